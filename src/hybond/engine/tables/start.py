"""Where a run begins."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.equations.slots import slots_of
from hybond.equations.storage import StorageLaws
from hybond.model.graph import FlatGraph

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
    co_energy = np.zeros(nx)
    wanted = [s for s in graph.storages if s.start_is == "co-energy"]
    for s in graph.storages:
        if s.start_is == "stored":
            y[s.index] = s.start
        else:
            co_energy[s.index] = s.start
    if wanted:
        laws = StorageLaws.of(graph, slots_of(graph))
        for s in wanted:
            y[s.index] = laws.stored(co_energy, s.index, graph)
    for i in graph.integrals:
        y[nx + i.index] = i.start
    return y
