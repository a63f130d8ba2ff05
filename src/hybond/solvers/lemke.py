"""Lemke's algorithm for z >= 0, w = M z + q >= 0, z'w = 0.

Pivoting decides *which* of each pair is zero, as a mode does; the values then follow from one
linear solve with that choice, so that they are as accurate as any other linear solve.

References
----------
C. E. Lemke, *Bimatrix equilibrium points and mathematical programming*, Management Science
11(7):681-689, 1965.
R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*, Academic Press 1992:
algorithm 4.4.1 (Lemke), 4.9 (lexicographic ratio test).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybond.solvers.pivoting import FloatArray, Mask, balance, independent, lemke_path, principal

TOL = 1e-11
"""What counts as zero after scaling: entries of about one, the largest of q one."""

_HUGE = 1e12
"""A scaled solution beyond it comes from a matrix that is singular but for rounding."""

_MEANT = 1e-9
"""A component of q that is not below it, relative to the largest, is no rounding."""

_ROUNDS = 5
"""How often a path is taken up again from its own end because rounding had misled it."""


@dataclass(frozen=True)
class Solution:
    """What was found, and by which choice of zeros.

    Attributes
    ----------
    z, w : ndarray, shape (n,)
        The pairs (for `mixed`: a and b); NaN unless `status` is "solved".
    active : ndarray, shape (n,)
        Mask of the pairs whose z is basic, the rest has z = 0. For `boxed`: -1 at the lower
        bound, 1 at the upper one, 0 between. It is what a later call takes as `start`.
    status : str
        "solved"; "ray": the path ended on a secondary ray; "limit": too many pivots;
        "singular": no choice of one unknown of each pair leaves a regular matrix.
    pivots : int
        Number of pivots after the principal one to `start`.
    degenerate : tuple of int
        Pairs of which both are zero: their choice in `active` is arbitrary.
    ray : ndarray or None
        Direction of z along the secondary ray.
    infeasible : bool
        True if the ray proves that no z >= 0 has M z + q >= 0: M'ray <= 0 and q'ray < 0
        (Farkas). A ray that does not prove it leaves the question open.
    free : ndarray
        The free unknowns c of `mixed`.
    singular : tuple of int
        Pairs that no choice makes regular; n + k stands for the free unknown k.
    """

    z: FloatArray
    w: FloatArray
    active: NDArray[Any]
    status: str
    pivots: int
    degenerate: tuple[int, ...] = ()
    ray: FloatArray | None = None
    infeasible: bool = False
    free: FloatArray | None = None
    singular: tuple[int, ...] = ()


def lemke(
    M: ArrayLike,
    q: ArrayLike,
    *,
    start: ArrayLike | None = None,
    cover: ArrayLike | None = None,
    max_pivots: int | None = None,
    tol: float = TOL,
) -> Solution:
    """Find z >= 0, w = M z + q >= 0, z'w = 0 by Lemke's algorithm with lexicographic ratio test.

    Parameters
    ----------
    M : array_like, shape (n, n)
        Any square matrix. If it is positive semidefinite (not necessarily symmetric), a ray
        means that there is no solution; for other matrices it need not.
    q : array_like, shape (n,)
        Constant part of w.
    start : array_like, optional
        Guess of the active set: mask, or indices, of the z that are not zero. No pivot is made
        if it is right. Dependent ones among them are left out.
    cover : array_like, shape (n,), optional
        Covering vector (positive, after scaling); ones by default.
    max_pivots : int, optional
        Default 2000 + 20 n.
    tol : float
        What counts as zero after scaling.

    Returns
    -------
    Solution
        With z = 0 and w = 0 exactly where `active` says so.

    Raises
    ------
    ValueError
        If the shapes do not fit, or a number is not finite.

    Examples
    --------
    >>> found = lemke([[2.0, 1.0], [1.0, 2.0]], [-5.0, 1.0])  # the second one stays at rest
    >>> found.status, found.z.tolist(), found.w.tolist()
    ('solved', [2.5, 0.0], [0.0, 3.5])
    >>> lemke([[0.0]], [-1.0]).infeasible
    True
    """
    matrix, q = problem(M, q)
    n = len(q)
    matrix, q, d, size = scaled(matrix, q)
    covering = np.ones(n) if cover is None else np.asarray(cover, dtype=float)
    limit = 2000 + 20 * n if max_pivots is None else max_pivots
    active = mask(start, n)
    warm = bool(active.any())
    status, pivots, ray, infeasible = "limit", 0, None, False
    for turn in range(2 * _ROUNDS):
        if warm and turn == _ROUNDS:
            # rounding leads from this guess round in a ring; another path has other roundings
            warm, active = False, np.zeros(n, dtype=bool)
        try:
            point = _point(matrix, q, active, tol)
            if point is not None:
                z, w, both = point
                return Solution(size * d * z, size * w / d, active, "solved", pivots, both)
            if pivots >= limit:
                break
            pivoted = principal(matrix, q, active)
        except np.linalg.LinAlgError:
            fewer = independent(matrix, active)
            active = fewer if fewer.sum() < active.sum() else np.zeros(n, dtype=bool)
            continue
        path = lemke_path(*pivoted, covering, limit - pivots, tol)
        pivots += path.pivots
        if path.ray is not None:
            ray = np.where(active, path.ray[:n], path.ray[n:])
            below = (matrix.T @ ray).max() <= tol * np.abs(ray).max()
            infeasible = bool(below and q @ ray < -tol * (np.abs(q) @ np.abs(ray)))
            if infeasible or not warm:
                status, active = "ray", active ^ path.active
                break
            warm, active = False, np.zeros(n, dtype=bool)  # another path may end elsewhere
        else:
            active = active ^ path.active  # its point is confirmed, or the path taken up again
    nothing = np.full(n, np.nan)
    direction = d * ray if status == "ray" and ray is not None else None
    return Solution(nothing, nothing, active, status, pivots, (), direction, infeasible)


def problem(M: ArrayLike, q: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return M and q as arrays; ValueError if they do not fit or are not finite."""
    q = np.asarray(q, dtype=float)
    matrix = np.asarray(M, dtype=float)
    if q.ndim != 1 or matrix.size != len(q) ** 2 or (len(q) and matrix.shape != (len(q),) * 2):
        raise ValueError(f"M {matrix.shape} and q {q.shape} do not fit")
    if not (np.isfinite(matrix).all() and np.isfinite(q).all()):
        raise ValueError("M or q is not finite")
    return matrix.reshape(len(q), len(q)), q


