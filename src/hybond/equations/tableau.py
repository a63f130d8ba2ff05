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
from itertools import pairwise
from typing import Literal

from hybond.equations.calculus import gradient, partial_time, rate_name, reads_bonds
from hybond.equations.elimination import Elimination, Row
from hybond.model.expressions import (
    Binary,
    Bool,
    Expr,
    Name,
    Neg,
    Number,
    differentiate,
    names,
    simplify,
    substitute,
)
from hybond.model.graph import FlatGraph, Mode, Node, Storage
from hybond.model.kinds import RESISTORS, SOURCES, STORAGES, TWO_PORTS

Given = Literal["common", "net"]
"""Which variable of a junction's conjugate pair is given from outside."""


@dataclass(frozen=True, slots=True)
class Dynamic:
    """A row ``expression = 0`` that is evaluated anew each time.

    Parameters
    ----------
    kind : {"structure", "law", "hidden"}
        Power structure (a modulated two-port, a controlled source), a resistor's law, or the
        time derivative of a constraint.
    node : int
        The element, for messages; -1 for a hidden row.
    expression : Expr
    slopes : dict
        Derivatives with respect to bond variables, for Newton.
    frozen : dict
        The same with moduli held: what the structure is at this instant.
    impulse_free : tuple of str
        Bond variables that this row forbids to carry an impulse.
    """

    kind: Literal["structure", "law", "hidden"]
    node: int
    expression: Expr
    slopes: Mapping[str, Expr]
    frozen: Mapping[str, Expr]
    impulse_free: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Source:
    """A source whose value does not read bond variables: a known, with its own column."""

    node: int
    bond: int
    value: Expr
    rate: Expr
    """Its time derivative; it may read bond variables if the value reads what is stored."""


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


def settings(graph: FlatGraph, mode: Mode, discrete: Mapping[str, float]) -> dict[str, Expr]:
    """Return what is constant in a configuration: machine states, switches, `discrete`."""
    on = graph.on_nodes(mode)
    values: dict[str, Expr] = {k: Number(v) for k, v in discrete.items()}
    for n in graph.nodes:
        if n.controlled:
            values[f"on:{n.index}"] = Bool(n.index in on)
    for m, k in zip(graph.machines, mode, strict=True):
        values.update({f"in:{m.index}:{j}": Bool(j == k) for j in range(len(m.states))})
    return values


def configure(e: Expr, values: Mapping[str, Expr]) -> Expr:
    """Put in what is constant in a configuration."""
    read = names(e) & values.keys()
    return simplify(substitute(e, {k: values[k] for k in read})) if read else e


