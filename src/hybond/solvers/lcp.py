"""Linear complementarity: the problem in its forms, and what can be said of a solution.

References
----------
R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*, Academic Press 1992.
K. G. Murty, *Linear Complementarity, Linear and Nonlinear Programming*, Heldermann 1988.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from hybond.solvers.lcp_forms import boxed, mixed
from hybond.solvers.lemke import TOL, Solution, lemke, problem, scaled, sizes

__all__ = [
    "Solution",
    "boxed",
    "lemke",
    "mixed",
    "positive_semidefinite",
    "second_solution",
    "violation",
]


def violation(M: ArrayLike, q: ArrayLike, z: ArrayLike) -> float:
    """Return by how much z fails: the largest abs(min(z, w)), w = M z + q, after scaling.

    z counts relative to the largest of z and q, each w relative to the largest term of which
    sums like it are made; zero if z solves the problem, about one if it has nothing to do with it.

    Examples
    --------
    >>> violation([[2.0]], [-4.0], [2.0]), violation([[2.0]], [-4.0], [0.0])
    (0.0, 1.0)
    """
    matrix, q = problem(M, q)
    if not len(q):
        return 0.0
    raw = np.abs(q).max()
    matrix, q, d, size = scaled(matrix, q)
    z = np.asarray(z, dtype=float) / (d * size)
    if not np.isfinite(z).all():
        return float("inf")
    of_z = sizes(matrix, q, z)[0]
    # At most the largest q in either scaling: one pair with a huge d must not hide the others.
    most = np.minimum(np.abs(q).max(), d * raw / size)
    of_w = np.maximum(np.abs(matrix) @ np.abs(z), np.where(most > 0.0, most, 1.0))
    return float(np.abs(np.minimum(z / of_z, (matrix @ z + q) / of_w)).max())


def positive_semidefinite(M: ArrayLike, *, tol: float = TOL) -> bool:
    """Return whether x'M x >= 0 for all x, to rounding, for M scaled as in `lemke`.

    Then the solutions form a convex set, and a ray of `lemke` means that there is none. If M is
    symmetric besides, all solutions have the same w (Cottle, Pang and Stone, theorem 3.1.7).

    Examples
    --------
    >>> positive_semidefinite([[0.0, -1.0], [1.0, 0.0]]), positive_semidefinite([[-1.0]])
    (True, False)
    """
    matrix, q = problem(M, np.zeros(len(np.atleast_2d(np.asarray(M)))))
    if not len(q):
        return True
    matrix = scaled(matrix, q)[0]
    return bool(np.linalg.eigvalsh(matrix + matrix.T)[0] >= -tol * len(q))


def second_solution(
    M: ArrayLike, q: ArrayLike, solution: Solution, *, tol: float = 1e-8
) -> Solution | None:
    """Look for a solution with another w, as Painleve's problem of rigid friction has.

    A few other starts and covering vectors are tried, always the same ones: finding none proves
    nothing. A proof of uniqueness is a matrix that is symmetric and `positive_semidefinite` (w),
    or that stays semidefinite when something is taken off its diagonal (z and w).

    Parameters
    ----------
    M, q
        See `lemke`.
    solution : Solution
        The solution that is known.
    tol : float
        Smallest scaled difference of w that counts.

    Returns
    -------
    Solution or None

    Examples
    --------
    >>> M, q = [[-1.0]], [1.0]
    >>> first = lemke(M, q)
    >>> first.z.tolist(), second_solution(M, q, first).z.tolist()
    ([0.0], [1.0])
    """
    matrix, q = problem(M, q)
    n = len(q)
    known = np.asarray(solution.active, dtype=bool)
    single = np.eye(n, dtype=bool)[: 8 if n > 8 else n]
    starts = [~known, np.ones(n, dtype=bool), np.zeros(n, dtype=bool), *(known ^ single)]
    ramp = np.linspace(0.1, 1.0, n)
    balanced, constant, d, size = scaled(matrix, q)
    of_w = sizes(balanced, constant, solution.z / (d * size))[1] * size / d
    for cover in (None, ramp, ramp[::-1]):
        for start in starts:
            found = lemke(matrix, q, start=start, cover=cover)
            if found.status == "solved" and np.abs((found.w - solution.w) / of_w).max() > tol:
                return found
    return None
