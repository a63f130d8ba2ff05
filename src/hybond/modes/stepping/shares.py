"""Shares of laws that depend on each other: a table on four legs, diodes in parallel.

Laws may have many solutions over a step that store the same (`Coupling.still`). Of these this is
the one of least leakage, as everywhere else
(`equations.leakage`): the least sum of squares of what flows through conducting junctions and of
what blocking ones hold, each in SI. It does not depend on the order of elements, equal parts
take equal shares, and no law is left: diodes never share by letting current back.

The conditions for the least norm of ``l + N t`` between bounds are again a complementarity problem.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.equations.leakage import null_space
from hybond.solvers.lcp import lemke

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]

SAME = 1e-9
"""Shares that differ by less of the largest are the same."""


def least_shares(
    l: Vector,
    still: Matrix,
    *,
    low: Vector,
    high: Vector,
    others: Matrix | None = None,
    flows: Vector | None = None,
) -> tuple[Vector, list[int]]:
    """Return the solution of least leakage, and which of its parts were open.

    Parameters
    ----------
    l : array, shape (n,)
        A solution: what all laws carry and hold.
    still : array, shape (n, k)
        A basis of what may be added to it.
    low, high : array, shape (n,)
        Bounds; equal where it stays.
    others : array, shape (m, n), optional
        What leaks elsewhere (at junctions that machines switch), by `l`.
    flows : array, shape (m,), optional
        How much that is now.

    Examples
    --------
    Two diodes in parallel, and a third that must not carry any more than it does:

    >>> still = np.array([[1.0, 0.0], [-1.0, 1.0], [0.0, -1.0]])
    >>> low, high = np.zeros(3), np.array([np.inf, np.inf, 1.0])
    >>> shares, open_ = least_shares(np.array([5.0, 0.0, 1.0]), still, low=low, high=high)
    >>> shares.round(9).tolist(), open_
    ([2.5, 2.5, 1.0], [0, 1])
    """
    fixed = low >= high
    basis = still @ null_space(still[fixed]) if fixed.any() else still
    # what cancels but for rounding moves nothing, and asks for no bound
    basis = np.where(np.abs(basis) > SAME * np.abs(still).max(initial=0.0), basis, 0.0)
    basis = basis[:, np.abs(basis).max(axis=0, initial=0.0) > 0.0]
    if not basis.shape[1]:
        return l, []
    A, b = basis, l
    if others is not None and flows is not None and len(others):
        A, b = np.vstack([basis, others @ basis]), np.concatenate([l, flows])
    # orthonormal columns: the normal equations are then as good as the basis
    onto, triangle = np.linalg.qr(A)
    basis = basis @ np.linalg.inv(triangle)
    t = -(onto.T @ b)
    below, above = ~fixed & np.isfinite(low), ~fixed & np.isfinite(high)
    rows = np.vstack([basis[below], -basis[above]])
    room = np.concatenate([(l - low)[below], (high - l)[above]])
    room = np.maximum(room, 0.0)
    if (rows @ t + room < 0.0).any():
        found = lemke(rows @ rows.T, rows @ t + room)
        if found.status != "solved":
            return l, _touched(basis)
        t = t + rows.T @ found.z
    shares = np.clip(l + basis @ t, low, high)
    size = max(float(np.abs(l).max(initial=0.0)), float(np.abs(shares).max(initial=0.0)))
    near = SAME * size
    shares = np.where(shares - low <= near, low, np.where(high - shares <= near, high, shares))
    inside = (shares > low) & (shares < high)
    left = null_space(basis[~inside]) if not inside.all() else np.eye(basis.shape[1])
    moved = np.abs(shares - l) > near
    return shares, sorted({*_touched(basis @ left), *np.flatnonzero(moved).tolist()})


def _touched(basis: Matrix) -> list[int]:
    """Return the ports that a basis moves."""
    size = np.abs(basis).max(axis=1, initial=0.0)
    return [int(k) for k in np.flatnonzero(size > SAME * size.max(initial=0.0))]
