"""Step size control shared by the adaptive solvers: error norm and first step."""

from __future__ import annotations

import math

import numpy as np

from hybond.solvers.base import Field, FloatArray


def error_norm(error: FloatArray, scale: FloatArray) -> float:
    """Return the root mean square of ``error/scale`` over the controlled components.

    A component of infinite scale is not controlled. A component of scale 0 and error 0 counts
    as 0; scale 0 with an error gives ``inf``. With nothing controlled the norm is 0.

    Examples
    --------
    >>> error_norm(np.array([3.0, 4.0, 9.0]), np.array([1.0, 1.0, np.inf]))
    3.5355339059327378
    """
    controlled = int(np.count_nonzero(scale < np.inf))
    if controlled == 0:
        return 0.0
    ratio = error_ratios(error, scale)
    return math.sqrt(float(ratio.dot(ratio)) / controlled)


def error_ratios(error: FloatArray, scale: FloatArray) -> FloatArray:
    """Return ``abs(error)/scale`` with 0/0 and anything/inf as 0.

    Examples
    --------
    >>> error_ratios(np.array([0.0, -4.0, 9.0]), np.array([0.0, 2.0, np.inf]))
    array([0., 2., 0.])
    """
    with np.errstate(all="ignore"):
        ratios: FloatArray = np.abs(error) / scale
    ratios[(scale == np.inf) | ((scale == 0.0) & (error == 0.0))] = 0.0
    return ratios


def worst_component(error: FloatArray, scale: FloatArray) -> int | None:
    """Return the index with the largest error in units of its scale, or None.

    Examples
    --------
    >>> worst_component(np.array([1.0, 3.0]), np.array([1.0, 6.0]))
    0
    """
    ratios = error_ratios(error, scale)
    return int(np.argmax(ratios)) if ratios.size and np.any(ratios > 0.0) else None


def first_step(
    field: Field,
    t: float,
    y: FloatArray,
    f: FloatArray,
    *,
    scale: FloatArray,
    order: int,
    limit: float,
) -> float:
    """Choose the first step size, with one evaluation of the field.

    Parameters
    ----------
    field : callable
        The derivative.
    t : float
        Start.
    y, f : ndarray, shape (n,)
        State and derivative there.
    scale : ndarray, shape (n,)
        Error allowed per component.
    order : int
        Order of the error estimate.
    limit : float
        Largest step allowed, may be infinite.

    Notes
    -----
    After Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, II.4, with their
    norms ``d0, d1, d2`` of state and first two derivatives, but independent of the unit of
    time: the derivative of order p+1 is estimated as ``d1*(d2/d1)**p`` instead of
    ``max(d1, d2)``, and 1e-6 is a fraction of `limit`.

    Examples
    --------
    >>> y = np.ones(1)
    >>> h = first_step(lambda t, y: -y, 0.0, y, -y, scale=1e-6 * y, order=4, limit=10.0)
    >>> round(h, 4)
    0.0251
    """
    unit = limit if limit < math.inf else 1.0
    d0 = error_norm(y, scale)
    d1 = error_norm(f, scale)
    # A move by a hundredth of the state, or by ten tolerances where the state is small.
    h0 = max(0.01 * d0, 10.0) / d1 if 0.0 < d1 < math.inf else 1e-6 * unit
    h0 = min(h0, 1e-3 * unit) if h0 > 0.0 else 1e-6 * unit
    f1 = np.asarray(field(t + h0, y + h0 * f))
    d2 = error_norm(f1 - f, scale) / h0
    if not math.isfinite(d2):
        return 0.01 * h0
    h1 = math.inf
    # a state that leaves 0 has no size to compare its derivative with
    if d2 > 0.0 and d1 < math.inf:
        if d1 > 0.0:
            h1 = d1 / d2 * (0.01 / d1 * (d2 / d1)) ** (1.0 / (order + 1))
        # Curvature within one tolerance is no error at all, whatever the derivatives say.
        h1 = max(h1 if d1 > 0.0 else 0.0, d2**-0.5)
    return min(100.0 * h0, h1, limit)
