"""Strokes of many modes, switched one after the other."""

from __future__ import annotations

from hybond.causality.strokes import Strokes


def mode_dependent(graph, modes) -> dict[int, tuple[int, ...]]:
    """Return the bonds whose stroke differs among `modes`, each compared with the first."""
    if not modes:
        return {}
    live = Strokes(graph, modes[0])
    seen = []
    for mode in modes:
        live.switch(mode)
        # a mode without a causality shows the strokes that its conflicts are told with
        seen.append(live.record().strokes if live.conflict else tuple(live.strokes))
        live.undo()
    rows = enumerate(zip(*seen, strict=True))
    return {bond: strokes for bond, strokes in rows if any(s != strokes[0] for s in strokes)}
