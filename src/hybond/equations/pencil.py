"""The pencil of one mode: whether it has a unique solution, its order, index and slow part.

``E v' = A v + B u`` has one solution per input and consistent start if ``det(sE - A)`` is not
identically zero. The finite eigenvalues of the pencil are its motions, as many as the degree of
that determinant; what is left are constraints. If the degree is below the rank of E, an
inconsistent start makes impulses in v itself.

The infinite eigenvalues are taken off step by step: rows without rates are algebraic, some of
their variables follow from the others and are put in, which may leave further rows without rates
(P. Van Dooren, *The computation of Kronecker's canonical form of a singular pencil*, Linear
Algebra Appl. 27, 1979). Ranks are decided by singular values; variables are chosen by pivoting,
so that the states of what is left are stored quantities of the model, not mixtures of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.equations.descriptor import Descriptor
from hybond.equations.ranks import (
    RANK,
    Matrix,
    Rank,
    Scaled,
    Tracked,
    counted,
    exponents,
    rank_of,
    scaled,
    worst,
)

TRIALS = (0.7411 + 0.3923j, -1.1307 + 0.8219j, 1.9163 - 0.2741j)
"""Scaled frequencies at which a regular pencil is hardly singular by chance."""


@dataclass(frozen=True, slots=True)
class Slow:
    """What moves: ``x' = A x + B u`` in scaled variables, ``y = C x`` but for what u adds."""

    A: Matrix
    B: Matrix
    C: Matrix
    """`A`, `B` and `C`: of `order` states."""
    kept: tuple[int, ...]
    """Which of the descriptor's variables the states are."""
    basis: Matrix
    """Shape (n, order). ``v = basis @ x`` while u = 0: how all variables move with the states."""


@dataclass(frozen=True, slots=True)
class Pencil:
    """What `analyse` found.

    Parameters
    ----------
    states : int
        Size of the pencil.
    regular : bool
        Whether ``det(sE - A)`` is not identically zero: the mode is solvable.
    normal_rank : int
        Rank of ``sE - A`` at nearly all s.
    rank_e : int
    order : int or None
        Degree of the determinant; None if it is zero.
    index : int or None
        Steps until nothing was algebraic any more: 0 for an ordinary differential equation.
    poles : array or None
        The finite eigenvalues, 1/s, sorted by real part.
    slow : Slow or None
    scaled : Scaled
        What the ranks were decided on.
    smallest, dropped : float
        The least clear margins of all ranks decided (`hybond.equations.ranks.Rank`).
    """

    states: int
    regular: bool
    normal_rank: int
    rank_e: int
    order: int | None
    index: int | None
    poles: NDArray[np.generic] | None
    slow: Slow | None
    scaled: Scaled
    smallest: float
    dropped: float

    @property
    def impulse_free(self) -> bool | None:
        """Whether no start makes an impulse in v: the degree equals the rank of E."""
        return None if self.order is None else self.order == self.rank_e

    @property
    def sure(self) -> bool:
        """Whether no rank was near its limit."""
        return Rank(0, self.smallest, self.dropped).sure


def analyse(d: Descriptor) -> Pencil:
    """Return regularity, order, index, poles and slow part of a mode.

    Examples
    --------
    Two capacitors in parallel, 1 F and 2 F, that 3 ohm discharges: one state, one constraint.

    >>> d = Descriptor.of([[1, 1], [0, 0]], [[-1 / 3, 0], [1, -0.5]], [[1], [0]],
    ...                   states=("c1.q", "c2.q"), inputs=("J",))
    >>> found = analyse(d)
    >>> found.regular, found.order, found.index, found.impulse_free
    (True, 1, 1, True)
    >>> found.poles.round(6).tolist()
    [-0.111111]
    """
    n = len(d.states)
    s = scaled(d)
    trials = [rank_of(z * s.E - s.A) for z in TRIALS]
    normal = max(trials, key=lambda r: (r.value, r.smallest))
    e_rank = rank_of(s.E)
    regular = normal.value == n
    if not regular:
        low, high = worst(normal, e_rank)
        return Pencil(n, False, normal.value, e_rank.value, None, None, None, None, s, low, high)
    try:
        reduced = Reduction(s)
    except np.linalg.LinAlgError:
        # regular at the trial frequencies, but so barely that no variable can be put in
        return Pencil(n, False, n, e_rank.value, None, None, None, None, s, 0.0, normal.smallest)
    slow = reduced.slow()
    poles = poles_of(slow.A) * s.time
    low, high = worst(normal, e_rank, *reduced.ranks)
    order = len(slow.kept)
    return Pencil(n, True, n, e_rank.value, order, reduced.index, poles, slow, s, low, high)


