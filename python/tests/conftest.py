"""Materials for all tests: the presets, and small fits of models, of both kinds."""

import os
import pathlib
import subprocess

import numpy as np
import pytest

import srbf_brdf as srbf

ROOT = pathlib.Path(__file__).resolve().parents[2]
PRESETS = sorted((ROOT / "presets").glob("*.srbf"))
QUICK = dict(starts=1, steps=4, exchanges=0, views=4, progress=False)


def spread(n, seed=1):
    """Pairs of directions above the horizon, half of the incident ones near the mirror direction, and uniform numbers: float32 (n, 3)."""
    random = np.random.default_rng(seed)

    def hemisphere(n):
        z = 0.02 + 0.98 * random.random(n)
        phi = 2 * np.pi * random.random(n)
        r = np.sqrt(1 - z * z)
        return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=1)

    wo, wi = hemisphere(n), hemisphere(n)
    near = wo[: n // 2] * [-1, -1, 1] + 0.1 * random.normal(size=(n // 2, 3))
    near[:, 2] = np.abs(near[:, 2])
    wi[: n // 2] = near / np.linalg.norm(near, axis=1, keepdims=True)
    return tuple(np.ascontiguousarray(a, dtype=np.float32) for a in (wo, wi, random.random((n, 3)) * 0.9999999))


def reference(path, wo, wi, u):
    """What core says of them, by the program that `cargo build --release --workspace --example reference` makes: rows as columns of (n, 14)."""
    program = os.environ.get("SRBF_REFERENCE", str(ROOT / "target/release/examples/reference"))
    rows = np.ascontiguousarray(np.concatenate([wo, wi, u], axis=1).T, dtype="<f4")
    out = subprocess.run([program, path], input=rows.tobytes(), stdout=subprocess.PIPE, check=True).stdout
    return np.frombuffer(out, "<f4").reshape(14, -1).T


def make_materials(folder):
    """Writes materials, and returns their paths by name: isotropic and anisotropic, with factors and without, and the presets."""
    made = {
        "isotropic": srbf.fit("model:ggx:alpha=0.2,f0=0.9/0.5/0.1", lobes=5, factors="none", **QUICK),
        "factors": srbf.fit("model:ggx:alpha=0.15,f0=0.9/0.5/0.1,diffuse=0.1", lobes=4, factors=(8, 6, 3), **QUICK),
        "brushed": srbf.fit("model:ward:alpha_x=0.1,alpha_y=0.4", lobes=4, starts=1, steps=4, progress=False),
    }
    for name, material in made.items():
        material.save(folder / f"{name}.srbf")
    return {name: folder / f"{name}.srbf" for name in made} | {path.stem: path for path in PRESETS}


@pytest.fixture(scope="session")
def materials(tmp_path_factory):
    """Those, once."""
    return make_materials(tmp_path_factory.mktemp("materials"))
