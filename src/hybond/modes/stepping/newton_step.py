"""A step of `moreau` where something is nonlinear: Newton's method with the laws inside.

Unknown are the end of the step, ``Y = (x, s)``, and `l`. Written for laws that need not be affine
in `l` (a diode in series with a nonlinear resistor), with ``r`` the rates of stored quantities and
integrated signals::

    Y - Y0 - h [ r(Y, l) - (1 - theta) (r(Y, 0) - r(Y0, 0)) ] = 0

Each iteration linearises this and ``w(Y, l)``, eliminates Y, and solves the laws for the whole new
`l` (Josephy-Newton). Derivatives are difference quotients, renewed when convergence is slow.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hybond.equations.ports import PortEquations
from hybond.errors import NumericsError
from hybond.model.interval import Interval
from hybond.modes.jump import reach_of
from hybond.modes.laws.problem import Answer
from hybond.modes.stepping.coupling import couple
from hybond.modes.stepping.laws import Laws, Together, closed_half_way

if TYPE_CHECKING:
    from hybond.modes.stepping.moreau import Point, ThetaScheme

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

STEPS = 40
"""Iterations of one step."""
SLOW = 0.2
"""An update that is not reduced to this part asks for new derivatives."""
TOLERANCE = 1e-11
"""Newton ends when an update is below this part of what is updated."""
DUST = 1e-3
"""Part of the largest bond variable of its kind down to which the digits of `l` count."""
NEAR = 1e-7
"""Difference quotients: part of a variable's size."""


class _Rates:
    """``r(Y, l)`` and bond variables, at the end of one step."""

    def __init__(self, scheme: ThetaScheme, ports: PortEquations, v: list[float], h: float) -> None:
        self.program = scheme.program
        self.theta = scheme.theta
        self.ports = ports
        self.v = v
        self.h = h

    def at(self, y: Vector, l: Vector) -> tuple[Vector, Vector]:
        """Return rates and bond variables; write the values."""
        program, slots = self.program, self.program.slots
        x = y[: program.nx]
        self.v[slots.x] = x.tolist()
        self.v[slots.s] = y[program.nx :].tolist()
        w = self.ports.solve(self.v, x, l)
        slow = program.rates(self.v)
        return np.concatenate([self.ports.equations.storage.rates_of(w), slow]), w

    def implicit(self, y: Vector, l: Vector) -> tuple[Vector, Vector, Vector]:
        """Return what the end adds to a step over `h`, and bond variables without and with `l`."""
        smooth, without = self.at(y, np.zeros(len(l)))
        if not l.any():
            return self.theta * smooth, without, without
        whole, w = self.at(y, l)
        return whole - (1.0 - self.theta) * smooth, without, w

    def slopes(
        self, y: Vector, l: Vector, size: Vector, unit: Vector
    ) -> tuple[Matrix, Matrix, Matrix, Matrix]:
        """Return the derivatives of the implicit rates and of bond variables, by Y and by l."""
        base, _, w = self.implicit(y, l)
        by_y, w_by_y, by_l, w_by_l = [], [], [], []
        for j in range(len(y)):
            ahead = y.copy()
            ahead[j] += NEAR * size[j]
            step = ahead[j] - y[j]
            rate, _, bonds = self.implicit(ahead, l)
            by_y.append((rate - base) / step)
            w_by_y.append((bonds - w) / step)
        for j in range(len(l)):
            more = l.copy()
            more[j] += NEAR * 1e3 * unit[j]
            step = more[j] - l[j]
            rate, _, bonds = self.implicit(y, more)
            by_l.append((rate - base) / step)
            w_by_l.append((bonds - w) / step)
        n, bonds_ = len(base), len(w)
        return (
            np.array(by_y).reshape(len(y), n).T,
            np.array(w_by_y).reshape(len(y), bonds_).T,
            np.array(by_l).reshape(len(l), n).T,
            np.array(w_by_l).reshape(len(l), bonds_).T,
        )


