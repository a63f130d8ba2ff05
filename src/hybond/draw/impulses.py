"""Impulses in a plot: vertical arrows with their areas."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hybond.draw.traces import Vector, apart
from hybond.errors import UnitError
from hybond.units import format_quantity, parse_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_NEGLIGIBLE = 1e-9
"""Areas below this part of the largest one are rounding."""


def impulses_of(result: Any, name: str) -> Vector:
    """Return the impulses of a signal, shape (k, 2): time and area.

    Steps of one event that write add up; a mythical step writes nothing.
    """
    found = []
    for event in result.events.with_impulses():
        steps = [s for s in event.steps if s.kind != "mythical"]
        area = sum(s.impulses.get(name, 0.0) for s in steps)
        if area:
            found.append((float(event.t), float(area)))
    table = np.array(found) if found else np.zeros((0, 2))
    largest = np.max(np.abs(table[:, 1]), initial=0.0)
    kept: Vector = table[np.abs(table[:, 1]) > _NEGLIGIBLE * largest]
    return kept


def draw_impulses(
    ax: Axes, table: Vector, *, unit: str, colour: str, time_factor: float, t_end: float
) -> None:
    """Draw arrows from zero on axes whose limits are set; the longest is the largest area.

    Areas are written where there is room.
    """
    if not len(table):
        return
    low, high = ax.get_ylim()
    t, area = table[:, 0] * time_factor, table[:, 1]
    foot = min(max(0.0, low), high)
    part = 0.12 + 0.12 * np.abs(area) / np.max(np.abs(area))
    tip = foot + np.sign(area) * part * (high - low)
    ax.vlines(t, foot, tip, color=colour, linewidth=1.4, zorder=4)
    for sign, marker in ((1.0, "^"), (-1.0, "v")):
        chosen = np.sign(area) == sign
        ax.plot(
            t[chosen],
            tip[chosen],
            marker,
            color=colour,
            markersize=5.5,
            linestyle="none",
            zorder=4,
            scalex=False,
            scaley=False,
        )
    roomy = apart(table[:, 0], 0.11 * t_end)
    for k in np.flatnonzero(roomy)[:24]:
        late = table[k, 0] > 0.85 * t_end
        ax.annotate(
            area_text(float(area[k]), unit),
            (t[k], tip[k]),
            xytext=(-5 if late else 5, 2 if area[k] > 0 else -2),
            textcoords="offset points",
            ha="right" if late else "left",
            va="bottom" if area[k] > 0 else "top",
            fontsize=8,
            color=colour,
            zorder=5,
            parse_math=False,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.6},
        )


def area_text(area: float, unit: str) -> str:
    """Return an impulse's area with its unit: that of the signal, times second.

    Examples
    --------
    >>> area_text(-0.0993262, "V"), area_text(2.0, "")
    ('-0.0993 V·s', '2')
    """
    if "/" not in unit:
        # in the domain's own words: the impulse of a torque is in N·m·s, not in J·s
        return format_quantity(area, f"{unit}*s" if unit else "", 3)
    try:
        dimension = parse_unit(unit)[1] * parse_unit("s")[1]
    except UnitError:
        return f"{area:.3g}"
    return format_quantity(area, dimension, 3)
