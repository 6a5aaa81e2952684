"""What calls return in several parts."""

from __future__ import annotations

from typing import Any, List, NamedTuple

import numpy as np


class Sample(NamedTuple):
    """Incident directions that were drawn."""

    direction: np.ndarray
    """Unit vectors, float32 of shape (n, 3)."""
    pdf: np.ndarray
    """Their density, float32 of shape (n,), 1/sr."""
    weight: np.ndarray
    """`f cos / pdf`, linear sRGB, float32 of shape (n, 3)."""


class Primaries(NamedTuple):
    """What takes the colours of a material to values at wavelengths."""

    columns: np.ndarray
    """For each wavelength three numbers, whose product with linear sRGB is the value; float32 of shape (w, 3)."""

    def of(self, rgb) -> np.ndarray:
        """The values of colours (..., 3) at the wavelengths, (..., w): of `f cos`, weights, albedos. None is below 0."""
        return np.maximum(np.asarray(rgb, np.float32) @ self.columns.T, 0)


class Comparison:
    """A material beside a table; prints as its verdict."""

    def __init__(self, report: dict, verdict: List[str]):
        self.report: dict[str, Any] = report
        """Every number, view by view, as `srbf judge` prints it."""
        self.verdict = verdict
        """Criteria that are good, fair and off, and advice: a sentence each."""

    def __str__(self) -> str:
        return "\n".join(self.verdict)

    __repr__ = __str__
