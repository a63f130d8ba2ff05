"""The equations of one mode as rows: power structure, storage, sources, resistors.

A *configuration* is a mode together with the values of whatever else is constant between events
and enters moduli or resistor laws (a PWM input that drives a transformer switch). Rows with
constant coefficients are eliminated here, in the order that tells structure from laws:

1. power structure, storages with their co-energy variables given, sources with their values
   given; a row without unknowns is a constraint that the structure puts on what is stored;
2. constant linear resistors. A definite one adds no constraint; zero resistance does.

What is left (modulated two-ports, nonlinear laws, sources that read bond variables) are `Dynamic`
rows, solved at each evaluation.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

from hybond.causality.orientation import Given
from hybond.equations.calculus import gradient, rate_name, reads_bonds
from hybond.equations.element_parts import Dynamic, Part, Parts, Source, settings
from hybond.equations.elimination import Elimination, Row
from hybond.model.expressions import (
    Binary,
    Expr,
    Name,
    Number,
    differentiate,
    names,
    simplify,
    substitute,
    uses_pre,
)
from hybond.model.graph import FlatGraph, Mode, Node, Storage
from hybond.model.kinds import STORAGES
from hybond.uncollected import uncollected

"""Which variable of a junction's conjugate pair is given from outside."""


@dataclass(slots=True)
class Tableau:
    """Rows of one configuration, constant ones eliminated.

    Columns: ``2 * bonds`` unknowns (efforts, then flows), one known per storage port, one per
    source value, one per source rate.
    """

    unknowns: int
    storages: int
    sources: list[Source]
    power: Elimination
    """After steps 1 and 2; its free unknowns include those that carry impulses."""
    finite: Elimination
    """The same after the hidden rows with constant coefficients."""
    constraints: list[Row]
    """Independent rows among knowns that involve stored quantities."""
    agreements: list[Row]
    """Rows among source values alone: satisfied, or the model contradicts itself."""
    dynamic: list[Dynamic]
    too_high: list[Row]
    """Hidden rows that determine nothing: differentiating once is not enough."""

    @property
    def knowns(self) -> int:
        """How many columns of knowns there are."""
        return self.storages + 2 * len(self.sources)


