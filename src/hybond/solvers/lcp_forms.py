"""Complementarity in other forms: pairs a, b on equal terms, free unknowns, boxes.

References
----------
R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*, Academic Press 1992:
1.5 (mixed, horizontal and other forms).
J. Edmonds, *Submodular functions, matroids, and certain polyhedra*, 1970 (the augmenting path).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from hybond.solvers.lemke import TOL, Solution, lemke, mask, problem
from hybond.solvers.pivoting import FloatArray, Mask, balance_sides, complementary_basis

_NOISE = 1e-14
"""What elimination leaves of a zero, coefficients being scaled to about one."""

_FAR = 1e4
"""Scaled entries beyond it say that the guessed choice is too near a singular one to reduce by."""


def mixed(
    A: ArrayLike,
    B: ArrayLike,
    q: ArrayLike,
    *,
    C: ArrayLike | None = None,
    start: ArrayLike | None = None,
    max_pivots: int | None = None,
    tol: float = TOL,
) -> Solution:
    """Find a, b >= 0 and c with A a + B b + C c = q and a_k b_k = 0 for each pair k.

    One unknown of each pair is chosen such that these n unknowns and c can be solved for: by
    complete pivoting in which each pivot takes its pair out, with exchanges along an augmenting
    path (linear matroid and partition) where that gets stuck; so "singular" means that every
    choice is singular. What is left is a standard problem, see `lemke`.

    Parameters
    ----------
    A, B : array_like, shape (n + m, n)
        Coefficients of the pairs.
    q : array_like, shape (n + m,)
        Right-hand side.
    C : array_like, shape (n + m, m), optional
        Coefficients of unknowns without sign.
    start : array_like, optional
        Guess: mask, or indices, of the pairs with a > 0.
    max_pivots, tol
        See `lemke`.

    Returns
    -------
    Solution
        a as `z`, b as `w`, c as `free`; `ray` is the direction of a.

    Examples
    --------
    >>> found = mixed([[1.0]], [[-2.0]], [4.0])  # a - 2 b = 4
    >>> found.z.tolist(), found.w.tolist()
    ([4.0], [0.0])
    """
    q = np.asarray(q, dtype=float)
    A, B = np.asarray(A, dtype=float), np.asarray(B, dtype=float)
    C = np.zeros((len(q), 0)) if C is None else np.asarray(C, dtype=float)
    n, m = A.shape[1], C.shape[1]
    if A.shape != (n + m, n) or B.shape != A.shape or C.shape != (n + m, m) or q.shape != (n + m,):
        raise ValueError(f"A {A.shape}, B {B.shape}, C {C.shape} and q {q.shape} do not fit")
    whole = np.hstack([A, B, C])
    if not (np.isfinite(whole).all() and np.isfinite(q).all()):
        raise ValueError("a coefficient is not finite")
    rows, columns = balance_sides(whole)
    whole = whole * rows[:, None] * columns
    right = rows * q
    guess = None if start is None else mask(start, n)
    is_a = guess
    reduced = None if guess is None else _reduce(whole, right, guess)
    if is_a is None or reduced is None or np.abs(reduced[:, 1:]).max(initial=0.0) > _FAR:
        basis, stuck = complementary_basis(whole, n)
        if stuck:
            nothing, none = np.full(n, np.nan), np.zeros(n, dtype=bool)
            gone = np.full(m, np.nan)
            return Solution(nothing, nothing, none, "singular", 0, free=gone, singular=stuck)
        is_a = np.isin(np.arange(n), basis)
        reduced = _reduce(whole, right, is_a)
        assert reduced is not None  # its pivots were regular
    H, h = -reduced[:n, 1:], reduced[:n, 0]
    H[np.abs(H) < _NOISE] = 0.0  # else a pair that nothing couples gets a unit from rounding
    begin = None if guess is None else guess ^ is_a
    found = lemke(H, h, start=begin, max_pivots=max_pivots, tol=tol)
    x, y = found.w, found.z
    a, b = np.where(is_a, x, y), np.where(is_a, y, x)
    c = reduced[n:, 0] - reduced[n:, 1:] @ y
    ray = found.ray
    if ray is not None:
        ray = columns[:n] * np.where(is_a, H @ ray, ray)
    return replace(
        found,
        z=columns[:n] * a,
        w=columns[n : 2 * n] * b,
        free=columns[2 * n :] * c,
        active=found.active ^ is_a,
        ray=ray,
    )


def _reduce(whole: FloatArray, right: FloatArray, is_a: Mask) -> FloatArray | None:
    """Solve for one unknown of each pair (a where `is_a`) and the free ones; None if singular.

    Column 0 is the constant, the others what each unknown of the other kind takes from it.
    """
    n = len(is_a)
    k = np.arange(n)
    kept = np.concatenate([np.where(is_a, k, n + k), np.arange(2 * n, whole.shape[1])])
    others = whole[:, np.where(is_a, n + k, k)]
    try:
        solved = np.linalg.solve(whole[:, kept], np.column_stack([right, others]))
    except np.linalg.LinAlgError:
        return None
    return np.asarray(solved, dtype=np.float64)


def boxed(
    M: ArrayLike,
    q: ArrayLike,
    low: ArrayLike,
    high: ArrayLike,
    *,
    start: ArrayLike | None = None,
    max_pivots: int | None = None,
    tol: float = TOL,
) -> Solution:
    """Find low <= z <= high, w = M z + q with w >= 0 at low, w <= 0 at high, w = 0 between.

    Dry friction: z the force within its limits, w the sliding velocity against it.

    Parameters
    ----------
    M, q
        See `lemke`.
    low, high : array_like, shape (n,) or scalars
        Bounds, may be infinite; where they are equal, w has any sign.
    start : array_like of int, shape (n,), optional
        Guess: -1 at the lower bound, 1 at the upper one, 0 between.
    max_pivots, tol
        See `lemke`.

    Returns
    -------
    Solution
        With `active` of -1, 0, 1; the certificate of a ray is its direction of z.

    Examples
    --------
    >>> found = boxed([[2.0]], [-10.0], -3.0, 3.0)  # pushed harder than friction can hold
    >>> found.z.tolist(), found.w.tolist(), found.active.tolist()
    ([3.0], [-4.0], [1])
    """
    matrix, q = problem(M, q)
    n = len(q)
    low = np.broadcast_to(np.asarray(low, dtype=float), n)
    high = np.broadcast_to(np.asarray(high, dtype=float), n)
    if not (low <= high).all():
        raise ValueError("a lower bound exceeds its upper bound")
    below, above = np.isfinite(low), np.isfinite(high)
    base = np.where(below, low, np.where(above, high, 0.0))
    moves = np.flatnonzero((below | above) & (low < high))
    free = np.flatnonzero(~below & ~above)
    twice = np.flatnonzero((below & above)[moves])  # positions in moves
    sign = np.where(below[moves], 1.0, -1.0)  # z = base + sign s, sign w = u - v
    p, r = len(moves), len(twice)
    shifted = q + matrix @ base
    K = np.zeros((p + r, p + r))
    K[:p, :p] = sign[:, None] * matrix[np.ix_(moves, moves)] * sign
    K[twice, p + np.arange(r)] = 1.0
    K[p + np.arange(r), twice] = -1.0
    gap = (high[moves] - low[moves])[twice]
    k = np.concatenate([sign * shifted[moves], gap])
    guess = None
    if start is not None:
        side = np.asarray(start)[moves]
        guess = np.concatenate([side != -sign, side[twice] == 1])
    if len(free):
        A = np.vstack([-K, np.zeros((len(free), p + r))])
        A[p + r :, :p] = -matrix[np.ix_(free, moves)] * sign
        C = np.zeros((len(A), len(free)))
        C[:p] = -sign[:, None] * matrix[np.ix_(moves, free)]
        C[p + r :] = -matrix[np.ix_(free, free)]
        q_all = np.concatenate([k, shifted[free]])
        B = np.eye(len(A), p + r)
        found = mixed(A, B, q_all, C=C, start=guess, max_pivots=max_pivots, tol=tol)
    else:
        found = lemke(K, k, start=guess, max_pivots=max_pivots, tol=tol)
    z, w, active = base.copy(), np.zeros(n), np.zeros(n, dtype=np.int8)
    z[moves] += sign * found.z[:p]
    active[moves] = np.where(found.active[:p], 0, -sign)
    upper = moves[twice[found.active[p:].astype(bool)]]
    active[upper] = 1
    z[upper] = high[upper]
    z = np.clip(z, low, high)  # a rounding where it ends on the other bound
    if found.free is not None:
        z[free] = found.free
    w[moves] = sign * found.w[:p]
    w[moves[twice]] -= found.z[p:]
    fixed = np.flatnonzero(low == high)
    w[fixed] = matrix[fixed] @ z + q[fixed]
    active[fixed] = np.where(w[fixed] < 0.0, 1, -1)
    pair_of = np.concatenate([moves, moves[twice]])
    both = tuple(sorted({int(pair_of[i]) for i in found.degenerate}))
    ray = None
    if found.ray is not None:
        ray = np.zeros(n)
        ray[moves] = sign * found.ray[:p]
    named = tuple(int(pair_of[i] if i < p + r else free[i - p - r]) for i in found.singular)
    return replace(found, z=z, w=w, active=active, degenerate=both, ray=ray, free=None,
                   singular=tuple(sorted(set(named))))  # fmt: skip
