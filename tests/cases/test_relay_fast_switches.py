"""Relay feedback with fast switchings, against Taylor series of the two linear flows.

The plant is (s - 0.2)^2/(s + 1)^4. The relay enters the second rate of the output only, so that no
switching is met by another from across: what looks like sliding are thousands of switchings, each
well apart from the next. Johansson, Rantzer & Astrom, *Fast switches in relay feedback systems*,
Automatica 35, 1999; the values are those of Di Bernardo, Johansson & Vasca 2001.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.polynomial.polynomial import polyval

import hybond as hb

FILE = Path(__file__).parents[2] / "examples" / "relay_fast_switches.toml"
A = np.array([[-4, 1, 0, 0], [-6, 0, 1, 0], [-4, 0, 0, 1], [-1, 0, 0, 0]], dtype=float)
B = np.array([0.0, 1.0, -0.4, 0.04])
START = (-0.01, -0.02, -1.0, 0.5)
ON_CYCLE = (0.0, 0.0240324937, -0.9161928001, 0.4992062174)
"""On the limit cycle, just switched to y > 0 after the long swing."""
HALF_PERIOD = 11.6502241
SWITCHINGS = 2601
AHEAD = 0.25
LOOK = AHEAD * np.concatenate([[0.0], np.geomspace(1e-10, 1e-2, 120), np.linspace(0.012, 1, 200)])
STATES = ("x1.q", "x2.q", "x3.q", "x4.q")


@cache
def switchings(until, start):
    """Return ``(t, x)`` of the switchings, and the state at `until`."""
    flow = {s: np.vstack([np.column_stack([A, -s * B]), np.zeros(5)]) for s in (1, -1)}
    t, z, s = 0.0, np.array([*start, 1.0]), 1 if start[0] >= 0.0 else -1
    found = []
    while True:
        terms = [z]
        for k in range(1, 26):
            terms.append(flow[s] @ terms[-1] / k)
        series = np.array(terms)
        over = np.flatnonzero(s * polyval(LOOK[1:], series[:, 0]) < 0.0)
        h = AHEAD
        if len(over):
            low, h = LOOK[over[0]], LOOK[over[0] + 1]
            while low < (middle := 0.5 * (low + h)) < h:
                if s * polyval(middle, series[:, 0]) < 0.0:
                    h = middle
                else:
                    low = middle
        if t + h > until:
            return found, polyval(until - t, series)[:4]
        t, z = t + h, polyval(h, series)
        if len(over):
            z[0], s = 0.0, -s
            found.append((t, z[:4].copy()))


@pytest.mark.slow
def test_half_a_cycle_is_a_map_onto_its_mirror_image():
    found, x = switchings(HALF_PERIOD + 1e-3, ON_CYCLE)
    assert len(found) == SWITCHINGS
    t, x = found[-1]
    assert t == pytest.approx(HALF_PERIOD, abs=1e-7)
    assert x == pytest.approx([-a for a in ON_CYCLE], abs=1e-9)
    # all but the last within 4.2 s; the last after the long swing to the other side
    assert found[-2][0] == pytest.approx(4.202416, abs=1e-6)
    # each crosses: the relay does not enter the rate of y, which is never zero there
    assert B[0] == 0.0
    assert min(abs(x[1]) for _, x in found) > 5e-6


@pytest.mark.slow
def test_a_half_cycle_switching_by_switching(tmp_path):
    text = FILE.read_text(encoding="utf-8")
    for old, new in zip(START, ON_CYCLE, strict=True):
        assert text.count(f"q = {old:g} ") == 1
        text = text.replace(f"q = {old:g} ", f"q = {new!r} ")
    (tmp_path / "model.toml").write_text(text, encoding="utf-8")
    until = HALF_PERIOD + 1e-3
    run = hb.simulate(hb.load(tmp_path / "model.toml"), until=until, rtol=1e-8)
    expected, x = switchings(until, ON_CYCLE)
    assert run.sliding == ()
    assert not run.warnings
    # the relay starts on the side of u = +1 and is at its surface at once
    times = [e.t for e in run.events[1:] if e.t > 1e-12]
    assert len(times) == SWITCHINGS
    assert times == pytest.approx([t for t, _ in expected], abs=2e-6)
    assert [float(run[s].at(until)) for s in STATES] == pytest.approx(x, abs=1e-6)


def test_published_start(simulate):
    run = simulate("relay_fast_switches", rtol=1e-9)
    until = run.until
    expected, x = switchings(until, START)
    assert [e.t for e in run.events[1:]] == pytest.approx([t for t, _ in expected], abs=1e-8)
    assert [float(run[s].at(until)) for s in STATES] == pytest.approx(x, abs=1e-8)
    assert run.sliding == ()
