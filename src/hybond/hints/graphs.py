"""Hints at the graph: arrows, signs, unused junctions, parts that float, no ground."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hybond.model.arrays import base_of, is_array
from hybond.model.builder import Model
from hybond.model.checked import Hint
from hybond.model.expressions import Expr, Number, names
from hybond.model.graph import FlatGraph, Node
from hybond.model.kinds import RESISTORS, STORAGES, TWO_PORTS

ROUNDING = 1e-12
"""Part of the entries of a field below which it takes and gives nothing."""


def graph_hints(model: Model, graph: FlatGraph) -> Iterator[Hint]:
    """Yield the hints at nodes and bonds of the model itself, not of its submodels."""
    own = [n for n in _own(model, graph) if not n.hidden and not n.implied]
    for node in own:
        if node.kind in STORAGES + RESISTORS:
            yield from _arrows(graph, node)
        if node.kind in RESISTORS:
            yield from _gives(node)
        if node.is_junction:
            yield from _alone(node)
    for region in _regions(graph, through=True):
        yield from _still(graph, region)
    for region in _regions(graph, through=False):
        yield from _ungrounded(graph, region)


def _own(model: Model, graph: FlatGraph) -> Iterator[Node]:
    """Yield the nodes of the model itself; of an array one speaks for all."""
    arrays = {base_of(key) for key in model.elements if is_array(key)}
    for node in graph.nodes:
        base = base_of(node.path)
        if node.path in model.elements:
            yield node
        elif base in arrays and "." not in node.path:
            arrays.discard(base)
            yield node


def _arrows(graph: FlatGraph, node: Node) -> Iterator[Hint]:
    """A storage or a loss whose half arrow points away counts what it gives as taken."""
    for end in node.ends:
        if end.inward:
            continue
        bond = graph.bonds[end.bond]
        other = graph.nodes[bond.head].path
        what = "stores" if node.kind in STORAGES else "takes"
        yield Hint(
            "HB-H101",
            f"elements.{node.path}",
            f"the half arrow of {bond.name!r} points away from {node.kind} {node.path!r}: its "
            f"law then {what} with the opposite sign of what the arrow counts",
            f'turn it round: "{other} -> {node.path}"',
        )


def _gives(node: Node) -> Iterator[Hint]:
    """A resistance below zero gives energy, and so does a field that does for some of its flows."""
    matrix = node.law.matrix if node.law else None
    if not matrix:
        return
    size = max(abs(entry) for row in matrix for entry in row)
    sums = [
        [a + b for a, b in zip(row, column, strict=True)]
        for row, column in zip(matrix, zip(*matrix, strict=True), strict=True)
    ]
    if float(np.linalg.eigvalsh(sums)[0]) >= -ROUNDING * size:
        return
    what = f"{matrix[0][0]:g} is negative" if len(matrix) == 1 else "its matrix is not positive"
    yield Hint(
        "HB-H112",
        f"elements.{node.path}",
        f"{node.kind} {node.path!r} gives energy where others take it: {what}",
        "look at its sign; a source of energy is Se or Sf, which says so in the balance",
    )


def _alone(node: Node) -> Iterator[Hint]:
    where = f"elements.{node.path}"
    if not node.ends and node.controlled:
        return  # its machine is told of
    if not node.ends:
        yield Hint(
            "HB-H103",
            where,
            f"the {node.kind}-junction {node.path!r} has no bond",
            "connect it, or take it out",
        )
    elif len(node.ends) == 1 and not node.controlled:
        zero = "flow" if node.kind == "0" else "effort"
        yield Hint(
            "HB-H103",
            where,
            f"the {node.kind}-junction {node.path!r} has one bond, whose {zero} it makes zero",
            f"connect what is missing there, or write {'Sf' if zero == 'flow' else 'Se'} = 0",
        )


def _regions(graph: FlatGraph, *, through: bool) -> list[list[Node]]:
    """Return the nodes that bonds join, through two-ports or only up to them."""
    seen: set[int] = set()
    found = []
    for first in graph.nodes:
        if first.index in seen or not first.ends or (not through and first.kind in TWO_PORTS):
            continue
        region, waiting = [first], [first.index]
        seen.add(first.index)
        while waiting:
            for end in graph.nodes[waiting.pop()].ends:
                bond = graph.bonds[end.bond]
                for k in (bond.tail, bond.head):
                    if k in seen or (not through and graph.nodes[k].kind in TWO_PORTS):
                        continue
                    seen.add(k)
                    region.append(graph.nodes[k])
                    waiting.append(k)
        found.append(region)
    return found


def _still(graph: FlatGraph, region: list[Node]) -> Iterator[Hint]:
    """A part with no source, no start and nothing that is read from elsewhere stays at rest."""
    if len(region) == len([n for n in graph.nodes if n.ends]):
        return
    inside = {n.index for n in region}
    if any(s.start != 0.0 for s in graph.storages if s.node in inside):
        return
    for node in region:
        if node.kind in ("Se", "Sf"):
            law = node.law
            trees = () if law is None else law.expressions
            if any(not isinstance(e, Number) or e.value != 0.0 for e in trees):
                return
        if node.is_junction and node.controlled:
            return
        if node.kind not in ("Se", "Sf") and node.law and any(map(_reads, node.law.expressions)):
            return
    shown = [n.path for n in region if not n.is_junction and not n.hidden][:4]
    if not shown:
        return
    yield Hint(
        "HB-H104",
        f"elements.{shown[0]}",
        f"nothing drives {', '.join(shown)}, which no bond joins to the rest: no source, no start "
        "other than zero, no signal",
        "join it to the rest by a bond, give it a source or a start, or take it out",
    )


def _reads(e: Expr) -> bool:
    return any(not name.startswith("law:") for name in names(e))


def _ungrounded(graph: FlatGraph, region: list[Node]) -> Iterator[Hint]:
    """Efforts of 0-junctions count from nowhere if all of them may be raised by the same amount.

    That is so if every 1-junction between them takes one effort for each that it gives, and
    nothing else stands at a 0-junction.
    """
    zeros = sorted((n for n in region if n.kind == "0"), key=lambda n: n.index)
    if len(zeros) < 2 or any(n.controlled or n.hidden or n.implied for n in region):
        return
    if zeros[0].domain.name != "electrical":
        return
    for node in region:
        balance = 0
        for end in node.ends:
            bond = graph.bonds[end.bond]
            other = graph.nodes[bond.tail if bond.head == node.index else bond.head]
            if node.kind == "0" and not other.is_junction:
                return  # its effort counts from where that stands
            if node.kind == "1":
                if other.kind == "1":
                    return
                balance += end.sign * (other.kind == "0")
        if node.kind == "1" and balance:
            return
    names_ = ", ".join(n.path for n in zeros[:4]) + (", ..." if len(zeros) > 4 else "")
    yield Hint(
        "HB-H105",
        f"elements.{zeros[0].path}",
        f"the circuit of {names_} has no ground: all its voltages may be raised together",
        'join one node to a ground: { submodel = "electrical.ground" }, or leave one node out',
    )
