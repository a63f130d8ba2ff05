"""The strip of modes below a plot: one lane per machine, one block per stay in a state.

Where a machine changes faster than pixels tell, the height of a colour is the share of time that is
spent in its state.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.draw.measure import width

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LANES = 10
"""Most machines shown."""

_COLOURS = ("#e3e6ea", "#9ecae1", "#fdd49e", "#a1d99b", "#dadaeb", "#fcbba1", "#d9d9b0", "#c7e9e4")

MANY = 600
"""Stays of a machine from which on its lane shows shares of time."""
_COLUMNS = 900

Stay = tuple[float, float, int]
"""From, to, state."""


def stays(result: Any, machine: int) -> list[Stay]:
    """Return the stays of one machine in its states, neighbours of one state joined.

    Examples
    --------
    >>> from types import SimpleNamespace as N
    >>> run = N(segments=[N(t=[0, 1], mode=(0,)), N(t=[1, 2], mode=(0,)), N(t=[2, 3], mode=(1,))])
    >>> stays(run, 0)
    [(0.0, 2.0, 0), (2.0, 3.0, 1)]
    """
    found: list[Stay] = []
    for segment in result.segments:
        start, end, state = float(segment.t[0]), float(segment.t[-1]), int(segment.mode[machine])
        if found and found[-1][2] == state:
            found[-1] = (found[-1][0], end, state)
        elif end > start or not found:
            found.append((start, end, state))
    return found


def shares(
    all_stays: Sequence[Stay], state: int, edges: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the part of the time between neighbouring edges that is spent in a state.

    Examples
    --------
    >>> shares([(0.0, 1.0, 0), (1.0, 4.0, 1)], 1, np.array([0.0, 2.0, 4.0])).tolist()
    [0.5, 1.0]
    """
    times = np.array([t for a, b, _ in all_stays for t in (a, b)])
    spent = np.array([(b - a) * (k == state) for a, b, k in all_stays])
    total = np.repeat(np.cumsum(spent), 2)
    total[0::2] -= spent
    share = np.diff(np.interp(edges, times, total)) / np.diff(edges)
    return np.asarray(np.clip(share, 0.0, 1.0))


def lanes(result: Any) -> tuple[list[int], int]:
    """Return the machines to show, those that move first, and how many are left out."""
    machines = range(len(result.graph.machines))
    modes = {tuple(s.mode) for s in result.segments}
    moving = [m for m in machines if len({mode[m] for mode in modes}) > 1]
    still = [m for m in machines if m not in set(moving)]
    return sorted((moving + still)[:LANES]), max(0, len(machines) - LANES)


def slides(result: Any, machine: int, factor: float) -> list[tuple[float, float]]:
    """Return from when to when a machine slides along its switching surface."""
    path = result.graph.machines[machine].path
    return [
        (s.t0 * factor, s.t1 * factor) for s in getattr(result, "sliding", ()) if path in s.machines
    ]


def room_beside(result: Any, shown: list[int], *, inches: float) -> float:
    """Return how wide, in inches, the names are that stand right of the lanes of an axes."""
    span = result.t_end or 1.0
    widest = 0.0
    for m in shown:
        states = result.graph.machines[m].states
        found = stays(result, m)
        few = found if len(found) <= MANY else ()
        named = {k for a, b, k in few if _fits(states[k], (b - a) / span * inches)}
        beside = {k for _, _, k in found} - named
        names = sum(0.03 * inches + width(states[k], 7.5) / 72.0 for k in beside)
        widest = max(widest, 0.01 * inches + names if beside else 0.0)
    return widest


def _fits(name: str, inches: float) -> bool:
    """Whether the name of a state fits into its block."""
    return inches * 72.0 > width(name, 7.5) + 4.0