def build(
    graph: FlatGraph,
    mode: Mode,
    discrete: Mapping[str, float],
    ports: Mapping[int, Given] | None = None,
) -> Tableau:
    """Return the tableau of one configuration.

    `ports` are junctions whose law is left open: whether their ``"common"`` or their ``"net"``
    variable is given from outside, as a source at the end of `sources`, in the order of `ports`.
    """
    ports = {} if ports is None else ports
    bonds = len(graph.bonds)
    off = graph.off_nodes(mode)
    values = settings(graph, mode, discrete)
    first: list[Row] = []
    second: list[Row] = []
    sources: list[Source] = []
    dynamic: list[Dynamic] = []
    value0 = 2 * bonds + len(graph.storages)

    def column(name: str) -> int:
        kind, _, index = name.partition(":")
        return int(index) + (bonds if kind == "f" else 0)

    for s in graph.storages:
        own = column(f"e:{s.bond}") if s.kind == "C" else column(f"f:{s.bond}")
        first.append({own: 1.0 if s.kind == "C" else float(s.sign), 2 * bonds + s.index: -1.0})
    for node in graph.nodes:
        if node.is_junction or node.kind in STORAGES:
            continue
        plain = node.law is not None and node.law.matrix is not None and not node.impulsive
        if plain and node.kind in RESISTORS:
            second.extend({column(k): c for k, c in row.items()} for row in _constant(node))
            continue
        laws = [configure(e, values) for e in _localised(node)]
        if node.kind in SOURCES:
            end = node.ends[0]
            name = f"{'e' if node.kind == 'Se' else 'f'}:{end.bond}"
            value = Number(0.0) if node.index in off else laws[0]
            if reads_bonds(value) or node.impulsive:
                dynamic.append(_controlled_source(node, name, value))
            else:
                first.append({column(name): 1.0, value0 + len(sources): -1.0})
                sources.append(Source(node.index, end.bond, value, partial_time(value, graph)))
        elif node.kind in TWO_PORTS:
            modulus = Number(0.0) if node.index in off else laws[0]
            pairs = _two_port(node)
            if isinstance(modulus, Number):
                for (out, a), (arg, b) in pairs:
                    row = {column(out): a}
                    if modulus.value != 0.0:
                        row[column(arg)] = row.get(column(arg), 0.0) - modulus.value * b
                    first.append(row)
            else:
                dynamic.extend(_modulated(node, modulus, pair) for pair in pairs)
        else:
            second_rows, laws_rows = _resistor(node, laws)
            second.extend({column(k): c for k, c in row.items()} for row in second_rows)
            dynamic.extend(laws_rows)
    known = first
    for index, given in ports.items():
        own = value0 + len(sources)
        known += _port(graph.nodes[index], given, own, bonds)
        bond = graph.nodes[index].ends[0].bond
        sources.append(Source(index, bond, Number(0.0), Number(0.0)))
    shared = [n for n in graph.nodes if n.is_junction and n.index not in off | ports.keys()]
    known += [
        r
        for n in graph.nodes
        if n.is_junction and n.index not in ports
        for r in ([_balance(n, bonds)] if n.index not in off else _nothing(n, bonds))
    ]

    power = Elimination(2 * bonds, [pair for n in shared for pair in _equal(n, bonds)])
    leftover = [power.add(row) for row in known]
    leftover += [power.add(row) for row in second]
    # a source's rate column stands as far behind its value as there are sources
    constraints, agreements = _independent([r for r in leftover if r], graph)
    finite = power.copy()
    too_high = []
    for row in constraints:
        constant, expression = _hidden(row, graph, sources, value0)
        if expression is not None:
            slopes = gradient(expression)
            dynamic.append(Dynamic("hidden", -1, expression, slopes, slopes))
        elif (rest := finite.add(constant)) is not None:
            too_high.append(rest)
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


def _localised(node: Node) -> list[Expr]:
    """Return the law with its local names replaced by those of the node's bonds."""
    assert node.law is not None
    local: dict[str, Expr] = {}
    many = len(node.ends) > 1
    for end in node.ends:
        k = str(end.port + 1) if many else ""
        local[f"law:e{k}"] = Name(f"e:{end.bond}")
        flow = Name(f"f:{end.bond}")
        local[f"law:f{k}"] = flow if end.inward else Neg(flow)
    return [substitute(e, local) for e in node.law.expressions]


def _equal(node: Node, bonds: int) -> list[tuple[int, int]]:
    """Return the variables that a junction, ON, makes equal."""
    common = 0 if node.kind == "0" else bonds
    return [(common + a.bond, common + b.bond) for a, b in pairwise(node.ends)]


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
    rows: list[Row] = [{a: 1.0, b: -1.0} for a, b in _equal(node, bonds)]
    return [*rows, {**_balance(node, bonds), own: -1.0}]


Term = tuple[str, float]


def _two_port(node: Node) -> list[tuple[Term, Term]]:
    """Return ``(output, argument)`` of both equations ``output = modulus * argument``.

    Port 1 takes power in, port 2 gives it out: TF e1 = m e2, f2 = m f1; GY e1 = r f2, e2 = r f1.
    """
    one, two = node.ends
    f1, f2 = 1.0 if one.inward else -1.0, -1.0 if two.inward else 1.0
    e1, e2 = (f"e:{one.bond}", 1.0), (f"e:{two.bond}", 1.0)
    flow1, flow2 = (f"f:{one.bond}", f1), (f"f:{two.bond}", f2)
    if node.kind == "TF":
        return [(e1, e2), (flow2, flow1)]
    return [(e1, flow2), (e2, flow1)]


