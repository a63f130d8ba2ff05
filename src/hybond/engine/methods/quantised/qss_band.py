"""When a state leaves the band about its quantised state: the first root of a cubic, or of less."""

from __future__ import annotations

import math
from typing import Final

FAR: Final = 1e200
"""A time that is never reached, whatever the unit."""
ITERATIONS: Final = 80


def leaves_band(d0: float, d1: float, d2: float, d3: float, quantum: float) -> float:
    """Return the first ``s >= 0`` at which the cubic leaves the band, infinity if none.

    Between its extrema a polynomial is monotone, so that the first piece whose end is outside the
    band holds exactly one crossing.
    """
    if not math.fabs(d0) < quantum:
        return 0.0
    root = d2 * d2 - 3.0 * d3 * d1
    low = 0.0
    if root > 0.0:
        # the extrema that are ahead, the nearer one first
        far = -(d2 + math.copysign(math.sqrt(root), d2))
        one = far / (3.0 * d3) if d3 != 0.0 else 0.0
        other = d1 / far
        for k in range(2):
            end = min(one, other) if k == 0 else max(one, other)
            if not (end > 0.0 and end < FAR):
                continue
            if math.fabs(d0 + end * (d1 + end * (d2 + end * d3))) >= quantum:
                return crosses_band(d0, d1, d2, d3, quantum, low, end)
            low = end
    step = math.inf
    if d1 != 0.0:
        step = quantum / math.fabs(d1)
    if d2 != 0.0:
        step = min(step, math.sqrt(quantum / math.fabs(d2)))
    if d3 != 0.0:
        step = min(step, math.pow(quantum / math.fabs(d3), 1.0 / 3.0))
    if step == 0.0:
        # a coefficient beyond all bounds; whoever makes the step will find the state not finite
        return low
    if not step < FAR:
        return math.inf
    high = low + step
    while not math.fabs(d0 + high * (d1 + high * (d2 + high * d3))) >= quantum:
        step *= 2.0
        high = low + step
        if not high < FAR:
            return math.inf
    return crosses_band(d0, d1, d2, d3, quantum, low, high)


def crosses_band(
    d0: float, d1: float, d2: float, d3: float, quantum: float, begin: float, end: float
) -> float:
    """Return where the edge of the band is reached in a bracket where that is once (Newton)."""
    low = begin
    high = end
    sign = 1.0 if d0 + high * (d1 + high * (d2 + high * d3)) > 0.0 else -1.0
    s = 0.5 * (low + high)
    if d0 == 0.0 and low == 0.0:
        # where one power alone moves it, as right after an event, that is the answer
        guess = math.inf
        if d1 == 0.0 and d2 == 0.0 and d3 != 0.0:
            guess = math.pow(quantum / math.fabs(d3), 1.0 / 3.0)
        elif d1 == 0.0 and d2 != 0.0:
            guess = math.sqrt(quantum / math.fabs(d2))
        elif d1 != 0.0:
            guess = quantum / math.fabs(d1)
        s = min(guess, high)
    for _ in range(ITERATIONS):
        value = sign * (d0 + s * (d1 + s * (d2 + s * d3))) - quantum
        if value >= 0.0:
            high = s
        else:
            low = s
        slope = sign * (d1 + s * (2.0 * d2 + s * 3.0 * d3))
        new = s - value / slope if slope > 0.0 else low
        if math.fabs(new - s) <= 1e-13 * new:
            return new
        if not (low < new and new < high):
            new = 0.5 * (low + high)
        if math.fabs(new - s) <= 1e-13 * new or new == low or new == high:
            return new
        s = new
    return high
