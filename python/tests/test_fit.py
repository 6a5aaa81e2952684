import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import srbf_brdf as srbf
from conftest import QUICK, spread


def lobe(wo, wi):
    """A function of Python: a lobe round the half vector, and something diffuse."""
    h = [a + b for a, b in zip(wo, wi)]
    cos = h[2] / (h[0] ** 2 + h[1] ** 2 + h[2] ** 2) ** 0.5
    value = 0.1 + 0.5 * cos**20
    return (value, 0.8 * value, 0.6 * value)


def test_a_path_a_table_and_its_arrays_are_one_measurement(tmp_path):
    made = srbf.fit("model:ggx:alpha=0.3,f0=0.8", lobes=4, **QUICK)
    table = srbf.read("model:ggx:alpha=0.3,f0=0.8")
    assert srbf.fit(table, lobes=4, **QUICK) == made
    assert table.is_evaluable and table.symmetry == "isotropic" and "model" in repr(table) or table.name
    assert made.report["lobes"] == 4 and any("relative L2" in line for line in made.verdict)
    comparison = made.compare(table)
    assert str(comparison).count("\n") == len(comparison.verdict) - 1 > 3
    assert made.compare("model:ggx:alpha=0.3,f0=0.8").report == comparison.report


def test_a_look_names_what_is_wrong(tmp_path):
    wo, wi, f = samples()
    f = np.array(f, dtype=float)
    spoiled = f.copy()
    # Far from the highlight, where neighbours say what is right.
    number = int(np.argmax(np.linalg.norm(wi - wo, axis=1) * (wi[:, 2] > 0.3)))
    spoiled[number] *= 40
    good, bad, quick = srbf.table(wo, wi, f).look(), srbf.table(wo, wi, spoiled).look(), srbf.table(wo, wi, spoiled).look(quick=True)
    assert "samples" in good[0] and not any("check" in line for line in good)
    assert [line for line in bad if "check" in line] and not any("check" in line for line in quick)
    assert srbf.read("model:ggx:alpha=0.3,f0=0.8").look() == []


def samples(n=300):
    random = np.random.default_rng(3)
    wo, wi = [], []
    for degrees in (10, 25, 40, 55, 70):
        t = np.radians(degrees)
        z = np.sqrt(0.02 + 0.98 * random.random(n))
        phi = 2 * np.pi * random.random(n)
        r = np.sqrt(1 - z * z)
        wi.append(np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=1))
        wo.append(np.tile([-np.sin(t), 0, np.cos(t)], (n, 1)))
    wo, wi = np.concatenate(wo), np.concatenate(wi)
    return wo, wi, np.array([lobe(o, i) for o, i in zip(wo, wi)])


def test_arrays_of_samples():
    wo, wi, f = samples(60)
    table = srbf.table(wo, wi, f, name="mine")
    assert not table.is_evaluable and table.name == "mine" and "300 samples" in repr(table)
    assert table.left_out == ""
    held = table.samples()
    assert held["f"].shape == (300, 3) and held["weight"].min() > 0
    np.testing.assert_allclose(np.sort(held["f"][:, 0]), np.sort(f[:, 0]))
    with pytest.raises(ValueError, match="no value in between"):
        table.evaluate([0, 0, 1], [0, 0, 1])
    made = srbf.fit((wo, wi, f), lobes=3, **dict(QUICK, views=None))
    value = made.evaluate(wo, wi)
    want = f * wi[:, 2:]
    assert np.linalg.norm(value - want) < 0.3 * np.linalg.norm(want)
    grey = srbf.table(wo, wi, f[:, 0])
    assert np.array_equal(grey.samples()["f"][:, 0], grey.samples()["f"][:, 2])


def test_a_grid_of_samples_needs_no_repeated_directions():
    """Five viewers, twelve lights each."""
    wo, wi, f = (a.reshape(5, 12, 3) for a in samples(12))
    viewers, lights = wo[:, :1], wi[0]
    grid = np.array([[lobe(o[0], i) for i in lights] for o in viewers])
    repeated = srbf.table(wo.reshape(-1, 3), np.tile(lights, (5, 1)), grid.reshape(-1, 3))
    for values in (grid, grid[..., :1]):
        table = srbf.table(viewers, lights, values)
        assert "60 samples at 5" in repr(table)
        np.testing.assert_array_equal(table.samples()["wi"], repeated.samples()["wi"])
        np.testing.assert_array_equal(table.samples()["f"][:, 0], repeated.samples()["f"][:, 0])


