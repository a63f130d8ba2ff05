"""A graph with the laws of its junctions left open: linear complementarity from a bond graph.

Each junction with a law (ideal diode, contact, dry friction) is a *port*. One variable of its
conjugate pair is given from outside, the other follows from the graph::

    x' = f(x, u) + E l,     w = y(x, u) + D l,     one-sided laws: 0 <= l, w >= 0, l w = 0

``l`` and ``w`` are the common variable and minus the net variable, or the other way round; ``l w``
is the power that the graph takes from the law, so for a passive graph `D` is positive
semi-definite, and so is ``C E`` on the ports without direct feedthrough. Which of the two is given
is chosen so that as much storage as possible is in integral causality: then no constraint on what
is stored contains `l`, and an impulse of `l` is a jump of the state by ``E`` times its area.

This is the (mixed) linear complementarity system of Heemels, Schumacher and Weiland (2000), made
by the same rows as the equations of every mode; for a nonlinear graph it is its linearisation.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.causality.orientation import Given, base_mode, orientation
from hybond.equations.calculus import gradient
from hybond.equations.mode import ModeEquations, prepare
from hybond.equations.slots import Slots
from hybond.equations.storage import StorageLaws
from hybond.equations.tableau import Sheet
from hybond.errors import CausalityError
from hybond.model.expressions import Number, compile_expression
from hybond.model.graph import FlatGraph, Mode
from hybond.model.laws import JunctionLaw

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]
Closure = Callable[[Sequence[float]], float]

CANCELLATION = 1e-13
"""A sum below this part of its terms is zero: a law without effect must be told from a weak one."""


@dataclass(frozen=True, slots=True)
class Port:
    """A junction whose law is left open.

    Parameters
    ----------
    machine : int
        Its machine.
    law : JunctionLaw
    given : {"common", "net"}
        What `l` is: the common variable, or minus the net variable.
    path : str
    """

    machine: int
    law: JunctionLaw
    given: Given
    path: str


@dataclass(slots=True)
class Response:
    """The graph seen from its ports at one state, linearised.

    Parameters
    ----------
    bonds : array, shape (2 * bonds,)
        Bond variables with ``l = 0``.
    gain : array, shape (2 * bonds, n)
        Their derivative by `l`.
    y, size : array, shape (n,)
        `w` at ``l = 0``, and the size of the terms that made it.
    D, E, CE : arrays, shape (n, n), (storages, n), (n, n)
    rate : array, shape (n,)
        The rate of `y` along the motion with ``l = 0``.
    """

    bonds: Vector
    gain: Matrix
    y: Vector
    size: Vector
    D: Matrix
    E: Matrix
    CE: Matrix
    rate: Vector


@dataclass(slots=True)
class PortEquations:
    """The equations of a configuration with its junction laws open; made by `port_equations`."""

    equations: ModeEquations
    ports: tuple[Port, ...]
    columns: NDArray[np.intp]
    """Of each port among the sources of `equations`."""
    sign: Vector
    """What the given variable is times `l`: 1 for a common variable, -1 for a net one."""
    partner: Matrix
    """``w = partner @ bond variables``, shape (ports, 2 * bonds)."""
    partner_size: Matrix
    """The magnitudes of `partner`."""
    source_rates: list[tuple[int, Closure]]
    constant: _Constant | None = None

    @property
    def linear(self) -> bool:
        """Whether the response is the same at every state."""
        return self.equations.linear and self.equations.storage.linear

    def solve(self, v: list[float], x: Vector, given: Vector) -> Vector:
        """Return the bond variables with the ports' `l` given; write them into `v`."""
        constants = self.equations.source_constants
        constants[self.columns] = self.sign * given
        try:
            return self.equations.solve(v, x)
        finally:
            constants[self.columns] = 0.0

    def gains(self, v: list[float], x: Vector, at: Vector | None = None) -> Matrix:
        """Return the derivative of the bond variables by `l`, shape (2 * bonds, ports)."""
        e = self.equations
        if e.linear:
            gain = e.finite.columns(len(e.graph.storages) + self.columns) * self.sign
            return np.asarray(gain if e.project is None else e.project @ gain)
        # modulated two-ports and controlled sources are affine in what ports give, so that a
        # difference over a unit step is exact; through nonlinear resistors it is a chord
        base = np.zeros(len(self.ports)) if at is None else at
        kept = list(v)
        zero = self.solve(v, x, base)
        columns = []
        for k in range(len(self.ports)):
            ahead = base.copy()
            ahead[k] += 1.0
            columns.append(self.solve(v, x, ahead) - zero)
        v[:] = kept
        return np.array(columns).reshape(len(self.ports), len(zero)).T

    def response(
        self,
        v: list[float],
        x: Vector,
        *,
        later: Callable[[float, Vector], list[float]] | None = None,
        step: float = 1e-7,
    ) -> Response:
        """Return the response at the values `v` and the stored state `x`.

        Parameters
        ----------
        v : list of float
            Values but for bond variables, which are written.
        x : array, shape (storages,)
        later : callable
            ``later(dt, y')``: the values `v` a time `dt` later, stored quantities having moved at
            the rates `y'`; needed for the rate of `y` in a nonlinear graph.
        step : float
            That time, s.
        """
        e = self.equations
        nothing = np.zeros(len(self.ports))
        bonds = self.solve(v, x, nothing)
        y = self.partner @ bonds
        size = e.finite.sizes(e.knowns(v, x)) + np.abs(bonds)
        storage = e.storage
        field = storage.rates_of(bonds)
        if self.linear:
            if self.constant is None:
                self.constant = self._constant(v, x)
            known = self.constant
            push = np.zeros(known.through.shape[1])
            for j, f in self.source_rates:
                push[j] = f(v)
            rate = known.seen @ field + known.through @ push
            gain, d, inward, coupled = known.gain, known.D, known.E, known.CE
        else:
            gain = self.gains(v, x)
            inward = storage.rates_of(gain)
            d = _product(self.partner, gain)
            coupled = self._directional(v, x, inward, y)
            rate = self._ahead(later, x, field, y, step) if later is not None else 0.0 * y
        return Response(
            bonds, gain, y, self.partner_size @ size, d, inward, coupled, np.asarray(rate)
        )

    def _constant(self, v: list[float], x: Vector) -> _Constant:
        """Return what is the same at every state of a linear graph."""
        e = self.equations
        gain = self.gains(v, x)
        nz, nu = len(e.graph.storages), len(e.tableau.sources)
        shown = self.partner if e.project is None else e.project.after(self.partner)
        by_knowns = e.finite.after(shown)
        seen = e.storage.matrix.after(by_knowns[:, :nz])
        inward = e.storage.rates_of(gain)
        return _Constant(
            gain,
            _product(self.partner, gain),
            inward,
            _product(seen, inward),
            seen,
            by_knowns[:, nz : nz + nu],
        )

    def _directional(self, v: list[float], x: Vector, inward: Matrix, y: Vector) -> Matrix:
        """Return how `y` moves along the columns of `inward`, by differences."""
        reach = max(float(np.abs(x).max(initial=0.0)), 1e-6)
        slots = self.equations.slots
        nothing = np.zeros(len(self.ports))
        columns = []
        kept = list(v)
        for d in inward.T:
            largest = float(np.abs(d).max(initial=0.0))
            if largest == 0.0:
                columns.append(np.zeros(len(y)))
                continue
            h = 1e-6 * reach / largest
            moved = x + h * d
            back = x - h * d
            v[slots.x] = moved.tolist()
            ahead = self.partner @ self.solve(v, moved, nothing)
            v[slots.x] = back.tolist()
            columns.append((ahead - self.partner @ self.solve(v, back, nothing)) / (2.0 * h))
        v[:] = kept
        return np.array(columns).reshape(len(columns), len(y)).T

    def _ahead(
        self,
        later: Callable[[float, Vector], list[float]],
        x: Vector,
        field: Vector,
        y: Vector,
        step: float,
    ) -> Vector:
        moved = x + step * field
        v = later(step, field)
        return (self.partner @ self.solve(v, moved, np.zeros(len(self.ports))) - y) / step


