"""Floquet multipliers: the eigenvalues of the monodromy matrix, and what each says.

Where motions lose directions (a diode that blocks, friction that holds, a plastic impact, storage
that follows other storage), the matrix M has no full rank, and eigenvalues that are zero are often
defective: rounding makes 1e-16 to 1e-8 or 1e-5. M maps into its range, so that it is restricted to
that, again and again, until nothing is lost any more. What was lost are the zeros.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]

RANK = 1e-11
"""Singular values of the scaled matrix below this part of the largest count as zero."""
NEAR = 1e-5
"""From the unit circle: a multiplier that is nearer is on it, as far as can be told."""


@dataclass(frozen=True, slots=True, eq=False)
class Multiplier:
    """A Floquet multiplier.

    Parameters
    ----------
    value : complex
    kind : str
        What crosses: ``"fold"`` near +1, ``"period doubling"`` near -1, ``"Neimark-Sacker"`` for a
        pair near the circle elsewhere; ``"phase"`` for the one that is 1 because nothing says when
        an autonomous motion begins, ``"conserved"`` for one that is 1 because something is kept;
        ``"zero"`` for a direction that is lost; empty otherwise.
    """

    value: complex
    kind: str = ""

    @property
    def counts(self) -> bool:
        """Whether stability depends on it."""
        return self.kind not in ("phase", "conserved")

    def __str__(self) -> str:
        v = self.value
        if self.kind == "zero":
            return "0"
        return (
            f"{v.real:.9g}" if not v.imag else f"{v.real:.9g} {'+-'[v.imag < 0]} {abs(v.imag):.9g}i"
        )


def eigenvalues(M: Vector, sizes: Vector) -> tuple[Complex, int]:
    """Return the eigenvalues of a matrix that are not zero by its structure, and how many are.

    Parameters
    ----------
    M : array, shape (n, n)
    sizes : array, shape (n,)
        What states are measured by.

    Examples
    --------
    A defective zero, which a plain computation returns as 1e-8:

    >>> import numpy as np
    >>> M = np.array([[1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [0.0, 0.0, 0.5]])
    >>> values, zeros = eigenvalues(M, np.ones(3))
    >>> values.tolist(), zeros
    ([(0.5+0j)], 2)
    """
    own = M * sizes / sizes[:, None]
    n, largest = len(own), 0.0
    while len(own):
        u, values, _ = np.linalg.svd(own)
        largest = max(largest, float(values.max()))
        rank = int((values > RANK * largest).sum())
        if rank == len(own):
            break
        own = u[:, :rank].T @ own @ u[:, :rank]
    found = np.linalg.eigvals(own).astype(complex) if len(own) else np.zeros(0, dtype=complex)
    order = np.lexsort((-found.imag, -found.real, -np.round(np.abs(found), 12)))
    return found[order], n - len(own)


def multipliers(M: Vector, sizes: Vector, *, phase: bool, conserved: int) -> tuple[Multiplier, ...]:
    """Return the multipliers of a period, the largest first.

    Parameters
    ----------
    phase : bool
        Whether the motion is autonomous, so that one of them is 1.
    conserved : int
        Quantities that the motion keeps, for each of which one is 1.
    """
    values, zeros = eigenvalues(M, sizes)
    kinds = [_kind(v) for v in values.tolist()]
    nearest = np.argsort(np.abs(values - 1.0), kind="stable").tolist()
    names = ["phase"] * phase + ["conserved"] * conserved
    for k, name in zip(nearest, names):
        kinds[k] = name
    found = [Multiplier(complex(v), kind) for v, kind in zip(values.tolist(), kinds, strict=True)]
    return (*found, *[Multiplier(0j, "zero")] * zeros)


def _kind(v: complex) -> str:
    if abs(abs(v) - 1.0) > NEAR:
        return ""
    if abs(v - 1.0) <= 10.0 * NEAR:
        return "fold"
    if abs(v + 1.0) <= 10.0 * NEAR:
        return "period doubling"
    return "Neimark-Sacker"


def is_stable(found: Sequence[Multiplier]) -> bool:
    """Whether all multipliers that count are inside the unit circle."""
    return all(abs(m.value) < 1.0 - NEAR for m in found if m.counts)