class Sheet:
    """Makes the tableaus of one graph.

    Rows that are the same in every mode are eliminated once; those of a mode are added to that.
    """

    def __init__(self, graph: FlatGraph) -> None:
        self.graph = graph
        self.parts = Parts(graph)
        self._begun: dict[frozenset[int], _Begun] = {}
        self._siblings: dict[int, list[Storage]] = {}
        for s in graph.storages:
            self._siblings.setdefault(s.node, []).append(s)

    def build(
        self, mode: Mode, discrete: Mapping[str, float], ports: Mapping[int, Given] | None = None
    ) -> Tableau:
        """Return the tableau of one configuration.

        `ports` are junctions whose law is left open: whether their ``"common"`` or their ``"net"``
        variable is given from outside, as a source at the end of `sources`, in the order of
        `ports`.
        """
        graph = self.graph
        ports = {} if ports is None else ports
        bonds = len(graph.bonds)
        off = graph.off_nodes(mode)
        values = settings(graph, mode, discrete)
        begun = self._first(frozenset(k for k in ports if not graph.nodes[k].controlled), values)
        power = begun.power.copy()
        leftover: list[Row | None] = list(begun.leftover)
        sources, dynamic = list(begun.sources), list(begun.dynamic)
        value0 = 2 * bonds + len(graph.storages)
        first: list[Row] = []
        second: list[Row] = []
        for node in begun.open:
            if node.is_junction:
                continue
            part = self.parts.of(node, node.index in off, values)
            _collect(part, value0, first, second, sources, dynamic)
        for index, given in ports.items():
            own = value0 + len(sources)
            first += _port(graph.nodes[index], given, own, bonds)
            bond = graph.nodes[index].ends[0].bond
            sources.append(Source(index, bond, Number(0.0), Number(0.0)))
        for node in begun.open:
            if node.is_junction and node.index not in ports:
                first += _nothing(node, bonds) if node.index in off else _joined(node, bonds)
        leftover += [power.add(row) for row in first + second]
        # a source's rate column stands as far behind its value as there are sources
        constraints, agreements = _independent([r for r in leftover if r], graph)
        finite = power.copy() if constraints else power
        too_high = []
        for row in constraints:
            constant, expression = _hidden(row, graph, sources, value0, self._siblings)
            if expression is not None:
                slopes = gradient(expression)
                dynamic.append(Dynamic("hidden", -1, expression, slopes, slopes))
            elif (rest := finite.add(constant)) is not None:
                too_high.append(rest)
        if constraints:
            # what is stored dependently is not asked: sums that cancel on the constraints are gone
            told = {value0 + k for k, s in enumerate(sources) if _of_time(s.value)}
            finite.put_in(_dependent(constraints, {*range(2 * bonds, value0), *told}))
        return Tableau(
            2 * bonds,
            len(graph.storages),
            sources,
            power,
            finite,
            constraints,
            agreements,
            dynamic,
            too_high,
        )

    @uncollected
    def _first(self, loose: frozenset[int], values: Mapping[str, Expr]) -> _Begun:
        """Return the elimination of what is the same in every mode, `loose` junctions left out."""
        found = self._begun.get(loose)
        if found is not None:
            return found
        graph = self.graph
        bonds = len(graph.bonds)
        value0 = 2 * bonds + len(graph.storages)
        first: list[Row] = []
        second: list[Row] = []
        sources: list[Source] = []
        dynamic: list[Dynamic] = []
        open_: list[Node] = []
        for s in graph.storages:
            own = s.bond if s.kind == "C" else bonds + s.bond
            first.append({own: 1.0 if s.kind == "C" else float(s.sign), 2 * bonds + s.index: -1.0})
        joined: list[Node] = []
        for node in graph.nodes:
            if node.kind in STORAGES:
                continue
            if node.is_junction:
                (open_ if node.controlled or node.index in loose else joined).append(node)
                continue
            part = self.parts.of(node, False, values)
            if part.steady:
                _collect(part, value0, first, second, sources, dynamic)
            else:
                open_.append(node)
        first += [_balance(node, bonds) for node in joined]
        power = Elimination(2 * bonds, [pair for n in joined for pair in _equal(n, bonds)])
        leftover = [power.add(row) for row in first + second]
        found = _Begun(power, [r for r in leftover if r], sources, dynamic, open_)
        self._begun[loose] = found
        return found


@dataclass(frozen=True, slots=True)
class _Begun:
    """What is the same in every mode, and the nodes that are not."""

    power: Elimination
    leftover: list[Row]
    sources: list[Source]
    dynamic: list[Dynamic]
    open: list[Node]


def build(
    graph: FlatGraph,
    mode: Mode,
    discrete: Mapping[str, float],
    ports: Mapping[int, Given] | None = None,
) -> Tableau:
    """Return the tableau of one configuration of a graph, from scratch; see `Sheet.build`."""
    return Sheet(graph).build(mode, discrete, ports)


def _collect(
    part: Part,
    value0: int,
    first: list[Row],
    second: list[Row],
    sources: list[Source],
    dynamic: list[Dynamic],
) -> None:
    """Add what an element says; the value of a source gets the next column."""
    if part.source is not None:
        (row,) = part.power
        first.append({**row, value0 + len(sources): -1.0})
        sources.append(part.source)
    else:
        first.extend(part.power)
    second.extend(part.laws)
    dynamic.extend(part.dynamic)


def _equal(node: Node, bonds: int) -> list[tuple[int, int]]:
    """Return the variables that a junction, ON, makes equal."""
    common = 0 if node.kind == "0" else bonds
    return [(common + a.bond, common + b.bond) for a, b in pairwise(node.ends)]


def _joined(node: Node, bonds: int) -> list[Row]:
    """Return the rows of a junction that is ON."""
    return [*({a: 1.0, b: -1.0} for a, b in _equal(node, bonds)), _balance(node, bonds)]


def _balance(node: Node, bonds: int) -> Row:
    """Return the sum that a junction, ON, makes zero."""
    other = bonds if node.kind == "0" else 0
    return {other + end.bond: float(end.sign) for end in node.ends}


def _nothing(node: Node, bonds: int) -> list[Row]:
    """Return the rows of a junction that is OFF: each bond gets zero."""
    common = 0 if node.kind == "0" else bonds
    return [{common + end.bond: 1.0} for end in node.ends]


