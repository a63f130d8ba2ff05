"""Pivots on complementary pairs: scaling, principal pivots, Lemke's path, regular choices.

The arithmetic below `hybond.solvers.lcp`; all matrices are scaled to entries of about one.

References
----------
R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*, Academic Press 1992:
2.3 (principal pivots), 4.4 (Lemke), 4.9 (lexicographic ratio test).
D. Ruiz, *A scaling algorithm to equilibrate both rows and columns norms in matrices*,
RAL-TR-2001-034, 2001.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]

REGULAR = 1e-9
"""Smallest pivot of a matrix that counts as regular."""

_SWEEPS = 40
"""Sweeps of scaling: each halves the digits by which rows differ; 1e12 needs six."""


def balance(M: FloatArray) -> FloatArray:
    """Return d > 0 such that the rows and columns of d_i M_ij d_j have largest entries near one.

    Powers of two, so that scaling rounds nothing. Symmetric, so that M stays semidefinite.

    Examples
    --------
    >>> d = balance(np.array([[1e12, 1.0], [-1.0, 1e-12]]))
    >>> bool(0.5 <= 1e12 * d[0] ** 2 <= 2.0), bool(0.5 <= d[0] * d[1] <= 2.0)
    (True, True)
    """
    size = np.abs(M)
    return _to_powers(_equilibrate(np.maximum(size, size.T), symmetric=True)[1])


def balance_sides(W: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return r, c > 0 such that rows and columns of r_i W_ij c_j have largest entries near one."""
    rows, columns = _equilibrate(np.abs(W), symmetric=False)
    return _to_powers(rows), _to_powers(columns)


def _equilibrate(size: FloatArray, *, symmetric: bool) -> tuple[FloatArray, FloatArray]:
    rows, columns = np.ones(size.shape[0]), np.ones(size.shape[1])
    if not size.size:
        return rows, columns
    for _ in range(_SWEEPS):
        now = size * rows[:, None] * columns
        down = now.max(axis=0)
        across = down if symmetric else now.max(axis=1)
        down, across = (np.where(most > 0.0, most, 1.0) for most in (down, across))
        rows /= np.sqrt(across)
        columns /= np.sqrt(down)
        if max(down.max(), across.max()) < 1.5 and min(down.min(), across.min()) > 0.67:
            break
    return rows, columns


def _to_powers(d: FloatArray) -> FloatArray:
    scale: FloatArray = np.exp2(np.round(np.log2(d)))
    return scale


def principal(M: FloatArray, q: FloatArray, active: Mask) -> tuple[FloatArray, FloatArray]:
    """Return M and q after z and w of the active pairs have changed places.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the block of the active pairs is singular, or nearly so.
    """
    on, off = np.flatnonzero(active), np.flatnonzero(~active)
    if not len(on):
        return M, q
    block = M[np.ix_(on, on)]
    inverse = np.linalg.inv(block)
    if not np.abs(inverse).sum(axis=0).max() * np.abs(block).sum(axis=0).max() < 1e13:
        raise np.linalg.LinAlgError("singular")
    across = inverse @ M[np.ix_(on, off)]
    down = M[np.ix_(off, on)]
    new = np.empty_like(M)
    new[np.ix_(on, on)] = inverse
    new[np.ix_(on, off)] = -across
    new[np.ix_(off, on)] = down @ inverse
    new[np.ix_(off, off)] = M[np.ix_(off, off)] - down @ across
    constant = np.empty_like(q)
    constant[on] = -inverse @ q[on]
    constant[off] = q[off] + down @ constant[on]
    return new, constant


