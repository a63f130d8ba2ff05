"""When inputs break and signals are set next: a second opinion beside the engine's own."""

from __future__ import annotations

import bisect
import math
import sys

from hybond.model.graph import FlatGraph, Sample
from hybond.model.inputs import Called, Pwm, Timetable, Waveform

ROUNDING = 8.0 * sys.float_info.epsilon
"""What instants that are one on paper differ by, as a part of the time: 10*0.1 and 2*0.3 + 0.4."""


def next_break(w: Waveform, t: float) -> float:
    """Return the first breakpoint of an input after t, or infinity."""
    if isinstance(w, Timetable):
        k = w.piece(t)
        if w.period:
            return w.begin(k + 1)
        return w.times[k] if k < len(w.times) else math.inf
    if isinstance(w, Pwm) and w.duty not in (0.0, 1.0):
        cycle, falling = divmod(w.piece(t) + 1, 2)
        return w.phase + (cycle + (w.duty if falling else 0.0)) * w.period
    if isinstance(w, Called):
        k = bisect.bisect_right(w.breaks, t)
        return w.breaks[k] if k < len(w.breaks) else math.inf
    return math.inf


def next_sample(s: Sample, t: float) -> float:
    """Return the first instant of a sample after t."""
    n = max(0, math.floor((t - s.phase) / s.every) - 1)
    while (instant := s.phase + n * s.every) <= t:
        n += 1
    return instant


def next_timed(graph: FlatGraph, t: float) -> float:
    """Return the next instant at which an input breaks, a signal is set or time is compared."""
    ahead = [
        *(next_break(i.waveform, t) for i in graph.inputs),
        *(next_sample(s, t) for s in graph.samples),
        *(s for w in graph.watches for s in w.times if s > t),
    ]
    first = min(ahead, default=math.inf)
    return max((s for s in ahead if abs(s - first) <= ROUNDING * abs(first)), default=first)
