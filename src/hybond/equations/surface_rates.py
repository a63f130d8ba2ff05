"""Surfaces of the second kind: where a switching function stands still on its own surface.

Behind a filter, ``g' `` is the same on both sides of ``g = 0``, and its rate is not: switches that
push ``g`` back and forth do so ever faster, and come to rest where ``g`` and ``g'`` are zero. A
machine slides there as it does on a surface of its own, that of ``g'``.
"""

from __future__ import annotations

from dataclasses import replace

from hybond.equations.calculus import rate_name
from hybond.equations.storage import stiffness
from hybond.equations.surfaces import Surface, surfaces_of
from hybond.model.expressions import Binary, Expr, Name, Neg, Number, differentiate, names, simplify
from hybond.model.graph import FlatGraph, Storage

READ = ("x:", "s:", "e:", "f:", "u:", "time")
"""What a function may read that has a rate here."""


def all_surfaces(graph: FlatGraph) -> tuple[Surface, ...]:
    """Return the switching surfaces of a graph, then those of the rates of their functions."""
    first = surfaces_of(graph)
    behind = _Behind(graph)
    found = list(first)
    for k, s in enumerate(first):
        rate = None if s.up_rest or s.down_rest else _rate(s.g, behind)
        if rate is not None:
            found.append(replace(s, g=rate, text=f"{s.text} and its rate", rate_of=k))
    return tuple(found)


def _rate(g: Expr, behind: _Behind) -> Expr | None:
    """Return the rate of a function by bond variables; None if it reads what has none."""
    total: Expr = Number(0.0)
    for name in sorted(names(g)):
        rate = behind.rate(name) if name.startswith(READ) else None
        if rate is None:
            return None
        total = Binary("+", total, Binary("*", differentiate(g, name), rate))
    return simplify(total)


class _Behind:
    """The storages that give bond variables their values, whatever is switched."""

    def __init__(self, graph: FlatGraph) -> None:
        self.graph = graph
        self._own = {(s.bond, "e" if s.kind == "C" else "f"): s for s in graph.storages}

    def rate(self, name: str) -> Expr | None:
        """Return how fast a stored quantity, a signal or a bond variable moves."""
        kind, _, index = name.partition(":")
        if kind == "time":
            return Number(1.0)
        if kind == "u":
            return Name(f"du:{index}")
        if kind == "s":
            return self.graph.integrals[int(index)].rate
        if kind == "x":
            return rate_name(self.graph.storages[int(index)])
        storage = self._storage(int(index), kind)
        if storage is None:
            return None
        node = self.graph.nodes[storage.node]
        total: Expr = Number(0.0)
        for other in self.graph.storages:
            if other.node == storage.node:
                slope = stiffness(node, storage.port, other.port, self.graph)
                total = Binary("+", total, Binary("*", slope, rate_name(other)))
        return Neg(total) if kind == "f" and storage.sign < 0 else total

    def _storage(self, bond: int, kind: str) -> Storage | None:
        """Return the storage behind an effort or a flow, along junctions that are always ON."""
        joins = "0" if kind == "e" else "1"
        seen, todo = {bond}, [bond]
        while todo:
            here = todo.pop()
            if (here, kind) in self._own:
                return self._own[here, kind]
            for at in (self.graph.bonds[here].tail, self.graph.bonds[here].head):
                node = self.graph.nodes[at]
                if node.is_junction and node.kind == joins and not node.controlled:
                    new = [end.bond for end in node.ends if end.bond not in seen]
                    seen.update(new)
                    todo += new
        return None
