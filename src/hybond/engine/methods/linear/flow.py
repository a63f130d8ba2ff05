"""Which modes are linear, and what the flow of such a mode is."""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.algebra.products import all_finite
from hybond.engine.engine import NOT_FINITE, OK, Engine
from hybond.engine.methods.linear.balance import take_matrix
from hybond.engine.methods.linear.flow_columns import put_column, put_stored, stands_alone
from hybond.engine.methods.linear.flow_records import (
    NO_FLOW,
    ROOM,
    Exact,
    Flow,
    make_flow,
)
from hybond.engine.methods.linear.graded import grade
from hybond.engine.methods.linear.linear_rows import open_rows
from hybond.engine.mode.mode_records import Mode
from hybond.engine.model import Model
from hybond.engine.words import ints, records, some

FEWEST_FLOWS: Final = 4
"""Kept whatever they take."""
OF_A_FLOW: Final = 500
"""Numbers that each takes beside its matrices."""
STORAGE: Final = 0
LAWS: Final = 1


def take_flow(e: Engine) -> None:
    """Take the flow of the present mode, if it has one; else it is left to rk45."""
    x = e.exact
    x.on = False
    if e.slide.k > 0:
        note_slide(e)
        return
    mode = e.mode
    first = not mode.flow_known
    if first:
        mode.flow = NO_FLOW
        mode.flow_why = -1
        mode.flow_known = True
    if mode.flow_why < 0 and mode.flow == NO_FLOW:
        mode.flow_why = why_not(e, mode)
        if mode.flow_why < 0 and make_flow_of(e, mode) != OK:
            mode.flow_why = LAWS
    if first:
        x.found[mode.flow_why + 1] += 1
    if mode.flow_why >= 0:
        return
    x.flow = some(x.flows[mode.flow])
    x.clock += 1
    x.used[mode.flow] = x.clock
    x.on = True


def note_slide(e: Engine) -> None:
    """Count a motion along surfaces, once."""
    m = e.model
    first = e.slide.surface[0]
    if e.exact.slid[first] == 0:
        e.exact.slid[first] = 1
        e.exact.found[m.reasons + 1] += 1


def why_not(e: Engine, mode: Mode) -> int:
    """Return the number of the reason why a mode is not linear, -1 if it is."""
    m = e.model
    if m.groups > 0:
        return STORAGE
    if m.forms_why >= 0:
        return m.forms_why
    if mode.rank != mode.structures:
        return LAWS
    solved = mode.dynamics > 0
    for k in range(mode.sources):
        s = mode.source[k]
        if s < 0:
            continue
        why = m.form_why[s]
        if why >= 0 and (solved or mode.rates.valued[k] != 0):
            return why
        why = m.form_why[m.sources + s]
        asked = is_rate_asked(m, mode, k) if solved else mode.rates.rated[k] != 0
        if asked and (why >= 0 or reads_bonds(m, m.sources + s)):
            return max(why, LAWS)
    return LAWS if mode.dynamics > 0 and not open_rows(e, mode) else -1


def reads_bonds(m: Model, form: int) -> bool:
    """Whether a form has terms with bond variables."""
    return (
        m.form_first[form] < m.form_first[form + 1]
        and m.form_column[m.form_first[form]] < 2 * m.bonds
    )


def is_rate_asked(m: Model, mode: Mode, k: int) -> bool:
    """Whether the rate of a source of the mode stands in any of its rows."""
    for i in range(mode.finite.first.at[mode.finite.rows]):
        if mode.finite.column.at[i] == m.storages + mode.sources + k:
            return True
    return False


