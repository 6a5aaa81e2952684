"""Compiles the BSDF of Mitsuba's scalar variants in C++, so that no hit calls Python: `python -m srbf_brdf.scalar`.

It needs a C++ compiler, g++ or the one that CXX names, and `pip install nanobind`; Mitsuba's own package brings the other headers. The plugin lies beside
this file, and serves the version of Mitsuba that it is compiled for. `srbf_brdf.mitsuba.register()` takes it where it is there.
"""

from __future__ import annotations

import importlib.util
import os
import pathlib
import platform
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).parent
# Its arrays of three numbers have four places where SSE 4.2 is allowed, as it is in Mitsuba's package.
FLAGS = ["-std=c++17", "-O2", "-fPIC", "-shared", "-fvisibility=hidden", "-fno-strict-aliasing", "-w"]
CHECK = """
import sys, mitsuba as mi, drjit as dr, srbf_brdf as srbf
mi.set_variant("scalar_rgb")
mi.file_resolver().append(sys.argv[1])
bsdf, material = mi.load_dict({"type": sys.argv[2], "filename": sys.argv[3]}), srbf.load(sys.argv[3])
for wo, wi in ([0.6, 0, 0.8], [-0.6, 0, 0.8]), ([0, 0.28, 0.96], [0.36, 0.48, 0.8]):
    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi = mi.Vector3f(wo)
    got, want = bsdf.eval_pdf(mi.BSDFContext(), si, mi.Vector3f(wi)), material.evaluate_and_pdf(wo, wi)
    assert all(abs(a - b) <= 1e-3 * abs(b) + 1e-4 for a, b in zip([*got[0], got[1]], [*want[0], want[1]])), (got, want)
"""


class BuildError(RuntimeError):
    """The plugin cannot be compiled here; the message names the part that is missing."""


def name() -> str:
    """The plugin's name, which has Mitsuba's version."""
    import mitsuba as mi

    return "srbf_scalar_" + mi.__version__.replace(".", "_")


def is_built() -> bool:
    """Whether it is there for this version of Mitsuba."""
    return (HERE / "plugins" / f"{name()}.so").exists()


def _folder(package: str) -> pathlib.Path:
    found = importlib.util.find_spec(package)
    if found is None or found.origin is None:
        raise BuildError(f"the headers of {package} are missing: pip install {package}")
    return pathlib.Path(found.origin).parent


def build() -> pathlib.Path:
    """Compiles the plugin, checks in a process of its own that it has the library's values, and returns its path."""
    from . import Material, _native, fit

    if sys.platform != "linux":
        raise BuildError("the plugin is compiled on Linux alone; other systems call Python at each hit")
    mitsuba, drjit, nanobind = map(_folder, ("mitsuba", "drjit", "nanobind"))
    includes = [mitsuba / "include", drjit / "include", nanobind / "include", nanobind / "ext/robin_map/include"]
    libraries = [mitsuba / "libmitsuba.so", drjit / "libdrjit-core.so"]
    machine = ["-msse4.2"] if platform.machine() == "x86_64" else []
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder)
        (place / "plugins").mkdir()
        (place / "srbf_device.hpp").write_text(_native._DEVICE_HEADER)
        made = place / "plugins" / f"{name()}.so"
        words = [os.environ.get("CXX", "g++"), *FLAGS, *machine, *(f"-I{path}" for path in [place, *includes])]
        words += [str(HERE / "scalar.cpp"), "-o", str(made), *map(str, libraries)]
        try:
            done = subprocess.run(words, capture_output=True, text=True)
        except OSError as error:
            raise BuildError(f"{words[0]}: {error.strerror}; a C++ compiler is needed, and CXX may name one") from error
        if done.returncode != 0:
            raise BuildError(f"{words[0]} fails:\n{done.stderr}")
        quick = fit("model:ggx:alpha=0.3,f0=0.9/0.5/0.1", lobes=3, starts=1, steps=2, exchanges=0, views=3, progress=False)
        quick.save(place / "check.srbf")
        # Another layout of Mitsuba's classes would end this process.
        words = [sys.executable, "-c", CHECK, folder, name(), str(place / "check.srbf")]
        done = subprocess.run(words, capture_output=True, text=True, env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)})
        if done.returncode != 0:
            raise BuildError(f"the plugin does not fit this Mitsuba: it is left out\n{done.stderr[-2000:]}")
        kept = HERE / "plugins" / made.name
        try:
            kept.parent.mkdir(exist_ok=True)
            (kept.parent / f".{made.name}").write_bytes(made.read_bytes())
            os.replace(kept.parent / f".{made.name}", kept)
        except OSError as error:
            raise BuildError(f"{kept}: {error.strerror}") from error
    return kept


def open_plugin(mi) -> None:
    """Loads the plugin into Mitsuba, before a scene: while one is read, other threads look through the paths, which may not grow."""
    resolver = mi.file_resolver()
    resolver.append(str(HERE))
    try:
        kind = mi.PluginManager.instance().plugin_type(name())
    finally:
        del resolver[len(resolver) - 1]
    if kind != mi.ObjectType.BSDF:
        raise RuntimeError(f"{HERE / 'plugins' / name()}.so: a plugin of a BSDF is expected; `python -m srbf_brdf.scalar` compiles it")


def load(mi, content, **parameters):
    """The compiled BSDF of a material or a sheet, with its other parameters; `open_plugin` has loaded the plugin."""
    from . import _native

    with tempfile.TemporaryDirectory() as folder:
        # The file that was loaded may be packed.
        path = pathlib.Path(folder, "plain.srbf")
        path.write_bytes(_native._plain_bytes(content.to_bytes()))
        return mi.load_dict({"type": name(), "filename": str(path), **parameters})


if __name__ == "__main__":
    try:
        print(build())
    except BuildError as error:
        sys.exit(f"srbf_brdf.scalar: {error}")
