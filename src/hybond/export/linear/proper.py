"""A descriptor ``E v' = A v + B u`` brought to a state space whose states are some of `v`.

Rows without rates are algebraic. Some of their variables follow from the others and the inputs and
are put in, which may leave further such rows, until E is invertible (as in
`hybond.equations.pencil`; here everything that inputs add is carried along, derivatives too).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.equations.descriptor import Descriptor
from hybond.equations.ranks import RANK, Scaled, Tracked, counted, rank_of, scaled
from hybond.errors import EquationError

Matrix = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Proper:
    """``x' = A x + B u``, ``v = basis @ x + sum of direct[k] @ (k-th derivative of u)``."""

    A: Matrix
    B: Matrix
    basis: Matrix
    direct: tuple[Matrix, ...]
    kept: tuple[int, ...]
    """Which of `v` the states are, but for what `direct` adds to them."""


def proper(E: Matrix, A: Matrix, B: Matrix, stored: int) -> Proper:
    """Reduce a descriptor; the first `stored` variables may be states.

    Raises
    ------
    EquationError
        HB-Q105 if the equations do not determine `v`.

    Examples
    --------
    Two capacitors of 1 F and 2 F in series across a source:

    >>> E = np.array([[0.0, 0.0], [1.0, -1.0]])
    >>> A = np.array([[-1.0, -0.5], [0.0, 0.0]])
    >>> found = proper(E, A, np.array([[1.0], [0.0]]), 2)
    >>> found.A.tolist(), found.kept
    ([[0.0]], (1,))
    >>> (found.basis[0] + 0.5 * found.basis[1]).tolist(), found.direct[0].round(12).tolist()
    ([0.0], [[0.666666666667], [0.666666666667]])
    """
    n, p = B.shape
    names = tuple(str(k) for k in range(n))
    unit = scaled(Descriptor.of(E, A, np.zeros((n, 0)), states=names, inputs=()))
    left = _row_scales(E, A, unit)
    e, a, b = Tracked.of(unit.E), Tracked.of(unit.A), [Tracked.of(left[:, None] * B)]
    kept, size_e = np.arange(n), float(np.linalg.norm(unit.E, 2)) if n else 0.0
    # v = basis @ v_kept + direct(s) u, as b is a polynomial in s
    basis, direct = Tracked.of(np.eye(n)), [Tracked.of(np.zeros((n, p)))]
    while len(e.value):
        rank = rank_of(e.value, size_e).value
        if rank == len(e.value):
            break
        cut = _cut(e, a, rank, kept < stored)
        parts = [(cut.above(m), cut.below(m)) for m in b]
        drive = [-cut.inverse @ below for _, below in parts]
        out = cut.out
        # what follows is put in: v_out = follow @ v_stay + drive(s) u
        b = _sum([above for above, _ in parts], [cut.a.take(columns=out) @ d for d in drive])
        b = _sum(b, [_none(b[0]), *(-cut.e.take(columns=out) @ d for d in drive)])
        direct = _sum(direct, [basis.take(columns=out) @ d for d in drive])
        e, a, basis = cut.put_in(cut.e), cut.put_in(cut.a), cut.put_in(basis)
        kept = kept[cut.stay]
    inverse = e.inverse()
    a, b = inverse @ a, [inverse @ m for m in b]
    # b(s) = (s - a) g(s) + rest: with v_kept = x + g(s) u, x' = a x + rest u
    g: list[Tracked] = []
    rest = b[-1]
    for coefficient in reversed(b[:-1]):
        g.insert(0, rest)
        rest = coefficient + a @ rest
    direct = _sum(direct, [basis @ m for m in g])
    size, inner, time = unit.columns[:, None], unit.columns[kept][:, None], unit.time
    return Proper(
        time * inner * a.value / inner.T,
        time * inner * rest.value,
        size * basis.value / inner.T,
        tuple(size * m.value / time**k for k, m in enumerate(direct)),
        tuple(int(k) for k in kept),
    )


@dataclass(frozen=True, slots=True)
class _Cut:
    """One step: rows without rates, and the variables that follow from them."""

    upper: Indices
    lower: Indices
    mix: Tracked
    out: Indices
    stay: Indices
    e: Tracked
    a: Tracked
    inverse: Tracked
    follow: Tracked

    def above(self, m: Tracked) -> Tracked:
        return m.take(self.upper)

    def below(self, m: Tracked) -> Tracked:
        return m.take(self.lower) + -self.mix @ m.take(self.upper)

    def put_in(self, m: Tracked) -> Tracked:
        return m.take(columns=self.stay) + m.take(columns=self.out) @ self.follow


def _cut(e: Tracked, a: Tracked, rank: int, storage: NDArray[np.bool_]) -> _Cut:
    from scipy.linalg import qr

    n = len(e.value)
    pivots = qr(e.value.T, mode="r", pivoting=True)[1]
    upper, lower = np.sort(pivots[:rank]), np.sort(pivots[rank:])
    mix = Tracked.of(e.value[lower] @ np.linalg.pinv(e.value[upper], rcond=RANK))
    mix = Tracked(np.where(np.abs(mix.value) > RANK, mix.value, 0.0), mix.error)
    a2 = a.take(lower) + -mix @ a.take(upper)
    values = np.linalg.svd(a2.value, compute_uv=False)
    most = max(float(np.linalg.norm(a.value, 2)), float(values[0]))
    if counted(values, most).value < n - rank:
        raise EquationError(
            "the equations of this mode do not determine all variables",
            code="HB-Q105",
            hint="hybond analyse tells what is undetermined",
        )
    # what is stored stays if anything else may go
    weights = np.where(storage, 2.0**-20, 1.0)
    pivots = qr(a2.value * weights, mode="r", pivoting=True)[1]
    out, stay = np.sort(pivots[: n - rank]), np.sort(pivots[n - rank :])
    inverse = a2.take(columns=out).inverse()
    follow = -inverse @ a2.take(columns=stay)
    return _Cut(upper, lower, mix, out, stay, e.take(upper), a.take(upper), inverse, follow)


def _row_scales(E: Matrix, A: Matrix, unit: Scaled) -> Matrix:
    """Return by what the rows were multiplied, all powers of two."""
    found = np.ones(len(A))
    for i in range(len(A)):
        for before, after, more in ((A, unit.A, 1.0), (E, unit.E, unit.time)):
            j = int(np.argmax(np.abs(before[i]) > 0.0))
            if before[i, j]:
                found[i] = after[i, j] / (before[i, j] * unit.columns[j] * more)
                break
    return found


def _sum(first: list[Tracked], second: list[Tracked]) -> list[Tracked]:
    """Add polynomials; powers that vanished are left off."""
    longer, shorter = (first, second) if len(first) >= len(second) else (second, first)
    found = [m + shorter[k] if k < len(shorter) else m for k, m in enumerate(longer)]
    while len(found) > 1 and not found[-1].value.any():
        found.pop()
    return found


def _none(m: Tracked) -> Tracked:
    return Tracked.of(np.zeros_like(m.value))
