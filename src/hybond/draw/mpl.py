"""Draw a scene on matplotlib axes: the same picture for PNG, PDF and figures of one's own."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

from hybond.draw.scene import Band, Frame, Line, Scene, printable
from hybond.draw.style import look

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DPI = 192.0
"""Of pictures in pixels."""


def draw_on_axes(scene: Scene, ax: Axes) -> None:
    """Draw `scene` on `ax`, which loses its frame and is given an equal aspect.

    Letters and lines are scaled to the present size of the axes.
    """
    from matplotlib.patches import FancyBboxPatch

    ax.set_axis_off()
    ax.set_xlim(0.0, scene.width)
    ax.set_ylim(scene.height, 0.0)
    ax.set_aspect("equal", adjustable="box")
    window = ax.get_window_extent()
    figure = ax.get_figure(root=True)
    dots = (figure.dpi if figure is not None else 72.0) / 72.0
    # Pixels of the scene that the axes have room for, in points: the tighter direction counts.
    points = min(window.width / dots / scene.width, window.height / dots / scene.height)
    order = 1.0  # what comes later lies above, be it a line, a frame or a text
    for group in scene.groups:
        for mark in group.marks:
            order += 1e-4
            style = look(mark.role)
            colour = (style.ink or ("black", "white"))[0]
            thick = (style.width or 1.5) * points
            # matplotlib counts dashes in line widths.
            dash = (0, tuple(d * points / thick for d in style.dash)) if style.dash else "solid"
            if isinstance(mark, Band):
                ax.plot(
                    [p[0] for p in mark.points],
                    [p[1] for p in mark.points],
                    color=colour,
                    linewidth=mark.breadth * points,
                    solid_capstyle="round",
                    scalex=False,
                    scaley=False,
                    clip_on=False,
                    zorder=order,
                )
            elif isinstance(mark, Line):
                words = mark.role.split()
                cap = "round" if {"bond", "barb", "cross"} & set(words) else "butt"
                if "filled" in words:
                    ax.fill(*zip(*mark.points), color=colour, linewidth=0.0, zorder=order)
                ax.plot(
                    [p[0] for p in mark.points],
                    [p[1] for p in mark.points],
                    color=colour,
                    linewidth=thick,
                    linestyle=dash,
                    solid_capstyle=cap,
                    dash_capstyle="butt",
                    scalex=False,
                    scaley=False,
                    clip_on=False,
                    zorder=order,
                )
            elif isinstance(mark, Frame):
                b = mark.box
                ax.add_patch(
                    FancyBboxPatch(
                        (b.x0, b.y0),
                        b.x1 - b.x0,
                        b.y1 - b.y0,
                        boxstyle=f"round,pad=0,rounding_size={mark.radius}",
                        facecolor=style.fill[0] if style.fill else "none",
                        edgecolor=colour,
                        linewidth=thick,
                        linestyle=dash,
                        zorder=order,
                    )
                )
            else:
                ax.text(
                    mark.x,
                    mark.y,
                    printable(mark.text),
                    color=colour,
                    fontsize=(style.size or 11.0) * points,
                    fontweight="bold" if style.bold else "normal",
                    fontstyle="italic" if style.italic else "normal",
                    fontfamily="DejaVu Sans",
                    ha={"start": "left", "middle": "center", "end": "right"}[mark.anchor],
                    va="baseline",
                    zorder=order,
                    parse_math=False,  # a $ in a name is a letter
                )


def figure_bytes(scene: Scene, *, form: str) -> bytes:
    """Return `scene` at its own size as ``"png"`` or ``"pdf"``."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(scene.width / 96.0, scene.height / 96.0), facecolor="white")
    FigureCanvasAgg(figure)
    draw_on_axes(scene, figure.add_axes((0.0, 0.0, 1.0, 1.0)))
    # No date and no version of a writer: the same picture is the same file.
    metadata = {"pdf": {"CreationDate": None, "Producer": "hybond", "Creator": "hybond"}}
    file = io.BytesIO()
    figure.savefig(file, format=form, dpi=DPI, metadata=metadata.get(form, {"Software": "hybond"}))
    return file.getvalue()
