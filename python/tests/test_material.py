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


def everything(of, wo, wi, u):
    """All that is asked of directions: arrays, with how many axes they have after the leading shape."""
    drawn, towards, there = of.sample_and_evaluate(wo, u, wi)
    again = of.sample(wo, u)
    value, pdf = of.evaluate_and_pdf(wo, wi)
    both = [(drawn.direction, 1), (drawn.pdf, 0), (drawn.weight, 1), (towards, 1), (there, 0), (value, 1), (pdf, 0)]
    both += [(again.direction, 1), (again.pdf, 0), (again.weight, 1), (of.evaluate(wo, wi), 1), (of.pdf(wo, wi), 0)]
    if isinstance(of, srbf.Sheet):
        return both + [(of.reflected_share(wo), 0), *((albedo, 1) for albedo in of.albedos(wo))]
    return both + [(of.albedo(wo), 1)] + ([(array, 2) for array in of.gradients(wo, wi)] if isinstance(of, srbf.Blend) else [])


@pytest.mark.parametrize("shapes", [((4, 1), (1, 5), (4, 5)), ((5,), (4, 5), (1,)), ((), (2, 3, 4), (4,)), ((4, 5), (4, 5), (4, 5)), ((0, 1), (3,), ()), ((1,), (), ())])
def test_leading_shapes_broadcast_as_those_of_numpy(shapes):
    materials = [srbf.load(str(path)) for path in PRESETS[:2]]
    wo, wi, u = (array[: int(np.prod(shape))].reshape(*shape, 3) for array, shape in zip(spread(40), shapes))
    whole = np.broadcast_shapes(*shapes)
    flat = [np.broadcast_to(a, (*whole, 3)).reshape(-1, 3) for a in (wo, wi, u)]
    sheet = srbf.Sheet.join(front_reflection=materials[0], front_transmission=materials[1])
    for of in (materials[0], sheet, srbf.Blend(materials, [0.3, 0.7])):
        for n, ((got, last), (want, _)) in enumerate(zip(everything(of, wo, wi, u), everything(of, *flat), strict=True)):
            lead = np.shape(got)[: np.ndim(got) - last]
            # A blend of few pairs chooses other parts by the same numbers.
            if isinstance(of, srbf.Blend) and n < 10 and lead != whole:
                continue
            assert lead in (whole, shapes[0], np.broadcast_shapes(shapes[0], shapes[1]), np.broadcast_shapes(shapes[0], shapes[2]))
            spread_out = np.broadcast_to(got, (*whole, *np.shape(got)[len(lead) :]))
            # Blocks of pairs are others, whose sums of lobes are rounded in another order.
            np.testing.assert_allclose(spread_out.reshape(want.shape), want, rtol=2e-5, atol=1e-6)


def test_weights_of_a_blend_and_values_of_a_table_broadcast_too():
    materials = [srbf.load(str(path)) for path in PRESETS[:2]]
    wo, wi, _ = spread(20)
    wo, wi = wo.reshape(4, 5, 3), wi[:5]
    weights, tints = np.random.default_rng(1).uniform(0.1, 1, (4, 1, 2)), np.random.default_rng(2).uniform(0.1, 1, (5, 2, 3))
    blend = srbf.Blend(materials, weights, tints)
    want = sum(weights[..., k, None] * tints[:, k] * m.evaluate(wo, wi) for k, m in enumerate(materials))
    np.testing.assert_allclose(blend.evaluate(wo, wi), want, rtol=1e-4, atol=1e-5)
    # Of one direction as many as there are weights.
    assert blend.albedo([0, 0, 1]).shape == (4, 5, 3) and blend.gradients(wo, wi)[0].shape == (4, 5, 2, 3)
    with pytest.raises(ValueError, match=r"weights of shape \(4, 2\) and tints of shape \(3, 2, 3\)"):
        srbf.Blend(materials, np.ones((4, 2)), np.ones((3, 2, 3)))
    with pytest.raises(ValueError, match=r"weights: shape \(\.\.\., 2\) is expected, not \(2, 3\)"):
        srbf.Blend(materials, np.ones((2, 3)))
    table = srbf.read("model:ggx:alpha=0.3,f0=0.5")
    values = table.evaluate(wo, wi)
    assert values.shape == (4, 5, 3) and values.dtype == np.float64
    np.testing.assert_array_equal(values[2, 3], table.evaluate(wo[2, 3], wi[3]))
    with pytest.raises(ValueError, match=r"wo of shape \(4, 5, 3\) and wi of shape \(2, 3\)"):
        table.evaluate(wo, wi[:2])


def test_pairs_that_no_memory_holds_are_refused():
    many = np.broadcast_to(np.float32([0, 0, 1]), (1 << 20, 3))
    with pytest.raises(MemoryError, match=r"wo of shape \(1048576, 1, 3\) and wi of shape \(1048576, 3\)"):
        srbf.load(GARNET).evaluate(many[:, None], many)


