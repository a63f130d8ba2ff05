"""Automatic gearbox: every speed is made of straight lines, found by hand from the torques."""

import numpy as np
import pytest

ENGINE, RING, SUN, ARM, CAR = range(5)
INERTIA = np.diag([0.25, 0.02, 0.03, 0.04, 2.0])
SETS = ([0, 2, 1, 0, -3], [0, 0, 1, -3, 2])  # w_sun + 2 w_ring - 3 w_carrier = 0, twice
T_ENG, T_LOAD = 150.0, 100.0
LAUNCH, DIRECT = [1, -1, 0, 0, 0], [1, 0, -1, 0, 0]
BAND, LOW = [0, 0, 1, 0, 0], [0, 0, 0, 1, 0]


def accelerations(torques, slips, locked):
    """Newton's law: `slips` are linings ``(row, torque)``, `locked` rows that stay at zero."""
    rows = np.array([*SETS, *locked], dtype=float)
    n = len(rows)
    matrix = np.block([[INERTIA, rows.T], [rows, np.zeros((n, n))]])
    load = np.array(torques, dtype=float)
    for row, torque in slips:
        load = load - torque * np.array(row)
    return np.linalg.solve(matrix, np.concatenate([load, np.zeros(n)]))[:5]


def phases():
    """Yield ``(t, speeds)`` at each change: by hand, each phase until its condition is met."""
    t, w = 0.2, np.array([100.0, 0, 0, 0, 0])
    drive = [T_ENG, 0, 0, 0, -T_LOAD]
    yield t, w
    # launch: the clutch slips from engine to ring; first: it has locked
    plan = [
        ([(LAUNCH, 250.0)], [LOW], LAUNCH, 0.0),
        ([], [LAUNCH, LOW], [0, 0, 0, 0, 1], 60.0),
        # to second: the sun turns backwards, and the band brakes it
        ([(BAND, -150.0)], [LAUNCH], BAND, 0.0),
        ([], [LAUNCH, BAND], [0, 0, 0, 0, 1], 110.0),
        # to third: the engine is faster than the sun
        ([(DIRECT, 120.0)], [LAUNCH], DIRECT, 0.0),
    ]
    for slips, locked, row, value in plan:
        a = accelerations(drive, slips, locked)
        t, w = (
            t + (value - np.dot(row, w)) / (np.dot(row, a)),
            w + a * (value - np.dot(row, w)) / (np.dot(row, a)),
        )
        yield t, w
    a = accelerations(drive, [], [LAUNCH, DIRECT])
    yield 3.0, w + a * (3.0 - t)


@pytest.fixture(scope="module")
def run(simulate):
    return simulate("automatic_gearbox", rtol=1e-9)


def test_shifts_and_locks_are_where_the_straight_lines_meet(run):
    expected = list(phases())
    assert [e.t for e in run.events[1:]] == pytest.approx([t for t, _ in expected[:-1]], rel=1e-8)
    for t, speeds in expected:
        found = [run[f"w_{n}.f"].at(t) for n in ("eng", "ring", "sun", "arm", "out")]
        assert found == pytest.approx(list(speeds), abs=1e-6)


def test_locked_gears_have_the_ratios_of_their_teeth(run):
    for t, ratio in ((0.7, 2.5), (1.5, 1.5), (2.5, 1.0)):
        assert run["w_eng.f"].at(t) / run["w_out.f"].at(t) == pytest.approx(ratio, rel=1e-9)
    assert run["w_sun.f"].at(1.5) == pytest.approx(0.0, abs=1e-9)
    assert run["w_arm.f"].at(0.7) == pytest.approx(0.0, abs=1e-9)


def test_a_band_without_slip_would_take_the_speeds_that_momentum_gives(run):
    """The lining's torque moves momentum as an impulse would: where it locks depends on the torque
    only by what engine and load do meanwhile.
    """
    (begun, before), (locked, after) = list(phases())[2:4]
    outside = np.array([T_ENG, 0, 0, 0, -T_LOAD]) * (locked - begun)
    rows = np.array([*SETS, LAUNCH, BAND], dtype=float)
    matrix = np.block([[INERTIA, rows.T], [rows, np.zeros((4, 4))]])
    jump = np.linalg.solve(matrix, np.concatenate([INERTIA @ before + outside, np.zeros(4)]))[:5]
    assert jump == pytest.approx(after)
    found = [run[f"w_{n}.f"].at(locked) for n in ("eng", "ring", "sun", "arm", "out")]
    assert found == pytest.approx(list(jump), abs=1e-6)