def independent(M: FloatArray, active: Mask) -> Mask:
    """Return the part of the active pairs that symmetric elimination finds regular.

    Pivots of one or two pairs at a time: a skew block has no diagonal to divide by.

    Examples
    --------
    >>> independent(np.ones((2, 2)), np.array([True, True])).tolist()  # two contacts, one body
    [True, False]
    """
    on = np.flatnonzero(active)
    S = M[np.ix_(on, on)]
    left = np.ones(len(on), dtype=bool)
    while left.any():
        inside = np.outer(left, left)
        single = np.where(left, np.abs(np.diag(S)), 0.0)
        double = np.sqrt(np.abs(S * S.T)) * inside
        np.fill_diagonal(double, 0.0)
        block = [int(single.argmax())]
        if single.max() < 0.1 * double.max():
            block = [int(i) for i in np.unravel_index(double.argmax(), S.shape)]
        if max(single.max(), double.max()) < REGULAR:
            break
        S = S - S[:, block] @ np.linalg.solve(S[np.ix_(block, block)], S[block])
        left[block] = False
    kept = np.zeros_like(active)
    kept[on[~left]] = True
    return kept


class Path(NamedTuple):
    """Where Lemke's path ended."""

    status: str
    """"solved", "ray" or "limit"."""
    active: Mask
    """Pairs whose z is basic."""
    pivots: int
    ray: FloatArray | None
    """Direction of (w, z), 2 n numbers."""


def lemke_path(M: FloatArray, q: FloatArray, cover: FloatArray, limit: int, tol: float) -> Path:
    """Follow Lemke's path from w = q + M z + cover z0 with a large z0 until z0 is zero.

    Notes
    -----
    The dictionary holds ``basic = T nonbasic``, its last column the constants. The
    lexicographic rule is that of q + (eps, eps^2, ...): the coefficient of eps^j in a basic
    variable is one if that is w_j itself, else minus its entry in the column of w_j, so that no
    inverse of the basis is carried along.
    """
    n = len(q)
    z0 = 2 * n  # unknowns are numbered w, z, z0
    T = np.column_stack([M, cover, q])
    basic = np.arange(n)
    beside = np.concatenate([np.arange(n, 2 * n), [z0]])  # of the columns
    place = np.concatenate([np.full(n, -1), np.arange(n + 1)])  # column of an unknown, else -1
    entering = z0
    for pivots in range(1, limit + 1):
        c = int(place[entering])
        column = T[:, c].copy()
        if pivots == 1:
            if (q >= 0.0).all():
                return Path("solved", np.zeros(n, dtype=bool), 0, None)
            # The last w to become nonnegative as z0 falls from infinity gives z0 its place;
            # of several the one with the largest index, which keeps all rows positive.
            level = np.where(cover > 0.0, q, 0.0) / np.where(cover > 0.0, cover, 1.0)
            r = int(np.flatnonzero(level <= level.min() + tol)[-1])
        else:
            rows = np.flatnonzero(column < -tol * max(1.0, np.abs(column).max()))
            if not len(rows):
                ray = np.zeros(2 * n + 1)
                ray[basic] = column
                ray[entering] = 1.0
                return Path("ray", _basic_z(basic, n), pivots - 1, ray[:z0])
            r = _first_to_vanish(T, rows, column, basic, place, tol)
        leaving = int(basic[r])
        if leaving == z0:
            basic[r] = entering
            return Path("solved", _basic_z(basic, n), pivots, None)
        row = T[r] / -column[r]
        row[c] = 1.0 / column[r]
        T[:, c] = 0.0
        T += np.multiply.outer(column, row)
        T[r] = row
        basic[r], beside[c] = entering, leaving
        place[entering], place[leaving] = -1, c
        entering = leaving + n if leaving < n else leaving - n
    return Path("limit", _basic_z(basic, n), limit, None)


def _basic_z(basic: NDArray[np.intp], n: int) -> Mask:
    inside = np.zeros(2 * n + 1, dtype=bool)
    inside[basic] = True
    return inside[n : 2 * n]


