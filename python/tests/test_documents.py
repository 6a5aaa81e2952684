"""The programs of docs/use-from-python.md and docs/use-from-mitsuba.md, as they stand there."""

import os
import pathlib
import re
import subprocess
import sys

import pytest

import srbf_brdf as srbf
from conftest import PRESETS, ROOT

PAGES = [ROOT / "docs/use-from-python.md", ROOT / "docs/use-from-mitsuba.md"]
DATA = os.environ.get("SRBF_DATA_DIR")


def blocks():
    return [block for page in PAGES for block in re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL)]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder to run in, with the measurement where it is at hand, and a preset."""
    monkeypatch.chdir(tmp_path)
    if DATA:
        (tmp_path / "garnet_red.brdf").symlink_to(pathlib.Path(DATA).resolve() / "cornell/garnet_red.brdf")
    preset = next(p for p in PRESETS if p.stem == "garnet_red")
    (tmp_path / "garnet_red.srbf").write_bytes(preset.read_bytes())
    return tmp_path


def test_the_pages_have_a_program_each():
    assert ["srbf.fit(" in block for block in blocks()] == [True, False]


@pytest.mark.skipif(not DATA, reason="needs the measured garnet red: SRBF_DATA_DIR")
def test_from_a_measured_file_to_samples(folder, capsys):
    pytest.importorskip("matplotlib")
    (folder / "garnet_red.srbf").unlink()
    names = {}
    exec(blocks()[0], names)
    assert srbf.load("garnet_red.srbf").to_bytes() == names["material"].to_bytes()
    assert (folder / "garnet_red.png").read_bytes().startswith(b"\x89PNG")
    assert names["value"].shape == (1000, 3) and "good" in capsys.readouterr().out


def test_a_material_in_mitsuba(folder):
    pytest.importorskip("mitsuba")
    # In a process of its own, as one cannot hold two of Mitsuba's variants; the scalar one needs no LLVM. It calls Python at each hit, so that
    # its picture is small.
    small = '"fov": 35, "film": {"type": "hdrfilm", "width": 64, "height": 48},'
    program = blocks()[1].replace("llvm_ad_rgb", "scalar_rgb").replace('"fov": 35,', small)
    assert small in program
    program += "\nassert isinstance(bsdf, mi.BSDF) and bsdf.flags()\n"
    subprocess.run([sys.executable, "-c", program], check=True)
    assert (folder / "ball.png").read_bytes().startswith(b"\x89PNG")
