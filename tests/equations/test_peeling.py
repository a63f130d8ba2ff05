"""Loops in which a tear cancels out of a value before it closes itself."""

import random

import numpy as np
import pytest

from hybond.equations.peeling import Peeling
from hybond.equations.ring import Numbers

CANCELLED = {
    7: [
        {2: -1.0, 0: -1.0, 4: -1.0, 3: -1.0},
        {3: 1.0, 1: 1.0, 6: 1.0},
        {3: 1.0, 2: -1.0, 4: 1.0, 7: 1.0},
        {6: 1.0, 0: -1.0, 4: 1.0, 7: 1.0},
        {1: 1.0, 4: -1.0, 2: -1.0, 7: 1.0},
        {0: -1.0, 3: -1.0, 2: -1.0},
        {2: -1.0, 4: 1.0, 6: -1.0, 7: 1.0},
    ],
    8: [
        {0: -1.0, 5: 1.0, 4: 1.0, 7: 1.0, 8: 1.0},
        {5: -1.0, 7: -1.0, 1: -1.0, 0: 1.0, 8: 1.0},
        {0: 1.0, 3: -1.0, 2: 1.0, 8: 2.0},
        {0: 1.0, 4: -1.0, 6: 1.0, 8: 1.0},
        {0: 1.0, 7: -1.0, 6: 1.0, 2: -1.0, 8: 2.0},
        {4: 1.0, 1: -1.0, 7: -1.0, 8: 1.0},
        {3: -1.0, 2: 1.0, 5: 1.0},
        {7: -1.0, 4: 1.0, 3: -1.0},
    ],
}
"""By the number of unknowns; the column behind them is known."""


def drawn(seed: int) -> tuple[int, list[dict[int, float]]]:
    """Return as many rows as unknowns, of ones, as junctions have them."""
    draw = random.Random(seed)
    n = draw.choice([5, 6, 7, 8])
    rows = [{k: float(draw.choice([1, -1])) for k in draw.sample(range(n), 3)} for _ in range(n)]
    for row in rows:
        if draw.random() < 0.5:
            row[n] = draw.choice([1.0, 2.0])
    return n, rows


SYSTEMS = [*CANCELLED.items(), *map(drawn, range(300))]


def test_a_tear_that_has_cancelled_is_put_nowhere() -> None:
    solved = 0
    for n, rows in SYSTEMS:
        a = np.array([[row.get(k, 0.0) for k in range(n + 1)] for row in rows])
        found = Peeling(Numbers({}), rows, n)
        if np.linalg.matrix_rank(a[:, :n]) < n:
            continue
        meant = np.linalg.solve(a[:, :n], -a[:, n])
        values = [found.value(k).get(n, 0.0) for k in range(n)]
        assert not found.free() and not found.constraints
        assert values == pytest.approx(meant.tolist(), abs=1e-12)
        solved += 1
    assert solved > 100
