"""How a state on switching surfaces goes on. After modes/sliding/ways.py and crossings.py."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine, say_fault
from hybond.engine.instant.entering import enter
from hybond.engine.instant.jump import enter_mode, is_constrained
from hybond.engine.instant.trial import a_priori
from hybond.engine.mode.equations import is_fieldless, mode_of
from hybond.engine.mode.newton import solve
from hybond.engine.mode.storage import reach_of
from hybond.engine.mode.values import evaluate, field
from hybond.engine.model import value
from hybond.engine.reasons.warned import OWN_JUMP, TWIN_SURFACES, add_about, begin_warning
from hybond.engine.sliding.blend import blend, find_speeds, show_state, take_parts
from hybond.engine.sliding.common_space import ALONE, NEVER, can_keep, find_common
from hybond.engine.sliding.filippov import ABOVE, BELOW, SLIDES, find_ways
from hybond.engine.sliding.slide_records import MOST
from hybond.engine.sliding.surface import is_of_state, part_mode, surface_rate
from hybond.engine.sliding.ways_told import (
    warn_of_no_way,
    warn_of_strokes,
    warn_of_surface,
    warn_of_ways,
)
from hybond.engine.words import Floats, Ints, Text

VANISHED: Final = 1e-9
"""A jump below this part of what may be stored has vanished."""
MOVES_ALIKE: Final = 1e-12
"""Two states of a machine move what is stored alike if their rates differ by less: rounding."""
ADDITIVE: Final = 1e-9
"""Fields are additive if what they lack is below this part of them."""
AGREES: Final = 1e-9
"""Parts give a switching function one value up to this part of what it reads."""
NO_WAY: Final = 0
A_WAY: Final = 1
STOPS: Final = 2


def vanishes(e: Engine, moved: Floats, y: Floats) -> bool:
    """Whether a jump of what is stored is next to nothing."""
    m = e.model
    reach_of(e, y, e.energy, e.work.reach)
    for k in range(m.storages):
        if not math.fabs(moved[k]) <= VANISHED * (math.fabs(y[k]) + e.work.reach[k]):
            return False
    return True


def choose_branches(e: Engine, state: Ints) -> None:
    """Give a mode the branches that its junction laws have in the present state."""
    m = e.model
    if m.laws == 0:
        return
    n = m.storages
    for k in range(m.integrals):
        e.slide.signal[k] = e.y[n + k]
    if a_priori(e, e.t, e.y, e.slide.signal, state) != OK:
        return
    for k in range(m.machines):
        e.slide.state[k] = state[k]
    if enter(e, e.t, e.y, e.slide.signal, e.slide.state, True, False) == OK:
        for k in range(m.machines):
            state[k] = e.trial.state[k]


def take_met(e: Engine, first: int, many: int) -> int:
    """Take some of the surfaces met as those to be combined, with the modes around them."""
    s = e.slide
    s.k = many
    for j in range(many):
        s.side[j] = s.met_surface[first + j]
    if e.model.laws == 0:
        return take_parts(e, s.around)
    return take_branched(e)


def take_branched(e: Engine) -> int:
    """Take the modes around some surfaces, each with the branches of its junction laws."""
    m = e.model
    s = e.slide
    many = s.k
    for part in range(many + 1):
        for machine in range(m.machines):
            s.target[machine] = s.around[machine]
        for j in range(many):
            surface = s.side[j]
            above = part == j + 1
            s.target[m.surface_machine[surface]] = (
                m.surface_above[surface] if above else m.surface_below[surface]
            )
        choose_branches(e, s.target)
        s.k = many
        if mode_of(e, s.target) != OK:
            return STOPS
        s.part[part] = e.mode_at
    return mode_of(e, s.around)


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
    for part in range(s.k + 1):
        if not is_taken(e, part):
            return False
    how = find_common(e)
    if how != ALONE and how != NEVER:
        for part in range(s.k + 1):
            mode = part_mode(e, part)
            show_state(e, e.t, e.y, s.v)
            for k in range(m.switches + m.state_first[m.machines]):
                s.v[m.on_slot + k] = mode.flags[k]
            if solve(e, mode, s.v) != OK:
                return False
            for k in range(m.storages):
                at = m.storage_bond[k] + (m.bonds if m.storage_kind[k] == 0 else 0)
                negative = m.storage_kind[k] == 0 and m.storage_sign[k] < 0
                s.rates[k] = -e.work.w[at] if negative else e.work.w[at]
            if not can_keep(e, s.v, s.rates):
                return False
    return how != NEVER


def decide(e: Engine) -> int:
    """Decide how the state goes on from the surfaces met: NO_WAY, A_WAY or STOPS.

    `sides` says on entry on which side each surface is now; the way is in ``best``, for the
    surfaces that are left in ``met_surface``.
    """
    m = e.model
    s = e.slide
    if one_each(e) != OK or leave_agreeing(e) != OK:
        return STOPS
    if s.met == 0:
        return NO_WAY
    if s.met > MOST:
        return stop(e, "sliding on so many surfaces at once is not part of an export")
    if take_met(e, 0, s.met) != OK:
        return STOPS
    for j in range(s.k):
        if not is_of_state(e, s.side[j]):
            if s.k == 1 and not is_one_value(e):
                if m.tells != 0:
                    warn_of_surface(e, OWN_JUMP, s.side[j])
                # the switch itself makes it jump: there is no surface to slide on
                s.met = 0
                return NO_WAY
            return stop(e, "a surface that reads what can jump is not part of an export")
    how = find_common(e)
    show_state(e, e.t, e.y, s.v)
    if find_speeds(e, True) != OK:
        return STOPS
    if s.k > 1:
        found = is_additive(e)
        if found != OK:
            return STOPS
    for j in range(s.k):
        surface = s.side[j]
        state = s.around[m.surface_machine[surface]]
        slid = False
        for i in range(s.many):
            slid = slid or s.surface[i] == surface
        s.sides[j] = SLIDES if slid else ABOVE if state == m.surface_above[surface] else BELOW
    if find_ways(e) == 0:
        if m.tells != 0:
            warn_of_no_way(e)
        return NO_WAY
    if m.tells != 0:
        warn_of_ways(e)
    slides = 0
    for j in range(s.k):
        slides += 1 if s.best[j] == SLIDES else 0
    if how != ALONE and slides > 0:
        return push(e, slides)
    if m.tells != 0 and how != ALONE and s.k == 1:
        warn_of_strokes(e)
    return A_WAY


def is_one_value(e: Engine) -> bool:
    """Whether both parts give the only switching function the same value.

    After Combined.outputs_agree.
    """
    m = e.model
    s = e.slide
    surface = s.side[0]
    low = 0.0
    size = 0.0
    for part in range(2):
        mode = part_mode(e, part)
        show_state(e, e.t, e.y, s.v)
        for k in range(m.switches + m.state_first[m.machines]):
            s.v[m.on_slot + k] = mode.flags[k]
        if solve(e, mode, s.v) != OK:
            return True
        g = value(m, m.surface_value[surface], s.v)
        for i in range(m.surface_first[surface], m.surface_first[surface + 1]):
            if m.surface_kind[i] == 4:
                size = max(size, math.fabs(s.v[m.bond_slot + m.surface_index[i]]))
        if part == 0:
            low = g
            s.right[0] = math.fabs(g)
        elif math.fabs(g - low) > AGREES * (size + max(s.right[0], math.fabs(g))):
            return False
    return True


def stop(e: Engine, why: Text) -> int:
    """Refuse what is not part of an export."""
    say_fault(e, "HB-E635", why, "")
    return STOPS


def push(e: Engine, slides: int) -> int:
    """Leave out surfaces that a mode leads away from before any jump.

    On the mean a mode may be led back by its jumps alone; but there are none if it never returns.
    """
    s = e.slide
    show_state(e, e.t, e.y, e.shown)
    s.known = False
    if blend(e, e.shown) != OK:
        return STOPS
    away = False
    for j in range(s.k):
        away = away or s.margin[2 * j] < 0.0 or s.margin[2 * j + 1] < 0.0
    if slides < s.k or not away:
        return A_WAY
    for j in range(s.k):
        low = s.margin[2 * j]
        high = s.margin[2 * j + 1]
        if min(low, high) < 0.0:
            s.best[j] = BELOW if low <= high else ABOVE
    return A_WAY


def is_additive(e: Engine) -> int:
    """Refuse switches that do not act independently of each other. After sliding_program.additive.

    Held against the fields with all machines above, and with every other one.
    """
    m = e.model
    s = e.slide
    for check in range(3):
        for k in range(m.machines):
            s.target[k] = s.around[k]
        for j in range(s.k):
            up = check == 0 or j % 2 == (0 if check == 1 else 1)
            s.trial_side[j] = 1 if up else 0
            surface = s.side[j]
            s.target[m.surface_machine[surface]] = (
                m.surface_above[surface] if up else m.surface_below[surface]
            )
        choose_branches(e, s.target)
        if mode_of(e, s.target) != OK:
            return STOPS
        show_state(e, e.t, e.y, s.v)
        for k in range(m.switches + m.state_first[m.machines]):
            s.v[m.on_slot + k] = e.mode.flags[k]
        if solve(e, e.mode, s.v) != OK:
            return STOPS
        most = 0.0
        for k in range(2 * m.bonds):
            most = max(most, math.fabs(e.work.w[k]))
        for k in range(2 * m.bonds):
            expected = s.solution[k]
            size = math.fabs(s.solution[k])
            for j in range(s.k):
                own = s.solution[(j + 1) * 2 * m.bonds + k]
                size = max(size, math.fabs(own))
                expected += float(s.trial_side[j]) * (own - s.solution[k])
            if math.fabs(e.work.w[k] - expected) > ADDITIVE * (float(s.k) * size + most):
                why = "surfaces whose switches act on each other are not part of an export"
                return stop(e, why)
    return OK


def one_each(e: Engine) -> int:
    """Keep one surface of those that coincide: that whose machine moves something."""
    m = e.model
    s = e.slide
    kept = 0
    for i in range(s.met):
        surface = s.met_surface[i]
        twin = -1
        for j in range(kept):
            if m.surface_twin[surface * m.surfaces + s.met_surface[j]] != 0:
                twin = j
        if twin < 0:
            s.met_surface[kept] = surface
            kept += 1
        elif acts(e, surface) and not acts(e, s.met_surface[twin]):
            s.met_surface[twin] = surface
        elif m.tells != 0 and acts(e, surface):
            begin_warning(e.warned, TWIN_SURFACES, e.t)
            add_about(e.warned, float(s.met_surface[twin]))
            add_about(e.warned, float(surface))
    s.met = kept
    return OK


def acts(e: Engine, surface: int) -> bool:
    """Whether a machine's two states move the stored quantities differently."""
    m = e.model
    s = e.slide
    k = s.k
    s.k = 0
    different = False
    for side in range(2):
        for machine in range(m.machines):
            s.target[machine] = s.around[machine]
        s.target[m.surface_machine[surface]] = (
            m.surface_above[surface] if side == 1 else m.surface_below[surface]
        )
        choose_branches(e, s.target)
        if mode_of(e, s.target) != OK or not find_field(e, s.rates if side == 0 else s.rate):
            s.k = k
            return True
    for i in range(e.states):
        size = math.fabs(s.rates[i]) + math.fabs(s.rate[i])
        different = different or math.fabs(s.rates[i] - s.rate[i]) > MOVES_ALIKE * size
    s.k = k
    return different


