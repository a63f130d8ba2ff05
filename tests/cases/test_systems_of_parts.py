"""Eight systems made of parts, as their files are, against what does not come from here.

What is linear between two events is held against eigenvalues and roots of its own solution, the
rest against SciPy's integrator.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from example_runs import EXAMPLES
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

import hybond as hb

RTOL = 1e-11
G = 9.81


def run_of(name: str, **options: object) -> hb.Result:
    return hb.simulate(hb.load(EXAMPLES / "systems" / f"{name}.toml"), rtol=RTOL, **options)


def times_of(run: hb.Result) -> list[float]:
    return [event.t for event in run.events][1:]


class Linear:
    """``x' = a*x + b`` from x at a time."""

    def __init__(self, t: float, x: np.ndarray, a: list, b: list) -> None:
        self.t, self.x = t, np.append(x, 1.0)
        self.matrix = np.zeros((len(self.x), len(self.x)))
        self.matrix[:-1] = np.column_stack([a, b])
        self.rates, self.modes = np.linalg.eig(self.matrix)
        self.whole = np.linalg.cond(self.modes) < 1e6  # else eigenvectors do not span the motion
        self.parts = np.linalg.solve(self.modes, self.x) if self.whole else None

    def __call__(self, t: float) -> np.ndarray:
        if not self.whole:
            return (expm(self.matrix * (t - self.t)) @ self.x)[:-1]
        return (self.modes @ (self.parts * np.exp(self.rates * (t - self.t)))).real[:-1]

    def first(self, g: Callable[[np.ndarray], float], end: float, step: float) -> float:
        """Return when ``g(x)`` first comes to zero from above, or `end`."""
        at = self.t
        while at < end:
            after = min(at + step, end)
            if g(self(after)) < 0:
                return brentq(lambda t: g(self(t)), at, after, xtol=1e-14, rtol=1e-14)
            at = after
        return end


def test_a_bungee_jumper_falls_freely_and_swings_while_the_rope_is_taut() -> None:
    run = run_of("bungee")
    k, m, slack = 80.0, 75.0, 25.0
    fall = np.sqrt(2 * slack / G)
    speed, w = G * fall, np.sqrt(k / m)
    # depth below the taut rope: a*(1 - cos(w*t)) + speed/w*sin(w*t), zero again after `taut`
    a = m * G / k
    taut = 2 * (np.pi - np.arctan2(speed / w, a)) / w
    period = 2 * fall + taut
    wanted = [n * period + fall + part for n in range(5) for part in (0.0, taut)]
    assert times_of(run) == pytest.approx([t for t in wanted if t < 30], rel=1e-10)
    lowest = slack + a + np.hypot(a, speed / w)
    turn = fall + (np.pi - np.arctan2(speed / w, a)) / w
    assert run["jumper.position"].at(turn) == pytest.approx(-lowest, rel=1e-10)
    assert run["rope.tension"].at(turn) == pytest.approx(k * (lowest - slack), rel=1e-9)
    t = 2 * period + fall + 1.0
    deep = a * (1 - np.cos(w)) + speed / w * np.sin(w)
    assert run["jumper.position"].at(t) == pytest.approx(-slack - deep, rel=1e-9)


def test_a_thermostat_switches_when_exponentials_say() -> None:
    run = run_of("thermostat")
    c, g, p = 60e3, 40.0, 1500.0
    low, high = 292.15 - 273.15, 294.15 - 273.15
    rest = p / g  # temperatures above that of the winter
    up = c / g * np.log((rest - low) / (rest - high))
    down = c / g * np.log(high / low)
    t = c / g * np.log((rest - 12.0) / (rest - high))
    wanted = []
    for k in range(64):
        wanted.append(t)
        t += up if k % 2 else down
    assert times_of(run) == pytest.approx([t for t in wanted if t < 3 * 3600], rel=1e-10)


