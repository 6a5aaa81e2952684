"""The BSDF of Mitsuba 3 against core, Mitsuba's own chi-square test, derivatives. Skipped without mitsuba; the LLVM part without an LLVM that works."""

import os
import subprocess
import sys

import numpy as np
import pytest

import srbf_brdf as srbf
from conftest import PRESETS, spread

mi = pytest.importorskip("mitsuba")
import drjit as dr  # noqa: E402
import srbf_brdf.mitsuba  # noqa: E402

GARNET = next(p for p in PRESETS if p.stem == "garnet_red")
# `test_all_of_a_variant` runs this file again, once for each variant: one process cannot hold two of Dr.Jit's worlds in peace.
VARIANT = os.environ.get("SRBF_MITSUBA_VARIANT")
# All presets and both kinds take a minute and a half: SRBF_CHI_SQUARE=garnet_red,krylon_blue,brushed,factors.
CHI_SQUARE = os.environ.get("SRBF_CHI_SQUARE", "factors,brushed").split(",")
IS_SPECTRAL = VARIANT is not None and "spectral" in VARIANT
of_variant = pytest.mark.skipif(VARIANT is None or IS_SPECTRAL, reason="run by test_all_of_a_variant")
of_spectral = pytest.mark.skipif(not IS_SPECTRAL, reason="run by test_all_of_a_variant")


@pytest.mark.skipif(VARIANT is not None, reason="itself")
@pytest.mark.parametrize("variant", ["llvm_ad_rgb", "scalar_rgb", "llvm_mono", "cuda_ad_rgb", "scalar_spectral", "llvm_ad_spectral", "llvm_ad_spectral_polarized"])
def test_all_of_a_variant(variant):
    if variant not in mi.variants():
        pytest.skip(f"this Mitsuba has no {variant}")
    if variant.startswith("cuda") and not os.path.exists("/dev/nvidiactl"):
        pytest.skip("no GPU")
    arguments = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", __file__]
    run = subprocess.run(arguments, env=os.environ | {"SRBF_MITSUBA_VARIANT": variant}, stdout=subprocess.PIPE, text=True)
    print(run.stdout)
    assert run.returncode == 0


@pytest.fixture(scope="module", autouse=True)
def variant():
    if VARIANT:
        mi.set_variant(VARIANT)
        srbf_brdf.mitsuba.register()


def bsdf(path, **more):
    return mi.load_dict({"type": "srbf", "filename": str(path), **more})


def arrays(*values):
    return [np.array(v).T if np.ndim(v) else np.array(v) for v in values]


def traced(material, wo, wi, u):
    """Value, density, direction, density there, weight."""
    ctx = mi.BSDFContext()
    if "scalar" not in VARIANT:
        si = dr.zeros(mi.SurfaceInteraction3f, len(wo))
        si.wi = mi.Vector3f(np.ascontiguousarray(wo.T))
        value, pdf = material.eval_pdf(ctx, si, mi.Vector3f(np.ascontiguousarray(wi.T)))
        sample, weight = material.sample(ctx, si, mi.Float(u[:, 0].copy()), mi.Point2f(np.ascontiguousarray(u[:, 1:].T)))
        return arrays(value, pdf, sample.wo, sample.pdf, weight)
    rows = []
    for o, i, x in zip(wo, wi, u):
        si = dr.zeros(mi.SurfaceInteraction3f)
        si.wi = mi.Vector3f(*map(float, o))
        value, pdf = material.eval_pdf(ctx, si, mi.Vector3f(*map(float, i)))
        sample, weight = material.sample(ctx, si, float(x[0]), mi.Point2f(float(x[1]), float(x[2])))
        rows.append([*value, pdf, *sample.wo, sample.pdf, *weight])
    rows = np.array(rows)
    return rows[:, :3], rows[:, 3], rows[:, 4:7], rows[:, 7], rows[:, 8:]


