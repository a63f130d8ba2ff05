"""What a picture of a bond graph shows, before it has a place: symbols and arrows.

A switched element is drawn as one symbol: the hidden junction that stands for its switch, and
the bond between the two, are merged into it. A junction with a law has the law's name beside it;
the source by which the law is opened into ordinary parts is no element of the model and not drawn.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from hybond.draw.badges import Badge
from hybond.errors import UsageError
from hybond.model.graph import FlatGraph, Mode, Node
from hybond.names import did_you_mean


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
    derivative: bool = False
    """A storage in derivative causality."""
    badge: Badge | None = None
    law: str = ""
    """The law of a junction that has one: ``diode``."""

    @property
    def is_junction(self) -> bool:
        """Whether it is a 0- or a 1-junction."""
        return self.kind in ("0", "1")


@dataclass(frozen=True, slots=True)
class Arrow:
    """A bond as drawn, between two symbols."""

    tail: int
    head: int
    """`tail` and `head`: indices of symbols."""
    name: str
    number: str = ""
    strokes: tuple[int, ...] = ()
    dashed: tuple[int, ...] = ()
    """`strokes` and `dashed`: the ends (0 tail, 1 head) with a solid and with a dashed stroke."""
    late: tuple[int, ...] = ()
    """The ends at which a stroke means derivative causality of a storage."""
    integral: bool = False
    conflict: bool = False
    off: bool = False
    region: bool = False
    """It lies in a region of dynamic causality, which is shaded."""
    emphasis: bool = False
    """It is pointed out: its stroke differs from that of the reference mode."""


@dataclass(frozen=True, slots=True)
class Frame:
    """What is drawn around the symbols of a part that is open."""

    path: str
    members: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Sketch:
    """Symbols, arrows, and the words around them."""

    symbols: tuple[Symbol, ...]
    arrows: tuple[Arrow, ...]
    title: str = ""
    caption: str = ""
    pins: dict[int, tuple[float, float]] = field(default_factory=dict)
    left_out: int = 0
    """How many symbols it is drawn without, because they decide nothing."""
    frames: tuple[Frame, ...] = ()


def sketch(
    graph: FlatGraph,
    *,
    mode: Mode | None = None,
    causality: Causality | None = None,
    dynamic_bonds: Collection[int] = (),
    emphasis: Collection[int] = (),
    marks: Mapping[str, Badge] | None = None,
    numbers: bool = False,
    title: bool = True,
    caption: str | None = None,
) -> Sketch:
    """Return what a drawing of `graph` shows; the parameters are those of `draw`.

    `emphasis` are bonds to point out; `caption` replaces the names of the states of `mode`.
    """
    off = graph.off_nodes(mode) if mode is not None else frozenset()
    inner = _inner_bonds(graph)
    element_of = {s: e for s, (e, _) in inner.items()}
    implied = _implied(graph)
    hidden_bonds = {b for _, b in inner.values()} | {b for _, b in implied.values()}
    shown = [n for n in graph.nodes if n.index not in element_of and n.index not in implied]
    place = {n.index: k for k, n in enumerate(shown)}
    switch_of = {e: s for s, e in element_of.items()}

    derivative = {graph.storages[k].node for k in (causality.derivative if causality else ())}
    owners = element_of | {s: j for s, (j, _) in implied.items()}
    badges = _badges(graph, marks or {}, owners)
    symbols = []
    for node in shown:
        switch = graph.nodes[switch_of.get(node.index, node.index)]
        symbols.append(
            _symbol(
                graph,
                node,
                switch,
                off=switch.index in off,
                derivative=node.index in derivative,
                badge=badges.get(node.index),
            )
        )

    red, idle = _conflict_bonds(causality)
    derived = _derivative_bonds(graph, causality, inner)
    preferred = _integral_ends(graph, inner)
    dynamic = set(dynamic_bonds)
    arrows = []
    for bond in graph.bonds:
        if bond.index in hidden_bonds:
            continue
        strokes: tuple[int, ...] = ()
        dashed: tuple[int, ...] = ()
        if causality is not None:
            strokes = (causality.strokes[bond.index],)
        if bond.index in dynamic:
            dashed = tuple(end for end in (0, 1) if end not in strokes)
        late: tuple[int, ...] = ()
        if bond.index in derived:
            late = strokes
        elif bond.index in preferred:
            late = tuple(end for end in dashed if end != preferred[bond.index])
        ends = (element_of.get(bond.tail, bond.tail), element_of.get(bond.head, bond.head))
        behind = [b for s, (_, b) in inner.items() if s in (bond.tail, bond.head)]
        arrows.append(
            Arrow(
                tail=place[ends[0]],
                head=place[ends[1]],
                name=bond.name,
                number=str(bond.index + 1) if numbers else "",
                strokes=strokes,
                dashed=dashed,
                late=late,
                integral=bond.index in preferred and bool(strokes) and strokes[0] not in late,
                conflict=not red.isdisjoint([bond.index, *behind]),
                off=bond.tail in off or bond.head in off or bond.index in idle,
                region=bond.index in dynamic,
                emphasis=bond.index in emphasis,
            )
        )
    if caption is None:
        caption = mode_caption(graph, mode) if mode is not None else ""
    paths = {s.path: k for k, s in enumerate(symbols)}
    return Sketch(
        tuple(symbols),
        tuple(arrows),
        title=(graph.title or graph.name) if title else "",
        caption=caption,
        pins={paths[p]: (float(x), float(y)) for p, (x, y) in graph.layout.items() if p in paths},
    )


def mode_caption(graph: FlatGraph, mode: Mode) -> str:
    """Return a mode as it is written on the command line: ``S1 = on, S2 = off``."""
    return ", ".join(f"{m} = {state}" for m, state in graph.mode_names(mode).items())


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


def _implied(graph: FlatGraph) -> dict[int, tuple[int, int]]:
    """Return for each source that a law brought in its junction and the bond between them."""
    found = {}
    for node in graph.nodes:
        if node.implied:
            bond = graph.bonds[node.ends[0].bond]
            junction = bond.tail if bond.head == node.index else bond.head
            found[node.index] = (junction, bond.index)
    return found


def _symbol(
    graph: FlatGraph,
    node: Node,
    switch: Node,
    *,
    off: bool,
    derivative: bool,
    badge: Badge | None,
) -> Symbol:
    said = node.said
    parameter = typeset(said)
    if node.kind == "G" and parameter:
        # Drawn as R like in the textbooks: the value must say that it is a conductance.
        parameter = f"G = {parameter}"
    owner = None if switch.machine is None else graph.machines[switch.machine]
    law = "" if owner is None or owner.law is None else owner.law.kind
    # the law's own machine is named like its junction; the second of a pair has that of the first
    machine = "" if owner is None or (law and owner.path == switch.path) else owner.path
    about = f"{node.path}: {node.about.meaning}"
    if said:
        about += f", {said}"
    if machine:
        about += f"; switched by {machine}"
    if law:
        about += f"; {law}"
    if derivative:
        about += "; in derivative causality"
    if badge is not None:
        about += f"; {badge.text}"
    return Symbol(
        path=node.path,
        kind=node.kind,
        letters=node.about.symbol,
        parameter=parameter,
        about=about,
        controlled=switch.controlled,
        machine=machine,
        off=off,
        derivative=derivative,
        badge=badge,
        law=law,
    )


_POWER = re.compile(r"\^(\(-?\d+\)|-?\d+)(?![\d.])")
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


_QUANTITY = re.compile(r"(-?\d[\d.]*(?:e[-+]?\d+)?)( [^\W\d].*)?")
_MICRO = re.compile(r"\bu(?=(?:[A-Zgms]|Wb|Hz|ohm|bar)\b)")
_OHM = re.compile(r"(?<![^\W_])([pnuµmkMG]?)ohm\b")
_DIGITS = 7
"""Most digits of a number; a value that was computed has more."""


def _of_quantity(text: str) -> str:
    """Write a number with a unit, ``22.2222222222222 uohm``, as ``22.2222 µΩ``."""
    found = _QUANTITY.fullmatch(text.strip())
    if found is None:
        return text
    number, unit = found[1], found[2] or ""
    if sum(map(str.isdigit, number.partition("e")[0])) > _DIGITS:
        number = f"{float(number):.6g}"
    return number + _OHM.sub(r"\1Ω", _MICRO.sub("µ", unit))


def typeset(text: str) -> str:
    """Write ``m/(N*s^2)`` the way it is printed: ``m/(N·s²)``.

    Examples
    --------
    >>> typeset("10 m/(N*s^2)"), typeset("3 kg*m**-1"), typeset("x^2.5")
    ('10 m/(N·s²)', '3 kg·m⁻¹', 'x^2.5')
    >>> typeset("22.2222222222222 mohm"), typeset("100 uH"), typeset("u*2")
    ('22.2222 mΩ', '100 µH', 'u·2')
    """
    text = _of_quantity(text)
    text = text.replace("**", "^")
    text = _POWER.sub(lambda found: found[1].strip("()").translate(_RAISED), text).replace("*", "·")
    return " ".join(text.split())


def _badges(
    graph: FlatGraph, marks: Mapping[str, Badge], element_of: Mapping[int, int]
) -> dict[int, Badge]:
    """Return the badges by node; one on a hidden switch or implied source goes to its owner.

    Raises
    ------
    UsageError
        HB-D106.
    """
    by_path = {node.path: node.index for node in graph.nodes}
    found = {}
    for path, badge in marks.items():
        if path not in by_path:
            raise UsageError(
                f"there is no element or junction {path!r} to mark",
                code="HB-D106",
                where=path,
                hint=did_you_mean(path, by_path) or "name a node of the graph",
            )
        found[element_of.get(by_path[path], by_path[path])] = badge
    return found


def _conflict_bonds(causality: Causality | None) -> tuple[set[int], set[int]]:
    """Return the bonds that are in conflict, and those that only carry nothing.

    Where a junction that is OFF meets another each says that there is no flow, or no effort: that
    is said twice and no conflict, as between diodes that all block.
    """
    found: set[int] = set()
    idle: set[int] = set()
    for conflict in causality.conflicts if causality is not None else ():
        bonds = getattr(conflict, "bonds", None)
        if bonds is None:
            bonds = (getattr(conflict, "bond", None),)
        rules = {getattr(getattr(conflict, o, None), "rule", "") for o in ("origin_a", "origin_b")}
        gives = getattr(conflict, "gives", ())
        twice = rules == {"off"} and len(set(gives)) == 1
        (idle if twice else found).update(b for b in bonds if isinstance(b, int))
    return found, idle


def _derivative_bonds(
    graph: FlatGraph, causality: Causality | None, inner: dict[int, tuple[int, int]]
) -> set[int]:
    """Return the bonds of storages in derivative causality, within and outside a switch."""
    late = {graph.storages[k].bond for k in (causality.derivative if causality else ())}
    for switch, (_, bond) in inner.items():
        if bond in late:
            late.update(e.bond for e in graph.nodes[switch].ends)
    return late


def _integral_ends(graph: FlatGraph, inner: dict[int, tuple[int, int]]) -> dict[int, int]:
    """Return the bonds of storages, with the end at which a stroke means integral causality."""
    found = {}
    for storage in graph.storages:
        bond = graph.bonds[storage.bond]
        at_storage = 0 if bond.tail == storage.node else 1
        # An I receives effort, a C gives it.
        found[bond.index] = at_storage if storage.kind == "I" else 1 - at_storage
    for switch, (element, inside) in inner.items():
        if inside in found:
            wants_effort = graph.bonds[inside].tail == element
            wants_effort = (found[inside] == 0) == wants_effort
            for end in graph.nodes[switch].ends:
                if end.bond != inside:
                    near = 0 if graph.bonds[end.bond].tail == switch else 1
                    found[end.bond] = near if wants_effort else 1 - near
    return found
