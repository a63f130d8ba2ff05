"""Bond variables of a mode at one instant: a product with what is known, or Newton's method.

Newton solves in the unknowns that elimination left free.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import Rows, fit, row_times
from hybond.engine.algebra.products import all_finite, copy_floats
from hybond.engine.answers import node_name
from hybond.engine.engine import NOT_FINITE, OK, Engine, say_fault
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.at_jumps import at_jumps
from hybond.engine.mode.nonlinear.beside_jumps import from_beside_jumps
from hybond.engine.mode.nonlinear.continuation import continued
from hybond.engine.mode.nonlinear.damped import SETTLED, damped
from hybond.engine.mode.nonlinear.dynamic_rows import dynamic_value, slopes_at
from hybond.engine.mode.nonlinear.enclosed import enclosed
from hybond.engine.mode.nonlinear.led_up import led_up
from hybond.engine.mode.nonlinear.level import ROUNDED, is_level, put_level, put_together
from hybond.engine.mode.nonlinear.neighbours import from_neighbours
from hybond.engine.mode.nonlinear.newton_step import SWINGS, TOLERANCE, newton_step
from hybond.engine.mode.nonlinear.newton_system import (
    by_free,
    is_zero,
    largest_of,
    measured_system,
    system,
    take_rank,
    with_free,
)
from hybond.engine.mode.nonlinear.put_back import is_exact, put_back
from hybond.engine.mode.nonlinear.solved_apart import solved_apart
from hybond.engine.mode.nonlinear.swung_over import led_between
from hybond.engine.mode.nonlinear.unseen import step_beside_unseen
from hybond.engine.mode.rows.sources_of_time import rate_of_source, value_of_source
from hybond.engine.mode.rows.storage import co_energy, co_energy_of
from hybond.engine.reasons.facts import NO_ELEMENT, OVERFLOW, tell_law, tell_laws
from hybond.engine.words import Floats, Text

STEPS: Final = 40
BACK: Final = 1e-9
"""Two steps that cancel to within this part of them lead back."""
TO_AND_FRO: Final = 3
"""So many in a row lead nowhere."""
LEFT: Final = 1e-13
"""A residual below this part of its terms is rounding."""
LATE: Final = 8
"""Steps after which what does not settle may be rounding."""
TURNS: Final = 4
"""Times that rows are combined anew where those before have been solved."""
REACHED: Final = 1e-10
"""A step reaches a residual of which it leaves less than this part of its terms."""


def knowns_of(e: Engine, mode: Mode, v: Floats, rates: bool) -> None:
    """Put co-energy variables, values and, if asked for, rates of sources into `e.work.xi`."""
    m = e.model
    xi = e.work.xi
    co_energy(m, v, xi)
    for k in range(mode.sources):
        xi[m.storages + k] = source_of(e, mode, k, v)
        at = m.storages + mode.sources + k
        xi[at] = 0.0
        if rates and mode.rated[k] != 0:
            xi[at] = rate_of_source(e, mode.source[k], v)


def known_of(e: Engine, mode: Mode, v: Floats, k: int) -> float:
    """Return one of them, rates of sources being left at zero."""
    m = e.model
    if k < m.storages:
        return co_energy_of(m, k, v)
    return source_of(e, mode, k - m.storages, v) if k < m.storages + mode.sources else 0.0


def source_of(e: Engine, mode: Mode, k: int, v: Floats) -> float:
    """Return the value of source k of a mode."""
    source = mode.source[k]
    law = e.model.source_value[source] if source >= 0 else -1
    return mode.source_level[k] if law < 0 else value_of_source(e, source, v)


def by_knowns(e: Engine, mode: Mode, rows: Rows, w: Floats) -> None:
    """Put what the knowns give to bond variables by such rows into `w`."""
    xi = e.work.xi
    n = 2 * e.model.bonds
    for k in range(n):
        same = mode.same[k]
        w[k] = w[same] if same < k else row_times(rows, k, xi)


def newton(e: Engine, mode: Mode, v: Floats) -> int:
    """Solve for the free unknowns, from where Newton ended last, or else from zero.

    Laws that do not know of each other one by one; else with full steps, beside jumps of laws, then
    with shorter steps, then on the way from laws with a resistance beside them; if laws have no
    values at zero, from what is known beside them; then from where full steps have ended. Only if
    none of these leads to one, what is left may be rounding; at last a law may be at its jump. What
    is found is put back into the laws.
    """
    work = e.work
    frees = mode.finite_frees
    by_knowns(e, mode, mode.finite, work.base)
    level_edges(e, mode, v, work.base)
    fit(work.step, frees + mode.dynamics + 1)
    fit(work.guess, frees + 1)
    take_rank(e, mode, v)
    # what is begun anew does not hang on what was solved before
    work.newton_order = work.newton_order and mode.guessed
    r = work.guess.at
    for j in range(frees):
        r[j] = mode.guess.at[j] if mode.guessed else 0.0
    work.swings = 0
    work.met_rounding = False
    mode.clear = False
    found = solved_apart(e, mode, v, r)
    if not found:
        for j in range(frees):
            r[j] = mode.guess.at[j] if mode.guessed else 0.0
        found = full_steps(e, mode, v, r)
    mode.clear = mode.clear and found and work.swings == 0
    if not found and work.swings == 0 and led_between(e, mode, v, r):
        found = full_steps(e, mode, v, r)
    if work.swings > 0:
        found = from_swings(e, mode, v, r)
    if not found:
        keep_end(e, frees, r)
        found = from_beside_jumps(e, mode, v, r)
    if not found and mode.rank != mode.structures:
        found = by_held_rows(e, mode, v, r)
    if not found and mode.guessed:
        found = shorter_steps(e, mode, v, r, mode.guess.at)
    if not found and mode.guessed:
        found = enclosed(e, mode, v, r, True)
    work.had_values = False
    found = found or from_nothing_known(e, mode, v, r)
    # full steps come ever nearer to a flow that is zero beside others that are not
    found = found or shorter_steps(e, mode, v, r, work.swung.at)
    if not found and work.met_rounding:
        work.takes_rounding = True
        found = mode.guessed and shorter_steps(e, mode, v, r, mode.guess.at)
        found = found or from_nothing_known(e, mode, v, r)
        work.takes_rounding = False
    found = found or at_jumps(e, mode, v, r)
    if found:
        with_free(mode, 2 * e.model.bonds, work.base, r, work.w)
        return OK
    return no_solution(e, mode, v)


def from_nothing_known(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Find a root from zero, or if laws have no values there from what is known beside them."""
    n = 2 * e.model.bonds
    with_free(mode, n, e.work.base, r, e.work.w)
    for j in range(mode.finite_frees):
        r[j] = 0.0
    with_free(mode, n, e.work.base, r, e.work.w)
    rows = system(e, mode, v, e.work.w)
    if not all_finite(rows, e.work.residual.at):
        found = from_neighbours(e, mode, v, r)
    else:
        found = damped(e, mode, v, r)
        found = found or continued(e, mode, v, r)
    found = found or led_up(e, mode, v, r)
    return found or enclosed(e, mode, v, r, False)


