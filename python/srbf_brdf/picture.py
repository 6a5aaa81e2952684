"""A lit ball of a material, by numpy alone."""

from __future__ import annotations

import struct
import zlib

import numpy as np

# Lights, towards them, and their brightness: a key light, a fill light, and one behind for the grazing angles.
LIGHTS = (((-0.5, 0.6, 0.65), 2.2), ((0.8, 0.1, 0.5), 0.7), ((0.3, 0.7, -0.55), 1.6))
GROUND = 0.12
"""Radiance from all round, which the albedo multiplies."""


def _frames(normal):
    """Tangents that vary little over the ball, x to the right."""
    tangent = np.cross([0.0, 1.0, 0.0], normal)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    return tangent, np.cross(normal, tangent)


def srgb(linear):
    """Linear sRGB as bytes."""
    x = np.clip(linear, 0, 1)
    return np.round(255 * np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)).astype(np.uint8)


def ball(material, size: int = 256):
    """A ball from the front under three lights, uint8 of shape (size, size, 3)."""
    if not 1 <= size <= 8192:
        raise ValueError(f"size: {size} is not from 1 to 8192")
    at = (np.arange(size) + 0.5) / size * 2.1 - 1.05
    x, y = (a.ravel() for a in np.meshgrid(at, -at))
    squared = x * x + y * y
    inside = squared < 0.998
    x, y = x[inside], y[inside]
    normal = np.stack([x, y, np.sqrt(1 - x * x - y * y)], axis=1)
    # Nowhere is the normal along the axis of the frames, but at the poles, which no pixel meets.
    tangent, bitangent = _frames(normal)
    local = lambda d: np.stack([tangent @ d, bitangent @ d, normal @ d], axis=1)
    wo = local(np.array([0.0, 0.0, 1.0]))
    color = GROUND * np.asarray(material.albedo(wo), dtype=np.float64)
    for towards, brightness in LIGHTS:
        towards = np.asarray(towards) / np.linalg.norm(towards)
        color += brightness * np.maximum(material.evaluate(wo, local(towards)), 0)
    picture = np.full((size * size, 3), 255, dtype=np.uint8)
    picture[inside] = srgb(color)
    return picture.reshape(size, size, 3)


def png(picture) -> bytes:
    """An array of uint8 of shape (height, width, 3) as a PNG file."""
    height, width, _ = picture.shape
    rows = np.concatenate([np.zeros((height, 1), np.uint8), picture.reshape(height, -1)], axis=1)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows.tobytes())) + chunk(b"IEND", b"")


def png_of_ball(material) -> bytes:
    """The picture of a material in a notebook."""
    return png(ball(material, 192))
