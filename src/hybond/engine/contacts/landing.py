"""Landing: what happens where impacts accumulate.

A machine lands when its next flight would be below the position tolerance and all that is left of
its flights below the time room; such a flight is never started. It then stays in its pinnacle
state, whose impact law has every ``pre()`` term at its limit 0. Its own exits are suspended. It
leaves, by its first exit, when the reaction (the conjugate of what the impact law prescribes)
changes the sign that its impulses had. A landing is accepted only if the reaction has that sign to
begin with. Source: Mosterman & Biswas 2002, section 4.
"""

import math
from typing import Final

from hybond.engine.algebra.products import all_finite, copy_floats, copy_part, copy_places
from hybond.engine.contacts.accumulation import (
    POSITION,
    chatters,
    fell_silent,
    limit_of,
    restart,
    room_of,
    tick_of,
)
from hybond.engine.contacts.coming_back import comes_back
from hybond.engine.contacts.impacts_seen import forget_left
from hybond.engine.contacts.landing_records import CROWD, Landings, in_force
from hybond.engine.contacts.rest import find_moved, find_rest, still_stored
from hybond.engine.contacts.unrest import (
    REBOUNDS,
    tell_no_solution,
    tell_refusal,
    tell_verdict,
    warn_of_unrest,
)
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.expressions.paired import holds
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.guard_values import (
    ask_in_motion,
    begin_sizes_in_motion,
    measure_in_motion,
)
from hybond.engine.instant.back_by_dust import refuse_turns
from hybond.engine.instant.instant import (
    ACCUMULATION,
    CONTINUOUS,
    PINNACLE,
    Instant,
    add_energy,
    begin_instant,
    note_fired,
    note_step,
)
from hybond.engine.instant.settle import settle
from hybond.engine.instant.settling import Settling
from hybond.engine.instant.telling import supplied_by_jump, supplied_now
from hybond.engine.instant.told import LANDS, add_read, say_why
from hybond.engine.jumps.trial import a_priori
from hybond.engine.mode.digits.fading import remember_jump
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.rows.storage import energy_of
from hybond.engine.model import Model
from hybond.engine.surfaces.combine import combine_here
from hybond.engine.surfaces.values import begin_field, evaluate, field
from hybond.engine.words import Floats

FEW_EVENTS: Final = 1e-13
"""What counts as no time for a crowd of events, as a part of the run."""


SILENT: Final = 0
"""Why events accumulate that nothing was landed for: impacts follow each other too fast."""
CHATTERS: Final = 1
"""Other events of a machine have a limit."""
NO_TIME: Final = 2
"""No time passes between many of them."""
SLOW: Final = 1e-3
FADING: Final = 1000.0
"""A rebound is looked at more closely if the last flight was shorter than FADING times the time
room; one at less than half the speed of the approach also if it is below the part SLOW of the
fastest approach."""


def land_contacts(e: Engine, s: Settling, i: Instant) -> int:
    """Land the machines whose impacts, just observed, are over: 1 if there are any, 0 if not.

    -1 for a refusal. Call it until there are none; `i` is then the event.
    """
    g = e.landings
    kept = 0
    for k in range(g.touches):
        if worth_trying(e, g, k):
            g.touch_contact[kept] = g.touch_contact[k]
            g.touch_gap[kept] = g.touch_gap[k]
            g.touch_approach[kept] = g.touch_approach[k]
            g.touch_rebound[kept] = g.touch_rebound[k]
            kept += 1
    g.touches = kept
    first = 0 if kept > 1 else 1
    for turn in range(first, kept + 1):
        for k in range(kept):
            g.chosen[k] = 1 if turn == 0 or k == turn - 1 else 0
        if would_rest(e, g):
            return put_down(e, g, s, i)
        if e.model.tells != 0:
            tell_verdict(e, g)
    g.touches = 0
    if kept > 0 and (mode_of(e, e.state) != OK or combine_here(e, e.state) != OK):
        return -1
    return 0


