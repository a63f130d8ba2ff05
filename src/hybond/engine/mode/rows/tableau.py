"""The equations of one configuration as rows: power structure, storage, sources, resistors.

Rows with constant coefficients are eliminated in the order that tells structure from laws: power
structure, storage with its co-energy variables given, sources with their values given, and then
constant linear resistors. A row without unknowns is a constraint. What is left (modulated
two-ports, nonlinear laws, sources that read bond variables) is evaluated each time.

Columns: efforts and flows, co-energy variables, values of sources, rates of sources.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.elimination import USED, add_row, give, make_equal, settle_equal
from hybond.engine.mode.rows.elimination_of_another import (
    copy_elimination,
    put_in,
    repeat_elimination,
)
from hybond.engine.mode.rows.elimination_records import Elimination, begin_elimination
from hybond.engine.mode.rows.hidden_rows import give_hidden, is_constant, is_source_timed
from hybond.engine.mode.rows.storage import own_stiffness
from hybond.engine.mode.rows.storage_bonds import co_energy_bond
from hybond.engine.model import Model
from hybond.engine.words import Ints

NOT_OPEN: Final = 0
COMMON: Final = 1
NET: Final = 2
"""What is given from outside of the pair of a junction whose law is left open."""
WIDE: Final = 32
"""Ends from which on the sum of a junction is added behind all other rows.

