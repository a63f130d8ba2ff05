"""Free-wheeling diode by its law: 10 V, 10 ohm, 0.1 H, opened at 50 ms, drop of 0.7 V."""

import math

import numpy as np
import pytest

OPENED = 0.05
CURRENT = 1.0 - math.exp(-5.0)


def test_conducts_until_the_current_has_run_out(simulate, modes_of, solver):
    run = simulate("diode_inductor_law", solver=solver)
    opening, end = run.events[1:]
    assert opening.t == OPENED
    assert modes_of(run, opening) == [(("open", "conducts"), "continuous")]
    assert opening.steps[0].energy.lost == 0.0
    assert end.t - OPENED == pytest.approx(0.141895, abs=5e-7)
    assert end.t - OPENED == pytest.approx(CURRENT / 7.0, rel=1e-7)
    assert run["L.f"].at(0.1) == pytest.approx(CURRENT - 7.0 * 0.05, rel=1e-6)
    assert run["L.f"].at(0.25) == 0.0
    assert run["node.e"].at(0.1) == pytest.approx(-0.7)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("t_off", [1e-6, 1e-4, 1e-2])
def test_law_and_machine_agree_where_both_settle(t_off, simulate, solver):
    law = simulate("diode_inductor_law", parameters={"t_off": t_off}, solver=solver)
    machine = simulate("diode_inductor", parameters={"t_off": t_off, "I_th": 0}, solver=solver)
    assert [e.t for e in law.events] == pytest.approx([e.t for e in machine.events], rel=1e-7)
    t = np.linspace(0.0, 2.0 * law.events[-1].t, 200).tolist()
    scale = machine["L.p"].at(t_off)
    assert law["L.p"].at(t) == pytest.approx(machine["L.p"].at(t), abs=1e-6 * scale)
    assert law.final["L.p"] == machine.final["L.p"] == 0.0
    assert law.graph.mode_names(law.segments[-1].mode) == {"Sw": "open", "diode": "blocks"}


def test_published_cycle_is_gone(simulate):
    """The published machine has no mode left where its law has one."""
    run = simulate("diode_inductor_law")
    assert run.status == "ok"
    assert run.audit().holds(1e-10)