def test_a_lock_up_clutch_takes_over_from_the_brake() -> None:
    run = run_of("two_speed_gear")
    sun, ring, carrier, z, torque, grip = 0.1, 0.05, 2.0, 2.0, 20.0, 60.0
    first = torque / (sun + carrier / (1 + z) ** 2)
    w = 3 * first
    # what the gear takes from the sun while the clutch slips
    t = ((torque - grip) / sun + z * grip / ring) / (
        1 / sun + z * z / ring + (1 + z) ** 2 / carrier
    )
    of_sun, of_ring = (torque - grip - t) / sun, (grip - z * t) / ring
    slip = w / (of_ring - of_sun)
    assert times_of(run) == pytest.approx([3.0, 3.0 + slip], rel=1e-10)
    assert run["crank.speed"].at(2.0) == pytest.approx(2 * first, rel=1e-10)
    assert run["load.speed"].at(2.0) == pytest.approx(2 * first / (1 + z), rel=1e-10)
    last = of_ring * slip + torque / (sun + ring + carrier) * (5 - slip)
    for name in ("crank", "rim", "load"):
        assert run[f"{name}.speed"].at(8.0) == pytest.approx(last, rel=1e-10)
    assert run["lock_up.heat"].at(8.0) == pytest.approx(grip * w * slip / 2, rel=1e-8)


def test_a_relay_lets_go_when_its_coil_has_run_down_through_the_diode() -> None:
    run = run_of("relay_coil")
    r, coil, drop, v = 240.0, 2.4, 0.7, 24.0
    tau = coil / r
    on = 0.005 + tau * np.log(0.1 / (0.1 - 0.05))
    held = v / r * (1 - np.exp(-0.045 / tau))
    off = 0.05 + tau * np.log((held + drop / r) / (0.02 + drop / r))
    idle = 0.05 + tau * np.log((held + drop / r) / (drop / r))
    assert times_of(run) == pytest.approx([0.005, on, 0.05, off, idle], rel=1e-10)
    # load 12 ohm, 20 mH; snubber 100 ohm, 0.1 uF: charged to 24 V before the contact closes
    i = v / 12 * (1 - np.exp(-(off - on) * 12 / 20e-3))
    after = Linear(off, np.array([i, 0.0]), [[-112 / 20e-3, -1 / 20e-3], [1e7, 0]], [v / 20e-3, 0])
    for t in off + np.array([2e-5, 1e-4, 4e-4]):
        assert run["L.current"].at(t) == pytest.approx(after(t)[0], rel=1e-8)
        assert run["c.voltage"].at(t) == pytest.approx(after(t)[1], rel=1e-8)


@pytest.mark.slow
def test_a_motor_on_an_h_bridge_keeps_its_current_below_the_limit() -> None:
    run = run_of("h_bridge")
    r, coil, k, j, drag = 1.0, 10e-3, 0.05, 6e-4, 1e-5
    a = [[-r / coil, -k / coil], [k / j, -drag / j]]
    t, x, limited = 0.0, np.zeros(2), False
    times, pieces = [], []
    while t < 1.0:
        end, u = (0.5, 24.0) if t < 0.5 else (1.0, -24.0)
        piece = Linear(t, x, a, [0.0 if limited else u / coil, 0.0])
        pieces.append(piece)
        t = piece.first(
            lambda x, limited=limited: abs(x[0]) - 7 if limited else 8 - abs(x[0]), end, 2e-3
        )
        x = piece(t)
        if t != end:
            limited = not limited
        times.append(t)
    found = times_of(run)
    switched = [t for t in times if t < 1.0]
    assert len(switched) > 200
    # backwards the current passes zero: from diodes to transistors, no limit's doing
    zero = next(p for p in pieces if p.t > 0.5).first(lambda x: x[0], 1.0, 1e-3)
    assert found == pytest.approx(sorted([*(t for t in switched if t != 0.5), zero]), rel=1e-9)
    for t in (0.1, 0.3, 0.45, 0.6, 0.95):
        piece = next(p for p in reversed(pieces) if p.t <= t)
        assert run["motor.current"].at(t) == pytest.approx(piece(t)[0], rel=1e-7)
        assert run["motor.speed"].at(t) == pytest.approx(piece(t)[1], rel=1e-8)