def draw_strip(ax: Axes, result: Any, shown: list[int], *, factor: float, inches: float) -> None:
    """Draw the lanes of the machines `shown` on axes of their own.

    Parameters
    ----------
    factor : float
        From seconds to the unit of the axis.
    inches : float
        Width of the axes, to tell which names fit into their blocks.
    """
    from matplotlib.collections import PolyCollection

    span = (result.t_end or 1.0) * factor
    corners, colours = [], []
    for lane, m in enumerate(shown):
        states = result.graph.machines[m].states
        named: set[int] = set()
        present: set[int] = set()
        found = stays(result, m)
        if len(found) > MANY:
            present |= {state for _, _, state in found}
            _draw_shares(ax, found, lane, factor)
            _explain(ax, lane, {k: states[k] for k in sorted(present)}, inches)
            continue
        for start, end, state in found:
            a, b = start * factor, end * factor
            corners.append([(a, lane - 0.4), (b, lane - 0.4), (b, lane + 0.4), (a, lane + 0.4)])
            colours.append(_COLOURS[state % len(_COLOURS)])
            present.add(state)
            if _fits(states[state], (b - a) / span * inches):
                named.add(state)
                ax.text(
                    (a + b) / 2,
                    lane,
                    states[state],
                    fontsize=7.5,
                    ha="center",
                    va="center",
                    color="#222222",
                    parse_math=False,
                )
        _explain(ax, lane, {k: states[k] for k in sorted(present - named)}, inches)
    # White borders of very many blocks would leave nothing else.
    border = 0.4 if len(corners) < 150 else 0.0
    ax.add_collection(
        PolyCollection(corners, facecolors=colours, edgecolors="white", linewidths=border),
        autolim=False,
    )
    # while a machine slides it is in both of its states at once
    both = [
        [(a, lane - 0.4), (b, lane - 0.4), (b, lane + 0.4), (a, lane + 0.4)]
        for lane, m in enumerate(shown)
        for a, b in slides(result, m, factor)
    ]
    if both:
        ax.add_collection(
            PolyCollection(both, facecolors="none", edgecolors="#777777", hatch="////", lw=0.0),
            autolim=False,
        )
    ax.set_ylim(len(shown) - 0.5, -0.5)
    ax.set_yticks(range(len(shown)))
    ax.set_yticklabels([result.graph.machines[m].path for m in shown], fontsize=8, parse_math=False)
    ax.tick_params(axis="y", length=0)
    for side in ("top", "right", "left"):
        ax.spines[side].set_visible(False)


def _draw_shares(ax: Axes, found: Sequence[Stay], lane: int, factor: float) -> None:
    """Fill a lane with the colours of its states, as high as their shares of time."""
    edges = np.linspace(found[0][0], found[-1][1], _COLUMNS + 1)
    low = np.full(_COLUMNS, lane - 0.4)
    for state in sorted({k for _, _, k in found}):
        high = low + 0.8 * shares(found, state, edges)
        ax.stairs(
            high,
            edges * factor,
            baseline=low,
            fill=True,
            color=_COLOURS[state % len(_COLOURS)],
            linewidth=0.0,
        )
        low = high


def _explain(ax: Axes, lane: int, names: dict[int, str], inches: float) -> None:
    """Name, right of a lane, the states whose blocks are all too narrow for their names."""
    from matplotlib.lines import Line2D

    x = 1.01
    for state, name in names.items():
        ax.add_line(
            Line2D(
                [x + 0.006],
                [lane],
                transform=ax.get_yaxis_transform(),
                marker="s",
                markersize=5.5,
                color=_COLOURS[state % len(_COLOURS)],
                markeredgecolor="#777777",
                markeredgewidth=0.5,
                clip_on=False,
            )
        )
        ax.text(
            x + 0.018,
            lane,
            name,
            transform=ax.get_yaxis_transform(),
            fontsize=7.5,
            va="center",
            color="#222222",
            parse_math=False,
        )
        x += 0.03 + width(name, 7.5) / 72.0 / inches
