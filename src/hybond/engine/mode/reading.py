"""Bond variables that are read while time passes: those and no others are evaluated in a step.

Which these are is told once, for the rates of the state when a mode is made, for guards when they
begin to be watched. At events and where something is printed all are evaluated.
"""

from __future__ import annotations

from hybond.engine.algebra.blocks import Rows, row_times
from hybond.engine.engine import Engine
from hybond.engine.mode.digits.closely import rate_by_row, row_twofold
from hybond.engine.mode.mode_records import Mode, Reads
from hybond.engine.mode.nonlinear.apart import given_of
from hybond.engine.mode.nonlinear.level import are_level, is_level
from hybond.engine.mode.rows.sources_of_time import rate_of_source, value_of_source
from hybond.engine.mode.rows.storage import co_energy_of, law_at
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.model import Model
from hybond.engine.words import Floats


def read_nothing(m: Model, r: Reads) -> None:
    """Forget what is read."""
    r.many = 0
    r.plain = False
    for b in range(2 * m.bonds):
        r.chosen[b] = 0
        r.first_of[b] = 0
    for k in range(m.most_sources):
        r.valued[k] = 0
        r.rated[k] = 0
    r.stores = 0
    for k in range(m.storages):
        r.stored[k] = 0


def read_rates(e: Engine, mode: Mode, r: Reads) -> None:
    """Read what the rates of the state do: of stored quantities, of integrated signals."""
    m = e.model
    read_nothing(m, r)
    read_nothing(m, mode.signals)
    for k in range(m.storages):
        at = rate_bond(m, k)
        mode.rate_row[k] = mode.same[at]
        read_bond(m, mode, r, at)
    for k in range(m.integrals):
        read_pair(m, mode, r, m.rule_first[m.machines] + k)
        read_pair(m, mode, mode.signals, m.rule_first[m.machines] + k)


def read_guard(m: Model, mode: Mode, r: Reads, rule: int) -> None:
    """Read what a guard does, and what rounding of that is measured by."""
    begin = r.many
    read_pair(m, mode, r, rule)
    for i in range(begin, r.many):
        at = r.bond[i] * mode.finite_frees
        for j in range(mode.finite_frees):
            if mode.finite_free.at[at + j] != 0.0:
                read_bond(m, mode, r, mode.free_column[j])


def note_plain(m: Model, mode: Mode, r: Reads) -> None:
    """Note whether all that is read is known without Newton: no unknown has part in it.

    Laws that are solved for what they read have Newton tell where there is no solution: those are
    not plain. Of two that are put level both are read, or neither is.
    """
    r.plain = mode.dynamics > 0
    r.plain_of = mode.eliminated
    for i in range(m.level_pairs):
        one = r.first_of[mode.same[m.level_pair[2 * i]]] != 0
        r.plain = r.plain and one == (r.first_of[mode.same[m.level_pair[2 * i + 1]]] != 0)
    for i in range(mode.dynamics if r.plain else 0):
        r.plain = r.plain and gives_alone(m, mode, i)
    for i in range(r.many if r.plain else 0):
        r.plain = r.plain and not has_part(mode, r.bond[i])


def reads_plainly(m: Model, mode: Mode, r: Reads) -> bool:
    """Whether no unknown has part in what is read, of rows as they are eliminated now."""
    if r.plain_of != mode.eliminated:
        note_plain(m, mode, r)
    return r.plain


def gives_alone(m: Model, mode: Mode, i: int) -> bool:
    """Whether a row is a law that reads what is known, and gives a variable that is none."""
    d = mode.dynamic[i]
    given = given_of(m, d)
    if given < 0:
        return False
    for p in range(m.law_reads[d], m.law_reads[d + 1]):
        k = m.law_column[p]
        if k != given and has_part(mode, k):
            return False
    return has_part(mode, given)


def has_part(mode: Mode, k: int) -> bool:
    """Whether an unknown has part in a bond variable."""
    return mode.finite_frees > 0 and mode.share_first.at[k] < mode.share_first.at[k + 1]


def show_plain(e: Engine, mode: Mode, r: Reads, v: Floats) -> None:
    """Put these into `v`, as Newton has them."""
    put_knowns(e, mode, r, v)
    w = e.work.w
    for i in range(r.many):
        same = mode.same[r.bond[i]]
        if r.first_of[same] == r.bond[i] + 1:
            w[same] = row_times(mode.finite, same, e.work.xi) + 0.0
    level_read(e, mode, r, v)
    for i in range(r.many):
        b = r.bond[i]
        w[b] = w[mode.same[b]]
        v[e.model.bond_slot + b] = w[b]