def level_edges(e: Engine, mode: Mode, v: Floats, base: Floats) -> None:
    """Let what a root is taken of be zero where what is known leaves only rounding of it.

    The root of rounding is large beside it, and below zero there is none: two tanks that are level
    would send a last digit to and fro without end. A law of storage that is a difference has the
    rounding of its terms.
    """
    m = e.model
    for i in range(m.edge_bonds):
        first = mode.same[m.edge_bond[i]]
        if is_level(e, mode, v, base, first):
            put_level(e, mode, base, first)
    for i in range(m.level_pairs):
        one = mode.same[m.level_pair[2 * i]]
        put_together(e, mode, base, one, mode.same[m.level_pair[2 * i + 1]])


def full_steps(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Take Newton's steps from `r` to a root; False if they do not lead to one."""
    work = e.work
    n = 2 * e.model.bonds
    frees = mode.finite_frees
    w = work.w
    update = math.inf
    share = math.inf
    turns = 0
    small = False
    fit(work.trial, frees)
    for step in range(STEPS):
        with_free(mode, n, work.base, r, w)
        rows = system(e, mode, v, w)
        if not all_finite(rows, work.residual.at):
            return False
        if is_zero(rows, work.residual.at):
            # exact already, even where a law has no slope: a root at zero flow
            mode.clear = all_finite(rows * frees, work.jacobian.at) and (
                step_beside_unseen(e, mode, rows)
            )
            mode.regular = (
                not mode.clear
                and all_finite(rows * frees, work.jacobian.at)
                and newton_step(e, rows, frees)
            )
            return True
        if not all_finite(rows * frees, work.jacobian.at):
            return False
        mode.clear = step_beside_unseen(e, mode, rows)
        mode.regular = not mode.clear and newton_step(e, rows, frees)
        if not (mode.regular or mode.clear) and stands_still(e, rows, frees):
            # after a step that was next to nothing, what cannot be reached may be rounding
            return is_left_by_laws(e, mode, v, w) or (small and is_idle_reaction(e, mode, v, w))
        scale = largest_of(n, work.base) + largest_of(frees, r)
        previous = update
        update = largest_of(frees, work.step.at)
        shared = share
        share = largest_share(e, frees, r)
        back = step > 0 and is_taken_back(work.trial.at, work.step.at, frees, BACK * update)
        swings = step > 0 and is_taken_back(work.trial.at, work.step.at, frees, SWINGS * update)
        turns = turns + 1 if back else 0
        if turns == TO_AND_FRO:
            return False
        for j in range(frees):
            r[j] -= work.step.at[j]
            work.trial.at[j] = work.step.at[j]
        exact = mode.affine and mode.rank == mode.structures
        # rounding keeps a step from vanishing: stop as well when it no longer shrinks
        small = update <= TOLERANCE * scale
        ends = small and is_settled(e, frees, r)
        shrinks = update < 0.5 * previous or (small and share < 0.5 * shared)
        falls = step > 0 and residuals_fall(e, rows)
        shrinks = shrinks or (falls and not swings)
        keep_residuals(e, rows)
        if small and not ends and step >= LATE:
            ends = leaves_rounding_of_sums(e, mode, v, r)
        if exact or ends or not shrinks:
            with_free(mode, n, work.base, r, w)
            if put_back(e, mode, v, w):
                if ends or exact or not swings:
                    return True
                keep_swing(e, frees, r)
                return False
            # from far away a step leaves rounding of where it began: the next one does not
            if exact and step > 0:
                return False
    with_free(mode, n, work.base, r, w)
    return small and is_idle_reaction(e, mode, v, w)


def leaves_rounding_of_sums(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Whether all that does not settle is rounding of what constraints' derivatives are sums of.

    Two storages at one potential exchange next to nothing where they come to rest. A flow that is
    the difference of large ones has only steps of their last digit, and an unknown beside it, which
    has all its digits, would go after these for ever. A derivative is linear in rates: what is left
    of it after a step is nothing but that.
    """
    work = e.work
    if mode.rank != mode.structures:
        return False
    with_free(mode, 2 * e.model.bonds, work.base, r, work.w)
    rows = measured_system(e, mode, v, work.w)
    if not all_finite(rows * mode.finite_frees, work.jacobian.at):
        return False
    for i in range(rows):
        if (
            mode.dynamic[i] < 0
            and math.fabs(work.residual.at[i]) <= LEFT * work.residual_size.at[i]
        ):
            work.residual.at[i] = 0.0
    return newton_step(e, rows, mode.finite_frees) and is_settled(e, mode.finite_frees, r)


def is_left_by_laws(e: Engine, mode: Mode, v: Floats, w: Floats) -> bool:
    """Whether what no slope can reach is rounding of the laws: where they are flat of their terms.

    ``(2*e - abs(e + 1) + abs(e - 1))/2`` is zero between -1 and 1, but for the last digit of 1.
    """
    if e.model.flats == 0:
        return False
    return is_exact(e, mode, v, measured_system(e, mode, v, w))


def is_idle_reaction(e: Engine, mode: Mode, v: Floats, w: Floats) -> bool:
    """Whether what does not settle may be the reaction of a contact that is open, which is nothing.

    It comes out as rounding, ever anew; the laws hold whatever it is. Where no junction has a law,
    what does not settle is a law that steps have not solved, and others come nearer.
    """
    return e.model.laws > 0 and put_back(e, mode, v, w)


def residuals_fall(e: Engine, rows: int) -> bool:
    """Whether a residual that is more than rounding has become less than half, and none twice.

    A square is come nearer to by halves; what large variables beside it leave is no reason to stop
    there.
    """
    work = e.work
    falls = False
    for i in range(rows):
        before = math.fabs(work.residual_before.at[i])
        now = math.fabs(work.residual.at[i])
        if now > 2.0 * before and now > LEFT * work.residual_size.at[i]:
            return False
        falls = falls or (now < 0.5 * before and now > LEFT * work.residual_size.at[i])
    return falls


def keep_residuals(e: Engine, rows: int) -> None:
    """Keep the residuals to hold the next ones against."""
    fit(e.work.residual_before, rows)
    copy_floats(rows, e.work.residual.at, e.work.residual_before.at)


def largest_share(e: Engine, frees: int, r: Floats) -> float:
    """Return the largest part of an unknown that the last step is."""
    most = 0.0
    for j in range(frees):
        step = math.fabs(e.work.step.at[j])
        if step > most * math.fabs(r[j]):
            most = step / math.fabs(r[j]) if r[j] != 0.0 else math.inf
    return most


def is_settled(e: Engine, frees: int, r: Floats) -> bool:
    """Whether the last step is a small part of each unknown.

    What is small beside large ones has digits of its own: the flow of an orifice near rest.
    """
    for j in range(frees):
        if math.fabs(e.work.step.at[j]) > SETTLED * math.fabs(r[j]):
            return False
    return True


def is_taken_back(before: Floats, step: Floats, frees: int, part: float) -> bool:
    """Whether a step leads back to where the one before came from: they may do so for ever.

    A law like a root does this at rest: ``e = sign(f)*sqrt(abs(f))`` steps from f to -f.
    """
    for j in range(frees):
        if math.fabs(before[j] + step[j]) > part:
            return False
    return True


def keep_swing(e: Engine, frees: int, r: Floats) -> None:
    """Keep a root that steps swing about: all that rounding allows, or steep on both sides."""
    e.work.swings = 1
    keep_end(e, frees, r)


def keep_end(e: Engine, frees: int, r: Floats) -> None:
    """Keep where full steps have ended."""
    fit(e.work.swung, frees)
    copy_floats(frees, r, e.work.swung.at)


def from_swings(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Go on with shorter steps from where full ones swing; if that leads nowhere, stay there."""
    if not shorter_steps(e, mode, v, r, e.work.swung.at):
        copy_floats(mode.finite_frees, e.work.swung.at, r)
    return True


def shorter_steps(e: Engine, mode: Mode, v: Floats, r: Floats, begin: Floats) -> bool:
    """Take shorter steps from `begin`."""
    copy_floats(mode.finite_frees, begin, r)
    return damped(e, mode, v, r)


def by_held_rows(e: Engine, mode: Mode, v: Floats, r: Floats) -> bool:
    """Solve with rows of the power structure combined as where it begins, and from there as ever.

    How they are combined turns with their slopes. Where amplifiers reach their limits between one
    step and the next it turns so far that no part of a step leaves less.
    """
    frees = mode.finite_frees
    for j in range(frees):
        r[j] = mode.guess.at[j] if mode.guessed else 0.0
    fit(e.work.held, frees)
    for _ in range(TURNS):
        with_free(mode, 2 * e.model.bonds, e.work.base, r, e.work.w)
        rows = system(e, mode, v, e.work.w)
        if not all_finite(rows, e.work.residual.at):
            return False
        e.work.holds_rows = True
        found = damped(e, mode, v, r)
        e.work.holds_rows = False
        if not found:
            return False
        copy_floats(frees, r, e.work.held.at)
        if full_steps(e, mode, v, r):
            return True
        copy_floats(frees, e.work.held.at, r)
    return False


def no_solution(e: Engine, mode: Mode, v: Floats) -> int:
    """Refuse laws for which no solution was found, or one of them that has no value."""
    work = e.work
    guessed = mode.guessed
    mode.guessed = False
    for j in range(mode.finite_frees):
        work.guess.at[j] = mode.guess.at[j] if guessed else 0.0
    with_free(mode, 2 * e.model.bonds, work.base, work.guess.at, work.w)
    rows = system(e, mode, v, work.w)
    if not all_finite(rows, work.residual.at) and not work.had_values:
        return blame(e, mode, v)
    no_values(e, mode)
    e.fault.t = v[0]
    return NOT_FINITE


def no_values(e: Engine, mode: Mode) -> None:
    """Note the laws of a mode for which no common solution was found."""
    say_fault(e, "HB-N301", "no values were found at which all laws hold", first_place(e, mode))
    if e.model.tells != 0:
        tell_laws(e, mode)


def keep_guess(mode: Mode, w: Floats) -> None:
    """Keep what the free unknowns are: Newton begins there next time."""
    for j in range(mode.finite_frees):
        mode.guess.at[j] = w[mode.free_column[j]]
    mode.guessed = True


def stands_still(e: Engine, rows: int, frees: int) -> bool:
    """Whether a step leaves a part of the residual that the slopes here cannot reach.

    What one unknown has of the rounding of another is none: a flow that is zero beside an effort.
    """
    work = e.work
    most = ROUNDED * largest_of(frees, work.step.at)
    for i in range(rows):
        total = work.residual.at[i]
        size = math.fabs(total)
        rounding = 0.0
        for j in range(frees):
            term = work.jacobian.at[i * frees + j] * work.step.at[j]
            total -= term
            size += math.fabs(term)
            rounding += math.fabs(work.jacobian.at[i * frees + j]) * most
        rest = math.fabs(total)
        left = rest > REACHED * size and rest > rounding
        if left and rest > 0.5 * math.fabs(work.residual.at[i]):
            return True
    return False


def first_place(e: Engine, mode: Mode) -> Text:
    """Return the first element whose law is evaluated in a mode."""
    m = e.model
    for i in range(mode.dynamics):
        if mode.dynamic[i] >= 0:
            return node_name(m, m.dynamic_node[mode.dynamic[i]])
    return ""


def blame(e: Engine, mode: Mode, v: Floats) -> int:
    """Name the law whose value or slope is not a number."""
    m = e.model
    n = 2 * m.bonds
    mode.guessed = False
    slopes_at(e, mode, v, e.work.slopes)
    fit(e.work.row, mode.finite_frees)
    for i in range(mode.dynamics):
        by_free(mode, n, e.work.slopes.at, i * n, e.work.row.at)
        steep = not all_finite(mode.finite_frees, e.work.row.at)
        if steep or not math.isfinite(dynamic_value(e, mode, i, v)):
            d = mode.dynamic[i]
            place = node_name(m, m.dynamic_node[d]) if d >= 0 else "a constraint's derivative"
            say_fault(e, "HB-N302", "a law has no finite value or slope", place)
            if m.tells != 0:
                element = m.dynamic_node[d] if d >= 0 else NO_ELEMENT
                tell_law(e, mode, element, dynamic_value(e, mode, i, v))
            e.fault.t = v[0]
            return NOT_FINITE
    say_fault(e, "HB-N302", "the equations overflow", "")
    if m.tells != 0:
        tell_law(e, mode, OVERFLOW, 0.0)
    e.fault.t = v[0]
    return NOT_FINITE
