"""The BSDF of Mitsuba 3 against core, Mitsuba's own chi-square test, derivatives. Skipped without mitsuba; the LLVM part without an LLVM that works."""

import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import time

import numpy as np
import pytest

import srbf_brdf as srbf
from conftest import PRESETS, ROOT, spread

mi = pytest.importorskip("mitsuba")
import drjit as dr  # noqa: E402
import srbf_brdf.mitsuba  # noqa: E402
from srbf_brdf import scalar  # noqa: E402

GARNET, CAYMAN = (next(p for p in PRESETS if p.stem == stem) for stem in ("garnet_red", "cayman"))
# `test_all_of_a_variant` runs this file again, once for each variant: one process cannot hold two of Dr.Jit's worlds in peace.
VARIANT = os.environ.get("SRBF_MITSUBA_VARIANT")
# All presets and both kinds take a minute and a half: SRBF_CHI_SQUARE=garnet_red,krylon_blue,brushed,factors.
CHI_SQUARE = os.environ.get("SRBF_CHI_SQUARE", "factors,brushed").split(",")
COMPILED = os.environ.get("SRBF_COMPILED") == "1"
PLUGIN = sys.platform == "linux" and shutil.which(os.environ.get("CXX", "g++")) and importlib.util.find_spec("nanobind")
IS_SPECTRAL = VARIANT is not None and "spectral" in VARIANT
of_variant = pytest.mark.skipif(VARIANT is None or IS_SPECTRAL, reason="run by test_all_of_a_variant")
of_spectral = pytest.mark.skipif(not IS_SPECTRAL, reason="run by test_all_of_a_variant")


@pytest.mark.skipif(VARIANT is not None, reason="itself")
@pytest.mark.parametrize(
    "variant, compiled",
    [(name, False) for name in ("llvm_ad_rgb", "scalar_rgb", "llvm_mono", "cuda_ad_rgb", "scalar_spectral", "llvm_ad_spectral", "llvm_ad_spectral_polarized")]
    + [(name, True) for name in ("scalar_rgb", "scalar_spectral", "scalar_spectral_polarized")],
)
def test_all_of_a_variant(variant, compiled):
    if variant not in mi.variants():
        pytest.skip(f"this Mitsuba has no {variant}")
    if variant.startswith("cuda") and not os.path.exists("/dev/nvidiactl"):
        pytest.skip("no GPU")
    if compiled and not PLUGIN:
        pytest.skip("needs a C++ compiler and nanobind")
    if compiled and not scalar.is_built():
        subprocess.run([sys.executable, "-m", "srbf_brdf.scalar"], check=True)
    arguments = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", __file__]
    run = subprocess.run(arguments, env=os.environ | {"SRBF_MITSUBA_VARIANT": variant, "SRBF_COMPILED": str(int(compiled))}, stdout=subprocess.PIPE, text=True)
    print(run.stdout)
    assert run.returncode == 0