def newton_step(
    scheme: ThetaScheme,
    start: Point,
    interval: Interval,
    t1: float,
    h: float,
    ports: PortEquations,
    laws: Laws,
    v: list[float],
    energy: float,
) -> tuple[Vector, Vector, Vector, Laws, Together]:
    """Return the end state, its bond variables, their mean, the laws that took part, their answer.

    Raises
    ------
    NumericsError
        HB-N310 if Newton does not converge, HB-J120 if the laws have no solution.
    """
    program = scheme.program
    nx, ns, n = program.nx, program.ns, len(ports.ports)
    y0 = start.y[: nx + ns]
    begin, before = _Rates(scheme, ports, v, h).at(y0, np.zeros(n))
    v1 = program.values(t1, interval, start.mode, y0[:nx], y0[nx:])
    end = _Rates(scheme, ports, v1, h)
    size = _size(scheme, ports, y0, begin, h, energy)
    unit = np.array([_unit(scheme, ports, k, start.w) for k in range(n)])
    explicit = y0 + h * (1.0 - scheme.theta) * begin
    y, l = y0 + 0.0, np.zeros(n)
    together = Together(Answer(l, laws.guess, np.zeros(n, dtype=bool)), [], [])
    # the slopes of the step before are good enough to begin with
    known = scheme.slopes.get(id(ports))
    slopes = known[1] if known is not None and known[0] is ports else None
    last = np.inf
    projected = False
    for k in range(STEPS):
        if slopes is None:
            slopes = end.slopes(y, l, size, unit)
            scheme.slopes[id(ports)] = ports, slopes
        by_y, w_by_y, by_l, w_by_l = slopes
        inverse = np.linalg.inv(np.eye(nx + ns) - h * by_y)
        implicit, _, w = end.implicit(y, l)
        move = inverse @ (explicit + h * implicit - y)
        if projected:
            move = 0.0 * move
        push = h * (inverse @ by_l)
        coupling = couple(ports.partner, w_by_l, push, w_by_y)
        base = w + w_by_y @ move - coupling.gain @ l
        if k == 0:
            laws = closed_half_way(laws, h, ports.partner @ base)
        end.at(y, l)
        together = scheme.solve(ports, laws, v1, base, coupling, start.mode, t1)
        answer, gain = together.answer, coupling.gain
        change = move + push @ (answer.l - l)
        update = float((np.abs(change) / size).max(initial=0.0))
        # where nothing acts on a bond but the rounding of other laws, that is all it has
        acting = np.abs(answer.l) + DUST * unit
        scale = np.abs(gain) @ acting + np.abs(w) + np.abs(base)
        rest = np.abs(gain @ (answer.l - l)) / np.where(scale > 0.0, scale, 1.0)
        update = max(update, 1e-2 * float(rest.max(initial=0.0)))
        y, l = y + change, answer.l
        if projected or update <= TOLERANCE:
            x = scheme.constrained(ports, v1, y[:nx], start.mode, energy)
            if projected or np.array_equal(x, y[:nx]):
                break
            # back on the constraints; the laws once more, from there
            y, projected, slopes = np.concatenate([x, y[nx:]]), True, None
            continue
        if update > SLOW * last:
            slopes = None
        last = update
    else:
        raise NumericsError(
            f"the step that ends at t = {t1:.9g} s does not converge",
            code="HB-N310",
            where=program.graph.mode_text(start.mode),
            hint="take a smaller step; a law with a jump of its own belongs into a machine",
        )
    _, after, w = end.implicit(y, l)
    mean = w - (1.0 - scheme.theta) * (after - before)
    return y, w, mean, laws, together


def _size(
    scheme: ThetaScheme, ports: PortEquations, y: Vector, rates: Vector, h: float, energy: float
) -> Vector:
    """Return what each unknown is measured by: itself, its motion, what the energy would make."""
    nx = scheme.program.nx
    size = np.abs(y) + h * np.abs(rates)
    size[:nx] = np.maximum(size[:nx], reach_of(ports.equations.storage, y[:nx], energy))
    size[:nx] = np.maximum(size[:nx], 1e-3 * size[:nx].max(initial=0.0))
    return np.where(size > 0.0, size, 1.0 if not size.any() else 1e-3 * float(size.max()))


def _unit(scheme: ThetaScheme, ports: PortEquations, k: int, w: Vector) -> float:
    """Return a size of `l`: that of the bond variables of its kind."""
    bonds = len(scheme.program.graph.bonds)
    node = scheme.program.graph.nodes[ports.ports[k].law.node]
    effort = (node.kind == "0") == (ports.ports[k].given == "common")
    largest = float(np.abs(w[:bonds] if effort else w[bonds:]).max(initial=0.0))
    return largest if largest > 0.0 else 1.0
