#!/usr/bin/env python3
"""One table of every form of the library beside Rust's scalar level: the same random materials, pairs of directions and uniform numbers.

    cargo build --release --workspace --lib --bins --examples
    python3 lab/differential.py FOLDER [--count 280] [--seed 1] > docs/figures/differential.csv

`materials` of srbf-tests writes the materials into FOLDER, and each has 4096 pairs. Forms are processes with the protocol of
evaluator/examples/reference.rs. All need g++, by whose program the power of a material is known, and C needs gcc. Python and shaders are asked by
the interpreter itself, which needs the package, and wgpu beside glslangValidator: those of .ci/checks/35-python and 56-evaluator. The module for
WebAssembly is that of .ci/checks/74-npm. A form whose tools are missing says NOT RUN. Rows are the worst of each kind of material, and the exit
status is 1 if one is above its form's bound.
"""

import argparse
import csv
import os
import shutil
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
N = 4096
NAMES = ["value", "density", "direction", "density there", "weight", "albedo"]
# Farther apart, two draws are of different lobes, or of different ends of the same.
APART = 2e-4
TINTS = [[0.7, 0.7, 0.7], [0.3, 0.24, 0.18]]


def pairs(random, is_sheet):
    """Nine rows of N numbers. Half of the incident directions are near the mirror direction, as near as 1e-4."""
    z = 0.02 + 0.98 * random.random((2, N))
    phi = 2 * np.pi * random.random((2, N))
    wo, wi = np.stack([np.sqrt(1 - z * z) * np.cos(phi), np.sqrt(1 - z * z) * np.sin(phi), z], axis=1)
    width = 10 ** random.uniform(-4, -0.5, N)
    near = [[-1], [-1], [1]] * wo + width * random.normal(size=(3, N))
    near[2] = np.abs(near[2])
    wi = np.where(np.arange(N) % 2 == 0, wi, near / np.linalg.norm(near, axis=0))
    if is_sheet:
        wo[2] *= np.where(np.arange(N) // 2 % 2 == 0, 1, -1)
        wi[2] *= np.where(np.arange(N) // 4 % 2 == 0, 1, -1)
    u = random.integers(0, 1 << 24, (3, N)) / (1 << 24)
    return np.ascontiguousarray(np.concatenate([wo, wi, u]), dtype="<f4")


def errors(got, want, power, left_out):
    """The worst of each quantity; the same of values and densities but for a density that may be left out; how many draws went elsewhere.

    A value is relative to its largest channel, or to density times power where that is larger: the power is that of the lobes. Where the power
    is below 2^-100 nothing is compared: there a lobe may be 0 in one form.
    """
    got, want = np.float64(got), np.float64(want)
    far = lambda rows: np.max(np.abs(got[rows] - want[rows]), axis=0)
    most = lambda rows: np.max(np.abs(want[rows]), axis=0)
    tiny = np.finfo(np.float32).tiny
    lit = power >= 2.0**-100
    same = lit & (far(slice(4, 7)) <= APART)
    found = {
        "value": lit * far(slice(0, 3)) / np.maximum(np.maximum(most(slice(0, 3)), want[3] * power), tiny),
        "density": lit * far(slice(3, 4)) / np.maximum(want[3], tiny),
        "direction": far(slice(4, 7)) * same,
        "density there": far(slice(7, 8)) / np.maximum(want[7], tiny) * same,
        "weight": far(slice(8, 11)) / np.maximum(np.maximum(most(slice(8, 11)), power), tiny) * same,
        "albedo": lit * far(slice(11, 14)) / np.maximum(np.maximum(most(slice(11, 14)), power), tiny),
    }
    over = found | {
        "value": found["value"] * np.clip(1 - left_out * power / np.maximum(far(slice(0, 3)), tiny), 0, 1),
        "density": found["density"] * np.clip(1 - left_out / np.maximum(far(slice(3, 4)), tiny), 0, 1),
    }
    worst = lambda each: {name: float(np.max(np.where(np.isfinite(error), error, np.inf))) for name, error in each.items()}
    return worst(found), worst(over), int(np.sum(lit & ~same))


def program(command, given, **environment):
    """Asks a program for one material."""
    run = subprocess.run(command, input=given.tobytes(), stdout=subprocess.PIPE, check=True, env={**os.environ, **environment})
    return np.frombuffer(run.stdout, "<f4").reshape(14, N)


def content(kind):
    """Whose functions answer for a kind of material."""
    return kind if kind in ("sheet", "blend") else "material"


def rust(level):
    flag = {"avx2": "avx2", "avx512": "avx512vl"}.get(level)
    if flag and flag not in Path("/proc/cpuinfo").read_text():
        raise RuntimeError(f"the processor has no {level}")
    reference = TARGET / "release/examples/reference"
    return lambda path, kind, given: program([reference, path, *(["blend"] if kind == "blend" else [])], given, SRBF_LEVEL=level)


def truth():
    """Value and density by the oracle, and the draws of the scalar level."""
    scalar = rust("scalar")

    def ask(path, kind, given):
        run = subprocess.run([TARGET / "release/truth", path], input=given.tobytes(), stdout=subprocess.PIPE, check=True, env={**os.environ, "SRBF_LEVEL": "scalar"})
        return np.concatenate([np.frombuffer(run.stdout, "<f4").reshape(4, N), scalar(path, kind, given)[4:]])

    return ask


def compiled(compiler, source, name, place):
    """A program of the C interface."""
    system = ["-lutil", "-lrt", "-lpthread", "-lm", "-ldl"]
    command = [*compiler, "-O2", f"-I{ROOT}/include", f"-I{ROOT}/tests/c", ROOT / source, TARGET / "release/libsrbf.a", *system]
    subprocess.run([*command, "-o", place / name], check=True)
    return lambda path, kind, given: program([place / name, path, content(kind)], given)


def text(language, options, place):
    """The text in a program of evaluator/tests/values.cpp, which has a protocol of its own."""
    folder = place / language
    folder.mkdir(exist_ok=True)
    words = subprocess.run([TARGET / "release/write", language, "blend"], stdout=subprocess.PIPE, check=True).stdout
    (folder / "text").write_bytes(words)
    subprocess.run(["g++", "-std=c++17", "-O2", *options, f"-I{folder}", ROOT / "evaluator/tests/values.cpp", "-o", folder / "values"], check=True)

    def ask(path, kind, given):
        words = plain(path)
        sent = struct.pack("<I", len(words)) + words + struct.pack("<I", N) + given.tobytes()
        command = [folder / "values", *(["blend"] if kind == "blend" else [])]
        out = subprocess.run(command, input=sent, stdout=subprocess.PIPE, check=True).stdout
        if out[:4] != bytes(4):
            raise RuntimeError(f"{path}: word {struct.unpack('<i', out[:4])} is wrong")
        return np.frombuffer(out[4:], "<f4").reshape(18, N)[:15]

    return ask


def plain(path):
    """The bytes of a material in plain numbers, which the text reads."""
    beside = path.with_suffix(".plain")
    return (beside if beside.exists() else path).read_bytes()


def python():
    import srbf_brdf

    def ask(path, kind, given):
        wo, wi, u = (given[i : i + 3].T for i in (0, 3, 6))
        surface = srbf_brdf.Material.load(path) if content(kind) == "material" else srbf_brdf.Sheet.load(path)
        if kind == "blend":
            surface = srbf_brdf.Blend([surface.quarter(name) for name in ("front_reflection", "front_transmission")], [1, 1], TINTS)
        drawn, value, pdf = surface.sample_and_evaluate(wo, u, wi)
        if kind == "sheet":
            albedo = np.where((wo[:, 2:] < 0) == (wi[:, 2:] < 0), *surface.albedos(wo))
        else:
            albedo = surface.albedo(wo)
        return np.concatenate([value.T, pdf[None], drawn.direction.T, drawn.pdf[None], drawn.weight.T, albedo.T])

    return ask


def wasm(level):
    folder = TARGET / "npm/empty"
    if not (folder / "node_modules/srbf-wasm").exists():
        raise RuntimeError("no srbf-wasm is installed")
    shutil.copy(ROOT / "wasm/check/rows.mjs", folder)
    return lambda path, kind, given: program(["node", folder / "rows.mjs", level, path], given)


def shaders(place):
    """One function a language; they share a device."""
    sys.path.insert(0, str(ROOT / "evaluator/check"))
    from shaders import Shaders

    found = Shaders(TARGET / "release/write", place)
    made = {kind: found.pipelines(hit, text) for kind, hit, text in [("material", "material", None), ("sheet", "sheet", None), ("blend", "front", "blend")]}

    def of(language):
        def ask(path, kind, given):
            words = plain(path)
            rows = found.ask(made[content(kind)][language], words + bytes(-len(words) % 4), given).T
            return rows[[*range(11), 12, 13, 14]]

        return ask

    return of


def bound(*numbers):
    return dict(zip(NAMES, numbers))


# The bounds are those of the tests of each form: tests/tests/verbs.rs, wasm/check/values.mjs, evaluator/tests/text/values.rs. The second of
# these compares no densities of draws, and has those of the levels. Those of directions are APART: next to the end of a wide lobe that is
# opposite to its axis, rounding turns a draw by up to that.
LEVEL = bound(2e-5, 2e-5, APART, 4e-4, 1e-4, 2e-5)
WASM = bound(5e-6, 5e-6, APART, 4e-4, 5e-5, 2e-6)
# Frames of anisotropic materials are rounded otherwise in vectors, and no material of values.mjs is anisotropic.
SIMD128 = {**WASM, "value": 2e-5, "density": 2e-5}
TEXT = bound(3e-4, 3e-4, APART, 5e-4, 5e-4, 3e-4)
# They are for lobes of at most this sharpness, and grow with the root of the sharpness beyond: an axis that is turned by rounding changes
# a value of exponent t by the root of 2 s t times the angle.
SHARP = 4096


def growth(name, sharpness):
    return max(1.0, sharpness / SHARP) ** 0.5 if name in ("value", "density", "density there", "weight") else 1.0


def forms(place):
    """Name, bounds, kinds that it does not have, and the maker of the function that asks."""
    cpp = [f"-I{ROOT}/evaluator/tests/metal", "-D__METAL__", "-Wno-unused-function"]
    once = []

    def shader(language):
        if not once:
            once.append(shaders(place))
        return once[0](language)

    return [
        ("f64 of the same mixtures", LEVEL, ("sheet", "blend", "ends"), truth),
        ("Rust, portable", LEVEL, (), lambda: rust("portable")),
        ("Rust, AVX2", LEVEL, (), lambda: rust("avx2")),
        ("Rust, AVX-512", LEVEL, (), lambda: rust("avx512")),
        ("C", LEVEL, (), lambda: compiled(["gcc", "-std=c11"], "tests/c/pairs.c", "pairs", place)),
        ("C++ wrapper, hit by hit", LEVEL, (), lambda: compiled(["g++", "-std=c++17"], "tests/c/pairs.cpp", "wrapper", place)),
        ("Python", LEVEL, (), python),
        ("wasm, scalar", WASM, ("blend",), lambda: wasm("scalar")),
        ("wasm, simd128", SIMD128, ("blend",), lambda: wasm("simd128")),
        ("C++ header", TEXT, (), lambda: text("cpp", [], place)),
        ("Metal, as C++", TEXT, (), lambda: text("metal", cpp, place)),
        *((f"{language.upper()}, lavapipe", TEXT, (), lambda language=language: shader(language)) for language in ("glsl", "wgsl", "hlsl")),
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--count", type=int, default=280, help="materials")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="forms whose name has this word")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    for old in [*options.folder.glob("*.srbf"), *options.folder.glob("*.plain")]:
        old.unlink()
    made = subprocess.run([TARGET / "release/materials", options.folder, str(options.count), str(options.seed)], stdout=subprocess.PIPE, check=True, text=True)
    sharpest = {name: float(sharpness) for name, sharpness in csv.reader(made.stdout.splitlines())}
    os.environ.setdefault("LP_NUM_THREADS", "2")
    base, header, asked, random = rust("scalar"), text("cpp", [], options.folder), [], np.random.default_rng(options.seed)
    for name in sharpest:
        path, kind = options.folder / f"{name}.srbf", name.split("-", 1)[1]
        given = pairs(random, kind == "sheet")
        asked.append((path, kind, given, base(path, kind, given), header(path, kind, given)[14]))
    out = csv.writer(sys.stdout, lineterminator="\n")
    out.writerow(["form", "kind", "materials", "pairs", *NAMES, "elsewhere", "of the bound", "worst material"])
    failed = False
    for name, limits, without, make in forms(options.folder):
        if options.only not in name:
            continue
        out.writerow([name, "bound", "", "", *(f"{limit:.0e}" for limit in limits.values())])
        try:
            ask = make()
        except (ImportError, OSError, RuntimeError, subprocess.CalledProcessError) as error:
            out.writerow([name, f"NOT RUN: {error}"])
            continue
        kinds = {}
        for path, kind, given, want, power in asked:
            if kind in without:
                continue
            # WebAssembly asks mixtures, which leave out folds of at most 1e-7 of a lobe: of its peak, which has at most its sharpness.
            left_out = 1e-7 * sharpest[path.stem] if name.startswith("wasm") else 0.0
            found, over, elsewhere = errors(ask(path, kind, given), want, power, left_out)
            row = kinds.setdefault(kind, {"count": 0, "elsewhere": 0, "share": 0.0, "at": "", "worst": dict.fromkeys(NAMES, 0.0)})
            share = max(over[key] / (limit * growth(key, sharpest[path.stem])) for key, limit in limits.items())
            # Two draws of a material may be of another lobe.
            share = max(share, elsewhere / 2 if elsewhere > 2 else 0)
            if share >= row["share"]:
                row["share"], row["at"] = share, path.stem
            row["count"] += 1
            row["elsewhere"] += elsewhere
            row["worst"] = {key: max(error, found[key]) for key, error in row["worst"].items()}
        for kind, row in kinds.items():
            worst = (f"{error:.1e}" for error in row["worst"].values())
            # At the ends of the format's ranges no bound is stated.
            is_bound = kind != "ends"
            failed |= is_bound and row["share"] > 1
            share = f"{row['share']:.2f}" if is_bound else "none"
            out.writerow([name, kind, row["count"], N * row["count"], *worst, row["elsewhere"], share, row["at"]])
        sys.stdout.flush()
    sys.exit(failed)


if __name__ == "__main__":
    main()
