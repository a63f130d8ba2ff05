"""One-sided laws decided with twice the digits, against all branches in fractions."""

from __future__ import annotations

import itertools
from fractions import Fraction

import numpy as np
import pytest

from hybond.engine.complementarity.decided_closely import (
    decide_closely,
    make_closer,
    put_entry,
    put_known,
)

Matrix = list[list[float]]


def exact(d: Matrix, ce: Matrix, y: list[float], rate: list[float], h: float) -> list[list[int]]:
    """Return which laws give something in each answer, by solving every choice in fractions."""
    n = len(y)
    step = Fraction(h)
    m = [[Fraction(d[i][j]) + step * Fraction(ce[i][j]) for j in range(n)] for i in range(n)]
    q = [Fraction(y[i]) + step * Fraction(rate[i]) for i in range(n)]
    found = []
    for choice in itertools.product((0, 1), repeat=n):
        on = [k for k in range(n) if choice[k]]
        rows = [[m[i][j] for j in on] + [-q[i]] for i in on]
        for c in range(len(on)):
            p = next((r for r in range(c, len(on)) if rows[r][c] != 0), None)
            if p is None:
                break
            rows[c], rows[p] = rows[p], [x / rows[p][c] for x in rows[c]] if p == c else rows[c]
            if p != c:
                rows[c] = [x / rows[c][c] for x in rows[c]]
            for r in range(len(on)):
                if r != c:
                    rows[r] = [a - rows[r][c] * b for a, b in zip(rows[r], rows[c], strict=True)]
        else:
            l = dict(zip(on, (row[-1] for row in rows), strict=True))
            w = [q[i] + sum(m[i][j] * x for j, x in l.items()) for i in range(n)]
            if all(x >= 0 for x in l.values()) and all(x >= 0 for x in w):
                found.append(list(choice))
    return found


def asked(
    d: Matrix, ce: Matrix, y: list[float], rate: list[float], h: float
) -> tuple[bool, list[int]]:
    n = len(y)
    p = make_closer(n)
    p.n = n
    for i in range(n):
        put_known(p, i, y[i], h, rate[i])
        for j in range(n):
            put_entry(p, i * n + j, d[i][j], h, ce[i][j])
    return decide_closely(p), [int(p.active[k]) for k in range(n)]


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("leak", [1e-3, 1e-7, 3e-9])
def test_feedthroughs_that_a_leak_alone_tells_apart(leak: float, seed: int) -> None:
    """Four diodes of a bridge: one current passes all of them at once, storage moves two more."""
    rng = np.random.default_rng(seed)
    whole = 256.0 * np.outer([1, -1, 1, -1], [1, -1, 1, -1])
    whole += leak * np.outer([0, 1, 0, 0], [0, 1, 0, 0])
    turn = np.array([[1.0, -1.0, -1.0, 1.0], [1.0, 1.0, -1.0, -1.0]])
    stored = 200.0 * np.outer(turn[0], turn[0]) + 60.0 * np.outer(turn[1], turn[1])
    drop = rng.choice([-3.5e-9, -1.05e-8, 3.5e-9])
    y = [drop, -3.0 * abs(drop), drop, -drop]
    rate = list(rng.choice([-5e4, 5e4], 4) + rng.normal(size=4))
    d, ce = whole.tolist(), stored.tolist()
    found, active = asked(d, ce, y, rate, 7e-17)
    answers = exact(d, ce, y, rate, 7e-17)
    if found:
        assert answers == [active]
    else:
        assert len(answers) != 1


def test_a_matrix_that_is_singular_to_rounding_alone_decides_nothing() -> None:
    """The sixteenth digit of what acts at once is not known: nothing hangs on it."""
    d = [[1.0, 1.0], [1.0, 1.0 + 4e-15]]
    assert not asked(d, [[1.0, 0.0], [0.0, 1.0]], [-1.0, -1.0], [1.0, 2.0], 1e-17)[0]
    d = [[1.0, 1.0], [1.0, 1.0]]
    assert asked(d, [[1.0, 0.0], [0.0, 1.0]], [-1.0, -1.0], [1.0, 2.0], 1e-17)[0]
