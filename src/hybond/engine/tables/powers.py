"""Tables of where power enters a model and where it leaves: sources, resistors."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hybond.model.kinds import SOURCES

if TYPE_CHECKING:
    from hybond.engine.tables.columns import ModelTables

RESISTORS = ("R", "G")


def put_powers(t: ModelTables) -> None:
    """Put the bonds of sources and the ports of resistors there, those on pseudo bonds left out."""
    g = t.graph
    for name, kinds, way in (("supplier", SOURCES, -1), ("dissipator", RESISTORS, 1)):
        ends = [
            end
            for node in g.nodes
            if node.kind in kinds
            for end in node.ends
            if not g.bonds[end.bond].domain.pseudo
        ]
        t.numbers[f"{name}s"] = len(ends)
        t.ints[f"{name}_bond"] = [end.bond for end in ends]
        t.ints[f"{name}_sign"] = [way * end.sign for end in ends]
