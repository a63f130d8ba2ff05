"""What each element says about the bonds at its ports, as rows of coefficients.

Unknown columns are the efforts of all bonds, then their flows. Known columns are appended as
elements need them: rates and co-energy variables of storage, values of sources, outputs of
resistors that are held as ports, outputs of nonlinear laws, and switch variables.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Generic, Literal, TypeVar

from hybond.equations.calculus import bent, gradient, localised, reads_bonds
from hybond.equations.ring import Ring, Row
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
    turning,
)
from hybond.model.expressions.tree import fold, with_children
from hybond.model.graph import FlatGraph, Node
from hybond.model.kinds import RESISTORS, SOURCES, STORAGES, TWO_PORTS
from hybond.model.parametric import Parametric

T = TypeVar("T")
Kind = Literal["rate", "storage", "stored", "source", "resistor", "intake", "law", "switch"]


@dataclass(frozen=True, slots=True)
class Column:
    """A known column."""

    kind: Kind
    """``"rate"`` x' of a storage port, ``"storage"`` its co-energy variable, ``"stored"`` what it
    stores, where a source reads that; ``"source"`` a value that reads no bond, ``"resistor"`` what
    a resistor port imposes, ``"intake"`` what it receives, ``"law"`` the output of a nonlinear law,
    ``"switch"`` a switch variable."""
    index: int
    """The storage, or the node."""
    port: int = 0
    """The port of a resistor."""
    formula: Expr | None = None
    """The value of a source or the law of a nonlinear output, in canonical names."""


@dataclass(slots=True)
class Rows(Generic[T]):
    """The rows of a graph, mode-independent ones first."""

    unknowns: int
    """``2 * bonds``."""
    columns: list[Column] = field(default_factory=list)
    """Known column ``unknowns + k`` is `columns[k]`."""
    rows: list[Row[T]] = field(default_factory=list)
    """Each sums to zero in every mode."""
    owners: list[int] = field(default_factory=list)
    """The node that each row belongs to; a junction's balance is the last of its rows."""
    closing: dict[int, Closing[T]] = field(default_factory=dict)
    """Switch column to its row in each combination of what it depends on: see `Closing`."""

    def column(self, kind: Kind, index: int, *, port: int = 0, formula: Expr | None = None) -> int:
        """Append a known column; return its number."""
        self.columns.append(Column(kind, index, port, formula))
        return self.unknowns + len(self.columns) - 1


@dataclass(frozen=True, slots=True)
class Closing(Generic[T]):
    """The row that closes the system for one switch variable, by the state of its machines."""

    machines: tuple[int, ...]
    """The machines whose states decide."""
    row: Callable[[tuple[int, ...]], Row[T]]
    """From the states of those machines to the row."""
    key: Callable[[tuple[int, ...]], tuple[object, ...]]
    """From the states of those machines to what distinguishes rows: states with equal keys have the
    same row."""


def laws_of(graph: FlatGraph, node: Node, *, symbolic: bool) -> Parametric:
    """Return the law of an element in names of parameters, or in numbers."""
    if symbolic and graph.parametric is not None:
        return graph.parametric(node.index)
    law = node.law
    assert law is not None
    if law.matrix is None:
        return Parametric(None, law.expressions)
    matrix = tuple(tuple(Number(c) for c in row) for row in law.matrix)
    return Parametric(matrix, law.expressions)


def _constant(e: Expr) -> bool:
    """Whether an expression reads parameters only."""
    return all(name.startswith("p:") for name in names(e))


def _at_rest(e: Expr) -> Expr:
    """Return `e` with all bond variables zero, but for those of before a jump."""

    def visit(node: Expr, prior: bool, below: list[Expr]) -> Expr:
        if isinstance(node, Name) and not prior and node.path.startswith(("e:", "f:")):
            return Number(0.0)
        return with_children(node, tuple(below))

    return fold(e, visit)


