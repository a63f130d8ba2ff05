"""Guards and what they compare, at an instant of the last step."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import row_times
from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.answers import rule_text, value
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.expressions.paired import holds_from
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.kept_sides import NOT_ASKED, ask_kept
from hybond.engine.guards.locator import ALL_PARTS, NO_KINK, Locator
from hybond.engine.guards.naps import is_asleep
from hybond.engine.guards.waiting import may_wait, waits
from hybond.engine.jumps.jump import on_constraints
from hybond.engine.jumps.tied import put_tied
from hybond.engine.jumps.trial import refuse_pair
from hybond.engine.methods.stepping import between
from hybond.engine.mode.digits.fading import keep_seen, may_fade, see_as_before
from hybond.engine.mode.digits.sizes import measure, seen_of
from hybond.engine.mode.mode_records import is_constrained
from hybond.engine.mode.reading import put_knowns, reads_plainly, show_plain
from hybond.engine.mode.solving import solve_read
from hybond.engine.reasons.facts import add_fact
from hybond.engine.surfaces.averages import begin_sizes, part_sizes, show_part, solve_here
from hybond.engine.surfaces.values import evaluate, set_motion, set_state
from hybond.engine.words import Floats

STANDS: Final = 1e-12
"""Part of its terms up to which a law may count what it compares as zero."""
FEW: Final = 16
"""Bond variables that are evaluated all at once, whichever of them are asked for."""
BEYOND: Final = 1e-13
"""A weight this far beyond 0 or 1 has left."""


def look(e: Engine, g: Locator, t: float) -> None:
    """Fill the values at t that guards read; bond variables as each is asked, where they are rows.

    Most guards are asked at few of the instants that are looked at.
    """
    if g.looked != t:
        look_at_time(e, g, t, t)


def look_at_sample(e: Engine, g: Locator, t: float) -> None:
    """Do the same where the step is sampled: the state may be known there on its constraints."""
    at = 0
    while at < g.keeps and g.kept_at[at] != t:
        at += 1
    if at == g.keeps or g.looked == t:
        look(e, g, t)
        return
    copy_part(e.states, g.kept_y, at * e.states, g.y, 0)
    look_on(e, g, t)


def keep_sample(e: Engine, g: Locator, t: float) -> None:
    """Keep the state that is there, on its constraints, for who samples the step."""
    g.kept_at[g.keeps] = t
    copy_part(e.states, g.y, 0, g.kept_y, g.keeps * e.states)
    g.keeps += 1


def look_at_time(e: Engine, g: Locator, t: float, at: float) -> None:
    """Fill them as they would be at t, with the state at another instant."""
    if g.tied:
        put_tied(e, t, g.y)
        look_on(e, g, t)
        return
    between(e, at, g.y)
    look_here(e, g, t)


def look_at_state(e: Engine, g: Locator, t: float, y: Floats) -> None:
    """Fill them as they would be at t in any state; what was looked at before is forgotten."""
    copy_floats(e.states, y, g.y)
    look_here(e, g, t)


def look_here(e: Engine, g: Locator, t: float) -> None:
    """Fill them with the state that is there."""
    if g.held and put_on_constraints(e, t, g.y) != OK:
        g.failed = True
    look_on(e, g, t)


def look_on(e: Engine, g: Locator, t: float) -> None:
    """Fill them with the state that is there, which is on its constraints where it has to be."""
    show(e, g, ALL_PARTS)
    set_motion(e, e.v, t, g.y)
    g.lost = False
    g.looks += 1
    several = g.reads.many > FEW and e.slide.k == 0
    g.singly = several and e.mode.dynamics == 0 and e.mode.finite_frees == 0
    if g.singly:
        put_knowns(e, e.mode, g.reads, e.v)
    elif e.slide.k == 0 and reads_plainly(e.model, e.mode, g.reads):
        show_plain(e, e.mode, g.reads, e.v)
    elif e.slide.k == 0:
        g.failed = solve_read(e, e.mode, g.reads, e.v) != OK or g.failed
    else:
        # where no combination holds the state on its surfaces, it has left them
        g.lost = solve_here(e, e.mode, e.v) != OK
    g.looked = t
    g.sized = False


def show_guard(e: Engine, g: Locator, k: int) -> None:
    """Put the bond variables that guard k reads there, unless that was done since it was looked."""
    if not g.singly or g.seen[k] == g.looks:
        return
    g.seen[k] = g.looks
    m = e.model
    w = e.work.w
    for p in range(m.read_first[g.pair[k]], m.read_first[g.pair[k] + 1]):
        b = m.read_slot[p] - m.bond_slot
        if b < 0 or b >= 2 * m.bonds:
            continue
        row = e.mode.same[b]
        if g.row_seen[row] != g.looks:
            g.row_seen[row] = g.looks
            w[row] = row_times(e.mode.direct, row, e.work.xi)
        e.v[m.bond_slot + b] = w[row]


def put_on_constraints(e: Engine, t: float, y: Floats) -> int:
    """Put a state of the motion back on its mode's constraints, if there are any."""
    if not is_constrained(e.mode):
        return OK
    if e.mode.dynamics == 0 and e.model.priors == 0 and e.slide.k == 0:
        # of bond variables, and of what was before, constraints read nothing then
        set_state(e, e.mode, e.shown, t, y)
    elif evaluate(e, e.mode, e.shown, t, y) != OK:
        return REFUSED
    return on_constraints(e, e.mode, e.shown, y)


