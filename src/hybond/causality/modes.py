"""How causality differs from mode to mode."""

from __future__ import annotations

from collections.abc import Iterable

from hybond.causality.record import Causality
from hybond.causality.strokes import Strokes
from hybond.model.graph import FlatGraph, Mode


def changed(graph: FlatGraph, a: Causality, b: Causality) -> tuple[int, ...]:
    """Return the bonds of `graph` whose stroke differs between `a` and `b`."""
    return tuple(k.index for k in graph.bonds if a.strokes[k.index] != b.strokes[k.index])


def mode_dependent(graph: FlatGraph, modes: Iterable[Mode]) -> dict[int, tuple[int, ...]]:
    """Return the bonds whose stroke differs among `modes`, with their stroke in each.

    These are the bonds of dynamic causality, drawn with a dashed stroke (R. Margetts and
    R. F. Ngwompo). Each mode is compared with the first, and differs from it only where that is
    needed. For all modes of a graph with many switches see `hybond.causality.dynamics`.

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
    every = list(modes)
    if not every:
        return {}
    live = Strokes(graph, every[0])
    seen: list[tuple[int, ...]] = []
    for mode in every:
        live.switch(mode)
        # A mode without a causality shows the strokes that its conflicts are told with.
        seen.append(live.record().strokes if live.conflict else tuple(live.strokes))
        live.undo()
    return {
        bond: strokes
        for bond, strokes in enumerate(zip(*seen, strict=True))
        if any(stroke != strokes[0] for stroke in strokes)
    }
