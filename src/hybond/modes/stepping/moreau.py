"""One step of Moreau's time-stepping: the theta-scheme of Moreau and Jean for any bond graph.

The graph seen from its junction laws (`equations.ports`) is ``x' = f(x) + E l, w = y(x) + D l``.
From ``(t, x)`` a step of length ``h`` goes to::

    x+ = x + h (theta f(x+) + (1 - theta) f(x)) + h E l
    w+ = y(x+) + D l,     0 <= l  |  w+ + eps w >= 0

`theta` averages the smooth part only; what the laws ask for holds at the *end* of the step, so that
a capacitor that is charged through a diode never overshoots. ``h l`` is the percussion of the step:
a force that acts during it, an impulse, or both, which the scheme does not tell apart. That is why
it needs no event location and passes through accumulation points. `eps` is Newton's restitution; a
contact takes part only if it would close in the first half of the step, ``gap + h/2 gap' <= 0``.
Integrated signals follow the same formula as what is stored.

Where everything is linear the matrices are factorised once per mode of the machines and `h`;
elsewhere Newton's method (`newton_step`) solves the step with the laws inside (Josephy-Newton).

References
----------
J. J. Moreau, *Unilateral contact and dry friction in finite freedom dynamics*, CISM 302, 1988.
M. Jean, *The non-smooth contact dynamics method*, Comput. Methods Appl. Mech. Eng. 177, 1999.
V. Acary, B. Brogliato, *Numerical Methods for Nonsmooth Dynamical Systems*, Springer 2008.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.causality.orientation import base_mode
from hybond.equations.end_of_step import end_of_step_ports
from hybond.equations.ports import PortEquations
from hybond.errors import NumericsError
from hybond.model.expressions import Expr, Number
from hybond.model.graph import Mode
from hybond.model.interval import Interval, discrete_names, discrete_values
from hybond.modes.jump import enter
from hybond.modes.laws.friction import Linearised
from hybond.modes.laws.problem import CUT, ONE_SIDED, Answer, Friction
from hybond.modes.stepping.coupling import Coupling
from hybond.modes.stepping.laws import Laws, Together, read_laws
from hybond.modes.stepping.linear_step import KEPT, LinearSteps
from hybond.programs.program import Program

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Closure = Callable[[Sequence[float]], float]

REST = 1e-9
"""Part of the largest approach so far below which a contact counts as at rest."""


@dataclass(frozen=True, slots=True)
class Point:
    """Where a step begins or ends.

    Parameters
    ----------
    t : float
        s.
    y : array
        Stored quantities, integrated signals, energy supplied, energy dissipated.
    w : array, shape (2 * bonds,)
        Bond variables.
    mode : Mode
    """

    t: float
    y: Vector
    w: Vector
    mode: Mode


@dataclass(frozen=True, slots=True)
class Advance:
    """A step taken.

    Parameters
    ----------
    end : Point
    ports : PortEquations
    laws : Laws
        What the laws asked for.
    answer : Answer
    struck : array of bool, shape (ports,)
        Laws that were violated by what was stored: their percussion does not vanish with `h`.
    supplied : float
        Energy from sources, J.
    unbalanced : float
        Energy that came from nowhere, J; see `ThetaScheme._unbalanced`.
    ambiguous : tuple of str
        Laws whose variables would be others in a second solution.
    shared : tuple of str
        Laws that could share what they carry otherwise; least leakage decided.
    """

    end: Point
    ports: PortEquations
    laws: Laws
    answer: Answer
    struck: NDArray[np.bool_]
    supplied: float
    unbalanced: float = 0.0
    ambiguous: tuple[str, ...] = ()
    shared: tuple[str, ...] = ()


class ThetaScheme:
    """Takes steps for one program.

    Parameters
    ----------
    program : Program
    theta : float
        1/2 is of second order where nothing switches and keeps the energy of what vibrates;
        1 (implicit Euler) damps it, and never creates energy in a passive model.
    """

    def __init__(self, program: Program, theta: float) -> None:
        self.program = program
        self.theta = theta
        self._linear = LinearSteps(self)
        self.limits = Linearised(program)
        self._discrete = discrete_names(program.graph)
        self._ports: OrderedDict[tuple[object, ...], PortEquations] = OrderedDict()
        self._values: dict[Expr, Closure] = {}
        self.slopes: dict[int, tuple[PortEquations, tuple[Matrix, Matrix, Matrix, Matrix]]] = {}
        """Of nonlinear configurations, as last computed."""
        self._largest: dict[int, float] = {}

    def step(
        self, start: Point, interval: Interval, t1: float, *, h: float, energy: float
    ) -> Advance:
        """Return the step from `start` to the time `t1`, of length `h`.

        `h` is said apart, because the difference of two times is not twice the same: matrices are
        factorised once for each.

        Raises
        ------
        NumericsError
            HB-J120 if the laws have no solution, HB-N310 if Newton does not converge.
        """
        program = self.program
        nx, ns = program.nx, program.ns
        ports = self.ports(start.mode, interval, start.t)
        x, s = start.y[:nx], start.y[nx : nx + ns]
        v = program.values(start.t, interval, start.mode, x, s)
        v[program.slots.w] = start.w.tolist()
        v[program.slots.size :] = v[: program.slots.size]
        laws = read_laws(program.graph, ports, lambda e: self.value(e, v), start.w, start.mode)
        v[program.slots.size :] = [0.0] * program.slots.size
        if self._linear.take(ports):
            y, w, mean, laws, together = self._linear.step(
                start, interval, t1, h, ports, laws, v, energy
            )
        else:
            from hybond.modes.stepping.newton_step import newton_step

            y, w, mean, laws, together = newton_step(
                self, start, interval, t1, h, ports, laws, v, energy
            )
        answer = together.answer
        struck = self._struck(laws, answer)
        # what bounces off is open again
        branch = np.where(struck & (laws.restitution > 0.0), 0, answer.branch).astype(np.int8)
        supplied, dissipated = program.meter.read(mean)
        end = np.concatenate([y, start.y[nx + ns :] + h * np.array([supplied, dissipated])])
        return Advance(
            Point(t1, end, _with_sources(program, ports, w, answer), laws.mode(branch)),
            ports,
            laws,
            answer,
            struck,
            h * supplied,
            self._unbalanced(ports, x, y[:nx], answer.l, mean, h * (supplied - dissipated), h),
            tuple(ports.ports[k].path for k in together.ambiguous),
            tuple(ports.ports[k].path for k in together.shared),
        )

    def _unbalanced(
        self,
        ports: PortEquations,
        x: Vector,
        x1: Vector,
        l: Vector,
        mean: Vector,
        passed: float,
        h: float,
    ) -> float:
        """Return what a step has stored beyond what sources, resistors and laws gave it, J.

        The mean bond variables of a step obey the junction structure, so that with the co-energy
        variables at the same mean, ``theta z(x+) + (1 - theta) z(x)``, the scheme balances exactly:
        what was stored by them is what sources gave and resistors took by them, and the laws' work
        ``h l w``. (The energy itself moves by that less ``(theta - 1/2) dx' K dx``, the damping of
        the scheme, for linear storage.) What constraints on storage take away is a loss.
        """
        storage = ports.equations.storage
        z = self.theta * storage.co_energy(x1) + (1.0 - self.theta) * storage.co_energy(x)
        stored = float(np.where(storage.pseudo, 0.0, z) @ (x1 - x))
        true = [not self.program.graph.nodes[p.law.node].domain.pseudo for p in ports.ports]
        worked = h * float((l * (ports.partner @ mean))[true].sum())
        return stored - passed - worked

    def ports(self, mode: Mode, interval: Interval, t: float) -> PortEquations:
        """Return the equations of a mode with its junction laws open, made once."""
        graph = self.program.graph
        discrete = discrete_values(graph, self._discrete, interval, t)
        key = (base_mode(graph, mode), *discrete.values())
        found = self._ports.get(key)
        if found is None:
            found = self._ports[key] = end_of_step_ports(graph, mode, self.program.slots, discrete)
            self.program.built += 1
            if len(self._ports) > KEPT:
                self._ports.popitem(last=False)
        self._ports.move_to_end(key)
        return found

    def value(self, e: Expr, v: Sequence[float]) -> float:
        """Return the value of an expression at the values `v`."""
        if isinstance(e, Number):
            return e.value
        if e not in self._values:
            self._values[e] = self.program.compile(e)
        return float(self._values[e](v))

    def _struck(self, laws: Laws, answer: Answer) -> NDArray[np.bool_]:
        found = np.zeros(len(laws.w), dtype=bool)
        for k, (m, w) in enumerate(zip(laws.machines, laws.w.tolist(), strict=True)):
            largest = self._largest[m.index] = max(self._largest.get(m.index, 0.0), abs(w))
            found[k] = laws.roles[k] == ONE_SIDED and answer.l[k] > 0.0 and w < -REST * largest
        return found

    # -- shared by linear and nonlinear steps

    def constrained(
        self, ports: PortEquations, v: list[float], x: Vector, mode: Mode, energy: float
    ) -> Vector:
        """Return the state put on the constraints that hold whatever the laws do."""
        e = ports.equations
        if not e.tableau.constraints and not e.structure and not e.tableau.agreements:
            return x
        slots = self.program.slots
        v[slots.x] = x.tolist()
        if e.structure:
            ports.solve(v, x, np.zeros(len(ports.ports)))
        where = self.program.graph.mode_text(mode)
        return enter(e, v, x, where=where, energy=energy).x

    def solve(
        self,
        ports: PortEquations,
        laws: Laws,
        v: list[float],
        bonds: Vector,
        coupling: Coupling,
        mode: Mode,
        t: float,
        *,
        doubt: Vector | float = 0.0,
    ) -> Together:
        """Return what the laws do if bond variables are ``bonds + coupling.gain @ l``.

        `v` holds the values at which limits of friction are linearised. What `w` has below `doubt`
        without `l` is rounding.
        """
        q = ports.partner @ bonds
        q = np.where(np.abs(q) <= doubt, 0.0, q)

        def limit(e: Expr) -> Friction:
            return self.limits.at(e, v, bonds, coupling.gain)

        leaks = None
        if coupling.still.shape[1]:
            rows = self._leaking(ports)
            leaks = rows @ bonds, rows @ coupling.gain
        together = laws.solve(coupling, q, limit, leaks)
        if together is not None:
            return together
        part = zip(ports.ports, laws.roles, strict=True)
        taking = ", ".join(p.path for p, r in part if r != CUT)
        raise NumericsError(
            f"the laws of {taking} have no solution in the step that ends at t = {t:.9g} s",
            code="HB-J120",
            where=self.program.graph.mode_text(mode),
            hint="friction of a rigid contact may leave none (Painleve), and so do sources that "
            "push each other through diodes: give the contact a stiffness, a source a resistance",
        )

    def _leaking(self, ports: PortEquations) -> Matrix:
        """Return what flows through, or is held by, the junctions that machines switch."""
        graph = self.program.graph
        own = {p.law.node for p in ports.ports}
        switched = [n.index for n in graph.nodes if n.controlled and n.is_junction and n.ends]
        return ports.equations.junctions[[k not in own for k in switched]]


def _with_sources(program: Program, ports: PortEquations, w: Vector, answer: Answer) -> Vector:
    """Return bond variables with the forces of what slides on the bonds made for them.

    A port's own equations leave out the source that its law brought in (`junction_laws`).
    """
    bonds = len(program.graph.bonds)
    found = w
    for k, port in enumerate(ports.ports):
        if port.law.source is None or not answer.branch[k]:
            continue
        if found is w:
            found = w.copy()
        net = -float(ports.partner[k] @ w if port.given == "common" else answer.l[k])
        end = program.graph.nodes[port.law.source].ends[0]
        at = end.bond + (bonds if program.graph.nodes[port.law.node].kind == "0" else 0)
        found[at] = float(end.sign) * net
    return found