def show(e: Engine, g: Locator, part: int) -> None:
    """Show the values in a mode that is combined, or of the motion as it is, where it is looked."""
    if g.showing != part:
        show_part(e, part, e.v)
        g.showing = part


def atom_at(e: Engine, g: Locator, a: int, t: float) -> float:
    """Return the difference that comparison a of the locator looks at."""
    look(e, g, t)
    return atom_here(e, g, a)


def atom_here(e: Engine, g: Locator, a: int) -> float:
    """Return the same at the values of the motion."""
    if g.atom[a] < 0:
        return -1.0 if g.lost else e.slide.margin[-1 - g.atom[a]]
    show(e, g, g.atom_part[a])
    show_guard(e, g, g.atom_guard[a])
    return value(e.model, e.model.atom_value[g.atom[a]], e.v)


def size_here(e: Engine, g: Locator, a: int) -> float:
    """Return what the magnitudes of the two sides of a comparison add up to."""
    if g.atom[a] < 0:
        return 1.0
    show_guard(e, g, g.atom_guard[a])
    return value(e.model, e.model.atom_size[g.atom[a]], e.v)


def terms_here(e: Engine, g: Locator, k: int, a: int) -> float:
    """Return the same with each bond variable as large as what it cancels from.

    Its own value may be nothing but rounding of that. What allows sliding reads no signals.
    """
    if g.atom[a] < 0:
        return size_here(e, g, a)
    measure_here(e, g, k)
    swap_terms(e, g, k)
    size = size_here(e, g, a)
    swap_terms(e, g, k)
    return size


def swap_terms(e: Engine, g: Locator, k: int) -> None:
    """Exchange the bond variables that guard k reads for what they are measured by."""
    m = e.model
    terms = e.work.terms
    for p in range(m.read_first[g.pair[k]], m.read_first[g.pair[k] + 1]):
        slot = m.read_slot[p]
        if slot >= m.bond_slot and slot < m.bond_slot + 2 * m.bonds:
            here = e.v[slot]
            e.v[slot] = terms[slot]
            terms[slot] = here


def test_here(e: Engine, g: Locator, k: int) -> bool:
    """Return the truth of guard k at the values of the motion, rounding being counted."""
    if waits_still(e, g, k, g.looked):
        return False
    if rests(e, g, k):
        return holds_at_rest(e, g, k, g.looked)
    if g.margin[k] >= 0:
        return g.lost or e.slide.margin[g.margin[k]] < -BEYOND
    if g.side[k] != NO_KINK:
        return has_crossed(e, g, k)
    show(e, g, g.part[k])
    show_guard(e, g, k)
    if keeps(e, g, k):
        return holds_as_it_was(e, g, k)
    return value(e.model, g.test[k], e.v) != 0.0


def has_crossed(e: Engine, g: Locator, k: int) -> bool:
    """Whether a kink is beyond the zero that the step came towards, by more than rounding."""
    if is_asleep(g, k):
        return False
    a = g.atom_first[k]
    here = atom_here(e, g, a)
    beyond = -float(g.side[k]) * here
    if beyond == math.inf:
        return True
    if not beyond > ROUNDING * size_here(e, g, a):
        return False
    return beyond > ROUNDING * terms_here(e, g, k, a)


def holds_at(e: Engine, g: Locator, k: int, t: float) -> bool:
    """Ask a guard as settling will, with rounding counted as zero; nothing jumps there."""
    look(e, g, t)
    if waits_still(e, g, k, t):
        return False
    if rests(e, g, k):
        return holds_at_rest(e, g, k, t)
    if g.margin[k] >= 0 or g.side[k] != NO_KINK:
        return test_here(e, g, k)
    if keeps(e, g, k):
        return holds_as_it_was(e, g, k)
    return holds_here(e, g, k)


def waits_still(e: Engine, g: Locator, k: int, t: float) -> bool:
    """Whether guard k is that of a rule that waits still, at the values of the motion."""
    if g.rule[k] < 0 or g.part[k] >= 0 or not may_wait(e, g.rule[k], t):
        return False
    measure_here(e, g, k)
    return waits(e, g.rule[k], t, e.v, e.work.terms)


def keeps(e: Engine, g: Locator, k: int) -> bool:
    """Whether a comparison of guard k rests on zero, and is what it was where it was clear."""
    q = e.rests
    rule = g.rule[k]
    if not q.some or rule < 0 or g.part[k] >= 0 or g.side[k] != NO_KINK or q.follows[rule] == 0:
        return False
    for a in range(e.model.atom_first[rule], e.model.atom_first[rule + 1]):
        if q.atom[a] != 0 and q.away[a] == 0:
            return True
    return False


