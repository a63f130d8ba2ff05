"""Where a run begins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hybond.equations.storage import StorageLaw, stored_at
from hybond.model.expressions import Expr, Number, transform
from hybond.model.expressions.slots import settled
from hybond.model.graph import FlatGraph, Storage

ITERATED = "a start that is found by iteration"


def start_of(graph: FlatGraph) -> list[float]:
    """Return what is stored and integrated at t = 0 as the model gives it, before it is settled.

    Raises
    ------
    ModelError
        HB-M166 if a law of storage cannot be inverted at the co-energy variable that is given.
    """
    y = [0.0] * len(graph.storages)
    nodes = {s.node for s in graph.storages if s.start_is == "co-energy"}
    own: dict[int, list[Storage]] = {}
    for s in graph.storages:
        if s.start_is == "stored":
            y[s.index] = s.start
        if s.node in nodes:
            own.setdefault(s.node, []).append(s)
    for node, ports in own.items():
        law = graph.nodes[node].law
        if law is not None and law.matrix is not None and len(ports) == 1:
            y[ports[0].index] = ports[0].start / law.matrix[0][0]
            continue
        wanted = [s.start_is == "co-energy" for s in ports]
        z = [settled(s.start, ITERATED) if asked else 0.0 for s, asked in zip(ports, wanted)]
        numbers = _with_numbers(graph, node)
        x = stored_at(numbers, StorageLaw.of(numbers, tuple(ports)), np.array(z))
        for s, value, asked in zip(ports, x.tolist(), wanted, strict=True):
            if asked:
                y[s.index] = value
    return [*y, *(i.start for i in graph.integrals)]


def _with_numbers(graph: FlatGraph, k: int) -> FlatGraph:
    """Return a graph in which the law of a node has plain numbers."""
    node = graph.nodes[k]
    assert node.law is not None

    def settle(e: Expr) -> Expr:
        return Number(settled(e.value, ITERATED), e.dimension) if isinstance(e, Number) else e

    law = replace(
        node.law,
        expressions=tuple(transform(e, settle) for e in node.law.expressions),
        matrix=node.law.matrix
        and tuple(tuple(settled(a, ITERATED) for a in row) for row in node.law.matrix),
    )
    nodes = (*graph.nodes[:k], replace(node, law=law), *graph.nodes[k + 1 :])
    return replace(graph, nodes=nodes)
