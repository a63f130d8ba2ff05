"""From where on the values of a run do not hold, in its plots."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from hybond.draw.scales import time_scale

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOUR = "#a05000"
"""Of what is to be doubted, and of the words that say so."""


def doubted_from(result: Any) -> float | None:
    """Return when a law was first seen not to hold, s; None of a run in which all do."""
    return min((float(v.t) for v in _seen(result)), default=None)


def _seen(result: Any) -> Sequence[Any]:
    # what is no run of its own, but is plotted like one, has no trace
    found: Sequence[Any] = getattr(getattr(result, "trace", None), "unsound", ())
    return found


def doubt(result: Any) -> str:
    """Return what a plot says of a run that is not sound, empty of others.

    Examples
    --------
    >>> from types import SimpleNamespace as Some
    >>> seen = Some(t=2e-3, place="B1")
    >>> doubt(Some(trace=Some(unsound=[seen]), t_end=0.01))
    'the laws do not hold from t = 2 ms on (B1): values there are wrong'
    """
    start = doubted_from(result)
    if start is None:
        return ""
    factor, unit = time_scale(result.t_end)
    place = next(v.place for v in _seen(result) if float(v.t) == start)
    shown = f"the laws do not hold from t = {start * factor:.6g} {unit} on"
    return f"{shown}{f' ({place})' * bool(place)}: values there are wrong"


def draw_doubt(panels: Sequence[Axes], result: Any, *, factor: float) -> None:
    """Draw a line where values end to hold, and a shade over those that do not."""
    start = doubted_from(result)
    if start is None:
        return
    for panel in panels:
        panel.axvline(start * factor, color=COLOUR, linewidth=1.2, linestyle="--", zorder=4)
        if start < result.t_end:
            begin, end = start * factor, float(result.t_end) * factor
            panel.axvspan(begin, end, color=COLOUR, alpha=0.12, linewidth=0.0, zorder=0)
