"""Mode selection at one instant: mythical modes, pinnacles, divergence of time.

A mode that is left on its a posteriori values is mythical; one that was written and then left is a
pinnacle; the last is continuous. All machines fire together. If the same mode, state, state after
the jump and a priori values return at one instant, time cannot advance. Source:
Mosterman and Biswas 2002, eq. 18 and Algorithms 2 and 3.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_part
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.guards.waiting import wake_all
from hybond.engine.inputs.interval import hold_before, interval_after
from hybond.engine.inputs.sampling import sample
from hybond.engine.instant.back_by_dust import is_back_by_dust, may_slide, note_dust
from hybond.engine.instant.beginning import begin_behind, stand_before, stand_without_before
from hybond.engine.instant.ceasing import find_standing, is_over
from hybond.engine.instant.doubts import warn_of_moduli
from hybond.engine.instant.enabled import find_enabled
from hybond.engine.instant.indeterminate import (
    keep_as_before,
    keep_open_before,
)
from hybond.engine.instant.instant import (
    CONTINUOUS,
    GUARD,
    MYTHICAL,
    PINNACLE,
    SAMPLE,
    START,
    Instant,
    drop_fired,
    is_new,
    note_fired,
    note_hit,
    note_step,
)
from hybond.engine.instant.jump_balance import hold_jump, jump_may_create
from hybond.engine.instant.left_out import warn_of_left_out
from hybond.engine.instant.open_integrals import refuse_open_integrals
from hybond.engine.instant.passed_over import enter_or_pass
from hybond.engine.instant.settling import Settling, comes_back, look_for_cycle
from hybond.engine.instant.staying import (
    acts_on_prior,
    is_still_known,
    show_prior,
    stay_on_trial,
)
from hybond.engine.instant.telling import (
    supplied_by_jump,
    tell_branch,
    tell_found,
    tell_kept,
    tell_trial,
)
from hybond.engine.jumps.jump import SWEPT
from hybond.engine.jumps.trial import (
    a_priori,
)
from hybond.engine.laws.branches import choose_at, know_around
from hybond.engine.laws.entering import enter
from hybond.engine.laws.law_standing import stands_as_it_was
from hybond.engine.mode.digits.fading import remember_jump, remember_now
from hybond.engine.mode.digits.part_energies import join_parts
from hybond.engine.mode.equations import is_fieldless, mode_of
from hybond.engine.words import Ints

OWN_ROUNDING: Final = 1e-14
"""Part of what is stored that is its rounding."""


def settle(e: Engine, g: Settling, i: Instant) -> int:
    """Find the state and mode in which time goes on, from those of the run, and write them there.

    The interval is entered that begins at the instant.
    """
    if begin_to_settle(e, g, i) != OK or refuse_what_passed(e, i) != OK:
        return REFUSED
    written = -1
    writes = 0
    while True:
        fired = fire_all(e, g, i, written)
        if fired < 0:
            return REFUSED
        if fired == 0 and not e.trial.jumps and is_kept(e, g):
            if e.trial.dusted or is_moved(e, g):
                for k in range(e.model.storages):
                    g.x[k] = e.trial.x[k]
            break
        writes += 1
        if writes > e.model.max_writes:
            return say_fault(e, "HB-N402", "too many state writes at one instant", "")
        if written >= 0:
            i.kind.at[written] = PINNACLE
        still = is_where_it_was(e, g)
        if join_written(e) != OK:
            return REFUSED
        written = write(e, g, i)
        if i.by_dust:
            break
        if go_on_from_written(e, g, e.t, still) != OK:
            return REFUSED
        by_law(e, g.state, i)
    if is_fieldless(e, e.mode):
        why = "the mode holds at an instant only (a law reads pre()) but no guard leaves it"
        return say_fault(e, "HB-N403", why, "")
    if refuse_open_integrals(e) != OK:
        return REFUSED
    if i.steps == 0 and is_new(i):
        drop_fired(i)
        note_step(i, CONTINUOUS)
        tell_trial(e, i, g.x, True)
    join_parts(e, e.mode)
    write_back(e, g)
    e.trial.settled_at = e.t
    return OK


def refuse_what_passed(e: Engine, i: Instant) -> int:
    """Refuse what has come to depend on integrals of what the mode left open that ends here.

    As it was entered, something else may have decided.
    """
    if i.cause == START or e.t <= e.trial.settled_at:
        return OK
    for k in range(e.model.machines):
        if e.trial.state[k] != e.state[k]:
            return OK
    return refuse_open_integrals(e)


def begin_to_settle(e: Engine, g: Settling, i: Instant) -> int:
    """Enter the mode of the run as it is at the instant: what is a priori, held and sampled."""
    m = e.model
    t = e.t
    e.instants += 1.0
    if m.laws > 0:
        remember_now(e)
    for k in range(m.storages):
        g.x[k] = e.y[k]
    for k in range(m.integrals):
        g.s[k] = e.y[m.storages + k]
    for k in range(m.machines):
        g.state[k] = e.state[k]
    g.tries = 0
    g.turn = 1
    g.marked = False
    g.stands = 0
    if i.cause != GUARD and i.cause != SAMPLE:
        wake_all(e)
    hold_before(e, t, e.model.timed_jumps)
    known = a_priori(e, t, g.x, g.s, g.state) == OK
    e.trial.turn += 1
    for k in range(2 * m.bonds if m.laws > 0 and e.laws.bonds_noted else 0):
        # the state is behind a kink at which a source jumps
        e.pre[m.bond_slot + k] = e.laws.bonds_before[k]
    begins = i.cause == START and m.laws > 0
    if not known and not (begins and stand_without_before(e, t, g.x, g.s, g.state, g.begin)):
        return a_priori(e, t, g.x, g.s, g.state)
    if known and begins and m.samples > 0:
        # what is sampled now is of branches that stand, too
        stand_before(e, t, g.x, g.s, g.state, g.begin)
    keep_open_before(e)
    if sample(e, g.s) != OK:
        return REFUSED
    interval_after(e, t)
    choose_at(e, g.x, g.s)
    know_around(e, g.state)
    if begins:
        stand_before(e, t, g.x, g.s, g.state, g.begin)
    stands = m.laws > 0 and not is_new(i) and stands_as_it_was(e, t, g.x, g.s, g.state)
    if not stands and enter(e, t, g.x, g.s, g.state, True, False) != OK:
        if i.cause != START or not begin_behind(e, i, g.x, g.s, g.entered, g.target, g.begin):
            return REFUSED
        by_law(e, g.entered, i)
        return OK
    drop_fired(i)
    by_law(e, g.state, i)
    return OK


def fire_all(e: Engine, g: Settling, i: Instant, written: int) -> int:
    """Follow the rules that hold, mode after mode; return in how many, -1 if none can be entered.

    `written` is the step of the instant that was the last to be written, -1: none.
    """
    m = e.model
    many = 0
    while True:
        entered = i.waiting > 0
        fired = find_enabled(e, g, e.t)
        if is_over(e, g, fired):
            wake_all(e)
            fired = find_enabled(e, g, e.t)
        if fired > 0 and comes_back(e, g):
            find_standing(e, g)
            # the search has asked other modes: what fires is asked anew
            fired = find_enabled(e, g, e.t)
        if fired > 0 and written < 0 and may_slide(m):
            note_dust(e, g, many)
            if is_back_by_dust(e, g, many):
                i.by_dust = True
                return many
        if fired == 0 and g.stands > 0 and not e.trial.jumps:
            return many  # it may be the mode from which it was found
        if fired < 0 or look_for_cycle(e, g) != OK:
            return -1
        if fired == 0:
            return many
        if many > 0 or entered or e.trial.jumps or (i.cause == START and i.steps == 0):
            note_hits(e, i)
            note_step(i, MYTHICAL)
            tell_trial(e, i, g.x, False)
        elif written >= 0:
            i.kind.at[written] = PINNACLE
        drop_fired(i)
        for k in range(m.machines):
            if g.target[k] != e.trial.state[k]:
                note_fired(i, k, e.trial.state[k], g.target[k])
                tell_found(e, i, k, g.held)
        for k in range(m.machines):
            g.entered[k] = g.target[k]
        know_around(e, g.entered)
        if enter_or_pass(e, i, e.t, g.x, g.s, g.entered, g.target) != OK:
            return -1
        by_law(e, g.entered, i)
        many += 1


def write_back(e: Engine, g: Settling) -> None:
    """Let the run go on from what was found."""
    m = e.model
    if m.laws > 0:
        remember_jump(e, g.x)
    for k in range(m.storages):
        e.y[k] = g.x[k]
    for k in range(m.integrals):
        e.y[m.storages + k] = g.s[k]
    for k in range(m.machines):
        e.state[k] = e.trial.state[k]


def is_where_it_was(e: Engine, g: Settling) -> bool:
    """Whether the trial changes nothing that is stored or integrated."""
    m = e.model
    same = not e.trial.jumps
    for k in range(m.storages):
        same = same and e.trial.x[k] == g.x[k]
    for k in range(m.integrals):
        same = same and e.trial.s[k] == g.s[k]
    return same


def go_on_from_written(e: Engine, g: Settling, t: float, still: bool) -> int:
    """Let what ``pre()`` reads be the signals at the state just written; try its mode with that.

    `still` says whether it is the state from which the trial was made.
    """
    m = e.model
    known = is_still_known(e)
    again = m.laws > 0 and not is_fieldless(e, e.mode)
    if known:
        stay_on_trial(e)
    elif enter(e, t, g.x, g.s, g.state, False, True) != OK:
        return REFUSED
    copy_part(m.slots, e.v, 0, e.pre, 0)
    e.trial.turn += 1
    keep_as_before(e, e.trial.loose, e.trial.freedom.at)
    if known and not acts_on_prior(e, still):
        show_prior(e)
        return OK
    return enter(e, t, g.x, g.s, g.state, again, True)


def write(e: Engine, g: Settling, i: Instant) -> int:
    """Write the state of the trial, and note its mode; return the number of the step.

    If the junction laws that carried the impulses are not those that last, the former are a
    pinnacle.
    """
    m = e.model
    note_hits(e, i)
    warn_of_moduli(e, e.mode)
    warn_of_left_out(e, e.mode)
    if e.trial.struck:
        write_struck(e, i)
        tell_trial(e, i, g.x, True)
    if e.trial.jumps:
        hold_jump(e, g.x, supplied_by_jump(e), jump_may_create(e))
    written = note_step(i, CONTINUOUS)
    if e.trial.struck:
        tell_kept(e, i)
    else:
        tell_trial(e, i, g.x, True)
    for k in range(m.storages):
        g.x[k] = e.trial.x[k]
    for k in range(m.integrals):
        g.s[k] = e.trial.s[k]
    for k in range(m.machines):
        g.state[k] = e.trial.state[k]
    return written


def join_written(e: Engine) -> int:
    """Let what the trial joins be one part, and what its impulses went through, if that is over."""
    if e.trial.struck and e.model.most_parts > 1:
        if mode_of(e, e.trial.through) != OK:
            return REFUSED
        join_parts(e, e.mode)
        if mode_of(e, e.trial.state) != OK:
            return REFUSED
    join_parts(e, e.mode)
    return OK


def note_hits(e: Engine, i: Instant) -> None:
    """Note the impulses of the trial that are more than rounding."""
    m = e.model
    if not e.trial.jumps:
        return
    for k in range(2 * m.bonds):
        if e.trial.jump[m.bond_slot + k] != 0.0:
            note_hit(i, k, e.trial.jump[m.bond_slot + k], e.floor[k])


def write_struck(e: Engine, i: Instant) -> None:
    """Note the branches that carried the impulses; what led from them to the lasting ones waits."""
    m = e.model
    for k in range(m.machines):
        if m.is_law[k] == 0 or e.trial.state[k] == e.trial.through[k]:
            continue
        known = False
        for f in range(i.waiting):
            if i.wait_machine.at[f] == k:
                i.wait_target.at[f] = e.trial.through[k]
                known = True
        if not known:
            note_fired(i, k, e.trial.state[k], e.trial.through[k])
            tell_branch(e, i, k, e.trial.state[k])
    kept = 0
    for f in range(i.waiting):
        if i.wait_source.at[f] != i.wait_target.at[f]:
            i.wait_machine.at[kept] = i.wait_machine.at[f]
            i.wait_source.at[kept] = i.wait_source.at[f]
            i.wait_target.at[kept] = i.wait_target.at[f]
            i.wait_reason.at[kept] = i.wait_reason.at[f]
            kept += 1
    i.waiting = kept
    note_step(i, PINNACLE)
    for k in range(m.machines):
        if m.is_law[k] != 0 and e.trial.state[k] != e.trial.through[k]:
            note_fired(i, k, e.trial.through[k], e.trial.state[k])


def by_law(e: Engine, state: Ints, i: Instant) -> None:
    """Note the laws whose branches changed from `state` to that of the trial."""
    m = e.model
    for k in range(m.machines):
        if m.is_law[k] != 0 and state[k] != e.trial.state[k]:
            note_fired(i, k, state[k], e.trial.state[k])
            tell_branch(e, i, k, state[k])


def is_kept(e: Engine, g: Settling) -> bool:
    """Whether the trial changes neither mode nor signals."""
    m = e.model
    for k in range(m.machines):
        if e.trial.state[k] != g.state[k]:
            return False
    for k in range(m.integrals):
        if e.trial.s[k] != g.s[k]:
            return False
    return True


def is_moved(e: Engine, g: Settling) -> bool:
    """Whether a trial without impulses is off the state by more than the last digits of it.

    What is rounding beside the energy of its part may be many digits of a storage that is small.
    The signals are those of the trial.
    """
    moved = False
    if e.moved == SWEPT:
        for k in range(e.model.storages):
            size = max(math.fabs(g.x[k]), math.fabs(e.trial.x[k]))
            moved = moved or math.fabs(e.trial.x[k] - g.x[k]) > OWN_ROUNDING * size
    return moved
