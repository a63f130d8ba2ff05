"""What a picture of a bond graph shows, before it has a place: symbols and arrows.

A switched element is drawn as one symbol: the hidden junction that stands for its switch, and
the bond between the two, are merged into it.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from typing import Protocol

from hybond.model.graph import FlatGraph, Mode, Node


class Causality(Protocol):
    """What a drawing reads of a causality assignment."""

    @property
    def strokes(self) -> tuple[int, ...]:
        """Per bond: 0, stroke at the tail; 1, at the head."""

    @property
    def derivative(self) -> Collection[int]:
        """Storages in derivative causality."""

    @property
    def conflicts(self) -> Collection[object]:
        """Conflicts, with `bonds` or `bond`."""


@dataclass(frozen=True, slots=True)
class Symbol:
    """A node as drawn."""

    path: str
    kind: str
    letters: str
    parameter: str = ""
    about: str = ""
    """Text that appears when the pointer rests on the node."""
    controlled: bool = False
    machine: str = ""
    off: bool = False

    @property
    def is_junction(self) -> bool:
        """Whether it is a 0- or a 1-junction."""
        return self.kind in ("0", "1")


@dataclass(frozen=True, slots=True)
class Arrow:
    """A bond as drawn, between two symbols; `strokes` are ends (0 tail, 1 head)."""

    tail: int
    head: int
    name: str
    number: str = ""
    strokes: tuple[int, ...] = ()
    dynamic: bool = False
    derivative: bool = False
    conflict: bool = False
    off: bool = False


@dataclass(frozen=True, slots=True)
class Sketch:
    """Symbols, arrows, and the words around them."""

    symbols: tuple[Symbol, ...]
    arrows: tuple[Arrow, ...]
    title: str = ""
    caption: str = ""
    pins: dict[int, tuple[float, float]] = field(default_factory=dict)


def sketch(
    graph: FlatGraph,
    *,
    mode: Mode | None = None,
    causality: Causality | None = None,
    dynamic_bonds: Collection[int] = (),
    numbers: bool = False,
    title: bool = True,
) -> Sketch:
    """Return what a drawing of `graph` shows; the parameters are those of `draw`."""
    off = graph.off_nodes(mode) if mode is not None else frozenset()
    inner = _inner_bonds(graph)
    element_of = {s: e for s, (e, _) in inner.items()}
    hidden_bonds = {b for _, b in inner.values()}
    shown = [n for n in graph.nodes if n.index not in element_of]
    place = {n.index: k for k, n in enumerate(shown)}
    switch_of = {e: s for s, e in element_of.items()}

    symbols = []
    for node in shown:
        switch = graph.nodes[switch_of.get(node.index, node.index)]
        symbols.append(_symbol(graph, node, switch, off=switch.index in off))

    red = _conflict_bonds(causality)
    late = _derivative_bonds(graph, causality, inner)
    dynamic = set(dynamic_bonds)
    arrows = []
    for bond in graph.bonds:
        if bond.index in hidden_bonds:
            continue
        strokes: tuple[int, ...] = ()
        if bond.index in dynamic and mode is None:
            strokes = (0, 1)  # Margetts: both ends that the stroke may take
        elif causality is not None:
            strokes = (causality.strokes[bond.index],)
        ends = (element_of.get(bond.tail, bond.tail), element_of.get(bond.head, bond.head))
        behind = [b for s, (_, b) in inner.items() if s in (bond.tail, bond.head)]
        arrows.append(
            Arrow(
                tail=place[ends[0]],
                head=place[ends[1]],
                name=bond.name,
                number=str(bond.index + 1) if numbers else "",
                strokes=strokes,
                dynamic=bond.index in dynamic,
                derivative=bond.index in late,
                conflict=not red.isdisjoint([bond.index, *behind]),
                off=bond.tail in off or bond.head in off,
            )
        )
    names = graph.mode_names(mode) if mode is not None else {}
    paths = {s.path: k for k, s in enumerate(symbols)}
    return Sketch(
        tuple(symbols),
        tuple(arrows),
        title=(graph.title or graph.name) if title else "",
        caption=", ".join(f"{machine} = {state}" for machine, state in names.items()),
        pins={paths[p]: (float(x), float(y)) for p, (x, y) in graph.layout.items() if p in paths},
    )


def _inner_bonds(graph: FlatGraph) -> dict[int, tuple[int, int]]:
    """Return for each hidden junction its element and the bond between them."""
    found: dict[int, tuple[int, int]] = {}
    for node in graph.nodes:
        if not node.hidden:
            continue
        for end in node.ends:
            bond = graph.bonds[end.bond]
            other = bond.tail if bond.head == node.index else bond.head
            # The element is named like its switch, less the last part of the path.
            if graph.nodes[other].path == node.path.rpartition(".")[0]:
                found[node.index] = (other, bond.index)
    return found


def _symbol(graph: FlatGraph, node: Node, switch: Node, *, off: bool) -> Symbol:
    parameter = _typeset(node.label)
    if node.kind == "G" and parameter:
        # Drawn as R like in the textbooks: the value must say that it is a conductance.
        parameter = f"G = {parameter}"
    machine = graph.machines[switch.machine].path if switch.machine is not None else ""
    about = f"{node.path}: {node.about.meaning}"
    if node.label:
        about += f", {node.label}"
    if machine:
        about += f"; switched by {machine}"
    return Symbol(
        path=node.path,
        kind=node.kind,
        letters=node.about.symbol,
        parameter=parameter,
        about=about,
        controlled=switch.controlled,
        machine=machine,
        off=off,
    )


def _typeset(text: str) -> str:
    """Write ``m/(N*s^2)`` the way it is printed: ``m/(N·s²)``.

    Examples
    --------
    >>> _typeset("10 m/(N*s^2)")
    '10 m/(N·s²)'
    """
    for plain, printed in (("**", "^"), ("^2", "²"), ("^3", "³"), ("*", "·")):
        text = text.replace(plain, printed)
    return " ".join(text.split())


def _conflict_bonds(causality: Causality | None) -> set[int]:
    found: set[int] = set()
    for conflict in causality.conflicts if causality is not None else ():
        bonds = getattr(conflict, "bonds", None)
        if bonds is None:
            bonds = (getattr(conflict, "bond", None),)
        found.update(b for b in bonds if isinstance(b, int))
    return found


def _derivative_bonds(
    graph: FlatGraph, causality: Causality | None, inner: dict[int, tuple[int, int]]
) -> set[int]:
    """Return the bonds of storages in derivative causality, outside a switch."""
    late = {graph.storages[k].bond for k in (causality.derivative if causality else ())}
    for switch, (_, bond) in inner.items():
        if bond in late:
            late.update(e.bond for e in graph.nodes[switch].ends)
    return late
