"""Laws of storage in the names of what is stored in a graph, and their slopes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from hybond.model.expressions import Expr, Name, Number, differentiate, substitute
from hybond.model.graph import FlatGraph, Node, Storage


def stiffness(
    node: Node, port: int, other: int, graph: FlatGraph, own: Sequence[Storage] | None = None
) -> Expr:
    """Return the derivative of a storage's co-energy variable by a stored quantity.

    `own` are the storage ports of the node, if they are known.
    """
    assert node.law is not None
    if node.law.matrix is not None:
        return Number(node.law.matrix[port][other])
    energy = node.about.energy
    suffix = str(other + 1) if len(node.ends) > 1 else ""
    d = _slope(node.law.expressions[port], f"law:{energy}{suffix}")
    return substitute(d, stored_names(node, graph, own))


@lru_cache(maxsize=1024)
def _slope(law: Expr, name: str) -> Expr:
    """Return a derivative in local names, which are the same in many elements."""
    return differentiate(law, name)


def stored_names(
    node: Node, graph: FlatGraph, own: Sequence[Storage] | None = None
) -> dict[str, Expr]:
    """Return what a storage's local stored quantities are called in the graph.

    `own` are its ports, if they are known.
    """
    many = len(node.ends) > 1
    return {
        f"law:{node.about.energy}{s.port + 1 if many else ''}": Name(f"x:{s.index}")
        for s in (graph.storages if own is None else own)
        if s.node == node.index
    }