def _scaled(term: Term) -> Expr:
    name, sign = term
    return Name(name) if sign > 0 else Neg(Name(name))


def _modulated(node: Node, modulus: Expr, pair: tuple[Term, Term]) -> Dynamic:
    out, arg = pair
    e = simplify(Binary("-", _scaled(out), Binary("*", modulus, _scaled(arg))))
    frozen: dict[str, Expr] = {out[0]: Number(out[1])}
    frozen[arg[0]] = simplify(Binary("*", Number(-arg[1]), modulus))
    return Dynamic("structure", node.index, e, gradient(e), frozen)


def _controlled_source(node: Node, name: str, value: Expr) -> Dynamic:
    e = simplify(Binary("-", Name(name), value))
    slopes = gradient(e)
    return Dynamic("structure", node.index, e, slopes, slopes, () if node.impulsive else (name,))


def _constant(node: Node) -> list[dict[str, float]]:
    """Return the rows of a linear resistor with constant coefficients."""
    assert node.law is not None and node.law.matrix is not None
    flow = node.law.output == "f"
    rows = []
    for end, coefficients in zip(node.ends, node.law.matrix, strict=True):
        row = {f"{'f' if flow else 'e'}:{end.bond}": float(end.sign) if flow else 1.0}
        for other, c in zip(node.ends, coefficients, strict=True):
            if c != 0.0:
                row[f"{'e' if flow else 'f'}:{other.bond}"] = -c * (1.0 if flow else other.sign)
        rows.append(row)
    return rows


def _resistor(node: Node, laws: list[Expr]) -> tuple[list[dict[str, float]], list[Dynamic]]:
    """Return constant rows and dynamic rows of a resistor; a row is constant if its slopes are."""
    assert node.law is not None
    constant: list[dict[str, float]] = []
    dynamic: list[Dynamic] = []
    for end, law in zip(node.ends, laws, strict=True):
        flow = node.law.output == "f"
        own = f"{'f' if flow else 'e'}:{end.bond}"
        sign = float(end.sign) if flow else 1.0
        e = simplify(Binary("-", _scaled((own, sign)), law))
        slopes = gradient(e)
        at_zero = simplify(substitute(e, {n: Number(0.0) for n in slopes}))
        numbers = {n: d.value for n, d in slopes.items() if isinstance(d, Number)}
        if len(numbers) == len(slopes) and at_zero == Number(0.0) and not node.impulsive:
            constant.append(numbers)
        else:
            both = (f"e:{end.bond}", f"f:{end.bond}")
            free = () if node.impulsive else both
            dynamic.append(Dynamic("law", node.index, e, slopes, slopes, free))
    return constant, dynamic


def _independent(rows: list[Row], graph: FlatGraph) -> tuple[list[Row], list[Row]]:
    """Split constraints into independent ones on storage and ones among sources alone."""
    first = 2 * len(graph.bonds)
    table = Elimination(len(graph.storages))
    constraints, agreements = [], []
    for row in rows:
        rest = table.add({k - first: c for k, c in row.items()})
        if rest is None:
            constraints.append(row)
        elif rest:
            agreements.append({k + first: c for k, c in rest.items()})
    return constraints, agreements


def _hidden(
    row: Row, graph: FlatGraph, sources: list[Source], value0: int
) -> tuple[Row, Expr | None]:
    """Return the time derivative of a constraint: a constant row, or else an expression."""
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
        for s in graph.storages:
            if s.node != node.index:
                continue
            slope = stiffness(node, port, s.port, graph)
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
    d = differentiate(node.law.expressions[port], f"law:{energy}{suffix}")
    return substitute(d, stored_names(node, graph, own))


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
