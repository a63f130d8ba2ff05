"""The end of a step along surfaces: the state is put back on them, unless they have jumped.

What a step drifts off is put back. Where a surface jumps that is what it has drifted off the
surface as it was before, and where it is far off without a jump that anybody has seen, nothing is:
the instant is settled, and what slides is where the state is.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.products import copy_floats
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.inputs.interval import moment
from hybond.engine.methods.stepping import between
from hybond.engine.surfaces.jumps_near import none_has_jumped, note_jumps
from hybond.engine.surfaces.onto import onto_surfaces
from hybond.engine.surfaces.parted import APART, find_parted, is_far
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
    jumps = note_jumps(e, t, e.y)
    before = t
    copy_floats(n, e.y, s.y)
    if jumps:
        before = before_jump(e, t)
        between(e, before, e.y)
    copy_floats(n, e.y, s.put_from)
    if onto_surfaces(e, before, e.y) != OK:
        return REFUSED
    far = is_far(e, s.put_from, e.y)
    for k in range(n if jumps or far else 0):
        e.y[k] = s.y[k] + (0.0 if far else e.y[k] - s.put_from[k])
    s.parts_now = far
    if jumps and not far:
        s.parts_now = find_parted(e, t, e.y, APART)
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
