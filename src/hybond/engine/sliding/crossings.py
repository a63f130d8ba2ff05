"""What crossing a surface does to what is stored: nothing, a jump that vanishes, or one that stays.

Modes with different constraints can slide along their surface where all constraints are met, since
a jump is nothing there. Off that place, jumps that do not move the switching function bring a state
to it at once: switching back and forth in no time ends where all constraints are met, whatever it
began with (alternating projections, von Neumann).
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import copy_floats
from hybond.engine.engine import OK, Engine
from hybond.engine.instant.small_jumps import vanishes
from hybond.engine.jumps.jump import enter_mode
from hybond.engine.mode.equations import is_fieldless
from hybond.engine.mode.mode_records import is_constrained
from hybond.engine.mode.rows.storage import energy_of
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.reasons.warned import WITHOUT_END, add_about, begin_warning
from hybond.engine.sliding.around import find_field, take_met
from hybond.engine.surfaces.common_space import (
    ALONE,
    NEVER,
    TOGETHER,
    can_keep,
    find_common,
    find_correction,
)
from hybond.engine.surfaces.outputs import show_state, solve_plain
from hybond.engine.surfaces.surface import part_mode, put_read, surface_rate
from hybond.engine.surfaces.values import evaluate
from hybond.engine.words import Floats

MET: Final = 1e-12
"""A constraint is met if its residual is below this part of its terms."""
TURNS: Final = 3
"""Times that a state is moved to where all constraints are met."""


# -- without a jump


def is_taken(e: Engine, part: int) -> bool:
    """Whether a mode around a surface can be entered without a jump."""
    m = e.model
    s = e.slide
    mode = part_mode(e, part)
    if is_fieldless(e, mode):
        return False
    if not is_constrained(mode):
        return True
    if not enter_part(e, part, s.x):
        return False
    for k in range(m.storages):
        s.x[k] -= e.y[k]
    return vanishes(e, s.x, e.y)


def enter_part(e: Engine, part: int, after: Floats) -> bool:
    """Put what entering a mode around a surface makes of the state into `after`."""
    # bond variables are those of the mode alone
    k = e.slide.k
    mode = part_mode(e, part)
    e.slide.k = 0
    entered = evaluate(e, mode, e.shown, e.t, e.y) == OK
    entered = entered and enter_mode(e, mode, e.shown, e.y, after) == OK
    e.slide.k = k
    return entered


def do_meet(e: Engine) -> bool:
    """Whether the state is where all constraints of the parts are met, and can be kept there."""
    m = e.model
    s = e.slide
    for part in range(s.parts):
        if not is_taken(e, part):
            return False
    how = find_common(e)
    if how != ALONE and how != NEVER:
        for part in range(s.parts):
            show_state(e, e.t, e.y, s.v)
            if solve_plain(e, part, s.v) != OK:
                return False
            for k in range(m.storages):
                at = rate_bond(m, k)
                s.rates[k] = way_of_rate(m, k) * e.work.w[at]
            if not can_keep(e, s.v, s.rates):
                return False
    return how != NEVER


# -- with jumps


def collapse(e: Engine, surface: int) -> bool:
    """Put the state where switching back and forth over a surface in no time ends.

    False if it ends nowhere, or if time passes on one of the sides. The state before is in
    ``before``, the impulses in ``impulses``, energies beside.
    """
    m = e.model
    s = e.slide
    if not no_time(e, surface):
        return False
    copy_floats(e.states, e.y, s.before)
    if find_common(e) != TOGETHER or not is_still(e, surface):
        warn_without_end(e, surface)
        return False
    fit(s.total, s.areas)
    for a in range(s.areas):
        s.total.at[a] = 0.0
    for _ in range(TURNS):
        show_state(e, e.t, e.y, s.v)
        find_correction(e, s.v)
        for a in range(s.areas):
            s.total.at[a] -= s.area.at[a]
        for k in range(m.storages):
            change = 0.0
            for a in range(s.areas):
                change += s.moves.at[k * s.areas + a] * s.total.at[a]
            e.y[k] = s.before[k] + change
    if not is_met(e):
        take_back(e)
        warn_without_end(e, surface)
        return False
    for b in range(2 * m.bonds):
        s.impulses[b] = 0.0
        for a in range(s.areas):
            s.impulses[b] += s.directions.at[b * s.areas + a] * s.total.at[a]
    s.energy_before = energy_of(e, s.before)
    s.energy_after = energy_of(e, e.y)
    return True


def warn_without_end(e: Engine, surface: int) -> None:
    """Warn that no sliding motion is the limit of jumps back and forth."""
    if e.model.tells != 0 and e.slide.endless[surface] == 0:
        e.slide.endless[surface] = 1
        begin_warning(e.warned, WITHOUT_END, e.t)
        add_about(e.warned, float(surface))


def take_back(e: Engine) -> None:
    """Put the state before the jumps there again."""
    copy_floats(e.states, e.slide.before, e.y)


def is_met(e: Engine) -> bool:
    """Whether the state is where all constraints are met, and can be kept there."""
    s = e.slide
    show_state(e, e.t, e.y, s.v)
    find_correction(e, s.v)
    for i in range(s.held):
        if not math.fabs(s.off.at[i]) <= MET * s.off_size.at[i]:
            return False
    areas = s.areas
    return do_meet(e) and s.areas == areas


def is_still(e: Engine, surface: int) -> bool:
    """Whether jumps move neither the switching function nor anything by a source's impulse."""
    m = e.model
    s = e.slide
    show_state(e, e.t, e.y, s.v)
    put_read(e, surface, s.v)
    for a in range(s.areas):
        change = moved_by_area(e, surface, a, False)
        size = moved_by_area(e, surface, a, True)
        if not math.fabs(change) <= MET * max(math.fabs(size), 1.0):
            return False
        for k in range(m.sources):
            bond = m.source_bond[k] % m.bonds
            for b in range(2):
                at = (bond + b * m.bonds) * s.areas + a
                if not math.fabs(s.directions.at[at]) <= MET:
                    return False
    return True


def moved_by_area(e: Engine, surface: int, a: int, sized: bool) -> float:
    """Return what one of the impulses does to a switching function, or by how much at most."""
    m = e.model
    s = e.slide
    for k in range(e.states):
        move = s.moves.at[k * s.areas + a] if k < m.storages else 0.0
        s.rates[k] = math.fabs(move) if sized else move
    return surface_rate(e, surface, s.v, s.rates, 0, False)


def no_time(e: Engine, surface: int) -> bool:
    """Whether the modes on both sides, entered from here, push back into the surface."""
    m = e.model
    s = e.slide
    s.met = 1
    s.met_surface[0] = surface
    if take_met(e, 0, 1, False) != OK or s.of_state[0] == 0:
        return False
    copy_floats(e.states, e.y, s.y)
    pushes = True
    for part in range(2):
        if is_fieldless(e, part_mode(e, part)) or not enter_part(e, part, s.y):
            return False
        e.mode = part_mode(e, part)
        for k in range(m.storages):
            s.keep[k] = e.y[k]
            e.y[k] = s.y[k]
        s.k = 0
        found = find_field(e, s.rates)
        s.k = 1
        speed = 0.0
        if found:
            copy_floats(2 * m.slots, e.v, s.v)
            speed = surface_rate(e, surface, s.v, s.rates, 0, True)
        copy_floats(m.storages, s.keep, e.y)
        if not found:
            return False
        pushes = pushes and (speed > 0.0 if part == 0 else speed < 0.0)
    return pushes
