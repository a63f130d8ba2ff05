"""Going on along the surfaces chosen, and what is written down of that."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import grow_places
from hybond.engine.algebra.products import copy_floats, copy_places, largest
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.instant.instant import (
    CONTINUOUS,
    PINNACLE,
    Instant,
    add_energy,
    append_fired,
    is_struck,
    note_fired,
    note_hit,
    note_step,
)
from hybond.engine.instant.small_jumps import vanishes
from hybond.engine.instant.told import (
    FOLLOWS,
    PARTS,
    PUSHED_BACK,
    SLIDES_OFF,
    SLIDES_ON,
    THROWN_BACK,
    add_read,
    say_why,
)
from hybond.engine.jumps.jump import enter_mode
from hybond.engine.laws.branches import choose_anew, know_around
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.mode_records import is_constrained
from hybond.engine.reasons.facts import add_fact
from hybond.engine.sliding.filippov import SLIDES
from hybond.engine.sliding.ways_on import CHOSEN, COLLAPSES
from hybond.engine.sliding.what_happened import is_held
from hybond.engine.surfaces.blend import find_speeds
from hybond.engine.surfaces.combine import combine_here
from hybond.engine.surfaces.corners import cross_as_one
from hybond.engine.surfaces.onto import onto_surfaces
from hybond.engine.surfaces.outputs import show_state
from hybond.engine.surfaces.parted import is_far
from hybond.engine.surfaces.surface import part_mode
from hybond.engine.surfaces.values import evaluate
from hybond.engine.words import Floats

SLIDING: Final = -1
"""The state of a machine that slides, in what is written down."""
NO_IMPULSE: Final = 1e-12
"""Impulses of jumps that were added up are none below this part of the largest."""


def go_on_sliding(e: Engine, i: Instant, slid: int, decided: int) -> int:
    """Go on along the surfaces chosen, and write down what became of machines.

    `decided` is what the decision came to: CHOSEN or COLLAPSES have branches of laws of their own.
    """
    m = e.model
    s = e.slide
    copy_places(m.machines, s.target, 0, s.mark, 0)
    waiting = note_transitions(e, i, slid)
    left = s.many > 0
    s.many = slid
    s.slid_product = slid > 0 and s.best_product
    copy_places(slid, s.chosen, 0, s.surface, 0)
    copy_places(m.machines, s.mark, 0, e.state, 0)
    if decided != CHOSEN and decided != COLLAPSES:
        choose_anew(e)
    know_around(e, e.state)
    found = s.met if slid > 0 else 0
    s.met = 0
    if mode_of(e, e.state) != OK or combine_here(e, e.state) != OK:
        return REFUSED
    s.has_last = False
    at = 0
    for j in range(found):
        if s.best[j] == SLIDES:
            s.last[at] = s.best_weight[j]
            at += 1
    s.has_last = at > 0 and at == s.k
    keep_phases(e)
    if s.k > 0 and put_on(e) != OK:
        return REFUSED
    if s.k == 0 and left and put_within(e) != OK:
        return REFUSED
    s.known = False
    if waiting > 0:
        write_transitions(e, i, decided == COLLAPSES)
    return OK


def put_on(e: Engine) -> int:
    """Put the state on the surfaces that it is to slide on; it is there but for rounding."""
    s = e.slide
    copy_floats(e.states, e.y, s.put_from)
    if onto_surfaces(e, e.t, e.y) != OK:
        return REFUSED
    if is_far(e, s.put_from, e.y) and not is_led_within(e, s.put_from):
        copy_floats(e.states, s.put_from, e.y)
        say_fault(e, "HB-N405", "the state is not on the surfaces", "")
        for j in range(s.k if e.model.tells != 0 else 0):
            add_fact(e.fault, float(s.side[j]))
        return REFUSED
    return OK


def is_led_within(e: Engine, before: Floats) -> bool:
    """Whether a mode around leads as far within the instant: what has held nothing has no size."""
    s = e.slide
    room = room_of_instant(e, e.t)
    show_state(e, e.t, before, s.v)
    s.known = False
    if find_speeds(e, True) != OK:
        return False
    for k in range(e.states):
        most = 0.0
        for part in range(s.parts):
            most = max(most, math.fabs(s.part_rate[part * e.states + k]))
        if not math.fabs(e.y[k] - before[k]) <= room * most:
            return False
    return True


def put_within(e: Engine) -> int:
    """Put the state within what the mode holds that goes on alone; it is there but for dust."""
    s = e.slide
    if not is_constrained(e.mode):
        return OK
    if evaluate(e, e.mode, e.shown, e.t, e.y) != OK:
        return REFUSED
    if enter_mode(e, e.mode, e.shown, e.y, s.x) != OK:
        return REFUSED
    copy_floats(e.model.storages, s.x, s.rates)
    for k in range(e.model.storages):
        s.x[k] -= e.y[k]
    if vanishes(e, s.x, e.y):
        copy_floats(e.model.storages, s.rates, e.y)
    return OK


def write_transitions(e: Engine, i: Instant, collapsed: bool) -> None:
    """Add the decision to what is written down of this instant."""
    s = e.slide
    if i.steps == 0:
        note_step(i, CONTINUOUS)
        return
    last = i.steps - 1
    differs = False
    for k in range(e.model.machines):
        differs = differs or s.settled[k] != e.state[k]
    if collapsed:
        i.kind.at[last] = PINNACLE
        note_collapse(e, i)
    elif is_struck(i, last) and differs and s.many == 0:
        i.kind.at[last] = PINNACLE
        note_step(i, CONTINUOUS)
        if i.energies.at[last] != 0:
            left = i.energy.at[3 * last + 1]
            add_energy(i, left, left, 0.0)
    else:
        append_fired(i)


def note_collapse(e: Engine, i: Instant) -> None:
    """Note the step in which jumps back and forth end, with all their impulses."""
    s = e.slide
    most = largest(2 * e.model.bonds, s.impulses)
    for b in range(2 * e.model.bonds):
        if s.impulses[b] != 0.0:
            note_hit(i, b, s.impulses[b], NO_IMPULSE * most)
    note_step(i, CONTINUOUS)
    if e.model.tells != 0:
        add_energy(i, s.energy_before, s.energy_after, 0.0)


def note_transitions(e: Engine, i: Instant, slid: int) -> int:
    """Note what the decision did to machines; return how many transitions there are."""
    m = e.model
    s = e.slide
    i.waiting = 0
    for j in range(s.many + slid):
        surface = s.surface[j] if j < s.many else s.chosen[j - s.many]
        machine = m.surface_machine[surface]
        stays = False
        for p in range(slid):
            stays = stays or s.chosen[p] == surface
        if is_held(e, surface) and stays:
            continue
        now = s.mark[machine]
        if stays:
            note_fired(i, machine, s.settled[machine], SLIDING)
            say_why(i.told, SLIDES_ON)
            add_read(i.told, float(surface), 0.0, False)
        elif now == m.surface_below[surface] or now == m.surface_above[surface]:
            note_fired(i, machine, SLIDING, now)
            say_why(i.told, PARTS if s.parted[surface] != 0 else SLIDES_OFF)
            add_read(i.told, float(surface), 0.0, False)
    for machine in range(m.machines):
        if s.settled[machine] == s.mark[machine]:
            continue
        known = False
        for j in range(s.many + slid):
            surface = s.surface[j] if j < s.many else s.chosen[j - s.many]
            known = known or m.surface_machine[surface] == machine
        if not known:
            note_fired(i, machine, s.settled[machine], s.mark[machine])
            if m.is_law[machine] == 0:
                why = PUSHED_BACK if s.many + slid > 0 else THROWN_BACK
                say_why(i.told, FOLLOWS if goes_along(e, slid, machine) else why)
    return i.waiting


def keep_phases(e: Engine) -> None:
    """Keep the modes combined from here on: an event comes in any of them."""
    m = e.model
    s = e.slide
    s.phases = s.parts if s.k > 0 and m.followers > 0 else 0
    grow_places(s.phase, s.phases * m.machines)
    for part in range(s.phases):
        copy_places(m.machines, part_mode(e, part).state, 0, s.phase.at, part * m.machines)


def goes_along(e: Engine, slid: int, machine: int) -> bool:
    """Whether a machine follows others, or crosses its surface together with one that slides."""
    m = e.model
    s = e.slide
    if m.followers > 0 and m.machine_follows[machine] != 0:
        return True
    for other in range(m.surfaces):
        for i in range(s.many + slid if m.surface_machine[other] == machine else 0):
            surface = s.surface[i] if i < s.many else s.chosen[i - s.many]
            if cross_as_one(m, surface, other):
                return True
    return False