def _first_to_vanish(
    T: FloatArray,
    rows: NDArray[np.intp],
    column: FloatArray,
    basic: NDArray[np.intp],
    place: NDArray[np.intp],
    tol: float,
) -> int:
    """Return the row whose unknown is zero first, ties decided in lexicographic order."""
    n = len(T)
    fall = -column[rows]
    ratio = np.maximum(T[rows, -1], 0.0) / fall
    near = ratio <= ratio.min() + tol * max(1.0, ratio.min())
    rows, fall = rows[near], fall[near]
    final = np.flatnonzero(basic[rows] == 2 * n)
    if len(final):
        return int(rows[final[0]])  # z0 itself is zero: done
    for j in range(n):
        if len(rows) == 1:
            break
        share = (-T[rows, place[j]] if place[j] >= 0 else (basic[rows] == j) * 1.0) / fall
        near = share <= share.min() + tol * max(1.0, abs(share.min()))
        rows, fall = rows[near], fall[near]
    return int(rows[fall.argmax()])


def complementary_basis(W: FloatArray, pairs: int) -> tuple[NDArray[np.intp], tuple[int, ...]]:
    """Choose one column of each pair (k, pairs + k), and all later ones, that are independent.

    Gauss-Jordan elimination in which the largest entry is the pivot and takes its pair out.
    Where nothing is left, chosen columns are exchanged for their partners along a shortest
    augmenting path; if there is none, no choice exists (intersection of a linear and a
    partition matroid).

    Returns
    -------
    ndarray of int
        The chosen columns, in no order.
    tuple of int
        Pairs without a choice (``pairs + i``: the later column i); empty if all is well.

    Examples
    --------
    >>> W = np.array([[1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.1, 0.0]])  # b of pair 0 is needed
    >>> sorted(complementary_basis(W, 2)[0].tolist())
    [1, 2]
    >>> complementary_basis(np.array([[1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]]), 2)[1]
    (1,)
    """
    T = W.copy()
    owner = np.full(len(T), -1, dtype=np.intp)  # column of each row
    waiting = np.ones(T.shape[1], dtype=bool)

    def pivot(r: int, c: int) -> None:
        row = T[r] / T[r, c]
        column = T[:, c].copy()
        np.subtract(T, np.multiply.outer(column, row), out=T)
        T[r] = row
        owner[r] = c

    for later in (True, False):
        while True:
            among = waiting & ((np.arange(T.shape[1]) >= 2 * pairs) == later)
            if not among.any():
                break
            size = np.abs(T) * among * (owner < 0)[:, None]
            r, c = (int(i) for i in np.unravel_index(size.argmax(), T.shape))
            if size[r, c] > REGULAR:
                steps = [(r, c)]
            else:
                steps = [] if later else _augmenting_path(T, owner, among, pairs)
            if not steps:
                left = np.flatnonzero(among)
                names = left - pairs if later else left[left < pairs]
                return owner[owner >= 0], tuple(int(i) for i in names)
            for r, c in steps:
                if c < 2 * pairs:
                    owner[owner == (c + pairs) % (2 * pairs)] = -1
                    waiting[[c, (c + pairs) % (2 * pairs)]] = False
                waiting[c] = False
                pivot(r, c)
    return owner, ()


def _augmenting_path(
    T: FloatArray, owner: NDArray[np.intp], waiting: Mask, pairs: int
) -> list[tuple[int, int]]:
    """Return the pivots (row, column) that free a row for a waiting column, [] if none do."""
    came: dict[int, tuple[int, int] | None] = {int(r): None for r in np.flatnonzero(owner < 0)}
    queue = list(came)
    for r in queue:
        last = np.flatnonzero(waiting & (np.abs(T[r]) > REGULAR))
        if len(last):
            steps = [(r, int(last[np.abs(T[r, last]).argmax()]))]
            step = came[r]
            while step is not None:
                steps.insert(0, step)
                step = came[step[0]]
            return steps
        for other, c in enumerate(owner):
            if other not in came and 0 <= c < 2 * pairs:
                partner = int(c + pairs) % (2 * pairs)
                if abs(T[r, partner]) > REGULAR:
                    came[other] = (r, partner)
                    queue.append(other)
    return []
