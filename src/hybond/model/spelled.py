"""A canonical name as a modeller would write it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hybond.model.resolve import Resolver


def as_written(name: str, known: Resolver) -> str:
    """Return a canonical name as a modeller would write it."""
    kind, _, index = name.partition(":")
    if kind == "law":
        return index
    if kind in ("e", "f"):
        bond = known.bonds[int(index)]
        for at in (bond.tail, bond.head):
            node = known.nodes[at]
            if not node.is_junction and len(node.ends) == 1:
                return f"{node.path}.{kind}"
        return f'"{bond.name}".{kind}'
    if kind == "x":
        return list(known.stored)[int(index)]
    if kind == "s":
        return list(known.integrals)[int(index)]
    if kind == "u":
        return list(known.inputs)[int(index)]
    return name
