"""Laws with flat ends: where what is stored decides what they give, an end is an end stop.

Oracles: closed forms; what a source asks for is more than a law can give, or it is not.
"""

from __future__ import annotations

import math

import pytest
from scipy.optimize import brentq

import hybond as hb

CLIPS = {
    "min and max": "max(-2, min(2, {}))",
    "if": "if {0} > 2 then 2 else if {0} < -2 then -2 else {0}",
    "table": {"table": [[-3, -2, 2, 3], [-2, -2, 2, 2]], "extrapolate": "linear"},
    "signs": "(abs({0} + 2) - abs({0} - 2))/2",
}


def driven(law: object, force: str, *, dual: bool = False, start: float = 0.0) -> hb.Model:
    """A mass that a force moves against a resistor, or a capacitor that a flow fills beside one."""
    m = hb.Model("driven")
    given = law.format("f" if dual else "e") if isinstance(law, str) else law
    if dual:
        m.add(u=hb.Sf(force), s=hb.C(1.0, q=start), j=hb.Zero(), d=hb.R({"e": given}))
    else:
        m.add(u=hb.Se(force), s=hb.I(1.0, p=start), j=hb.One(), d=hb.R({"f": given}))
    m.bond("u -> j -> s", "j -> d")
    return m


def free(t: float, since: float, begin: float, force: float) -> float:
    """``x' = force*cos(t) - x`` from `begin`."""

    def steady(t: float) -> float:
        return 0.5 * force * (math.cos(t) + math.sin(t))

    return steady(t) + (begin - steady(since)) * math.exp(since - t)


@pytest.mark.sampled(8)
@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize("law", CLIPS.values(), ids=CLIPS)
def test_a_flow_that_reaches_the_end_of_a_law_is_held_there(
    law: object, dual: bool, solver: str
) -> None:
    """Up to 2 it follows; there it stays until the force falls below 2; then it follows again."""
    run = hb.simulate(driven(law, "5*cos(time/1 [s])", dual=dual), 2.5, solver=solver)
    x = run["j.e" if dual else "j.f"]
    held = brentq(lambda t: free(t, 0.0, 0.0, 5.0) - 2.0, 0.0, 1.0, xtol=1e-15)
    loose = math.acos(0.4)
    assert [e.t for e in run.events][1:] == pytest.approx([held, loose], abs=1e-7)
    assert x.at(0.4) == pytest.approx(free(0.4, 0.0, 0.0, 5.0), rel=1e-7)
    assert x.at([held + 0.01, 1.0]) == pytest.approx(2.0, rel=1e-12)
    assert x.at(2.5) == pytest.approx(free(2.5, loose, 2.0, 5.0), rel=1e-6)
    # the other variable is what is left of the force
    other = run["d.f" if dual else "d.e"].at(0.8)
    assert other == pytest.approx(5.0 * math.cos(0.8), rel=1e-9)
    assert run.audit().holds() and run.mode["d"] == "follows"


def test_a_conductor_of_one_way_is_a_check_valve() -> None:
    """At rest until the force turns at pi; what flows then ends where it comes to nothing."""
    run = hb.simulate(driven("max(0, {})", "-sin(time/1 [s])"), 9.0)
    begin = math.pi

    def flow(t: float) -> float:
        # x' = -sin(t) - x from rest at pi
        return 0.5 * (math.cos(t) - math.sin(t)) + 0.5 * math.exp(begin - t)

    end = brentq(flow, 5.5, 8.0, xtol=1e-14)
    assert run["j.f"].at([1.0, 3.0]) == pytest.approx(0.0, abs=1e-300)
    assert run["j.f"].at([4.0, 5.0]) == pytest.approx([flow(4.0), flow(5.0)], rel=1e-6)
    assert run.events[-1].t == pytest.approx(end, abs=1e-6)
    assert run["j.f"].at(8.9) == pytest.approx(0.0, abs=1e-12)
    assert run["d.e"].at(8.0) == pytest.approx(-math.sin(8.0), rel=1e-9)


def test_what_is_stored_beyond_the_end_of_a_law_jumps_to_it() -> None:
    """A flow the wrong way through a conductor of one way: its energy is lost, as by a diode."""
    run = hb.simulate(driven("max(0, {})", "1", start=-1.0), 1.0)
    lost = [step.energy.lost for step in run.events[0].steps if step.energy is not None]
    assert sum(lost) == pytest.approx(0.5, rel=1e-12)
    assert run["j.f"].at([0.5, 1.0]) == pytest.approx(
        [-math.expm1(-0.5), -math.expm1(-1.0)], rel=1e-7
    )


@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_a_law_that_bends_towards_its_limit_is_held_there(solver: str) -> None:
    """``f = 2*tanh(e)`` under fifty: all is pressed against 2 from where a millionth is lacking."""
    run = hb.simulate(driven("2*tanh({})", "50*cos(time/1 [s])"), 3.0, solver=solver)
    assert run["j.f"].at(1.0) == pytest.approx(2.0, rel=1e-12)
    assert run["d.e"].at(1.0) == pytest.approx(50.0 * math.cos(1.0), rel=1e-9)
    assert run["j.f"].at(3.0) == pytest.approx(-2.0, rel=1e-12)
    (fired,) = run.events[1].steps[0].fired
    assert fired.values["d.e"] == pytest.approx(math.atanh(1.0 - 1e-6), rel=1e-5)


def test_two_ends_on_one_flow() -> None:
    """``x' = 5 - 2 x`` up to 1.5, where the weaker one holds and the other follows."""
    m = driven("max(-2, min(2, {}))", "5")
    m.add(d2=hb.R({"f": "max(-1.5, min(1.5, e))"}))
    m.bond("j -> d2")
    run = hb.simulate(m, 2.0)
    assert run["j.f"].at(0.3) == pytest.approx(-2.5 * math.expm1(-0.6), rel=1e-7)
    assert run.events[-1].t == pytest.approx(math.log(2.5) / 2.0, rel=1e-9)
    assert [float(run[k].at(1.0)) for k in ("j.f", "d.e", "d2.e")] == pytest.approx(
        [1.5, 1.5, 3.5], rel=1e-12
    )


@pytest.mark.parametrize("law", CLIPS.values(), ids=CLIPS)
def test_a_source_beyond_the_end_has_no_solution(law: object) -> None:
    """2 V is asked of what gives 1 V: that stays refused; 0.9 of it is not."""
    given = law.format("f") if isinstance(law, str) else law
    for volts, code in ((2.5, "HB-N301"), (1.9, "")):
        m = hb.Model("asked")
        m.add(u=hb.Se(volts), d=hb.R({"e": given}), j=hb.One())
        m.bond("u -> j -> d")
        run = hb.simulate(m, 1.0, on_error="return")
        assert (run.error.code if run.error is not None else "") == code


def test_a_source_that_grows_beyond_the_end_is_refused_where_it_does() -> None:
    m = hb.Model("asked")
    m.add(u=hb.Se("1*time/1 [s]"), d=hb.R({"e": "max(-2, min(2, f))"}), j=hb.One())
    m.bond("u -> j -> d")
    run = hb.simulate(m, 3.0, on_error="return")
    assert run.error is not None and run.error.code == "HB-N301"
    assert run.t_end == pytest.approx(2.0, rel=1e-6)
