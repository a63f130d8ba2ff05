"""The equations of a mode, ready to evaluate: made when the mode is first entered."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_rows
from hybond.engine.algebra.products import copy_floats, copy_places
from hybond.engine.engine import NO_MODE, OK, Engine, say_fault
from hybond.engine.inputs.interval import configuration
from hybond.engine.mode.digits.lesser_sizes import keep_sizes, take_lesser
from hybond.engine.mode.kept_modes import find_kept, keep_mode
from hybond.engine.mode.left_free.leakage import fold, least_leakage
from hybond.engine.mode.mode_records import NOT_KNOWN, Mode
from hybond.engine.mode.nonlinear.apart import find_groups
from hybond.engine.mode.nonlinear.followed_records import UNKNOWN
from hybond.engine.mode.nonlinear.newton import by_knowns
from hybond.engine.mode.nonlinear.newton_system import take_rank
from hybond.engine.mode.nonlinear.unseen import find_unseen
from hybond.engine.mode.reading import read_rates
from hybond.engine.mode.rows.elimination import CLEAR
from hybond.engine.mode.rows.storage import is_alone
from hybond.engine.mode.rows.tableau import build, part_of, switch_on
from hybond.engine.mode.rows.taken_rows import (
    free_columns,
    list_shares,
    share_rows,
    take_free,
    take_free_rest,
    take_free_rows,
    take_rows,
)
from hybond.engine.model import Model
from hybond.engine.reasons.warned import FAR_APART, add_about, begin_warning
from hybond.engine.words import Floats, Ints, some

TURNS: Final = 2
"""Times that rows without laws are eliminated anew if they lose digits."""
APART: Final = 0.618
"""By what levels are apart that stand for those that are not known yet."""
LEAST_LEVEL: Final = 2.0**-52
"""The least that a variable counts as, as a part of the largest of its kind."""
LEAST: Final = 1e-300
"""Likewise, where all of its kind are zero."""


def mode_of(e: Engine, state: Ints) -> int:
    """Take the equations of a mode within the present interval into `e.mode`."""
    m = e.model
    e.clock += 1
    e.straight = False
    configuration(e, state, e.key)
    at = find_kept(e, e.key)
    if at != NO_MODE:
        e.mode = some(e.modes[at])
        e.mode_at = at
        e.modes_used[at] = e.clock
        return check_depth(e, e.mode)
    e.mode_at = keep_mode(e, e.key)
    mode = some(e.modes[e.mode_at])
    e.modes_used[e.mode_at] = e.clock
    e.mode = mode
    for j in range(m.junctions):
        e.given[j] = 0
    mode.opened = False
    make_equations(e, mode, e.given)
    if m.tells != 0:
        look_at_digits(e, mode)
    e.modes_built += 1
    mode.made = e.modes_built
    return check_depth(e, mode)


def look_at_digits(e: Engine, mode: Mode) -> None:
    """Warn, once in a run, of values so far apart that sums of them lose their digits.

    Rows have twice the digits: what is small beside its terms has enough of them, unless storages
    are tied, whose constraints have those of a number.
    """
    w = e.warned
    least = min(e.work.power.least, e.work.built.least) if e.work.table.done > 0 else 1.0
    if w.far_apart or mode.too_high or not least < CLEAR:
        return
    w.far_apart = True
    begin_warning(w, FAR_APART, e.t)
    add_about(w, least)
    for k in range(e.model.machines):
        add_about(w, float(mode.state[k]))


def check_depth(e: Engine, mode: Mode) -> int:
    """Refuse a mode in which a constraint would have to be differentiated twice."""
    if mode.too_high:
        return say_fault(
            e, "HB-C103", "a constraint on storage leaves no rate free that could keep it", ""
        )
    return OK


def make_equations(e: Engine, mode: Mode, given: Ints) -> None:
    """Eliminate a configuration and keep what evaluation asks for."""
    copy_places(e.model.junctions, given, 0, mode.given, 0)
    mode.weighed = False
    mode.closely = False
    mode.lost = 0.0
    mode.rows_lost = 0.0
    mode.solves = 0
    mode.looks_due = 1
    eliminate(e, mode)
    many = 2 * e.model.bonds
    plain = mode.finite_frees == 0
    for turn in range(TURNS):
        # constraints on what is stored, and what laws tie together, are told from structure, but
        # where what is given does not fit to its last digit
        structured = e.work.table.done > 0 or (e.model.laws > 0 and not mode.doubted)
        if mode.dynamics > 0 or mode.too_high or structured:
            break
        # a leak beside an exchange 1e15 times as large is as small as rounding of the two
        if not loses_digits(e) and not mode.doubted:
            break
        for k in range(mode.knowns):
            e.work.xi[k] = level_of(e.model, mode, k)
        by_knowns(e, mode, mode.finite, e.work.w)
        if plain and turn == 0:
            keep_sizes(mode.finite, many, e.work.plain)
        eliminate_by(e, mode, e.work.w)
        if plain and mode.finite_frees == 0:
            take_lesser(mode.finite, many, e.work.plain)


def loses_digits(e: Engine) -> bool:
    """Whether coefficients have come out as small differences of large ones."""
    power = e.work.power
    built = e.work.built
    return min(power.least, built.least) < CLEAR


def level_of(m: Model, mode: Mode, k: int) -> float:
    """Return what a known counts as before any value is there: its constant, or about 1.

    No two are the same: nothing flows between equal ones.
    """
    some_level = 1.0 + math.fmod(APART * float(k + 1), 1.0)
    source = k - m.storages
    if source < 0:
        return some_level
    if source >= mode.sources:
        return 0.0
    s = mode.source[source]
    return m.source_constant[s] if s >= 0 and m.source_value[s] < 0 else some_level


def eliminate_by(e: Engine, mode: Mode, at: Floats) -> None:
    """Eliminate the rows of a mode anew, by how large bond variables are; `at` may be rounding."""
    m = e.model
    n = 2 * m.bonds
    for c in range(m.classes):
        e.work.kind_reach[c] = 0.0
    for k in range(n):
        c = m.bond_class[k]
        if math.isfinite(at[k]):
            e.work.kind_reach[c] = max(e.work.kind_reach[c], math.fabs(at[k]))
    for k in range(n):
        own = math.fabs(at[k]) if math.isfinite(at[k]) else 0.0
        mode.weight[k] = max(own, least_weight(e, k))
    weigh_by_laws(e, mode)
    mode.weighed = True
    eliminate(e, mode)


def least_weight(e: Engine, k: int) -> float:
    """Return what bond variable k counts as where nothing but rounding is known of it."""
    return max(LEAST_LEVEL * e.work.kind_reach[e.model.bond_class[k]], LEAST)


def weigh_by_laws(e: Engine, mode: Mode) -> None:
    """Let what a law gives count as that where the sums of a junction have lost it in rounding.

    The current of a leak is as large as the voltage at it says, however large those beside it are.
    """
    m = e.model
    for element in range(m.elements):
        part = part_of(m, mode, element)
        for row in range(m.part_power[part], m.part_power[part + 1]):
            first = m.row_first[row]
            if m.row_first[row + 1] != first + 2:
                continue
            for i in range(2):
                one = m.row_column[first + i]
                other = m.row_column[first + 1 - i]
                if one >= 2 * m.bonds or other >= 2 * m.bonds or m.row_value[first + i] == 0.0:
                    continue
                given = math.fabs(m.row_value[first + 1 - i] / m.row_value[first + i])
                if mode.weight[one] <= least_weight(e, one):
                    mode.weight[one] = max(mode.weight[one], given * mode.weight[other])


def eliminate(e: Engine, mode: Mode) -> None:
    """Do the same for what is given in the mode, with its weights."""
    m = e.model
    switch_on(m, mode)
    mode.eliminated += 1
    mode.too_high = build(e, mode) > 0
    for k in range(m.priors):
        mode.prior_acts[k] = 1 if is_prior_active(m, mode, k) else 0
    power = e.work.power
    built = e.work.built
    mode.doubted = power.doubted or built.doubted
    copy_places(2 * m.bonds, power.same, 0, mode.same, 0)
    mode.finite_frees = free_columns(built, mode.free_column)
    mode.bent = False
    for k in range(2 * m.bonds):
        mode.bent = mode.bent or built.read[k] != 0
    for i in range(mode.dynamics):
        mode.bent = mode.bent or mode.dynamic[i] < 0
    for j in range(mode.finite_frees):
        mode.reluctant[j] = built.read[mode.free_column[j]]
    if mode.finite_frees == 0 and mode.dynamics == 0:
        share_rows(m, built, mode)
    take_rows(built, mode.knowns, mode.same, mode.finite)
    take_free(built, mode.finite_frees, mode.free_column, mode.finite_free)
    list_shares(mode, 2 * m.bonds)
    take_free_rest(built, mode)
    divide_rows(m, mode)
    find_groups(m, mode)
    mode.acting.known = False
    mode.port_acting.known = False
    mode.power = mode.finite
    mode.power_free = mode.finite_free
    mode.power_frees = mode.finite_frees
    mode.free_sparse = False
    if e.work.table.done > 0:
        mode.power_free = mode.own_power_free
        mode.power_frees = free_columns(power, e.work.columns)
        mode.free_sparse = mode.dynamics == 0
        if mode.free_sparse:
            take_free_rows(power, mode.power_frees, e.work.columns, mode.free_rows)
        else:
            take_free(power, mode.power_frees, e.work.columns, mode.own_power_free)
    if e.work.table.done > 0 and mode.structures > 0:
        # what knowns give there is read by dynamic rows of the power structure alone
        mode.power = mode.own_power
        take_rows(power, mode.knowns, mode.same, mode.own_power)
    take_constraints(e, mode)
    list_bound(e, mode)
    note_rates(m, mode)
    mode.direct = mode.finite
    read_rates(e, mode, mode.rates)
    mode.guessed = False
    mode.branch.several = UNKNOWN
    mode.branch.others = UNKNOWN
    mode.branch.known = False
    mode.branch.basis += 1
    mode.looks = 0
    fit(mode.guess, mode.finite_frees + 1)
    mode.ways.known = False
    mode.ties.known = NOT_KNOWN
    mode.ways.parted = False
    mode.ways.shares = 0
    mode.flow_known = False
    mode.summed_known = False
    for k in range(m.storages):
        mode.stood.members[k] = 0
    mode.connected = False
    mode.saw = False
    mode.saw_at = -1.0
    for k in range(m.storages):
        mode.fades_by[k] = -1.0
    mode.fading_known = False
    mode.never_settles = False
    mode.sized = False
    mode.leakage.stages = 0
    mode.leakage.first = 0
    mode.leakage.second = 0
    mode.leakage.many = 0
    mode.loose = 0
    mode.unseen = 0
    if mode.too_high:
        return
    mode.rank = mode.structures
    take_rank(e, mode, e.v)
    mode.affine = True
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d >= 0 and m.dynamic_affine[d] == 0:
            mode.affine = False
        if d < 0 and not is_hidden_affine(m, mode, -1 - d):
            mode.affine = False
    find_unseen(e, mode)
    if mode.finite_frees == 0 or mode.dynamics > 0:
        # what laws that are evaluated leave free is known at the values that hold
        return
    fit(mode.freedom, 2 * m.bonds * mode.finite_frees)
    mode.loose = mode.finite_frees
    copy_floats(2 * m.bonds * mode.finite_frees, mode.finite_free.at, mode.freedom.at)
    least_leakage(e, mode, mode.loose, mode.freedom.at, mode.leakage)
    if mode.leakage.stages > 0:
        fold(e, mode)
        read_rates(e, mode, mode.rates)


def take_constraints(e: Engine, mode: Mode) -> None:
    """Take the constraints on what is stored, and what sources must agree on, by knowns."""
    table = e.work.table
    entries = 0
    for c in range(table.done):
        entries += 1 + table.count[table.order[c]]
    fit_rows(mode.constraints, table.done, entries)
    entries = 0
    for c in range(table.done):
        mode.constraints.first.at[c] = entries
        pivot = table.order[c]
        mode.constraints.column.at[entries] = pivot
        mode.constraints.value.at[entries] = 1.0
        mode.constraints.size.at[entries] = 1.0
        entries += 1
        for i in range(table.first[pivot], table.first[pivot] + table.count[pivot]):
            mode.constraints.column.at[entries] = table.column.at[i]
            mode.constraints.value.at[entries] = table.entry.at[i]
            mode.constraints.size.at[entries] = math.fabs(table.entry.at[i])
            entries += 1
    mode.constraints.first.at[table.done] = entries
    w = e.work
    fit_rows(mode.agreements, w.agreements, w.agreement_entries)
    for r in range(w.agreements + 1):
        mode.agreements.first.at[r] = w.agreement_first[r] if r > 0 else 0
    for i in range(w.agreement_entries):
        mode.agreements.column.at[i] = w.agreement_column[i]
        mode.agreements.value.at[i] = w.agreement_value[i]
        mode.agreements.size.at[i] = math.fabs(w.agreement_value[i])


def list_bound(e: Engine, mode: Mode) -> None:
    """List the knowns that constraints are evaluated by, in their order.

    Those that stand in them; all where they are no linear function of what is stored: their slopes
    are differences there, or their rows change with the state.
    """
    m = e.model
    linear = mode.dynamics == 0 and m.groups == 0
    for k in range(mode.sources):
        s = mode.source[k]
        if s >= 0 and m.source_value[s] >= 0 and m.source_timed[s] == 0:
            linear = False
    mark = e.work.met
    for k in range(mode.knowns):
        mark[k] = 0 if linear else 1
    for i in range(mode.constraints.first.at[mode.constraints.rows]):
        mark[mode.constraints.column.at[i]] = 1
    mode.bounds = 0
    for k in range(mode.knowns):
        if mark[k] != 0:
            mode.bound[mode.bounds] = k
            mode.bound_alone[mode.bounds] = 1 if is_alone(m, k) else 0
            mode.bounds += 1


def divide_rows(m: Model, mode: Mode) -> None:
    """Tell dynamic rows of the power structure from the others."""
    mode.structures = 0
    others = 0
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d >= 0 and m.dynamic_kind[d] == 0:
            mode.structure[mode.structures] = i
            mode.structures += 1
        else:
            mode.other[others] = i
            others += 1


def note_rates(m: Model, mode: Mode) -> None:
    """Note of which sources the rate is asked for."""
    first = m.storages + mode.sources
    for k in range(mode.sources):
        rated = mode.source[k] >= 0 and m.source_rate[mode.source[k]] >= 0
        mode.rated[k] = 1 if rated and mode.structures > 0 else 0
        if not rated or mode.structures > 0:
            continue
        for i in range(mode.finite.first.at[mode.finite.rows]):
            if mode.finite.column.at[i] == first + k:
                mode.rated[k] = 1


def is_hidden_affine(m: Model, mode: Mode, c: int) -> bool:
    """Whether the slopes of the derivative of a constraint do not read bond variables.

    Those of storage laws read what is stored; those of rates of sources may read anything.
    """
    for i in range(mode.constraints.first.at[c], mode.constraints.first.at[c + 1]):
        k = mode.constraints.column.at[i] - m.storages
        if k >= 0 and mode.source[k] >= 0 and m.source_curved[mode.source[k]] != 0:
            return False
    return True


def is_fieldless(e: Engine, mode: Mode) -> bool:
    """Whether an active law reads ``pre()``, one of a landed machine left out."""
    m = e.model
    for k in range(m.priors):
        if mode.prior_acts[k] != 0 and not is_prior_landed(e, k):
            return True
    return False


def is_prior_active(m: Model, mode: Mode, k: int) -> bool:
    """Whether a law that reads ``pre()`` acts in a mode."""
    for i in range(m.prior_first[k], m.prior_first[k + 1]):
        if mode.on[m.prior_switch[i]] == 0:
            return False
    machine = m.prior_machine[k]
    return machine < 0 or mode.state[machine] == m.prior_state[k]


def is_prior_landed(e: Engine, k: int) -> bool:
    """Whether a machine that has landed switches a law that reads ``pre()``."""
    m = e.model
    for i in range(m.prior_first[k], m.prior_first[k + 1]):
        if e.landed[m.switch_machine[m.prior_switch[i]]] != 0:
            return True
    return False
