"""The rows of a graph whose sensors are known: what a diagnosis can start from.

Beside the rows of elements and junctions there are those of storage with the time derivative as a
factor, ``rate = D x`` (derivative causality: nothing has to be integrated, no start value known),
and one row per sensor, ``signal = y``. Columns are bond variables, stored quantities, what
sources give, sensors and switch variables; coefficients are rational functions of parameters and
polynomials in ``D``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from hybond.analysis.residuals.relations import evaluate, residue
from hybond.equations.element_parts import parameter_values
from hybond.equations.element_rows import Assembly, Column, laws_of
from hybond.equations.ring import Row, Symbols
from hybond.equations.symbolic.rational import Rational
from hybond.errors import EquationError, UsageError
from hybond.model.expressions import (
    Expr,
    Number,
    differentiate,
    names,
    posterior_names,
    prior_names,
    simplify,
    substitute,
)
from hybond.model.graph import FlatGraph
from hybond.names import did_you_mean

D = "d/dt"
"""The atom that stands for the time derivative in coefficients."""

SENSOR, LAW, BALANCE, MONITORED = 0, 1, 2, 3
"""What a row is used for first: the balance of a junction with a sensor is a residual last of all
used to find something, as the sensor imposes the junction's common variable."""

ROOTS = ("e:", "f:", "x:", "s:")
"""Variables of a signal; what else it reads has to be known."""


@dataclass(frozen=True, slots=True)
class Known:
    """A column of what a diagnosis knows."""

    name: str
    """A sensor as the model calls it, or the source."""
    kind: Literal["sensor", "source"]
    formula: Expr
    """In canonical names: what the sensor measures, what the source gives."""
    node: int = -1
    """The source; -1 for a sensor."""

    @property
    def constant(self) -> bool:
        """Whether it is a source that never changes."""
        return self.kind == "source" and all(n.startswith("p:") for n in names(self.formula))


@dataclass(slots=True)
class SensorRows:
    """All rows of a graph with sensors."""

    graph: FlatGraph
    ring: Symbols
    rows: list[Row[Rational]] = field(default_factory=list)
    """Each sums to zero in every mode."""
    kinds: list[int] = field(default_factory=list)
    """`SENSOR`, `LAW`, `BALANCE` or `MONITORED`, per row."""
    owners: list[int] = field(default_factory=list)
    """The node that each row comes from; -1 for sensors."""
    known: dict[int, Known] = field(default_factory=dict)
    """Columns that are known."""
    switches: dict[int, tuple[int, ...]] = field(default_factory=dict)
    """Switch column to the machines that decide about it."""
    closing: dict[tuple[int, tuple[object, ...]], Row[Rational] | None] = field(
        default_factory=dict
    )
    """Switch column and key of the machines' states to the row that closes it; None if no law can
    be used there."""
    storages: dict[int, int] = field(default_factory=dict)
    """Storage to the column of its stored quantity."""
    unused: dict[int, str] = field(default_factory=dict)
    """Node to the reason why its law is not used."""
    monitored: set[int] = field(default_factory=set)
    """Junctions whose common variable a sensor gives."""
    _assembly: Assembly[Rational] | None = None
    _values: dict[str, int] = field(default_factory=dict)
    _seen: int = -1

    def key(self, switch: int, states: tuple[int, ...]) -> tuple[object, ...]:
        """Return what distinguishes the closing rows of a switch variable."""
        assert self._assembly is not None
        return self._assembly.out.closing[switch].key(states)

    def vanishes(self, c: Rational) -> bool:
        """Whether a coefficient without derivative is exactly zero at the model's values."""
        size = len(self.ring.meaning)
        if size != self._seen:
            known = self.ring.known({})
            self._seen, self._values = size, {k: residue(v) for k, v in known.items() if v == v}
        try:
            return evaluate(c, self._values) == 0
        except KeyError:
            return False

    def column(self, k: int) -> Column | None:
        """Return what a column of the assembly is; None for bond variables and our own."""
        assert self._assembly is not None
        out = self._assembly.out
        return out.columns[k - out.unknowns] if k >= out.unknowns else None


