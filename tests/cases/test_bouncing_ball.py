"""Ball on a springy floor (Margetts & Ngwompo), against exponentials of matrices.

Two linear modes, in (height, velocity, compression, 1)::

    away      h' = v, v' = -g,                  q' = -q/(C R)
    touching  h' = v, v' = -g + (q/C - R v)/m,  q' = -v
"""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

M, G, C, R, H = 1.0, 9.81, 1e-3, 0.1, 3.0
AWAY = np.array([[0, 1, 0, 0], [0, 0, 0, -G], [0, 0, -1 / (C * R), 0], [0, 0, 0, 0]], dtype=float)
TOUCHING = np.array(
    [[0, 1, 0, 0], [0, -R / M, 1 / (C * M), -G], [0, -1, 0, 0], [0, 0, 0, 0]], dtype=float
)
FORCE = np.array([0.0, -R, 1 / C, 0.0])
HEIGHT = np.array([1.0, 0.0, 0.0, 0.0])


def reference(until):
    """Return the pieces ``(t0, matrix, state at t0)``."""
    t, z = 0.0, np.array([H, 0.0, 0.0, 1.0])
    pieces = [(t, AWAY, z)]
    while True:
        matrix = pieces[-1][1]
        row = HEIGHT if matrix is AWAY else FORCE
        advance = expm(matrix * 1e-3)
        later, dt = advance @ z, 1e-3
        while row @ later > 0.0 and t + dt < until:
            later, dt = advance @ later, dt + 1e-3
        if t + dt >= until:
            return pieces
        root = brentq(
            lambda a, z=z, matrix=matrix, row=row: row @ expm(matrix * a) @ z,
            dt - 1e-3,
            dt,
            xtol=1e-15,
        )
        z = expm(matrix * root) @ z
        t += root
        pieces.append((t, TOUCHING if matrix is AWAY else AWAY, z))


@pytest.fixture(scope="module")
def pieces():
    return reference(3.0)


@pytest.mark.sampled(1)
def test_against_the_exact_solution(simulate, pieces, solver):
    run = simulate("bouncing_ball", solver=solver)
    assert run.status == "ok"
    events = [e.t for e in run.events[1:]]
    assert events == pytest.approx([p[0] for p in pieces[1:]], rel=1e-6)
    assert events[0] == pytest.approx(0.782062, abs=6e-7)
    assert run["v.f"].at(events[0], side="left") == pytest.approx(-7.672027, abs=6e-7)
    bounds = [*(p[0] for p in pieces), 3.0]
    for k, (t0, matrix, z0) in enumerate(pieces):
        # away from events by more than their tolerance
        for a in np.linspace(t0 + 1e-5, bounds[k + 1] - 1e-5, 9):
            z = expm(matrix * (a - t0)) @ z0
            assert run["height"].at(a) == pytest.approx(z[0], rel=1e-5, abs=1e-7)
            assert run["v.f"].at(a) == pytest.approx(z[1], rel=1e-5, abs=1e-5)
            assert run["pad.q"].at(a) == pytest.approx(z[2], rel=1e-5, abs=1e-7)


def test_no_state_jumps(simulate):
    run = simulate("bouncing_ball")
    for event in run.events[1:]:
        assert np.array_equal(event.before, event.after)
        assert [s.kind for s in event.steps] == ["continuous"]
        assert not event.steps[0].impulses
