"""Laws with several solutions: that there is another one than the run takes is said.

Where a run begins, and behind a jump, nothing says which of them holds. Time-stepping, `qss`,
motion along surfaces, laws that jump and hidden constraints follow none: they may go over from one
to another. What is said was found; it is looked for now and then, and said once of each.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_part
from hybond.engine.checks.another import element_of
from hybond.engine.engine import OK, Engine
from hybond.engine.method_numbers import MOREAU, QSS1
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.limits import put_limits
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.mode.nonlinear.newton import keep_guess
from hybond.engine.mode.nonlinear.others import (
    LOOKED_WITH,
    finds_another,
    may_have_others,
    part_apart,
)
from hybond.engine.mode.solving import solve_in_step
from hybond.engine.reasons.warned import ANOTHER, add_about, begin_warning
from hybond.engine.surfaces.surface import part_mode
from hybond.engine.surfaces.values import set_state
from hybond.engine.words import Floats

CHOSEN: Final = 0
BY_METHOD: Final = 1
BY_SURFACES: Final = 2
BY_LAWS: Final = 3
"""Why it is said: nothing says which solution goes on; or none is followed, by the method, along
surfaces, or of such laws."""
NEAR: Final = 1e-3
"""Part of a variable, and of the largest of its kind, by which it may differ where it goes on."""
NO_MORE: Final = -1
OFTEN: Final = 64
MORE: Final = 16
"""After so many times it is looked for each time that there have been a 16th more."""
FIRST: Final = 8
PATIENT: Final = 4
"""The first times it is looked for longer: so many times with shorter steps where full ones do not
settle."""


def see_chosen(e: Engine) -> None:
    """Tell if the solution that a motion begins to follow is one of several."""
    if may_look(e, 0) and may_have_others(e, e.mode):
        look_beside(e, e.mode, CHOSEN, e.y, e.root_now)


def see_left(e: Engine) -> None:
    """Tell if there are several, while none is followed."""
    if not may_look(e, 1):
        return
    if e.slide.k > 0:
        for part in range(e.slide.parts):
            if may_have_others(e, part_mode(e, part)):
                look_beside(e, part_mode(e, part), BY_SURFACES, e.y, e.root_now)
                return
    elif may_have_others(e, e.mode):
        look_beside(e, e.mode, BY_METHOD if e.model.method >= QSS1 else BY_LAWS, e.y, e.root_now)


def see_left_by_steps(e: Engine, w: Floats) -> None:
    """Do the same at the end of a step of time-stepping, where bond variables are `w`."""
    if e.model.curved == 0 or not may_look(e, 1):
        return
    if mode_of(e, e.state) == OK and may_have_others(e, e.mode):
        look_beside(e, e.mode, BY_METHOD, e.y, w)


def may_look(e: Engine, which: int) -> bool:
    """Whether somebody is told, has not been yet, and something is left to look with."""
    f = e.work.following
    told = f.due.at[which] == NO_MORE or e.checks.violated > 0
    return e.model.tells != 0 and not told and f.spent <= LOOKED_WITH


def asks_again(e: Engine, which: int) -> bool:
    """Whether it is time to look."""
    f = e.work.following
    f.asked.at[which] += 1
    many = f.asked.at[which]
    if many < f.due.at[which]:
        return False
    f.due.at[which] = many + 1 if many < OFTEN else many + many // MORE
    return True


def look_beside(e: Engine, mode: Mode, why: int, y: Floats, near: Floats) -> None:
    """Tell if laws have another solution with state `y` than that which is near bond variables."""
    m = e.model
    f = e.work.following
    which = 0 if why == CHOSEN else 1
    if not asks_again(e, which):
        return
    v = e.checks.other
    for k in range(2 * m.slots):
        v[k] = 0.0
    set_state(e, mode, v, e.t, y)
    put_limits(e, mode, v)
    refused = e.refusal
    regular = mode.regular
    solves = mode.solves
    patient = PATIENT if f.asked.at[which] <= FIRST else 0
    hold_guess(e, mode)
    if e.slide.k == 0 and (why == CHOSEN or m.method == MOREAU):
        keep_guess(mode, near)
    copy_part(m.slots, v, 0, v, m.slots)
    if solve_in_step(e, mode, v) == OK and finds_another(e, mode, v, patient):
        f.due.at[which] = NO_MORE
        tell_of_both(e, mode, why)
    give_back_guess(e, mode)
    mode.solves = solves
    mode.regular = regular
    e.refusal = refused


def tell_of_both(e: Engine, mode: Mode, why: int) -> None:
    """Tell of both: which law's variable is most apart, by parts of itself, and both its values."""
    m = e.model
    f = e.work.following
    best = -1
    law = -1
    most = 0.0
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        k = m.dynamic_partner[d] if d >= 0 else -1
        apart = part_apart(e, f.another.at, k) if k >= 0 else 0.0
        if apart > most:
            most = apart
            best = k
            law = d
    element = element_of(e, mode)
    for j in range(m.elements if law >= 0 else 0):
        if m.element_node[j] == m.dynamic_node[law]:
            element = j
    for k in range(2 * m.bonds if law < 0 else 0):
        apart = part_apart(e, f.another.at, k)
        if apart > most:
            most = apart
            best = k
    begin_warning(e.warned, ANOTHER, e.t)
    add_about(e.warned, float(why))
    add_about(e.warned, float(element))
    add_about(e.warned, float(best))
    add_about(e.warned, f.root_here.at[best])
    add_about(e.warned, f.another.at[best])


def is_as_before(e: Engine, before: Floats) -> bool:
    """Whether the bond variables in `e.work.w` are those of before, but for little."""
    for k in range(2 * e.model.bonds):
        off = math.fabs(e.work.w[k] - before[k])
        if off > NEAR * max(math.fabs(e.work.w[k]), math.fabs(before[k])):
            largest = e.checks.largest[e.model.bond_class[k]]
            if off > NEAR * largest:
                return False
    return True
