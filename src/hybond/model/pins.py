"""The strokes and the reference mode that a modeller fixes, from names to indices."""

from __future__ import annotations

from collections.abc import Mapping

from hybond.errors import ModelError
from hybond.model.graph import Bond, FlatGraph, Machine, Mode
from hybond.model.hierarchy import Opened, WrittenPin
from hybond.model.resolve import Resolver
from hybond.names import did_you_mean, join


def pins_of(opened: Opened, resolver: Resolver) -> dict[int, int]:
    """Return the pinned strokes: bond index to 0 (stroke at the tail) or 1 (at the head).

    Raises
    ------
    ModelError
        HB-M121 an ambiguous bond, HB-M180 no such bond, HB-M181 a node that the bond does not
        end at, or one bond pinned at both ends.
    """
    found: dict[int, int] = {}
    for pin in opened.pins:
        where = join(pin.scope.prefix, f"causality.pins.{pin.bond!r}")
        bond = _bond(pin, resolver, where)
        stroke = _end(bond, pin, resolver, where)
        if found.setdefault(bond.index, stroke) != stroke:
            raise ModelError(
                f"the bond {bond.name!r} is pinned at both ends",
                code="HB-M181",
                where=where,
                hint="a bond has one stroke: keep one of the two pins",
            )
    return found


def reference_of(opened: Opened, machines: tuple[Machine, ...]) -> Mode | None:
    """Return the reference mode that the model gives; machines it leaves out are in their start.

    Raises
    ------
    ModelError
        HB-M144 for a machine or state that does not exist.
    """
    if not opened.reference:
        return None
    mode = [m.start for m in machines]
    by_path = {m.path: m for m in machines}
    for path, state in opened.reference.items():
        machine = by_path.get(path)
        if machine is None or state not in machine.states:
            known = tuple(by_path) if machine is None else machine.states
            raise ModelError(
                f"no machine {path!r}"
                if machine is None
                else f"{state!r} is not a state of this machine",
                code="HB-M144",
                where=f"causality.reference.{path}",
                hint=did_you_mean(path if machine is None else state, known),
            )
        mode[machine.index] = machine.states.index(state)
    return tuple(mode)


def pin_names(graph: FlatGraph, pins: Mapping[int, int] | None = None) -> dict[str, str]:
    """Return pins (those of `graph` if none are given) as ``{bond: node at the stroke}``.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model()
    >>> m.add(V=hb.Se(1), r=hb.R(1), s=hb.R(2), node=hb.One())
    >>> m.bond("V -> node -> r", "node -> s")
    >>> m.pin("node -> r", at="node")
    >>> graph = m.flatten()
    >>> dict(graph.pins), pin_names(graph)
    ({1: 0}, {'node -> r': 'node'})
    """
    found = {}
    for index, stroke in (graph.pins if pins is None else pins).items():
        bond = graph.bonds[index]
        found[bond.name] = graph.nodes[bond.head if stroke else bond.tail].path
    return found


def _bond(pin: WrittenPin, resolver: Resolver, where: str) -> Bond:
    bonds = resolver.bonds_called(pin.bond, pin.scope)
    if len(bonds) == 1:
        return resolver.bonds[bonds[0]]
    if bonds:
        raise ModelError(
            f"{len(bonds)} bonds are called {pin.bond!r}",
            code="HB-M121",
            where=where,
            hint=f'label them: "b1: {pin.bond}"',
        )
    within = _within(pin)
    known = [b.name.removeprefix(within) for b in resolver.bonds if b.name.startswith(within)]
    raise ModelError(
        f"there is no bond {pin.bond!r}",
        code="HB-M180",
        where=where,
        hint=did_you_mean(pin.bond, known),
    )


def _end(bond: Bond, pin: WrittenPin, resolver: Resolver, where: str) -> int:
    """Return which end of `bond` the node of the pin is."""
    ends = (resolver.nodes[bond.tail].path, resolver.nodes[bond.head].path)
    # A bond to a switched element ends at the junction that is its switch.
    for name in (pin.path, f"{pin.path}.switch"):
        if name in ends:
            return ends.index(name)
    tail, head = (e.removesuffix(".switch").removeprefix(_within(pin)) for e in ends)
    raise ModelError(
        f"the bond {bond.name!r} does not end at {pin.at!r}",
        code="HB-M181",
        where=where,
        hint=f"its stroke is at {tail!r} or at {head!r}",
    )


def _within(pin: WrittenPin) -> str:
    return f"{pin.scope.prefix}." if pin.scope.prefix else ""
