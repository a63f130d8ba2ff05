"""Steps that end just before time alone makes a law or a source jump, and not far behind it.

A jump that a step reaches over is an error of that step, which is tried again and again until it is
so short that the jump does nothing in it. When time alone makes one, as in ``mod(time, T) < d*T``,
is known beforehand. So a step ends next to it, and one over it, of some last places, follows.

What may be an instant of its own is left to the step that meets it: a source that jumps onto what
is stored, or at laws of junctions.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.guards.together import LAST_PLACES
from hybond.engine.inputs.interval import HALF, set_time
from hybond.engine.method_numbers import RK4
from hybond.engine.methods.explicit.dopri import spacing
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.methods.stepping import by_radau
from hybond.engine.mode.mode_records import is_constrained

LOOKS: Final = 4
"""Places in a step, its end is the last, up to each of which it is asked whether something jumps:
a pulse that begins and ends between two of them is found by the errors of steps."""
MANY_JUMPS: Final = 64
PER_STATE: Final = 4
"""So many jumps, and more for each state, are not asked for before each step: it would take longer
than the step itself."""
NEXT_TO: Final = 2.0 * LAST_PLACES
"""Units in the last place of time that a step ends before a jump, and the next one behind it."""


def end_at_jump(e: Engine, end: float) -> float:
    """Return where the next step ends at the latest: at `end`, or next to a jump of time alone."""
    m = e.model
    if m.timed_laws == 0 or m.method >= RK4 or m.laws > 0:
        return end
    many = m.timed_laws > MANY_JUMPS + PER_STATE * e.states
    if many or e.slide.k > 0 or is_constrained(e.mode):
        return end
    size = e.radau.next if by_radau(e) else e.step.h
    ahead = min(end, e.t + size)
    if not (ahead - e.t > room_of_instant(e, e.t) and ahead < math.inf):
        return end
    jump = ahead
    for k in range(m.timed_laws):
        jump = min(jump, before_jump(e, m.timed_jump[k], e.t, jump))
    set_time(e, e.v, e.t)
    # what has another value at one instant alone, as a sign at zero, begins with the step
    if not jump < ahead or jump <= e.t:
        return end
    near = NEXT_TO * spacing(jump)
    if jump - near - e.t > near:
        return jump - near
    return min(end, jump + near)


def before_jump(e: Engine, which: int, a: float, b: float) -> float:
    """Return the last time in ``[a, b]`` before a value of time jumps there, `b` if it does not."""
    here = value_at(e, which, a)
    # where the last step has ended next to one, others may be as near as the first place to look
    close = min(a + 3.0 * NEXT_TO * spacing(a), b)
    there = value_at(e, which, close)
    if math.fabs(there - here) > HALF:
        return last_before(e, which, a, close)
    way = (b - a) / float(LOOKS)
    for k in range(LOOKS):
        before = a + float(k) * way
        behind = b if k == LOOKS - 1 else before + way
        there = value_at(e, which, behind)
        if math.fabs(there - here) > HALF:
            return last_before(e, which, before, behind)
        here = there
    return b


def last_before(e: Engine, which: int, a: float, b: float) -> float:
    """Return the last time before the jump between `a` and `b`, `b` if it is none but goes on."""
    end = b
    here = value_at(e, which, a)
    there = value_at(e, which, b)
    middle = 0.5 * (a + b)
    while middle > a and middle < b:
        between = value_at(e, which, middle)
        if math.fabs(between - here) > HALF:
            b = middle
            there = between
        else:
            a = middle
            here = between
        if not math.fabs(there - here) > HALF:
            return end
        middle = 0.5 * (a + b)
    return a


def value_at(e: Engine, which: int, t: float) -> float:
    """Return what a value that time alone moves is at a time."""
    set_time(e, e.v, t)
    return value(e.model, which, e.v)
