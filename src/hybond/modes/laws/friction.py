"""Dry friction in the problem of all laws: its limits, and how it breaks loose."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.equations.calculus import gradient
from hybond.model.expressions import Expr
from hybond.modes.laws.problem import Answer, Friction
from hybond.programs.program import Program

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Closure = Callable[[Sequence[float]], float]


class Linearised:
    """Limits of friction as affine functions of what the laws give.

    A limit may follow bond variables (a contact force), and they follow the laws of the same
    problem. What a limit is made of is compiled once.
    """

    def __init__(self, program: Program) -> None:
        self.program = program
        self._known: dict[Expr, tuple[Closure, list[tuple[int, Closure]]]] = {}

    def at(self, limit: Expr, v: Sequence[float], bonds: Vector, gain: Matrix) -> Friction:
        """Return a limit where bond variables are ``bonds + gain @ l``.

        Parameters
        ----------
        limit : Expr
        v : sequence of float
            The values at which it is linearised.
        bonds : array, shape (2 * bonds,)
        gain : array, shape (2 * bonds, ports)
        """
        value, slopes = self._compiled(limit)
        here = self.program.slots.w.start
        at, slope = float(value(v)), np.zeros(gain.shape[1])
        for k, f in slopes:
            d = f(v)
            at += d * float(bonds[k] - v[here + k])
            slope = slope + d * gain[k]
        return Friction(at, slope)

    def _compiled(self, e: Expr) -> tuple[Closure, list[tuple[int, Closure]]]:
        """Return a limit, compiled, and its derivatives by bond variables."""
        found = self._known.get(e)
        if found is None:
            slots = self.program.slots
            slopes = [
                (slots.index[name] - slots.w.start, self.program.compile(d))
                for name, d in gradient(e).items()
            ]
            found = self._known[e] = self.program.compile(e), slopes
        return found


def breaking_loose(resting: set[int], solve: Callable[[set[int]], Answer | None]) -> Answer | None:
    """Return an answer in which what rests holds up to its breakaway limit.

    What has to move although that holds it slides with the limit of sliding, and the others are
    asked again: to let go is never taken back.

    Parameters
    ----------
    resting : set of int
        Ports held by their breakaway limits to begin with.
    solve : callable
        The answer of all laws when these ports are, None if there is none.
    """
    while True:
        found = solve(resting)
        if found is None:
            return None
        broken = {k for k in resting if found.branch[k] != 0}
        if not broken:
            return found
        resting = resting - broken
