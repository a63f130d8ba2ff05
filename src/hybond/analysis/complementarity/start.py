"""What is known of a graph at its start, and what is not linear there."""

from __future__ import annotations

from collections.abc import Mapping

from hybond.engine.tables.start import start_of
from hybond.equations.element_parts import Parts, settings
from hybond.equations.slots import slots_of
from hybond.model.expressions import compile_expression
from hybond.model.graph import FlatGraph, Mode
from hybond.model.kinds import STORAGES


def start_values(graph: FlatGraph, mode: Mode) -> dict[str, float]:
    """Return the value of each canonical name at t = 0 in a mode; bond variables are zero."""
    found = dict.fromkeys(slots_of(graph).index, 0.0)
    for i in graph.inputs:
        piece = i.waveform.piece(0.0)
        found[f"u:{i.index}"] = i.waveform.value(0.0, piece)
        found[f"du:{i.index}"] = i.waveform.rate(0.0, piece)
    start = start_of(graph)
    for s, x in zip(graph.storages, start, strict=False):
        found[f"x:{s.index}"] = x
    for signal in graph.integrals:
        found[f"s:{signal.index}"] = signal.start
    for node in graph.on_nodes(mode):
        found[f"on:{node}"] = 1.0
    for m, k in zip(graph.machines, mode, strict=True):
        found[f"in:{m.index}:{k}"] = 1.0
    for w in graph.watches:
        found[f"at:{w.index}"] = float(
            compile_expression(w.compare, {"time": 0}, pre_offset=1)([0.0])
        )
    return found


def nonlinear_nodes(
    graph: FlatGraph, mode: Mode, known: Mapping[str, float]
) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the elements that are not linear in a mode: those without storage, and storage.

    Inputs and comparisons of time count as constants: they are, between two timed events.
    """
    discrete = {name: x for name, x in known.items() if name.startswith(("at:", "u:"))}
    values, off = settings(graph, mode, discrete), graph.off_nodes(mode)
    parts = Parts(graph)
    bent = [
        node.index
        for node in graph.nodes
        if not node.is_junction
        and node.kind not in STORAGES
        and parts.of(node, node.index in off, values).dynamic
    ]
    stored = {
        s.node for s in graph.storages if getattr(graph.nodes[s.node].law, "matrix", 0) is None
    }
    return tuple(bent), tuple(sorted(stored))
