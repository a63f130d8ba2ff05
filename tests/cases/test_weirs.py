"""Three tanks and two weirs, against exact steps of the four linear modes."""

import numpy as np
import pytest
from scipy.linalg import expm

L, R, LEAK = 0.01, 0.1, 5.0
PRINTED = {
    5: (2.046, 1.976, 0.0),
    10: (2.385, 2.303, 2.285),
    12: (2.040, 2.026, 2.040),
    15: (1.531, 1.516, 2.000),
    20: (1.000, 0.857, 2.000),
}


def matrix(first, second):
    a = np.zeros((6, 6))
    a[0, 5] = 1.0
    a[1, 1] = -1.0 / LEAK
    if first:
        a[0, 3], a[1, 3] = -1.0 / L, 1.0 / L
        a[3, 0], a[3, 1], a[3, 3] = 1.0, -1.0, -R / L
    if second:
        a[1, 4] -= 1.0 / L
        a[2, 4] = 1.0 / L
        a[4, 1], a[4, 2], a[4, 4] = 1.0, -1.0, -R / L
    return a


def on_a_grid(h, until):
    """Switch at grid points only; between them the solution is exact."""
    step = {(i, j): expm(matrix(i, j) * h) for i in (False, True) for j in (False, True)}
    z = np.zeros(6)
    z[5] = 1.0
    levels, switchings, mode = {}, 0, (False, False)
    for k in range(round(until / h)):
        now = (bool(z[0] > 1.0 or z[1] > 1.0), bool(z[1] > 2.0 or z[2] > 2.0))
        switchings += (now[0] != mode[0]) + (now[1] != mode[1])
        mode = now
        if not now[0]:
            z[3] = 0.0
        if not now[1]:
            z[4] = 0.0
        if k * h >= 10.0:
            z[5] = 0.0
        z = step[now] @ z
        t = (k + 1) * h
        if abs(t - round(t)) < 0.5 * h:
            levels[round(t)] = z[:3].copy()
    return levels, switchings


@pytest.fixture(scope="module")
def run(simulate):
    return simulate("weirs", until=20.0, rtol=1e-5)


def levels(run, t):
    return [run[f"tank{k}.e"].at(float(t)) for k in (1, 2, 3)]


def test_published_levels(run):
    for t, expected in PRINTED.items():
        assert levels(run, t) == pytest.approx(expected, abs=1.1e-3)
    # while the third tank fills, levels swing with the cycle
    assert levels(run, 8) == pytest.approx((2.104, 2.001, 1.717), abs=6e-3)
    assert not run.sliding


def test_against_exact_steps(run):
    expected, switchings = on_a_grid(2e-4, 20.0)
    for t in (5, 10, 12, 15, 20):
        assert levels(run, t) == pytest.approx(list(expected[t]), abs=2e-3)
    # a weir runs dry and wet again at once: events count both
    found = len(run.events) - 1
    assert found == pytest.approx(switchings, rel=0.06)
