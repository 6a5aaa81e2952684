"""What `srbf convert` writes, as other programs read it.

    python exports.py bsdf FILE.bsdf SAMPLES.csv READ.csv LOSS [AZIMUTH...]
    python exports.py merl FILE.binary SAMPLES.csv
    python exports.py spectral-samples OUT.csv
    python exports.py spectra FILE.bsdf

SAMPLES are those of `srbf convert` of the same input: the values themselves. READ are those of FILE.bsdf, as srbf reads it. `bsdf` opens the
file by Mitsuba's `measured`: its values, the variance of the weights of its draws, and its own chi-square test. `merl` looks cells up by the index that Matusik's published
reader computes (2003), written out here anew: half angle by the square root, difference angle and azimuth in degrees. `spectral-samples` writes
samples of a dull surface with a spectrum, and `spectra` looks that spectrum up in FILE.bsdf, by a spectral variant of Mitsuba. AZIMUTHs of the
viewer are for an anisotropic surface, in degrees."""

import csv
import sys

import numpy as np

# Largest relative L2 error of f cos over the samples of views up to 75 degrees: of what Mitsuba reads beside what srbf reads, and by the
# nearest cell of MERL. The loss between the 59 views of a .bsdf file, 1.5 degrees apart, depends on the material: LOSS.
VALUES = {"bsdf beside srbf": 1e-4, "merl": 0.2}
# Largest relative variance of the luminance of the weights, angle by angle in degrees.
VARIANCES = {2: 0.01, 6: 0.01, 15: 0.01, 35: 0.01, 60: 0.01, 75: 0.01}
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def samples(path):
    with open(path) as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    assert rows[0] == ["wi_x", "wi_y", "wi_z", "wo_x", "wo_y", "wo_z", "r", "g", "b"], rows[0]
    numbers = np.array(rows[1:], dtype=float)
    numbers = numbers[numbers[:, 5] > np.cos(np.radians(75))]
    return numbers[:, :3], numbers[:, 3:6], numbers[:, 6:]


def compare(kind, found, wi, f, most):
    truth = f * wi[:, 2:]
    error = np.sqrt(((found - truth) ** 2).sum() / (truth**2).sum())
    print(f"{kind}: {len(wi)} values of f cos, off by {100 * error:.4f} % (relative L2)")
    assert error < most, "too far off"


def bsdf(path, table, again, loss, *azimuths):
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    import drjit as dr

    material = mi.load_dict({"type": "measured", "filename": path})
    context = mi.BSDFContext()
    beside = "bsdf beside srbf"
    for kind, name, most in ("bsdf", table, float(loss)), (beside, again, VALUES[beside]):
        wi, wo, f = samples(name)
        # A viewer at azimuth 0 is where the file's half turn ends: which end Mitsuba takes is decided by rounding.
        inside = (np.abs(wo[:, 1]) > 1e-6) | (len(azimuths) == 0)
        wi, wo, f = wi[inside], wo[inside], f[inside]
        si = dr.zeros(mi.SurfaceInteraction3f, len(wi))
        # Mitsuba's wi is the viewer.
        si.wi = mi.Vector3f(wo.T.astype("f4"))
        found = np.array(material.eval(context, si, mi.Vector3f(wi.T.astype("f4"))))
        compare(kind, found if found.shape == f.shape else found.T, wi, f, most)

    n = 200000
    turns = [float(azimuth) for azimuth in azimuths] or [0.0]
    for degrees, most, turn in ((*of, turn) for of in VARIANCES.items() for turn in turns):
        theta, phi = np.radians(degrees), np.radians(turn)
        towards = [float(np.sin(theta) * np.cos(phi)), float(np.sin(theta) * np.sin(phi)), float(np.cos(theta))]
        si = dr.zeros(mi.SurfaceInteraction3f, n)
        si.wi = mi.Vector3f(*towards)
        random = np.random.default_rng(1)
        u, v = mi.Float(random.random(n).astype("f4")), mi.Point2f(random.random((2, n)).astype("f4"))
        drawn, weight = material.sample(context, si, u, v)
        weight = np.array(weight)
        weight = LUMINANCE @ (weight if weight.shape[0] == 3 else weight.T)
        variance = weight.var() / weight.mean() ** 2
        said, own = np.array(material.pdf(context, si, drawn.wo)), np.array(drawn.pdf)
        above = (own > 0) & (np.array(drawn.wo)[2] > 0)
        apart = np.abs(said[above] / own[above] - 1).max()
        print(f"bsdf: {degrees} degrees, azimuth {turn}: relative variance {variance:.4f}, densities apart {apart:.1e}")
        assert variance < most, "draws badly"

    for degrees, turn in ((degrees, turn) for degrees in (10, 50) for turn in turns):
        theta, phi = np.radians(degrees), np.radians(turn)
        direction = [float(np.sin(theta) * np.cos(phi)), float(np.sin(theta) * np.sin(phi)), float(np.cos(theta))]
        plugin = f'<bsdf type="measured"><string name="filename" value="{path}"/></bsdf>'
        sample, pdf = mi.chi2.BSDFAdapter("measured", f'<string name="filename" value="{path}"/>', wi=direction)
        test = mi.chi2.ChiSquareTest(mi.chi2.SphericalDomain(), sample, pdf, sample_dim=3, ires=16, res=201)
        passed = test.run()
        print(f"bsdf: chi-square at {degrees} degrees, azimuth {turn}: {'passes' if passed else test.messages}")
        assert passed, plugin


