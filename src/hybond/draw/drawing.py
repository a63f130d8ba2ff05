"""`draw`: a bond graph as a picture."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from hybond.draw.compose import compose
from hybond.draw.layout import layout
from hybond.draw.mpl import draw_on_axes, write_figure
from hybond.draw.scene import Scene
from hybond.draw.sketch import Causality, sketch
from hybond.draw.svg import write_svg
from hybond.errors import UsageError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from hybond.model.graph import FlatGraph, Mode


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

    def _repr_svg_(self) -> str:
        return self.svg()

    def save(self, path: str | Path) -> Path:
        """Write the picture to a file: ``.svg``, ``.png`` or ``.pdf``.

        Raises
        ------
        UsageError
            HB-D101 for another ending.
        """
        target = Path(path)
        form = target.suffix.lower().lstrip(".")
        if form == "svg":
            target.write_text(self.svg(), encoding="utf-8")
        elif form in ("png", "pdf"):
            write_figure(self.scene, target, form=form)
        else:
            raise UsageError(
                f"cannot draw a {target.suffix or 'nameless'!r} file",
                code="HB-D101",
                where=str(target),
                hint="end the name in .svg, .png or .pdf",
            )
        return target

    def to_mpl(self, ax: Axes) -> Axes:
        """Draw on matplotlib axes and return them."""
        draw_on_axes(self.scene, ax)
        return ax


def draw(
    graph: FlatGraph,
    *,
    mode: Mode | None = None,
    causality: Causality | None = None,
    dynamic_bonds: Collection[int] = (),
    numbers: bool = False,
    title: bool = True,
) -> Drawing:
    """Draw a bond graph.

    Parameters
    ----------
    graph : FlatGraph
        ``graph.layout`` pins nodes: path to (x, y) in grid cells, y downwards.
    mode : tuple of int, optional
        The mode to show: what is OFF in it is grey, and a caption names it.
    causality : object, optional
        An assignment with `strokes`, `derivative` and `conflicts`; without it no strokes.
    dynamic_bonds : collection of int
        Bonds whose stroke depends on the mode: drawn dashed, at both ends if no mode is shown.
    numbers : bool
        Number the bonds, from 1.
    title : bool
        Write the model's title above.

    Returns
    -------
    Drawing
        Shows itself in a notebook; `Drawing.save` writes it.

    Examples
    --------
    >>> from hybond.model.builder import Model
    >>> from hybond.model.parts import C, I, One
    >>> m = Model("oscillator", domain="translational")
    >>> m.add(mass=I("1 kg"), spring=C("1 mm/N"), v=One())
    >>> m.bond("v -> mass", "v -> spring")
    >>> drawing = draw(m.flatten())
    >>> drawing.positions["v"], drawing.svg().startswith("<svg")
    ((0.0, 1.0), True)
    """
    if mode is not None and len(mode) != len(graph.machines):
        raise UsageError(
            f"the mode {tuple(mode)} has {len(mode)} states for {len(graph.machines)} machines",
            code="HB-D102",
            hint="one state per machine, in the graph's order",
        )
    shown = sketch(
        graph,
        mode=mode,
        causality=causality,
        dynamic_bonds=dynamic_bonds,
        numbers=numbers,
        title=title,
    )
    positions = _positions(
        tuple(s.kind for s in shown.symbols),
        tuple((a.tail, a.head) for a in shown.arrows),
        tuple(shown.pins.items()),
    )
    places = dict(zip((s.path for s in shown.symbols), positions, strict=True))
    return Drawing(compose(shown, positions), places)


@lru_cache(maxsize=32)
def _positions(
    kinds: tuple[str, ...],
    bonds: tuple[tuple[int, int], ...],
    pins: tuple[tuple[int, tuple[float, float]], ...],
) -> tuple[tuple[float, float], ...]:
    """Remember layouts: a model is drawn again for each mode."""
    return layout(kinds, bonds, pinned=dict(pins))


def draw_mode(
    graph: FlatGraph, mode: Mode, *, numbers: bool = False, title: bool = True
) -> Drawing:
    """Draw a bond graph with the causal strokes of one mode.

    Examples
    --------
    >>> from hybond.model.builder import Model
    >>> from hybond.model.parts import I, One, Se
    >>> m = Model("falling", domain="translational")
    >>> m.add(weight=Se("-9.81 N"), ball=I("1 kg"), v=One())
    >>> m.bond("weight -> v -> ball")
    >>> graph = m.flatten()
    >>> 'class="stroke"' in draw_mode(graph, graph.start_mode).svg()
    True
    """
    from hybond.causality.assign import assign

    return draw(graph, mode=mode, causality=assign(graph, mode), numbers=numbers, title=title)
