"""Surfaces that are not where the state is that slides on them: what makes them jump has done so.

A surface that follows an input, a sampled signal or a function of time may be somewhere else from
one instant to the next, and what is stored is not. To put the state back there would be a jump that
nobody is told of. Sliding has ended then: the machine is on the side that its function says, and
the motion leads back to the surface or away from it.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.lu import SINGULAR, lu_factor, lu_solve
from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.engine import OK, Engine
from hybond.engine.method_numbers import EULER, RK4
from hybond.engine.mode.digits.reach import reach_of
from hybond.engine.model import Model
from hybond.engine.surfaces.blend import blend
from hybond.engine.surfaces.corners import put_slopes
from hybond.engine.surfaces.onto import direction, side_value
from hybond.engine.surfaces.outputs import show_state
from hybond.engine.surfaces.slide_records import Slide
from hybond.engine.words import Floats

APART: Final = 1e-9
"""Part of what may be stored by which a state is put onto a surface that has jumped, at least."""
ERROR: Final = 1e-5
"""Part of it by which steps may drift off, ..."""
TOLERATED: Final = 100.0
"""... or so many times the tolerance."""


def find_parted(e: Engine, t: float, y: Floats, part: float) -> bool:
    """Find which surfaces are farther from the state than a part of it, into ``parted``.

    Whether any is. Where the modes around have no combination any more, that is for who decides how
    to go on.
    """
    s = e.slide
    m = e.model
    some = False
    copy_part(m.switches + m.state_first[m.machines], e.mode.flags, 0, e.shown, m.on_slot)
    show_state(e, t, y, e.shown)
    for j in range(s.k):
        s.gap[j] = side_value(e, j, e.shown)
        s.parted[s.side[j]] = 0
        some = some or s.gap[j] != 0.0
    if not some:
        return False
    show_state(e, t, y, e.shown)
    s.known = False
    if blend(e, e.shown) != OK:
        return False
    put_slopes(s)
    sizes_stored(e, y)
    some = False
    for j in range(s.k):
        if s.gap[j] != 0.0 and is_parted(e, y, j, part):
            s.parted[s.side[j]] = 1
            some = True
    s.known = False
    return some


def is_parted(e: Engine, y: Floats, j: int, part: float) -> bool:
    """Whether it takes such a jump to put the state on a surface, and on no other than before."""
    s = e.slide
    copy_floats(s.k * s.k, s.change, s.matrix)
    for p in range(s.k):
        s.right[p] = s.gap[j] if p == j else 0.0
    if lu_factor(s.k, s.matrix, s.pivot) == SINGULAR:
        return True  # nothing leads there
    lu_solve(s.k, s.matrix, s.pivot, 1, s.right)
    for k in range(e.states):
        way = 0.0
        for p in range(s.k):
            way += s.right[p] * direction(e, p, k)
        if not math.fabs(way) <= part * max(math.fabs(y[k]), s.size[k]):
            return True
    return False


def is_far(e: Engine, before: Floats, y: Floats) -> bool:
    """Whether a state has been put farther than the error of a step: no drift is that long.

    Steps of fixed length have no bound on their error but their own length.
    """
    m = e.model
    s = e.slide
    sizes_stored(e, y)
    part = error_of(m)
    if m.method == RK4 or m.method == EULER:
        for k in range(e.states):
            part = max(part, part_of(s, e.step.y0, e.step.y1, k))
    given = TOLERATED * m.atol if m.atol == m.atol else 0.0
    for k in range(e.states):
        if not math.fabs(y[k] - before[k]) <= given and not part_of(s, before, y, k) <= part:
            return True
    return False


def error_of(m: Model) -> float:
    """Return by what part of what is stored steps may be off."""
    return max(ERROR, TOLERATED * m.rtol)


def part_of(s: Slide, before: Floats, y: Floats, k: int) -> float:
    """Return by what part of its size a state differs; 0 of what has none."""
    size = max(math.fabs(y[k]), s.size[k])
    return math.fabs(y[k] - before[k]) / size if size > 0.0 else 0.0


def sizes_stored(e: Engine, y: Floats) -> None:
    """Put what each state may be into ``size``: what it was, what energy or time may make of it.

    The fields around are those that were combined last.
    """
    m = e.model
    s = e.slide
    reach_of(e, e.mode, y, e.work.reach)
    for k in range(e.states):
        s.size[k] = max(e.lately[k], e.work.reach[k] if k < m.storages else 0.0)
    for part in range(s.parts):
        for k in range(m.storages, e.states):
            led = math.fabs(e.t * s.part_rate[part * e.states + k])
            s.size[k] = max(s.size[k], led)
