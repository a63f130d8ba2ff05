"""Hints at ready parts: a port that nothing is joined to, so that nothing passes there."""

from __future__ import annotations

from collections.abc import Iterator

from hybond.library import names, sheet
from hybond.model.arrays import base_of
from hybond.model.builder import Model
from hybond.model.checked import Hint
from hybond.model.graph import FlatGraph, Node
from hybond.model.parts import SubmodelPart

FREE = "planar."
"""Parts whose ends may be free: points of a body."""

HOLDS = {"translational": "translational.frame", "rotational": "rotational.frame"}


def port_hints(model: Model, graph: FlatGraph) -> Iterator[Hint]:
    """Yield the ports of ready parts of the model that are joined to nothing.

    Models of one's own may have ports for others to use; a part of the library with an open port
    carries nothing there.
    """
    members: dict[str, list[str]] = {}
    for node in graph.nodes:
        part, dot, _ = node.path.partition(".")
        if dot and part not in members.setdefault(base_of(part), []):
            members[base_of(part)].append(part)
    for key, element in model.elements.items():
        if not isinstance(element, SubmodelPart) or not isinstance(element.model, str):
            continue
        if element.model in model.models or element.model.startswith(FREE):
            continue
        for port in _ports_of(element.model):
            for name in members.get(base_of(key), ()):
                k = graph.by_path.get(f"{name}.{port}")
                if k is not None and _open(graph, graph.nodes[k], f"{name}."):
                    yield _hint(key, name, port, graph.nodes[k])
                    break


def _ports_of(part: str) -> list[str]:
    return [port.name for port in sheet(part).ports] if part in names() else []


def _open(graph: FlatGraph, node: Node, within: str) -> bool:
    """Whether all bonds at a junction lead to nodes of the part itself."""
    if not node.is_junction:
        return False
    for end in node.ends:
        bond = graph.bonds[end.bond]
        other = bond.head if bond.tail == node.index else bond.tail
        if not graph.nodes[other].path.startswith(within):
            return False
    return True


def _hint(key: str, name: str, port: str, node: Node) -> Hint:
    passes = "flow" if node.kind == "0" else "effort"
    holder = HOLDS.get(node.domain.name)
    held = f"; what stands still is joined to a {holder}" if holder else ""
    return Hint(
        "HB-H110",
        f"elements.{key}",
        f"nothing is joined to the port {name + '.' + port!r}, so that no {passes} passes there",
        f'join it: "{name}.{port} -> ..."{held}',
    )
