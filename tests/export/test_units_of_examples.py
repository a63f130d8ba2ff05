"""Examples as functional mock-up units, run by FMPy, against hybond."""

from __future__ import annotations

import shlex
from pathlib import Path

import needs
import numpy as np
import pytest
from example_runs import PRINTED, RTOL, example, run_of

import hybond as hb

fmpy = pytest.importorskip("fmpy")


@pytest.mark.tcc
@pytest.mark.slow
@pytest.mark.parametrize("name", PRINTED["fmu"])
def test_an_example_is_a_unit(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", shlex.join(needs.QUICK))
    model, run = example(name), run_of(name)
    # a run that cannot go on is looked at before it stops
    end = run.t_end * (1.0 if run.error is None else 0.99)
    path = tmp_path / "any.fmu"
    hb.export(model, to="fmu", path=path, fmi=("2.0", "3.0")[len(name) % 2])
    paths = [s.path for s in (*run.graph.storages, *run.graph.integrals)]
    # how slip in the plane turns is not shown
    shown = [p for p in paths if p not in ("slip_x.heading", "slip_x.slow")]
    found = fmpy.simulate_fmu(
        str(path),
        fmi_type="CoSimulation",
        stop_time=end,
        output_interval=end / 20,
        relative_tolerance=RTOL,
        output=shown,
    )
    t = float(found["time"][-2])
    largest = np.max([np.abs(np.asarray(s.y)).max(axis=0) for s in run.trace.segments], axis=0)
    for state in shown:
        size = max(float(largest[paths.index(state)]), 1e-300)
        assert float(found[state][-2]) == pytest.approx(run[state].at(t), abs=1e-5 * size), state