@pytest.fixture(scope="module", autouse=True)
def variant():
    if VARIANT:
        mi.set_variant(VARIANT)
        srbf_brdf.mitsuba.register(compiled=COMPILED)


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
def test_values_at_wavelengths_are_those_of_core(materials, tmp_path):
    """Of a path with four wavelengths; light that leaves is not polarized."""
    wo, wi, _ = spread(20 if "scalar" in VARIANT else 1000)
    nm = np.random.default_rng(5).uniform(380, 760, (len(wo), 4)).astype(np.float32)
    ctx = mi.BSDFContext()
    sheet = tmp_path / "sheet.srbf"
    srbf.Sheet.join(front_transmission=srbf.load(materials["isotropic"])).save(sheet)
    for name, path in [*materials.items(), ("sheet", sheet)]:
        material, traced = srbf.load(materials.get(name, materials["isotropic"])), bsdf(path)
        want = np.stack([material.primaries(w).of(rgb) for w, rgb in zip(nm, material.evaluate(wo, wi))])
        wi = np.float32(wi * [1, 1, -1]) if name == "sheet" else wi
        if "scalar" in VARIANT:
            got = []
            for o, i, w in zip(wo, wi, nm):
                si = dr.zeros(mi.SurfaceInteraction3f)
                si.wi, si.wavelengths = mi.Vector3f(*map(float, o)), type(si.wavelengths)(*map(float, w))
                value = np.array(traced.eval(ctx, si, mi.Vector3f(*map(float, i))))
                got.append(value[0, 0] if mi.is_polarized else value)
        else:
            si = dr.zeros(mi.SurfaceInteraction3f, len(wo))
            si.wi = mi.Vector3f(np.ascontiguousarray(wo.T))
            si.wavelengths = type(si.wavelengths)(np.ascontiguousarray(nm.T))
            value = traced.eval(ctx, si, mi.Vector3f(np.ascontiguousarray(wi.T)))
            got = np.array(value[0, 0] if mi.is_polarized else value).T
        np.testing.assert_allclose(got, want, rtol=3e-4, atol=3e-4 * want.max(), err_msg=name)


def coloured(rgb):
    """Colours as Mitsuba has them: grey in monochrome variants, and none below 0 in scalar ones."""
    rgb = rgb @ np.array([[0.2126], [0.7152], [0.0722]]) if "mono" in VARIANT else rgb
    return np.maximum(rgb, 0) if "scalar" in VARIANT else rgb


def check(name, path, material, wo, wi, u):
    """Of a material or a sheet: values, densities and draws are those of the library."""
    want_value, want_pdf = material.evaluate_and_pdf(wo, wi)
    drawn = material.sample(wo, u)
    value, pdf, direction, density, weight = traced(bsdf(path), wo, wi, u)
    want_weight = drawn.weight
    want_value, want_weight = coloured(want_value), coloured(want_weight)
    if "mono" in VARIANT:
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
def test_packed_files_are_those_of_core(tmp_path):
    packed = srbf.load(ROOT / "fuzz/seeds/material/packed")
    sheet = srbf.Sheet.join(front_reflection=packed, front_transmission=packed, symmetric=True)
    wo, wi, u = spread(100 if "scalar" in VARIANT else 4096)
    for name, content in ("material", packed), ("sheet", sheet):
        path = tmp_path / f"{name}.srbf"
        content.save(path)
        check(name, path, content, wo, wi, u)
    if COMPILED:
        with pytest.raises(Exception, match="version 1"):
            bsdf(ROOT / "tests/corpus/version1.srbf")


@of_variant
def test_a_sheet_is_that_of_core_on_both_sides(tmp_path):
    names = ("front_reflection", "front_transmission", "back_reflection", "back_transmission")
    presets = (srbf.load(str(path)) for path in [*PRESETS, GARNET])
    four = srbf.Sheet.join(**dict(zip(names, presets)))
    alike = srbf.Sheet.join(front_reflection=four.quarter(names[1]), front_transmission=four.quarter(names[2]), symmetric=True)
    wo, wi, u = spread(100 if "scalar" in VARIANT else 4096)
    wo[::2, 2] *= -1
    wi[::3, 2] *= -1
    for name, sheet in ("four", four), ("alike", alike):
        path = tmp_path / f"{name}.srbf"
        sheet.save(path)
        check(name, path, sheet, wo, wi, u)
        assert COMPILED == ("compiled" in str(bsdf(path)))
        assert {mi.has_flag(bsdf(path).flags(), flag) for flag in (mi.BSDFFlags.GlossyTransmission, mi.BSDFFlags.BackSide)} == {True}