@of_spectral
def test_values_at_wavelengths_are_those_of_core(materials):
    """Of a path with four wavelengths; light that leaves is not polarized."""
    wo, wi, _ = spread(20 if "scalar" in VARIANT else 1000)
    nm = np.random.default_rng(5).uniform(380, 760, (len(wo), 4)).astype(np.float32)
    ctx = mi.BSDFContext()
    for name, path in materials.items():
        material, traced = srbf.load(path), bsdf(path)
        want = np.stack([material.primaries(w).of(rgb) for w, rgb in zip(nm, material.evaluate(wo, wi))])
        if "scalar" in VARIANT:
            got = []
            for o, i, w in zip(wo, wi, nm):
                si = dr.zeros(mi.SurfaceInteraction3f)
                si.wi, si.wavelengths = mi.Vector3f(*map(float, o)), type(si.wavelengths)(*map(float, w))
                got.append(np.array(traced.eval(ctx, si, mi.Vector3f(*map(float, i)))))
        else:
            si = dr.zeros(mi.SurfaceInteraction3f, len(wo))
            si.wi = mi.Vector3f(np.ascontiguousarray(wo.T))
            si.wavelengths = type(si.wavelengths)(np.ascontiguousarray(nm.T))
            value = traced.eval(ctx, si, mi.Vector3f(np.ascontiguousarray(wi.T)))
            got = np.array(value[0, 0] if mi.is_polarized else value).T
        np.testing.assert_allclose(got, want, rtol=3e-4, atol=3e-4 * want.max(), err_msg=name)


def check(name, path, material, wo, wi, u):
    """Of a material or a sheet: values, densities and draws are those of the library."""
    want_value, want_pdf = material.evaluate_and_pdf(wo, wi)
    drawn = material.sample(wo, u)
    value, pdf, direction, density, weight = traced(bsdf(path), wo, wi, u)
    want_weight = drawn.weight
    if "mono" in VARIANT:
        luminance = np.array([[0.2126], [0.7152], [0.0722]])
        want_value, want_weight = want_value @ luminance, want_weight @ luminance
        value, weight = (np.reshape(a, (-1, 1)) for a in (value, weight))
    largest = lambda a: np.max(np.abs(a), axis=1)
    same = largest(direction - drawn.direction) < 1e-4
    # A lobe chosen at the very edge between two may be the other one.
    assert np.sum(~same) <= 2, name
    assert np.max(largest(value - want_value) / np.maximum(largest(want_value), 0.1 * want_pdf)) < 3e-4, name
    assert np.max(np.abs(pdf - want_pdf) / want_pdf) < 3e-4, name
    assert np.max((np.abs(density - drawn.pdf) / drawn.pdf)[same]) < 5e-4, name
    assert np.max((largest(weight - want_weight) / np.maximum(largest(want_weight), 0.1))[same]) < 5e-4, name


@of_variant
def test_values_and_draws_are_those_of_core(materials):
    wo, wi, u = spread(300 if "scalar" in VARIANT else 4096)
    for name, path in materials.items():
        check(name, path, srbf.load(path), wo, wi, u)


@of_variant
def test_a_sheet_is_that_of_core_on_both_sides(tmp_path):
    names = ("front_reflection", "front_transmission", "back_reflection", "back_transmission")
    presets = (srbf.load(str(path)) for path in [*PRESETS, GARNET])
    sheet = srbf.Sheet.join(**dict(zip(names, presets)))
    path = tmp_path / "sheet.srbf"
    sheet.save(path)
    wo, wi, u = spread(100 if "scalar" in VARIANT else 4096)
    wo[::2, 2] *= -1
    wi[::3, 2] *= -1
    check("sheet", path, sheet, wo, wi, u)