def holds_as_it_was(e: Engine, g: Locator, k: int) -> bool:
    """Ask such a guard at the values of the motion."""
    measure_here(e, g, k)
    ask_in_motion(e)
    held = ask_kept(e, g.rule[k], e.v, e.work.terms, False)
    return holds_here(e, g, k) if held == NOT_ASKED else held == 1


def rests(e: Engine, g: Locator, k: int) -> bool:
    """Whether guard k holds in the step by rounding alone, as far as it does."""
    return e.rests.any and g.rule[k] >= 0 and g.part[k] < 0 and e.rests.rule[g.rule[k]] != 0


def holds_at_rest(e: Engine, g: Locator, k: int, t: float) -> bool:
    """Ask such a guard with what rests where it does, and what is zero there as it was.

    With either sign if it was never clear.
    """
    q = e.rests
    n = e.states
    if g.atom_first[k + 1] - g.atom_first[k] < 2:
        return False
    true = True
    for way in range(2):
        between(e, t, g.y)
        for j in range(n):
            at = g.rule[k] * n + j
            if q.kept[at] == q.kept[at]:
                g.y[j] = q.kept[at] + (q.aside[at] if way == 0 else q.across[at])
        look_here(e, g, t)
        held = holds_here(e, g, k)
        true = true and held
    look_at_time(e, g, t, t)
    return true


def level_in_motion(e: Engine, g: Locator, k: int) -> float:
    """Return up to where what guard k compares counts as zero: its limit, or where a law stood."""
    q = e.rests
    r = g.rule[k]
    if r < 0 or g.pair[k] != r:
        return 0.0
    if q.of_law[r] == 0:
        return q.within[r] if q.some_crossed else 0.0
    if not q.some_stand or q.within[r] == 0.0:
        return 0.0
    a = g.atom_first[k]
    terms = terms_here(e, g, k, a)
    return q.within[r] if math.fabs(q.within[r]) <= STANDS * terms else 0.0


def holds_here(e: Engine, g: Locator, k: int) -> bool:
    """Ask a guard so at the values of the motion."""
    m = e.model
    stack = e.work.stack
    measure_here(e, g, k)
    ask_in_motion(e)
    level = level_in_motion(e, g, k)
    true = holds_from(m, g.pair[k], stack, level)
    if stack.refused != 0:
        refuse_pair(e, e.v[0], rule_text(m, g.rule[k]))
        if m.tells != 0:
            add_fact(e.fault, float(g.rule[k]))
        g.failed = True
    return true


def doubt(e: Engine, g: Locator, t: float) -> int:
    """Refuse a guard that compares what is not a number at the end of a step: it would not hold."""
    m = e.model
    for k in range(g.guards):
        if g.rule[k] >= 0 and m.rule_doubted[g.rule[k]] != 0 and g.part[k] < 0:
            lacks = False
            for a in range(g.atom_first[k], g.atom_first[k + 1]):
                here = atom_at(e, g, a, t)
                lacks = lacks or here != here
            if lacks:
                holds_at(e, g, k, t)  # of what is never asked nothing is wrong
            if lacks and g.failed:
                return REFUSED
    return OK


def measure_here(e: Engine, g: Locator, k: int) -> None:
    """Find what rounding of the signals that guard k reads is measured by, and show these."""
    if g.part[k] >= 0:
        show(e, g, ALL_PARTS)
        keep_stored(e)
        part_sizes(e, g.part[k], e.v, e.work.here, e.work.terms)
        g.sized = False
    elif not g.sized:
        show(e, g, ALL_PARTS)
        begin_sizes_in_motion(e)
        g.sized = True
    show(e, g, g.part[k])
    show_guard(e, g, k)
    measure_in_motion(e, g.pair[k])


def keep_stored(e: Engine) -> None:
    """Put what is stored there, to measure rounding by."""
    copy_part(e.model.storages, e.v, e.model.stored_slot, e.work.here, 0)


def begin_sizes_in_motion(e: Engine) -> None:
    """Prepare for guards to be measured at the values of the motion, after `solve_here`."""
    keep_stored(e)
    begin_sizes(e, e.mode, e.v, e.work.here, e.work.terms)


def measure_in_motion(e: Engine, pair: int) -> None:
    """Find what rounding of the signals that a guard reads is measured by in the motion."""
    measure(e, e.mode, pair, e.work.xi, e.v, e.work.terms)


def ask_in_motion(e: Engine) -> None:
    """Let guards be asked at the values of the motion: nothing jumps there."""
    stack = e.work.stack
    stack.now = e.v
    stack.was = e.v
    stack.was_first = 0
    stack.jump = e.v
    stack.jumps = False
    stack.terms = e.work.terms
    stack.prior_terms = e.work.terms


def see_where_it_begins(e: Engine) -> None:
    """Find what rounding is measured by in the motion that begins, if that is not known."""
    if not may_fade(e.model, e.mode):
        return
    if e.mode.saw_at != e.instants:
        set_state(e, e.mode, e.shown, e.t, e.y)
        seen_of(e, e.mode, e.shown, e.y)
    if e.standing.goes_on:
        see_as_before(e, e.mode)
    else:
        keep_seen(e, e.mode)
