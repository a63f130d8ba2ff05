"""`Program`: a flat graph made runnable, mode by mode, as modes are entered."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.causality.orientation import base_mode
from hybond.equations.elimination import CLEAR
from hybond.equations.mode import ModeEquations, prepare
from hybond.equations.ports import PortEquations, port_equations
from hybond.equations.slots import Slots, slots_of
from hybond.equations.storage import StorageLaws
from hybond.equations.tableau import Sheet, Tableau
from hybond.errors import NumericsError
from hybond.model.expressions import ARRAYS, Expr, compile_expression, names
from hybond.model.fieldless import fieldless_laws, reads_pre, switches_of
from hybond.model.graph import FlatGraph, Mode
from hybond.model.interval import Interval, discrete_names, discrete_values
from hybond.model.resolve import prior
from hybond.programs.linear import LinearForms
from hybond.uncollected import uncollected

Vector = NDArray[np.float64]
Field = Callable[[float, Vector], Vector]
KEPT = 512
"""Configurations kept; the least recently used is forgotten first."""

COMPILED = 10_000
"""Expressions kept compiled."""


@dataclass(frozen=True, slots=True)
class PowerMeter:
    """Where power enters and leaves: index pairs of bond variables and signs.

    `supplied` are source bonds (power out of the source), `dissipated` resistor ports.
    """

    supplied: tuple[NDArray[np.intp], NDArray[np.intp], Vector]
    dissipated: tuple[NDArray[np.intp], NDArray[np.intp], Vector]

    def read(self, w: Vector) -> tuple[float, float]:
        """Return power supplied and power dissipated, W."""
        e, f, sign = self.supplied
        supplied = float((w[e] * w[f]) @ sign)
        e, f, sign = self.dissipated
        return supplied, float((w[e] * w[f]) @ sign)


class Program:
    """The equations of a graph in the modes entered so far.

    The vector of values `v` has two copies of the slots of `equations.slots`: current values,
    then a priori values. A state vector `y` is stored quantities, integrated signals, energy
    supplied, energy dissipated.
    """

    @uncollected
    def __init__(self, graph: FlatGraph) -> None:
        self.graph = graph
        self.slots: Slots = slots_of(graph)
        self.nx = len(graph.storages)
        self.ns = len(graph.integrals)
        self.meter = _meter(graph)
        self.storage = StorageLaws.of(graph, self.slots)
        self._sheet = Sheet(graph)
        self._discrete = discrete_names(graph)
        self._equations: OrderedDict[tuple[object, ...], ModeEquations] = OrderedDict()
        self._ports: OrderedDict[tuple[object, ...], PortEquations] = OrderedDict()
        self.prior = [n for n in graph.nodes if reads_pre(n)]
        """Elements whose laws read a priori values."""
        self._compiled: dict[int, tuple[Expr, Callable[[Sequence[float]], float]]] = {}
        self._arrays: dict[int, tuple[Expr, Callable[[Sequence[Vector]], Vector]]] = {}
        self._rates = [self.compile(i.rate) for i in graph.integrals]
        self._flags: dict[Mode, list[float]] = {}
        self.refused: NumericsError | None = None
        """The last refusal of a law during a trial step."""
        self.landed: frozenset[int] = frozenset()
        """Machines that have landed: their pinnacle state is a mode with a field, its ``pre()``
        terms being zero."""
        self._vanishing: dict[Mode, tuple[int, ...]] = {}
        self.warnings: list[str] = []
        """What is to be said of the numbers in the modes so far."""
        self.built = 0
        self.evaluations = 0
        self.linear = LinearForms(self)

    @property
    def selective(self) -> bool:
        """Whether inputs or comparisons of time select equations as modes do."""
        return bool(self._discrete)

    def compile(self, e: Expr) -> Callable[[Sequence[float]], float]:
        """Return a closure of the values for a canonical expression, made once.

        Expressions are told apart by identity: to hash one takes longer than to read it.
        """
        known = self._compiled.get(id(e))
        if known is None:
            if len(self._compiled) >= COMPILED:
                self._compiled.clear()
            f = compile_expression(e, self.slots.index, pre_offset=self.slots.size)
            known = self._compiled[id(e)] = e, f
        return known[1]

    def equations(self, mode: Mode, interval: Interval, t: float) -> ModeEquations:
        """Return the equations of a mode, made the first time it is entered."""
        discrete = discrete_values(self.graph, self._discrete, interval, t)
        key = (mode, *discrete.values())
        found = self._equations.get(key)
        if found is None:
            tableau = self._sheet.build(mode, discrete)
            found = prepare(self.graph, mode, self.slots, tableau, self.storage)
            self._look_at(tableau, mode)
            self._equations[key] = found
            self.built += 1
            if len(self._equations) > KEPT:
                self._equations.popitem(last=False)
        self._equations.move_to_end(key)
        return found

    def _look_at(self, tableau: Tableau, mode: Mode) -> None:
        """Warn, once, of values so far apart that sums of them lose their digits."""
        least = min(tableau.power.least, tableau.finite.least)
        dropped = max(tableau.power.dropped, tableau.finite.dropped)
        if self.warnings or (least >= CLEAR and not dropped):
            return
        lost = f"{dropped:.0e} of its terms and counts as zero" if dropped else ""
        few = f"{least:.0e} of its terms and has few digits" if least < CLEAR else ""
        self.warnings.append(
            "elements lie too many powers of ten apart for the arithmetic: in mode "
            f"({self.graph.mode_text(mode)}) a coefficient is {lost or few}; leave out what is "
            "negligible, or check units"
        )

    def ports(self, mode: Mode, interval: Interval, t: float) -> PortEquations:
        """Return the equations of a mode with its junction laws open, made once."""
        discrete = discrete_values(self.graph, self._discrete, interval, t)
        mode = base_mode(self.graph, mode)
        key = (mode, *discrete.values())
        found = self._ports.get(key)
        if found is None:
            found = port_equations(
                self.graph, mode, self.slots, discrete, storage=self.storage, sheet=self._sheet
            )
            self._ports[key] = found
            self.built += 1
            if len(self._ports) > KEPT:
                self._ports.popitem(last=False)
        self._ports.move_to_end(key)
        return found

    def fieldless(self, mode: Mode) -> bool:
        """Whether an active law of `mode` reads ``pre()``, one of a landed machine left out."""
        return any(
            not any(s.machine in self.landed for s in switches_of(self.graph, node))
            for node in fieldless_laws(self.graph, mode, self.prior)
        )

    def vanishing(self, mode: Mode) -> tuple[int, ...]:
        """Return the slots that active laws of `mode` read by ``pre()``: zero at the limit."""
        found = self._vanishing.get(mode)
        if found is None:
            read = {
                self.slots.index[name]
                for node in fieldless_laws(self.graph, mode, self.prior)
                if node.law is not None
                for e in node.law.expressions
                for argument in prior(e)
                for name in names(argument)
            }
            found = self._vanishing[mode] = tuple(sorted(read))
        return found

    # -- values

    def values(self, t: float, interval: Interval, mode: Mode, x: Vector, s: Vector) -> list[float]:
        """Return `v` with all but bond variables filled; the a priori copy is zero."""
        v = [0.0] * (2 * self.slots.size)
        self.set_time(v, t, interval)
        self.set_mode(v, mode)
        v[self.slots.s] = s.tolist()
        v[self.slots.x] = x.tolist()
        return v

    def set_time(self, v: list[float], t: float, interval: Interval) -> None:
        """Write time, inputs and comparisons of time as seen inside `interval`."""
        v[0] = t
        if self.graph.inputs:
            pairs = list(zip(self.graph.inputs, interval.pieces, strict=True))
            v[self.slots.u] = [i.waveform.value(t, p) for i, p in pairs]
            v[self.slots.du] = [i.waveform.rate(t, p) for i, p in pairs]
        if interval.at:
            v[self.slots.at] = [float(a) for a in interval.at]

    def set_mode(self, v: list[float], mode: Mode) -> None:
        """Write the Booleans of a mode."""
        v[self.slots.on.start : self.slots.states.stop] = self.flags(mode)

    def flags(self, mode: Mode) -> list[float]:
        """Return the Booleans of a mode: what is ON, then the states of its machines."""
        flags = self._flags.get(mode)
        if flags is None:
            on = self.graph.on_nodes(mode)
            flags = [float(n.index in on) for n in self.graph.nodes if n.controlled]
            for m, k in zip(self.graph.machines, mode, strict=True):
                flags += [float(j == k) for j in range(len(m.states))]
            self._flags[mode] = flags
        return flags

    def rates(self, v: Sequence[float]) -> list[float]:
        """Return the rates of the integrated signals."""
        return [f(v) for f in self._rates]

    def field(self, equations: ModeEquations, interval: Interval) -> Field:
        """Return ``y' = field(t, y)`` of a configuration, y of shape (nx + ns + 2,)."""
        nx, ns = self.nx, self.ns
        v = self.values(0.0, interval, equations.mode, np.zeros(nx), np.zeros(ns))
        timed = bool(self.graph.inputs)
        rates_of = equations.storage.rates_of
        meter = self.meter

        def field(t: float, y: Vector) -> Vector:
            self.evaluations += 1
            x = y[:nx]
            if timed:
                self.set_time(v, t, interval)
            else:
                v[0] = t
            v[self.slots.s] = y[nx : nx + ns].tolist()
            v[self.slots.x] = x.tolist()
            try:
                w = equations.solve(v, x)
            except NumericsError as error:
                # a trial point beyond where the laws hold: the solver shortens its step, and if
                # that does not help the reason is this one
                self.refused = error
                return np.full(nx + ns + 2, np.nan)
            rate = np.empty(nx + ns + 2)
            rate[:nx] = rates_of(w)
            if ns:
                rate[nx : nx + ns] = self.rates(v)
            rate[nx + ns :] = meter.read(w)
            return rate

        return field

    def evaluate(
        self, t: float, y: Vector, interval: Interval, equations: ModeEquations
    ) -> list[float]:
        """Return all values at one instant of a motion, a priori copy equal to the current one.

        If time passes in a pinnacle's mode, a machine has landed: what its law reads is zero.
        """
        x, s = y[: self.nx], y[self.nx : self.nx + self.ns]
        v = self.values(t, interval, equations.mode, x, s)
        equations.solve(v, x)
        v[self.slots.size :] = v[: self.slots.size]
        for k in self.vanishing(equations.mode):
            v[self.slots.size + k] = 0.0
        return v

    def evaluate_many(
        self,
        t: Vector,
        y: Vector,
        interval: Interval | Sequence[Interval],
        equations: ModeEquations,
    ) -> Vector:
        """Return all values at many instants of one mode, shape (2 * slots, len(t)).

        `interval` is one for all, or one for each. Modes without laws to solve take one matrix
        product for all instants.
        """
        each = [interval] * len(t) if isinstance(interval, Interval) else list(interval)
        if not equations.linear:
            rows = [self.evaluate(a, b, i, equations) for a, b, i in zip(t, y, each, strict=True)]
            return np.array(rows).reshape(len(t), 2 * self.slots.size).T
        n = self.slots.size
        v = np.zeros((2 * n, len(t)))
        first = self.values(
            float(t[0]),
            each[0],
            equations.mode,
            y[0, : self.nx],
            y[0, self.nx : self.nx + self.ns],
        )
        v[:n] = np.array(first[:n])[:, None]
        v[0] = t
        times = t.tolist()
        for k, i in enumerate(self.graph.inputs):
            at = [(a, j.pieces[k]) for a, j in zip(times, each, strict=True)]
            v[self.slots.u.start + i.index] = [i.waveform.value(a, p) for a, p in at]
            v[self.slots.du.start + i.index] = [i.waveform.rate(a, p) for a, p in at]
        if each[0].at:
            v[self.slots.at] = np.array([j.at for j in each], dtype=float).T
        v[self.slots.x] = y[:, : self.nx].T
        v[self.slots.s] = y[:, self.nx : self.nx + self.ns].T
        nu = len(equations.tableau.sources)
        xi = np.zeros((self.nx + 2 * nu, len(t)))
        xi[: self.nx] = equations.storage.matrix.times(y[:, : self.nx].T)
        xi[self.nx : self.nx + nu] = equations.source_constants[:, None]
        columns = [v[k] for k in range(2 * n)]
        for k, law, _ in equations.storage.expressions:
            xi[k] = self.compile_arrays(law)(columns)
        needed = {k for k, _ in equations.source_values}
        moving = {k for k, _ in equations.rate_values}
        for k, source in enumerate(equations.tableau.sources):
            if k in needed:
                xi[self.nx + k] = self.compile_arrays(source.value)(columns)
            if k in moving:
                xi[self.nx + nu + k] = self.compile_arrays(source.rate)(columns)
        w = equations.finite.by_knowns(xi)
        if equations.project is not None:
            w = equations.project @ w
        v[self.slots.w] = w
        v[n:] = v[:n]
        v[[n + k for k in self.vanishing(equations.mode)]] = 0.0
        return v

    def compile_arrays(self, e: Expr) -> Callable[[Sequence[Vector]], Vector]:
        """Return a closure over arrays of values, made once."""
        known = self._arrays.get(id(e))
        if known is None:
            if len(self._arrays) >= COMPILED:
                self._arrays.clear()
            f: Callable[[Sequence[Vector]], Vector] = compile_expression(
                e, self.slots.index, ARRAYS, pre_offset=self.slots.size
            )
            known = self._arrays[id(e)] = e, f
        return known[1]


def _meter(graph: FlatGraph) -> PowerMeter:
    bonds = len(graph.bonds)

    def indices(
        kinds: tuple[str, ...], outward: bool
    ) -> tuple[NDArray[np.intp], NDArray[np.intp], Vector]:
        ends = [
            end
            for n in graph.nodes
            if n.kind in kinds
            for end in n.ends
            if not graph.bonds[end.bond].domain.pseudo
        ]
        e = np.array([end.bond for end in ends], dtype=np.intp)
        sign = np.array([float(-end.sign if outward else end.sign) for end in ends])
        return e, e + bonds, sign

    return PowerMeter(indices(("Se", "Sf"), True), indices(("R", "G"), False))