@pytest.mark.parametrize(
    "wo, wi, text",
    [
        (np.zeros((4, 2)), [0, 0, 1], "wo: shape"),
        ([0, 0, 1], [0, 0, 2], "wi: .* has length 2, not 1"),
        ([[0, 0, 1], [0, np.nan, 1]], [0, 0, 1], r"wo\[1\]"),
        ([[[0, 0, 1], [0, 0, 1]], [[0, 0, 1], [0, 0, 3]]], [0, 0, 1], r"wo\[1, 1\]: .* has length 3"),
        (np.tile([0, 0, 1], (2, 1)), np.tile([0, 0, 1], (3, 1)), r"wo of shape \(2, 3\) and wi of shape \(3, 3\): .* do not broadcast"),
        (np.tile([0, 0, 1], (4, 2, 1)), np.tile([0, 0, 1], (4, 1)), r"wo of shape \(4, 2, 3\) and wi of shape \(4, 3\)"),
        ("up", [0, 0, 1], "wo"),
        (0.5, [0, 0, 1], "wo: shape"),
    ],
)
def test_what_is_no_direction_is_named(wo, wi, text):
    with pytest.raises(ValueError, match=text):
        srbf.load(GARNET).evaluate(wo, wi)


def test_uniform_numbers_are_checked_and_those_next_to_one_are_below_it():
    material = srbf.load(GARNET)
    with pytest.raises(ValueError, match="u: 1.5 is not in"):
        material.sample([0, 0, 1], [0.1, 1.5, 0.2])
    with pytest.raises(ValueError, match=r"u\[1\]: NaN"):
        material.sample([0, 0, 1], [[0.1, 0.5, 0.2], [0.1, np.nan, 0.2]])
    sample = material.sample([0, 0, 1], np.full(3, 1 - 1e-12))
    assert np.all(np.isfinite(np.concatenate([sample.direction, sample.weight])))


def test_files_come_back_and_faults_are_named(tmp_path):
    material = srbf.load(GARNET)
    material.save(tmp_path / "new" / "again.srbf")
    again = srbf.load(tmp_path / "new" / "again.srbf")
    assert again == material and hash(again) == hash(material) and again != 3
    assert pickle.loads(pickle.dumps(material)) == material
    assert "isotropic" in repr(material) and material.provenance and material.report == {} and material.verdict == []
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


def test_samples_are_drawn_as_points(tmp_path):
    pytest.importorskip("matplotlib")
    material = srbf.load(GARNET)
    degrees = np.radians([-60, -20, 10, 45, 70])
    viewers = np.radians([10, 30, 50, 60, 75])
    wo = np.stack([-np.sin(viewers), 0 * viewers, np.cos(viewers)], axis=1)[:, None]
    # In the plane of incidence, and far from it.
    inside = np.stack([np.sin(degrees), 0 * degrees, np.cos(degrees)], axis=1)
    outside = np.stack([0 * degrees, np.sin(np.abs(degrees) + 0.2), np.cos(np.abs(degrees) + 0.2)], axis=1)
    wi = np.concatenate([inside, outside[:4]])
    f = material.evaluate(wo, wi) / wi[:, 2:]
    table = srbf.table(wo, wi, np.maximum(f, 1e-4), name="mine")
    lines = lambda figure: figure.axes[0].get_lines()
    figure = material.plot(table)
    points = [line for line in lines(figure) if line.get_linestyle() == "None"]
    curves = [line for line in lines(figure) if line.get_linestyle() != "None"]
    assert len(points) == len(curves) == 4 and "as points" in figure.axes[0].get_title()
    for line, curve in zip(points, curves):
        np.testing.assert_allclose(np.sort(line.get_xdata()), np.degrees(degrees), atol=1e-4)
        # The material's own values lie on its curve.
        on_curve = np.interp(line.get_xdata(), curve.get_xdata(), np.log(curve.get_ydata()))
        np.testing.assert_allclose(np.log(line.get_ydata()), on_curve, atol=0.02)
        assert line.get_color() == curve.get_color()
    figure.savefig(tmp_path / "samples.png")
    # At angles of one's own only where samples are near.
    assert sum(line.get_linestyle() == "None" for line in lines(material.plot(table, [11, 20, 74]))) == 2
    far = srbf.table(wo, outside, np.ones((5, 5)), name="far")
    assert "no sample is near" in material.plot(far).axes[0].get_title()
    dotted = material.plot("model:lambert:albedo=0.5", [30])
    assert [line.get_linestyle() for line in lines(dotted)] == ["-", ":"]
    with pytest.raises(TypeError, match="a Table, or the path"):
        material.plot(3)


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