def level_read(e: Engine, mode: Mode, r: Reads, v: Floats) -> None:
    """Let what a root is taken of be zero, where it is read, and is rounding.

    As `newton.level_edges` does of all bond variables.
    """
    m = e.model
    w = e.work.w
    for i in range(m.edge_bonds):
        same = mode.same[m.edge_bond[i]]
        if r.first_of[same] != 0 and is_level(e, mode, v, w, same):
            w[same] = 0.0
    for i in range(m.level_pairs):
        one = mode.same[m.level_pair[2 * i]]
        other = mode.same[m.level_pair[2 * i + 1]]
        if r.first_of[one] != 0 and are_level(mode, w, one, other):
            w[one] = w[other]


def read_pair(m: Model, mode: Mode, r: Reads, pair: int) -> None:
    """Read the bond variables that a guard or a rate does."""
    for i in range(m.read_first[pair], m.read_first[pair + 1]):
        b = m.read_slot[i] - m.bond_slot
        if b >= 0 and b < 2 * m.bonds:
            read_bond(m, mode, r, b)


def read_bond(m: Model, mode: Mode, r: Reads, b: int) -> None:
    """Read a bond variable, with the storages and sources that its terms are made of."""
    if r.chosen[b] != 0:
        return
    r.chosen[b] = 1
    r.bond[r.many] = b
    r.many += 1
    if r.first_of[mode.same[b]] != 0:
        return
    r.first_of[mode.same[b]] = b + 1
    read_knowns(m, mode, r, mode.finite, mode.same[b])
    read_knowns(m, mode, r, mode.direct, mode.same[b])


def read_knowns(m: Model, mode: Mode, r: Reads, rows: Rows, k: int) -> None:
    """Read the storages and the sources whose values and rates stand in a row."""
    for i in range(rows.first.at[k], rows.first.at[k + 1]):
        known = rows.column.at[i]
        source = known - m.storages
        if known < m.storages:
            if r.stored[known] == 0:
                r.stored[known] = 1
                r.storage[r.stores] = known
                r.stores += 1
        elif source >= mode.sources:
            r.rated[source - mode.sources] = mode.rated[source - mode.sources]
        else:
            r.valued[source] = 1


def show_read(e: Engine, mode: Mode, r: Reads, v: Floats) -> None:
    """Put what the knowns there are give to the bond variables that are read into `v`."""
    read_by_knowns(mode, r, e.work.xi, e.work.w)
    for i in range(r.many):
        v[e.model.bond_slot + r.bond[i]] = e.work.w[r.bond[i]]


def rates_by_knowns(e: Engine, mode: Mode, v: Floats, rate: Floats) -> None:
    """Put the rates of what is stored there, and what those of signals read into `v`."""
    m = e.model
    xi = e.work.xi
    put_knowns(e, mode, mode.rates, v)
    for k in range(m.storages):
        row = mode.rate_row[k]
        way = way_of_rate(m, k)
        if mode.closely:
            total = row_twofold(e.work, mode.direct, row, xi)
            e.rate_rest[k] = way * e.work.over
        else:
            total = row_times(mode.direct, row, xi)
        rate[k] = way * total
    show_read(e, mode, mode.signals, v)


def put_knowns(e: Engine, mode: Mode, r: Reads, v: Floats) -> None:
    """Put the knowns that are read of a mode without Newton into `e.work.xi`."""
    m = e.model
    xi = e.work.xi
    for i in range(r.stores):
        port = r.storage[i]
        first = m.stiff_first[port]
        law = m.co_energy[port]
        if law >= 0:
            xi[port] = law_at(m, port, law, v[m.stored_slot + port], v)
        elif m.stiff_first[port + 1] == first + 1:
            xi[port] = m.stiff_constant[first] * v[m.stored_slot + m.stiff_other[first]]
        else:
            xi[port] = co_energy_of(m, port, v)
    for k in range(mode.sources):
        source = mode.source[k]
        at = m.storages + k
        if r.valued[k] != 0:
            given = m.source_value[source] if source >= 0 else -1
            xi[at] = mode.source_level[k] if given < 0 else value_of_source(e, source, v)
        xi[at + mode.sources] = rate_of_source(e, source, v) if r.rated[k] != 0 else 0.0


def read_by_knowns(mode: Mode, r: Reads, xi: Floats, w: Floats) -> None:
    """Put what the knowns `xi` give to the bond variables that are read into `w`."""
    for i in range(r.many):
        b = r.bond[i]
        first = r.first_of[mode.same[b]] - 1
        w[b] = w[first] if first != b else row_of_rate(mode, mode.same[b], xi)


def row_of_rate(mode: Mode, k: int, xi: Floats) -> float:
    """Return what the knowns `xi` give to a bond variable by row k."""
    return rate_by_row(mode.direct, k, xi) if mode.closely else row_times(mode.direct, k, xi)
