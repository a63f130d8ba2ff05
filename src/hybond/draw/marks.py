"""Marks in plots: where steps of a script begin, and what they are called."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hybond.draw.measure import shorten

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

SIZE = 7.5
"""Of labels, points."""
GAP = 3.0
"""Room between a label and the next mark, points."""
LEAST = 12.0
"""Room below which a label is left out, points: its mark stands without it."""


def draw_marks(panels: Sequence[Axes], result: Any, *, factor: float, inches: float) -> None:
    """Draw the marks of a run over all panels, their labels above the first.

    Parameters
    ----------
    panels : sequence of Axes
        From the top.
    result : Result
    factor : float
        From seconds to what stands on the axis of time.
    inches : float
        How wide the panels are.
    """
    marks = getattr(result, "marks", ())
    if not marks or not panels:
        return
    low, high = panels[0].get_xlim()
    points = 72.0 * inches / max(high - low, 1e-300)
    for k, (t, label) in enumerate(marks):
        x = t * factor
        for panel in panels:
            panel.axvline(x, color="#8a8a8a", linewidth=0.7, linestyle=(0, (2, 2)), zorder=1)
        beyond = marks[k + 1][0] * factor if k + 1 < len(marks) else high
        room = (beyond - x) * points - GAP
        if room < LEAST:
            continue
        panels[0].annotate(
            shorten(label, SIZE, room),
            (x, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(2.0, -2.0),
            textcoords="offset points",
            fontsize=SIZE,
            color="#555555",
            ha="left",
            va="top",
            zorder=4,
            parse_math=False,
        )
