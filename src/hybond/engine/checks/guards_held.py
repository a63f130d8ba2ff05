"""Guards put back: none holds unfired where time goes on, none fires apart from its own instant.

A rule whose guard holds at the end of a step that nothing has ended was passed over. What begins to
hold within one instant of another guard, by the motion that led there, is one instant with it: to
settle the two one after the other makes a mode of what is none, and its jump takes what flows.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_places
from hybond.engine.answers import value
from hybond.engine.checks.shown import show_at
from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.paired import holds_from
from hybond.engine.guards.in_force import is_asked
from hybond.engine.guards.kept_sides import keeps_sides
from hybond.engine.guards.waiting import waits
from hybond.engine.instant.instant import Instant
from hybond.engine.instant.told import BY_LAW
from hybond.engine.methods.stepping import between
from hybond.engine.mode.digits.sizes import measure
from hybond.engine.mode.equations import mode_of
from hybond.engine.reasons.noting import APART, UNFIRED, note_violation
from hybond.engine.surfaces.combine import combine_here

PASSED: Final = 2.0
"""Times its rounding by which a guard must hold to count as passed over: what measures rounding, as
the energy of a part, is not the same to the last digit where a step looks for it and behind it."""


def look_at_guards(e: Engine) -> None:
    """Hold the values in `e.checks.v` against all guards that leave the mode of the motion.

    They are of a point within a motion, and laws were held against them.
    """
    m = e.model
    v = e.checks.v
    for k in range(m.slots):
        v[m.slots + k] = v[k]
    for k in range(m.machines):
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            if m.rule_watched[r] == 0 or not is_asked(e, k, r, e.state[k]):
                continue
            if value(m, m.rule_value[r], v) != 0.0 and holds_clearly(e, r, PASSED):
                note_violation(e, e.mode, e.t, UNFIRED, r, 1.0, 1.0)


def holds_clearly(e: Engine, r: int, times: float) -> bool:
    """Whether the guard of a rule holds at the values in `e.checks.v` by more than rounding.

    By so many times as much.
    """
    m = e.model
    v = e.checks.v
    stack = e.work.stack
    if e.rests.rule[r] != 0 or keeps_sides(e, r, v):
        return False
    measure(e, e.mode, r, e.work.xi, v, e.work.terms)
    if waits(e, r, e.t, v, e.work.terms):
        return False
    # while machines slide, terms of bond variables are not made anew
    for p in range(m.read_first[r], m.read_first[r + 1] if e.slide.k == 0 else 0):
        e.work.terms[m.read_slot[p]] *= times
    stack.now = v
    stack.was = v
    stack.was_first = 0
    stack.jump = v
    stack.jumps = False
    stack.terms = e.work.terms
    stack.prior_terms = e.work.terms
    true = holds_from(m, r, stack, e.rests.within[r])
    return true and stack.refused == 0


def foresee(e: Engine, top: float) -> None:
    """Keep where the motion that has led to the present instant would be at its end, at `top`.

    Where the present instant is within the one before, first find what should have fired in that.
    """
    c = e.checks
    c.close = c.foreseen and e.t > c.at and e.t <= c.beyond
    if c.close:
        c.late = e.t - c.at
        c.room = c.beyond - c.at
        find_foreseen(e)
    c.foreseen = e.slide.k == 0 and top > e.t
    if not c.foreseen:
        return
    c.at = e.t
    c.beyond = top
    between(e, top, c.ahead)
    copy_floats(e.states, e.y, c.since)
    copy_places(e.model.machines, e.state, 0, c.ahead_state, 0)


def keep_foreseen(e: Engine, i: Instant) -> None:
    """Keep what was foreseen if a guard fired at the instant that was settled: else it was none.

    One may be found and be rounding once the energy that the step has led to is known. It fires a
    little later, and diodes that carry nothing may have changed in between.
    """
    for f in range(i.fired if e.checks.foreseen else 0):
        if i.told.why.at[i.reason.at[f]] != BY_LAW:
            return
    e.checks.foreseen = False


def find_foreseen(e: Engine) -> None:
    """Find the rules that the motion before the last instant makes hold by the end of that instant.

    There are none if what held at that instant would have ceased to hold by then: what is touched
    is an instant alone.
    """
    m = e.model
    c = e.checks
    c.close = mode_of(e, c.ahead_state) == OK and show_at(e, e.mode, c.beyond, c.ahead)
    if c.close:
        note_held(e)
        c.close = show_at(e, e.mode, c.at, c.since)
    for k in range(m.machines if c.close else 0):
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            if leaves(e, k, r) and holds_clearly(e, r, 1.0):
                c.close = c.close and c.held[r] != 0
                c.held[r] = 0
    if mode_of(e, e.state) != OK or combine_here(e, e.state) != OK:
        c.close = False


def note_held(e: Engine) -> None:
    """Note the guards that hold where it is seen, of those that leave the mode before."""
    m = e.model
    for k in range(m.machines):
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            e.checks.held[r] = 1 if leaves(e, k, r) and holds_clearly(e, r, 1.0) else 0


def leaves(e: Engine, machine: int, r: int) -> bool:
    """Whether a rule leaves the mode before the last instant, and may begin to hold in motion."""
    m = e.model
    return m.rule_watched[r] != 0 and m.rule_source[r] == e.checks.ahead_state[machine]


def hold_apart(e: Engine, i: Instant) -> None:
    """Hold what fired first at a settled instant against what should have fired in the one before.

    Laws of junctions are decided together, not by their rules.
    """
    m = e.model
    c = e.checks
    for f in range(i.first.at[1] if c.close and i.steps > 0 else 0):
        k = i.machine.at[f]
        for r in range(m.rule_first[k], m.rule_first[k + 1] if m.is_law[k] == 0 else 0):
            own = m.rule_source[r] == i.source.at[f] and m.rule_target[r] == i.target.at[f]
            if own and c.held[r] != 0:
                note_violation(e, e.mode, e.t, APART, r, c.late, c.room)
    c.close = False