class Reduction:
    """A scaled regular pencil while its infinite eigenvalues are taken off.

    Attributes
    ----------
    e, a : Tracked
        What is left.
    b, direct : list of Tracked
        Polynomials in s, as eliminating a variable that an input drives brings ``s u``:
        ``v = basis x + direct(s) u``.
    kept : array of int
        Which of the descriptor's variables are left.
    """

    def __init__(self, s: Scaled, *, last: NDArray[np.int_] | None = None) -> None:
        """Take a scaled descriptor; variables go only where none with a lower `last` may."""
        n, p = s.B.shape
        self.e, self.a = Tracked.of(s.E), Tracked.of(s.A)
        self.b = [Tracked.of(s.B)]
        self.c = [Tracked.of(m) for m in (s.C, s.F) if m is s.C or m.any()]
        self.kept = np.arange(n)
        self.basis, self.direct = Tracked.of(np.eye(n)), [Tracked.of(np.zeros((n, p)))]
        self.index = 0
        self.ranks: list[Rank] = []
        self._size_e = float(np.linalg.norm(s.E, 2)) if n else 0.0
        self._weights = np.ones(n) if last is None else 2.0 ** (-20.0 * last)
        while len(self.e.value):
            rank = rank_of(self.e.value, self._size_e)
            self.ranks.append(rank)
            if rank.value == len(self.e.value):
                break
            self._deflate(rank.value)
            self.index += 1
        # what is left: x' = a x + b(s) u
        inverse = self.e.inverse()
        self.a, self.b = inverse @ self.a, [inverse @ m for m in self.b]

    def slow(self) -> Slow:
        """Return what moves."""
        # modulo sI - a: s acts on a column of B as a does, on a row of C likewise
        *lower, b = self.b
        for coefficient in reversed(lower):
            b = self.a @ b + coefficient
        *lower, c = self.c
        for coefficient in reversed(lower):
            c = c @ self.a + coefficient
        kept = tuple(int(k) for k in self.kept)
        return Slow(self.a.value, b.value, c.value, kept, self.basis.value)

    def _deflate(self, rank: int) -> None:
        """Take off the rows without rates, and as many variables."""
        from scipy.linalg import qr

        n = len(self.e.value)
        # rows of E that are independent, and the others as combinations of them
        pivots = qr(self.e.value.T, mode="r", pivoting=True)[1]
        upper, lower = np.sort(pivots[:rank]), np.sort(pivots[rank:])
        mix = Tracked.of(self.e.value[lower] @ np.linalg.pinv(self.e.value[upper], rcond=RANK))
        mix = Tracked(np.where(np.abs(mix.value) > RANK, mix.value, 0.0), mix.error)

        def split(m: Tracked) -> tuple[Tracked, Tracked]:
            return m.take(upper), m.take(lower) + -mix @ m.take(upper)

        e1 = self.e.take(upper)
        a1, a2 = split(self.a)
        values = np.linalg.svd(a2.value, compute_uv=False)
        found = counted(values, max(float(np.linalg.norm(self.a.value, 2)), float(values[0])))
        if found.value < n - rank:
            raise np.linalg.LinAlgError("algebraic rows that depend on each other")
        self.ranks.append(found)
        pivots = qr(a2.value * self._weights[self.kept], mode="r", pivoting=True)[1]
        out, stay = np.sort(pivots[: n - rank]), np.sort(pivots[n - rank :])
        # 0 = a2_out v_out + a2_stay v_stay + b2 u
        inverse = a2.take(columns=out).inverse()
        follow = -inverse @ a2.take(columns=stay)
        parts = [split(b) for b in self.b]
        driven = [-inverse @ b2 for _, b2 in parts]
        self.b = added([b1 for b1, _ in parts], [a1.take(columns=out) @ d for d in driven])
        none = Tracked.of(np.zeros_like(self.b[0].value))
        self.b = added(self.b, [none, *(-e1.take(columns=out) @ d for d in driven)])
        self.direct = added(self.direct, [self.basis.take(columns=out) @ d for d in driven])

        def put_in(m: Tracked) -> Tracked:
            return m.take(columns=stay) + m.take(columns=out) @ follow

        self.e, self.a, self.basis = put_in(e1), put_in(a1), put_in(self.basis)
        self.c = [put_in(c) for c in self.c]
        self.kept = self.kept[stay]