What all branches share there, the voltage of a bus, stays one unknown in the row of each until
then; added before them the sum would put every branch into every other, and each row that is added
would be put into all. Where there are few ends that costs nothing.
"""


def switch_on(m: Model, mode: Mode) -> None:
    """Find what the machines switch ON, and the Booleans of a mode."""
    for k in range(m.switches):
        mode.on[k] = 0
    for k in range(m.machines):
        state = m.state_first[k] + mode.state[k]
        for i in range(m.on_first[state], m.on_first[state + 1]):
            mode.on[m.on_switch[i]] = 1
    for k in range(m.switches):
        mode.flags[k] = float(mode.on[k])
    for k in range(m.machines):
        for s in range(m.state_first[k], m.state_first[k + 1]):
            mode.flags[m.switches + s] = 1.0 if s == m.state_first[k] + mode.state[k] else 0.0


def part_of(m: Model, mode: Mode, element: int) -> int:
    """Return what an element says in a mode."""
    number = 0
    for i in range(m.select_first[element], m.select_first[element + 1]):
        index = m.select_index[i]
        state = 0
        if m.select_kind[i] == 0:
            state = mode.state[index]
        else:
            for d in range(m.discrete):
                if m.discrete_kind[d] == m.select_kind[i] and m.discrete_index[d] == index:
                    state = mode.state[m.machines + d]
        number = number * m.select_many[i] + state
    return m.element_part[m.element_first[element] + number]


def build(e: Engine, mode: Mode) -> int:
    """Eliminate the rows of a configuration, into `e.work.power` and `e.work.built`.

    ``mode.given[k]`` says which variable of junction k is given from outside: NOT_OPEN, COMMON or
    NET. Returns how many hidden rows determine nothing: differentiating once is not enough.
    """
    m = e.model
    given = mode.given
    mode.sources = 0
    mode.dynamics = 0
    # what is the same in every mode comes first
    if begins_as_known(e, mode):
        repeat_steady(e, mode)
    else:
        add_steady(e, mode)
    for element in range(m.steady, m.elements):
        add_power(e, mode, part_of(m, mode, element))
    for j in range(m.junctions):
        if given[j] != NOT_OPEN:
            add_port(e, mode, j, given[j])
    for j in range(m.junctions):
        if given[j] == NOT_OPEN and m.junction_switch[j] >= 0:
            if mode.on[m.junction_switch[j]] != 0:
                add_joined(e, j, -1)
            else:
                add_nothing(e, j, -1)
    for element in range(m.steady, m.elements):
        add_laws(e, part_of(m, mode, element))
    mode.knowns = m.storages + 2 * mode.sources
    return add_hidden(e, mode, 2 * m.bonds + m.storages)


def is_steady(m: Model, mode: Mode) -> bool:
    """Whether a mode begins as all do: its rows are not weighed, none of them is left open."""
    plain = not mode.weighed
    for j in range(m.junctions):
        plain = plain and (m.junction_switch[j] >= 0 or mode.given[j] == NOT_OPEN)
    return plain


def begins_as_known(e: Engine, mode: Mode) -> bool:
    """Whether the rows that are the same in every mode are known as this mode would add them.

    Which unknowns end a row hangs on what a mode's own elements are, sources or not.
    """
    w = e.work
    known = w.steady_known and is_steady(e.model, mode)
    if known:
        note_last(e.model, mode, w.steady.same, w.power.last)
        for k in range(w.power.unknowns):
            known = known and w.power.last[k] == w.steady.last[k]
    return known


def add_steady(e: Engine, mode: Mode) -> None:
    """Add the rows that are the same in every mode, and keep what they come to."""
    m = e.model
    w = e.work
    power = w.power
    unknowns = 2 * m.bonds
    begin_elimination(power)
    weigh_storages(e)
    begin_elimination(w.table)
    w.agreements = 0
    w.agreement_entries = 0
    join_equal(m, power, mode.given)
    note_read(m, power)
    note_last(m, mode, power.same, power.last)
    for k in range(unknowns):
        power.weight[k] = mode.weight[power.same[k]] if mode.weighed else 1.0
    for k in range(m.storages):
        at = co_energy_bond(m, k)
        give(power, at, 1.0 if m.storage_kind[k] == 0 else float(m.storage_sign[k]))
        give(power, unknowns + k, -1.0)
        keep(e, add_row(power))
    for element in range(m.steady):
        add_power(e, mode, part_of(m, mode, element))
    for j in range(m.junctions):
        if m.junction_switch[j] < 0 and mode.given[j] == NOT_OPEN and not is_wide(m, j):
            add_balance(e, j, -1)
    for element in range(m.steady):
        add_laws(e, part_of(m, mode, element))
    # where there is one mode nobody asks for them again
    if m.machines + m.discrete > 0 and is_steady(m, mode) and w.agreements == 0:
        repeat_elimination(power, w.steady)
        repeat_elimination(w.table, w.steady_table)
        w.steady_known = True


def repeat_steady(e: Engine, mode: Mode) -> None:
    """Go on from the rows that are the same in every mode, bit for bit as if they were added."""
    m = e.model
    w = e.work
    repeat_elimination(w.steady, w.power)
    repeat_elimination(w.steady_table, w.table)
    w.agreements = 0
    w.agreement_entries = 0
    for element in range(m.steady):
        part = part_of(m, mode, element)
        for _ in range(m.part_power[part], m.part_law[part]):
            list_source(m, mode, m.part_source[part])
        list_dynamics(m, mode, part)


def weigh_storages(e: Engine) -> None:
    """Let of storages that depend on each other the one be solved for that holds the least.

    A co-energy variable that is so large for one joule. What stays are those that hold nearly all:
    a rate that follows what a mass of a milligram has beside a ton is a difference of sums in which
    it is lost.
    """
    w = e.work
    m = e.model
    if w.weighed:
        return
    w.weighed = True
    for k in range(m.storages):
        w.at_start[m.stored_slot + k] = m.storage_start[k]
    for k in range(m.storages):
        root = math.sqrt(math.fabs(own_stiffness(m, k, w.at_start)))
        w.table.weight[k] = root if root > 0.0 and math.isfinite(root) else 1.0


def join_equal(m: Model, power: Elimination, given: Ints) -> None:
    """Make the common variables of junctions one that are always ON."""
    for j in range(m.junctions):
        if m.junction_switch[j] >= 0 or given[j] != NOT_OPEN:
            continue
        common = 0 if m.junction_kind[j] == 0 else m.bonds
        for i in range(m.end_first[j], m.end_first[j + 1] - 1):
            make_equal(power, common + m.end_bond[i], common + m.end_bond[i + 1])
    settle_equal(power)


def note_read(m: Model, power: Elimination) -> None:
    """Note the bond variables that laws read which jump, or are flat, where these are zero.

    A smooth law bears what rounding leaves of a difference. That what is read here is exact costs
    digits elsewhere, where a flow is left over of large efforts.
    """
    for k in range(power.unknowns):
        power.read[k] = 0
    for d in range(m.dynamics):
        if m.dynamic_jumps[d] != 0:
            power.read[power.same[m.dynamic_partner[d]]] = 1


def note_last(m: Model, mode: Mode, same: Ints, last: Ints) -> None:
    """Note the forces of sources of flow, and the flows of sources of effort, that no bond shares.

    What laws read is no such end.
    """
    for k in range(2 * m.bonds):
        last[k] = 0
    for element in range(m.elements):
        part = part_of(m, mode, element)
        if m.part_source[part] < 0:
            continue
        for row in range(m.part_power[part], m.part_law[part]):
            for i in range(m.row_first[row], m.row_first[row + 1]):
                k = m.row_column[i]
                last[k + m.bonds if k < m.bonds else k - m.bonds] = 1
    for k in range(2 * m.bonds):
        if same[k] != k:
            last[k] = 0
            last[same[k]] = 0
    for d in range(m.dynamics):
        if m.dynamic_partner[d] >= 0:
            last[m.dynamic_partner[d]] = 0


def keep(e: Engine, left: int) -> None:
    """Keep a row that constrains knowns only: they are made independent of each other."""
    if left == USED:
        return
    power = e.work.power
    table = e.work.table
    first = power.unknowns
    for i in range(left):
        at = power.met[i]
        give(table, at - first, power.total[at])
    if left > 0:
        store_agreement(e, add_row(table))


def store_agreement(e: Engine, left: int) -> None:
    """Keep a row among sources alone."""
    if left == USED or left == 0:
        return
    w = e.work
    table = w.table
    for i in range(left):
        w.agreement_column[w.agreement_entries] = table.met[i]
        w.agreement_value[w.agreement_entries] = table.total[table.met[i]]
        w.agreement_entries += 1
    w.agreements += 1
    w.agreement_first[w.agreements] = w.agreement_entries


def give_row(m: Model, power: Elimination, row: int) -> None:
    """Give a row of the tables."""
    for i in range(m.row_first[row], m.row_first[row + 1]):
        give(power, m.row_column[i], m.row_value[i])


def add_power(e: Engine, mode: Mode, part: int) -> None:
    """Add the power structure of a part; the value of a source gets the next column."""
    m = e.model
    source = m.part_source[part]
    for row in range(m.part_power[part], m.part_law[part]):
        give_row(m, e.work.power, row)
        if source >= 0:
            give(e.work.power, 2 * m.bonds + m.storages + mode.sources, -1.0)
            list_source(m, mode, source)
        keep(e, add_row(e.work.power))
    list_dynamics(m, mode, part)


def list_source(m: Model, mode: Mode, source: int) -> None:
    """List a source of a part among those of the mode, if there is one."""
    if source >= 0:
        mode.source[mode.sources] = source
        mode.source_level[mode.sources] = m.source_constant[source]
        mode.sources += 1


def list_dynamics(m: Model, mode: Mode, part: int) -> None:
    """List what of a part is evaluated each time."""
    for d in range(m.part_dynamic[part], m.part_dynamic[part + 1]):
        mode.dynamic[mode.dynamics] = d
        mode.dynamics += 1


def add_laws(e: Engine, part: int) -> None:
    """Add the laws of a part."""
    m = e.model
    for row in range(m.part_law[part], m.part_power[part + 1]):
        give_row(m, e.work.power, row)
        keep(e, add_row(e.work.power))


def is_wide(m: Model, j: int) -> bool:
    """Whether a junction has so many ends that its sum is added last."""
    return m.end_first[j + 1] - m.end_first[j] >= WIDE


def add_wide(e: Engine, mode: Mode) -> int:
    """Add the sums of junctions with many ends that are ON; return how many determine something."""
    m = e.model
    many = 0
    for j in range(m.junctions):
        if not is_sum_last(m, mode, j):
            continue
        give_balance(m, e.work.power, j)
        left = add_row(e.work.power)
        if left == USED:
            e.work.wide[many] = j
            many += 1
        keep(e, left)
    return many


def is_sum_last(m: Model, mode: Mode, j: int) -> bool:
    """Whether a junction makes a sum zero in a mode that is added last."""
    switch = m.junction_switch[j]
    return is_wide(m, j) and mode.given[j] == NOT_OPEN and (switch < 0 or mode.on[switch] != 0)


def give_balance(m: Model, x: Elimination, j: int) -> None:
    """Give the sum that a junction, ON, makes zero."""
    other = m.bonds if m.junction_kind[j] == 0 else 0
    for i in range(m.end_first[j], m.end_first[j + 1]):
        give(x, other + m.end_bond[i], float(m.end_sign[i]))


def add_balance(e: Engine, j: int, own: int) -> None:
    """Add the sum that a junction, ON, makes zero, or the known column `own`."""
    give_balance(e.model, e.work.power, j)
    if own >= 0:
        give(e.work.power, own, -1.0)
    keep(e, add_row(e.work.power))


def add_joined(e: Engine, j: int, own: int) -> None:
    """Add the rows of a junction that is ON."""
    m = e.model
    common = 0 if m.junction_kind[j] == 0 else m.bonds
    for i in range(m.end_first[j], m.end_first[j + 1] - 1):
        give(e.work.power, common + m.end_bond[i], 1.0)
        give(e.work.power, common + m.end_bond[i + 1], -1.0)
        keep(e, add_row(e.work.power))
    if own >= 0 or not is_wide(m, j):
        add_balance(e, j, own)


def add_nothing(e: Engine, j: int, own: int) -> None:
    """Add the rows of a junction that is OFF: each bond gets zero, or the known column `own`."""
    m = e.model
    common = 0 if m.junction_kind[j] == 0 else m.bonds
    for i in range(m.end_first[j], m.end_first[j + 1]):
        give(e.work.power, common + m.end_bond[i], 1.0)
        if own >= 0:
            give(e.work.power, own, -1.0)
        keep(e, add_row(e.work.power))


def add_port(e: Engine, mode: Mode, j: int, given: int) -> None:
    """Add the rows of a junction one of whose pair of variables is given: a source without law."""
    m = e.model
    own = 2 * m.bonds + m.storages + mode.sources
    mode.source[mode.sources] = -1 - j
    if not mode.weighed:
        mode.source_level[mode.sources] = 0.0
    mode.sources += 1
    if given == COMMON:
        add_nothing(e, j, own)
    else:
        add_joined(e, j, own)


def add_hidden(e: Engine, mode: Mode, value0: int) -> int:
    """Add the time derivatives of constraints; return how many determine nothing.

    What is stored dependently is not asked afterwards: sums that cancel on the constraints are
    gone.
    """
    m = e.model
    w = e.work
    finite = w.finite
    table = w.table
    w.built = finite
    # sums of wide junctions are the last rows of the power structure, but behind the derivatives of
    # constraints in what is evaluated: it goes on from before them where there are any
    tied = table.done > 0
    if tied:
        copy_elimination(w.power, finite)
    wide = add_wide(e, mode)
    if table.done == 0:
        w.built = w.power
        return 0
    if not tied:
        copy_elimination(w.power, finite)
        wide = 0
    tell_pivots(e, mode)
    # where much is tied all of it would stand in each row until then
    at_once = table.done >= WIDE
    if at_once:
        put_in(finite, table, 2 * m.bonds, w.told)
    too_high = 0
    for c in range(table.done):
        pivot = table.order[c]
        mode.constraint_hidden[c] = -1
        if is_constant(e, mode, pivot):
            give_hidden(e, mode, pivot, value0)
            if add_row(finite) != USED:
                too_high += 1
        else:
            mode.constraint_hidden[c] = mode.dynamics
            mode.dynamic[mode.dynamics] = -1 - c
            mode.dynamics += 1
    for i in range(wide):
        # a row that is left with nothing to determine is one derivative too many
        give_balance(m, finite, w.wide[i])
        if add_row(finite) != USED:
            too_high += 1
    if not at_once:
        put_in(finite, table, 2 * m.bonds, w.told)
    return too_high


def tell_pivots(e: Engine, mode: Mode) -> None:
    """Tell the storages that constraints determine by others and by time alone."""
    m = e.model
    table = e.work.table
    told = e.work.told
    for k in range(m.storages):
        told[k] = 0
    for c in range(table.done):
        pivot = table.order[c]
        told[pivot] = 1
        for i in range(table.first[pivot], table.first[pivot] + table.count[pivot]):
            k = table.column.at[i] - m.storages
            if k >= 0 and not is_source_timed(m, mode, k):
                told[pivot] = 0
