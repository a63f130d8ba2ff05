"""Which variable of each junction law is given: the causality of a graph seen from its laws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from hybond.causality.arrays import Arrays, compile_arrays
from hybond.causality.reference import best_mode
from hybond.model.graph import FlatGraph, Mode

Given = Literal["common", "net"]


def base_mode(graph: FlatGraph, mode: Sequence[int]) -> Mode:
    """Return the mode with every junction law in its first branch: what machines alone decide."""
    return tuple(0 if m.law is not None else k for m, k in zip(graph.machines, mode, strict=True))


def orientation(graph: FlatGraph, mode: Mode, arrays: Arrays | None = None) -> dict[int, Given]:
    """Return which variable of each law's pair is given, junction by junction.

    The states of the other machines are those of `mode`. The choice leaves as much storage as
    possible in integral causality: the reference mode of what the laws may do. `arrays` are those
    of the graph, if they are known.
    """
    arrays = arrays or compile_arrays(graph)
    machines = tuple(
        m
        if m.law is not None
        else replace(m, states=(m.states[k],), on=(m.on[k],), start=0, rules=(), fieldless=())
        for m, k in zip(graph.machines, mode, strict=True)
    )
    part = replace(graph, machines=machines)
    on = [
        sets if m.law is not None else [sets[k]]
        for m, sets, k in zip(graph.machines, arrays.on, mode, strict=True)
    ]
    best = best_mode(part, replace(arrays, on=on))
    return {
        law.node: "net" if m.on[k] else "common"
        for m, k in zip(machines, best, strict=True)
        if m.law is not None
        for law in m.law.junctions
    }
