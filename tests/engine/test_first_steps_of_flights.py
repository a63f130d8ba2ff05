"""A motion begins with steps as long as the last one in its mode had; nothing is lost by it."""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb

GRAVITY, DROP, BACK = 9.81, 3.0, 0.9
BALL, OSCILLATION = 30, 2.0


def ball() -> hb.Model:
    """Return a ball that gives back a part of its speed, by a machine."""
    m = hb.Model("ball", domain="translational")
    m.add(weight=hb.Se(-GRAVITY), ball=hb.I(1.0), v=hb.One(), contact=hb.Zero())
    m.add(rebound=hb.Sf(f"-{BACK}*pre(v.f)"))
    m.bond("weight -> v -> ball", "contact -> v", "rebound -> contact")
    m.signal(height=hb.Integral("v.f", start=DROP))
    m.machine(
        "floor",
        states={"away": [], "impact": ["contact"]},
        start="away",
        rules=[
            "away -> impact when height <= 0 and v.f < 0",
            "impact -> away when pre(ball.p) >= 0",
        ],
    )
    return m


def bounces(n: int) -> np.ndarray:
    """Return when the first n bounces are: each flight is a part of the one before."""
    flights = 2.0 * BACK ** np.arange(n)
    flights[0] = 1.0
    return math.sqrt(2.0 * DROP / GRAVITY) * np.cumsum(flights)


@pytest.mark.parametrize("solver", ["rk45", "exact", "radau"])
def test_each_flight_of_a_ball_is_one_step_and_ends_when_it_should(solver: str) -> None:
    true = bounces(BALL)
    run = hb.simulate(ball(), 0.5 * (true[-1] + bounces(BALL + 1)[-1]), solver=solver)
    assert np.array([e.t for e in run.events][1:]) == pytest.approx(true, rel=1e-12)
    steps = [len(s.t) - 1 for s in run.segments[2:]]
    if solver != "radau":
        assert steps == [1] * len(steps)
    last = run.t_end - true[-1]
    speed = math.sqrt(2.0 * GRAVITY * DROP) * BACK**BALL
    height = speed * last - 0.5 * GRAVITY * last**2
    assert float(run.final["height"]) == pytest.approx(height, rel=1e-9)


def relay(guard: str) -> hb.Model:
    """Return an oscillator that is pulled to one side or the other, switched by a clock."""
    m = hb.Model("relay", domain="translational")
    m.add(mass=hb.I(1.0), spring=hb.C(1.0 / OSCILLATION**2), v=hb.One())
    m.add(right=hb.Se(1.0), left=hb.Se(-1.0), one=hb.One(), other=hb.One(), pull=hb.Zero())
    m.bond("v -> mass", "v -> spring", "right -> one -> pull", "left -> other -> pull")
    m.bond("pull -> v")
    m.input(clock=hb.Input(pwm={"period": 3.0, "duty": 0.4}))
    m.machine(
        "S",
        states={"right": ["one"], "left": ["other"]},
        start="right",
        rules=[f"right -> left when {guard} < 0.5", f"left -> right when {guard} > 0.5"],
    )
    return m


def test_what_swings_between_timed_events_is_as_right_as_its_tolerance() -> None:
    # q'' = +-1 - w^2 q: from each switch on a turn about +-1/w^2
    run = hb.simulate(relay("clock"), 29.0, solver="rk45", rtol=1e-9)
    w, q, p, t, side = OSCILLATION, 0.0, 0.0, 0.0, 1.0
    for k in range(1, 20):
        until = min(3.0 * (k // 2) + (1.2 if k % 2 else 0.0), 29.0)
        angle, centre = w * (until - t), side / w**2
        q, p = (
            centre + (q - centre) * math.cos(angle) + p / w * math.sin(angle),
            p * math.cos(angle) - w * (q - centre) * math.sin(angle),
        )
        t, side = until, -side
    angle, centre = w * (29.0 - t), side / w**2
    end = centre + (q - centre) * math.cos(angle) + p / w * math.sin(angle)
    assert run.final["spring.q"] == pytest.approx(end, abs=1e-7)


def test_laws_that_are_sums_of_powers_are_those_that_are_written_otherwise() -> None:
    # a stiffening spring: half the energy of the mass that hits it gives how far it goes
    def run(law: str) -> hb.Result:
        m = hb.Model("spring", domain="translational")
        m.add(mass=hb.I(2.0, f=3.0), spring=hb.C({"e": law}), v=hb.One())
        m.bond("v -> mass", "v -> spring")
        m.signal(way=hb.Integral("abs(v.f)", start=0.0))
        return hb.simulate(m, 0.7, rtol=1e-10)

    one, other = run("100*q - 20*q^2 + 500*q^3"), run("q*(100 - 20*q + 500*q*q)")
    for name in ("spring.q", "mass.p", "way"):
        assert one.final[name] == pytest.approx(other.final[name], rel=1e-8)
    q, p = one.final["spring.q"], one.final["mass.p"]
    energy = 50.0 * q**2 - 20.0 / 3.0 * q**3 + 125.0 * q**4 + p**2 / 4.0
    assert energy == pytest.approx(9.0, rel=1e-8)
