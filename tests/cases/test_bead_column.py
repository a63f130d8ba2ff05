"""Column of beads: every impact by Newton's law, flights by parabolas.

The ten beads meet 722 times in 1.18 s; then contacts collapse, the lower ones first, and all rest.
Impacts are compared up to the eve of that, and the collapse itself on shorter columns.
"""

import math

import numpy as np
import pytest

import hybond as hb

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


@pytest.mark.slow
def test_ten_beads(simulate):
    until = 1.1
    run = simulate("bead_column", until=until)
    expected, x, v = collisions(10, until)
    assert len(expected) == 316
    found = [(e.t, f.machine) for e in run.events[1:] for f in e.steps[0].fired]
    assert [name for _, name in found] == [name for _, name in expected]
    assert [t for t, _ in found] == pytest.approx([t for t, _ in expected], rel=1e-8)
    for k in range(10):
        assert run[f"x{k + 1}"].at(until) == pytest.approx(x[k], rel=1e-7)
        assert run[f"bead{k + 1}.v.f"].at(until) == pytest.approx(v[k], abs=1e-6)


@pytest.mark.slow
def test_energy_is_lost_at_impacts_only(simulate):
    run = simulate("bead_column")
    lost = sum(s.energy.lost for e in run.events for s in e.steps if s.energy is not None)
    t = run.t_end
    kinetic = sum(0.5 * run[f"bead{k}.v.f"].at(t) ** 2 for k in range(1, 11))
    height = sum(run[f"x{k}"].at(t) for k in range(1, 11)) - (10 * 1.0 + 0.25 * 45)
    assert kinetic + G * height + lost == pytest.approx(0.0, abs=1e-8)


def column(n, eps):
    m = hb.Model("column", domain="translational", parameters={"eps": eps})
    for k in range(1, n + 1):
        weight, v, mass = f"weight{k}", f"v{k}", f"mass{k}"
        m.add(**{weight: hb.Se(f"-{G} N"), v: hb.One(), mass: hb.I("1 kg")})
        m.bond(f"{weight} -> {v} -> {mass}")
        m.signal(**{f"x{k}": hb.Integral(f"{v}.f", f"{1.0 + 0.25 * (k - 1)} m")})
        below = "0.1 [m]" if k == 1 else f"x{k - 1} - 0.2 [m]"
        contact = hb.Zero(law="unilateral", gap=f"x{k} - {below}", restitution="eps")
        m.add(**{f"contact{k - 1}": contact})
        m.bond(f"contact{k - 1} -> v1" if k == 1 else f"v{k - 1} -> contact{k - 1} -> {v}")
    return m


def two_to_rest(eps, slow=1e-10):
    """Return when each of two beads first rests, and when the upper one does for good.

    A rebound slower than `slow` is none: the bead rests from there, till it is hit.
    """
    gap, fall = np.array([0.9, 0.05]), np.zeros(2)  # distances below, and speeds upwards
    t, rests, first = 0.0, False, None
    while True:
        a = (0.0 if rests else -G), -G
        down = math.inf if rests else (fall[0] + math.sqrt(fall[0] ** 2 + 2 * G * gap[0])) / G
        closing, pull = fall[0] - fall[1], a[0] - a[1]
        root = math.sqrt(closing**2 + 2 * pull * gap[1])
        meet = math.inf if closing + root <= 0.0 else 2.0 * gap[1] / (closing + root)
        if gap[1] == 0.0 and pull > 0.0:
            meet = math.inf if closing + root < 0.0 else -2.0 * closing / pull
        dt = min(down, meet)
        ground = gap[0] + fall[0] * dt + 0.5 * a[0] * dt * dt
        upper = gap[1] - closing * dt - 0.5 * pull * dt * dt
        gap = np.array([ground, upper])
        fall += np.array(a) * dt
        t += dt
        if down <= meet:
            gap[0], fall[0] = 0.0, -eps * fall[0]
            if fall[0] < slow:
                fall[0], rests = 0.0, True
                first = t if first is None else first
        else:
            gap[1] = 0.0
            below, above = fall
            if rests and below - above < slow:
                return first, t
            fall[0] = ((1 - eps) * below + (1 + eps) * above) / 2
            fall[1] = ((1 + eps) * below + (1 - eps) * above) / 2
            rests = False


def test_two_beads_come_to_rest():
    first, last = two_to_rest(0.5)
    run = hb.simulate(column(2, 0.5), until=3.0)
    landed = [(a.t, a.machine) for a in run.accumulations if a.landed]
    assert landed[0] == (pytest.approx(first, rel=1e-7), "contact0")
    assert landed[-1] == (pytest.approx(last, rel=1e-7), "contact1")


@pytest.mark.sampled(1)
@pytest.mark.parametrize("n", [2, 3])
def test_at_rest_each_contact_carries_what_is_above(n):
    run = hb.simulate(column(n, 0.5), until=3.0)
    assert run.status == "ok"
    assert not run.warnings
    for k in range(n):
        assert run[f"contact{k}.e"].at(3.0) == pytest.approx((n - k) * G, rel=1e-12)
        assert run[f"x{k + 1}"].at(3.0) == pytest.approx(0.1 + 0.2 * k, abs=1e-10)
        assert run[f"v{k + 1}.f"].at(3.0) == 0.0
    lost = sum(s.energy.lost for e in run.events for s in e.steps if s.energy is not None)
    assert lost == pytest.approx(sum(G * (0.9 + 0.05 * k) for k in range(n)), rel=1e-9)
