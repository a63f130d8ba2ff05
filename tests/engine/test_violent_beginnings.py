"""What is over in no time at all is followed with the digits that were asked for.

Its force is large beside anything that comes later, for so short a time that its rounding adds up
to nothing.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

INERTIA, START = 1.0 / 8972.97, 5.66e-4
STRONG, UNIT = 194.0, 0.00145
BRAKE = f"{STRONG}*(({{}}/{UNIT}) + ({{}}/{UNIT})^3)"
A = STRONG / UNIT / INERTIA
B = STRONG / (UNIT * INERTIA) ** 3
SETTINGS = [("auto", 1e-8), ("radau", 1e-8), ("auto", 1e-10)]
TIMES = (3e-17, 1e-16, 1e-14, 1e-11)


def left(t: float) -> float:
    """``p' = -a p - b p**3`` is linear in ``1/p**2``."""
    u = (1.0 / START**2 + B / A) * math.exp(2.0 * A * t) - B / A
    return 1.0 / math.sqrt(u)


@pytest.mark.parametrize(("solver", "rtol"), SETTINGS)
def test_a_body_is_stopped_in_no_time(solver: str, rtol: float) -> None:
    """By friction that grows with the cube of its speed."""
    m = hb.Model("stopped")
    m.add(i=hb.I(INERTIA, p=START), r=hb.R({"e": BRAKE.format("f", "f")}), j=hb.One())
    m.bond("j -> i", "j -> r")
    run = hb.simulate(m, 0.5, solver=solver, rtol=rtol)
    for t in TIMES:
        assert run["i.p"].at(t) == pytest.approx(left(t), rel=100.0 * rtol)
    assert run.audit().holds(1e-6)


@pytest.mark.parametrize(("solver", "rtol"), SETTINGS)
def test_a_charge_is_gone_in_no_time(solver: str, rtol: float) -> None:
    """The same of a capacitor and a conductance."""
    m = hb.Model("drained")
    m.add(c=hb.C(INERTIA, q=START), r=hb.R({"f": BRAKE.format("e", "e")}), j=hb.Zero())
    m.bond("j -> c", "j -> r")
    run = hb.simulate(m, 0.5, solver=solver, rtol=rtol)
    for t in TIMES:
        assert run["c.q"].at(t) == pytest.approx(left(t), rel=100.0 * rtol)
    assert run.audit().holds(1e-6)


@pytest.mark.parametrize(("solver", "rtol"), SETTINGS)
def test_what_a_body_gives_off_at_once_is_kept(solver: str, rtol: float) -> None:
    """A gyrator turns the momentum that is lost into a charge, which was none before.

    Its capacitor is so large that it pushes back by nothing that counts.
    """
    ratio = 7.34
    m = hb.Model("given")
    m.add(i=hb.I(INERTIA, p=START), r=hb.R({"e": BRAKE.format("f", "f")}), j=hb.Zero())
    m.add(g=hb.GY(ratio), k=hb.One(), c=hb.C(1e3, q=0.0))
    m.bond("i -> j", "j -> r", "j -> g -> k", "k -> c")
    run = hb.simulate(m, 0.5, solver=solver, rtol=rtol)
    for t in TIMES:
        assert abs(run["i.p"].at(t)) == pytest.approx(left(t), rel=1e-4)
        given = START - abs(run["i.p"].at(t))
        assert abs(run["c.q"].at(t)) == pytest.approx(given / ratio, rel=100.0 * rtol)
    assert run.audit().holds(1e-6)
