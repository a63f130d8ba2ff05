"""`draw`: a bond graph as a picture."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from hybond.calls import called
from hybond.draw.arrange import Arrangement, arrange
from hybond.draw.badges import Badge, badges
from hybond.draw.compose import compose
from hybond.draw.legend import entries
from hybond.draw.mpl import draw_on_axes, figure_bytes
from hybond.draw.scene import Scene
from hybond.draw.simplify import shown_of
from hybond.draw.sketch import Causality, Sketch, sketch
from hybond.draw.svg import write_svg
from hybond.draw.tikz import write_tikz
from hybond.draw.words import with_words
from hybond.errors import HybondError, UsageError
from hybond.files.whole import write_whole
from hybond.model.builder import graph_of
from hybond.model.graph import FlatGraph, Mode
from hybond.simulation import simulate

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from hybond.model.builder import Model
    from hybond.model.graph import AnyMode


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


@dataclass(frozen=True, slots=True)
class Drawing:
    """A picture of a bond graph.

    Parameters
    ----------
    scene : Scene
        Lines and texts with their places.
    positions : dict of str to (x, y)
        Where each node stands, in grid cells, y downwards: what a model file may keep under
        ``layout``.
    """

    scene: Scene
    positions: dict[str, tuple[float, float]]

    def svg(self) -> str:
        """Return the picture as one self-contained SVG text."""
        return write_svg(self.scene)

    def tikz(self, *, document: bool = False) -> str:
        r"""Return the picture as TikZ: an environment for ``\input``, or a whole document."""
        return write_tikz(self.scene, document=document)

    def _repr_svg_(self) -> str:
        return self.svg()

    def save(self, path: str | Path) -> Path:
        """Write the picture to a file: ``.svg``, ``.png``, ``.pdf`` or ``.tex`` (TikZ).

        Raises
        ------
        UsageError
            HB-D101 for another ending.
        """
        target = Path(path)
        form = target.suffix.lower().lstrip(".")
        if form == "svg":
            write_whole(target, self.svg())
        elif form == "tex":
            write_whole(target, self.tikz())
        elif form in ("png", "pdf"):
            write_whole(target, figure_bytes(self.scene, form=form))
        else:
            raise UsageError(
                f"cannot draw a {target.suffix or 'nameless'!r} file",
                code="HB-D101",
                where=str(target),
                hint="end the name in .svg, .png, .pdf or .tex",
            )
        return target

    def to_mpl(self, ax: Axes) -> Axes:
        """Draw on matplotlib axes and return them."""
        draw_on_axes(self.scene, ax)
        return ax


@called("hb.draw(model)")
def draw(
    graph: Model | FlatGraph,
    *,
    mode: AnyMode | None = None,
    causality: Causality | None = None,
    dynamic_bonds: Collection[int] = (),
    marks: Mapping[str, str | tuple[str, str] | Badge] | None = None,
    numbers: bool = False,
    simplify: bool | None = None,
    open: Collection[str] | None = None,
    title: bool = True,
    legend: bool = True,
) -> Drawing:
    """Draw a bond graph.

    Parameters
    ----------
    graph : Model or FlatGraph
        ``graph.layout`` pins nodes: path to (x, y) in grid cells, y downwards.
    mode : tuple of int or mapping, optional
        The mode to show: what is OFF in it is grey, and a caption names it.
    causality : object, optional
        An assignment with `strokes`, `derivative` and `conflicts`; without it no strokes.
    dynamic_bonds : collection of int
        Bonds whose stroke depends on the mode. The stroke of `causality` is solid, and a dashed
        one stands at the other end; without `causality` both are dashed. The region is shaded.
    marks : mapping of path to str, (text, tone) or Badge
        Badges beside elements: ``{"pad": "derivative", "i": ("12 kHz", "purple")}``.
    numbers : bool
        Number the bonds, from 1.
    simplify : bool, optional
        Leave out what decides nothing: junctions between two bonds, grounds, losses of zero.
        Without it that is done where a model is made of parts; the legend says so.
    open : collection of str, optional
        Draw each part as one box, but for those that are named here: these have a frame around
        what is in them. Without it everything is drawn, and no frames.
    title : bool
        Write the model's title above.
    legend : bool
        Explain the signs that occur.

    Returns
    -------
    Drawing
        Shows itself in a notebook; `Drawing.save` writes it.

    Raises
    ------
    ModelError
        HB-M144 for what is no mode.
    UsageError
        HB-D106 for a mark on a node that does not exist,
        HB-D107 for a tone that does not exist,
        HB-D111 for a part to open that does not exist,
        HB-D112 for a layout with places too far apart.

    References
    ----------
    R. Margetts and R. F. Ngwompo, on the dashed stroke for dynamic causality in hybrid bond
    graphs with controlled junctions.

    Examples
    --------
    >>> from hybond.model.builder import Model
    >>> from hybond.model.constructors import C, I, One
    >>> m = Model("oscillator", domain="translational")
    >>> m.add(mass=I("1 kg"), spring=C("1 mm/N"), v=One())
    >>> m.bond("v -> mass", "v -> spring")
    >>> drawing = draw(m.flatten())
    >>> drawing.positions["v"], drawing.svg().startswith("<svg")
    ((0.0, 1.0), True)
    """
    graph = graph_of(graph)
    if mode is not None:
        mode = graph.mode_of(mode)
    shown = sketch(
        graph,
        mode=mode,
        causality=causality,
        dynamic_bonds=dynamic_bonds,
        marks=badges(marks or {}),
        numbers=numbers,
        title=title,
    )
    return finished(*shown_of([shown], graph, simplify, open), legend=legend)


def finished(shown: Sketch, *, legend: bool = True) -> Drawing:
    """Return the drawing of a sketch: laid out, composed, with its words."""
    places = places_of(shown)
    scene = with_words(
        compose(shown, places),
        title=shown.title,
        caption=shown.caption,
        legend=entries([shown]) if legend else [],
    )
    return Drawing(scene, dict(zip((s.path for s in shown.symbols), places.positions, strict=True)))


def places_of(shown: Sketch) -> Arrangement:
    """Return where the symbols and arrows of a sketch are: the same for every mode."""
    return _places(
        tuple(s.kind for s in shown.symbols),
        tuple((a.tail, a.head) for a in shown.arrows),
        tuple(shown.pins.items()),
    )


@lru_cache(maxsize=32)
def _places(
    kinds: tuple[str, ...],
    bonds: tuple[tuple[int, int], ...],
    pins: tuple[tuple[int, tuple[float, float]], ...],
) -> Arrangement:
    """Remember layouts: a model is drawn again for each mode."""
    return arrange(kinds, bonds, pinned=dict(pins))


@called('hb.draw_mode(model, {"floor": "touching"})')
def draw_mode(
    graph: Model | FlatGraph,
    mode: AnyMode | None = None,
    *,
    marks: Mapping[str, str | tuple[str, str] | Badge] | None = None,
    numbers: bool = False,
    simplify: bool | None = None,
    open: Collection[str] | None = None,
    title: bool = True,
    legend: bool = True,
) -> Drawing:
    """Draw a bond graph with the causal strokes of one mode.

    Parameters
    ----------
    graph : Model or FlatGraph
    mode : tuple of int or mapping, optional
        Without it the mode in which a run goes on after its start.
    marks, numbers, simplify, open, title, legend
        As for `draw`.

    Examples
    --------
    >>> from hybond.model.builder import Model
    >>> from hybond.model.constructors import I, One, Se
    >>> m = Model("falling", domain="translational")
    >>> m.add(weight=Se("-9.81 N"), ball=I("1 kg"), v=One())
    >>> m.bond("weight -> v -> ball")
    >>> graph = m.flatten()
    >>> 'class="stroke"' in draw_mode(graph, graph.start_mode).svg()
    True
    """
    from hybond.causality.dynamics import causality_of

    graph = graph_of(graph)
    mode = first_mode(graph) if mode is None else graph.mode_of(mode)
    return draw(
        graph,
        mode=mode,
        causality=causality_of(graph, mode),
        marks=marks,
        numbers=numbers,
        simplify=simplify,
        open=open,
        title=title,
        legend=legend,
    )
