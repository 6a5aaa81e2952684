"""What editors and type checkers are told: that it is complete, and true."""

import ast
import inspect
import pathlib
import subprocess
import sys
from typing import get_type_hints

import pytest

import srbf_brdf as srbf
from conftest import QUICK
from srbf_brdf import types

FOLDER = pathlib.Path(srbf.__file__).parent
PROGRAM = """
import numpy as np
import srbf_brdf as srbf
from srbf_brdf.types import Report, Sample

material = srbf.fit("model:ggx:alpha=0.2,f0=0.9", lobes=4)
first: str = material.verdict[0]
lines: str = "\\n".join(material.verdict)
report: Report = material.report
worst: float = max(view["energy_error"] or 0.0 for view in report["held_out"])
good: list[str] = report["verdict"]["good"]
sample: Sample = material.sample([0.0, 0.0, 1.0], np.zeros((5, 2, 3)))
total: np.float32 = sample.weight.sum()
theta = srbf.read("model:lambert:albedo=0.5").samples()["theta_o"].max()
values = material.primaries([500.0]).of(sample.weight)
table = srbf.table([0.0, 0.0, 1.0], [[0.0, 0.0, 1.0]], [0.3])
reduced = material.compare(table).report["summary"]
wrong: int = material.verdict[0]  # type: ignore[assignment]
"""


def members(tree):
    """The names that a stub declares, those of classes with their class, and the functions among them."""
    found = {}
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            found[node.name] = node
        elif isinstance(node, ast.ClassDef):
            found[node.name] = None
            found |= {f"{node.name}.{name}": inner for name, inner in members(node).items()}
    return found


def test_stubs_name_all_that_there_is():
    declared = members(ast.parse((FOLDER / "_native.pyi").read_text()))
    there = set()
    for name, thing in vars(srbf._native).items():
        if not name.startswith("_") and (inspect.isclass(thing) or callable(thing)):
            there.add(name)
            if inspect.isclass(thing) and thing is not srbf.FitError:
                there |= {f"{name}.{own}" for own in vars(thing) if not own.startswith("_")}
    named = {name for name in declared if not name.split(".")[-1].startswith("_")}
    assert named == there, named ^ there
    for name, node in declared.items():
        if node is None or node.name.startswith("_") or node.decorator_list and getattr(node.decorator_list[0], "id", "") == "property":
            continue
        thing = srbf._native
        for part in name.split("."):
            thing = getattr(thing, part)
        signature = [p for p in inspect.signature(thing).parameters if p != "self"]
        stub = [a.arg for a in [*node.args.args, *node.args.kwonlyargs] if a.arg != "self"]
        assert signature == stub, name
        assert node.returns is not None and all(a.annotation for a in node.args.args if a.arg != "self"), name
        assert ast.get_docstring(node), f"{name} has no text"


def test_a_report_has_the_fields_that_its_type_names():
    made = srbf.fit("model:ggx:alpha=0.3,f0=0.5", lobes=2, **QUICK)
    compared = made.compare("model:ggx:alpha=0.3,f0=0.5").report
    for report in (made.report, compared):
        assert set(report) <= set(get_type_hints(types.Report))
        assert set(report["held_out"][0]) == set(get_type_hints(types.View))
        assert set(report["verdict"]) == set(types.Verdict.__annotations__)
    assert set(made.report) == set(get_type_hints(types.Report))
    assert set(srbf.read("model:lambert:albedo=0.5").samples([30])) == set(get_type_hints(types.Samples))


def test_a_type_checker_takes_programs_and_the_stubs(tmp_path):
    pytest.importorskip("mypy")
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    mypy = lambda *words: subprocess.run([sys.executable, "-m", *words], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    # Strict: an error that is expected and is not there is one too.
    done = mypy("mypy", "--strict", "--cache-dir", "cache", "program.py")
    assert done.returncode == 0, done.stdout
    done = mypy("mypy.stubtest", "srbf_brdf._native", "--ignore-missing-stub", "--ignore-disjoint-bases")
    assert done.returncode == 0, done.stdout
