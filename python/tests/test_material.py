import pickle

import numpy as np
import pytest

import srbf_brdf as srbf
from conftest import PRESETS, reference, spread

N = 3001
GARNET = next(p for p in PRESETS if p.stem == "garnet_red")


def test_values_are_those_of_core_bit_for_bit(materials):
    assert len(materials) >= 6
    for name, path in materials.items():
        material = srbf.load(path)
        wo, wi, u = spread(N)
        want = reference(path, wo, wi, u)
        value, pdf = material.evaluate_and_pdf(wo, wi)
        direction, density, weight = material.sample(wo, u)
        got = np.column_stack([value, pdf, direction, density, weight, material.albedo(wo)])
        assert got.dtype == np.float32
        assert np.array_equal(got.view(np.uint32), np.ascontiguousarray(want).view(np.uint32)), name
        assert np.array_equal(material.evaluate(wo, wi), value)
        np.testing.assert_allclose(material.pdf(wo, wi), pdf, rtol=1e-5)
        sample, towards, there = material.sample_and_evaluate(wo, u, wi)
        np.testing.assert_allclose(sample.direction, direction, atol=1e-6)
        np.testing.assert_allclose(towards, value, rtol=1e-4, atol=1e-6)
        np.testing.assert_allclose(there, pdf, rtol=1e-5)


def round_the_mirror(wo, n=(1000, 300)):
    """Directions round the mirror direction, dense close to it, and the solid angle of each."""
    t, phi = np.meshgrid((np.arange(n[0]) + 0.5) / n[0], 2 * np.pi * (np.arange(n[1]) + 0.5) / n[1])
    angle = np.pi * t**3
    solid = np.sin(angle) * 3 * np.pi * t**2 * 2 * np.pi / (n[0] * n[1])
    axis = np.array([-wo[0], -wo[1], wo[2]])
    side = np.cross(axis, [1.0, 0.0, 0.0] if abs(axis[0]) < 0.7 else [0.0, 1.0, 0.0])
    side /= np.linalg.norm(side)
    parts = (np.sin(angle) * np.cos(phi), np.sin(angle) * np.sin(phi), np.cos(angle))
    wi = sum(part[..., None] * vector for part, vector in zip(parts, (side, np.cross(axis, side), axis)))
    return wi.reshape(-1, 3), solid.ravel()


def test_density_integrates_to_one_and_draws_to_the_albedo(materials):
    for name, path in materials.items():
        material = srbf.load(path)
        for wo in ([0, 0, 1], [-0.6, 0, 0.8], [0.3, 0.6, np.sqrt(0.55)]):
            wi, solid = round_the_mirror(wo)
            assert np.sum(material.pdf(wo, wi) * solid) == pytest.approx(1, abs=3e-3), name
            albedo = np.sum(material.evaluate(wo, wi) * solid[:, None], axis=0)
            np.testing.assert_allclose(albedo, material.albedo(wo), rtol=0.02, atol=2e-3, err_msg=name)
            drawn = np.mean(material.sample(wo, spread(100_000)[2]).weight, axis=0)
            np.testing.assert_allclose(drawn, albedo, rtol=0.02, atol=2e-3, err_msg=name)


def test_one_direction_stands_for_many_and_any_type_is_cast():
    material = srbf.load(str(GARNET))
    wo, wi, u = spread(7)
    one = material.evaluate(wo[0], wi)
    assert one.shape == (7, 3)
    assert np.array_equal(one, material.evaluate(np.repeat(wo[:1], 7, axis=0), wi))
    single = material.evaluate(wo[0], wi[0])
    # Pairs are taken in blocks, one alone by itself: the sums of lobes are rounded in another order.
    assert single.shape == (3,) and np.max(np.abs(single - one[0])) <= 1e-6 * np.max(one[0])
    assert np.ndim(material.pdf(wo[0], wi[0])) == 0
    assert np.array_equal(material.evaluate(wo.astype(np.float64), wi.tolist()), material.evaluate(wo, wi))
    assert np.array_equal(material.evaluate(np.asfortranarray(wo), wi[::-1][::-1]), material.evaluate(wo, wi))
    sample = material.sample(wo[0], u[0])
    assert sample.direction.shape == (3,) and sample.weight.shape == (3,)
    assert material.evaluate(np.zeros((0, 3)), np.zeros((0, 3))).shape == (0, 3)
    assert np.all(material.evaluate([0, 0.6, -0.8], wi) == 0)


