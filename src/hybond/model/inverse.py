"""The inverse of the matrix of a storage field, each entry to its last digit.

Windings that are coupled by 0.999 have an inverse a thousand times what their inductances are one
by one. Entries that are the same by symmetry must come out the same then: elimination adds and
subtracts them, and what is left of a difference of rounding looks like an element that is lost.
"""

from __future__ import annotations

from collections.abc import Sequence
from operator import mul
from typing import Any

ROUNDS = 4
"""At the most; each makes the error the square of what it was, as long as that is less."""


def inverse_of(matrix: Sequence[Sequence[float]]) -> list[list[float]]:
    """Return the inverse of a symmetric matrix, symmetric.

    What is found in floating point is refined by residuals that are exact (Higham, *Accuracy and
    Stability of Numerical Algorithms*, 2002, section 14.5).

    Parameters
    ----------
    matrix : sequence of sequence of float, shape (n, n)
        Finite and symmetric to rounding; far enough from singular for floating point.

    Examples
    --------
    >>> inverse_of([[2.0, 1.0], [1.0, 1.0]])
    [[1.0, -1.0], [-1.0, 2.0]]
    """
    import numpy as np

    whole = np.array(matrix, dtype=float)
    found = np.linalg.inv(whole)
    if not np.isfinite(found).all():
        return _rows(found)
    worst = np.inf
    for _ in range(ROUNDS):
        lacks = _residual(whole.tolist(), found.tolist())
        terms = np.abs(whole) @ np.abs(found)
        shares = np.divide(np.abs(lacks), terms, out=np.zeros_like(terms), where=terms > 0.0)
        last, worst = worst, shares.max()
        if not worst < last:
            break
        found = found + found @ lacks
    # to rounding of its largest terms it is symmetric; small ones have none to spare
    halves = 0.5 * (found + found.T)
    return _rows(halves)


def _residual(matrix: list[list[float]], found: list[list[float]]) -> Any:
    """Return what the product of two matrices lacks to one, each entry rounded once."""
    import numpy as np

    rows, one = _integers(matrix)
    columns, other = _integers([list(c) for c in zip(*found, strict=True)])
    unit = one * other
    return np.array(
        [
            [
                (unit * (i == k) - sum(map(mul, row, column))) / unit
                for k, column in enumerate(columns)
            ]
            for i, row in enumerate(rows)
        ]
    )


def _integers(rows: list[list[float]]) -> tuple[list[list[int]], int]:
    """Return numbers as integers, and by what they are divided: a power of two."""
    pairs = [[v.as_integer_ratio() for v in row] for row in rows]
    unit = max(below for row in pairs for _, below in row)
    return [[above * (unit // below) for above, below in row] for row in pairs], unit


def _rows(found: Any) -> list[list[float]]:
    rows: list[list[float]] = found.tolist()
    return rows
