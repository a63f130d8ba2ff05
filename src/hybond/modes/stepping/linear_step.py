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

from hybond.equations.calculus import bent, gradient, reads_bonds
from hybond.equations.element_parts import Dynamic
from hybond.equations.ports import PortEquations
from hybond.model.expressions import Expr, Number, names
from hybond.model.interval import Interval
from hybond.modes.stepping.coupling import Coupling, couple
from hybond.modes.stepping.laws import Laws, Together, closed_half_way

if TYPE_CHECKING:
    from hybond.modes.stepping.moreau import Point, ThetaScheme

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

ROUNDED = 1e-14
"""A `w` below this part of the terms that made it is rounding."""
KEPT = 32
"""Pairs of configuration and step whose matrices are kept."""
_OUTER = ("u:", "at:", "in:", "on:")
"""Names that do not depend on the state."""


@dataclass(slots=True)
class _Matrices:
    """A linear configuration and step: ``x+ = free + push l``, ``w+ = bonds(free) + gain l``.

    `state` are bond variables by what is stored, `rates` the rates of what is stored, `doubt` the
    size of the terms of which `w` is made.
    """

    ports: PortEquations
    state: Matrix
    rates: Matrix
    inverse: Matrix
    coupling: Coupling
    doubt: Matrix


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
                (e.linear or (e.affine and all(_constant(d) for d in e.rows)))
                and e.storage.linear
                and all(_outer(a) for a in sources)
                and all(_affine(a) for a in limits)
            )
            found = self._straight[id(ports)] = (ports, straight)
        return found[1]

    def step(
        self,
        start: Point,
        interval: Interval,
        t1: float,
        h: float,
        ports: PortEquations,
        laws: Laws,
        v: list[float],
        energy: float,
    ) -> tuple[Vector, Vector, Vector, Laws, Together]:
        """Return the end state, its bond variables, their mean, the laws taking part, the answer.

        `v` are the values at the beginning, `h` is the length of the step.
        """
        program, theta = self.scheme.program, self.scheme.theta
        nx, ns = program.nx, program.ns
        x, s = start.y[:nx], start.y[nx : nx + ns]
        m = self._prepared(ports, h)
        rates_of = ports.equations.storage.rates_of
        past = self._outer_part(ports, v)
        slow = np.zeros(0)
        if ns:
            v[program.slots.w] = (past + m.state @ x).tolist()
            slow = np.array(program.rates(v))
        v1 = program.values(t1, interval, start.mode, np.zeros(nx), s)
        outer = self._outer_part(ports, v1)
        driven = rates_of(theta * outer + (1.0 - theta) * past)
        free = m.inverse @ (x + h * ((1.0 - theta) * (m.rates @ x) + driven))
        free = self.scheme.constrained(ports, v1, free, start.mode, energy)
        bonds = outer + m.state @ free
        v1[program.slots.x] = free.tolist()
        v1[program.slots.w] = bonds.tolist()
        laws = closed_half_way(laws, h, ports.partner @ bonds)
        doubt = m.doubt @ np.abs(free) + ports.partner_size @ np.abs(outer)
        together = self.scheme.solve(
            ports, laws, v1, bonds, m.coupling, start.mode, t1, doubt=ROUNDED * doubt
        )
        l = together.answer.l
        x1 = free + m.coupling.push @ l
        w1 = bonds + m.coupling.gain @ l
        after = mean = w1
        if ns or theta < 1.0:
            after = outer + m.state @ x1
            mean = w1 - (1.0 - theta) * (after - past - m.state @ x)
        if not ns:
            return x1, w1, mean, laws, together
        # integrated signals do not act back here, so that they follow
        v1[program.slots.x] = x1.tolist()
        v1[program.slots.w] = after.tolist()
        smooth = np.array(program.rates(v1))
        v1[program.slots.w] = w1.tolist()
        s1 = s + h * (np.array(program.rates(v1)) - (1.0 - theta) * (smooth - slow))
        return np.concatenate([x1, s1]), w1, mean, laws, together

    def _outer_part(self, ports: PortEquations, v: list[float]) -> Vector:
        """Return the bond variables that sources alone would make; most knowns are zero."""
        e = ports.equations
        nothing = np.zeros(self.scheme.program.nx)
        if not e.linear:
            return ports.solve(v, nothing, np.zeros(len(ports.ports)))
        w = e.finite.by_knowns(e.knowns(v, nothing))
        return np.asarray(w if e.project is None else e.project @ w)

    def _zeros(self) -> list[float]:
        return [0.0] * (2 * self.scheme.program.slots.size)

    def _state(self, ports: PortEquations) -> Matrix:
        """Return bond variables by what is stored."""
        e = ports.equations
        n = self.scheme.program.nx
        if e.linear:
            x2 = e.x2[:, :n]
            state = x2 if e.project is None else e.project @ x2
            return e.storage.matrix.after(state)
        # constant rows: what storage gives by itself, put through them one quantity at a time
        v, nothing = self._zeros(), np.zeros(len(ports.ports))
        base = ports.solve(v, np.zeros(n), nothing)
        columns = [ports.solve(v, unit, nothing) - base for unit in np.eye(n)]
        return np.array(columns).reshape(n, len(base)).T

    def _prepared(self, ports: PortEquations, h: float) -> _Matrices:
        key = (id(ports), h)
        found = self._matrices.get(key)
        if found is None or found.ports is not ports:
            e = ports.equations
            n = self.scheme.program.nx
            state = self._state(ports)
            gain = ports.gains(self._zeros(), np.zeros(n))
            rates = e.storage.rates_of(state)
            inverse = np.asarray(np.linalg.inv(np.eye(n) - h * self.scheme.theta * rates))
            push = h * (inverse @ (e.storage.rates_of(gain)))
            coupling = couple(ports.partner, gain, push, state)
            doubt = ports.partner_size @ np.abs(state)
            found = _Matrices(ports, state, rates, inverse, coupling, doubt)
            self._matrices[key] = found
            if len(self._matrices) > KEPT:
                self._matrices.popitem(last=False)
        self._matrices.move_to_end(key)
        return found


def _constant(row: Dynamic) -> bool:
    """Whether a row reads nothing but bond variables, with coefficients that are numbers."""
    return (
        all(n.startswith(("e:", "f:")) for n in names(row.expression))
        and all(isinstance(slope, Number) for slope in row.slopes.values())
        and not bent(row.expression)
    )


def _outer(e: Expr) -> bool:
    """Whether a value depends on time and modes alone."""
    return all(n == "time" or n.startswith(_OUTER) for n in names(e))


def _affine(e: Expr) -> bool:
    """Whether a limit is affine in bond variables, with coefficients from outside."""
    if isinstance(e, Number):
        return True
    inner = [n for n in names(e) if not (n == "time" or n.startswith((*_OUTER, "e:", "f:")))]
    curved = bent(e) or any(reads_bonds(d) for d in gradient(e).values())
    return not inner and not curved
