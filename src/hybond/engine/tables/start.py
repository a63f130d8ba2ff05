"""Where a run begins."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.equations.storage import StorageLaw, stored_at
from hybond.model.graph import FlatGraph, Storage

Vector = NDArray[np.float64]


def start_of(graph: FlatGraph) -> Vector:
    """Return what is stored and integrated at t = 0 as the model gives it, before it is settled.

    Raises
    ------
    ModelError
        HB-M166 if a law of storage cannot be inverted at the co-energy variable that is given.
    """
    nx = len(graph.storages)
    y = np.zeros(nx + len(graph.integrals))
    nodes = {s.node for s in graph.storages if s.start_is == "co-energy"}
    own: dict[int, list[Storage]] = {}
    for s in graph.storages:
        if s.start_is == "stored":
            y[s.index] = s.start
        if s.node in nodes:
            own.setdefault(s.node, []).append(s)
    for ports in own.values():
        wanted = [s.start_is == "co-energy" for s in ports]
        z = np.array([s.start if asked else 0.0 for s, asked in zip(ports, wanted, strict=True)])
        x = stored_at(graph, StorageLaw.of(graph, tuple(ports)), z)
        for s, value, asked in zip(ports, x.tolist(), wanted, strict=True):
            if asked:
                y[s.index] = value
    for i in graph.integrals:
        y[nx + i.index] = i.start
    return y
