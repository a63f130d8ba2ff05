"""1 F at 10 V joined to 2 F at 4 V."""

import pytest


def test_charge_is_kept_and_energy_is_not(simulate, modes_of, solver):
    run = simulate("capacitors_joined", solver=solver)
    joining = run.events[1]
    assert (joining.t, joining.cause) == (1.0, "time")
    assert modes_of(run, joining) == [(("closed",), "continuous")]
    for name in ("C1.e", "C2.e"):
        assert run[name].at(1.0) == pytest.approx(6.0, rel=1e-12)
        assert run[name].at(2.0) == pytest.approx(6.0, rel=1e-12)
    assert run["C1.q + C2.q"].at(2.0) == pytest.approx(18.0, rel=1e-12)
    energy = joining.steps[0].energy
    assert (energy.before, energy.source) == (66.0, 0.0)
    assert energy.lost == pytest.approx(12.0, rel=1e-12)
    assert joining.steps[0].impulses["join.f"] == pytest.approx(4.0, rel=1e-12)


@pytest.mark.parametrize("solver", ["euler", "rk4"])
def test_fixed_steps_have_the_same_jump(solver, simulate):
    run = simulate("capacitors_joined", solver=solver, step=0.3)
    assert run.events[1].t == 1.0
    assert run["C2.e"].at(2.0) == pytest.approx(6.0, rel=1e-12)
