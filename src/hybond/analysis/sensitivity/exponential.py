"""The matrix exponential of many steps at once, stiff ones too.

    e^(F h) - 1 = (2 U / (V - U)) of F h / 2^s by Pade's approximation of order 13,
    then s times E <- 2 E + E^2                   slow parts keep their digits beside fast ones

as long as both do not mix in one entry: before that `split` takes A apart into blocks, the slow
from the fast. Sources: Al-Mohy and Higham, SIAM Journal on Matrix Analysis 31, 2009; Bavely and
Stewart, SIAM Journal on Numerical Analysis 16, 1979 (blocks).
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]

PADE = (
    64764752532480000.0, 32382376266240000.0, 7771770303897600.0, 1187353796428800.0,
    129060195264000.0, 10559470521600.0, 670442572800.0, 33522128640.0, 1323241920.0,
    40840800.0, 960960.0, 16380.0, 182.0, 1.0,
)  # fmt: skip
NORM = 4.25
"""Largest norm that the approximation takes without halving."""
APART = 30.0
"""Eigenvalues that are so much larger than all smaller ones are in another block."""
WORST = 1e6
"""Largest condition of the blocks' basis with which they are used."""
MIXED = 1e3
"""Largest norm of a step whose slow and fast parts may be in one block: rounding grows with it."""


def grown(matrices: Vector) -> Vector:
    """Return the exponentials of matrices, less one, shape (points, n, n).

    Examples
    --------
    >>> slow, fast = grown(np.diag([-1e-3, -1e12])[None])[0].diagonal().tolist()
    >>> bool(abs(slow / np.expm1(-1e-3) - 1.0) < 1e-13), fast
    (True, -1.0)
    """
    sizes = np.abs(matrices).sum(axis=1).max(axis=1, initial=0.0)
    halvings = np.ceil(np.log2(np.maximum(sizes / NORM, 1.0))).astype(int)
    F = matrices / (2.0**halvings)[:, None, None]
    one = np.eye(F.shape[1])
    b = PADE
    F2 = F @ F
    F4 = F2 @ F2
    F6 = F4 @ F2
    U = F @ (
        F6 @ (b[13] * F6 + b[11] * F4 + b[9] * F2)
        + b[7] * F6 + b[5] * F4 + b[3] * F2 + b[1] * one
    )  # fmt: skip
    V = F6 @ (b[12] * F6 + b[10] * F4 + b[8] * F2) + b[6] * F6 + b[4] * F4 + b[2] * F2 + b[0] * one
    E = np.linalg.solve(V - U, 2.0 * U)
    for k in range(int(halvings.max(initial=0))):
        more = halvings > k
        part = E[more]
        E[more] = 2.0 * part + part @ part
    return np.asarray(E)


def split(A: Vector, longest: float) -> tuple[Vector, Vector, Vector, bool]:
    """Return a basis in which a matrix has blocks, slow from fast.

    Parameters
    ----------
    A : array, shape (n, n)
    longest : float
        The longest time for which it will be used: what is not fast in it is not taken apart.

    Returns
    -------
    T, back, blocks : array, shape (n, n)
        The basis, its inverse, and the matrix in it.
    apart : bool
        Whether nothing fast is left in a block with what is slow. Otherwise slow and fast have no
        well-conditioned bases of their own; the basis then only has other units.

    Examples
    --------
    >>> T, back, blocks, apart = split(np.array([[-1.0, 1e6], [0.0, -1e9]]), 1.0)
    >>> bool(blocks[0, 1] == blocks[1, 0] == 0.0), bool(np.allclose(T @ back, np.eye(2))), apart
    (True, True, True)
    """
    from scipy.linalg import schur, solve_sylvester

    n = len(A)
    unit = _balance(A)
    alone = np.diag(unit), np.diag(1.0 / unit), A * unit[None, :] / unit[:, None]
    step, inverse, blocks = np.eye(n), np.eye(n), alone[2]
    many = n
    while many > 1:
        own = blocks[:many, :many]
        sizes = np.sort(np.abs(np.linalg.eigvals(own)))[::-1]
        quick = sizes[:-1] * longest > MIXED
        gaps = np.flatnonzero(quick & (sizes[:-1] > APART * sizes[1:]))
        if not len(gaps):
            break
        fast = int(gaps[0]) + 1
        edge = np.sqrt(sizes[fast - 1] * max(sizes[fast], sizes[fast - 1] / APART**2))
        below = partial(_below, edge=float(edge))
        S, Q, slow = schur(own, sort=below)
        if slow != many - fast:
            return *alone, False
        X = solve_sylvester(S[:slow, :slow], -S[slow:, slow:], -S[:slow, slow:])
        apart = np.eye(n)
        apart[:many, :many] = Q
        step, inverse = step @ apart, apart.T @ inverse
        apart = np.eye(n)
        apart[:slow, slow:many] = X
        step = step @ apart
        apart[:slow, slow:many] = -X
        inverse = apart @ inverse
        new = np.zeros((n, n))
        new[many:, many:] = blocks[many:, many:]
        new[:slow, :slow], new[slow:many, slow:many] = S[:slow, :slow], S[slow:, slow:]
        blocks, many = new, slow
    largest = np.abs(blocks).sum(axis=0).max(initial=0.0)
    if many == n:
        return *alone, bool(largest * longest <= MIXED)
    if not np.linalg.norm(step, 2) * np.linalg.norm(inverse, 2) < WORST:
        return *alone, False
    return alone[0] @ step, inverse @ alone[1], blocks, True


def _below(re: float, im: float, edge: float) -> bool:
    return bool(np.hypot(re, im) < edge)


def _balance(A: Vector) -> Vector:
    """Return units, powers of two, in which rows and columns of a matrix are alike."""
    unit = np.ones(len(A))
    off = np.abs(A) * (1.0 - np.eye(len(A)))
    for _ in range(10):
        changed = False
        for k in range(len(A)):
            scaled = off * unit[None, :] / unit[:, None]
            row, column = scaled[k].sum(), scaled[:, k].sum()
            if row > 0.0 and column > 0.0:
                by = 2.0 ** round(0.5 * np.log2(row / column))
                changed = changed or by != 1.0
                unit[k] *= by
        if not changed:
            break
    return unit


__all__ = ["MIXED", "grown", "split"]
