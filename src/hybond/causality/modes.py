"""How causality differs from mode to mode."""

from __future__ import annotations

from hybond.causality.record import Causality
from hybond.model.graph import FlatGraph


def changed(graph: FlatGraph, a: Causality, b: Causality) -> tuple[int, ...]:
    """Return the bonds of `graph` whose stroke differs between `a` and `b`."""
    return tuple(k.index for k in graph.bonds if a.strokes[k.index] != b.strokes[k.index])
