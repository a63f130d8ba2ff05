"""Dry friction beside a switch that slides: it holds up to its limit on the mean.

Friction that slips one way in one of the modes combined and the other way in the other rests on the
mean of both: where it was asked what it carries in each of them its events accumulated.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import hybond as hb

SOLVERS = ("auto", "radau", "rk45")


def rules(of: str) -> list[str]:
    return [f"off -> on when {of} < ref", f"on -> off when {of} > ref"]


def disc(
    high: float,
    low: float,
    ref: str,
    *,
    limit: float = 2.0,
    breakaway: float | None = None,
    load: float = 0.3,
    turned: bool = False,
) -> tuple[hb.Model, str, str, str]:
    """Return a shaft that a relay leads, a dry clutch, and a wheel behind it."""
    options = {} if breakaway is None else {"breakaway": breakaway}
    m = hb.Model("disc")
    parts: dict[str, hb.Part] = {
        "drive": hb.Se(f'if q.state == "on" then {high} else {low}'),
        "w1": hb.One(),
        "w2": hb.One(),
        "shaft": hb.I(0.3),
        "wheel": hb.I(0.6),
        "drag": hb.R(load),
        "between": hb.Zero(),
        "disc": hb.One(law="coulomb", limit=limit, **options),
    }
    bonds = ["drive -> w1", "w1 -> shaft", "w1 -> between", "between -> w2", "w2 -> wheel"]
    bonds += ["drag -> w2" if turned else "w2 -> drag"]
    bonds += ["disc -> between" if turned else "between -> disc"]
    if turned:
        parts = dict(reversed(parts.items()))
        bonds.reverse()
    m.add(**parts)
    m.bond(*bonds)
    m.signal(ref=ref)
    m.machine("q", states={"off": [], "on": []}, start="off", rules=rules("w1.f"))
    return m, "w1.f", "w2.f", "between.e"


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("high", "low"), [(12.0, -2.6), (15.0, -2.6), (12.0, -6.0), (20.0, -9.0)])
def test_friction_holds_no_more_than_its_limit_on_the_mean(
    high: float, low: float, turned: bool, solver: str
) -> None:
    """The disc slips while the drive is on, and sticks while it brakes, or slips the other way."""
    own, load, limit, end = 0.6, 0.3, 2.0, 1.4
    m, first, second, force = disc(high, low, "0.5*time + time^3", turned=turned)

    def lead(s: Any) -> Any:
        return 0.5 * s + s**3

    slips = brentq(lambda s: own * (0.5 + 3 * s * s) + load * lead(s) - limit, 0.1, 1.3)
    run = hb.simulate(m, until=end, solver=solver)
    t = np.linspace(0.02, end * 0.98, 40)
    rest = limit / load
    alone = rest + (lead(slips) - rest) * np.exp(-(t - slips) * load / own)
    assert run.status == "ok" and run.audit().holds()
    assert run[first].at(t) == pytest.approx(lead(t), abs=1e-8)
    assert run[second].at(t) == pytest.approx(np.where(t < slips, lead(t), alone), abs=1e-6)
    assert np.max(run[force].at(t)) <= limit + 1e-9


def stuck_or_slipping(limit: float, load: float, omega: float, end: float) -> np.ndarray:
    """Step a wheel of 0.6 behind friction that is led by `2 sin(omega t)`, implicitly."""
    steps = 40000
    h = end / steps
    w = np.zeros(steps + 1)
    for k in range(steps):
        most = 1 / (0.6 / h + load)
        force = (2 * np.sin(omega * (k + 1) * h) - most * 0.6 / h * w[k]) / most
        w[k + 1] = most * (0.6 / h * w[k] + max(-limit, min(limit, force)))
    return w


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("limit", "load", "omega", "drive"), [(1.0, 0.3, 2.0, 12.0), (2.0, 0.5, 1.5, 9.0)]
)
def test_friction_that_a_switch_makes_slip_both_ways_sticks_and_slips_on_the_mean(
    limit: float, load: float, omega: float, drive: float, turned: bool, solver: str
) -> None:
    # in each mode alone the torque is far too large for the clutch
    ref = f"2*sin({omega}*time)"
    m, first, second, force = disc(drive, -drive, ref, limit=limit, load=load, turned=turned)
    run = hb.simulate(m, until=5.0, solver=solver)
    t = np.linspace(0.1, 4.9, 60)
    right = np.interp(t, np.linspace(0, 5.0, 40001), stuck_or_slipping(limit, load, omega, 5.0))
    assert run.status == "ok" and run.audit().holds()
    assert len(run.events) <= 11
    assert run[first].at(t) == pytest.approx(2 * np.sin(omega * t), abs=1e-8)
    assert run[second].at(t) == pytest.approx(right, abs=5e-4)
    assert np.max(np.abs(run[force].at(t))) <= limit + 1e-9


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_run_taken_up_where_friction_rests_on_the_mean_has_no_event_there(solver: str) -> None:
    m, _, second, force = disc(60.0, -60.0, "2*sin(1*time)", limit=2.0)
    whole = hb.simulate(m, until=2.0, solver=solver)
    first = hb.simulate(m, until=1.0, solver=solver)
    for state in (first.state(), whole.state(0.9)):
        run = hb.simulate(m, until=1.5, start=state, solver=solver)
        assert not run.events
        assert run[second].at(1.5) == pytest.approx(2 * np.sin(1.5), abs=1e-8)
        assert run[force].at(1.5) == pytest.approx(whole[force].at(1.5), abs=1e-8)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("high", "low", "limit", "breakaway", "end"),
    [(12.0, -12.0, 1.0, 1.5, 0.73), (20.0, -2.6, 1.9, 2.9, 1.048), (12.0, -2.6, 2.0, 2.5, 1.048)],
)
def test_what_slips_in_one_mode_is_held_to_its_limit_while_it_slips(
    high: float, low: float, limit: float, breakaway: float, end: float, turned: bool, solver: str
) -> None:
    """What breaks it loose is never carried: each time it slips it is to be brought back."""
    model = disc(high, low, "0.5*time + time^3", limit=limit, breakaway=breakaway, turned=turned)
    m, _, second, force = model
    run = hb.simulate(m, until=end, solver=solver)
    assert run.status == "ok"
    # 0.6 w' + 0.3 w is what leads the wheel: up to the limit, and the limit from there on
    lead = solve_ivp(
        lambda t, w: [min(0.5 + 3 * t**2, (limit - 0.3 * w[0]) / 0.6)],
        (0.0, end),
        [0.0],
        rtol=1e-10,
        atol=1e-12,
        max_step=1e-3,
    )
    assert run[second].at(end) == pytest.approx(lead.y[0, -1], abs=1e-6)
    assert abs(run[force].at(end)) == pytest.approx(limit, abs=1e-9)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize(("blocks", "rubbing"), [(1, 1), (2, 2), (6, 6), (7, 7), (8, 1)])
@pytest.mark.parametrize("slope", [0.0, 0.5, 1.0])
def test_blocks_that_rub_are_led_from_rest_however_many_others_there_are(
    slope: float, blocks: int, rubbing: int, solver: str
) -> None:
    m = hb.Model("blocks")
    for k in range(blocks):
        m.add(**{f"d{k}": hb.Se(f'if q{k}.state == "on" then 5 else -5'), f"w{k}": hb.One()})
        m.add(**{f"i{k}": hb.I(1.0)})
        m.bond(f"d{k} -> w{k} -> i{k}")
        if k < rubbing:
            m.add(**{f"f{k}": hb.One(law="coulomb", limit=1.0)})
            m.bond(f"w{k} -> f{k}")
        sides = [f"off -> on when w{k}.f < {slope}*time", f"on -> off when w{k}.f > {slope}*time"]
        m.machine(f"q{k}", states={"off": [], "on": []}, start="off", rules=sides)
    run = hb.simulate(m, until=1.0, solver=solver)
    assert run.status == "ok" and run.warnings == ()
    for k in range(blocks):
        assert run[f"w{k}.f"].at(1.0) == pytest.approx(slope, abs=1e-9)
    assert run["f0.e"].at(0.5) == pytest.approx(1.0 if slope else 0.0, abs=1e-9)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("weak", [12.0, 6.0, 4.0, 3.0])
@pytest.mark.parametrize("limit", [2.0, 0.5])
def test_two_motors_lead_both_sides_of_a_clutch(limit: float, weak: float, solver: str) -> None:
    m = hb.Model("two")
    m.add(w1=hb.One(), w2=hb.One(), i1=hb.I(0.3), i2=hb.I(0.6), z=hb.Zero())
    m.add(d1=hb.Se('if q1.state == "on" then 12 else -12'))
    m.add(d2=hb.Se(f'if q2.state == "on" then {weak} else {-weak}'))
    m.add(disc=hb.One(law="coulomb", limit=limit))
    m.bond("d1 -> w1 -> i1", "d2 -> w2 -> i2", "w1 -> z", "z -> w2", "z -> disc")
    for k in (1, 2):
        sides = [f"off -> on when w{k}.f < time", f"on -> off when w{k}.f > time"]
        m.machine(f"q{k}", states={"off": [], "on": []}, start="off", rules=sides)
    run = hb.simulate(m, until=1.0, solver=solver)
    assert run.status == "ok"
    assert run["w1.f"].at(1.0) == pytest.approx(1.0, abs=1e-9)
    assert run["w2.f"].at(1.0) == pytest.approx(1.0, abs=1e-9)
    assert abs(run["disc.e"].at(0.5)) <= limit + 1e-9


def test_no_machine_fires_on_what_friction_carries_in_no_mode() -> None:
    """At rest in a mode of 60 it would carry 40: it never is at rest there."""
    m, *_ = disc(60.0, -60.0, "2*sin(1*time)", limit=2.0)
    m.machine(
        "g",
        states={"a": [], "b": []},
        start="a",
        rules=["a -> b when time > 0.1 and abs(between.e) > 2.5"],
    )
    run = hb.simulate(m, until=1.0)
    assert run.status == "accumulation"
    assert not [f for e in run.events for v in e.steps for f in v.fired if f.machine == "g"]


def test_a_switch_in_a_thin_band_says_the_same_of_friction() -> None:
    """By hand, in no time of hybond's: Euler's method, friction implicit, a band of 1e-3."""
    w1, w2, on, h = 0.0, 0.0, True, 1e-5
    for k in range(int(2.0 / h)):
        ref = 2 * np.sin(2 * k * h)
        on = w1 < ref + 1e-3 if on else w1 < ref - 1e-3
        one, other = w1 + h * (12.0 if on else -12.0) / 0.3, w2 * (1 - h * 0.3 / 0.6)
        force = max(-1.0, min(1.0, (one - other) / (h / 0.3 + h / 0.6)))
        w1, w2 = one - h * force / 0.3, other + h * force / 0.6
    m, _, second, _ = disc(12.0, -12.0, "2*sin(2*time)", limit=1.0)
    assert hb.simulate(m, until=2.0)[second].at(2.0) == pytest.approx(w2, abs=5e-3)