@dataclass(frozen=True, slots=True)
class _Constant:
    """The response of a linear graph: as in `Response`, and what `y` sees of state and sources."""

    gain: Matrix
    D: Matrix
    E: Matrix
    CE: Matrix
    seen: Matrix
    through: Matrix


def _product(a: Matrix, b: Matrix) -> Matrix:
    """Return ``a @ b`` with what is nothing but cancellation as zero."""
    c = a @ b
    return np.where(np.abs(c) <= CANCELLATION * (np.abs(a) @ np.abs(b)), 0.0, c)


def law_machines(graph: FlatGraph) -> tuple[int, ...]:
    """Return the machines that stand for laws of junctions."""
    return tuple(m.index for m in graph.machines if m.law is not None)


def port_equations(
    graph: FlatGraph,
    mode: Mode,
    slots: Slots,
    discrete: Mapping[str, float],
    given: dict[int, Given] | None = None,
    storage: StorageLaws | None = None,
    sheet: Sheet | None = None,
) -> PortEquations:
    """Return the equations of a configuration with all junction laws open.

    `given` says which variable of each law's pair comes from outside, if not `orientation`;
    `storage` are the laws of storage, and `sheet` makes tableaus, if they are known.

    Raises
    ------
    CausalityError
        HB-C104 if a law stays tied to a constraint on what is stored, whichever of its variables
        is given.
    """
    mode = base_mode(graph, mode)
    given = orientation(graph, mode) if given is None else given
    owners = {law.node: (m, law) for m in graph.machines if m.law for law in m.law.junctions}
    seen: set[tuple[Given, ...]] = set()
    sheet = sheet or Sheet(graph)
    while True:
        tableau = sheet.build(mode, discrete, given)
        nodes = list(given)
        first = len(tableau.sources) - len(nodes)
        own = {tableau.unknowns + tableau.storages + first + k: n for k, n in enumerate(nodes)}
        tied = [
            next(own[k] for k in sorted(row) if k in own)
            for row in (*tableau.constraints, *tableau.agreements)
            if not own.keys().isdisjoint(row)
        ]
        if not tied:
            break
        # causality counts variables; around a loop without a reference potential they depend on
        # one another by value. Giving the other variable of one of them unties the row.
        seen.add(tuple(given.values()))
        given = {n: _other(g) if n in tied else g for n, g in given.items()}
        if tuple(given.values()) in seen:
            raise CausalityError(
                f"the law of {graph.nodes[tied[0]].path} is tied to a constraint that holds in "
                "every mode",
                code="HB-C104",
                where=graph.mode_text(mode),
                hint="two sources or switches leave nothing for the law to decide: look at what "
                "stands in parallel or in series with it",
            )
    equations = prepare(graph, mode, slots, tableau, storage)
    bonds = len(graph.bonds)
    ports = tuple(
        Port(owners[n][0].index, owners[n][1], given[n], graph.nodes[n].path) for n in nodes
    )
    partner = np.zeros((len(ports), 2 * bonds))
    for row, port in zip(partner, ports, strict=True):
        common = port.given == "common"
        for name, slope in gradient(port.law.net if common else port.law.common).items():
            assert isinstance(slope, Number)
            kind, _, index = name.partition(":")
            row[int(index) + (bonds if kind == "f" else 0)] = slope.value * (-1 if common else 1)
    rates = [
        (k, compile_expression(s.rate, slots.index, pre_offset=slots.size))
        for k, s in enumerate(tableau.sources)
        if s.rate != Number(0.0)
    ]
    return PortEquations(
        equations,
        ports,
        np.arange(first, len(tableau.sources)),
        np.array([1.0 if p.given == "common" else -1.0 for p in ports]),
        partner,
        np.abs(partner),
        rates,
    )


def _other(given: Given) -> Given:
    return "net" if given == "common" else "common"