def worth_trying(e: Engine, g: Landings, k: int) -> bool:
    """Whether an impact is looked at more closely."""
    m = e.model
    contact = g.touch_contact[k]
    machine = m.contact_machine[contact]
    here = m.state_first[machine] + e.state[machine]
    rest = m.state_first[machine] + m.contact_rest[contact]
    closed = True
    for p in range(m.on_first[rest], m.on_first[rest + 1]):
        found = False
        for q in range(m.on_first[here], m.on_first[here + 1]):
            found = found or m.on_switch[q] == m.on_switch[p]
        closed = closed and found
    if closed:
        return False  # it closed without our help
    # one that rebounds at half its speed or more flies about as long as before
    lively = g.touch_rebound[k] >= 0.5 * g.touch_approach[k]
    slow = not lively and g.touch_rebound[k] <= SLOW * g.speed[machine]
    return slow or g.touch_gap[k] <= FADING * room_of(e.t, e.span)


def would_rest(e: Engine, g: Landings) -> bool:
    """Try the structure at rest of the chosen contacts, and see what it would have to carry."""
    m = e.model
    copy_places(m.machines, e.state, 0, g.state, 0)
    for k in range(g.touches):
        if g.chosen[k] != 0:
            contact = g.touch_contact[k]
            g.state[m.contact_machine[contact]] = m.contact_rest[contact]
    for k in range(g.touches):
        if g.chosen[k] != 0 and not comes_back(e, g, k):
            if m.tells != 0:
                g.why = REBOUNDS
            return False
    copy_floats(m.storages, e.y, g.x)
    copy_part(m.integrals, e.y, m.storages, g.s, 0)
    if a_priori(e, e.t, g.x, g.s, e.state) != OK:
        if m.tells != 0:
            tell_no_solution(e, g)
        return False
    hold_chosen(m, g, True)
    # modes around a surface have the branches of this trial, not those that were chosen before it
    branches = e.slide.branches
    e.slide.branches = 0
    found = find_rest(e, g, e.t, g.state)
    e.slide.branches = branches
    hold_chosen(m, g, False)
    if found != OK:
        if m.tells != 0:
            tell_no_solution(e, g)
        return False
    some_found = False
    for k in range(g.touches):
        if g.chosen[k] == 0:
            continue
        contact = g.touch_contact[k]
        for r in range(m.reaction_first[contact], m.reaction_first[contact + 1]):
            if not carries(e, g, r):
                if m.tells != 0:
                    tell_refusal(e, g, r)
                return False
        if not flight_over(e, g, k):
            if m.tells != 0:
                g.why = REBOUNDS
            return False
        if not some_found or g.limit_t > g.found_t:
            g.found_t = g.limit_t
            g.found_ratio = g.limit_ratio
        some_found = True
    return some_found


def hold_chosen(m: Model, g: Landings, on: bool) -> None:
    """Let the chosen contacts be held as where they have landed: what leads there does not lead on.

    They may follow machines that others follow where these slide. None has landed before: what has
    is not struck.
    """
    for k in range(g.touches):
        contact = g.touch_contact[k]
        if g.chosen[k] != 0 and m.is_law[m.contact_machine[contact]] == 0:
            g.landed[m.contact_machine[contact]] = contact if on else -1


def carries(e: Engine, g: Landings, r: int) -> bool:
    """Whether a reaction is what the equations at rest say, and of the sign of its impulses."""
    column = e.model.reaction_column[r]
    for j in range(g.loose):
        if e.trial.freedom.at[column * g.loose + j] != 0.0:
            return False
    force = g.force[column]
    if not math.fabs(force) > ROUNDING * g.size[column]:
        return False
    return g.sign[r] == (1 if force > 0.0 else -1)


