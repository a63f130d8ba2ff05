"""Controllability and observability of one mode in descriptor form.

With n variables v in ``E v' = A v + B u`` (E. L. Yip and R. F. Sincovec, *Solvability,
controllability, and observability of continuous descriptor systems*, IEEE Trans. Automatic Control
26(3), 1981; D. Cobb, *Controllability, observability, and duality in singular systems*, IEEE Trans.
Automatic Control 29(12), 1984):

=============== ==============================================================
finite          ``rank [sE - A, B] = n`` at every finite s: u steers all motion
at infinity     ``rank [E, B] = n``: u can undo every constraint as well
impulse         ``rank [E 0 0; A E B] = n + rank E``: u can avoid every impulse
complete        finite and at infinity
=============== ==============================================================

The finite test is made twice. The eigenvalues of the pencil can be wrong in half their digits where
they coincide, and then a rank test at them sees nothing; so what decides is a staircase (H. H.
Rosenbrock, *State-space and multivariable theory*, 1970) on the slow part, which needs no
eigenvalue. The test at the eigenvalues, with its singular value, tells how clear the answer is.

Observability is the same of the transposed matrices. An output that reads the rate of a variable,
``y = C v + D u + F v'``, is brought to that form by a variable for the rate: ``0 = r - F v'``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.equations.pencil import Pencil, poles_of
from hybond.equations.ranks import DOUBT, RANK, Matrix, Rank, exponents, rank_of

INVOLVED = 1e-6
"""A variable belongs to a subspace if a unit vector in it has at least this component."""


@dataclass(frozen=True, slots=True)
class Reach:
    """Controllability, or observability, of one mode."""

    finite: bool
    infinite: bool
    impulse: bool
    rank: int
    """Dimension of the controllable (or observable) part of the motion; `order` if all of it."""
    order: int
    modes: NDArray[np.generic]
    """The finite eigenvalues that are not controllable (or observable), 1/s."""
    variables: tuple[int, ...]
    """The variables of the descriptor that are involved: those of the uncontrollable combinations,
    or those that move in motions which no output shows."""
    margin: float
    """The smallest singular value of the (scaled) test matrix at the finite eigenvalues; 1 if there
    are none. Near `RANK` the property is about to be lost."""
    sure: bool
    """Whether no rank was near its limit and both tests agree."""

    @property
    def complete(self) -> bool:
        """Whether it holds at all finite frequencies and at infinity."""
        return self.finite and self.infinite


def controllability(p: Pencil, *, at_poles: bool = True) -> Reach:
    """Return the controllability of a mode with a regular pencil.

    Parameters
    ----------
    at_poles : bool
        Whether to make the second test, at the eigenvalues; without it `margin` is NaN.

    Examples
    --------
    Two equal RC branches on one voltage source: their difference dies out by itself.

    >>> from hybond.equations.pencil import analyse
    >>> from hybond.equations.descriptor import Descriptor
    >>> d = Descriptor.of([[1, 0], [0, 1]], [[-1, 0], [0, -1]], [[1], [1]],
    ...                   states=("c1.q", "c2.q"), inputs=("V",))
    >>> found = controllability(analyse(d))
    >>> found.finite, found.rank, found.modes.tolist(), found.variables
    (False, 1, [-1.0], (0, 1))
    """
    assert p.slow is not None, "the pencil is singular"
    s, slow = p.scaled, p.slow
    a, b, t = _even(slow.A, slow.B)
    size, rest, staircase = staircase_of(a, b)
    # x = t * x_even, v = basis x: the quantity rest' x_even as a combination of v
    onto = np.linalg.pinv(slow.basis * t) if len(t) else slow.basis.T
    left = rest.T @ onto
    lost = a if size == 0 else rest.T @ a @ rest
    null = _null(s.E)
    infinite = rank_of(np.hstack([s.E, s.B]))
    impulse = rank_of(np.hstack([s.E, s.A @ null, s.B]))
    margin = _margin(a, b) if at_poles else math.nan
    return _reach(p, size, lost, left, infinite, impulse, margin, staircase)


def observability(p: Pencil, *, at_poles: bool = True) -> Reach:
    """Return the observability of a mode with a regular pencil; parameters as above.

    Examples
    --------
    The sum of two equal capacitors' voltages does not show their difference.

    >>> from hybond.equations.pencil import analyse
    >>> from hybond.equations.descriptor import Descriptor
    >>> d = Descriptor.of([[1, 0], [0, 1]], [[-1, 0], [0, -1]], [[1], [1]], C=[[1, 1]], D=[[0]],
    ...                   states=("c1.q", "c2.q"), inputs=("V",), outputs=("y",))
    >>> found = observability(analyse(d))
    >>> found.finite, found.rank, found.variables
    (False, 1, (0, 1))
    """
    assert p.slow is not None, "the pencil is singular"
    slow = p.slow
    a, c, t = _even(slow.A.T, slow.C.T)
    size, rest, staircase = staircase_of(a, c)
    # dual scaling: x_even = t x, so unseen motions are v = basis (rest / t)
    unseen = (slow.basis / t) @ rest if len(t) else slow.basis @ rest
    lost = a if size == 0 else rest.T @ a @ rest
    e, aa, cc = _with_rates(p)
    null = _null(e.T)
    infinite = rank_of(np.hstack([e.T, cc.T]))
    impulse = rank_of(np.hstack([e.T, aa.T @ null, cc.T]))
    margin = _margin(a, c) if at_poles else math.nan
    full = len(e) - p.states
    return _reach(p, size, lost, unseen.T, infinite, impulse, margin, staircase, extra=full)


def _reach(
    p: Pencil,
    size: int,
    lost: Matrix,
    directions: Matrix,
    infinite: Rank,
    impulse: Rank,
    margin: float,
    staircase: Rank,
    *,
    extra: int = 0,
) -> Reach:
    order = p.order or 0
    finite = size == order
    agree = math.isnan(margin) or (margin > RANK if finite else margin < DOUBT**0.5)
    n = p.states + extra
    return Reach(
        finite=finite,
        infinite=infinite.value == n,
        impulse=impulse.value == n,
        rank=size,
        order=order,
        modes=np.asarray(poles_of(lost) * p.scaled.time) if size < order else np.zeros(0),
        variables=_involved(directions),
        margin=margin,
        sure=bool(agree and p.sure and staircase.sure and infinite.sure and impulse.sure),
    )


def _margin(a: Matrix, b: Matrix) -> float:
    """Return the smallest singular value of ``[z - a, b]`` at the eigenvalues z, rows scaled."""
    margin = 1.0
    for z in poles_of(a):
        if z.imag < 0.0:
            continue
        m = np.hstack([z * np.eye(len(a)) - a, b])
        # rows of a stiff mode differ in size by its ratio of time constants
        rows = np.abs(m).max(axis=1, initial=0.0)
        if not rows.all():
            return 0.0
        values = np.linalg.svd(m / rows[:, None], compute_uv=False)
        margin = min(margin, float(values[len(m) - 1] / values[0]))
    return margin


def staircase_of(a: Matrix, b: Matrix) -> tuple[int, Matrix, Rank]:
    """Return the dimension that b reaches through a, a basis of what is left, the margins.

    Parameters
    ----------
    a, b : arrays, shapes (n, n), (n, p)

    Returns
    -------
    rank : int
    rest : array, shape (n, n - rank)
        Orthonormal; ``rest' a = (..) rest'`` and ``rest' b = 0``.
    margins : Rank
        The least clear margins of the ranks decided.

    Examples
    --------
    >>> rank, rest, _ = staircase_of(np.diag([1.0, 2.0]), np.array([[1.0], [0.0]]))
    >>> rank, np.abs(rest).tolist()
    (1, [[0.0], [1.0]])
    """
    n = len(a)
    q = np.eye(n)
    a = a.copy()
    size_a = float(np.linalg.norm(a, 2)) if n else 0.0
    block = b
    size = float(np.linalg.norm(b, 2)) if b.size else 0.0
    done = 0
    smallest, dropped = 1.0, 0.0
    while done < n and block.size and size:
        u, values, _ = np.linalg.svd(block)
        count = int((values > RANK * size).sum())
        if count < len(values):
            dropped = max(dropped, float(values[count]) / size)
        if count:
            smallest = min(smallest, float(values[count - 1]) / size)
        else:
            break
        q[:, done:] = q[:, done:] @ u
        a[:, done:] = a[:, done:] @ u
        a[done:] = u.T @ a[done:]
        block = a[done + count :, done : done + count]
        done += count
        size = size_a
    return done, q[:, done:], Rank(done, smallest, dropped)


def _even(a: Matrix, b: Matrix) -> tuple[Matrix, Matrix, Matrix]:
    """Return ``T^-1 a T``, ``T^-1 b u`` and T; T and u of powers of two.

    They bring entries near a common size; inputs keep their sizes relative to each other.
    """
    n = len(a)
    terms: list[tuple[tuple[tuple[int, float], ...], float]] = []
    for i, j in np.argwhere(a):
        log = float(np.log2(abs(a[i, j])))
        which = [(n + 1, 1.0)] if i == j else [(int(i), -1.0), (int(j), 1.0), (n + 1, 1.0)]
        terms.append((tuple(which), log))
    for i, k in np.argwhere(b):
        terms.append((((int(i), -1.0), (n, 1.0)), float(np.log2(abs(b[i, k])))))
    x = exponents(terms, n + 2)
    t, u = np.exp2(x[:n]), float(np.exp2(x[n]))
    return a * t / t[:, None], b / t[:, None] * u, t


def _with_rates(p: Pencil) -> tuple[Matrix, Matrix, Matrix]:
    """Return E, A, C with a variable for each rate that an output reads."""
    s = p.scaled
    read = s.F.any(axis=1)
    k, n = int(read.sum()), p.states
    if not k:
        return s.E, s.A, s.C
    f = s.F[read]
    e = np.block([[s.E, np.zeros((n, k))], [f, np.zeros((k, k))]])
    a = np.block([[s.A, np.zeros((n, k))], [np.zeros((k, n)), np.eye(k)]])
    shown = np.zeros((len(s.C), k))
    shown[read] = np.eye(k)
    return e, a, np.hstack([s.C, shown])


def _null(m: Matrix) -> Matrix:
    """Return a basis of the null space, by the same limit as `rank_of`."""
    if not m.size:
        return np.eye(m.shape[1])
    _, values, vt = np.linalg.svd(m)
    count = int((values > RANK * values[0]).sum()) if values[0] else 0
    return np.asarray(vt[count:].T)


def _involved(directions: Matrix) -> tuple[int, ...]:
    """Return the variables with a component in the space that the rows span."""
    if not directions.size:
        return ()
    # each variable by itself may be scaled freely, so measure in even units
    basis = np.linalg.qr(directions.T)[0]
    return tuple(int(k) for k in np.flatnonzero(np.linalg.norm(basis, axis=1) > INVOLVED))