def find_field(e: Engine, rate: Floats) -> bool:
    """Put the rates of the present state in ``e.mode`` there; False if there are none."""
    m = e.model
    for k in range(m.slots):
        e.v[m.slots + k] = 0.0
    for k in range(m.switches + m.state_first[m.machines]):
        e.v[m.on_slot + k] = e.mode.flags[k]
    # functions of surfaces may read any bond variable
    return field(e, e.mode, e.t, e.y, rate) == OK and solve(e, e.mode, e.v) == OK


def leave_agreeing(e: Engine) -> int:
    """Leave the surfaces around which all modes can keep the state."""
    s = e.slide
    while s.met > 0:
        if s.met > MOST:
            return stop(e, "sliding on so many surfaces at once is not part of an export")
        if take_met(e, 0, s.met) != OK:
            return STOPS
        if do_meet(e):
            return OK
        kept = 0
        for i in range(s.met):
            if take_met(e, i, 1) != OK:
                return STOPS
            if do_meet(e):
                s.met_surface[kept] = s.met_surface[i]
                kept += 1
        s.met = kept if kept < s.met else 0
    return OK


def no_time(e: Engine, surface: int) -> bool:
    """Whether the modes on both sides, entered from here, push back into the surface."""
    m = e.model
    s = e.slide
    s.met_surface[0] = surface
    if take_met(e, 0, 1) != OK or not is_of_state(e, surface):
        return False
    for k in range(e.states):
        s.y[k] = e.y[k]
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
            for k in range(2 * m.slots):
                s.v[k] = e.v[k]
            speed = surface_rate(e, surface, s.v, s.rates, 0, True)
        for k in range(m.storages):
            e.y[k] = s.keep[k]
        if not found:
            return False
        pushes = pushes and (speed > 0.0 if part == 0 else speed < 0.0)
    return pushes