def test_two_tanks_run_empty_through_a_siphon() -> None:
    run = run_of("siphon")
    up, low, pipe, bore, head = 0.5, 0.4, 2e6, 3e6, 9810.0
    hose = Linear(0.0, np.array([0.1]), [[-head / bore / low]], [-0.5 * head / bore / low])
    dry = hose.first(lambda x: x[0], 99.0, 1.0)
    start = 0.3 * up / 2e-3
    into = head / pipe
    shut = Linear(
        start,
        np.array([0.5, 0.0]),
        [[-into / up, into / up], [into / low, -into / low]],
        [(2e-3 - into) / up, into / low],
    )
    wets = shut.first(lambda x: 0.01 - x[1], 99.0, 0.1)
    both = [[-into / up, into / up], [into / low, -(into + head / bore) / low]]
    runs = Linear(wets, shut(wets), both, [(2e-3 - into) / up, (into - 0.5 * head / bore) / low])
    ends = Linear(100.0, runs(100.0), both, [-into / up, (into - 0.5 * head / bore) / low])
    air = ends.first(lambda x: x[0], 999.0, 1.0)
    rest = Linear(air, ends(air)[1:], [[-head / bore / low]], [-0.5 * head / bore / low])
    empty = rest.first(lambda x: x[0], 999.0, 1.0)
    assert times_of(run) == pytest.approx([dry, start, wets, air, empty], rel=1e-8)
    assert run["upper.level"].at(600.0) == pytest.approx(0, abs=1e-12)
    assert run["lower.level"].at(120.0) == pytest.approx(ends(120.0)[1], rel=1e-8)


def test_a_quarter_car_strikes_its_bump_stops() -> None:
    run = run_of("quarter_car")

    def rate(road: float, touch: int) -> Callable:
        def f(_: float, y: np.ndarray) -> list[float]:
            tyre, gap, wheel, body = y
            push = {0: 0.0, -1: 3e5 * (-0.04 - gap), 1: 3e5 * (0.06 - gap)}[touch]
            spring = 2e4 * gap + 1200 * (body - wheel) - push
            return [wheel - road, body - wheel, (spring - 2e5 * tyre) / 40, -spring / 320]

        return f

    def low(_: float, y: np.ndarray) -> float:
        return y[1] + 0.04

    def high(_: float, y: np.ndarray) -> float:
        return y[1] - 0.06

    low.terminal = high.terminal = True
    t, y, touch, times = 0.1, np.zeros(4), 0, []
    while t < 2.0:
        road, end = (4.0, 0.12) if t < 0.12 else (0.0, 2.0)
        low.direction, high.direction = (-1, 1) if touch == 0 else (1, -1)
        got = solve_ivp(
            rate(road, touch), (t, end), y, "DOP853", events=[low, high], rtol=1e-12, atol=1e-13
        )
        t, y = got.t[-1], got.y[:, -1]
        if got.status == 1:
            touch = 0 if touch else (-1 if len(got.t_events[0]) else 1)
            times.append(t)
    found = [t for t in times_of(run) if t not in (0.1, 0.12)]
    assert found == pytest.approx(times, rel=1e-8)
    assert len(times) >= 4
    assert run["body.speed"].at(2.0) == pytest.approx(y[3], abs=1e-9)
    assert run["stops.position"].at(2.0) == pytest.approx(y[1], abs=1e-10)


def test_a_press_stops_at_the_pressure_of_its_relief_valve() -> None:
    run = run_of("press", until="0.4 s")
    area_a, area_b, bulk, dead = 1e-3, 6e-4, 1.4e9, 20e-6
    flow = 10e-6 / (2 * np.pi) * 150

    def f(_: float, y: np.ndarray) -> list[float]:
        a, b, x, v = y  # what the chambers hold, position, speed
        room_a, room_b = dead + area_a * x, dead + area_b * (0.3 - x)
        p_a, p_b = bulk * (a - room_a) / room_a, bulk * (b - room_b) / room_b
        force = area_a * (p_a + p_a**2 / 2 / bulk) - area_b * (p_b + p_b**2 / 2 / bulk)
        piece = max(0.0, 1.5e6 * (x - 0.07))
        relief = max(0.0, (p_a - 150e5) / 2e10)
        return [flow - relief, -p_b / 1e9, v, (force - piece) / 50]

    y = np.array([dead + area_a * 0.02, dead + area_b * 0.28, 0.02, 0.0])
    t = 0.0
    for end in (0.1, 0.2, 0.25, 0.3, 0.4):
        got = solve_ivp(f, (t, end), y, "DOP853", rtol=1e-11, atol=1e-16, max_step=1e-3)
        t, y = end, got.y[:, -1]
        assert run["ram.position"].at(t) == pytest.approx(y[2], rel=1e-7)
        p_a = bulk * (y[0] / (dead + area_a * y[2]) - 1)
        assert run["ram.pressure_a"].at(t) == pytest.approx(p_a, rel=1e-6)
