"""Pictures of more than one mode: the hybrid overview, and panels side by side."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from hybond.calls import called
from hybond.causality.dynamics import causality_of, dynamics
from hybond.causality.record import changed
from hybond.causality.reference import reference_mode
from hybond.draw.badges import Badge, badges
from hybond.draw.drawing import Drawing, finished, places_of
from hybond.draw.panels import side_by_side
from hybond.draw.simplify import shown_of
from hybond.draw.sketch import mode_caption, sketch
from hybond.errors import UsageError
from hybond.model.builder import graph_of

if TYPE_CHECKING:
    from hybond.model.builder import Model
    from hybond.model.graph import AnyMode, FlatGraph, Mode

MOST_PANELS = 16
"""Pictures side by side."""


@called("hb.draw_hybrid(model)")
def draw_hybrid(
    graph: Model | FlatGraph,
    reference: AnyMode | None = None,
    *,
    marks: Mapping[str, str | tuple[str, str] | Badge] | None = None,
    numbers: bool = False,
    simplify: bool | None = None,
    open: Collection[str] | None = None,
    title: bool = True,
    legend: bool = True,
) -> Drawing:
    """Draw all modes of a bond graph in one picture.

    The strokes of the reference mode are solid; where causality is dynamic, a dashed stroke
    stands at the end where the stroke is in other modes, and the region is shaded. What is OFF
    in the reference mode is grey.

    Parameters
    ----------
    graph : Model or FlatGraph
    reference : tuple of int, optional
        Without it the mode in which most storages are in integral causality.
    marks, numbers, simplify, open, title, legend
        As for `draw`.

    References
    ----------
    R. Margetts and R. F. Ngwompo: hybrid bond graphs with controlled junctions and dynamic
    causality.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("chopper", domain="electrical")
    >>> m.add(V=hb.Se("10 V"), sw=hb.One(), j=hb.Zero(), r=hb.R("1 ohm"), c=hb.C("1 mF"))
    >>> m.bond("V -> sw -> j -> c", "sw -> r")
    >>> m.machine("S", states={"closed": ["sw"], "open": []}, start="closed")
    >>> drawing = draw_hybrid(m.flatten())
    >>> drawing.svg().count('"stroke dynamic"')  # the resistor's, and one in the legend
    2
    """
    graph = graph_of(graph)
    base = reference_mode(graph, mode=None if reference is None else graph.mode_of(reference))
    caption = mode_caption(graph, base.mode)
    shown = sketch(
        graph,
        mode=base.mode,
        causality=base.causality,
        dynamic_bonds=dynamics(graph, base).dynamic,
        marks=badges(marks or {}),
        numbers=numbers,
        title=title,
        caption=f"reference mode: {caption}" if caption else "",
    )
    return finished(*shown_of([shown], graph, simplify, open), legend=legend)


@called("hb.draw_modes(model)")
def draw_modes(
    graph: Model | FlatGraph,
    modes: Sequence[AnyMode] | None = None,
    *,
    reference: AnyMode | None = None,
    columns: int | None = None,
    numbers: bool = False,
    simplify: bool | None = None,
    open: Collection[str] | None = None,
    title: bool = True,
    legend: bool = True,
) -> Drawing:
    """Draw several modes side by side, everything in the same place in each.

    The first panel is the reference mode; in the others the bonds whose stroke differs from it
    lie on a coloured ground.

    Parameters
    ----------
    graph : Model or FlatGraph
    modes : sequence of tuple of int, optional
        Without it all modes. The reference mode is put first, also if it is not among them.
    reference : tuple of int, optional
        Without it the mode in which most storages are in integral causality.
    columns : int, optional
        Panels in a row; without it as many as suit a page.
    numbers, simplify, open, title, legend
        As for `draw`.

    Raises
    ------
    UsageError
        HB-D105 if that makes more than `MOST_PANELS` panels, or fewer than one column is asked
        for.
    ModelError
        HB-M144 for what is no mode.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("chopper", domain="electrical")
    >>> m.add(V=hb.Se("10 V"), sw=hb.One(), j=hb.Zero(), r=hb.R("1 ohm"), c=hb.C("1 mF"))
    >>> m.bond("V -> sw -> j -> c", "sw -> r")
    >>> m.machine("S", states={"closed": ["sw"], "open": []}, start="closed")
    >>> panels = draw_modes(m.flatten())
    >>> panels.svg().count('data-node="sw"')
    2
    """
    graph = graph_of(graph)
    first_mode = None if reference is None else graph.mode_of(reference)
    if modes is not None and (isinstance(modes, str | Mapping) or not isinstance(modes, Iterable)):
        raise UsageError(
            f"modes = {modes!r} is no list of modes",
            code="HB-S130",
            where="modes",
            hint='modes=[{"floor": "away"}, {"floor": "touching"}]',
        )
    wanted = None if modes is None else [graph.mode_of(mode) for mode in modes]
    if columns is not None and columns < 1:
        raise UsageError(
            f"{columns} columns", code="HB-D105", where="columns", hint="at least one column"
        )
    if wanted is None:
        wanted = _all_modes(graph)
    base = reference_mode(graph, mode=first_mode)
    first = base.mode
    chosen = list(dict.fromkeys([first, *wanted]))
    if len(chosen) > MOST_PANELS:
        raise UsageError(
            f"{len(chosen)} modes are too many to draw side by side",
            code="HB-D105",
            where=graph.name,
            hint=f"name at most {MOST_PANELS - 1} modes besides the reference mode",
        )
    sketches = []
    for mode in chosen:
        here = base.causality if mode == first else causality_of(graph, mode, reference=base)
        caption = mode_caption(graph, mode)
        if mode == first:
            caption = f"reference mode: {caption}" if caption else "the only mode"
        sketches.append(
            sketch(
                graph,
                mode=mode,
                causality=here,
                emphasis=changed(graph, base.causality, here),
                numbers=numbers,
                title=title,
                caption=caption,
            )
        )
    sketches = shown_of(sketches, graph, simplify, open)
    arrangement = places_of(sketches[0])
    scene = side_by_side(sketches, arrangement, columns=columns, legend=legend)
    places = dict(zip((s.path for s in sketches[0].symbols), arrangement.positions, strict=True))
    return Drawing(scene, places)


def _all_modes(graph: FlatGraph) -> list[Mode]:
    """Return every mode, if they are few enough to be drawn.

    Raises
    ------
    UsageError
        HB-D105.
    """
    count = math.prod(len(m.states) for m in graph.machines)
    if count > MOST_PANELS:
        raise UsageError(
            f"the model has {count} modes, more than the {MOST_PANELS} that are drawn side by side",
            code="HB-D105",
            where=graph.name,
            hint="name the modes that you want to see, or draw the hybrid overview",
        )
    return list(itertools.product(*(range(len(m.states)) for m in graph.machines)))
