"""Asking a field what kind of function it is, and states how large they are."""

from __future__ import annotations

import math

import numpy as np

from hybond.solvers.base import FloatArray
from hybond.solvers.qss_rates import Affine, Evaluate, Fitted, Indices, Quadratic, Rates

AFFINE = 1e-10
"""A field is affine if it differs from its matrix by less than this part of the terms' size."""
PAIRS = 16
"""With more states than this, quadratures of an affine field are sampled instead of expanded."""


def sizes_of(x: FloatArray, rate: FloatArray, known: FloatArray, span: float) -> FloatArray:
    """Return the natural size of each state, positive: how far to move it in asking.

    Parameters
    ----------
    x, rate : ndarray, shape (n,)
        States and derivatives.
    known : ndarray, shape (n,)
        What is known of their sizes; may be zero.
    span : float
        Length of the run, s; zero if unknown.

    Examples
    --------
    >>> sizes_of(np.array([2.0, 0.0]), np.array([0.0, 5.0]), np.zeros(2), 10.0)
    array([2.  , 0.05])
    """
    sizes = np.maximum(np.abs(x), known)
    idle = sizes == 0.0
    # of no size so far: as far as it gets in a thousandth of the time, or as far as others
    sizes[idle] = np.abs(rate[idle]) * (1e-3 * span or 1e-3)
    sizes[sizes == 0.0] = sizes.max(initial=0.0) or 1.0
    return sizes


def reached(x: FloatArray, rate: FloatArray, jacobian: FloatArray, span: float) -> FloatArray:
    """Return how far each state gets within the shortest time constant, positive.

    Examples
    --------
    >>> reached(np.zeros(2), np.array([1.0, 0.0]), np.array([[-2.0, 0.0], [1.0, 0.0]]), 9.0)
    array([0.5  , 0.125])
    """
    fastest = float(np.abs(np.linalg.eigvals(jacobian)).max(initial=0.0))
    spans = [s for s in (span, 1.0 / fastest if fastest > 0.0 else 0.0) if s > 0.0]
    tau = min(spans, default=1.0)
    far, term = np.abs(x), tau * rate
    for k in range(2, min(x.size, 8) + 2):
        far = np.maximum(far, np.abs(term))
        term = tau / k * (jacobian @ term)
    return np.where(far > 0.0, far, 1e-9 * (far.max(initial=0.0) or 1.0))


def learn(
    evaluate: Evaluate,
    t: float,
    x: FloatArray,
    f: FloatArray,
    *,
    sizes: FloatArray,
    states: Indices,
    rest: Indices,
    span: float,
) -> Rates:
    """Return the rates of a field, after asking it what kind of function it is.

    Parameters
    ----------
    evaluate : callable
        The field.
    t : float
        Time.
    x : ndarray, shape (n,)
        Controlled states.
    f : ndarray
        All derivatives there.
    sizes : ndarray, shape (n,)
        How far to move each state in asking: its natural size, positive.
    states, rest : ndarray of int
        Indices of controlled states and of quadratures among the derivatives.
    span : float
        How long the field is wanted for; asked for at times within it.

    Returns
    -------
    Rates
        After n + 2 evaluations if the field is affine, and (n^2 + 3 n)/2 more if it has quadratures
        and no more than `PAIRS` states; after 2 n + 2 at most if it is not.
    """
    n = x.size
    matrix, finite = _columns(evaluate, t, x, f[states], sizes, states)
    constant = f[states] - matrix @ x
    affine = finite
    # neither along an axis nor along a diagonal
    spread = np.cos(2.399963 * np.arange(n) + 1.0)
    for part, direction in ((0.3707, spread), (0.7313, -0.618 * spread)):
        if not affine:
            break
        y = x + direction * sizes
        g = evaluate(t + part * span, y)[states]
        size = np.abs(matrix) @ np.abs(y) + np.abs(constant)
        affine = bool((np.abs(g - matrix @ y - constant) <= AFFINE * size).all())
    if affine:
        # what rounding left in place of zero would make dependencies out of nothing
        typical = np.abs(f[states]) + np.abs(matrix) @ sizes
        matrix[np.abs(matrix) * sizes <= 1e-14 * typical[:, None]] = 0.0
        constant = f[states] - matrix @ x
        form = _form(evaluate, t, x, f[rest], sizes, rest) if n <= PAIRS else None
        return Affine(evaluate, states, rest, matrix, constant, form)
    if n:
        small = np.maximum(1e-7 * sizes, 1e-8 * np.abs(x))
        matrix, _ = _columns(evaluate, t, x, f[states], small, states)
        matrix[~np.isfinite(matrix)] = 0.0
    return Fitted(evaluate, states, rest, matrix, reach=span if span > 0.0 else math.inf)


def _columns(
    evaluate: Evaluate, t: float, x: FloatArray, f: FloatArray, moves: FloatArray, states: Indices
) -> tuple[FloatArray, bool]:
    matrix = np.zeros((x.size, x.size))
    for i in range(x.size):
        y = x.copy()
        y[i] += moves[i]
        matrix[:, i] = (evaluate(t, y)[states] - f) / (y[i] - x[i])
    return matrix, bool(np.isfinite(matrix).all())


def _form(
    evaluate: Evaluate, t: float, x: FloatArray, r: FloatArray, sizes: FloatArray, rest: Indices
) -> Quadratic | None:
    n, m = x.size, rest.size
    gradient, hessian = np.zeros((m, n)), np.zeros((m, n, n))
    if not m:
        return Quadratic(x, r, gradient, hessian)

    def at(*moves: tuple[int, float]) -> FloatArray:
        y = x.copy()
        for i, part in moves:
            y[i] += part * sizes[i]
        return evaluate(t, y)[rest] - r

    plus = np.array([at((i, 1.0)) for i in range(n)]).reshape(n, m)
    minus = np.array([at((i, -1.0)) for i in range(n)]).reshape(n, m)
    gradient = (0.5 * (plus - minus) / sizes[:, None]).T
    for i in range(n):
        hessian[:, i, i] = 0.5 * (plus[i] + minus[i]) / sizes[i] ** 2
        for j in range(i):
            mixed = at((i, 1.0), (j, 1.0)) - plus[i] - plus[j]
            hessian[:, i, j] = hessian[:, j, i] = 0.5 * mixed / (sizes[i] * sizes[j])
    if not np.isfinite(hessian).all():
        return None
    return Quadratic(x, r, gradient, hessian)