def flight_over(e: Engine, g: Landings, k: int) -> bool:
    """Whether the next flight is none; the limit of the impacts is then in `g.limit_t`."""
    m = e.model
    contact = g.touch_contact[k]
    machine = m.contact_machine[contact]
    tick = tick_of(e.t, e.span)
    room = room_of(e.t, e.span)
    flight = 0.0
    peak = 0.0
    for r in range(m.reaction_first[contact], m.reaction_first[contact + 1]):
        force = math.fabs(g.force[m.reaction_column[r]])
        area = math.fabs(g.area[m.reaction_column[r]])
        flight = max(flight, 2.0 * area / force)
        peak = max(peak, g.touch_rebound[k] * area / (2.0 * force))
    ratio = 0.0
    if g.touch_approach[k] > 0.0:
        ratio = g.touch_rebound[k] / g.touch_approach[k]
    told = limit_of(g, g.times, machine, g.kept[machine])
    if flight <= tick:
        if not (told and g.limit_left <= room):
            g.limit_t = e.t
            g.limit_left = 0.0
            g.limit_ratio = math.nan
        return True
    left = flight / (1.0 - ratio) if ratio < 1.0 else math.inf
    if told:
        left = max(left, g.limit_left)
    hidden = flight <= g.touch_hidden[k] and left < math.inf
    if not hidden and (left > room or peak > POSITION * g.flight[machine]):
        return False
    if not told:
        g.limit_t = e.t + left
        g.limit_left = left
        g.limit_ratio = math.nan
    return True


def put_down(e: Engine, g: Landings, s: Settling, i: Instant) -> int:
    """Land the chosen contacts, and settle the instant at their limit."""
    m = e.model
    begin_instant(i, e.t, ACCUMULATION)
    many = 0
    for k in range(g.touches):
        many += g.chosen[k]
    own_limits = many > 1
    left = 0
    for k in range(g.touches):
        contact = g.touch_contact[k]
        if g.chosen[k] == 0:
            g.touch_contact[left] = contact
            g.touch_gap[left] = g.touch_gap[k]
            g.touch_approach[left] = g.touch_approach[k]
            g.touch_rebound[left] = g.touch_rebound[k]
            left += 1
            continue
        machine = m.contact_machine[contact]
        if m.is_law[machine] == 0:
            g.landed[machine] = contact
            e.landed[machine] = 1
            g.any_landed = True
        note_fired(i, machine, e.state[machine], m.contact_rest[contact])
        tell_landing(g, i, machine, own_limits)
        restart(g, machine, g.found_t)
    g.touches = left
    return lie_down(e, g, s, i)


def lie_down(e: Engine, g: Landings, s: Settling, i: Instant) -> int:
    """Take the state at rest that was found, carry it to the limit, and settle the instant there.

    1, or -1 for a refusal. What lands is noted in `i`.
    """
    m = e.model
    note_step(i, CONTINUOUS)
    before = 0.0
    given = 0.0
    power = 0.0
    began = e.t
    if m.tells != 0:
        before = energy_of(e, e.y)
        copy_floats(2 * e.model.bonds, g.area, e.impulses)
        given = supplied_by_jump(e)
        power = supplied_now(e)
    if g.any_landed:
        find_moved(e, g.held)
    if m.laws > 0:
        remember_jump(e, g.x)
    copy_floats(m.storages, g.x, e.y)
    copy_part(m.integrals, g.s, 0, e.y, m.storages)
    copy_places(m.machines, g.state, 0, e.state, 0)
    e.slide.branches = 0
    if carry_over(e, g) != OK:
        return -1
    if m.tells != 0:
        # the impacts that are left out are the jump and what holds the contact up to their limit:
        # alone it takes back the last rebound, and friction that goes with it
        add_energy(i, before, energy_of(e, e.y), given + power * (e.t - began))
    i.t = e.t
    copy_places(m.machines, e.state, 0, g.before_state, 0)
    if settle(e, s, i) != OK or refuse_turns(e, i) != OK:
        return -1
    if i.steps > 1:
        i.kind.at[0] = PINNACLE
    forget_left(e)
    g.event_times[g.events % CROWD] = e.t
    g.events += 1
    return 1


def tell_landing(g: Landings, i: Instant, machine: int, own: bool) -> None:
    """Tell of the transition noted last how many impacts came to an end, and where.

    Of several machines that land at once each has its `own` limit, if its instants tell one.
    """
    t = g.found_t
    ratio = g.found_ratio
    if own and limit_of(g, g.times, machine, g.kept[machine]):
        t = g.limit_t
        ratio = g.limit_ratio
    tell_end(i, g.count[machine], t, ratio)


