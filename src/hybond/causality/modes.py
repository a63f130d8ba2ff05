"""How causality differs from mode to mode."""

from __future__ import annotations

from collections.abc import Iterable

from hybond.causality.assign import assign
from hybond.causality.record import Causality
from hybond.model.graph import FlatGraph, Mode


def changed(graph: FlatGraph, a: Causality, b: Causality) -> tuple[int, ...]:
    """Return the bonds of `graph` whose stroke differs between `a` and `b`."""
    return tuple(k.index for k in graph.bonds if a.strokes[k.index] != b.strokes[k.index])


def mode_dependent(graph: FlatGraph, modes: Iterable[Mode]) -> dict[int, tuple[int, ...]]:
    """Return the bonds whose stroke differs among `modes`, with their stroke in each.

    These are the bonds of dynamic causality, drawn with a dashed stroke (R. Margetts and
    R. F. Ngwompo).

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("chopper")
    >>> m.add(V=hb.Se(10), sw=hb.One(), j=hb.Zero(), r=hb.R(1), c=hb.C(1))
    >>> m.bond("V -> sw -> j -> c", "sw -> r")
    >>> m.machine("S", states={"closed": ["sw"], "open": []}, start="closed")
    >>> mode_dependent(m.flatten(), [(0,), (1,)])
    {3: (1, 0)}
    """
    strokes = [assign(graph, mode).strokes for mode in modes]
    return {
        bond: seen
        for bond, seen in enumerate(zip(*strokes, strict=True))
        if any(stroke != seen[0] for stroke in seen)
    }
