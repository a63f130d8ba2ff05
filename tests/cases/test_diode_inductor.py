"""Free-wheeling diode (Mosterman & Biswas 2002): 10 V, 10 ohm, 0.1 H, opened at 50 ms."""

import math

import pytest

import hybond as hb

OPENED = 0.05
CURRENT = 1.0 - math.exp(-5.0)  # at the opening: 0.993262 A
OPENS = [
    (("open", "blocks"), "mythical"),
    (("open", "conducts"), "continuous"),
]


@pytest.mark.parametrize("name", ["diode_inductor", "diode_inductor_no_mode"])
def test_flux_survives_the_opening(name, simulate, modes_of, solver):
    run = simulate(name, solver=solver, on_error="return")
    opening = run.events[1]
    assert opening.t == OPENED
    assert opening.cause == "time"
    assert modes_of(run, opening) == OPENS
    for side in ("left", "right"):
        assert run["L.f"].at(OPENED, side=side) == pytest.approx(0.993262, abs=5e-7)
        assert run["L.p"].at(OPENED, side=side) == pytest.approx(0.0993262, abs=5e-8)
    assert run["L.p"].at(OPENED, side="left") == run["L.p"].at(OPENED)
    # the mythical mode is tried with its impulse, and writes nothing
    mythical = opening.steps[0]
    assert mythical.impulses["diode.e"] == pytest.approx(0.1 * CURRENT, rel=1e-7)
    stored = 0.5 * run["L.p"].at(OPENED) * run["L.f"].at(OPENED)
    assert stored == pytest.approx(49.3285e-3, rel=2e-6)


def test_repaired_diode_lets_go_below_its_threshold(simulate, modes_of, solver):
    run = simulate("diode_inductor", solver=solver)
    assert run.status == "ok"
    assert len(run.events) == 3
    off = run.events[2]
    assert off.t - OPENED == pytest.approx(0.140466, abs=5e-7)
    assert off.t - OPENED == pytest.approx((CURRENT - 0.01) / 7.0, rel=1e-6)
    assert modes_of(run, off) == [(("open", "blocks"), "continuous")]
    assert off.steps[0].energy.lost == pytest.approx(5e-6, rel=1e-6)
    assert off.steps[0].energy.after == 0.0
    assert run["L.p"].at(off.t) == 0.0
    assert run["L.p"].at(0.25) == 0.0


@pytest.mark.parametrize("name", ["diode_inductor", "diode_inductor_no_mode"])
def test_without_a_threshold_the_current_runs_out(name, simulate, solver):
    run = simulate(name, parameters={"I_th": 0}, solver=solver)
    off = run.events[2]
    assert off.t - OPENED == pytest.approx(0.141895, abs=5e-7)
    assert off.t - OPENED == pytest.approx(CURRENT / 7.0, rel=1e-7)
    assert abs(run["L.f"].at(off.t, side="left")) < 1e-8
    assert run["L.f"].at(0.25) == 0.0


def test_published_diode_is_left_without_a_mode(simulate, solver):
    with pytest.raises(hb.DivergenceOfTime) as caught:
        simulate("diode_inductor_no_mode", solver=solver)
    error = caught.value
    assert error.code == "HB-N401"
    for mode in ("(open, conducts)", "(open, blocks)"):
        assert mode in error.why
    run = error.partial
    assert run.status == "error"
    assert run.error is error
    assert run.t_end == pytest.approx(0.190466, abs=5e-7)
    assert run["L.f"].at(run.t_end) == pytest.approx(0.01, rel=1e-6)
    assert [e.cause for e in run.events] == ["start", "time"]


@pytest.mark.sampled(5)
@pytest.mark.parametrize("t_off", [1e-6, 1e-5, 1e-4])
def test_opening_below_the_threshold(t_off, simulate, modes_of, solver):
    current = 1.0 - math.exp(-100.0 * t_off)
    assert 0.0 < current < 0.01
    with pytest.raises(hb.DivergenceOfTime) as caught:
        simulate("diode_inductor_no_mode", parameters={"t_off": t_off}, solver=solver)
    run = caught.value.partial
    assert run.t_end == t_off
    assert run["L.f"].at(t_off) == pytest.approx(current, rel=1e-6)
    # repaired, blocking is real at once and the flux is lost
    run = simulate("diode_inductor", parameters={"t_off": t_off}, solver=solver)
    assert modes_of(run, run.events[1]) == [(("open", "blocks"), "continuous")]
    assert run["L.p"].at(t_off) == 0.0
    assert run.events[1].steps[0].energy.lost == pytest.approx(0.05 * current**2, rel=2e-6)


@pytest.mark.parametrize(("solver", "order"), [("euler", 1), ("rk4", 4)])
def test_fixed_steps_converge(solver, order, simulate):
    errors = []
    for step in (5e-3, 2.5e-3):
        run = simulate("diode_inductor", solver=solver, step=step)
        errors.append(abs(run["L.f"].at(OPENED, side="left") - CURRENT))
    assert math.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.4)