class Assembly(Generic[T]):
    """Writes the rows of a graph.

    Parameters
    ----------
    on : collection of int
        The controlled nodes that are ON in the reference mode.
    symbolic : bool
        Whether laws are read in names of parameters.
    imposes : mapping, optional
        ``(node, port)`` to ``"e"`` or ``"f"``: resistors that are held as ports, with what they
        impose. Without it the laws of resistors are rows.
    feedback : bool
        Whether what sources read of stored quantities, times a constant, gets columns of its own
        (`stored`); else it is a part of the source's formula.
    """

    def __init__(
        self,
        graph: FlatGraph,
        ring: Ring[T],
        on: frozenset[int],
        *,
        symbolic: bool,
        imposes: Mapping[tuple[int, int], str] | None = None,
        feedback: bool = False,
    ) -> None:
        self.graph = graph
        self.ring = ring
        self.on = on
        self.symbolic = symbolic
        self.imposes = imposes
        self.bonds = len(graph.bonds)
        self.out: Rows[T] = Rows(2 * self.bonds)
        self.rates = [self.out.column("rate", s.index) for s in graph.storages]
        self.values = [self.out.column("storage", s.index) for s in graph.storages]
        self.stored = [self.out.column("stored", s.index) for s in graph.storages if feedback]
        for node in graph.nodes:
            if node.is_junction:
                self._junction(node)
            elif node.kind in STORAGES:
                continue
            elif node.kind in RESISTORS and imposes is not None:
                self._held(node)
            else:
                self._element(node)
            self.out.owners += [node.index] * (len(self.out.rows) - len(self.out.owners))
        minus = ring.of(-1.0)
        for s in graph.storages:
            own = s.bond if s.kind == "C" else self.bonds + s.bond
            way = ring.of(1.0 if s.kind == "C" else float(s.sign))
            self.out.rows.append({own: way, self.values[s.index]: minus})
            self.out.owners.append(s.node)

    # -- names to columns

    def bond(self, name: str) -> int:
        """Return the column of ``e:b`` or ``f:b``."""
        kind, _, index = name.partition(":")
        return int(index) + (self.bonds if kind == "f" else 0)

    def affine(self, e: Expr) -> tuple[Row[T], Expr] | None:
        """Return coefficients by bond column and the rest, if `e` is affine in bond variables."""
        slopes = gradient(e)
        if any(reads_bonds(d) for d in slopes.values()) or bent(e):
            return None
        rest = simplify(_at_rest(e)) if slopes or reads_bonds(e) else e
        row = {self.bond(name): self.ring.read(d) for name, d in slopes.items()}
        return {k: c for k, c in row.items() if self.ring.there(c)}, rest

    def given(self, node: int, rest: Expr, *, port: int = 0) -> Row[T]:
        """Return what reads no bond as columns: stored quantities, else a source of its own."""
        row: Row[T] = {}
        if self.stored:
            slopes = {n: differentiate(rest, n) for n in sorted(names(rest)) if n[:2] == "x:"}
            straight = not any(n in slopes for a in turning(rest) for n in names(a))
            if slopes and straight and all(_constant(d) for d in slopes.values()):
                row = {self.stored[int(n[2:])]: self.ring.read(d) for n, d in slopes.items()}
                rest = simplify(substitute(rest, {n: Number(0.0) for n in slopes}))
        if rest != Number(0.0):
            row[self._source(node, rest, port)] = self.ring.one
        return row

    def _source(self, node: int, value: Expr, port: int) -> int:
        """Return a source column; an output (node -1) may read one that an element has."""
        if node < 0:
            for k, column in enumerate(self.out.columns):
                if column.kind == "source" and column.formula == value:
                    return self.out.unknowns + k
        return self.out.column("source", node, port=port, formula=value)

    # -- nodes

    def _junction(self, node: Node) -> None:
        if not node.ends:
            return
        ring, bonds = self.ring, self.bonds
        common, other = (0, bonds) if node.kind == "0" else (bonds, 0)
        one, minus = ring.one, ring.of(-1.0)
        first = node.ends[0].bond
        rows = self.out.rows
        rows.extend({common + end.bond: one, common + first: minus} for end in node.ends[1:])
        balance = {other + end.bond: one if end.inward else minus for end in node.ends}
        if not node.controlled:
            rows.append(balance)
            return
        switch = self.out.column("switch", node.index)
        if node.index in self.on:
            rows.append({**balance, switch: minus})
            on, off = {switch: one}, {common + first: one}
        else:
            rows.append({common + first: one, switch: minus})
            on, off = balance, {switch: one}
        self._close(switch, node, on, off)

    def _close(self, switch: int, node: Node, on: Row[T], off: Row[T]) -> None:
        assert node.machine is not None
        states = self.graph.machines[node.machine].on

        def key(at: tuple[int, ...]) -> tuple[object, ...]:
            return (node.index in states[at[0]],)

        self.out.closing[switch] = Closing(
            (node.machine,), lambda at: on if node.index in states[at[0]] else off, key
        )

    def _held(self, node: Node) -> None:
        """A resistor as a port: what it imposes is known, its law is written elsewhere."""
        assert self.imposes is not None
        for end in node.ends:
            effort = self.imposes[node.index, end.port] == "e"
            own = self.out.column("resistor", node.index, port=end.port)
            way = 1.0 if effort else float(end.sign)
            at = end.bond + (0 if effort else self.bonds)
            self.out.rows.append({at: self.ring.of(way), own: self.ring.of(-1.0)})

    def _element(self, node: Node) -> None:
        """Each law is ``output - expression = 0``: a row if it is affine in bond variables."""
        law = laws_of(self.graph, node, symbolic=self.symbolic)
        for k, (output, expression) in enumerate(self._outputs(node, law)):
            decided = [n for n in sorted(names(expression)) if n.startswith(("in:", "on:"))]
            if node.controlled or decided:
                self._switched(node, k, output, expression, decided)
                continue
            found = self.affine(expression)
            if found is None:
                own = self.out.column("law", node.index, port=k, formula=expression)
                self.out.rows.append({**output, own: self.ring.of(-1.0)})
                continue
            self.out.rows.append(self._row(node, k, output, *found))

    def _outputs(self, node: Node, law: Parametric) -> list[tuple[Row[T], Expr]]:
        """Return the left-hand sides of a node's laws and their expressions."""
        ring = self.ring
        assert node.law is not None
        if node.kind in SOURCES:
            end = node.ends[0]
            at = end.bond + (0 if node.kind == "Se" else self.bonds)
            return [({at: ring.one}, localised(node, law.expressions)[0])]
        if node.kind in TWO_PORTS:
            modulus = localised(node, law.expressions)[0]
            one, two = node.ends
            e2 = Name(f"e:{two.bond}")
            f1, f2 = Name(f"f:{one.bond}"), Name(f"f:{two.bond}")
            in1: Expr = f1 if one.inward else Neg(f1)
            out2: Expr = Neg(f2) if two.inward else f2
            way = ring.of(-1.0 if two.inward else 1.0)
            first = {one.bond: ring.one}
            if node.kind == "TF":
                second = {self.bonds + two.bond: way}
                pairs = [(first, e2), (second, in1)]
            else:
                pairs = [(first, out2), ({two.bond: ring.one}, in1)]
            return [(row, simplify(Binary("*", modulus, arg))) for row, arg in pairs]
        effort = node.law.output == "e"
        found = []
        for end, expression in zip(node.ends, localised(node, law.expressions), strict=True):
            at = end.bond + (0 if effort else self.bonds)
            way = ring.of(1.0 if effort else float(end.sign))
            found.append(({at: way}, expression))
        return found

    def _row(self, node: Node, port: int, output: Row[T], slopes: Row[T], rest: Expr) -> Row[T]:
        """Return ``output - slopes - rest = 0``, the rest as a source column if it is not zero."""
        ring = self.ring
        minus = ring.of(-1.0)
        given = self.given(node.index, rest, port=port)
        return ring.collect([(ring.one, output), (minus, slopes), (minus, given)])

    def _switched(
        self, node: Node, port: int, output: Row[T], expression: Expr, decided: list[str]
    ) -> None:
        """A law that a machine switches: its output is a switch variable, closed by mode.

        An OFF source is a null source, an OFF two-port has modulus zero; a law may also read
        ``machine.state`` or ``junction.on``.
        """
        graph, ring = self.graph, self.ring
        machines = {node.machine} if node.controlled and node.machine is not None else set()
        for name in decided:
            kind, _, rest = name.partition(":")
            owner = int(rest.partition(":")[0]) if kind == "in" else graph.nodes[int(rest)].machine
            assert owner is not None
            machines.add(owner)
        order = tuple(sorted(machines))
        switch = self.out.column("switch", node.index, port=port)
        self.out.rows.append({**output, switch: ring.of(-1.0)})
        rests: dict[Expr, Row[T]] = {}
        made: dict[tuple[object, ...], Row[T]] = {}

        def configured(at: tuple[int, ...]) -> Expr:
            state = dict(zip(order, at, strict=True))
            own = node.machine
            if node.controlled and own is not None:
                on = node.index in graph.machines[own].on[state[own]]
                if not on:
                    return Number(0.0)
            values: dict[str, Expr] = {}
            for name in decided:
                kind, _, rest = name.partition(":")
                if kind == "in":
                    m, _, k = rest.partition(":")
                    values[name] = Bool(state[int(m)] == int(k))
                else:
                    owner = graph.nodes[int(rest)].machine
                    assert owner is not None
                    on = int(rest) in graph.machines[owner].on[state[owner]]
                    values[name] = Bool(on)
            return simplify(substitute(expression, values)) if values else expression

        def key(at: tuple[int, ...]) -> tuple[object, ...]:
            return (str(configured(at)),)

        def row(at: tuple[int, ...]) -> Row[T]:
            e = configured(at)
            known = made.get((str(e),))
            if known is not None:
                return known
            found = self.affine(e)
            if found is None:
                own = self.out.column("law", node.index, port=port, formula=e)
                result: Row[T] = {switch: ring.one, own: ring.of(-1.0)}
            else:
                slopes, rest = found
                if rest not in rests:
                    rests[rest] = self.given(node.index, rest, port=port)
                minus = ring.of(-1.0)
                result = ring.collect(
                    [(ring.one, {switch: ring.one}), (minus, slopes), (minus, rests[rest])]
                )
            made[str(e),] = result
            return result

        self.out.closing[switch] = Closing(order, row, key)