@pytest.mark.parametrize(
    "wo, wi, text",
    [
        (np.zeros((4, 2)), [0, 0, 1], "wo: shape"),
        ([0, 0, 1], [0, 0, 2], "wi.0.: .* has length 2, not 1"),
        ([[0, 0, 1], [0, np.nan, 1]], [0, 0, 1], "wo.1."),
        (np.tile([0, 0, 1], (2, 1)), np.tile([0, 0, 1], (3, 1)), "2 and 3 rows"),
        ("up", [0, 0, 1], "wo"),
        (0.5, [0, 0, 1], "wo: shape"),
    ],
)
def test_what_is_no_direction_is_named(wo, wi, text):
    with pytest.raises(ValueError, match=text):
        srbf.load(GARNET).evaluate(wo, wi)


def test_uniform_numbers_are_checked_and_those_next_to_one_are_below_it():
    material = srbf.load(GARNET)
    with pytest.raises(ValueError, match="u.0.: 1.5 is not in"):
        material.sample([0, 0, 1], [0.1, 1.5, 0.2])
    with pytest.raises(ValueError, match="u.0."):
        material.sample([0, 0, 1], [0.1, np.nan, 0.2])
    sample = material.sample([0, 0, 1], np.full(3, 1 - 1e-12))
    assert np.all(np.isfinite(np.concatenate([sample.direction, sample.weight])))


def test_files_come_back_and_faults_are_named(tmp_path):
    material = srbf.load(GARNET)
    material.save(tmp_path / "new" / "again.srbf")
    again = srbf.load(tmp_path / "new" / "again.srbf")
    assert again == material and hash(again) == hash(material) and again != 3
    assert pickle.loads(pickle.dumps(material)) == material
    assert "isotropic" in repr(material) and material.provenance and material.report is None
    with pytest.raises(FileNotFoundError, match="nothing.srbf"):
        srbf.load("nothing.srbf")
    (tmp_path / "bad.srbf").write_bytes(material.to_bytes()[:100])
    with pytest.raises(ValueError, match="bad.srbf"):
        srbf.load(tmp_path / "bad.srbf")
    with pytest.raises(OSError):
        material.save("/proc/nowhere/a.srbf")


def test_arrays_are_what_the_file_holds(materials):
    for path in materials.values():
        material = srbf.load(path)
        arrays = material.arrays()
        views, lobes = arrays["theta"].shape[0], arrays["log2_sharpness"].shape[1]
        assert views == material.view_count and lobes + arrays["mirrored"] == material.lobe_count
        assert arrays["tilt"].shape == (views, lobes, 2) and arrays["color"].shape == (views, lobes, 3)
        assert arrays["theta"][0] == 0 and np.all(np.diff(arrays["theta"]) >= 0)


def test_pictures(tmp_path):
    material = srbf.load(GARNET)
    ball = material.ball(64)
    assert ball.shape == (64, 64, 3) and ball.dtype == np.uint8
    # Red, and lit from above.
    assert ball[32, 32, 0] > ball[32, 32, 1] and np.all(ball[0, 0] == 255)
    assert material._repr_png_()[:4] == b"\x89PNG"
    matplotlib = pytest.importorskip("matplotlib")
    material.plot(srbf.read("model:lambert:albedo=0.5")).savefig(tmp_path / "sheet.png")
    assert (tmp_path / "sheet.png").stat().st_size > 10_000 and matplotlib


def test_other_formats_come_back(tmp_path):
    material = srbf.fit("model:ggx:alpha=0.3,f0=0.6,diffuse=0.2", lobes=3, starts=1, steps=8, exchanges=0, views=4, progress=False)
    wo, wi, _ = spread(500)
    # Not grazing, where grids of half vectors are coarse.
    keep = (wo[:, 2] > 0.3) & (wi[:, 2] > 0.2)
    value = material.evaluate(wo[keep], wi[keep])
    for name, write, bound in (("a.binary", material.to_merl, 0.06), ("a.bsdf", material.to_rgl, 0.03)):
        write(tmp_path / name)
        back = srbf.read(tmp_path / name).evaluate(wo[keep], wi[keep])
        assert np.linalg.norm(back - value) < bound * np.linalg.norm(value), name


