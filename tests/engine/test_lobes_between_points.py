"""A lobe that a law cuts off outside: nothing else moves there, and steps would grow over it.

What is compared is flat where a long step begins, in its middle and where it ends.
"""

import math

import pytest

import hybond as hb

LOBE = "1 A*max(0, 1/(1 + ((A.q/(1 C) - {at})/{width})^2) - 0.5)"


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("at", [2.5, 4.5585, 8.2])
@pytest.mark.parametrize("width", [0.3, 0.1])
def test_a_lobe_of_what_rises_evenly_is_stored(width: float, at: float, solver: str) -> None:
    """Between its half values it brings ``width (pi/2 - 1)``."""
    m = hb.Model("lobe", domain="electrical")
    m.add(SA=hb.Sf("1 A"), nA=hb.Zero(), A=hb.C("1 F"), nB=hb.Zero(), B=hb.C("1 F"))
    m.add(SB=hb.Sf(LOBE.format(at=at, width=width)))
    m.bond("SA -> nA -> A", "SB -> nB -> B")
    run = hb.simulate(m, until=10.0, solver=solver)
    assert run.final["B.q"] == pytest.approx(width * (math.pi / 2.0 - 1.0), rel=1e-5)


CUT = {
    "a lobe": ("1/(1 + ({u})^2)", "0.5"),
    "a logarithm": ("2 - log(1 + ({u})^2)", "2 - log(2)"),
    "a power": ("(1 + ({u})^2)^(-4)", "0.0625"),
    "an arc": ("2 - atan(({u})^2)", "2 - atan(1)"),
}
"""What is larger than a level, by the units of measurement of ``u``, between -1 and 1."""


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("at", [1.3, 9.1])
@pytest.mark.parametrize("what", ["a lobe", "a logarithm"])
def test_a_window_of_a_law_is_not_passed_over(what: str, at: float, solver: str) -> None:
    """What is let through in it is as much as the window is wide."""
    above, level = CUT[what]
    u = f"(A.q/(1 C) - {at})/0.005"
    m = hb.Model("window", domain="electrical")
    m.add(SA=hb.Sf("1 A"), nA=hb.Zero(), A=hb.C("1 F"), nB=hb.Zero(), B=hb.C("1 F"))
    m.add(SB=hb.Sf(f"1 A*(if {above.format(u=u)} > {level} then 1 else 0)"))
    m.bond("SA -> nA -> A", "SB -> nB -> B")
    run = hb.simulate(m, until=10.0, solver=solver)
    assert run.final["B.q"] == pytest.approx(0.01, rel=1e-5)


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45", "exact"])
@pytest.mark.parametrize("at", [0.7, 1.3, 9.1])
@pytest.mark.parametrize("what", list(CUT))
def test_a_guard_that_holds_in_a_narrow_window_fires(what: str, at: float, solver: str) -> None:
    """It does where the window begins, and ceases to hold where it ends."""
    above, level = CUT[what]
    holds = f"{above.format(u=f'(A.q/(1 C) - {at})/0.005')} > {level}"
    m = hb.Model("window", domain="electrical")
    m.add(SA=hb.Sf("1 A"), nA=hb.Zero(), A=hb.C("1 F"))
    m.bond("SA -> nA -> A")
    rules = [f"out -> in when {holds}", f"in -> out when not ({holds})"]
    m.machine("W", states={"out": [], "in": []}, start="out", rules=rules)
    run = hb.simulate(m, until=10.0, solver=solver)
    times = [event.t for event in run.events if event.t > 0.0]
    assert times == pytest.approx([at - 0.005, at + 0.005], abs=1e-7)