def added(first: list[Tracked], second: list[Tracked]) -> list[Tracked]:
    """Return the sum of two polynomials; powers that vanished are left off."""
    longer, shorter = (first, second) if len(first) >= len(second) else (second, first)
    found = [m + shorter[k] if k < len(shorter) else m for k, m in enumerate(longer)]
    while len(found) > 1 and not found[-1].value.any():
        found.pop()
    return found


def poles_of(a: Matrix) -> NDArray[Any]:
    """Return the eigenvalues; those at the origin, however often they coincide, are exactly 0.

    A double eigenvalue at 0 (a free mass) is found by QR only to half the digits. How many there
    are is a matter of ranks, of a matrix in even units: they are the infinite eigenvalues of the
    pencil (a, 1).

    Examples
    --------
    >>> poles_of(np.array([[0.0, 1.0, 0.0], [0.0, -1e5, 1.0], [0.0, 0.0, -1e5]])).tolist()
    [-100000.0, -100000.0, 0.0]
    """
    n = len(a)
    if not n:
        return np.zeros(0)
    even, unit = in_even_units(a)
    values = np.linalg.eigvals(even) * unit
    try:
        moving = len(Reduction(inverted(even)).kept)
    except np.linalg.LinAlgError:
        moving = n
    values[np.argsort(np.abs(values), kind="stable")[: n - moving]] = 0.0
    ordered = values[np.lexsort((values.imag, values.real))]
    return np.asarray(ordered if ordered.imag.any() else ordered.real)


def inverted(a: Matrix) -> Scaled:
    """Return the pencil (a, 1), rows and columns scaled so that entries of a are near 1.

    Ranks of a are not those of units or of time constants: a slow pole beside a fast one is none
    at the origin.
    """
    n = len(a)
    terms: list[tuple[tuple[tuple[int, float], ...], float]] = [
        (((int(i), 1.0), (n + int(j), 1.0)), float(np.log2(abs(a[i, j]))))
        for i, j in np.argwhere(a)
    ]
    x = exponents(terms, 2 * n)
    rows, columns = np.exp2(x[:n]), np.exp2(x[n:])
    none = np.zeros((n, 0))
    return Scaled(
        a * rows[:, None] * columns, np.diag(rows * columns), none, none.T, none.T, columns, 1.0
    )


def in_even_units(a: Matrix) -> tuple[Matrix, float]:
    """Return ``T^-1 a T / unit`` with entries as near to 1 as they can be, and the unit.

    T and the unit are powers of two: the eigenvalues are the same, times the unit, bit for bit.
    """
    n = len(a)
    terms: list[tuple[tuple[tuple[int, float], ...], float]] = []
    for i, j in np.argwhere(a):
        own: tuple[tuple[int, float], ...] = ((n, -1.0),)
        if i != j:
            own = ((int(i), -1.0), (int(j), 1.0), *own)
        terms.append((own, float(np.log2(abs(a[i, j])))))
    x = exponents(terms, n + 1)
    t, unit = np.exp2(x[:n]), float(np.exp2(x[n]))
    return a * t / t[:, None] / unit, unit