def scaled(M: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Return D M D, D q / size, D as a vector, and size: z is then z / (d size).

    The size is that of the largest of D q, unless that leaves another number, which the caller
    thinks of as large, below all tolerances: a pair with nothing but rounding in its row and
    column gets a huge d.
    """
    d = balance(M)
    raw, q = np.abs(q), d * q
    size = 1.0
    if q.any():
        meant = np.abs(q[raw >= _MEANT * raw.max()])
        size = float(np.exp2(np.round(np.log2(min(np.abs(q).max(), 1e6 * meant.min())))))
    return M * d[:, None] * d, q / size, d, size


def sizes(M: FloatArray, q: FloatArray, z: FloatArray) -> tuple[float, FloatArray]:
    """Return what z and each w of a scaled problem are compared with."""
    most = 1.0 if q.any() else float(np.finfo(float).tiny)
    return max(most, float(np.abs(z).max(initial=0.0))), np.maximum(most, np.abs(M) @ np.abs(z))


def mask(start: ArrayLike | None, n: int) -> Mask:
    """Return a guess of the active set, mask or indices, as a new mask."""
    if start is None:
        return np.zeros(n, dtype=bool)
    given = np.asarray(start)
    if given.dtype == bool:
        if given.shape != (n,):
            raise ValueError(f"start {given.shape} does not fit {n} pairs")
        return given.copy()
    chosen = np.zeros(n, dtype=bool)
    chosen[given.astype(np.intp)] = True
    return chosen


def _point(
    M: FloatArray, q: FloatArray, active: Mask, tol: float
) -> tuple[FloatArray, FloatArray, tuple[int, ...]] | None:
    """Return z, w and the degenerate pairs of an active set, None if one is negative."""
    z = np.zeros(len(q))
    if active.any():
        z[active] = np.linalg.solve(M[np.ix_(active, active)], -q[active])
    if not np.abs(z).max(initial=0.0) < _HUGE:
        raise np.linalg.LinAlgError("singular")
    w = M @ z + q
    w[active] = 0.0
    of_z, of_w = sizes(M, q, z)
    z_rel, w_rel = z / of_z, w / of_w
    if min(z_rel.min(initial=0.0), w_rel.min(initial=0.0)) < -tol:
        return None
    both = tuple(int(i) for i in np.flatnonzero((z_rel <= tol) & (w_rel <= tol)))
    return np.maximum(z, 0.0), np.maximum(w, 0.0), both
