"""A flat graph with one more resistor, to see what that does to causality."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from hybond.causality.demands import imposing
from hybond.model.expressions import Binary, Name, Number
from hybond.model.graph import Bond, End, FlatGraph, Node
from hybond.model.kinds import RESISTORS, SOURCES
from hybond.model.laws import Law

Kind = Literal["0", "1"]


@dataclass(frozen=True, slots=True)
class Place:
    """Where a resistor goes."""

    kind: Kind
    """Of the junction it is connected to: in parallel (0) or in series (1) with what is there."""
    node: int = -1
    """That junction; -1 if a new one splits `bond`."""
    bond: int = -1
    """The bond that a new junction splits; -1 if there is no new one."""


@dataclass(frozen=True, slots=True)
class Grafted:
    """A graph with added resistors.

    `resistors` are the bonds of the added resistors; `inside` are those and the bonds between an
    old node and a new junction: strokes that may follow the mode without touching the old graph.
    """

    graph: FlatGraph
    resistors: tuple[int, ...] = ()
    inside: frozenset[int] = frozenset()


def with_resistor(before: Grafted, place: Place, *, side: int = -1) -> Grafted:
    """Return the graph with a resistor of 1, SI, at `place`.

    Parameters
    ----------
    side : int
        When a bond is split: the node whose half of the bond counts as inside.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("coil")
    >>> m.add(V=hb.Se(10), sw=hb.One(), l=hb.I(1))
    >>> m.bond("V -> sw", "sw -> l")
    >>> after = with_resistor(Grafted(m.flatten()), Place("0", bond=1), side=1)
    >>> [bond.name for bond in after.graph.bonds]
    ['V -> sw', 'sw -> n1', 'n1 -> l', 'n1 -> r1']
    """
    graph = before.graph
    nodes, bonds = list(graph.nodes), list(graph.bonds)
    storages = list(graph.storages)
    inside = set(before.inside)
    at, number = place.node, len(before.resistors) + 1
    if at < 0:
        at = len(nodes)
        old = bonds[place.bond]
        second = len(bonds)
        path = _new_name(f"n{number}", graph.by_path)
        nodes.append(
            Node(at, path, place.kind, (End(old.index, True, 0), End(second, False, 1)), old.domain)
        )
        tail, head = nodes[old.tail], nodes[old.head]
        bonds[old.index] = replace(old, head=at, name=f"{tail.path} -> {path}")
        bonds.append(Bond(second, at, old.head, f"{path} -> {head.path}", old.domain))
        ends = tuple(
            replace(e, bond=second) if e.bond == old.index and e.inward else e for e in head.ends
        )
        nodes[old.head] = replace(head, ends=ends)
        for k, s in enumerate(storages):
            if s.bond == old.index and s.node == old.head:
                storages[k] = replace(s, bond=second)
        inside.add(old.index if side == old.tail else second)
    resistor, last = len(nodes), len(bonds)
    path = _new_name(f"r{number}", graph.by_path)
    domain = nodes[at].domain
    law = Law("e", (Binary("*", Number(1.0), Name("law:f")),), ((1.0,),))
    nodes.append(Node(resistor, path, "R", (End(last, True, 0),), domain, law))
    bonds.append(Bond(last, at, resistor, f"{nodes[at].path} -> {path}", domain))
    junction = nodes[at]
    nodes[at] = replace(junction, ends=(*junction.ends, End(last, False, len(junction.ends))))
    inside.add(last)
    changed = replace(
        graph,
        nodes=tuple(nodes),
        bonds=tuple(bonds),
        storages=tuple(storages),
        by_path={n.path: n.index for n in nodes},
    )
    return Grafted(changed, (*before.resistors, last), frozenset(inside))


def held(grafted: Grafted, switch: int) -> Grafted:
    """Return the graph with the strokes pinned that let the resistor at a switch do its work.

    The controlled junction then tells its other bonds the same variable ON as it does OFF, and
    the resistor tells it.
    """
    graph = grafted.graph
    node = graph.nodes[switch]
    tells: Literal["e", "f"] = "e" if node.kind == "0" else "f"
    pins = dict(graph.pins)
    for end in node.ends:
        bond = graph.bonds[end.bond]
        far = graph.nodes[bond.tail if end.inward else bond.head]
        if far.kind not in SOURCES + RESISTORS:
            pins.setdefault(end.bond, imposing(end.inward, tells))
    return replace(grafted, graph=replace(graph, pins=pins))


def _new_name(wanted: str, taken: Mapping[str, int]) -> str:
    name = wanted
    while name in taken:
        name += "_"
    return name
