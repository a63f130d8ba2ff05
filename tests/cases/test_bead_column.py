"""Column of beads: every impact by Newton's law, flights by parabolas."""

import math

import numpy as np
import pytest

G, D, EPS = 9.81, 0.2, 0.9


def collisions(n, until):
    """Return ``(t, contact)`` of the impacts and the state at the end: all weigh the same."""
    x = np.array([1.0 + 0.25 * k for k in range(n)])
    v = np.zeros(n)
    t, found = 0.0, []
    while True:
        # two beads approach uniformly: gravity drops out of all gaps but the lowest
        waits = [(v[0] + math.sqrt(v[0] ** 2 + 2.0 * G * max(x[0] - D / 2, 0.0))) / G]
        for k in range(1, n):
            closing = v[k - 1] - v[k]
            gap = max(x[k] - x[k - 1] - D, 0.0)
            waits.append(gap / closing if closing > 0.0 else math.inf)
        who = int(np.argmin(waits))
        dt = min(waits[who], until - t)
        x += v * dt - 0.5 * G * dt * dt
        v -= G * dt
        t += dt
        if t >= until:
            return found, x, v
        if who == 0:
            v[0] = -EPS * v[0]
        else:
            a, b = v[who - 1], v[who]
            v[who - 1] = ((1 - EPS) * a + (1 + EPS) * b) / 2
            v[who] = ((1 + EPS) * a + (1 - EPS) * b) / 2
        found.append((t, f"contact{who}"))


def test_ten_beads(simulate):
    until = 0.55
    run = simulate("bead_column", until=until)
    expected, x, v = collisions(10, until)
    assert len(expected) > 50
    found = [(e.t, f.machine) for e in run.events[1:] for f in e.steps[0].fired]
    assert [name for _, name in found] == [name for _, name in expected]
    assert [t for t, _ in found] == pytest.approx([t for t, _ in expected], rel=1e-8)
    for k in range(10):
        assert run[f"x{k + 1}"].at(until) == pytest.approx(x[k], rel=1e-7)
        assert run[f"bead{k + 1}.v.f"].at(until) == pytest.approx(v[k], abs=1e-6)


def test_energy_is_lost_at_impacts_only(simulate):
    run = simulate("bead_column")
    lost = sum(s.energy.lost for e in run.events for s in e.steps if s.energy is not None)
    t = run.t_end
    kinetic = sum(0.5 * run[f"bead{k}.v.f"].at(t) ** 2 for k in range(1, 11))
    height = sum(run[f"x{k}"].at(t) for k in range(1, 11)) - (10 * 1.0 + 0.25 * 45)
    assert kinetic + G * height + lost == pytest.approx(0.0, abs=1e-8)
