"""`CommonSpace`: what modes with different constraints hold stored quantities to, all together.

Two modes around a switching surface may hold stored quantities to different constraints: engaged,
a shaft and its load turn together; released, they do not. Every crossing is then a jump. Sliding
keeps the state where all constraints are met, ``M``: there a jump is zero, and while a mode lasts
for a short time dt in which its field f leads off M by f dt, the next entry brings it back along
the impulses D that conserve the state. In the limit each mode moves the state at the rate

    x' = f + D nu,   nu such that   d/dt (G z(x) - c) = 0   for the constraints of all modes,

and D nu is the mean of infinitely many vanishing impulses: a finite effort or flow of every bond.
The limit is unique, because a projection along the impulses of one mode is followed by that along
all of them without a difference. Energy balances: what a jump takes is of second order in dt.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.equations.mode import ModeEquations

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

ROUNDING = 1e-13
"""A constraint that drifts by less than this part of its terms is kept already."""
REPEATED = 1e-12
"""Constraints of several modes may repeat each other: a direction in which their impulses act by
less than this part of the strongest is rounding of such a repetition."""
KEEPABLE = 1e-9
"""Impulses can keep all constraints if they leave less than this part of the drift's terms."""


@dataclass(slots=True)
class CommonSpace:
    """The constraints of some modes together, and the impulses that can keep them.

    Parameters
    ----------
    holders : list of ModeEquations
        Modes whose constraints are among them.
    rows : list of array, shape (constraints, knowns)
        Of each, over its co-energy variables and sources.
    directions : array, shape (2 * bonds, k)
        Impulses of every bond.
    moves : array, shape (storages, k)
        What they do to what is stored.
    """

    holders: list[ModeEquations]
    rows: list[Matrix]
    directions: Matrix
    moves: Matrix

    def kept(self, v: list[float], x: Vector, w: Vector, rates: Vector) -> tuple[Vector, Vector]:
        """Return bond variables and rates of what is stored, such that all constraints are kept.

        Parameters
        ----------
        v : list of float
            Values with the bond variables `w` of one mode.
        x, rates : array, shape (storages,)
        w : array, shape (2 * bonds,)
        """
        drift, size = self._drift(v, x, rates)
        drift = np.where(np.abs(drift) <= ROUNDING * size, 0.0, drift)
        if not drift.any():
            return w, rates
        nu = np.linalg.pinv(self._slope(x), rcond=REPEATED) @ -drift
        return w + self.directions @ nu, rates + self.moves @ nu

    def can_keep(self, v: list[float], x: Vector, rates: Vector) -> bool:
        """Whether impulses can keep what the field of a mode leads off."""
        drift, size = self._drift(v, x, rates)
        slope = self._slope(x)
        rest = drift - slope @ (np.linalg.pinv(slope, rcond=REPEATED) @ drift)
        return bool((np.abs(rest) <= KEEPABLE * float(size.max(initial=0.0))).all())

    def onto(self, v: list[float], x: Vector) -> Vector:
        """Return the stored quantities put back where all constraints are met."""
        return np.asarray(x - self.moves @ self.correction(v, x))

    def correction(self, v: list[float], x: Vector) -> Vector:
        """Return the areas of the impulses by which a state is off the constraints."""
        off = self._residual(v, x)[0]
        return np.asarray(np.linalg.pinv(self._slope(x), rcond=REPEATED) @ off)

    def met(self, v: list[float], x: Vector, tolerance: float) -> bool:
        """Whether all constraints are met, up to a part of their terms."""
        off, size = self._residual(v, x)
        return bool((np.abs(off) <= tolerance * size).all())

    def _residual(self, v: list[float], x: Vector) -> tuple[Vector, Vector]:
        known = [e.knowns(v, x, rates=False) for e in self.holders]
        pairs = list(zip(self.rows, known, strict=True))
        off = np.concatenate([rows @ k for rows, k in pairs])
        return off, np.concatenate([np.abs(rows) @ np.abs(k) for rows, k in pairs])

    def _slope(self, x: Vector) -> Matrix:
        n = len(x)
        stiff = self.holders[0].storage.stiffness(x)
        return np.vstack([r[:, :n] for r in self.rows]) @ stiff @ self.moves

    def _drift(self, v: list[float], x: Vector, rates: Vector) -> tuple[Vector, Vector]:
        """Return the rates of the constraints' residuals and the size of their terms."""
        n = len(x)
        stiff = self.holders[0].storage.stiffness(x)
        drift, size = [], []
        for e, rows in zip(self.holders, self.rows, strict=True):
            known = np.zeros(rows.shape[1])
            known[:n] = stiff @ rates
            for k, f in e.rate_values:
                known[n + k] = f(v)
            drift.append(rows @ known)
            size.append(np.abs(rows) @ np.abs(known))
        return np.concatenate(drift), np.concatenate(size)


Meet = Callable[[Sequence[ModeEquations]], CommonSpace | None]
"""Returns the common space of some modes, None if they have the same constraints."""
