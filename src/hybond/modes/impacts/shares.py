"""Shares of impulses among contacts that depend on each other: a table of four legs.

Where the Delassus matrix is singular, some impulses move nothing. The velocities after an impact do
not depend on these, the impulses of the single contacts do; the shares chosen here are unique,
independent of the order of the contacts, and equal for equal contacts.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.solvers.lcp import lemke

Array = NDArray[np.float64]

DEPENDENT = 1e-10
"""An eigenvalue of the scaled Delassus matrix below this part of the largest one is zero."""


def scales(W: Array) -> Array:
    """Return the square roots of the diagonal of `W`, 1 where it is zero.

    Divided by them, velocities are square roots of energies; so are impulses times them.

    Examples
    --------
    >>> scales(np.diag([4.0, 0.0])).tolist()
    [2.0, 1.0]
    """
    diagonal = np.diag(W)
    roots: Array = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    return roots


def still_impulses(W: Array) -> Array:
    """Return the scaled impulses that move nothing: an orthonormal basis, one a column.

    Parameters
    ----------
    W : ndarray, shape (n, n)
        Symmetric, positive semi-definite.

    Returns
    -------
    ndarray, shape (n, k)
        Columns N with ``W (N / scales(W)) = 0``.

    Examples
    --------
    >>> still_impulses(np.array([[1.0, 1.0], [1.0, 1.0]])).shape  # the same contact twice
    (2, 1)
    """
    if not len(W):
        return np.zeros((0, 0))
    scale = scales(W)
    values, vectors = np.linalg.eigh(W / np.outer(scale, scale))
    none: Array = vectors[:, values <= DEPENDENT * max(float(values[-1]), 1e-300)]
    return none


def least_shares(W: Array, z: Array, tight: NDArray[np.intp]) -> tuple[Array, bool]:
    """Return the impulses of least ``sum W_ii z_i**2`` that move as `z` does.

    With s the scales: minimise the norm of ``s z + N t >= 0``, N spanning the impulses that move
    nothing. Its optimality conditions are again a complementarity problem, of matrix N N'.

    Parameters
    ----------
    W : ndarray, shape (n, n)
        Symmetric, positive semi-definite.
    z : ndarray, shape (n,)
        Impulses, none negative.
    tight : ndarray of int
        Contacts that may carry an impulse.

    Returns
    -------
    shares : ndarray, shape (n,)
        Impulses, none negative.
    unique : bool
        Whether there was nothing to choose.

    Examples
    --------
    >>> one = np.ones((2, 2))
    >>> shares, unique = least_shares(one, np.array([1.0, 0.0]), np.arange(2))
    >>> shares.round(12).tolist(), unique
    ([0.5, 0.5], False)
    """
    inner = W[np.ix_(tight, tight)]
    kernel = still_impulses(inner)
    if not kernel.shape[1]:
        return z, True
    scale = scales(inner)
    shares = scale * z[tight]
    project = kernel @ kernel.T
    found = lemke(project, shares - project @ shares)
    if found.status != "solved":
        return z, False
    least = z.copy()
    least[tight] = np.where(found.active, 0.0, found.w) / scale
    return least, False
