"""The end of a step along surfaces: the state is put back on them, unless they have jumped.

What a step drifts off is put back. Where a surface jumps that is what it has drifted off the
surface as it was before, and where it is far off without a jump that anybody has seen, nothing is:
the instant is settled, and what slides is where the state is.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.rounding import AT_KINK
from hybond.engine.answers import value
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.inputs.interval import moment
from hybond.engine.methods.stepping import between
from hybond.engine.surfaces.onto import onto_surfaces
from hybond.engine.surfaces.parted import find_parted, is_far
from hybond.engine.surfaces.values import evaluate

DOUBLED: Final = 16
"""Times that the way back from a jump is doubled: it is found where it is past by rounding."""


def hold_to_surfaces(e: Engine, t: float) -> int:
    """Put the state at the end of a step, `e.y`, back on its surfaces; ``parts_now`` if it is off.

    Then it is as the step has left it.
    """
    s = e.slide
    n = e.states
    s.parts_now = False
    jumps = note_jumps(e, t)
    before = t
    for k in range(n):
        s.y[k] = e.y[k]
    if jumps:
        before = before_jump(e, t)
        between(e, before, e.y)
    for k in range(n):
        s.put_from[k] = e.y[k]
    if onto_surfaces(e, before, e.y) != OK:
        return REFUSED
    far = is_far(e, s.put_from, e.y)
    for k in range(n if jumps or far else 0):
        e.y[k] = s.y[k] + (0.0 if far else e.y[k] - s.put_from[k])
    s.parts_now = far
    if jumps and not far:
        s.parts_now = find_parted(e, t, e.y)
    s.known = False
    return OK


def before_jump(e: Engine, t: float) -> float:
    """Return an instant of the step before the jumps of surfaces that were noted at `t`."""
    reach = moment(e.model, t)
    before = t
    for _ in range(DOUBLED):
        before = max(t - reach, e.step.t0)
        between(e, before, e.y)
        known = evaluate(e, e.mode, e.shown, before, e.y) == OK
        if before == e.step.t0 or (known and none_has_jumped(e)):
            return before
        reach *= 2.0
    return before


def note_jumps(e: Engine, t: float) -> bool:
    """Note where surfaces just jump, into ``jump_near``; whether any does."""
    m = e.model
    s = e.slide
    may = False
    for j in range(s.k):
        may = may or m.surface_jump_first[s.side[j]] < m.surface_jump_first[s.side[j] + 1]
    if not may or evaluate(e, e.mode, e.shown, t, e.y) != OK:
        return False
    some = False
    for j in range(s.k):
        for p in range(m.surface_jump_first[s.side[j]], m.surface_jump_first[s.side[j] + 1]):
            atom = m.kink_atom + m.surface_jump[p]
            s.jump_at[p] = value(m, m.atom_value[atom], e.shown)
            size = math.fabs(value(m, m.atom_size[atom], e.shown))
            s.jump_near[p] = 1 if math.fabs(s.jump_at[p]) <= AT_KINK * size else 0
            some = some or s.jump_near[p] != 0
    return some


def none_has_jumped(e: Engine) -> bool:
    """Whether all that was noted is on its other side at the values shown."""
    m = e.model
    s = e.slide
    for j in range(s.k):
        for p in range(m.surface_jump_first[s.side[j]], m.surface_jump_first[s.side[j] + 1]):
            there = value(m, m.atom_value[m.kink_atom + m.surface_jump[p]], e.shown)
            other = s.jump_at[p] * there < 0.0 or (s.jump_at[p] == 0.0 and there != 0.0)
            if s.jump_near[p] != 0 and not other:
                return False
    return True
