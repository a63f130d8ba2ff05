"""A level that jumps within a step along it, which only a function in Python does unforeseen.

What is stored cannot follow: at the end of the step it is where it was led, and the level is
elsewhere. So the step ends just before that, and the next one, which is no longer than an instant,
just behind.
"""

from __future__ import annotations

from hybond.engine.engine import OK, Engine
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.methods.stepping import between, retry
from hybond.engine.surfaces.onto import onto_surfaces
from hybond.engine.surfaces.parted import is_far


def end_where_levels_jump(e: Engine) -> int:
    """Let the last step end where a function moves its surfaces by a jump: OK, or REFUSED."""
    if e.model.called == 0 or e.slide.k == 0 or not is_off(e, e.step.t1):
        return OK
    instant = room_of_instant(e, e.step.t1)
    low = e.step.t0
    high = e.step.t1
    while high - low > instant:
        middle = 0.5 * (low + high)
        if is_off(e, middle):
            high = middle
        else:
            low = middle
    end = low if low - e.step.t0 > instant else high
    return retry(e, end) if end < e.step.t1 else OK


def is_off(e: Engine, t: float) -> bool:
    """Whether the motion of the last step is off its surfaces, at a time of it, by a jump."""
    s = e.slide
    between(e, t, s.y)
    for k in range(e.states):
        s.put_from[k] = s.y[k]
    far = onto_surfaces(e, t, s.y) == OK and is_far(e, s.put_from, s.y)
    s.known = False
    return far
