"""Islands: parts of a graph between which no rounding passes, whatever is ON.

Nothing that one of them stores, and no rounding of it, is ever in another: what is small there is
measured by what is there. What a mode joins lies between them and the parts that remain one with
all controlled junctions OFF: `engine/mode/digits/connected`.
"""

from __future__ import annotations

from collections.abc import Iterator

from hybond.engine.tables.columns import ModelTables
from hybond.model.expressions import Binary, Expr, names, posterior_names
from hybond.model.expressions.tree import walk
from hybond.model.graph import FlatGraph, Node


def put_islands(t: ModelTables) -> None:
    """Put the island of each bond into the tables, and the part that remains, whatever is OFF."""
    g = t.graph
    own = islands(g)
    t.numbers["islands"] = max(own, default=0) + 1
    t.ints["bond_island"] = own
    base = islands(g, switched=False)
    t.numbers["bases"] = max(base, default=0) + 1
    t.ints["bond_base"] = base
    held = [base[s.bond] for s in g.storages]
    number = {b: k for k, b in enumerate(dict.fromkeys(held))}
    t.numbers["most_parts"] = len(number)
    t.ints["storage_base"] = [number[b] for b in held]


def islands(g: FlatGraph, *, switched: bool = True) -> list[int]:
    """Return the number of the island of each bond, in the order of their first bonds.

    Without what is `switched` they are parts that remain one with all controlled junctions OFF.

    Bonds that meet at a node are in one. So are those that a law reads: what it says follows from
    them at once. What is stored elsewhere is a factor, which is as exact as what it multiplies,
    unless a law adds it up: a difference of what is large leaves rounding of that. Friction in a
    plane is one force, whatever bodies feel it.
    """
    first = list(range(len(g.bonds)))

    def root(b: int) -> int:
        while first[b] != b:
            first[b] = first[first[b]]
            b = first[b]
        return b

    for group in _joined(g, switched):
        for b in group[1:]:
            one, other = sorted((root(group[0]), root(b)))
            first[other] = one
    roots = [root(b) for b in range(len(g.bonds))]
    number = {b: k for k, b in enumerate(dict.fromkeys(roots))}
    return [number[b] for b in roots]


def _joined(g: FlatGraph, switched: bool) -> Iterator[list[int]]:
    """Yield bonds that are in one island."""
    for node in g.nodes:
        if switched or not (node.controlled and node.is_junction):
            yield [end.bond for end in node.ends] + _bonds_read(g, node)
    for machine in g.machines:
        laws = machine.law.junctions if machine.law is not None else ()
        disk: list[int] = []
        for law in laws:
            own = [end.bond for end in g.nodes[law.node].ends]
            limits = [e for e in (law.limit, law.breakaway) if e is not None]
            read = [b for e in limits for b in _bonds_of(e)]
            if switched or read:
                yield own + read
            disk += own if law.planar else []
        yield disk


def _bonds_read(g: FlatGraph, node: Node) -> list[int]:
    """Return bonds that the law of a node reads, and those of what it adds up."""
    found: list[int] = []
    for e in node.law.expressions if node.law is not None else ():
        found += _bonds_of(e)
        if any(isinstance(part, Binary) and part.op in "+-" for part, _ in walk(e)):
            stored = [n for n in posterior_names(e) if n.startswith("x:")]
            found += [g.storages[int(n[2:])].bond for n in sorted(stored)]
    return found


def _bonds_of(e: Expr) -> list[int]:
    """Return the bonds whose efforts or flows an expression reads."""
    return [int(n[2:]) for n in sorted(names(e)) if n.startswith(("e:", "f:"))]