def merl(path, table):
    data = open(path, "rb").read()
    assert np.frombuffer(data[:12], "<i4").tolist() == [90, 90, 180]
    cells = np.frombuffer(data[12:], "<f8").reshape(3, 90, 90, 180)
    missing = (cells < 0).all(axis=0).mean()
    assert ((cells < 0).any(axis=0) == (cells < 0).all(axis=0)).all(), "a cell is measured in part"
    print(f"merl: {100 * missing:.1f} % of the cells are marked as not measured, those below the horizon among them")
    wi, wo, f = samples(table)
    half = wi + wo
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    theta, phi = np.arccos(np.clip(half[:, 2], -1, 1)), np.arctan2(half[:, 1], half[:, 0])
    # The incident direction, turned about the normal and then about the binormal until the half vector is the normal.
    x = wi[:, 0] * np.cos(phi) + wi[:, 1] * np.sin(phi)
    y = wi[:, 1] * np.cos(phi) - wi[:, 0] * np.sin(phi)
    across = x * np.cos(theta) - wi[:, 2] * np.sin(theta)
    along = x * np.sin(theta) + wi[:, 2] * np.cos(theta)
    difference, azimuth = np.arccos(np.clip(along, -1, 1)), np.arctan2(y, across) % np.pi
    index = (
        np.clip(np.sqrt(theta / (np.pi / 2)) * 90, 0, 89).astype(int),
        np.clip(difference / (np.pi / 2) * 90, 0, 89).astype(int),
        np.clip(azimuth / np.pi * 180, 0, 179).astype(int),
    )
    scale = np.array([1.0, 1.15, 1.66]) / 1500
    found = np.stack([cells[c][index] for c in range(3)], axis=1)
    kept = (found >= 0).all(axis=1)
    assert kept.mean() > 0.98, kept.mean()
    compare("merl", (found * scale * wi[:, 2:])[kept], wi[kept], f[kept], VALUES["merl"])


WAVELENGTHS = np.arange(400, 701, 10)


def spectrum(wavelengths):
    return 0.1 + 0.5 / (1 + np.exp(-(np.asarray(wavelengths) - 580) / 25))


def spectral_samples(path):
    angles = [(i, o, p) for i in (10, 35, 60) for o in range(5, 80, 10) for p in range(0, 181, 30)]
    values = ",".join(f"{v / np.pi:.6f}" for v in spectrum(WAVELENGTHS))
    with open(path, "w") as file:
        file.write("theta_i,theta_o,phi," + ",".join(f"{w}nm" for w in WAVELENGTHS) + "\n")
        file.writelines(f"{i},{o},{p},{values}\n" for i, o, p in angles)


def spectra(path):
    import mitsuba as mi

    mi.set_variant("llvm_ad_spectral")
    import drjit as dr

    material = mi.load_dict({"type": "measured", "filename": path})
    wavelengths = np.linspace(410, 690, 29, dtype="f4")
    si = dr.zeros(mi.SurfaceInteraction3f, len(wavelengths))
    si.wi = mi.Vector3f(0.3, 0.1, float(np.sqrt(0.9)))
    si.wavelengths = mi.Spectrum(mi.Float(wavelengths))
    wo = mi.Vector3f(-0.5, 0.2, float(np.sqrt(0.71)))
    found = np.array(material.eval(mi.BSDFContext(), si, wo))[0] * np.pi / np.sqrt(0.71)
    apart = np.abs(found / spectrum(wavelengths) - 1).max()
    print(f"bsdf: spectrum at {len(wavelengths)} wavelengths, off by {100 * apart:.2f} % at most")
    assert apart < 0.01, "spectra are off"


# Rings of Klems' patches: their ends in degrees, and how many patches each has.
RINGS = [(0, 5, 1), (5, 15, 8), (15, 25, 16), (25, 35, 20), (35, 45, 24), (45, 55, 24), (55, 65, 24), (65, 75, 16), (75, 90, 12)]
NAMES = {
    "Reflection Front": "Exterior Refl",
    "Reflection Back": "Interior Refl",
    "Transmission Front": "Ext->Int Trans",
    "Transmission Back": "Int->Ext Trans",
}


def radiance(path):
    """Radiance's own program reads the file, and finds the light that each matrix has; light both ways is the same."""
    import os
    import pathlib
    import re
    import subprocess
    from xml.etree import ElementTree

    import pyradiance

    home = pathlib.Path(pyradiance.__file__).parent
    environment = {**os.environ, "RAYPATH": str(home / "lib")}
    said = subprocess.run([home / "bin" / "checkBSDF", path], env=environment, capture_output=True, text=True, check=True).stdout
    print(said)
    areas = [np.pi * (np.sin(np.radians(b)) ** 2 - np.sin(np.radians(a)) ** 2) / n for a, b, n in RINGS for _ in range(n)]
    place = "{http://windows.lbl.gov}"
    found = 0
    for block in ElementTree.parse(path).iter(place + "WavelengthDataBlock"):
        name = block.find(place + "WavelengthDataDirection").text
        numbers = [float(v) for v in block.find(place + "ScatteringData").text.replace(",", " ").split()]
        most = 100 * (np.array(areas)[:, None] * np.array(numbers).reshape(145, 145)).sum(0).max()
        line = re.search(re.escape(NAMES[name]) + r"\s+[\d. ]+?\s+([\d.]+)%", said)
        assert line, f"{name} is missing"
        # A tenth of a per cent is printed, and the program adds up patches of its own.
        assert abs(float(line[1]) / most - 1) < 0.02, (name, line[1], most)
        found += 1
    assert found > 0
    errors = re.findall(r"(Interior Refl|Exterior Refl|Transmission)\t\s*([\d.]+)\t\s*([\d.]+)\t\s*([\d.]+)", said)
    print(f"xml: {found} matrices, their light found by checkBSDF; reciprocity errors {errors}")


{"bsdf": bsdf, "merl": merl, "radiance": radiance, "spectral-samples": spectral_samples, "spectra": spectra}[sys.argv[1]](*sys.argv[2:])
