"""Trying a mode: its jump from the a priori state, and every signal that follows.

Nothing here decides anything; settle.py does.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import all_finite, copy_floats, copy_part, copy_places
from hybond.engine.answers import node_name, stored_name
from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.expressions.paired import evaluate_pair
from hybond.engine.expressions.pairs import (
    DIVIDED_JUMPS,
    DIVISION,
    FACTOR_JUMPS,
    IMPULSE_RTOL,
    NOT_A_NUMBER,
    POWER,
    PRODUCT,
    TABLE,
    TOO_DEEP,
    Stack,
    clear,
    is_impulsive,
)
from hybond.engine.jumps.jump import JUMPS, STAYS, enter_mode
from hybond.engine.mode.digits.part_energies import part_of_bond, see_energy, see_energy_after
from hybond.engine.mode.digits.reach import reach_of
from hybond.engine.mode.digits.sizes import measure
from hybond.engine.mode.equations import is_fieldless, mode_of
from hybond.engine.mode.limits import put_limits
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.dynamic_rows import frozen_at
from hybond.engine.mode.rows.storage import energy_of
from hybond.engine.mode.rows.storage_bonds import co_energy_bond
from hybond.engine.reasons.facts import add_fact
from hybond.engine.reasons.warned import IMPULSIVE, add_about, begin_warning
from hybond.engine.surfaces.averages import begin_sizes, freedom_here, solve_here
from hybond.engine.surfaces.combine import combine_here
from hybond.engine.surfaces.values import set_values
from hybond.engine.words import Floats, Ints, Text


def a_priori(e: Engine, t: float, x: Floats, s: Floats, state: Ints) -> int:
    """Put all signals at the left limit into `e.pre`: what ``pre()`` reads."""
    m = e.model
    if mode_of(e, state) != OK:
        return REFUSED
    for k in range(m.slots):
        e.v[m.slots + k] = 0.0
    set_values(e, e.mode, e.v, t, x, s)
    put_limits(e, e.mode, e.v)
    if combine_here(e, state) != OK:
        return REFUSED
    if solve_here(e, e.mode, e.v) != OK and not lose_bonds(e):
        return REFUSED
    show_stored(e)
    copy_part(m.slots, e.v, 0, e.pre, 0)
    return OK


def show_stored(e: Engine) -> None:
    """Let storages show what they store, even if the state is not consistent yet."""
    m = e.model
    for k in range(m.storages):
        at = co_energy_bond(m, k)
        sign = 1.0 if m.storage_kind[k] == 0 else float(m.storage_sign[k])
        e.v[m.bond_slot + at] = sign * e.work.xi[k]


def lose_bonds(e: Engine) -> bool:
    """Let bond variables have no value; False if entering a mode asks for some.

    What is stored at the start need not be what its mode allows: laws of resistors may have no
    common solution there, and which of several storages they would see is nobody's to say. Only
    moduli, options of junction laws and impulsive laws act a priori.
    """
    m = e.model
    if e.mode.structures > 0 or e.slide.k > 0 or is_fieldless(e, e.mode):
        return False
    for k in range(m.ports):
        follows = m.port_limit[k] >= 0 or m.port_breakaway[k] >= 0 or m.port_gate[k] >= 0
        if follows or m.port_gap[k] >= 0 or m.port_restitution[k] >= 0:
            return False
    for d in range(m.dynamics):
        if m.dynamic_impulsive[d] != 0:
            return False
    for k in range(2 * m.bonds):
        e.v[m.bond_slot + k] = math.nan
    return True


def begin_trial(e: Engine, t: float, x: Floats, s: Floats, state: Ints) -> int:
    """Take the equations of a mode and write the values on entering it."""
    m = e.model
    copy_places(m.machines, state, 0, e.trial.state, 0)
    if mode_of(e, state) != OK or combine_here(e, state) != OK:
        return REFUSED
    write_entry(e, t, x, s)
    return OK


def write_entry(e: Engine, t: float, x: Floats, s: Floats) -> None:
    """Write the values on entering `e.mode`: bond variables and the second copy a priori."""
    m = e.model
    set_values(e, e.mode, e.v, t, x, s)
    copy_part(m.slots, e.pre, 0, e.v, m.slots)
    copy_part(2 * m.bonds, e.pre, m.bond_slot, e.v, m.bond_slot)


def try_mode(e: Engine, t: float, x: Floats, s: Floats, state: Ints, jump: bool) -> int:
    """Enter a mode without laws of junctions from the state `x`; without `jump`, stay on it.

    What follows is in `e.trial` and `e.v`.
    """
    m = e.model
    if begin_trial(e, t, x, s, state) != OK:
        return REFUSED
    e.trial.struck = False
    e.trial.dusted = False
    e.trial.factors = 0
    if jump:
        take_factors(e, e.mode, e.v)
        if jump_into(e, x, e.trial.x) != OK:
            return REFUSED
    else:
        e.moved = STAYS
        copy_floats(m.storages, x, e.trial.x)
    return finish_trial(e, t, x, s)


def jump_into(e: Engine, x: Floats, after: Floats) -> int:
    """Put the state on entering `e.mode` from `x` into `after`."""
    see_energy(e, x)
    return enter_mode(e, e.mode, e.v, x, after)


def forget_jump(e: Engine) -> None:
    """Let nothing jump in the trial."""
    for k in range(e.model.slots if e.trial.jumps else 0):
        e.trial.jump[k] = 0.0
    e.trial.jumps = False


def finish_trial(e: Engine, t: float, x: Floats, s: Floats) -> int:
    """Find the signals of a mode whose jump, from `x` to that of the trial, is known."""
    m = e.model
    trial = e.trial
    trial.energy_before = energy_of(e, x)
    trial.energy_after = trial.energy_before
    see_energy(e, x)
    forget_jump(e)
    trial.jumps = e.moved == JUMPS
    if e.moved != STAYS:
        trial.energy_after = energy_of(e, trial.x)
        see_energy_after(e, trial.x)
    trial.energy_struck = trial.energy_after
    if trial.jumps:
        find_floor(e, x)
        for k in range(2 * m.bonds):
            above = math.fabs(e.impulses[k]) > e.floor[k]
            trial.jump[m.bond_slot + k] = e.impulses[k] if above else 0.0
    copy_floats(m.integrals, s, trial.s)
    if solve_trial(e) != OK:
        return REFUSED
    if trial.jumps and m.integrals > 0:
        moved = False
        stack = e.work.stack
        show_trial(e, stack)
        for k in range(m.integrals):
            clear(stack)
            measure_trial(e, m.rule_first[m.machines] + k)
            evaluate_pair(m, m.rule_first[m.machines] + k, stack)
            if stack.refused != 0:
                if m.tells != 0:
                    return refuse_integral(e, t, k)
                return refuse_pair(e, t, "an integrated signal")
            if is_impulsive(stack, stack.top) and stack.impulse[stack.top] != 0.0:
                trial.s[k] = s[k] + stack.impulse[stack.top]
                moved = True
        if moved and solve_trial(e) != OK:
            return REFUSED
    if trial.jumps and trial.factors > 0:
        return check_factors(e, t)
    return OK


def solve_trial(e: Engine) -> int:
    """Solve for the bond variables after the jump, with what they leave free."""
    m = e.model
    trial = e.trial
    copy_part(m.storages, trial.x, 0, e.v, m.stored_slot)
    copy_part(m.integrals, trial.s, 0, e.v, m.signal_slot)
    if solve_here(e, e.mode, e.v) != OK:
        trial.valueless = True
        return REFUSED
    if not all_finite(2 * m.bonds, e.work.w):
        return blame_source(e)
    copy_floats(e.mode.knowns, e.work.xi, trial.xi)
    begin_sizes(e, e.mode, e.v, trial.x, trial.terms)
    trial.loose = freedom_here(e, e.mode, e.v)
    n = 2 * m.bonds * trial.loose
    fit(trial.freedom, n)
    copy_floats(n, e.work.freedom.at, trial.freedom.at)
    return OK


def blame_source(e: Engine) -> int:
    """Refuse values that are not finite, by the source that brings them in."""
    m = e.model
    for k in range(e.mode.sources):
        source = e.mode.source[k]
        if source >= 0 and not math.isfinite(e.work.xi[m.storages + k]):
            place = node_name(m, m.source_node[source])
            return say_fault(e, "HB-N302", "a law has no finite value or slope", place)
    return say_fault(e, "HB-N302", "the equations overflow", "")


def show_trial(e: Engine, stack: Stack) -> None:
    """Let pairs be those of the trial."""
    stack.now = e.v
    stack.was = e.pre
    stack.was_first = 0
    stack.jump = e.trial.jump
    stack.jumps = e.trial.jumps
    stack.terms = e.trial.terms
    stack.prior_terms = e.trial.prior_terms


def measure_trial(e: Engine, pair: int) -> None:
    """Find what rounding of the signals that a pair reads is measured by in the trial.

    What they were before is measured in the first trial that asks: it stays what it was, and so do
    its digits, whatever the modes are that follow.
    """
    m = e.model
    trial = e.trial
    measure(e, e.mode, pair, trial.xi, e.v, trial.terms)
    for i in range(m.read_first[pair], m.read_first[pair + 1]):
        slot = m.read_slot[i]
        if trial.prior_turn[slot] != trial.turn:
            trial.prior_turn[slot] = trial.turn
            trial.prior_terms[slot] = trial.terms[slot]


def find_floor(e: Engine, x: Floats) -> None:
    """Find the size below which each bond variable's impulse counts as zero.

    That share of the largest stored quantity of its kind in the bond's domain, on its part of the
    graph, or of the largest such impulse if nothing is stored there.
    """
    m = e.model
    mode = e.mode
    kinds = m.impulse_kinds
    reach_of(e, mode, x, e.work.reach)
    for c in range((mode.parts + 1) * kinds):
        e.largest[c] = 0.0
    for k in range(m.storages):
        c = mode.bond_part[m.storage_bond[k]] * kinds + m.storage_impulse[k]
        most = max(math.fabs(e.work.reach[k]), math.fabs(x[k]))
        e.largest[c] = max(e.largest[c], max(most, math.fabs(e.trial.x[k])))
    for k in range(2 * m.bonds):
        c = part_of_bond(m, mode, k) * kinds + m.bond_impulse[k]
        e.largest[c] = max(e.largest[c], math.fabs(e.impulses[k]))
    for k in range(2 * m.bonds):
        c = part_of_bond(m, mode, k) * kinds + m.bond_impulse[k]
        e.floor[k] = IMPULSE_RTOL * e.largest[c]


def refuse_pair(e: Engine, t: float, place: Text) -> int:
    """Refuse arithmetic on impulses that has no meaning, or what is not a number."""
    if e.work.stack.refused == NOT_A_NUMBER:
        say_fault(e, "HB-N302", why_refused(e.work.stack.refused), place)
    else:
        say_fault(e, "HB-J101", why_refused(e.work.stack.refused), place)
    e.fault.t = t
    return REFUSED


def refuse_integral(e: Engine, t: float, signal: int) -> int:
    """Refuse arithmetic on impulses in the rate of an integrated signal."""
    refuse_pair(e, t, stored_name(e.model, e.model.storages + signal))
    add_fact(e.fault, -1.0 - float(signal))
    return REFUSED


def why_refused(code: int) -> Text:
    """Return what has no meaning at a jump."""
    if code == NOT_A_NUMBER:
        return "a comparison with a value that is not a number has no meaning at a jump"
    if code == PRODUCT:
        return "a product of two impulses has no meaning at a jump"
    if code == FACTOR_JUMPS:
        return "an impulse times a factor that jumps has no meaning"
    if code == DIVISION:
        return "a division by an impulse has no meaning"
    if code == DIVIDED_JUMPS:
        return "an impulse divided by a factor that jumps has no meaning"
    if code == POWER:
        return "a power of an impulse has no meaning"
    if code == TABLE:
        return "a table read at an impulse has no meaning"
    if code == TOO_DEEP:
        return "an expression is nested too deep"
    return "a function of an impulse has no meaning"


# -- laws that are declared impulsive


def take_factors(e: Engine, mode: Mode, v: Floats) -> None:
    """Keep what multiplies impulses in laws declared impulsive."""
    m = e.model
    n = 2 * m.bonds
    trial = e.trial
    trial.factors = 0
    for i in range(mode.dynamics):
        if mode.dynamic[i] >= 0 and m.dynamic_impulsive[mode.dynamic[i]] != 0:
            trial.factors += 1
    if trial.factors == 0:
        return
    frozen_at(e, mode, v, e.work.frozen)
    fit(trial.factor, trial.factors * n)
    at = 0
    for i in range(mode.dynamics):
        if mode.dynamic[i] >= 0 and m.dynamic_impulsive[mode.dynamic[i]] != 0:
            copy_part(n, e.work.frozen.at, i * n, trial.factor.at, at)
            at += n


def check_factors(e: Engine, t: float) -> int:
    """Refuse a factor that jumps: friction that would turn the slip round creates energy."""
    m = e.model
    n = 2 * m.bonds
    trial = e.trial
    frozen_at(e, e.mode, e.v, e.work.frozen)
    at = 0
    for i in range(e.mode.dynamics):
        d = e.mode.dynamic[i]
        if d < 0 or m.dynamic_impulsive[d] == 0:
            continue
        for k in range(n):
            before = trial.factor.at[at + k]
            after = e.work.frozen.at[i * n + k]
            turned = math.fabs(after - before) > 1e-9 * (math.fabs(after) + math.fabs(before))
            if turned and e.impulses[k] != 0.0:
                why = "an impulsive law multiplies an impulse by a factor that the jump changes"
                say_fault(e, "HB-J103", why, node_name(m, m.dynamic_node[d]))
                e.fault.t = t
                return REFUSED
        at += n
    if m.tells != 0:
        warn_of_impulsive(e, e.mode)
    return OK


def warn_of_impulsive(e: Engine, mode: Mode) -> None:
    """Warn of laws declared impulsive, which a jump has taken into its equations."""
    m = e.model
    begin_warning(e.warned, IMPULSIVE, e.t)
    for i in range(mode.dynamics):
        if mode.dynamic[i] >= 0 and m.dynamic_impulsive[mode.dynamic[i]] != 0:
            add_about(e.warned, float(m.dynamic_node[mode.dynamic[i]]))
