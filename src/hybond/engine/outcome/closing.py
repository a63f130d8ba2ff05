"""Laws that close on what flows on, or short what is charged: which two elements, and what serves.

A resistance acts on what is stored with its finite part alone. What stops a flow through an inertia
at once is an impulse, and no law gives one: it takes an instant that enters another structure, or
something beside the law that gives way.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from hybond.model.expressions import Binary, Expr, Neg
from hybond.model.expressions.tree import names
from hybond.model.graph import FlatGraph, Node
from hybond.model.kinds import RESISTORS

MANY = 3
"""Elements that a remedy names at the most."""


def against_closing(graph: FlatGraph, elements: Iterable[Node]) -> str:
    """Return what to try where a factor of these laws may have gone to zero; "" without any."""
    ways: dict[tuple[bool, bool], list[Node]] = {}
    for node in elements:
        for way in _ways(node):
            ways.setdefault(way, []).append(node)
    return "; ".join(_hint(graph, ways[way][:MANY], *way) for way in sorted(ways, reverse=True))


def against_stopping(graph: FlatGraph, path: str) -> str:
    """Return that where steps cannot follow this storage; "" where no law stops or shorts it."""
    nodes = [n for n in graph.nodes if any(path == k.path for k in stopped_by(graph, n))]
    return against_closing(graph, nodes)


def stopped_by(graph: FlatGraph, node: Node) -> list[Node]:
    """Return what a law stops where it lets nothing through, or shorts, the nearest first.

    From junction to junction, but not past one at which something gives way.
    """
    ways = _ways(node)
    if not ways:
        return []
    closes = any(way[0] for way in ways)
    wanted, across = ("I", "0") if closes else ("C", "1")
    yields = ("C", *RESISTORS) if closes else ("I", *RESISTORS)
    found: list[Node] = []
    seen = {node.index}
    reached = [node]
    while reached:
        here = reached.pop(0)
        beside = [n for n in _beside(graph, here) if n.index not in seen]
        if here.kind == across and any(n.kind in yields for n in beside):
            continue
        seen.update(n.index for n in beside)
        found += [n for n in beside if n.kind == wanted]
        reached += [n for n in beside if n.is_junction or n.kind == "TF"]
    return found


def _beside(graph: FlatGraph, node: Node) -> Iterator[Node]:
    for end in node.ends:
        bond = graph.bonds[end.bond]
        yield graph.nodes[bond.head if bond.tail == node.index else bond.tail]


def _hint(graph: FlatGraph, found: Sequence[Node], closes: bool, divided: bool) -> str:
    laws = " or ".join(n.path for n in found)
    stored = list(dict.fromkeys(n.path for k in found for n in stopped_by(graph, k)))
    which = f" ({stored[0]})" if stored else ""
    between = stored[0] if stored else "that"
    if closes:
        what = f"the opening of a valve that closes on what flows on{which}"
        more = f"put a leak (a G) beside it or a compliance (a C) between it and {between}"
        form = "f = ..., which is zero where it is closed"
    else:
        what = f"the resistance of what shorts what is charged{which}"
        more = f"put a resistance in series with it or an inertia (an I) between it and {between}"
        form = "e = ..., which is zero where it shorts"
    which = "divides" if divided else "multiplies"
    more = f"give it as {form}, and {more}" if divided else more
    return (
        f"if what {which} the law of {laws} goes to zero, as {what}, let it keep a little, as "
        f"max(1e-4, ...) does, or let a machine switch its junction OFF a little before, or {more}"
    )


def _ways(node: Node) -> set[tuple[bool, bool]]:
    """Return whether a law lets nothing through, or shorts, where a factor is zero that varies.

    And whether that factor divides. It is another than what the law reads of its own bond.
    """
    if node.kind not in RESISTORS or node.law is None or node.law.matrix is not None:
        return set()
    if len(node.law.expressions) != 1:
        return set()
    own = {"law:e", "law:f"}
    return {
        ((node.law.output == "f") != divides, divides)
        for factor, divides in _factors(node.law.expressions[0], False)
        if names(factor) and not own & names(factor)
    }


def _factors(e: Expr, below: bool) -> list[tuple[Expr, bool]]:
    """Return the factors of a product, and whether each stands below the line."""
    match e:
        case Binary("*", left, right):
            return [*_factors(left, below), *_factors(right, below)]
        case Binary("/", left, right):
            return [*_factors(left, below), *_factors(right, not below)]
        case Neg(inner):
            return _factors(inner, below)
    return [(e, below)]
