"""Floquet multipliers: the eigenvalues of the monodromy matrix, and what each says.

Where motions lose directions (a diode that blocks, friction that holds, a plastic impact, storage
that follows other storage), the matrix M has no full rank, and eigenvalues that are zero are often
defective: rounding makes 1e-16 to 1e-8 or 1e-5. M maps into its range, so that it is restricted to
that, again and again, until nothing is lost any more. How many are zero says the way through the
period (`lost`); what else goes under is too small to be told.
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
ZERO = 1e-4
"""Below this size rounding may leave one that is zero for structure."""
ONE = 1e-2
"""As near to 1 is one that is 1 for structure: it is so defective that rounding moves it."""
SPLIT = 0.02
"""Part of how far two are from 1 by which their mean is, where they are one that is defective."""
CIRCLE = ("fold", "period doubling", "Neimark-Sacker")
"""Kinds of those that are on the unit circle without a reason that is known."""


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
        ``"neutral"`` for one on the circle because nothing damps it; ``"zero"`` for a direction
        that is lost, ``"fast"`` for one too small to be told; empty otherwise.
    """

    value: complex
    kind: str = ""

    @property
    def counts(self) -> bool:
        """Whether stability depends on it."""
        return self.kind not in ("phase", "conserved")

    def __str__(self) -> str:
        v = self.value
        if self.kind in ("zero", "fast"):
            return "0" if self.kind == "zero" else f"below {RANK:.0e}"
        return (
            f"{v.real:.9g}" if not v.imag else f"{v.real:.9g} {'+-'[v.imag < 0]} {abs(v.imag):.9g}i"
        )


def eigenvalues(M: Vector, sizes: Vector) -> tuple[Complex, int]:
    """Return the eigenvalues of a matrix that rounding leaves, and how many go under.

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


def multipliers(
    M: Vector, sizes: Vector, *, phase: bool, conserved: int, lost: int
) -> tuple[Multiplier, ...]:
    """Return the multipliers of a period, the largest first.

    Parameters
    ----------
    phase : bool
        Whether the motion is autonomous, so that one of them is 1.
    conserved : int
        Quantities that the motion keeps, for each of which one is 1.
    lost : int
        Directions that are lost, for each of which one is 0.
    """
    values, under = eigenvalues(M, sizes)
    while under < lost and len(values) and abs(values[-1]) < ZERO:
        values, under = values[:-1], under + 1
    kinds = [_kind(v) for v in values.tolist()]
    nearest = np.argsort(np.abs(values - 1.0), kind="stable").tolist()
    names = ["phase"] * phase + ["conserved"] * conserved
    for k, name in zip(nearest, names):
        kinds[k] = name
        if phase and conserved and abs(values[k] - 1.0) < ONE:
            values[k] = 1.0
    found = [Multiplier(complex(v), kind) for v, kind in zip(values.tolist(), kinds, strict=True)]
    lost = min(lost, under)
    return (*found, *[Multiplier(0j, "fast")] * (under - lost), *[Multiplier(0j, "zero")] * lost)


def spanned(M: Vector, sizes: Vector, values: Sequence[complex]) -> Vector:
    """Return a basis of the states that some multipliers belong to, shape (n, values)."""
    own = M * sizes / sizes[:, None]
    found, vectors = np.linalg.eig(own)
    near = np.abs(found[:, None] - np.asarray(values)[None]).min(axis=1)
    chosen = vectors[:, np.argsort(near, kind="stable")[: len(values)]]
    u, _, _ = np.linalg.svd(np.hstack([chosen.real, chosen.imag]), full_matrices=False)
    return np.asarray(u[:, : len(values)] * sizes[:, None])


def is_double(M: Vector, sizes: Vector) -> bool:
    """Whether rounding has split a defective 1, as a motion in a family of them has it.

    The two parts are as far from 1, in opposite directions; the 1 of a motion alone is none of two.

    Examples
    --------
    >>> import numpy as np
    >>> is_double(np.array([[1.0, 3.0], [1e-7, 1.0]]), np.ones(2))
    True
    >>> is_double(np.array([[1.0, 3.0], [0.0, 0.999]]), np.ones(2))
    False
    """
    off = eigenvalues(M, sizes)[0] - 1.0
    off = off[np.argsort(np.abs(off), kind="stable")][:2]
    far = float(np.abs(off).max(initial=0.0))
    return bool(len(off) == 2 and 0.0 < far < ONE and abs(off.sum()) < SPLIT * far)


def _kind(v: complex) -> str:
    if abs(abs(v) - 1.0) > NEAR:
        return ""
    if abs(v - 1.0) <= 10.0 * NEAR:
        return "fold"
    if abs(v + 1.0) <= 10.0 * NEAR:
        return "period doubling"
    return "Neimark-Sacker"


def is_stable(found: Sequence[Multiplier]) -> bool:
    """Whether all multipliers that count are inside the unit circle.

    Where all are 1 because something is conserved, none brings motions nearer: that is neutral.
    """
    counts = [m for m in found if m.counts]
    inside = all(abs(m.value) < 1.0 - NEAR for m in counts)
    return inside and (bool(counts) or not any(m.kind == "conserved" for m in found))


def is_neutral(found: Sequence[Multiplier]) -> bool:
    """Whether motions near it neither come to it nor leave it, as far as multipliers say."""
    return not is_stable(found) and all(abs(m.value) <= 1.0 + NEAR for m in found if m.counts)
