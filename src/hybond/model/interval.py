"""What is constant between two timed events: the pieces of inputs, and comparisons of time."""

from __future__ import annotations

import math
import operator
from dataclasses import dataclass

from hybond.model.expressions import Binary, Compare, names
from hybond.model.graph import FlatGraph, one_instant
from hybond.model.inputs import Constant, Pwm, Timetable
from hybond.model.kinds import RESISTORS, TWO_PORTS
from hybond.model.resolve import affine_in_time

_INSTANT = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge}


@dataclass(frozen=True, slots=True)
class Interval:
    """The open interval between two timed events.

    Parameters
    ----------
    pieces : tuple of int
        Piece of each input's waveform.
    at : tuple of bool
        Truth of each comparison of time.
    end : float
        The next timed event, s; infinity if there is none.
    """

    pieces: tuple[int, ...]
    at: tuple[bool, ...]
    end: float


def interval_after(graph: FlatGraph, t: float) -> Interval:
    """Return the interval that begins at `t` or contains it.

    Where instants are one but for rounding the interval ends at the last of them, so that what is
    due at any of them is due there.
    """
    ahead = [
        *(i.waveform.next_break(t) for i in graph.inputs),
        *(s.next_after(t) for s in graph.samples),
        *(s for w in graph.watches for s in w.times if s > t),
    ]
    first = min(ahead, default=math.inf)
    end = max((s for s in ahead if one_instant(s, first)), default=first)
    inside = t + 0.5 * (end - t) if end < math.inf else t + 1.0
    at = tuple(_INSTANT[w.compare.op](_in_time(w.compare, inside), 0.0) for w in graph.watches)
    return Interval(tuple(i.waveform.piece(t) for i in graph.inputs), at, end)


def _in_time(compare: Compare, t: float) -> float:
    slope, offset = affine_in_time(Binary("-", compare.left, compare.right)) or (0.0, 0.0)
    return slope * t + offset


def discrete_names(graph: FlatGraph) -> tuple[str, ...]:
    """Return the names of an interval that enter moduli or resistor laws.

    They select a configuration: with them constant, so are those rows.
    """
    held = {
        f"u:{i.index}"
        for i in graph.inputs
        if isinstance(i.waveform, Constant | Pwm)
        or (isinstance(i.waveform, Timetable) and not i.waveform.linear)
    }
    found: set[str] = set()
    for node in graph.nodes:
        if node.law is not None and node.kind in TWO_PORTS + RESISTORS:
            for e in node.law.expressions:
                found |= {n for n in names(e) if n in held or n.startswith("at:")}
    return tuple(sorted(found))


def discrete_values(
    graph: FlatGraph, wanted: tuple[str, ...], interval: Interval, t: float
) -> dict[str, float]:
    """Return the values of `wanted` within an interval."""
    values = {}
    for name in wanted:
        kind, _, index = name.partition(":")
        k = int(index)
        if kind == "at":
            values[name] = float(interval.at[k])
        else:
            values[name] = graph.inputs[k].waveform.value(t, interval.pieces[k])
    return values