def sensor_rows(graph: FlatGraph, sensors: Sequence[str]) -> SensorRows:
    """Write the rows of `graph` with the signals `sensors` known.

    Raises
    ------
    UsageError
        HB-A301 for a sensor that is no signal of the model, or no sensor at all.
    EquationError
        HB-A302 for a signal that is not linear in efforts, flows and stored quantities.
    """
    if not sensors:
        raise UsageError(
            "no sensors: without them nothing can be compared with the model",
            code="HB-A301",
            where="sensors",
            hint="name signals that are measured, such as sensors=['node.e', 'motor.f']",
        )
    return _Writing(graph, sensors).found


class _Writing:
    def __init__(self, graph: FlatGraph, sensors: Sequence[str]) -> None:
        self.graph = graph
        self.ring = ring = Symbols(parameter_values(graph))
        on = frozenset(n.index for n in graph.nodes if n.controlled)
        self.assembly = Assembly(graph, ring, on, symbolic=True)
        self.out = self.assembly.out
        self.found = SensorRows(graph, ring, _assembly=self.assembly)
        self.next = -1
        self.integrals: dict[int, int] = {}
        self.stored: dict[int, int] = {}
        self.D = Rational.atom(D)

        for s in graph.storages:
            self.stored[s.index] = self.found.storages[s.index] = self._own()
        formulas = [(name, self._signal(name)) for name in dict.fromkeys(sensors)]
        for name, e in formulas:
            self._sensor(name, e)
        self._structure()
        self._storage()
        self._closings()
        self._sources(len(self.graph.bonds) * 2)
        self._names()

    def _own(self) -> int:
        self.next -= 1
        return self.next + 1

    def _add(self, row: Row[Rational], kind: int, owner: int) -> None:
        self.found.rows.append(row)
        self.found.kinds.append(kind)
        self.found.owners.append(owner)

    # -- sensors

    def _signal(self, name: str) -> Expr:
        try:
            return self.graph.signal(name)
        except Exception as error:
            raise UsageError(
                f"the sensor {name!r} is no signal of the model",
                code="HB-A301",
                where="sensors",
                hint=did_you_mean(name, list(self.graph.signals)) or str(error),
            ) from None

    def _sensor(self, name: str, e: Expr) -> None:
        split = self._split(e)
        if split is None:
            raise EquationError(
                f"the sensor {name!r} is not linear in efforts, flows and stored quantities",
                code="HB-A302",
                where="sensors",
                hint="take the efforts and flows that it is made of as sensors",
            )
        row, rest = split
        own = self._own()
        self.found.known[own] = Known(name, "sensor", e)
        row = {**row, own: self.ring.of(-1.0)}
        if rest != Number(0.0):
            row[self._given(rest, -1, name)] = self.ring.one
        self._add(row, SENSOR, -1)
        roots = [n for n in posterior_names(e) if n.startswith(ROOTS)]
        if len(roots) == 1:
            self._monitor(roots[0])

    def _monitor(self, name: str) -> None:
        """Note the junctions whose common variable `name` is."""
        kind, _, index = name.partition(":")
        if kind == "x":
            # what is stored gives the co-energy variable
            s = self.graph.storages[int(index)]
            kind, index = ("e" if s.kind == "C" else "f"), str(s.bond)
        if kind not in ("e", "f"):
            return
        bond = self.graph.bonds[int(index)]
        for at in (bond.tail, bond.head):
            if self.graph.nodes[at].kind == ("0" if kind == "e" else "1"):
                self.found.monitored.add(at)

    def _split(self, e: Expr) -> tuple[Row[Rational], Expr] | None:
        """Return coefficients by column and the rest, if `e` is affine in unknown variables."""
        if prior_names(e):
            return None
        roots = sorted(n for n in posterior_names(e) if n.startswith(ROOTS))
        row: Row[Rational] = {}
        for name in roots:
            slope = differentiate(e, name)
            if not all(n.startswith("p:") for n in names(slope)):
                return None
            if slope != Number(0.0):
                row[self._variable(name)] = self.ring.read(slope)
        rest = simplify(substitute(e, {n: Number(0.0) for n in roots})) if roots else e
        if any(n.startswith(("in:", "on:")) for n in names(rest)):
            return None
        return row, rest

    def _variable(self, name: str) -> int:
        kind, _, index = name.partition(":")
        if kind == "x":
            return self.stored[int(index)]
        if kind != "s":
            return self.assembly.bond(name)
        k = int(index)
        if k not in self.integrals:
            self.integrals[k] = self._own()
            split = self._split(self.graph.integrals[k].rate)
            if split is not None:
                row, rest = split
                minus = self.ring.of(-1.0)
                row = self.ring.collect(
                    [(self.ring.one, {self.integrals[k]: self.D}), (minus, row)]
                )
                if rest != Number(0.0):
                    row[self._given(rest, -1, self.graph.integrals[k].path)] = minus
                self._add(row, LAW, -1)
        return self.integrals[k]

    def _given(self, formula: Expr, node: int, name: str) -> int:
        own = self._own()
        self.found.known[own] = Known(name, "source", formula, node)
        return own

    # -- elements and junctions

    def _structure(self) -> None:
        last = {owner: k for k, owner in enumerate(self.out.owners)}
        for k, (row, owner) in enumerate(zip(self.out.rows, self.out.owners, strict=True)):
            node = self.graph.nodes[owner]
            reason = self._unusable(row)
            if reason:
                self.found.unused[owner] = reason
                continue
            kind = LAW
            if node.is_junction and last[owner] == k:
                kind = MONITORED if owner in self.found.monitored else BALANCE
            self._add(row, kind, owner)

    def _unusable(self, row: Row[Rational]) -> str:
        """Return why a row cannot be used: its law is not linear, or a signal modulates it."""
        for k in row:
            about = self.found.column(k)
            if about is not None and about.kind == "law":
                return "its law is not linear"
        known = self.ring.meaning
        for c in row.values():
            for atom in c.atoms():
                read = names(known[atom]) if atom in known else {atom}
                if not all(n.startswith("p:") or n == D for n in read):
                    return "a signal modulates it"
        return ""

    def _storage(self) -> None:
        graph, ring = self.graph, self.ring
        minus = ring.of(-1.0)
        bonds = len(graph.bonds)
        ports: dict[tuple[int, int], int] = {(s.node, s.port): s.index for s in graph.storages}
        for s in graph.storages:
            node = graph.nodes[s.node]
            law = laws_of(graph, node, symbolic=True)
            at = s.bond + (bonds if s.kind == "C" else 0)
            way = ring.of(float(s.sign) if s.kind == "C" else 1.0)
            self._add({at: way, self.stored[s.index]: -self.D}, LAW, s.node)
            if law.matrix is None:
                self.found.unused[s.node] = "its law is not linear"
                continue
            row = {self.assembly.values[s.index]: minus}
            for j, e in enumerate(law.matrix[s.port]):
                c = ring.read(e)
                if ring.size(c) > 0.0:
                    row[self.stored[ports[s.node, j]]] = c
            self._add(row, LAW, s.node)

    def _closings(self) -> None:
        from itertools import product

        for switch, closer in list(self.out.closing.items()):
            self.found.switches[switch] = closer.machines
            sizes = [range(len(self.graph.machines[m].states)) for m in closer.machines]
            for states in product(*sizes):
                at = (switch, closer.key(states))
                if at in self.found.closing:
                    continue
                row = closer.row(states)
                reason = self._unusable(row)
                if reason:
                    about = self.found.column(switch)
                    assert about is not None
                    self.found.unused[about.index] = reason
                self.found.closing[at] = None if reason else row

    def _sources(self, first: int) -> None:
        """Split what sources give into what is known and what stored quantities control."""
        sources = [
            (first + k, c)
            for k, c in enumerate(list(self.out.columns))
            if c.kind == "source" and c.formula is not None
        ]
        for column, c in sources:
            assert c.formula is not None
            node = self.graph.nodes[c.index]
            split = self._split(c.formula)
            if split is None:
                self.found.unused[c.index] = "a signal modulates it"
                continue
            row, rest = split
            if not row:
                self.found.known[column] = Known(node.path, "source", rest, c.index)
                continue
            row = self.ring.collect([(self.ring.one, {column: self.ring.one}), _minus(row)])
            if rest != Number(0.0):
                row[self._given(rest, c.index, node.path)] = self.ring.of(-1.0)
            self._add(row, LAW, c.index)

    def _names(self) -> None:
        """Number sources that share a name: the values that one element takes in other modes."""
        known = self.found.known
        count = Counter(k.name for k in known.values())
        seen: Counter[str] = Counter()
        for column in sorted(known, key=lambda k: (known[k].kind == "source", -k)):
            own = known[column]
            if count[own.name] > 1 and own.kind == "source":
                seen[own.name] += 1
                known[column] = replace(own, name=f"{own.name}#{seen[own.name]}")


def _minus(row: Row[Rational]) -> tuple[Rational, Row[Rational]]:
    return Rational.of(-1), row
