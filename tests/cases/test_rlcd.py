"""Oscillator of 10 mH and 1 uF with 1 kohm and an ideal diode across it, from 10 V."""

import math

import pytest

L, C, R = 10e-3, 1e-6, 1e3
W0 = 1.0 / math.sqrt(L * C)
DAMPING = 1.0 / (2.0 * R * C)
W = math.sqrt(W0**2 - DAMPING**2)
HALF = math.pi / W0  # the diode blocks for half a period of the undamped oscillator
FULL = math.pi / W  # and conducts for half a period of the damped one

# published: times of switching, and the current of L there
TIMES = [152.268e-6, 466.4273e-6, 780.980e-6, 1095.1392e-6, 1409.6919e-6]
CURRENTS = {152.268e-6: 92.6692e-3, 780.980e-6: 79.1829e-3}


def first_end() -> tuple[float, float]:
    """Time and current at the first zero of the damped voltage, which starts at 10 V."""
    t = math.atan2(W, DAMPING) / W
    return t, 10.0 / (L * W) * math.exp(-DAMPING * t) * math.sin(W * t)


def switching(until: float) -> list[float]:
    times, t, blocks = [], first_end()[0], True
    while t < until:
        times.append(t)
        t += HALF if blocks else FULL
        blocks = not blocks
    return times


def state(t: float) -> tuple[float, float]:
    """Voltage, and current of L, in closed form."""
    if t < first_end()[0]:
        decay = math.exp(-DAMPING * t)
        v = 10.0 * decay * (math.cos(W * t) - DAMPING / W * math.sin(W * t))
        return v, 10.0 / (L * W) * decay * math.sin(W * t)
    k, since = [(k, t - s) for k, s in enumerate(switching(t + 1e-12)) if s <= t][-1]
    # at every switching the voltage is zero, and the current has changed its sign
    current = first_end()[1] * (-1) ** k * math.exp(-DAMPING * FULL * (k // 2))
    if k % 2 == 0:
        v = -current * math.sqrt(L / C) * math.sin(W0 * since)
        return v, current * math.cos(W0 * since)
    current *= math.exp(-DAMPING * since)
    v = -current / (C * W) * math.sin(W * since)
    return v, current * (math.cos(W * since) + DAMPING / W * math.sin(W * since))


@pytest.mark.sampled(1)
def test_switches_when_published(simulate, modes_of, solver):
    run = simulate("rlcd", solver=solver)
    times = [e.t for e in run.events[1:]]
    assert times[:5] == pytest.approx(TIMES, rel=1e-6)
    assert times == pytest.approx(switching(5e-3), rel=1e-6)
    states = [modes_of(run, e) for e in run.events]
    for k, steps in enumerate(states):
        assert steps == [(("blocks" if k % 2 else "conducts",), "continuous")]
    for t, current in CURRENTS.items():
        event = next(e for e in run.events if e.t == pytest.approx(t, rel=1e-6))
        assert run["L.f"].at(event.t) == pytest.approx(current, rel=2e-6)


@pytest.mark.sampled(1)
def test_state_is_the_published_one(simulate, solver):
    run = simulate("rlcd", solver=solver)
    assert run["C.e"].at(4.98e-3) == pytest.approx(2.631046, rel=1e-5)
    assert run["L.f"].at(4.98e-3) == pytest.approx(-13.8898e-3, rel=1e-5)
    for t in [k * 0.17e-3 for k in range(1, 29)]:
        v, i = state(t)
        assert run["C.e"].at(t) == pytest.approx(v, rel=1e-5, abs=1e-6)
        assert run["L.f"].at(t) == pytest.approx(i, rel=1e-5, abs=1e-8)


def test_diode_conducts_or_blocks(simulate):
    run = simulate("rlcd")
    t = [k * 1e-5 for k in range(501)]
    found = run.sample(t, ["d.f", "d.e"])
    assert min(found["d.f"]) >= -1e-12
    assert max(found["d.e"]) <= 1e-9
    assert max(abs(found["d.f"] * found["d.e"])) == 0.0
    # it does both
    assert max(found["d.f"]) == pytest.approx(10e-3)
    assert min(found["d.e"]) < -9.0