@of_variant
def test_below_the_horizon_there_is_nothing():
    wo = np.array([[0.6, 0, -0.8], [0.6, 0, 0.8]], dtype=np.float32)
    wi = np.array([[0.0, 0, 1], [0.6, 0, -0.8]], dtype=np.float32)
    value, pdf, *_ = traced(bsdf(GARNET), wo, wi, np.full((2, 3), 0.4, np.float32))
    assert np.all(np.asarray(value) == 0) and np.all(pdf == 0)


@of_variant
def test_mitsubas_chi_square_accepts(materials):
    if VARIANT not in ("llvm_ad_rgb", "cuda_ad_rgb"):
        pytest.skip("one vectorised variant is enough")
    from mitsuba.chi2 import BSDFAdapter, ChiSquareTest, SphericalDomain

    for name in CHI_SQUARE:
        for n in range(12):
            theta, phi = np.radians(5 + 7 * n), 2.4 * n
            wo = [float(np.sin(theta) * np.cos(phi)), float(np.sin(theta) * np.sin(phi)), float(np.cos(theta))]
            sample, pdf = BSDFAdapter("srbf", f'<string name="filename" value="{materials[name]}"/>', wi=wo)
            test = ChiSquareTest(
                domain=SphericalDomain(),
                sample_func=sample,
                pdf_func=pdf,
                sample_dim=3,
                sample_count=200_000,
                res=101,
                # Its quadrature within a cell: at 8 the density sums to 1.0008 by its own error.
                ires=32,
            )
            assert test.run(0.01, 48), f"{name}, wo at {np.degrees(theta):.0f} degrees: {test.messages}"


@of_variant
def test_tint_and_blend_are_differentiable(materials):
    if "_ad_" not in VARIANT:
        pytest.skip("no derivatives")
    blended = mi.load_dict(
        {
            "type": "blendbsdf",
            "weight": {"type": "bitmap", "bitmap": mi.Bitmap(np.full((4, 4, 1), 0.3, np.float32)), "raw": True},
            "a": bsdf(materials["factors"], tint={"type": "rgb", "value": [0.9, 0.8, 0.7]}),
            "b": bsdf(materials["isotropic"]),
        }
    )
    parameters = mi.traverse(blended)
    tint = next(key for key in parameters.keys() if key.endswith("tint.value"))
    weight = next(key for key in parameters.keys() if key.endswith("weight.data"))
    wo, wi, _ = spread(2000)
    si = dr.zeros(mi.SurfaceInteraction3f, len(wo))
    si.wi = mi.Vector3f(np.ascontiguousarray(wo.T))
    si.uv = mi.Point2f(0.5)
    value = [srbf.load(materials[name]).evaluate(wo, wi).astype(float) for name in ("factors", "isotropic")]
    value[0] *= [0.9, 0.8, 0.7]
    # Linear in both: f = (1 - weight) tint a + weight b.
    want = {tint: 0.7 * value[0].mean(axis=0) / 3 / [0.9, 0.8, 0.7], weight: (value[1] - value[0]).mean()}
    for key in (tint, weight):
        dr.enable_grad(parameters[key])
        parameters.update()
        got, _ = blended.eval_pdf(mi.BSDFContext(), si, mi.Vector3f(np.ascontiguousarray(wi.T)))
        np.testing.assert_allclose(np.array(got).T, 0.7 * value[0] + 0.3 * value[1], rtol=1e-3, atol=1e-4)
        dr.backward(dr.mean(dr.mean(got, axis=0)))
        gradient = np.array(dr.grad(parameters[key])).astype(float)
        gradient = gradient.sum() if key == weight else gradient.ravel()
        np.testing.assert_allclose(gradient, want[key], rtol=1e-3)
        dr.disable_grad(parameters[key])


@of_variant
def test_what_is_missing_is_named():
    with pytest.raises(Exception, match="filename"):
        mi.load_dict({"type": "srbf"})
    with pytest.raises(Exception, match="nothing.srbf"):
        mi.load_dict({"type": "srbf", "filename": "nothing.srbf"})