def test_a_blend_is_the_sum_of_its_parts():
    materials = [srbf.load(str(path)) for path in PRESETS[:3]]
    wo, wi, u = spread(300)
    weights = np.array([0.5, 0.3, 0.2], np.float32)
    tints = np.array([[1, 1, 1], [1, 0.5, 0.2], [0.1, 0.9, 1]], np.float32)
    blend = srbf.Blend(materials, weights, tints)
    want = sum(w * t * m.evaluate(wo, wi) for w, t, m in zip(weights, tints, materials))
    np.testing.assert_allclose(blend.evaluate(wo, wi), want, rtol=1e-4, atol=1e-5)
    np.testing.assert_allclose(blend.albedo(wo), sum(w * t * m.albedo(wo) for w, t, m in zip(weights, tints, materials)), rtol=1e-4)
    drawn = blend.sample(wo, u)
    value, pdf = blend.evaluate_and_pdf(wo, drawn.direction)
    np.testing.assert_allclose(pdf, drawn.pdf, rtol=5e-3)
    np.testing.assert_allclose(value, drawn.weight * drawn.pdf[:, None], rtol=5e-3, atol=1e-4)
    sample, other, density = blend.sample_and_evaluate(wo, u, wi)
    np.testing.assert_array_equal(sample.pdf, drawn.pdf)
    np.testing.assert_allclose(density, blend.pdf(wo, wi), rtol=1e-4, atol=1e-6)
    # One is its material, bit for bit.
    one = srbf.Blend(materials[:1], [1])
    np.testing.assert_array_equal(one.evaluate(wo, wi), materials[0].evaluate(wo, wi))
    np.testing.assert_array_equal(one.sample(wo, u).direction, materials[0].sample(wo, u).direction)
    # Hits that have weights of their own, of which some leave one part.
    each = np.random.default_rng(3).uniform(0, 1, (300, 3)).astype(np.float32)
    each[::3, 1:] = 0
    found = srbf.Blend(materials, each, tints).evaluate(wo, wi)
    np.testing.assert_allclose(found, sum(each[:, k, None] * tints[k] * m.evaluate(wo, wi) for k, m in enumerate(materials)), rtol=1e-4, atol=1e-5)
    # Below a coat less is seen.
    coated = srbf.Blend(materials[:1], [1], coats=[1.5])
    assert (coated.albedo(wo)[:, 1] <= materials[0].albedo(wo)[:, 1]).all()
    there, back = coated.evaluate(wo, wi)[:, 1], one.evaluate(wo, wi)[:, 1]
    assert (there <= back).all() and there.sum() > 0.5 * back.sum()
    for wrong in ([-1, 1, 1], [np.nan, 1, 1], [0, 0, 0], [1, 1, 2000]):
        with pytest.raises(ValueError, match="weights and tints"):
            srbf.Blend(materials, wrong)
    with pytest.raises(ValueError, match="1 to 8"):
        srbf.Blend([], [])
    with pytest.raises(ValueError, match="weights"):
        srbf.Blend(materials, [1, 2])
    with pytest.raises(ValueError, match=r"wo of shape \(5, 3\) .* weights and tints of shape \(300,\)"):
        srbf.Blend(materials, each).evaluate(wo[:5], wi[:5])


def test_gradients_of_a_blend_are_those_of_differences():
    materials = [srbf.load(str(path)) for path in PRESETS[:2]]
    wo, wi, _ = spread(50)
    weights, tints = np.array([0.6, 0.4], np.float32), np.array([[0.9, 0.5, 0.3], [0.2, 0.7, 1]], np.float32)
    by_weight, by_tint = srbf.Blend(materials, weights, tints, coats=[1, 1.3]).gradients(wo, wi)
    assert by_weight.shape == by_tint.shape == (50, 2, 3)
    value = lambda w, t: srbf.Blend(materials, w, t, coats=[1, 1.3]).evaluate(wo, wi).astype(np.float64)
    # Linear: a wide difference has no error but that of rounding.
    step = 0.125
    size = np.abs(value(weights, tints)).max(axis=1, keepdims=True) + 1e-6
    for k in range(2):
        more, less = weights.copy(), weights.copy()
        more[k], less[k] = more[k] + step, less[k] - step
        slope = (value(more, tints) - value(less, tints)) / (2 * step)
        assert (np.abs(by_weight[:, k] - slope) <= 1e-4 * size + 1e-4 * np.abs(slope)).all()
        for c in range(3):
            more, less = tints.copy(), tints.copy()
            more[k, c], less[k, c] = more[k, c] + step, less[k, c] - step
            slope = (value(weights, more) - value(weights, less)) / (2 * step)
            assert (np.abs(by_tint[:, k, c] - slope[:, c]) <= 1e-4 * size[:, 0] + 1e-4 * np.abs(slope[:, c])).all()
            assert not np.delete(slope, c, axis=1).any()
