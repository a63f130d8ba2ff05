"""Dense output of several steps as one."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

import numpy as np

from hybond.engine.outcome.polynomial import Interpolant, Polynomial
from hybond.solvers.base import FloatArray


class Joined(Interpolant):
    """Polynomials that follow one another, as one.

    Parameters
    ----------
    pieces : sequence of Polynomial
        Each begins where the one before ends; at least one.

    Examples
    --------
    >>> ends = [np.zeros(1), np.ones(1), np.full(1, 3.0)]
    >>> rise = Polynomial(0.0, 1.0, ends[0], ends[1], np.array([[1.0]]))
    >>> steeper = Polynomial(1.0, 2.0, ends[1], ends[2], np.array([[2.0]]))
    >>> Joined([rise, steeper])(np.array([0.5, 1.0, 1.5]))
    array([[0.5, 1. , 2. ]])
    """

    __slots__ = ("_pieces", "_starts")

    def __init__(self, pieces: Sequence[Polynomial]) -> None:
        super().__init__(pieces[0].t0, pieces[-1].t1, pieces[0].y0, pieces[-1].y1)
        self._pieces = pieces
        self._starts = [piece.t0 for piece in pieces]

    def _at(self, t: float) -> FloatArray:
        return self._pieces[max(bisect_right(self._starts, t) - 1, 0)](t)

    def _at_all(self, times: FloatArray) -> FloatArray:
        # Time by time, for the same bits as a call for each; rare and short.
        values = np.empty((self.y0.size, times.size))
        for k, t in enumerate(times.tolist()):
            values[:, k] = self._at(t)
        return values
