"""Constraints that turn while a point moves: what a frozen descriptor leaves out.

Storage that follows other storage through a law that bends (a mass behind a crank) is held by a
constraint ``G x = 0`` whose coefficients change along the motion: its derivative is
``G x' + G' x = 0``, and the second term is none of the rows at the point. It is added to the rates
of the storage that follows, so that eliminating these gives the Jacobian of what is left.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybond.equations.linear_rows import LinearRows

Matrix = NDArray[np.float64]

ROUNDING = 1e-12
"""Part of the sizes that an entry is made of below which it is zero."""
RANK = 1e-10
"""Singular values of the scaled rows below this part of the largest count as zero."""


def turned(rows: LinearRows, kept: Sequence[int]) -> tuple[LinearRows, bool]:
    """Return rows in which the constraints of storage that is not `kept` turn with the motion.

    Returns
    -------
    rows : LinearRows
    sure : bool
        False if a constraint turns in a way that was not told: it is then as if frozen.
    """
    n = rows.stored
    follow = [k for k in range(n) if k not in set(kept)]
    if not follow or rows.straight:
        return rows, True
    turning = rows.turning()
    still = np.flatnonzero(~rows.E.any(axis=1))
    mix = _left_null(rows.A[still][:, n:])
    weight = np.abs(mix) > RANK * np.abs(mix).max(initial=0.0)
    sure = bool(turning.sure[still][weight.any(axis=0)].all())
    if not turning.A[still].any() and not turning.B[still].any():
        return rows, sure
    G = mix @ rows.A[still][:, :n]
    own = G[:, follow]
    columns = np.abs(own).max(axis=0, initial=0.0)
    if not columns.all():
        return rows, False
    lines = np.abs(own / columns).max(axis=1, initial=0.0)
    lines[lines == 0.0] = 1.0
    unit = own / columns / lines[:, None]
    if np.linalg.matrix_rank(unit, tol=RANK) < len(follow):
        return rows, False
    inverse = np.linalg.pinv(unit, rcond=RANK)
    inverse[np.abs(inverse) <= ROUNDING * np.abs(inverse).max(initial=0.0)] = 0.0
    back = inverse / columns[:, None] / lines
    mix[~weight] = 0.0
    A, B = rows.A.copy(), rows.B.copy()
    more_a, more_b = _product(back, mix, turning.A[still]), _product(back, mix, turning.B[still])
    for k, more, direct in zip(follow, more_a, more_b, strict=True):
        (rate,) = np.flatnonzero(rows.E[:, k])
        A[rate] += more
        B[rate] += direct
    return replace(rows, A=A, B=B), sure


def _product(a: Matrix, b: Matrix, c: Matrix) -> Matrix:
    """Return a product without what is rounding: as an entry it would be scaled up to matter."""
    found = a @ b @ c
    size = np.abs(a) @ np.abs(b) @ np.abs(c)
    return np.where(np.abs(found) > ROUNDING * size, found, 0.0)


def _left_null(matrix: Matrix) -> Matrix:
    """Return combinations of rows that are zero, of rows and columns that were scaled."""
    if not matrix.shape[1]:
        return np.eye(len(matrix))
    row = np.abs(matrix).max(axis=1, initial=0.0)
    row[row == 0.0] = 1.0
    scaled = matrix / row[:, None]
    column = np.abs(scaled).max(axis=0, initial=0.0)
    column[column == 0.0] = 1.0
    u, sizes, _ = np.linalg.svd(scaled / column)
    rank = int((sizes > RANK * sizes.max(initial=0.0)).sum())
    return np.asarray(u[:, rank:].T / row)
