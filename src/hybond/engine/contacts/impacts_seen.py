"""What is seen of impacts as they happen: when, how fast, and with which sign contacts react."""

import math

from hybond.engine.algebra.products import copy_floats, copy_part, copy_places
from hybond.engine.answers import value
from hybond.engine.contacts.accumulation import note_impact, push_time, restart
from hybond.engine.contacts.landing_records import CROWD, Landings
from hybond.engine.engine import OK, Engine
from hybond.engine.instant.beginning import stand_before
from hybond.engine.instant.instant import PINNACLE, START, Instant
from hybond.engine.jumps.trial import a_priori
from hybond.engine.laws.entering import enter
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.limits import put_limit
from hybond.engine.model import Model
from hybond.engine.surfaces.combine import combine_here
from hybond.engine.surfaces.values import evaluate
from hybond.engine.words import Floats


def before_event(e: Engine) -> None:
    """Keep what there is before an instant is settled."""
    m = e.model
    g = e.landings
    copy_floats(e.states, e.y, g.before)
    copy_places(m.machines, e.state, 0, g.before_state, 0)
    copy_places(m.inputs, e.piece, 0, g.before_piece, 0)
    copy_places(m.watches, e.at, 0, g.before_at, 0)


def exchange_interval(e: Engine) -> None:
    """Exchange the interval after the instant with the one before it."""
    m = e.model
    g = e.landings
    for k in range(m.inputs):
        piece = e.piece[k]
        e.piece[k] = g.before_piece[k]
        g.before_piece[k] = piece
    for k in range(m.watches):
        at = e.at[k]
        e.at[k] = g.before_at[k]
        g.before_at[k] = at


def observe_event(e: Engine, i: Instant) -> None:
    """Learn from an event, just settled, which impacts it was."""
    m = e.model
    g = e.landings
    g.event_times[g.events % CROWD] = e.t
    g.events += 1
    forget_left(e)
    g.touches = 0
    for k in range(m.machines):
        g.state[k] = g.before_state[k]
        g.struck[k] = -1
        g.fired[k] = 0
    for f in range(i.first.at[i.steps]):
        g.fired[i.machine.at[f]] = 1
    for step in range(i.steps):
        for f in range(i.first.at[step], i.first.at[step + 1]):
            g.state[i.machine.at[f]] = i.target.at[f]
        if i.kind.at[step] == PINNACLE:
            note_struck(m, g, i.cause == START)
    exchange_interval(e)
    for k in range(m.machines):
        if g.struck[k] >= 0:
            touch(e, g, k, i.cause == START)
        elif g.fired[k] != 0:
            g.other_kept[k] = push_time(g.others, g.other_kept[k], k, e.t)
    exchange_interval(e)


def note_struck(m: Model, g: Landings, begins: bool) -> None:
    """Note the contacts that are struck in a pinnacle, and its mode; `begins` as the run does.

    One that was closed before the instant, and is so behind it, is not: nothing comes of it.
    """
    for k in range(m.machines):
        contact = m.contact_at[m.state_first[k] + g.state[k]]
        if contact >= 0 and g.landed[k] < 0 and (begins or g.fired[k] != 0):
            g.struck[k] = contact
            copy_places(m.machines, g.state, 0, g.struck_state, k * m.machines)


def touch(e: Engine, g: Landings, machine: int, begins: bool) -> None:
    """Note how fast a contact was approached and is left; `begins` as the run does."""
    m = e.model
    contact = g.struck[machine]
    moves = mode_of(e, e.state) == OK and combine_here(e, e.state) == OK
    approach = contact_speed(e, g, contact, g.before) if moves else 0.0
    rebound = contact_speed(e, g, contact, e.y) if moves else 0.0
    g.touch_contact[g.touches] = contact
    g.touch_gap[g.touches] = e.t - g.since[machine]
    g.touch_approach[g.touches] = approach
    g.touch_rebound[g.touches] = rebound
    g.touch_hidden[g.touches] = 0.0
    g.touches += 1
    note_impact(g, machine, e.t, approach)
    known = True
    for r in range(m.reaction_first[contact], m.reaction_first[contact + 1]):
        known = known and g.sign[r] != 0
    if not known:
        learn_signs(e, g, machine, contact, begins)


def contact_speed(e: Engine, g: Landings, contact: int, y: Floats) -> float:
    """Return how far a state of the mode is from what the impact laws prescribe at rest."""
    m = e.model
    evaluate(e, e.mode, g.v, e.t, y)
    for k in range(m.slots):
        g.v[m.slots + k] = 0.0
    for r in range(m.reaction_first[contact], m.reaction_first[contact + 1]):
        if m.reaction_prior[r] >= 0:
            put_limit(e, m.reaction_prior[r], g.v)
    worst = 0.0
    for r in range(m.reaction_first[contact], m.reaction_first[contact + 1]):
        total = 0.0
        for p in range(m.prescribed_first[r], m.prescribed_first[r + 1]):
            total += m.prescribed_sign[p] * g.v[m.bond_slot + m.prescribed_column[p]]
        law = m.reaction_law[r]
        own = m.reaction_law_constant[r] if law < 0 else value(m, law, g.v)
        total += m.reaction_own[r] * own
        worst = max(worst, math.fabs(total))
    return worst


def learn_signs(e: Engine, g: Landings, machine: int, contact: int, begins: bool) -> None:
    """Learn the sign of each reaction's impulse in the impact, which is made once more."""
    m = e.model
    copy_floats(m.storages, g.before, g.x)
    copy_part(m.integrals, g.before, m.storages, g.s, 0)
    copy_places(m.machines, g.struck_state, machine * m.machines, g.state, 0)
    if a_priori(e, e.t, g.x, g.s, g.before_state) != OK:
        return
    if begins and m.laws > 0:
        stand_before(e, e.t, g.x, g.s, g.before_state, g.before_laws)
    if enter(e, e.t, g.x, g.s, g.state, True, False) != OK:
        return
    for r in range(m.reaction_first[contact], m.reaction_first[contact + 1]):
        area = e.impulses[m.reaction_column[r]] if e.trial.jumps else 0.0
        if area != 0.0:
            g.sign[r] = 1 if area > 0.0 else -1


def forget_left(e: Engine) -> None:
    """Forget landings that were left."""
    m = e.model
    g = e.landings
    g.any_landed = False
    for k in range(m.machines):
        if g.landed[k] < 0:
            continue
        if e.state[k] != m.contact_state[g.landed[k]]:
            g.landed[k] = -1
            e.landed[k] = 0
            restart(g, k, e.t)
        else:
            g.any_landed = True