@pytest.mark.skipif(VARIANT is not None, reason="asked once")
def test_a_plugin_that_cannot_be_compiled_is_told():
    run = lambda more: subprocess.run([sys.executable, "-m", "srbf_brdf.scalar"], env=os.environ | more, stderr=subprocess.PIPE, text=True)
    none = run({"CXX": "no-such-compiler"})
    assert none.returncode == 1 and none.stderr.startswith("srbf_brdf.scalar: ") and "Traceback" not in none.stderr
    assert "no-such-compiler" in none.stderr or "nanobind" in none.stderr


@of_variant
def test_colours_outside_the_gamut_are_clamped_where_it_is_asked_for():
    wo, wi, u = spread(40)
    want = srbf.load(CAYMAN).evaluate(wo, wi)
    if "mono" in VARIANT:
        pytest.skip("a luminance is not outside")
    assert np.sum(want < -1e-3) > 5
    for clamp in (False, True):
        got = traced(bsdf(CAYMAN, clamp=clamp), wo, wi, u)[0]
        np.testing.assert_allclose(got, np.maximum(want, 0) if clamp else want, rtol=1e-3, atol=1e-4)


@of_variant
def test_pictures_have_no_warnings_and_an_albedo(capfd):
    """Of colours outside the gamut, whose samples below 0 a film of a scalar variant names, each by a line; with further channels it does not."""

    def picture(path, aovs):
        path_tracer = {"type": "path", "max_depth": 3}
        scene = mi.load_dict(
            {
                "type": "scene",
                "integrator": {"type": "aov", "aovs": aovs, "image": path_tracer} if aovs else path_tracer,
                "sensor": {
                    "type": "perspective",
                    "fov": 25,
                    "to_world": mi.ScalarTransform4f().look_at(origin=[0, 0, 5], target=[0, 0, 0], up=[0, 1, 0]),
                    "film": {"type": "hdrfilm", "width": 16, "height": 16, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
                },
                "ball": {"type": "sphere", "bsdf": {"type": "srbf", "filename": str(path)}},
                "sky": {"type": "constant"},
            }
        )
        made = np.array(mi.render(scene, spp=16))
        assert np.all(np.isfinite(made)) and "nvalid sample" not in "".join(capfd.readouterr())
        return made

    picture(CAYMAN, None)
    # Under an even sky the ball is as bright as its albedo.
    middle = picture(GARNET, "albedo:albedo")[5:11, 5:11].mean(axis=(0, 1))
    np.testing.assert_allclose(middle[:3], middle[3:6], rtol=0.15, atol=0.005)


@of_variant
def test_a_load_leaves_the_paths_as_they_are():
    """Other threads look through them while a scene is read."""
    if not COMPILED:
        pytest.skip("of the plugin")
    paths = list(map(str, mi.file_resolver()))
    scalar.load(mi, srbf.load(GARNET))
    assert list(map(str, mi.file_resolver())) == paths


@of_variant
def test_many_lobes_make_no_longer_program(tmp_path):
    if VARIANT != "llvm_ad_rgb":
        pytest.skip("one traced variant is enough")
    counts, spent = [], []
    wo, wi, u = spread(64)
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        for lobes in (3, 63):
            path = tmp_path / f"{lobes}.srbf"
            srbf.fit("model:ggx:alpha=0.3,f0=0.9/0.5/0.1", lobes=lobes, starts=1, steps=1, exchanges=0, views=3, factors="none", progress=False).save(path)
            material = bsdf(path)
            dr.kernel_history_clear()
            start = time.process_time()
            traced(material, wo, wi, u)
            spent.append(time.process_time() - start)
            counts.append(sum(kernel["operation_count"] for kernel in dr.kernel_history([dr.KernelType.JIT])))
    print(f"{counts} operations, {spent} s")
    assert counts[1] < 1.2 * counts[0] and spent[1] < 10


@of_variant
def test_directions_are_differentiable(materials):
    """Along a step of a direction, forwards, backwards and by differences of the library."""
    if "_ad_" not in VARIANT:
        pytest.skip("no derivatives")
    wo, wi, _ = spread(500)
    wo, wi = wo[wo[:, 2] > 0.2], wi[wo[:, 2] > 0.2]
    across = np.cross(wi, [0.6, 0, 0.8])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    for name in ("isotropic", "brushed"):
        material, seen = srbf.load(materials[name]), bsdf(materials[name])

        def value(step):
            si = dr.zeros(mi.SurfaceInteraction3f, len(wo))
            si.wi = mi.Vector3f(np.ascontiguousarray(wo.T))
            towards = mi.Vector3f(np.ascontiguousarray(wi.T)) + step * mi.Vector3f(np.float32(across.T))
            return seen.eval_pdf(mi.BSDFContext(), si, towards)[0].y

        step = mi.Float(0)
        dr.enable_grad(step)
        found = value(step)
        dr.forward(step)
        forwards = np.array(dr.grad(found))
        steps = mi.Float(np.zeros(len(wo), np.float32))
        dr.enable_grad(steps)
        dr.backward(value(steps))
        np.testing.assert_allclose(np.array(dr.grad(steps)), forwards, rtol=1e-3, atol=1e-5 * np.abs(forwards).max())
        moved = lambda s: material.evaluate(wo, (wi + s * across) / np.linalg.norm(wi + s * across, axis=1, keepdims=True))[:, 1].astype(float)
        differences = (moved(1e-3) - moved(-1e-3)) / 2e-3
        is_above = wi[:, 2] > 0.05
        np.testing.assert_allclose(forwards[is_above], differences[is_above], rtol=0.02, atol=2e-3 * np.abs(forwards).max())


@of_variant
def test_the_albedo_is_that_of_core(materials, tmp_path):
    """What `aov` writes as `albedo:albedo`."""
    wo, _, _ = spread(50 if "scalar" in VARIANT else 1000)
    front, through = (srbf.load(str(path)) for path in PRESETS[:2])
    sheet = srbf.Sheet.join(front_reflection=front, front_transmission=through)
    sheet.save(tmp_path / "sheet.srbf")
    pairs = [(path, [srbf.load(str(path)).albedo(wo)]) for path in materials.values()] + [(tmp_path / "sheet.srbf", sheet.albedos(wo))]
    for path, parts in pairs:
        seen = bsdf(path)
        if "scalar" in VARIANT:
            got = []
            for o in wo:
                si = dr.zeros(mi.SurfaceInteraction3f)
                si.wi = mi.Vector3f(*map(float, o))
                got.append(np.array(seen.eval_diffuse_reflectance(si)))
        else:
            si = dr.zeros(mi.SurfaceInteraction3f, len(wo))
            si.wi = mi.Vector3f(np.ascontiguousarray(wo.T))
            got = np.array(seen.eval_diffuse_reflectance(si)).T
        np.testing.assert_allclose(np.reshape(got, (len(wo), -1)), sum(map(coloured, parts)), rtol=3e-4, atol=3e-4, err_msg=str(path))


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
    # As the library's own blend.
    parts = [srbf.load(materials[name]) for name in ("factors", "isotropic")]
    blend = srbf.Blend(parts, [0.7, 0.3], [[0.9, 0.8, 0.7], [1, 1, 1]]).evaluate(wo, wi)
    for key in (tint, weight):
        dr.enable_grad(parameters[key])
        parameters.update()
        got, _ = blended.eval_pdf(mi.BSDFContext(), si, mi.Vector3f(np.ascontiguousarray(wi.T)))
        np.testing.assert_allclose(np.array(got).T, 0.7 * value[0] + 0.3 * value[1], rtol=1e-3, atol=1e-4)
        np.testing.assert_allclose(np.array(got).T, blend, rtol=1e-3, atol=1e-4)
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


@of_variant
def test_a_blend_has_the_picture_of_srbf_render(tmp_path):
    """A square whose share of a second material grows from left to right, tinted, under light from the sky: ours by a palette, Mitsuba's by `blendbsdf`."""
    program = pathlib.Path(os.environ.get("SRBF_REFERENCE", ROOT / "target/release/examples/reference")).parents[1] / "srbf"
    if VARIANT != "llvm_ad_rgb" or not program.exists():
        pytest.skip("a picture of one variant, beside the program srbf")
    side, size, samples, steps = 24, 3.4, 512, 256
    tint = [0.9, 0.6, 1.0]
    (tmp_path / "square.obj").write_text("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n")
    share = np.broadcast_to(((np.arange(steps) + 0.5) / steps)[None, :, None], (steps, steps, 3)).astype(np.float32)
    # Brighter towards the zenith, blue above and yellow below.
    up = (1 - (np.arange(256) + 0.5) / 256)[:, None, None]
    light = np.broadcast_to(0.2 + np.array([1.0, 1.5, 3.0]) * up**3 + np.array([2.0, 1.5, 0.2]) * (1 - up) ** 2, (256, 512, 3)).astype(np.float32)
    for name, pixels in ("share", share), ("light", light), ("tint", np.broadcast_to(np.float32(tint), (2, 2, 3))):
        mi.Bitmap(np.ascontiguousarray(pixels)).write(str(tmp_path / f"{name}.exr"))
    paths = [next(p for p in PRESETS if p.stem == stem) for stem in ("garnet_red", "krylon_blue")]

    def ours(seed):
        words = f"render --quiet --scene statue --mesh square.obj --mesh-up z --palette {paths[0]},{paths[1]} --weight-map share.exr --tint-map tint.exr"
        words += f" --env light.exr --eye 0,-5,4 --look-at 0,0,0 --fov 12 --max-bounces 1 --sampler mis --size {side}x{side} --spp {samples} --seed {seed}"
        subprocess.run([program, *words.split(), "-o", f"ours-{seed}.exr"], cwd=tmp_path, check=True)
        return np.array(mi.Bitmap(str(tmp_path / f"ours-{seed}.exr")).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))

    to_world = mi.ScalarTransform4f
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": 2},
            "sensor": {
                "type": "perspective",
                "fov": 12,
                "to_world": to_world().look_at(origin=[0, -5, 4], target=[0, 0, 0], up=[0, 0, 1]),
                "film": {"type": "hdrfilm", "width": side, "height": side, "rfilter": {"type": "box"}, "pixel_format": "rgb", "component_format": "float32"},
            },
            "light": {"type": "envmap", "filename": str(tmp_path / "light.exr"), "to_world": to_world().rotate([1, 0, 0], 90)},
            "square": {
                "type": "rectangle",
                "to_world": to_world().scale(size / 2),
                "bsdf": {
                    "type": "blendbsdf",
                    "weight": {"type": "bitmap", "filename": str(tmp_path / "share.exr"), "raw": True},
                    **{name: {"type": "srbf", "filename": str(path), "tint": {"type": "rgb", "value": tint}} for name, path in zip("ab", paths)},
                },
            },
        }
    )
    pictures = [ours(0), ours(1)] + [np.array(mi.render(scene, spp=samples, seed=seed)) for seed in (0, 1)]
    # Means over blocks of 4 x 4 pixels.
    blocks = [p.reshape(side // 4, 4, side // 4, 4, 3).mean(axis=(1, 3)) for p in pictures]
    scale = np.mean(blocks)
    noise = np.hypot(np.std(blocks[0] - blocks[1]), np.std(blocks[2] - blocks[3])) / 2 / scale
    difference = np.sqrt(np.mean((blocks[0] + blocks[1] - blocks[2] - blocks[3]) ** 2)) / 2 / scale
    print(f"{100 * difference:.2f} % apart, noise {100 * noise:.2f} %")
    assert 0 < noise < 0.02 and difference < max(2 * noise, 0.004)
    # It is no even picture: both materials are seen.
    assert np.std(blocks[2][..., 2].mean(axis=0)) > 0.1 * scale
