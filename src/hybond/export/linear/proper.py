"""A descriptor ``E v' = A v + B u`` brought to a state space whose states are some of `v`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybond.equations.descriptor import Descriptor
from hybond.equations.pencil import Reduction, added
from hybond.equations.ranks import Scaled, Tracked, scaled
from hybond.errors import EquationError

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Proper:
    """``x' = A x + B u``, ``v = basis @ x + sum of direct[k] @ (k-th derivative of u)``."""

    A: Matrix
    B: Matrix
    basis: Matrix
    direct: tuple[Matrix, ...]
    kept: tuple[int, ...]
    """Which of `v` the states are, but for what `direct` adds to them."""


def proper(E: Matrix, A: Matrix, B: Matrix, stored: int, *, keep: Sequence[int] = ()) -> Proper:
    """Reduce a descriptor; the first `stored` variables may be states, those of `keep` before all.

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
    n = len(B)
    names = tuple(str(k) for k in range(n))
    unit = scaled(Descriptor.of(E, A, np.zeros((n, 0)), states=names, inputs=()))
    unit = replace(unit, B=_row_scales(E, A, unit)[:, None] * B)
    last = (np.arange(n) < stored).astype(int)
    last[list(keep)] = 2
    try:
        left = Reduction(unit, last=last)
    except np.linalg.LinAlgError:
        raise EquationError(
            "the equations of this mode do not determine all variables",
            code="HB-Q105",
            where="the equations",
            hint="hybond analyse tells what is undetermined",
        ) from None
    a, b, basis, direct, kept = left.a, left.b, left.basis, left.direct, left.kept
    # b(s) = (s - a) g(s) + rest: with v_kept = x + g(s) u, x' = a x + rest u
    g: list[Tracked] = []
    rest = b[-1]
    for coefficient in reversed(b[:-1]):
        g.insert(0, rest)
        rest = coefficient + a @ rest
    direct = added(direct, [basis @ m for m in g])
    size, inner, time = unit.columns[:, None], unit.columns[kept][:, None], unit.time
    return Proper(
        time * inner * a.value / inner.T,
        time * inner * rest.value,
        size * basis.value / inner.T,
        tuple(size * m.value / time**k for k, m in enumerate(direct)),
        tuple(int(k) for k in kept),
    )


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
