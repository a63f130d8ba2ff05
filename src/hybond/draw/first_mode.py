"""The mode in which a run goes on after its start: what a drawing shows unless asked otherwise."""

from __future__ import annotations

from hybond.errors import HybondError
from hybond.model.graph import FlatGraph, Mode
from hybond.simulation import simulate

_INSTANT = 1e-12
"""Seconds that are simulated: the start is settled before time goes on."""


def first_mode(graph: FlatGraph) -> Mode:
    """Return the mode that holds right after t = 0, when the start is settled.

    The start states may be no mode that occurs: diodes that all block beside a coil that carries
    current. Where a run cannot begin it is the start mode all the same.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("clamp", domain="electrical")
    >>> m.add(V=hb.Se("5 V"), d=hb.One(law="diode"), r=hb.R("1 ohm"))
    >>> m.bond("V -> d -> r")
    >>> graph = m.flatten()
    >>> graph.mode_names(graph.start_mode), graph.mode_names(first_mode(graph))
    ({'d': 'blocks'}, {'d': 'conducts'})
    """
    if not graph.machines:
        return graph.start_mode
    try:
        run = simulate(graph, until=_INSTANT)
    except HybondError:
        return graph.start_mode
    segments = run.segments
    return tuple(segments[0].mode) if len(segments) else graph.start_mode
