"""Steps of `moreau` where everything but the laws is linear: matrices, factorised once.

With ``x' = A x + b(t) + E l`` and bond variables ``w = X x + u(t) + G l``::

    x+ = (1 - h theta A)^-1 [ x + h (1 - theta) x'(t) + h theta b(t + h) + h E l ]
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hybond.equations.calculus import gradient, reads_bonds
from hybond.equations.ports import PortEquations
from hybond.model.expressions import Expr, Number, names
from hybond.modes.laws.problem import Answer
from hybond.modes.stepping.laws import Laws, closed_half_way
from hybond.programs.interval import Interval

if TYPE_CHECKING:
    from hybond.modes.stepping.moreau import Point, ThetaScheme

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

KEPT = 32
"""Pairs of configuration and step whose matrices are kept."""
_OUTER = ("u:", "at:", "in:", "on:")
"""Names that do not depend on the state."""


@dataclass(slots=True)
class _Matrices:
    """A linear configuration and step: ``x+ = free + push l``, ``w+ = bonds(free) + gain l``."""

    ports: PortEquations
    state: Matrix
    inverse: Matrix
    push: Matrix
    gain: Matrix
    problem: Matrix


class LinearSteps:
    """The linear steps of one scheme."""

    def __init__(self, scheme: ThetaScheme) -> None:
        self.scheme = scheme
        self._matrices: OrderedDict[tuple[int, float], _Matrices] = OrderedDict()
        self._straight: dict[int, tuple[PortEquations, bool]] = {}

    def take(self, ports: PortEquations) -> bool:
        """Whether a step is linear but for the laws: the state acts through matrices alone."""
        found = self._straight.get(id(ports))
        if found is None or found[0] is not ports:
            e = ports.equations
            sources = [e.tableau.sources[k].value for k, _ in e.source_values]
            limits = [m for p in ports.ports for m in (p.law.limit, p.law.breakaway) if m]
            straight = (
                ports.linear and all(_outer(a) for a in sources) and all(_affine(a) for a in limits)
            )
            found = self._straight[id(ports)] = (ports, straight)
        return found[1]

    def step(
        self,
        start: Point,
        interval: Interval,
        t1: float,
        ports: PortEquations,
        laws: Laws,
        v: list[float],
        energy: float,
    ) -> tuple[Vector, Vector, Vector, Laws, Answer, list[int]]:
        """Return the end state, its bond variables, their mean, the laws taking part, the answer.

        `v` are the values at the beginning.
        """
        program, theta = self.scheme.program, self.scheme.theta
        nx, ns = program.nx, program.ns
        h = t1 - start.t
        x, s = start.y[:nx], start.y[nx : nx + ns]
        m = self._prepared(ports, h)
        nothing = np.zeros(len(ports.ports))
        rates = ports.equations.storage.rates
        before = ports.solve(v, x, nothing)
        slow = np.array(program.rates(v)) if ns else np.zeros(0)
        v1 = program.values(t1, interval, start.mode, np.zeros(nx), s)
        outer = ports.solve(v1, np.zeros(nx), nothing)
        free = m.inverse @ (x + h * ((1.0 - theta) * (rates @ before) + theta * (rates @ outer)))
        free = self.scheme.constrained(ports, v1, free, start.mode, energy)
        bonds = outer + m.state @ free
        v1[program.slots.x] = free.tolist()
        v1[program.slots.w] = bonds.tolist()
        laws = closed_half_way(laws, h, ports.partner @ bonds)
        answer, ambiguous = self.scheme.solve(ports, laws, v1, bonds, bonds, m.gain, start.mode, t1)
        x1 = free + m.push @ answer.l
        w1 = bonds + m.gain @ answer.l
        after = outer + m.state @ x1
        mean = w1 - (1.0 - theta) * (after - before)
        if not ns:
            return x1, w1, mean, laws, answer, ambiguous
        # integrated signals do not act back here, so that they follow
        v1[program.slots.x] = x1.tolist()
        v1[program.slots.w] = after.tolist()
        smooth = np.array(program.rates(v1))
        v1[program.slots.w] = w1.tolist()
        s1 = s + h * (np.array(program.rates(v1)) - (1.0 - theta) * (smooth - slow))
        return np.concatenate([x1, s1]), w1, mean, laws, answer, ambiguous

    def _prepared(self, ports: PortEquations, h: float) -> _Matrices:
        key = (id(ports), h)
        found = self._matrices.get(key)
        if found is None or found.ports is not ports:
            e = ports.equations
            n = self.scheme.program.nx
            state = e.x2[:, :n] if e.project is None else e.project @ e.x2[:, :n]
            state = state @ e.storage.matrix
            gain = ports.gains([], np.zeros(n))
            rates = e.storage.rates
            inverse = np.asarray(np.linalg.inv(np.eye(n) - h * self.scheme.theta * (rates @ state)))
            push = h * (inverse @ (rates @ gain))
            gain = gain + state @ push
            found = _Matrices(ports, state, inverse, push, gain, ports.partner @ gain)
            self._matrices[key] = found
            if len(self._matrices) > KEPT:
                self._matrices.popitem(last=False)
        self._matrices.move_to_end(key)
        return found


def _outer(e: Expr) -> bool:
    """Whether a value depends on time and modes alone."""
    return all(n == "time" or n.startswith(_OUTER) for n in names(e))


def _affine(e: Expr) -> bool:
    """Whether a limit is affine in bond variables, with coefficients from outside."""
    if isinstance(e, Number):
        return True
    inner = [n for n in names(e) if not (n == "time" or n.startswith((*_OUTER, "e:", "f:")))]
    return not inner and not any(reads_bonds(d) for d in gradient(e).values())
