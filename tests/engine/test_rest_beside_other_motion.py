"""What a root brings to rest comes to rest, however fast other things move beside it."""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb

SOLVERS = ("auto", "rk45", "radau")
LEVEL, CAPACITY, ROOT = 0.8, 0.3, 40.0
FLOW = f"{ROOT}*sign(e)*sqrt(abs(e))"
EMPTY = 2.0 * math.sqrt(LEVEL * CAPACITY) / ROOT
"""``q' = -k sqrt(q/C)`` is ``sqrt(q) = sqrt(q0) - k t/(2 sqrt(C))``."""
STEPS = 400


def emptied() -> hb.Model:
    """A tank that runs out through an orifice."""
    m = hb.Model("beside")
    m.add(tank=hb.C(CAPACITY, q=LEVEL), orifice=hb.R({"f": FLOW}), bottom=hb.Zero())
    m.bond("bottom -> tank", "bottom -> orifice")
    return m


def is_empty(run: hb.Result, until: float) -> bool:
    """Whether the tank ran out as it must, and stays empty."""
    for part in (0.3, 0.6, 0.9):
        meant = LEVEL * (1.0 - part) ** 2
        assert run["tank.q"].at(part * EMPTY) == pytest.approx(meant, rel=1e-5)
    later = [run["tank.q"].at(t) for t in np.linspace(1.01 * EMPTY, until, 20)]
    return bool(np.abs(later).max() < 1e-6 * LEVEL)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("speed", [1.0, 1e6])
def test_a_tank_runs_out_beside_a_body_that_falls(speed: float, solver: str) -> None:
    """The momentum grows on, ``m g t``: it has no part in what the orifice brings to rest."""
    m = emptied()
    m.add(body=hb.I(2.0, p=0.0), weight=hb.Se(19.62 * speed), fall=hb.One())
    m.bond("weight -> fall -> body")
    until = 100.0 * EMPTY
    run = hb.simulate(m, until, solver=solver, max_steps=20_000)
    assert is_empty(run, until)
    assert run["body.p"].at(until) == pytest.approx(19.62 * speed * until, rel=1e-9)
    assert run.stats["steps"] < STEPS


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_tank_runs_out_beside_what_is_counted(solver: str) -> None:
    """An integrated signal is no part of any law, and goes with time."""
    m = emptied()
    m.signal(count=hb.Integral("1e3*time"))
    until = 100.0 * EMPTY
    run = hb.simulate(m, until, solver=solver, max_steps=20_000)
    assert is_empty(run, until)
    assert run["count"].at(until) == pytest.approx(500.0 * until**2, rel=1e-6)
    assert run.stats["steps"] < STEPS


@pytest.mark.parametrize("solver", SOLVERS[:2])
def test_two_tanks_that_are_filled_come_to_one_level(solver: str) -> None:
    """Their difference is gone at a time; what flows into each goes on, and none of it is lost."""
    m = hb.Model("two")
    m.add(
        left=hb.C(CAPACITY, q=LEVEL),
        right=hb.C(CAPACITY, q=0.1 * LEVEL),
        orifice=hb.R({"f": FLOW}),
        one=hb.Sf(3.0),
        two=hb.Sf(3.0),
    )
    m.add(a=hb.Zero(), b=hb.Zero(), pipe=hb.One())
    m.bond("one -> a -> left", "two -> b -> right", "a -> pipe -> b", "pipe -> orifice")
    # d' = -2 k sqrt(d/C)
    gone = math.sqrt(0.9 * LEVEL * CAPACITY) / ROOT
    until = 50.0 * gone
    run = hb.simulate(m, until, solver=solver, max_steps=20_000)
    left, right = run["left.q"], run["right.q"]
    half = 0.9 * LEVEL * 0.25
    assert left.at(0.5 * gone) - right.at(0.5 * gone) == pytest.approx(half, rel=1e-5)
    for t in np.linspace(1.01 * gone, until, 10):
        assert left.at(t) == pytest.approx(right.at(t), abs=1e-6 * LEVEL)
        assert left.at(t) + right.at(t) == pytest.approx(1.1 * LEVEL + 6.0 * t, rel=1e-8)
    assert run.stats["steps"] < STEPS