@pytest.mark.parametrize(
    "change, text",
    [
        (lambda wo, wi, f: (wo[:-1], wi, f), r"wo of shape \(14, 3\) and wi of shape \(15, 3\)"),
        (lambda wo, wi, f: (wo, wi, f[:, :2]), r"f of shape \(15, 2\), .*: f of shape \(15,\) or \(15, 3\)"),
        (lambda wo, wi, f: (wo, -wi, f), "behind.*lines 2, 3, 4"),
        (lambda wo, wi, f: (wo, wi, f * np.nan), "number.*lines 2, 3, 4"),
        (lambda wo, wi, f: (wo, np.concatenate([wi[:1] * [1, 1, -1], wi[1:]]), f), "behind.*line 2"),
        (lambda wo, wi, f: (wo[:0], wi[:0], f[:0]), r"f of shape \(0, 3\).*a sample at least"),
    ],
)
def test_arrays_that_are_no_samples_are_named(change, text):
    with pytest.raises(ValueError, match=text):
        srbf.table(*change(*samples(3)))


def test_what_was_not_measured_is_left_out():
    wo, wi, f = samples(20)
    f[3] = np.nan
    for values in [f, np.ma.masked_invalid(f), np.ma.masked_invalid(f[:, 0])]:
        table = srbf.table(wo, wi, values)
        assert len(table.samples()["f"]) == len(f) - 1 and "1 row without a number (line 5)" in table.left_out


def test_channels_first_are_refused_whatever_their_count():
    wo, wi, f = samples(90)
    with pytest.raises(ValueError, match=r"f of shape \(3, 450\)"):
        srbf.table(wo, wi, np.ascontiguousarray(f.T))


def test_a_function_of_python():
    made = srbf.fit(lobe, lobes=2, **dict(QUICK, views=2, factors="none", starts=1, steps=2))
    wo, wi, _ = spread(200)
    want = np.array([lobe(o, i) for o, i in zip(wo.astype(float), wi.astype(float))]) * wi[:, 2:]
    assert np.linalg.norm(made.evaluate(wo, wi) - want) < 0.3 * np.linalg.norm(want)
    assert made.provenance.startswith("a function of Python")


def test_an_exception_of_the_function_ends_the_fit():
    calls = []

    def fails(wo, wi):
        calls.append(1)
        if len(calls) > 100:
            raise ZeroDivisionError("from within")
        return 0.3

    with pytest.raises(ZeroDivisionError, match="from within"):
        srbf.fit(fails, **QUICK)
    with pytest.raises((TypeError, ValueError)):
        srbf.fit(lambda wo, wi: "bright", **QUICK)


def test_progress_is_shown_and_rises():
    seen = []
    srbf.fit("model:ggx:alpha=0.1,f0=0.9", lobes=4, starts=2, steps=8, exchanges=0, views=4, progress=seen.append)
    assert len(seen) > 2 and seen == sorted(seen) and seen[0] >= 0 and seen[-1] == 1


def test_a_bar_moves_and_never_back(capsys):
    from srbf_brdf.progress import Terminal, show

    seen = []
    function = show(seen.append)
    for share in (0.2, 0.5, 0.4, 1.0):
        function.update(share)
    assert seen == [0.2, 0.5, 0.5, 1.0]
    bar = Terminal()
    for share in (0.0, 0.25, 0.25, 0.2, 0.75):
        bar.start -= 1
        bar.update(share)
    shown = capsys.readouterr().err.split("\r")[1:]
    assert len(set(shown)) == 5 and [text.count("=") for text in shown] == [0, 10, 10, 10, 30] and "s left" in shown[-1]
    bar.close()
    assert not capsys.readouterr().err.strip()


def test_an_exception_of_the_progress_ends_the_fit():
    def stop(share):
        raise RuntimeError("enough")

    start = time.monotonic()
    with pytest.raises(RuntimeError, match="enough"):
        srbf.fit("model:ggx:alpha=0.05,f0=0.9", progress=stop)
    assert time.monotonic() - start < 2


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_an_interruption_ends_the_fit():
    # A shell gives programs in the background no interruption.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        srbf.fit("model:ggx:alpha=0.05,f0=0.9", progress=False)
    assert time.monotonic() - start < 2


def test_a_bar_is_drawn_where_it_is_asked_for():
    code = "import srbf_brdf as s; s.fit('model:ggx:alpha=0.1,f0=0.9', lobes=2, starts=1, steps=4, exchanges=0, views=4, progress=%s)"
    run = lambda how: subprocess.run([sys.executable, "-c", code % how], stderr=subprocess.PIPE, check=True).stderr
    assert b"\rfit [" in run("True")
    assert run("None") == b"" and run("False") == b""


