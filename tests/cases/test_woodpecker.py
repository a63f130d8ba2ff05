"""Woodpecker toy of Glocker and Pfeiffer, against time-stepping written from their equations."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

rO, rM, hM, lM, lG, hS, lS = 0.0025, 0.0031, 0.0058, 0.010, 0.015, 0.02, 0.0201
mM, mS, JM, JS = 0.0003, 0.0045, 5e-9, 7e-7
STIFFNESS, G, MU = 0.0056, 9.81, 0.3
RESTITUTION = (0.5, 0.0, 0.0)
INERTIA = np.array(
    [
        [mS + mM, mS * lM, mS * lG],
        [mS * lM, JM + mS * lM**2, mS * lM * lG],
        [mS * lG, mS * lM * lG, JS + mS * lG**2],
    ]
)
NORMAL = np.array([[0.0, 0.0, -hS], [0.0, hM, 0.0], [0.0, -hM, 0.0]])
TANGENT = np.array([[1.0, lM, lG - lS], [1.0, rM, 0.0], [1.0, rM, 0.0]])
PLAY = np.array([lM + lG - lS - rO, rM - rO, rM - rO])
NAMES = ("height", "angleM", "angleS")


@cache
def march(until, h):
    """Midpoint stepping of Moreau; percussions by Gauss-Seidel. Return the ends of the steps."""
    inverse = np.linalg.inv(INERTIA)
    across, along = NORMAL @ inverse, TANGENT @ inverse
    bear, drag = (across * NORMAL).sum(axis=1), (along * TANGENT).sum(axis=1)
    q, v = np.array([0.0, -(rM - rO) / hM, -0.2788]), np.array([-0.3411, 0.0, -7.4583])
    found = [q]
    for _ in range(round(until / h)):
        half = q + 0.5 * h * v
        moment = STIFFNESS * (half[2] - half[1])
        push = [-(mS + mM) * G, -mS * lM * G + moment, -mS * lG * G - moment]
        u = v + h * (inverse @ push)
        touching = [k for k in range(3) if PLAY[k] + NORMAL[k] @ half <= 1e-12]
        P, F = np.zeros(3), np.zeros(3)
        change = 1.0 if touching else 0.0
        while change > 1e-12:
            change = 0.0
            for k in touching:
                back = NORMAL[k] @ u + RESTITUTION[k] * (NORMAL[k] @ v)
                new = max(0.0, P[k] - back / bear[k])
                u, change = u + across[k] * (new - P[k]), max(change, bear[k] * abs(new - P[k]))
                P[k] = new
                new = min(MU * P[k], max(-MU * P[k], F[k] - TANGENT[k] @ u / drag[k]))
                u, change = u + along[k] * (new - F[k]), max(change, drag[k] * abs(new - F[k]))
                F[k] = new
        q, v = half + 0.5 * h * u, u
        found.append(q)
    return np.array(found)


def difference(run, points, h, times):
    """Largest difference of the angles, and of heights in units of the sleeve's length."""
    ours = np.array([[float(run[n].at(t)) for n in NAMES] for t in times])
    theirs = points[[round(t / h) for t in times]]
    return (np.abs(ours - theirs) / [lM, 1.0, 1.0]).max()


LOCKED_AND_FALLING = (0.02, 0.04, 0.06, 0.072, 0.0776)
PECKED = (0.08, 0.084, 0.088, 0.096)


@pytest.mark.slow
def test_against_stepping(simulate):
    """The steps come closer with their square before the first impact, with themselves after."""
    run = simulate("woodpecker", rtol=1e-9)
    assert run.status == "ok"
    for h in (1.6e-4, 4e-5):
        points = march(0.1, h)
        assert difference(run, points, h, LOCKED_AND_FALLING) < 4e3 * h**2
        assert difference(run, points, h, PECKED) < 100.0 * h


@pytest.mark.slow
def test_what_happens(simulate):
    """The sleeve lets go, its upper edge strikes, the beak pecks, the upper edge strikes again."""
    run = simulate("woodpecker")
    hits = [
        machine
        for event in run.events
        for machine, state in run.graph.mode_names(event.steps[0].mode).items()
        if state == "impact"
    ]
    assert hits == ["hit3", "hit1", "hit3"]
    for n, inside in (("angleM", (rM - rO) / hM), ("angleS", PLAY[0] / hS)):
        assert np.max(run[n].at(np.linspace(0.0, 0.1, 2001))) <= inside * (1 + 1e-9)
    # locked: the sleeve rests on its lower edge while the bird swings
    assert run["angleM"].at(0.05) == pytest.approx(-(rM - rO) / hM, rel=1e-12)


def strikes(run):
    """Return ``(t, contact)`` of all impacts."""
    return [
        (event.t, machine)
        for event in run.events
        for step in event.steps
        for machine, state in run.graph.mode_names(step.mode).items()
        if state == "impact"
    ]


@pytest.fixture(scope="module")
def second(simulate):
    """A second of it: seven pecks."""
    return simulate("woodpecker", until=1.0)


@pytest.mark.slow
@pytest.mark.slow
def test_a_second_of_it(second):
    """The steps meet impacts up to a step late, by which all that follows is late: order one."""
    h = 4e-5
    points = march(1.0, h)
    assert difference(second, points, h, [0.04 * k for k in range(1, 16)]) < 1e3 * h
    ours = [t for t, contact in strikes(second) if contact == "hit1"]
    assert ours == pytest.approx(pecks(points[:, 2], h), abs=25 * h)
    assert second.audit().created < 1e-12


@pytest.mark.slow
def test_cycles_of_one_period(second):
    """Each cycle frees the upper edge, pecks, and locks again; cycles settle to one period."""
    ours = [t for t, contact in strikes(second) if contact == "hit1"]
    assert len(ours) == 7
    for a, b in pairwise(ours):
        between = [contact for t, contact in strikes(second) if a < t <= b]
        kept = [c for k, c in enumerate(between) if k == 0 or c != between[k - 1]]
        assert kept == ["hit3", "hit2", "hit3", "hit1"]
    # the periods swing about their limit, and come closer by the same factor
    steps = np.diff(np.diff(ours))
    factors = steps[1:] / steps[:-1]
    assert factors == pytest.approx(np.full(4, factors.mean()), abs=0.03)
    assert -0.9 < factors.mean() < -0.8
    # limit of the geometric series of their differences
    limit = ours[-1] - ours[-2] + steps[-1] * factors[-1] / (1.0 - factors[-1])
    theirs = pecks(march(1.0, 4e-5)[:, 2], 4e-5)
    assert limit == pytest.approx((theirs[-1] - theirs[0]) / 6, rel=2e-3)


def pecks(angle, h):
    """Return when the bird's angle is at its largest."""
    high = [k * h for k in range(1, len(angle) - 1) if angle[k - 1] <= angle[k] > angle[k + 1]]
    high = [t for t in high if angle[round(t / h)] > 0.115]
    return [t for k, t in enumerate(high) if k == 0 or t - high[k - 1] > 0.05]


@pytest.mark.sampled(1)
@pytest.mark.parametrize("h", [4e-4, 3e-4])
@pytest.mark.slow
def test_time_stepping_of_ours(h, simulate):
    run = simulate("woodpecker", until=0.0776, solver="moreau-jean", step=h)
    assert difference(run, march(0.1, 4e-5), 4e-5, LOCKED_AND_FALLING) < 4e3 * h**2