def _port(node: Node, given: Given, own: int, bonds: int) -> list[Row]:
    """Return the rows of a junction one of whose pair of variables is the known column `own`."""
    if given == "common":
        return [{**row, own: -1.0} for row in _nothing(node, bonds)]
    *rows, balance = _joined(node, bonds)
    return [*rows, {**balance, own: -1.0}]


def _independent(rows: list[Row], graph: FlatGraph) -> tuple[list[Row], list[Row]]:
    """Split constraints into independent ones on storage and ones among sources alone.

    Those on storage are reduced by each other: sums over many storages, which rounding would not
    keep, become differences of few. The first column of each is in no other.
    """
    first = 2 * len(graph.bonds)
    table = Elimination(len(graph.storages))
    agreements = []
    for row in rows:
        rest = table.add({k - first: c for k, c in row.items()})
        if rest:
            agreements.append({k + first: c for k, c in rest.items()})
    constraints = [
        {k + first: 1.0, **{j + first: c for j, c in row.items()}}
        for k, row in table.solved.items()
    ]
    return constraints, agreements


def _dependent(constraints: list[Row], told: set[int]) -> dict[int, Row]:
    """Return the first column of each constraint by the others, if all are `told`.

    The first one is that which no other constraint has (`_independent`).

    A source that reads ``pre()`` is not: what is stored keeps its value when that has moved on.
    """
    return {
        next(iter(row)): dict(list(row.items())[1:]) for row in constraints if row.keys() <= told
    }


def _of_time(e: Expr) -> bool:
    """Whether a value depends on time and inputs only."""
    return not uses_pre(e) and all(n == "time" or n.startswith("u:") for n in names(e))


def _hidden(
    row: Row,
    graph: FlatGraph,
    sources: list[Source],
    value0: int,
    siblings: Mapping[int, list[Storage]],
) -> tuple[Row, Expr | None]:
    """Return the time derivative of a constraint: a constant row, or else an expression.

    `siblings` are the ports of each storage.
    """
    bonds = len(graph.bonds)
    constant: Row = {}
    total: Expr = Number(0.0)
    linear = True
    for k, c in sorted(row.items()):
        if k >= value0:
            source = sources[k - value0]
            total = Binary("+", total, Binary("*", Number(c), source.rate))
            if reads_bonds(source.rate):
                linear = False
            elif source.rate != Number(0.0):
                constant[k + len(sources)] = c
            continue
        node = graph.nodes[graph.storages[k - 2 * bonds].node]
        port = graph.storages[k - 2 * bonds].port
        assert node.law is not None
        for s in siblings[node.index]:
            slope = stiffness(node, port, s.port, graph, siblings[node.index])
            total = Binary("+", total, Binary("*", Number(c), Binary("*", slope, rate_name(s))))
            if isinstance(slope, Number):
                at = s.bond + (bonds if s.kind == "C" else 0)
                way = s.sign if s.kind == "C" else 1.0
                constant[at] = constant.get(at, 0.0) + c * slope.value * way
            else:
                linear = False
    return constant, None if linear else simplify(total)


def stiffness(
    node: Node, port: int, other: int, graph: FlatGraph, own: Sequence[Storage] | None = None
) -> Expr:
    """Return the derivative of a storage's co-energy variable by a stored quantity.

    `own` are the storage ports of the node, if they are known.
    """
    assert node.law is not None
    if node.law.matrix is not None:
        return Number(node.law.matrix[port][other])
    energy = node.about.energy
    suffix = str(other + 1) if len(node.ends) > 1 else ""
    d = _slope(node.law.expressions[port], f"law:{energy}{suffix}")
    return substitute(d, stored_names(node, graph, own))


@lru_cache(maxsize=1024)
def _slope(law: Expr, name: str) -> Expr:
    """Return a derivative in local names, which are the same in many elements."""
    return differentiate(law, name)


def stored_names(
    node: Node, graph: FlatGraph, own: Sequence[Storage] | None = None
) -> dict[str, Expr]:
    """Return what a storage's local stored quantities are called in the graph.

    `own` are its ports, if they are known.
    """
    many = len(node.ends) > 1
    return {
        f"law:{node.about.energy}{s.port + 1 if many else ''}": Name(f"x:{s.index}")
        for s in (graph.storages if own is None else own)
        if s.node == node.index
    }
