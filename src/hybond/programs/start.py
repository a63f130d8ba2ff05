"""Where a run begins."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.programs.program import Program

Vector = NDArray[np.float64]


def start_of(program: Program) -> Vector:
    """Return the state at t = 0 as the model gives it, before it is settled."""
    graph = program.graph
    y = np.zeros(program.nx + program.ns + 2)
    co_energy = np.zeros(program.nx)
    wanted = [s for s in graph.storages if s.start_is == "co-energy"]
    for s in graph.storages:
        if s.start_is == "stored":
            y[s.index] = s.start
        else:
            co_energy[s.index] = s.start
    for s in wanted:
        y[s.index] = program.storage.stored(co_energy, s.index, graph)
    for i in graph.integrals:
        y[program.nx + i.index] = i.start
    return y
