"""What each element says in one mode, as rows; said once for all modes in which it is the same."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping, Sequence
from typing import Literal

from hybond.equations.calculus import bent, gradient, localised, partial_time, reads_bonds
from hybond.model.expressions import (
    Binary,
    Bool,
    Expr,
    Name,
    Neg,
    Number,
    names,
    simplify,
    substitute,
)
from hybond.model.graph import FlatGraph, Mode, Node
from hybond.model.kinds import RESISTORS, SOURCES, TWO_PORTS
from hybond.records import dataclass

Term = tuple[str, float]
"""A bond variable and its sign."""
Row = dict[int, float]
"""Column to coefficient: efforts of all bonds, then flows. The sum of the terms is zero."""
KEPT = 512
"""Parts kept beyond two for each element."""


@dataclass(frozen=True, slots=True)
class Dynamic:
    """A row ``expression = 0`` that is evaluated anew each time."""

    kind: Literal["structure", "law", "hidden"]
    """Power structure (a modulated two-port, a controlled source), a resistor's law, or the time
    derivative of a constraint."""
    node: int
    """The element, for messages; -1 for a hidden row."""
    expression: Expr
    slopes: Mapping[str, Expr]
    """Derivatives with respect to bond variables, for Newton."""
    frozen: Mapping[str, Expr]
    """The same with moduli held: what the structure is at this instant."""
    impulse_free: tuple[str, ...] = ()
    """Bond variables that this row forbids to carry an impulse."""
    partner: Term | None = None
    """Of a law that gives one variable of a bond: the other one, and the sign with which a
    resistance beside the law would add it."""


@dataclass(frozen=True, slots=True)
class Source:
    """A source whose value does not read bond variables: a known, with its own column."""

    node: int
    bond: int
    value: Expr
    rate: Expr
    """Its time derivative; it may read bond variables if the value reads what is stored."""


@dataclass(frozen=True, slots=True)
class Part:
    """What an element says."""

    power: tuple[Row, ...] = ()
    """Rows of the power structure with constant coefficients."""
    laws: tuple[Row, ...] = ()
    """Rows of resistors with constant coefficients."""
    dynamic: tuple[Dynamic, ...] = ()
    source: Source | None = None
    steady: bool = False
    """Whether it says that in every mode."""


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


def sends_impulses(node: Node, laws: Sequence[Expr]) -> bool:
    """Whether a source gives of an impulse that it reads the same multiple as of anything else.

    It does if parameters, inputs and time alone decide which multiple: a voltage that is n times
    another one is that at every instant, and so are their areas over a jump. Where the state or the
    mode has a part in it, the model has to say so: `impulsive`. `laws` are in the names of bonds.
    """
    if node.kind not in SOURCES or node.implied or node.finite:
        return node.impulsive
    slopes = [d for e in laws for d in gradient(e).values()]
    outside = all(
        n == "time" or n.startswith(("u:", "p:", "at:")) for d in slopes for n in names(d)
    )
    return node.impulsive or (outside and not any(bent(e) for e in laws))


class Parts:
    """The parts of a graph's elements."""

    def __init__(self, graph: FlatGraph) -> None:
        self.graph = graph
        self._bonds = len(graph.bonds)
        self._laws: dict[int, tuple[list[Expr], frozenset[str], bool]] = {}
        self._made: OrderedDict[tuple[object, ...], Part] = OrderedDict()

    def of(self, node: Node, off: bool, values: Mapping[str, Expr]) -> Part:
        """Return what an element says, where `values` are constant and it is `off` or not."""
        if node.index not in self._laws:
            assert node.law is not None
            laws = localised(node, node.law.expressions)
            read = frozenset().union(*(names(e) for e in laws))
            self._laws[node.index] = laws, read, sends_impulses(node, laws)
        laws, read, _ = self._laws[node.index]
        asked = sorted(read & values.keys())
        key = node.index, off, *((k, values[k]) for k in asked)
        found = self._made.get(key)
        if found is None:
            chosen = {k: values[k] for k in asked}
            steady = not asked and not node.controlled
            found = self._made[key] = self._part(
                node, off, [configure(e, chosen) for e in laws], steady=steady
            )
            if len(self._made) > KEPT + 2 * len(self.graph.nodes):
                # a table of time that sets a modulus makes a part for each of its rows
                self._made.popitem(last=False)
        return found

    def _part(self, node: Node, off: bool, laws: list[Expr], *, steady: bool) -> Part:
        assert node.law is not None
        if node.law.matrix is not None and not node.impulsive and node.kind in RESISTORS:
            return Part(laws=tuple(map(self._row, _constant(node))), steady=steady)
        if node.kind in SOURCES:
            end = node.ends[0]
            name = f"{'e' if node.kind == 'Se' else 'f'}:{end.bond}"
            value = Number(0.0) if off else laws[0]
            if reads_bonds(value) or node.impulsive:
                sends = self._laws[node.index][2]
                given = _controlled_source(node, name, value, sends=sends)
                return Part(dynamic=(given,), steady=steady)
            source = Source(node.index, end.bond, value, partial_time(value, self.graph))
            return Part((self._row({name: 1.0}),), source=source, steady=steady)
        if node.kind in TWO_PORTS:
            modulus = Number(0.0) if off else laws[0]
            pairs = _two_port(node)
            if not isinstance(modulus, Number):
                made = tuple(_modulated(node, modulus, pair) for pair in pairs)
                return Part(dynamic=made, steady=steady)
            rows = []
            for (out, a), (arg, b) in pairs:
                row = {out: a}
                if modulus.value != 0.0:
                    row[arg] = row.get(arg, 0.0) - modulus.value * b
                rows.append(self._row(row))
            return Part(tuple(rows), steady=steady)
        level = _level(node, laws)
        if level is not None:
            return Part((self._row({level[0]: 1.0}),), source=Source(*level[1:]), steady=steady)
        constant, dynamic = _resistor(node, laws)
        return Part(laws=tuple(map(self._row, constant)), dynamic=tuple(dynamic), steady=steady)

    def _row(self, by_name: Mapping[str, float]) -> Row:
        return {self.column(name): c for name, c in by_name.items()}

    def column(self, name: str) -> int:
        """Return the column of a bond variable."""
        kind, _, index = name.partition(":")
        return int(index) + (self._bonds if kind == "f" else 0)


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


