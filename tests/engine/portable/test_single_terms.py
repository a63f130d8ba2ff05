"""What a row says of one unknown alone: the same of rows in full and of sparse ones."""

import random
from types import SimpleNamespace as Made

import pytest

from hybond.engine.algebra.blocks import make_block, make_places
from hybond.engine.mode.nonlinear.single_terms import take_single


def told(rows, right, *, sparse):
    """Return what is told of each unknown, None if nothing is."""
    n = len(rows)
    work = Made(single=make_places(1), step=make_block(n), residual=make_block(n))
    work.residual.at[:] = right
    work.jacobian = Made(at=[v for row in rows for v in row])
    held = [[(j, v) for j, v in enumerate(row) if v is not NOT_HELD] for row in rows]
    work.newton_factors = Made(
        begins=Made(at=[sum(map(len, held[:i])) for i in range(n + 1)]),
        term_of=Made(at=[j for row in held for j, _ in row]),
        term=Made(at=[v for row in held for _, v in row]),
    )
    take_single(Made(work=work), n, sparse)
    return [work.step.at[j] if work.single.at[j] else None for j in range(n)]


NOT_HELD = float("nan")
"""A term that sparse rows do not have; it is zero in full."""


def by_hand(rows, right):
    """Solve rows with one term left for it, as long as what is told is zero."""
    found = [None] * len(rows)
    while True:
        before = list(found)
        for i, row in enumerate(rows):
            left = [j for j, v in enumerate(row) if v and found[j] != 0.0]
            if len(left) == 1 and found[left[0]] is None:
                found[left[0]] = right[i] / row[left[0]]
        if found == before:
            return found


@pytest.mark.parametrize("seed", range(6))
def test_rows_in_full_and_sparse_rows_tell_the_same_though_terms_are_zero(seed):
    dice = random.Random(seed)
    some = 0
    for _ in range(60):
        n = dice.randint(1, 7)
        drawn = [
            [dice.choice((NOT_HELD, NOT_HELD, 0.0, 2.0, -4.0)) for _ in range(n)] for _ in range(n)
        ]
        right = [dice.choice((0.0, 0.0, 1.0, 3.0)) for _ in range(n)]
        full = [[0.0 if v is NOT_HELD else v for v in row] for row in drawn]
        expected = by_hand(full, right)
        assert told(full, right, sparse=False) == expected
        assert told(drawn, right, sparse=True) == expected
        some += sum(v is not None for v in expected)
    assert some > 30
