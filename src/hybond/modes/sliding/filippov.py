"""Which way a state on switching surfaces goes on: through them, or along some of them.

With weights ``lambda_j`` in [0, 1] of the states above, Filippov's inclusion asks for

    dg_j/dt > 0  only if lambda_j = 1,   dg_j/dt < 0  only if lambda_j = 0.

For fields additive in the switches ``dg/dt = a + B lambda``: a linear complementarity problem
between bounds. If -B is a P-matrix (every switch wins over the others on its own surface) there
is one answer, and least-index pivoting finds it. Otherwise all choices are tried, and their
number is told: two futures, or none.

Source: Judice & Pires, *A basic-set algorithm for a generalized linear complementarity problem*,
J. Optim. Theory Appl. 74 (1992), for the pivoting; Filippov 1988 for the inclusion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

FEW = 6
"""Most surfaces for which all choices are tried."""
BELOW, SLIDES, ABOVE = 0, 1, 2


@dataclass(frozen=True, slots=True)
class Future:
    """A way to go on.

    Parameters
    ----------
    sides : tuple of int
        Per surface `BELOW`, `SLIDES` or `ABOVE`.
    weights : array, shape (k,)
    """

    sides: tuple[int, ...]
    weights: Vector

    @property
    def sliding(self) -> tuple[int, ...]:
        """The surfaces along which it goes."""
        return tuple(j for j, side in enumerate(self.sides) if side == SLIDES)


def future(a: Vector, b: Matrix) -> Future | None:
    """Return the way on for ``dg/dt = a + B lambda``, None if pivoting finds none.

    Parameters
    ----------
    a : array, shape (k,)
        Rates of the switching functions with every machine below.
    b : array, shape (k, k)
        What each machine's being above adds to them.

    Examples
    --------
    >>> future(np.array([1.5]), np.array([[-2.0]]))        # both sides push in
    Future(sides=(1,), weights=array([0.75]))
    >>> future(np.array([1.5]), np.array([[-1.0]])).sides  # through, to above
    (2,)
    """
    k = len(a)
    sides = [SLIDES] * k
    for _ in range(40 + 20 * k):
        weights = _weights(a, b, sides)
        if weights is None:
            return None
        wrong = _wrong(a, b, sides, weights)
        if not wrong:
            return Future(tuple(sides), weights)
        j, side = wrong[0]
        sides[j] = side
    return None


def futures(a: Vector, b: Matrix) -> list[Future]:
    """Return every way on, by trying all; those that slide least come last.

    Examples
    --------
    >>> [f.sides for f in futures(np.array([-1.0]), np.array([[2.0]]))]   # both push away
    [(1,), (2,), (0,)]
    """
    found = []
    for sides in product((SLIDES, ABOVE, BELOW), repeat=len(a)):
        weights = _weights(a, b, list(sides))
        if weights is not None and not _wrong(a, b, sides, weights):
            found.append(Future(sides, weights))
    return sorted(found, key=lambda f: -len(f.sliding))


def futures_of(rates: Callable[[Vector], Vector], k: int) -> list[Future]:
    """Return every way on for rates that are not linear in the weights.

    `rates` returns ``dg/dt`` at given weights; Newton starts from the middle.
    """
    found = []
    for sides in product((SLIDES, ABOVE, BELOW), repeat=k):
        weights = np.array([1.0 if s == ABOVE else 0.5 if s == SLIDES else 0.0 for s in sides])
        free = [j for j, s in enumerate(sides) if s == SLIDES]
        if free and not _newton(rates, weights, free):
            continue
        speed = rates(weights)
        if all(
            (0.0 <= weights[j] <= 1.0 and j in free)
            or (s == ABOVE and speed[j] >= 0.0)
            or (s == BELOW and speed[j] <= 0.0)
            for j, s in enumerate(sides)
        ):
            found.append(Future(sides, weights))
    return sorted(found, key=lambda f: -len(f.sliding))


def _newton(rates: Callable[[Vector], Vector], weights: Vector, free: Sequence[int]) -> bool:
    for _ in range(30):
        residual = rates(weights)[list(free)]
        slope = np.empty((len(free), len(free)))
        for c, j in enumerate(free):
            ahead = weights.copy()
            # multilinear: exact in each weight alone, whatever the step
            ahead[j] += 1.0
            slope[:, c] = rates(ahead)[list(free)] - residual
        try:
            step = np.linalg.solve(slope, residual)
        except np.linalg.LinAlgError:
            return False
        weights[list(free)] -= step
        if not np.abs(step).max() < 1e6:
            return False
        if np.abs(step).max() <= 1e-14:
            return True
    return bool(np.abs(step).max() <= 1e-10)


def _weights(a: Vector, b: Matrix, sides: Sequence[int]) -> Vector | None:
    weights = np.array([1.0 if s == ABOVE else 0.0 for s in sides])
    free = [j for j, s in enumerate(sides) if s == SLIDES]
    if free:
        try:
            found = np.linalg.solve(b[np.ix_(free, free)], -(a + b @ weights)[free])
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(found).all():
            return None
        weights[free] = found
    return weights


def _wrong(a: Vector, b: Matrix, sides: Sequence[int], weights: Vector) -> list[tuple[int, int]]:
    """Return the surfaces on which a choice fails, and the side to try instead."""
    speed = a + b @ weights
    found = []
    for j, side in enumerate(sides):
        if side == SLIDES:
            if weights[j] < 0.0:
                found.append((j, BELOW))
            elif weights[j] > 1.0:
                found.append((j, ABOVE))
        elif (side == ABOVE and speed[j] < 0.0) or (side == BELOW and speed[j] > 0.0):
            found.append((j, SLIDES))
    return found
