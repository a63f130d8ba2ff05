"""Rimless wheel: its return map in closed form, from energy between steps and momentum in them."""

import math
from itertools import pairwise

import pytest
from scipy.integrate import quad

L, ALPHA, SLOPE, G, W0 = 1.0, math.pi / 8, 0.2, 9.81, 1.2


def lasting(w):
    """Return how long a step lasts that begins with the speed of turning w."""

    def inverse(angle):
        fallen = math.cos(SLOPE - ALPHA) - math.cos(SLOPE + angle)
        return 1 / math.sqrt(w**2 + 2 * G / L * fallen)

    return quad(inverse, -ALPHA, ALPHA, epsabs=1e-13, epsrel=1e-13)[0]


def steps(count, w=W0):
    """Return ``(instant, speed before, speed after)`` of each step."""
    t, found = 0.0, []
    for _ in range(count):
        t += lasting(w)
        before = math.sqrt(w**2 + 4 * G / L * math.sin(ALPHA) * math.sin(SLOPE))
        w = math.cos(2 * ALPHA) * before
        found.append((t, before, w))
    return found


@pytest.fixture(scope="module")
def run(simulate):
    return simulate("rimless_wheel", rtol=1e-8, until=2.1)


@pytest.mark.slow
def test_every_step_is_that_of_the_return_map(run):
    expected = steps(4)
    assert [e.t for e in run.events[1:]] == pytest.approx([t for t, _, _ in expected], rel=1e-7)
    for event, (_, before, after) in zip(run.events[1:], expected, strict=True):
        t = event.t
        assert run["turning"].at(t, side="left") == pytest.approx(before, rel=1e-7)
        assert run["turning"].at(t) == pytest.approx(after, rel=1e-7)
    # each step is one length of a side further, and turns the other foothold into the one that
    # carries
    side = 2 * L * math.sin(ALPHA)
    for k, (t, _, _) in enumerate(expected):
        assert run["x"].at(t) == pytest.approx((k + 0.5) * side, rel=1e-8)


@pytest.mark.slow
def test_the_impulse_of_a_step_goes_along_the_new_leg(run):
    """What it loses is the momentum along that leg, m*l*w*sin(2*alpha)."""
    for event, (_, before, after) in zip(run.events[1:], steps(4), strict=True):
        (step,) = event.steps
        (leg,) = [step.impulses[k] for k in ("odd.e", "even.e") if abs(step.impulses.get(k, 0)) > 1]
        assert leg == pytest.approx(-10 * L * before * math.sin(2 * ALPHA), rel=1e-6)
        lost = 0.5 * 10 * L**2 * (before**2 - after**2)
        assert step.energy.lost == pytest.approx(lost, rel=1e-6)


@pytest.mark.slow
def test_the_walk_settles_on_its_limit_cycle(run):
    """The difference of squares to the limit halves with each step, for cos(pi/4)^2 = 1/2."""
    c = math.cos(2 * ALPHA) ** 2
    limit = c / (1 - c) * 4 * G / L * math.sin(ALPHA) * math.sin(SLOPE)
    squares = [run["turning"].at(e.t) ** 2 for e in run.events[1:]]
    off = [limit - square for square in (W0**2, *squares)]
    for a, b in pairwise(off):
        assert b == pytest.approx(c * a, rel=1e-5)


@pytest.mark.slow
def test_on_the_limit_cycle_every_step_is_the_same(simulate):
    c = math.cos(2 * ALPHA) ** 2
    w = math.sqrt(c / (1 - c) * 4 * G / L * math.sin(ALPHA) * math.sin(SLOPE))
    run = simulate("rimless_wheel", parameters={"w0": w}, rtol=1e-7, until=1.0)
    assert [e.t for e in run.events[1:]] == pytest.approx([lasting(w), 2 * lasting(w)], rel=1e-6)
    assert run["turning"].at(run.events[2].t) == pytest.approx(w, rel=1e-6)
