"""Other processes: children that are forked from one that has fitted, and what is sent to them."""

import multiprocessing
import os
import pickle
import signal
import threading
import time

import numpy as np
import pytest

import srbf_brdf as srbf
from conftest import QUICK
from test_fit import lobe, samples

# A child that hangs is found after so many seconds.
HUNG = 300
FEW = dict(QUICK, lobes=2, views=2, starts=1, steps=1, factors="none")
MODEL = "model:ggx:alpha=0.3,f0=0.5"
forks = pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are forked")


def everything(folder):
    """All that the package does on several threads."""
    folder.mkdir(parents=True, exist_ok=True)
    model, made = srbf.read(MODEL), srbf.fit(MODEL, **FEW)
    made.compare(model)
    model.samples()
    made.to_merl(folder / "a.binary")
    made.to_rgl(folder / "a.bsdf")
    model.save(folder / "b.bsdf")
    srbf.read(folder / "a.bsdf").save(folder / "c.csv")
    srbf.read(folder / "c.csv").look(quick=True)
    measured = srbf.table(*samples(20))
    measured.look()
    srbf.fit(measured, **dict(FEW, views=None)).compare(measured)


def in_child(work):
    """Whether a forked child does it, to its end."""
    child = os.fork()
    if child == 0:
        signal.alarm(HUNG)
        status = 1
        try:
            work()
            status = 0
        finally:
            os._exit(status)
    assert os.waitpid(child, 0)[1] == 0


@forks
def test_a_child_of_a_process_that_has_fitted_does_everything(tmp_path):
    everything(tmp_path / "parent")
    in_child(lambda: everything(tmp_path / "child"))
    # One of a process that is fitting.
    fitting = threading.Thread(target=lambda: srbf.fit(MODEL, **QUICK))
    fitting.start()
    time.sleep(0.1)
    in_child(lambda: srbf.fit(MODEL, **FEW))
    fitting.join()


@forks
def test_a_child_that_is_forked_within_a_fit_is_told_so():
    """Its parent's fit ends by an exception: calls of Python take long. `tests/c/fit.c` lets it end."""
    forked = []

    def function(wo, wi):
        if not forked:
            forked.append(1)

            def fit():
                with pytest.raises(RuntimeError, match="forked within a fit"):
                    srbf.fit(MODEL, **FEW)

            in_child(fit)
            raise ZeroDivisionError("after the child")
        return lobe(wo, wi)

    with pytest.raises(ZeroDivisionError, match="after the child"):
        srbf.fit(function, **FEW)
    assert forked


def fit_of(table):
    return srbf.fit(table, **dict(FEW, views=None))


@pytest.mark.parametrize("method", sorted({"fork", "spawn"} & set(multiprocessing.get_all_start_methods())))
def test_a_pool_fits_tables(tmp_path, method):
    srbf.fit(MODEL, **FEW).to_rgl(tmp_path / "a.bsdf")
    tables = [srbf.read(MODEL), srbf.read(tmp_path / "a.bsdf"), srbf.table(*samples(20), name="mine")]
    with multiprocessing.get_context(method).Pool(2) as pool:
        made = pool.map_async(fit_of, tables).get(HUNG)
    for table, material in zip(tables, made):
        here = fit_of(table)
        assert material == here and material.verdict == here.verdict
        assert {k: v for k, v in material.report.items() if k != "seconds"} == {
            k: v for k, v in here.report.items() if k != "seconds"
        }


def test_tables_are_pickled_as_they_are(tmp_path):
    model, file = srbf.fit(MODEL, **FEW), tmp_path / "a.bsdf"
    model.to_rgl(file)
    srbf.read(file).save(tmp_path / "a.csv")
    # At the horizon, which is left out.
    wo, wi, f = (np.concatenate([a, a[:1]]) for a in samples(20))
    wi[-1] = [1, 0, 0]
    for table in (srbf.read(MODEL), srbf.read(file), srbf.read(tmp_path / "a.csv"), srbf.table(wo, wi, f, name="mine.binary")):
        again = pickle.loads(pickle.dumps(pickle.loads(pickle.dumps(table))))
        assert (repr(again), again.name, again.sha256, again.left_out) == (repr(table), table.name, table.sha256, table.left_out)
        for key, array in table.samples().items():
            assert np.array_equal(again.samples()[key], array), key
    assert "line 102" in table.left_out
    table = srbf.read(file)
    file.write_bytes(file.read_bytes()[:-1] + b"x")
    with pytest.raises(ValueError, match="a.bsdf: changed since it was read"):
        pickle.dumps(table)
    file.unlink()
    with pytest.raises(FileNotFoundError, match="a.bsdf"):
        pickle.dumps(table)


def test_results_and_errors_are_pickled(tmp_path):
    made = srbf.fit(MODEL, **FEW)
    again = pickle.loads(pickle.dumps(made))
    assert again == made and again.report == made.report and again.verdict == made.verdict and made.verdict
    comparison = made.compare(MODEL)
    assert pickle.loads(pickle.dumps(comparison)).report == comparison.report
    sample = made.sample([0, 0, 1], [0.1, 0.2, 0.3])
    assert all(np.array_equal(a, b) for a, b in zip(pickle.loads(pickle.dumps(sample)), sample))
    with pytest.raises(srbf.FitError) as caught:
        srbf.read("model:nothing")
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
