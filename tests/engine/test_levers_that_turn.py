"""Masses tied by a lever that turns: struck in fixed steps, and where the lever has no arm left."""

from __future__ import annotations

import math

import pytest

import hybond as hb


def tied(
    arm: str, angle: float, speed: float = 0.0, *, turned: bool = False, push: float = -3.0
) -> hb.Model:
    """Two masses; the second one is driven by the first, or the other way round, by an arm."""
    m = hb.Model("tied", domain="translational")
    m.add(m1=hb.I(1.0, f=speed), v1=hb.One(), m2=hb.I(2.0), v2=hb.One(), tf=hb.TF(arm))
    m.add(w=hb.Se(push))
    m.bond("v1 -> m1", "v2 -> m2", "w -> v2", "v2 -> tf -> v1" if turned else "v1 -> tf -> v2")
    m.signal(x=hb.Integral("v1.f/(1 [m])", angle), y=hb.Integral("v2.f"))
    return m


@pytest.mark.parametrize("step", ["5 ms", "2 ms", "1 ms"])
@pytest.mark.parametrize(
    ("arm", "angle"),
    [("cos(x)", math.pi / 2), ("cos(x)", math.pi / 2 + 1e-3), ("sin(x)", math.pi)],
)
def test_a_stop_strikes_what_began_without_an_arm(arm: str, angle: float, step: str) -> None:
    """It was HB-J120, or HB-N310: slopes of the first step said what the stop pushes against.

    Kinetic energy and the work of 3 N are one; the stop is at half the arm, and gives back a half.
    """
    m = tied(arm, angle, 1.0)
    m.add(c=hb.Zero(law="unilateral", gap="y + 0.5", restitution=0.5))
    m.bond("c -> v2")
    run = hb.simulate(m, 2.0, solver="moreau-jean", step=step)
    right = hb.simulate(m, 2.0, rtol=1e-10)
    struck = right.events.t[1]
    before, after = (right["v1.f"].at(struck, side=s) for s in ("left", "right"))
    arm_there = right["v2.f"].at(struck, side="left") / before
    # the second mass is where the arm has led it
    start = 0.0 if angle != math.pi / 2 + 1e-3 else 1.0 - math.cos(1e-3)
    assert arm_there**2 == pytest.approx(1.0 - (0.5 - start) ** 2, rel=1e-6)
    assert 0.5 * (1.0 + 2.0 * arm_there**2) * before**2 == pytest.approx(2.0, rel=1e-5)
    assert after == pytest.approx(-0.5 * before, rel=1e-9)
    h = {"5 ms": 5e-3, "2 ms": 2e-3, "1 ms": 1e-3}[step]
    assert run.events.t[1] == pytest.approx(struck, abs=1.5 * h)
    assert run["y"].at(1.9) == pytest.approx(right["y"].at(1.9), abs=2.0 * h)


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize(
    ("arm", "angle"), [("sin(x)", math.pi), ("cos(x)", math.pi / 2), ("-sin(x)", math.pi - 1e-12)]
)
def test_what_is_tied_by_no_arm_steers_no_step(arm: str, angle: float, solver: str) -> None:
    """Rounding of the arm was followed to a part of itself: HB-N409, or 10,000 steps."""
    push = 3.0 if arm != "-sin(x)" else -3.0
    run = hb.simulate(tied(arm, angle, turned=True, push=push), 5.0, solver=solver)
    assert run.stats["steps"] < 200
    assert run["v2.f"].at(5.0) == pytest.approx(push / 2.0 * 5.0, rel=1e-9)
    assert run["x"].at(5.0) == pytest.approx(angle, abs=1e-11)
