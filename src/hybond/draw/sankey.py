"""Who gave energy and who took it: ribbons from givers over a bar to takers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from hybond.draw.measure import shorten
from hybond.draw.plots import new_figure, write_figure
from hybond.measures.losses import Losses, Row
from hybond.measures.value import shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Share: TypeAlias = tuple[str, str, float]
"""Name, kind and energy taken, J; negative if it was given."""
_LEAST = 1e-4
"""Part of all energy below which a share is not drawn."""
_GAP = 0.35
"""Between two ribbons, inches."""
_COLOURS = {"source": "#0072B2", "storage": "#009E73", "resistor": "#D55E00", "switch": "#CC79A7"}
_OTHER = "#7a7a7a"
_LEFT, _MIDDLE, _RIGHT, _BAR = 0.0, 0.5, 1.0, 0.012


def draw_sankey(losses: Losses, *, title: str = "", path: Any = None) -> Figure:
    """Draw the shares of a table of losses.

    Parameters
    ----------
    path : path, optional
        Write the figure to this file too.

    Returns
    -------
    Figure
        What was lost in jumps is a ribbon of its own, beside what the same element dissipated.
    """
    gives, takes = shares_of(losses)
    total = max(sum(-s[2] for s in gives), sum(s[2] for s in takes)) or 1.0
    many = max(len(gives), len(takes), 1)
    tall = 1.6 + _GAP * many
    figure = new_figure((7.4, tall + 0.8), interactive=path is None)
    ax = figure.add_axes((0.28, 0.03, 0.44, tall / (tall + 0.8) - 0.05))
    ax.set_axis_off()
    ax.set_xlim(_LEFT - _BAR, _RIGHT + _BAR)
    ax.set_ylim(-tall, 0.1)
    scale = (tall - _GAP * many - 0.2) / total
    _side(ax, gives, losses.unit, scale, left=True)
    _side(ax, takes, losses.unit, scale, left=False)
    _box(ax, _MIDDLE - _BAR / 2, 0.0, _BAR, total * scale, "#333333")
    window = f"t = {losses.start:.6g} s to {losses.end:.6g} s"
    for y, text, weight in ((0.3, title, "bold"), (0.55, window, "normal")):
        figure.text(
            0.03,
            1.0 - y / (tall + 0.8),
            shorten(text, 10.5, 480.0),
            fontsize=10.5 if weight == "bold" else 9.0,
            fontweight=weight,
            va="center",
            parse_math=False,
        )
    return write_figure(figure, path)


def shares_of(losses: Losses) -> tuple[list[Share], list[Share]]:
    """Return who gave and who took, the largest first; what is too small to be seen is left out."""
    shares = [s for row in losses for s in _shares(row)]
    most = sum(abs(e) for _, _, e in shares) / 2.0 or 1.0
    seen = [s for s in shares if abs(s[2]) > _LEAST * most]
    gives = sorted((s for s in seen if s[2] < 0.0), key=lambda s: s[2])
    return gives, sorted((s for s in seen if s[2] > 0.0), key=lambda s: -s[2])


def _shares(row: Row) -> list[Share]:
    """Return the shares of an element."""
    beside = row.dissipated + row.stored - row.supplied
    kind = row.kind
    if kind == "part":
        sizes = {"source": row.supplied, "resistor": row.dissipated, "storage": row.stored}
        kind = max(sizes, key=lambda k: abs(sizes[k]))
    found = [(row.name, kind, beside)] if beside else []
    if row.lost:
        name = row.name if row.kind == "switch" and not beside else f"{row.name}, in jumps"
        found.append((name, "switch", row.lost))
    return found


def _side(ax: Axes, shares: Sequence[Share], unit: str, scale: float, *, left: bool) -> None:
    """Draw the ribbons of one side, the largest at the top."""
    outer, inner = 0.0, 0.0
    edge = _LEFT if left else _RIGHT
    middle = _MIDDLE - _BAR / 2 if left else _MIDDLE + _BAR / 2
    for name, kind, energy in shares:
        high = abs(energy) * scale
        colour = _COLOURS.get(kind, _OTHER)
        _ribbon(ax, (edge, outer), (middle, inner), high, colour)
        _box(ax, edge - _BAR if left else edge, outer, _BAR, max(high, 0.01), colour)
        ax.annotate(
            f"{shorten(name, 9.0, 100.0)}  {shown(round_to(abs(energy)), unit)}",
            (edge - _BAR if left else edge + _BAR, -outer - high / 2),
            xytext=(-5 if left else 5, 0),
            textcoords="offset points",
            ha="right" if left else "left",
            va="center",
            fontsize=9.0,
            parse_math=False,
            annotation_clip=False,
        )
        outer += high + _GAP
        inner += high


def round_to(value: float) -> float:
    """Return a value with four digits.

    Examples
    --------
    >>> round_to(14.08952)
    14.09
    """
    return float(f"{value:.4g}")


def _ribbon(
    ax: Axes, start: tuple[float, float], end: tuple[float, float], high: float, colour: str
) -> None:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    (x0, y0), (x1, y1) = start, end
    bend = 0.5 * (x0 + x1)
    points = [
        (x0, -y0),
        (bend, -y0),
        (bend, -y1),
        (x1, -y1),
        (x1, -y1 - high),
        (bend, -y1 - high),
        (bend, -y0 - high),
        (x0, -y0 - high),
        (x0, -y0),
    ]
    codes = [Outline.MOVETO, *[Outline.CURVE4] * 3, Outline.LINETO, *[Outline.CURVE4] * 3]
    codes.append(Outline.CLOSEPOLY)
    ax.add_patch(PathPatch(Outline(points, codes), facecolor=colour, alpha=0.45, linewidth=0.0))


def _box(ax: Axes, x: float, y: float, wide: float, high: float, colour: str) -> None:
    from matplotlib.patches import Rectangle

    ax.add_patch(Rectangle((x, -y - high), wide, high, facecolor=colour, linewidth=0.0))