@pytest.mark.parametrize(
    "settings, text",
    [
        (dict(lobes=65), "lobes: from 1 to 64"),
        (dict(factors="many"), "factors"),
        (dict(factors=(1, 50)), "factors"),
        (dict(views=1), "views"),
        (dict(error=-1.0), "error"),
        (dict(error=float("nan")), "error"),
        (dict(smoothness=float("nan")), "smoothness"),
        (dict(steps=0), "steps"),
        (dict(squeezed=99), "squeezed"),
        (dict(mirrored=99), "mirrored"),
        (dict(symmetry="x"), 'symmetry: one of "isotropic", "quadrant", "half turn", "none" is expected, not "x"'),
        (dict(symmetry="none"), 'symmetry: that of this source is "isotropic"'),
        (dict(progress="no"), "progress: True, False or a function is expected, not 'no'"),
    ],
)
def test_settings_out_of_range_are_named(settings, text):
    with pytest.raises(ValueError, match=text):
        srbf.fit("model:lambert:albedo=0.5", **settings)
    if "symmetry" in settings and settings["symmetry"] == "x":
        with pytest.raises(ValueError, match=text):
            srbf.fit(lobe, **settings)


@pytest.mark.parametrize("angles", [[95.0], [-1.0], [float("nan")], [float("inf")], []])
def test_angles_that_are_none_are_refused(angles):
    table = srbf.read("model:lambert:albedo=0.5")
    with pytest.raises(ValueError, match="degrees|view"):
        table.samples(angles)
    with pytest.raises(ValueError, match="degrees|view"):
        srbf.fit(table, lobes=1, **QUICK).compare(table, angles)


def test_names_of_a_stranger_are_spelled_out():
    table = srbf.table(*samples(20), name="a\x1b[31m\u202eb\n")
    assert table.name == "a\x1b[31m\u202eb\n"
    assert repr(table).isprintable() and "a\\u{1b}[31m\\u{202e}b\\u{a}" in repr(table)
    for call in (lambda path: srbf.load(path), lambda path: srbf.read(path)):
        with pytest.raises((OSError, ValueError)) as caught:
            call("/tmp/no\x1b[31m\n")
        assert "\x1b" not in str(caught.value)


@pytest.mark.parametrize(
    "source, kind, text",
    [
        ("nothing.binary", FileNotFoundError, "nothing.binary"),
        ("model:nothing", srbf.FitError, "nothing"),
        (3, TypeError, "path"),
        ({"wo": 1}, ValueError, "tuple"),
        (("a", "b", "c"), ValueError, "wo"),
    ],
)
def test_sources_that_are_none_are_named(source, kind, text):
    with pytest.raises(kind, match=text):
        srbf.fit(source, progress=False)


def test_a_broken_file_is_named_with_its_place(tmp_path):
    path = tmp_path / "a.binary"
    path.write_bytes(b"\0" * 40)
    with pytest.raises(srbf.FitError, match="a.binary"):
        srbf.read(path)


def test_factors_by_their_nodes():
    model = "model:ggx:alpha=0.3,f0=0.9,diffuse=0.1"
    signed = srbf.fit(model, lobes=3, factors="8x4x3s", **QUICK)
    assert signed.has_signed_factors and "8 x 4 x 3 signed factors" in repr(signed)
    assert not srbf.fit(model, lobes=3, factors=(8, 4, 3), **QUICK).has_signed_factors
    with pytest.raises(ValueError, match="24x6x5s"):
        srbf.fit(model, lobes=3, factors="many", **QUICK)


def test_a_sheet_is_fitted(tmp_path):
    through = srbf.read("model:ground-glass:alpha=0.4,ior=1.5,behind=0")
    rows = ["wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,value"]
    wo, wi, _ = spread(300)
    keep = (wo[:, 2] > 0.2) & (wi[:, 2] > 0.2)
    # Light from behind, as a viewer in front sees it.
    for o, i, value in zip(wo[keep], wi[keep], through.evaluate(wo[keep], wi[keep])[:, 1] / wi[keep][:, 2]):
        rows.append(f"{i[0]},{i[1]},{-i[2]},{o[0]},{o[1]},{o[2]},{value}")
    path = tmp_path / "glass.csv"
    path.write_text("\n".join(rows))
    shares = []
    sheet = srbf.fit_sheet(path, lobes=4, views=4, starts=1, steps=8, exchanges=0, progress=shares.append)
    assert sheet.quarter("front_reflection") is None and sheet.quarter("front_transmission") is not None
    assert shares and sheet.report["bytes"] == len(sheet.to_bytes()) and "glass.csv" in sheet.provenance
    assert srbf.Sheet.from_bytes(sheet.to_bytes()).report == {}
    with pytest.raises(ValueError, match="band"):
        srbf.fit_sheet(path, band="")
    with pytest.raises(ValueError, match="a model is no sheet"):
        srbf.fit_sheet("model:ggx:alpha=0.2")