def test_spectra_of_colours(tmp_path):
    material = srbf.load(GARNET)
    nm = material.wavelengths
    assert material.has_spectrum and len(nm) == 31 and (nm[0], nm[-1]) == (400, 700)
    primaries = material.primaries([400, 405, 410, 2000])
    assert primaries.columns.shape == (4, 3) and primaries.columns.dtype == np.float32
    np.testing.assert_allclose(primaries.columns[1], primaries.columns[[0, 2]].mean(axis=0), atol=1e-6)
    np.testing.assert_array_equal(primaries.columns[3], material.primaries([700]).columns[0])
    wo, wi, _ = spread(50)
    rgb = material.evaluate(wo, wi)
    values = material.primaries([450, 650]).of(rgb)
    assert values.shape == (50, 2) and values.min() >= 0 and np.median(values[:, 1] / values[:, 0]) > 1.5
    # One wavelength, by a table of text; and none.
    rows = [f"{i},0,{o},{p},{0.2 + 0.001 * i}" for i in range(0, 80, 10) for o in (5, 30, 60) for p in (0, 90, 180)]
    path = tmp_path / "lidar.csv"
    path.write_text("theta_i,phi_i,theta_o,phi_o,905nm\n" + "\n".join(rows))
    lidar = srbf.fit(path, lobes=1, starts=1, steps=2, exchanges=0, views=3, factors="none", progress=False)
    assert lidar.wavelengths.tolist() == [905] and any("905 nm" in line for line in lidar.verdict)
    assert ", 905 nm," in repr(lidar) and "31 wavelengths from 400 to 700 nm" in repr(material)
    np.testing.assert_allclose(lidar.primaries([905]).of([0.25, 0.25, 0.25]), [0.25], rtol=1e-6)
    plain = srbf.fit("model:lambert:albedo=0.5", lobes=1, starts=1, steps=2, exchanges=0, views=2, progress=False)
    assert not plain.has_spectrum and plain.wavelengths.size == 0
    np.testing.assert_allclose(plain.primaries(np.arange(300, 900, 7)).columns.sum(axis=1), 1, atol=1e-5)
    with pytest.raises(ValueError):
        material.primaries("red")


def test_a_sheet_is_its_quarters(tmp_path):
    front, through = srbf.load(str(PRESETS[0])), srbf.load(str(PRESETS[1]))
    sheet = srbf.Sheet.join(front_reflection=front, back_transmission=through)
    assert sheet.quarter("front_reflection") == front and sheet.quarter("back_transmission") == through
    assert sheet.quarter("back_reflection") is None and not sheet.is_symmetric
    assert pickle.loads(pickle.dumps(sheet)) == sheet
    sheet.save(tmp_path / "sheet.srbf")
    assert srbf.Sheet.load(tmp_path / "sheet.srbf") == sheet
    wo, wi, u = spread(500)
    np.testing.assert_array_equal(sheet.evaluate(wo, wi), front.evaluate(wo, wi))
    down = np.array([1, 1, -1], np.float32)
    value, pdf = sheet.evaluate_and_pdf(wo * down, wi)
    np.testing.assert_array_equal(value, through.evaluate(wo, wi))
    np.testing.assert_allclose(pdf, through.pdf(wo, wi), rtol=1e-5)
    assert not sheet.evaluate(wo, wi * down).any()
    drawn = sheet.sample(wo * down, u)
    assert (drawn.direction[drawn.pdf > 0, 2] > 0).all() and (sheet.reflected_share(wo * down) == 0).all()
    reflected, transmitted = sheet.albedos(wo)
    np.testing.assert_allclose(reflected, front.albedo(wo), rtol=1e-5)
    assert not transmitted.any()
    with pytest.raises(ValueError, match="front_reflection, front_transmission"):
        sheet.quarter("side")
    with pytest.raises(ValueError):
        srbf.Sheet.join()
    with pytest.raises(ValueError):
        srbf.Sheet.from_bytes(front.to_bytes())
