"""One-way clutch, check valve, ratchet: diodes of other domains."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp


def settled(run, machine):
    """Instants and states entered of one machine."""
    return [(e.t, run.graph.mode_names(e.steps[-1].mode)[machine]) for e in run.events[1:]]


def entered(run, machine, state):
    """Instants at which a machine enters a state."""
    states = [run.graph.mode_names(e.steps[-1].mode)[machine] for e in run.events]
    pairs = zip([None, *states], states, run.events, strict=False)
    return [e.t for before, now, e in pairs if now == state != before]


def clutch_reference(until):
    """Engaged: one inertia; else two. Torque of the clutch by the balance of the shaft."""
    J1, J2, b = 0.1, 0.5, 0.8

    def torque(t):
        return 6.0 * math.cos(4.0 * t)

    def engaged(t, z):
        a = (torque(t) - b * z[1]) / (J1 + J2)
        return [a, a]

    def free(t, z):
        return [torque(t) / J1, -b * z[1] / J2]

    def passes(t, z):
        return torque(t) - J1 * engaged(t, z)[0]

    def faster(t, z):
        return z[1] - z[0]

    passes.terminal = faster.terminal = True
    passes.direction = faster.direction = -1.0
    t, z, on, events = 0.0, [0.0, 0.0], True, []
    while True:
        part = solve_ivp(
            engaged if on else free,
            (t, until),
            z,
            method="DOP853",
            rtol=1e-12,
            atol=1e-13,
            events=[passes if on else faster],
        )
        z = part.y[:, -1].copy()
        if part.status != 1:
            return events, z
        t = float(part.t[-1])
        if not on:
            z[:] = (J1 * z[0] + J2 * z[1]) / (J1 + J2)
        on = not on
        events.append((t, "conducts" if on else "blocks"))


@pytest.mark.sampled(1)
def test_one_way_clutch(simulate, solver):
    run = simulate("one_way_clutch", solver=solver)
    expected, end = clutch_reference(6.0)
    found = settled(run, "clutch")
    assert [s for _, s in found] == [s for _, s in expected]
    assert [t for t, _ in found] == pytest.approx([t for t, _ in expected], rel=1e-6)
    assert run["w1.f"].at(6.0) == pytest.approx(end[0], abs=1e-6)
    assert run["w2.f"].at(6.0) == pytest.approx(end[1], abs=1e-6)
    t = np.linspace(0.0, 6.0, 400)
    assert run["clutch.e"].at(t).min() >= -1e-9
    assert (run["w2.f"].at(t) - run["w1.f"].at(t)).min() >= -1e-6


@pytest.mark.sampled(1)
def test_check_valve(simulate, solver):
    run = simulate("check_valve", solver=solver)
    L, R, C, G = 2e7, 2e8, 2e-9, 1e-9

    def pump(t):
        return 2e5 + 3e5 * math.sin(20.0 * t)

    def opened(t, z):
        return [(pump(t) - R * z[0] - z[1]) / L, (z[0] - G * z[1]) / C]

    def closed(t, z):
        return [0.0, -G * z[1] / C]

    def flows(t, z):
        return z[0]

    def pushes(t, z):
        return pump(t) - z[1]

    flows.terminal = pushes.terminal = True
    flows.direction, pushes.direction = -1.0, 1.0
    t, z, on, events = 0.0, [0.0, 1e5], True, []
    while True:
        part = solve_ivp(
            opened if on else closed,
            (t, 2.0),
            z,
            method="DOP853",
            rtol=1e-12,
            atol=[1e-18, 1e-7],
            events=[flows if on else pushes],
            first_step=1e-4,
        )
        z = part.y[:, -1].copy()
        if part.status != 1:
            break
        t, on = float(part.t[-1]), not on
        z[0] = 0.0
        events.append((t, "conducts" if on else "blocks"))
    found = settled(run, "q")
    assert len(events) >= 10
    assert [s for _, s in found] == [s for _, s in events]
    assert [t for t, _ in found] == pytest.approx([t for t, _ in events], rel=1e-6)
    assert run["high.e"].at(2.0) == pytest.approx(z[1], rel=1e-5)
    assert run["q.f"].at(np.linspace(0.0, 2.0, 500)).min() >= -1e-14


@pytest.mark.slow
def test_ratchet(simulate):
    """The drum never turns back; the drive is felt in one direction only; what is lifted stays."""
    run = simulate("ratchet")
    t = np.linspace(0.0, 6.0, 800)
    height, drum = run["height"].at(t), run["drum.f"].at(t)
    assert drum.min() >= -1e-9
    assert np.diff(height).min() >= -1e-9
    # three strokes and the beginning of a fourth; the spring takes some of the lever's swing
    begins = entered(run, "drum", "conducts")
    assert len(begins) == 4
    assert 0.05 * 2.5 * (2 / 3) < height[-1] < 0.05 * 3.5 * (4 / 3)
    # while both pawls hold, the drum's one carries the weight: 40 N at 50 mm
    held = (drum == 0.0) & (run["driver.e"].at(t) == 0.0)
    assert held.any()
    assert run["drum.e"].at(t[held]) == pytest.approx(-2.0, rel=1e-9)