def _controlled_source(node: Node, name: str, value: Expr, *, sends: bool) -> Dynamic:
    e = simplify(Binary("-", Name(name), value))
    slopes = gradient(e)
    free = () if sends else (name,)
    other = f"{'f' if name.startswith('e:') else 'e'}:{node.ends[0].bond}"
    partner = (other, float(node.ends[0].sign))
    return Dynamic("structure", node.index, e, slopes, slopes, free, partner)


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


def _level(node: Node, laws: list[Expr]) -> tuple[str, int, int, Expr, Expr] | None:
    """Return what a resistor of one port fixes, whatever the other variable of its bond is."""
    assert node.law is not None
    if len(laws) != 1 or node.impulsive or not isinstance(laws[0], Number):
        return None
    end = node.ends[0]
    flow = node.law.output == "f"
    name = f"{'f' if flow else 'e'}:{end.bond}"
    value = laws[0] if end.inward or not flow else simplify(Neg(laws[0]))
    return name, node.index, end.bond, value, Number(0.0)


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
        straight = len(numbers) == len(slopes) and not bent(e)
        both = (f"e:{end.bond}", f"f:{end.bond}")
        foreign = bool(numbers.keys() - {*both})
        if straight and not foreign and at_zero == Number(0.0) and not node.impulsive:
            constant.append(numbers)
        else:
            # a multiple of what another bond has is no impulse where that is one
            given = straight and foreign and not slopes.keys() & {*both} - {own}
            free = () if node.impulsive else (own,) if given else both
            partner = (f"e:{end.bond}", 1.0) if flow else (f"f:{end.bond}", float(end.sign))
            dynamic.append(Dynamic("law", node.index, e, slopes, slopes, free, partner))
    return constant, dynamic


def parameter_values(graph: FlatGraph) -> dict[str, float]:
    """Return the values of all names ``p:...`` that formulas of `graph` use."""
    found = {f"p:{path}": float(v) for path, v in graph.parameters.items()}
    if graph.parametric is not None:
        for node in graph.nodes:
            if not node.is_junction and not node.hidden:
                found.update(graph.parametric(node.index).own)
    return found