def tell_end(i: Instant, many: int, t: float, ratio: float) -> None:
    """Tell of the transition noted last that so many impacts came to an end there."""
    say_why(i.told, LANDS)
    add_read(i.told, float(many), 0.0, False)
    add_read(i.told, t, 0.0, False)
    add_read(i.told, ratio, 0.0, False)


def carry_over(e: Engine, g: Landings) -> int:
    """Carry the state over to the limit, unless something else would happen before it.

    One step of the classical Runge-Kutta method.
    """
    n = e.states
    limit = g.found_t
    if not (e.t < limit and limit < min(e.next_break, e.until)):
        return OK
    if mode_of(e, e.state) != OK or combine_here(e, e.state) != OK:
        return REFUSED
    begin_field(e, e.mode)
    h = limit - e.t
    if field(e, e.mode, e.t, e.y, g.rate1) != OK:
        return OK
    move(n, e.y, 0.5 * h, g.rate1, g.at_rest)
    if field(e, e.mode, e.t + 0.5 * h, g.at_rest, g.rate2) != OK:
        return OK
    move(n, e.y, 0.5 * h, g.rate2, g.at_rest)
    if field(e, e.mode, e.t + 0.5 * h, g.at_rest, g.rate3) != OK:
        return OK
    move(n, e.y, h, g.rate3, g.at_rest)
    if field(e, e.mode, limit, g.at_rest, g.rate4) != OK:
        return OK
    for k in range(n):
        between_rates = 2.0 * (g.rate2[k] + g.rate3[k])
        g.at_rest[k] = e.y[k] + h / 6.0 * (g.rate1[k] + between_rates + g.rate4[k])
    if not all_finite(n, g.at_rest) or would_leave(e, g, limit):
        return OK
    copy_floats(n, g.at_rest, e.y)
    e.t = limit
    return OK


def move(n: int, y: Floats, h: float, rate: Floats, there: Floats) -> None:
    """Put ``y + h rate`` there."""
    for k in range(n):
        there[k] = y[k] + h * rate[k]


def would_leave(e: Engine, g: Landings, t: float) -> bool:
    """Whether a guard holds at a point of the motion."""
    m = e.model
    stack = e.work.stack
    if evaluate(e, e.mode, e.v, t, g.at_rest) != OK:
        return True
    begin_sizes_in_motion(e)
    ask_in_motion(e)
    for k in range(m.machines):
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            if m.rule_source[r] != e.state[k] or m.rule_watched[r] == 0:
                continue
            if in_force(m, g, k, r):
                measure_in_motion(e, r)
                if holds(m, r, stack):
                    return True
    return False


def stuck(e: Engine) -> bool:
    """Whether events accumulate that nothing was landed for."""
    m = e.model
    g = e.landings
    for k in range(m.machines):
        g.stuck_machine = k
        g.limit_t = e.t
        g.limit_ratio = math.nan
        if fell_silent(g, k, e.span):
            if not limit_of(g, g.times, k, g.kept[k]):
                g.limit_t = e.t
                g.limit_ratio = math.nan
            g.stuck_events = g.count[k]
            g.stuck_why = SILENT
            if m.tells != 0:
                warn_of_unrest(e, g, k)
            return True
        if chatters(g, k, e.span, e.t):
            g.stuck_events = g.other_kept[k]
            g.stuck_why = CHATTERS
            return True
    g.stuck_machine = -1
    g.limit_t = e.t
    g.limit_ratio = math.nan
    g.stuck_events = CROWD
    g.stuck_why = NO_TIME
    if g.events < CROWD:
        return False
    first = g.event_times[g.events % CROWD]
    last = g.event_times[(g.events - 1) % CROWD]
    return last - first <= FEW_EVENTS * e.span


def keep_still(e: Engine, y: Floats) -> None:
    """Put rounding in what landed contacts hold still to zero."""
    g = e.landings
    if g.any_landed:
        still_stored(e, g.held, y)
