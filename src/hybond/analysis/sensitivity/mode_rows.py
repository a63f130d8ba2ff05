"""All equations of one mode as expressions that are zero, with parameters as names in them.

r(w, x, t, p) = 0     2 * bonds rows for the bond variables w
x' = rates(w, x, t, p)
r_J(J, w, x, p) = 0   what impulse areas J keep to: the structure, moduli as before the jump
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.gradients import AREA, RATE, Compiled, without_pre
from hybond.analysis.sensitivity.wanted import followed, stored_law
from hybond.equations.calculus import partial_time, rate_name, reads_bonds
from hybond.equations.element_parts import Part, Parts, configure, settings
from hybond.equations.isolated import isolated
from hybond.equations.peeling import Peeling
from hybond.equations.ring import Numbers, Row
from hybond.model.expressions import (
    Binary,
    Expr,
    Name,
    Neg,
    Number,
    Pre,
    differentiate,
    names,
    simplify,
    substitute,
    turning,
)
from hybond.model.expressions.kinks import leaping
from hybond.model.expressions.slots import is_slotted, tree_of
from hybond.model.expressions.tree import transform
from hybond.model.graph import FlatGraph, Mode, Node
from hybond.model.junction_structure import junction_rows
from hybond.model.kinds import STORAGES


class ModeRows:
    """The equations of a mode.

    Parameters
    ----------
    graph : FlatGraph
        With slots for what is varied.
    truths : mapping
        Of each comparison of time alone, ``at:k``, whether it holds.

    Attributes
    ----------
    bonds : list of str
        The bond variables w.
    spread : array, shape (2 * bonds, open)
        All bond variables by those that junctions and constant two-ports leave open; it holds for
        impulse areas, too.
    rows : list of Expr
        What else holds.
    areas : list of Expr
        Of impulse areas, in names ``J|e:3``.
    rates : list of Expr
    """

    def __init__(self, graph: FlatGraph, mode: Mode, truths: Mapping[str, float]) -> None:
        self.graph, self.mode = graph, mode
        self.many = len(graph.bonds)
        bonds = range(self.many)
        self.bonds = [f"e:{b}" for b in bonds] + [f"f:{b}" for b in bonds]
        self.states = [f"x:{s.index}" for s in graph.storages]
        self.states += [f"s:{i.index}" for i in graph.integrals]
        self.discrete = settings(graph, mode, truths)
        self.rows: list[Expr] = []
        self.areas: list[Expr] = []
        self._structure: list[Row[float]] = []
        on = graph.on_nodes(mode)
        parts = Parts(graph)
        for node in graph.nodes:
            off = node.controlled and node.index not in on
            if node.is_junction:
                self._structure += junction_rows(node, self.many, off=off)
            elif node.kind in STORAGES:
                self._storage(node)
            else:
                self._element(node, parts.of(node, off, self.discrete))
        self.spread = self._peeled()
        rates: list[Expr] = [rate_name(s) for s in graph.storages]
        rates += [i.rate for i in graph.integrals]
        self.rates = [self.moving(e) for e in rates]

    @cached_property
    def carried(self) -> list[int]:
        """The places of what diodes that conduct carry, among the bond variables."""
        on = self.graph.on_nodes(self.mode)
        laws = (m.law for m in self.graph.machines if m.law is not None)
        nodes = (self.graph.nodes[a.node] for a in laws if a.kind in ("diode", "thyristor"))
        return [
            node.ends[0].bond + (self.many if node.kind == "1" else 0)
            for node in nodes
            if node.index in on and node.ends
        ]

    @cached_property
    def turns(self) -> list[Expr]:
        """What changes its sign where a law or a rate bends or jumps, of what moves."""
        return self._moving(turning)

    @cached_property
    def turned(self) -> Compiled:
        """The values of `turns`."""
        return Compiled(self.turns)

    @cached_property
    def leaps(self) -> frozenset[Expr]:
        """Those of `turns` at which something may jump."""
        return frozenset(self._moving(leaping))

    def _moving(self, found: Callable[[Expr], list[Expr]]) -> list[Expr]:
        every = {h: None for e in (*self.rows, *self.rates) for h in found(e)}
        return [h for h in every if any(not n.startswith("p:") for n in names(h))]

    def made(self, e: Expr) -> Expr:
        """Return an expression as it is in this mode, in names of parameters."""
        return without_pre(simplify(followed(configure(e, self.discrete))))

    def moving(self, e: Expr) -> Expr:
        """Return the same for a motion, in which what is read a priori is what there is."""
        return self.made(transform(e, lambda n: n.arg if isinstance(n, Pre) else n))

    def along(self, rows: Sequence[Expr]) -> list[Expr]:
        """Return the time derivatives of rows along the motion, with rates in names ``dw|e:3``."""
        found = []
        for e, total in zip(rows, self.along_held(rows), strict=True):
            for name in sorted(names(e)):
                if name.startswith(("e:", "f:")):
                    slope = differentiate(e, name)
                    total = Binary("+", total, Binary("*", slope, Name(RATE + name)))
            found.append(simplify(total))
        return found

    def along_held(self, rows: Sequence[Expr]) -> list[Expr]:
        """Return the time derivatives of rows along the motion with bond variables held."""
        return [self.made(partial_time(e, self.graph)) for e in rows]

    # -- rows

    def _peeled(self) -> NDArray[np.float64]:
        peeled = Peeling(Numbers({}), self._structure, 2 * self.many)
        for row in peeled.constraints:
            self._put(self._sum(row))
        free = peeled.free()
        spread = np.zeros((2 * self.many, len(free)))
        for k in range(2 * self.many):
            for j, c in peeled.reduce({k: 1.0}).items():
                spread[k, free.index(j)] = c
        return spread

    def _put(self, row: Expr, area: Expr | None = None) -> None:
        """Add a row, and what it says of impulse areas: the same without what is finite."""
        row = self.made(row)
        self.rows.append(row)
        self.areas.append(_homogeneous(row) if area is None else self.made(area))

    def _sum(self, row: Mapping[int, float]) -> Expr:
        total: Expr = Number(0.0)
        for k, c in row.items():
            total = Binary("+", total, Binary("*", tree_of(c), Name(self.bonds[k])))
        return simplify(total)

    def _storage(self, node: Node) -> None:
        for s in self.graph.storages:
            if s.node != node.index:
                continue
            kind = "e" if s.kind == "C" else "f"
            z: Expr = Name(f"{kind}:{s.bond}")
            if s.kind == "I" and s.sign < 0:
                z = Neg(z)
            self._put(Binary("-", z, stored_law(self.graph, s)), Name(f"{AREA}{kind}:{s.bond}"))

    def _element(self, node: Node, part: Part) -> None:
        if part.source is not None:
            name = self.bonds[part.source.bond + (0 if node.kind == "Se" else self.many)]
            self._put(Binary("-", Name(name), part.source.value), Name(AREA + name))
            return
        for row in part.power:
            if any(is_slotted(c) for c in row.values()):
                self._put(self._sum(row))
            else:
                self._structure.append(dict(row))
        for row in part.laws:
            self._put(self._sum(row))
        for dynamic in part.dynamic:
            free = dynamic.impulse_free
            if dynamic.kind == "law":
                # a resistor carries no impulse: both of its variables are finite
                area: Expr | None = Number(0.0)
                for name in free:
                    self.areas.append(Name(AREA + name))
            elif free:
                area = Name(AREA + free[0])
                other = dynamic.partner[0] if dynamic.partner is not None else ""
                slope = dynamic.frozen.get(other, Number(0.0))
                if reads_bonds(slope) and isolated(slope):
                    # as a resistor: a power of an impulse is beyond what is finite
                    self.areas.append(Name(AREA + other))
            else:
                area = None
            if area is None and dynamic.kind == "structure":
                frozen: Expr = Number(0.0)
                for name, c in dynamic.frozen.items():
                    frozen = Binary("+", frozen, Binary("*", c, Name(AREA + name)))
                area = frozen
            self._put(dynamic.expression, area)


def _homogeneous(row: Expr) -> Expr:
    """Return what a row with constant coefficients says of impulse areas."""
    read = {n: Name(AREA + n) for n in names(row) if n.startswith(("e:", "f:"))}
    return substitute(row, read)
