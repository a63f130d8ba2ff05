"""Cam and follower against flights in closed form and an own event search."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

M, K, EPS = 1.221, 1430.8, 0.8
W = 358.0 * 2.0 * math.pi / 60.0
R1, K1, R3, K3, TOP, BASE, DOWN = 0.85, 0.45, 0.15, 0.40393320723821, 0.55393320723821, 0.40, 0.3
B2, B3 = 1.050328174371336, 7.0 * math.pi / 18.0
W0 = math.sqrt(K / M)


def cam(t):
    """Lift, velocity, acceleration: distance from the axis to a circle, with polar angle."""
    turned = (W * t - math.pi / 2) % (2.0 * math.pi)
    way = 1.0 if turned < math.pi / 2 else -1.0
    x = turned if turned <= math.pi / 2 else math.pi - turned  # angle on the rising side
    if turned > math.pi or x >= B3:
        return (BASE if turned > math.pi else TOP) - DOWN, 0.0, 0.0
    # r(x) = d cos(x - x0) + sqrt(r^2 - d^2 sin^2(x - x0)), centre at distance d and angle x0
    d, x0, r = (K1, -math.pi, R1) if x < B2 else (K3, math.pi / 2 - math.pi / 9, R3)
    u = x - x0
    root = math.sqrt(r * r - (d * math.sin(u)) ** 2)
    lift = d * math.cos(u) + root
    first = -d * math.sin(u) - d * d * math.sin(u) * math.cos(u) / root
    inner = d * d * math.sin(u) * math.cos(u)
    second = -d * math.cos(u) - d * d * math.cos(2.0 * u) / root - inner * inner / root**3
    return lift - DOWN, way * W * first, W * W * second


def test_the_profile_is_smooth():
    """The published arcs meet with a common tangent."""
    for x in (0.0, B2, B3, math.pi - B3, math.pi - B2, math.pi):
        t = (x + math.pi / 2) / W
        below, above = cam(t - 1e-9), cam(t + 1e-9)
        assert below[0] == pytest.approx(above[0], abs=1e-7)
        assert below[1] == pytest.approx(above[1], abs=1e-4)


@pytest.mark.slow
def test_the_model_has_this_profile(simulate):
    run = simulate("cam_follower", until=0.2)
    for t in np.linspace(0.0, 0.2, 57):
        assert run["lift"].at(t) == pytest.approx(cam(t)[0], rel=1e-12)
        assert run["speed"].at(t) == pytest.approx(cam(t)[1], rel=1e-9, abs=1e-9)


def flight(t0, y0, v0):
    def at(t):
        s, c = math.sin(W0 * (t - t0)), math.cos(W0 * (t - t0))
        return y0 * c + v0 / W0 * s, v0 * c - y0 * W0 * s

    return at


def reference(until):
    """Return ``(t, what)`` for lift-offs and impacts, up to flights that last 0.1 ms."""
    t, closed, found, at = 0.0, True, [], None
    step = 2e-5

    def force(s):
        lift, _, acceleration = cam(s)
        return M * acceleration + K * lift

    while t < until:
        watch = force if closed else (lambda s, at=at: at(s)[0] - cam(s)[0])
        a = t + (1e-9 if closed else 1e-6)
        while a < until and watch(a + step) > 0.0:
            a += step
        if a >= until:
            return found
        t = brentq(watch, a, a + step, xtol=1e-15)
        lift, speed, _ = cam(t)
        if closed:
            found.append((t, "lift-off"))
            at, closed = flight(t, lift, speed), False
            continue
        found.append((t, "impact"))
        v = at(t)[1]
        at = flight(t, lift, (1.0 + EPS) * speed - EPS * v)
    return found


@pytest.mark.sampled(1)
@pytest.mark.parametrize("rtol", [1e-8, 1e-11])
def test_lift_off_and_impacts(rtol, simulate):
    run = simulate("cam_follower", rtol=rtol, until=0.34)
    expected = reference(0.34)
    assert expected[0][1] == "lift-off"
    assert sum(1 for _, what in expected if what == "impact") >= 4
    found = [e.t for e in run.events[1:] if any(f.machine == "contact" for f in e.steps[0].fired)]
    assert found == pytest.approx([t for t, _ in expected], rel=1e-6)


def ride(until):
    """Return lift-offs, impacts, and the instants from which it rides again."""
    t, lifted, hits, rides = 0.0, [], [], []

    def force(s):
        lift, _, acceleration = cam(s)
        return M * acceleration + K * lift

    def first(watch, a, step):
        while watch(a + step) > 0.0:
            a += step
            if a > until:
                return None
        return brentq(watch, a, a + step, xtol=1e-16, rtol=1e-15)

    while True:
        t = first(force, t + 1e-9, 2e-5)
        if t is None:
            return lifted, hits, rides
        lifted.append(t)
        lift, speed, _ = cam(t)
        at, flights = flight(t, lift, speed), []
        apart = 1e-3
        while apart > 2e-6:
            # the next impact: not before a tenth of the flight that constant rates would give
            start, step = t + 0.1 * apart, 0.01 * apart
            hit = first(lambda s, at=at: at(s)[0] - cam(s)[0], start, step)
            if hit is None:
                return lifted, hits, rides
            t = hit
            lift, speed, acceleration = cam(t)
            v = speed - EPS_LOW * (at(t)[1] - speed)
            at = flight(t, lift, v)
            hits.append(t)
            apart = 2.0 * (v - speed) / (acceleration + K / M * lift)
            flights.append(apart)
        # flights that are this short have constant rates: a geometric series
        t += flights[-1] / (1.0 - EPS_LOW)
        rides.append(t)


EPS_LOW = 0.3


def test_it_rides_again_after_an_accumulation(simulate, monkeypatch):
    """At 250 turns a minute the flights end on the flank: infinitely many impacts, then contact."""
    slow = 250.0 * 2.0 * math.pi / 60.0
    monkeypatch.setitem(globals(), "W", slow)
    run = simulate("cam_follower", until=0.45, parameters={"eps": EPS_LOW, "rate": slow})
    lifted, hits, rides = ride(0.45)
    assert len(rides) == 2
    assert [a.t for a in run.accumulations] == pytest.approx(rides, rel=1e-6)
    assert all(a.landed and a.machine == "contact" for a in run.accumulations)
    assert [a.ratio for a in run.accumulations] == pytest.approx([EPS_LOW] * 2, rel=2e-2)
    state = [
        (e.t, run.graph.mode_names(e.steps[-1].mode)["contact"], e.steps[0].fired)
        for e in run.events[1:]
    ]
    own = [(t, now) for t, now, fired in state if any(f.machine == "contact" for f in fired)]
    begun = [own[0][0]] + [b for (_, a), (b, now) in pairwise(own) if a == "closed"]
    assert begun == pytest.approx(lifted, rel=1e-6)
    bounces = [t for t, _ in own if t not in begun]
    assert bounces[:4] == pytest.approx(hits[:4], rel=1e-6)
    # it rides: no gap, and the cam bears spring and inertia
    for t in (0.5 * (rides[0] + lifted[1]), rides[1] + 0.01):
        lift, speed, acceleration = cam(t)
        assert run["spring.q"].at(t) == pytest.approx(lift, rel=1e-8)
        assert run["v.f"].at(t) == pytest.approx(speed, rel=1e-8, abs=1e-9)
        assert run["contact.e"].at(t) == pytest.approx(M * acceleration + K * lift, rel=1e-6)