def make_flow_of(e: Engine, mode: Mode) -> int:
    """Make the flow of a mode, in the place of the one that was used least recently."""
    x = e.exact
    size = place_generators(e, mode)
    n = e.states + size
    at = free_place(e, n)
    f = some(x.flows[at])
    f.gens = 0
    for g in range(e.model.generators):
        if x.place[g] >= 0:
            f.gen[f.gens] = g
            f.gens += 1
    fit(x.dense, n * n)
    for i in range(n * n):
        x.dense.at[i] = 0.0
    begin = 0
    if stands_alone(e.model, mode):
        put_stored(e, mode, n)
        begin = e.states
    for c in range(begin, n):
        if put_column(e, mode, f, n, c) != OK:
            return NOT_FINITE
    put_generators(e.model, x, f, e.states, n)
    if not all_finite(n * n, x.dense.at):
        return NOT_FINITE
    take_matrix(f, n, x.dense.at)
    grade(e, mode, f)
    fit_places(f.watched, f.gens)
    f.watches = 0
    for k in range(f.gens):
        if e.model.generator_moving[f.gen[k]] != 0:
            f.watched.at[f.watches] = e.states + k
            f.watches += 1
    f.owner = e.mode_at
    mode.flow = at
    return OK


def free_place(e: Engine, n: int) -> int:
    """Return a place for a flow of that size."""
    x = e.exact
    most = max(FEWEST_FLOWS, ROOM // (8 * n * n + OF_A_FLOW))
    if x.made < most:
        if x.made == x.places:
            make_places_for_flows(x, 2 * x.places)
        at = x.made
        x.flows[at] = make_flow(e.model)
        x.made += 1
        return at
    at = 0
    # places behind are those of smaller ones
    for k in range(min(most, x.made)):
        if x.used[k] < x.used[at]:
            at = k
    owner = some(x.flows[at]).owner
    if owner >= 0 and some(e.modes[owner]).flow == at:
        some(e.modes[owner]).flow = NO_FLOW
    return at


def make_places_for_flows(x: Exact, many: int) -> None:
    """Make room for so many flows, and keep those that are there."""
    more = records(Flow, many)
    used = ints(many)
    for k in range(x.made):
        more[k] = some(x.flows[k])
        used[k] = x.used[k]
    x.flows = more
    x.used = used
    x.places = many


def place_generators(e: Engine, mode: Mode) -> int:
    """Find the generators that a mode needs; return how many."""
    m = e.model
    x = e.exact
    for g in range(m.generators):
        x.place[g] = -1
    x.place[m.generator_one] = 0
    for k in range(mode.sources):
        s = mode.source[k]
        if s >= 0:
            if mode.dynamics > 0 or mode.rates.valued[k] != 0:
                mark_form(m, x, s)
            if mode.rated[k] != 0 or mode.dynamics > 0:
                mark_form(m, x, m.sources + s)
    for i in range(mode.dynamics):
        if mode.dynamic[i] >= 0:
            mark_form(m, x, 2 * m.sources + mode.dynamic[i])
    for k in range(m.integrals):
        mark_form(m, x, 2 * m.sources + m.dynamics + k)
    marked = True
    while marked:
        marked = False
        for g in range(m.generators):
            if x.place[g] < 0:
                continue
            for p in range(m.generator_first[g], m.generator_first[g + 1]):
                if x.place[m.generator_column[p]] < 0:
                    x.place[m.generator_column[p]] = 0
                    marked = True
    many = 0
    for g in range(m.generators):
        if x.place[g] >= 0:
            x.place[g] = e.states + many
            many += 1
    return many


def mark_form(m: Model, x: Exact, form: int) -> None:
    """Mark the generators of a form, if it is there."""
    first = 2 * m.bonds + m.storages + m.integrals
    for p in range(m.form_first[form], m.form_first[form + 1]):
        if m.form_column[p] >= first:
            x.place[m.form_column[p] - first] = 0


def put_generators(m: Model, x: Exact, f: Flow, states: int, n: int) -> None:
    """Put the rates of generators into the matrix."""
    for k in range(f.gens):
        for p in range(m.generator_first[f.gen[k]], m.generator_first[f.gen[k] + 1]):
            at = (states + k) * n + x.place[m.generator_column[p]]
            x.dense.at[at] = m.generator_rate[p]
