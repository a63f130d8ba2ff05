"""What a run writes down as it goes on, for who reads it from outside: steps and instants.

Runs by hybond itself have it; a printed program has `report` in its place, which has the same
names. A step is a polynomial from ``(t0, y0)`` to ``(t1, y1)``, and the point ``(t, y)`` of it at
which it was ended, put back on its constraints. An instant is written once, when it is settled. Who
reads the rows takes them away (`forget_rows`): the log is as long as a slice of the run.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import (
    Block,
    Places,
    grow_block,
    grow_places,
    make_block,
    make_places,
)
from hybond.engine.algebra.products import copy_floats, copy_part, copy_places
from hybond.engine.engine import Engine
from hybond.engine.instant.instant import MYTHICAL, START, Instant, note_step
from hybond.engine.method_numbers import MOREAU
from hybond.engine.methods.control import is_propagated
from hybond.engine.methods.implicit.from_edges import may_turn
from hybond.engine.methods.stepping import by_radau
from hybond.engine.reasons.warned import Warned, forget_warned, make_warned
from hybond.engine.surfaces.surface import part_mode
from hybond.engine.words import Floats, floats, record

BROKEN: Final = 16
"""What the cause of an instant is more than it was, if it could not be settled."""
TERMS: Final = 4
"""Coefficients of a step's polynomial, of ``x`` to ``x^4`` with ``x = (t - t0)/(t1 - t0)``."""


@record
class Report:
    """Rows of the log.

    Of steps: `step_time` holds t0, t1, t; `step_until` the next timed event; `step_state` y0, y1,
    y; `step_dense` the coefficients, power by power; `step_place` the number of instants before it,
    the number of the combination that is slid in (0: none), then the state of each machine, then
    whether it has landed.

    Of steps of time-stepping besides: `step_bonds` are bond variables, a row for each point, and
    `step_bond` the row of each step's end, the one before being its beginning; `step_energy` what
    sources gave, resistors took, and what came from nowhere.

    Of combinations, which count from 1 on: when they begin in `slide_time`; in `slid` how many
    surfaces are slid on, and unless that is 0 whether all corners are combined, how many modes, the
    surfaces by number, the state of each machine as shown, then in each of these modes.

    Of instants: `instant_time` t, and the largest energy seen before; `instant_since` the begin of
    the step within which it happened, -1 if it was located; `instant_state` the state
    before and after; `instant_place` the cause, how many modes were visited, the number of the
    combination from there on, then the state of each machine after it, then whether it has landed.

    Of each mode visited, `visit`: its kind, how many transitions, impulses and open bond variables
    belong to it, and whether its energy is known, before, after and given by sources in
    `visit_energy`. Of each transition, `fired`: machine, source, target, why (see
    `portable.told`), how many values were read and rules passed over. Of each value, `read`: finite
    part, impulse, and whether it has one. Of each impulse, `hit`: its bond variable, and in
    `hit_area` the area and what would be none.
    """

    steps: int
    step_time: Block
    step_until: Block
    step_state: Block
    step_dense: Block
    step_place: Places
    instants: int
    """In the log now; `instants_before` were taken away."""
    instants_before: int
    instant_time: Block
    instant_since: Block
    instant_state: Block
    instant_place: Places
    visits: int
    visit: Places
    fireds: int
    fired: Places
    hits: int
    hit: Places
    hit_area: Block
    visit_energy: Block
    reads: int
    read: Block
    overs: int
    over: Places
    opens: int
    open: Places
    bond_rows: int
    bond_wide: int
    step_bonds: Block
    step_bond: Places
    step_energy: Block
    turns: int
    """Of the method that chooses by itself: times at which it went over to ``radau``, or back."""
    turn_time: Block
    implicit: bool
    slides: int
    slide_time: Block
    slids: int
    slid: Places
    slide_number: int
    """Of the combination in force, and of all so far."""
    slides_made: int
    slide_row: Places
    """What was written of the last one; `slide_length` numbers."""
    slide_length: int
    slide_next: Places
    rejected: int
    """Steps that were too long."""
    settling: bool
    """Whether an instant is being settled."""
    energy: float
    left: Floats
    warned: Warned


def make_report(e: Engine) -> Report:
    """Return an empty log."""
    r = Report()
    r.step_time = make_block(48)
    r.step_until = make_block(16)
    r.step_state = make_block(48 * e.states)
    r.step_dense = make_block(64 * e.states)
    r.step_place = make_places(16 * (2 + 2 * e.model.machines))
    r.bond_wide = 2 * e.model.bonds
    r.step_bonds = make_block(16)
    r.step_bond = make_places(16)
    r.step_energy = make_block(16)
    r.instant_time = make_block(16)
    r.instant_since = make_block(16)
    r.instant_state = make_block(16 * e.states)
    r.instant_place = make_places(16)
    r.visit = make_places(16)
    r.fired = make_places(16)
    r.hit = make_places(16)
    r.hit_area = make_block(16)
    r.visit_energy = make_block(16)
    r.read = make_block(16)
    r.over = make_places(16)
    r.open = make_places(16)
    r.slide_time = make_block(16)
    r.turn_time = make_block(4)
    r.slid = make_places(16)
    r.slide_row = make_places(16)
    r.slide_next = make_places(16)
    r.slide_length = 1
    r.settling = True
    r.left = floats(e.states)
    r.warned = e.warned if e.model.tells != 0 else make_warned()
    return r


def forget_rows(r: Report) -> None:
    """Forget the rows that were read; the next step begins with the last bond variables."""
    if r.bond_rows > 1:
        n = r.bond_wide
        for k in range(n):
            r.step_bonds.at[k] = r.step_bonds.at[(r.bond_rows - 1) * n + k]
        r.bond_rows = 1
    r.instants_before += r.instants
    r.steps = 0
    r.instants = 0
    r.visits = 0
    r.fireds = 0
    r.hits = 0
    r.reads = 0
    r.overs = 0
    r.opens = 0
    r.slids = 0
    r.slides = 0
    r.turns = 0
    forget_warned(r.warned)


def report_slide(e: Engine, r: Report) -> None:
    """Write down what is slid on from the present time on, if that is new."""
    next_one = r.slide_next
    length = put_slide(e, next_one)
    same = length == r.slide_length
    for k in range(length if same else 0):
        same = same and next_one.at[k] == r.slide_row.at[k]
    if same:
        return
    grow_block(r.slide_time, r.slides + 1)
    r.slide_time.at[r.slides] = e.t
    r.slides += 1
    r.slides_made += 1
    r.slide_number = r.slides_made if e.slide.many > 0 else 0
    grow_places(r.slid, r.slids + length)
    copy_places(length, next_one.at, 0, r.slid.at, r.slids)
    r.slids += length
    r.slide_next = r.slide_row
    r.slide_row = next_one
    r.slide_length = length


def put_slide(e: Engine, row: Places) -> int:
    """Put what is slid on there; return how many numbers that takes."""
    s = e.slide
    machines = e.model.machines
    grow_places(row, 4 + s.many + (1 + s.parts) * machines + e.model.ports)
    row.at[0] = s.many if s.k > 0 else 0
    if row.at[0] == 0:
        return 1
    row.at[1] = 1 if s.product else 0
    row.at[2] = s.parts
    at = 3
    for j in range(s.many):
        row.at[at] = s.surface[j]
        at += 1
    for part in range(-1, s.parts):
        for k in range(machines):
            row.at[at] = e.state[k] if part < 0 else part_mode(e, part).state[k]
            at += 1
    row.at[at] = e.model.ports
    at += 1
    for k in range(e.model.ports):
        row.at[at] = s.meant[k]
        at += 1
    return at


def report_step(e: Engine, r: Report) -> None:
    """Write down the step that ended at the present time."""
    s = e.step
    n = e.states
    r.rejected += s.rejected
    if e.model.method == MOREAU:
        write_bonds_of_step(e, r)
    if may_turn(e) and not is_propagated(e) and s.implicit != r.implicit:
        r.implicit = s.implicit
        grow_block(r.turn_time, r.turns + 1)
        r.turn_time.at[r.turns] = s.t0
        r.turns += 1
    if not by_radau(e) or e.curved:
        write_step(e, r, s.t0, s.t1, e.t)
        at = (r.steps - 1) * n
        for k in range(n):
            r.step_state.at[3 * at + k] = s.y0[k]
            r.step_state.at[3 * at + n + k] = s.y1[k]
            for p in range(TERMS):
                r.step_dense.at[TERMS * at + p * n + k] = s.dense[p * n + k]
        write_end(e, r, e.y)
        return
    # a step that was repeated may have fallen apart into several
    for piece in range(e.radau.pieces):
        if piece > 0 and e.radau.piece_t0[piece] >= e.t:
            return
        write_piece(e, r, piece)


def write_bonds_of_step(e: Engine, r: Report) -> None:
    """Write down bond variables and energies of a step; those at its beginning if they are new.

    What happens in it has the state at its beginning before it.
    """
    s = e.stepping
    r.energy = e.energy
    copy_floats(e.states, s.begin_y, r.left)
    if s.begins or r.bond_rows == 0:
        write_bond_row(r, s.begin_w)
    write_bond_row(r, s.w)
    grow_places(r.step_bond, r.steps + 1)
    grow_block(r.step_energy, 3 * (r.steps + 1))
    r.step_bond.at[r.steps] = r.bond_rows - 1
    r.step_energy.at[3 * r.steps] = s.supplied
    r.step_energy.at[3 * r.steps + 1] = s.dissipated
    r.step_energy.at[3 * r.steps + 2] = s.unbalanced


def write_bond_row(r: Report, w: Floats) -> None:
    """Write a row of bond variables."""
    n = r.bond_wide
    grow_block(r.step_bonds, n * (r.bond_rows + 1))
    copy_part(n, w, 0, r.step_bonds.at, n * r.bond_rows)
    r.bond_rows += 1


def write_piece(e: Engine, r: Report, piece: int) -> None:
    """Write down a step of Radau IIA, a part of the last one."""
    n = e.states
    a = e.radau
    last = piece + 1 == a.pieces or a.piece_t0[piece + 1] >= e.t
    write_step(e, r, a.piece_t0[piece], a.piece_t1[piece], e.t if last else a.piece_t1[piece])
    at = (r.steps - 1) * n
    for k in range(n):
        r.step_state.at[3 * at + k] = a.piece_y0[piece * n + k]
        r.step_state.at[3 * at + n + k] = a.piece_y1[piece * n + k]
        r.step_state.at[3 * at + 2 * n + k] = a.piece_y1[piece * n + k]
        for p in range(TERMS):
            r.step_dense.at[TERMS * at + p * n + k] = a.piece_polynomial[
                (TERMS * piece + p) * n + k
            ]
    if last:
        write_end(e, r, e.y)


def write_step(e: Engine, r: Report, t0: float, t1: float, t: float) -> None:
    """Begin a row of a step."""
    n = e.states
    machines = e.model.machines
    k = r.steps
    r.steps += 1
    grow_block(r.step_time, 3 * r.steps)
    grow_block(r.step_until, r.steps)
    grow_block(r.step_state, 3 * n * r.steps)
    grow_block(r.step_dense, TERMS * n * r.steps)
    grow_places(r.step_place, (2 + 2 * machines) * r.steps)
    r.step_time.at[3 * k] = t0
    r.step_time.at[3 * k + 1] = t1
    r.step_time.at[3 * k + 2] = t
    r.step_until.at[k] = e.next_break
    at = (2 + 2 * machines) * k
    r.step_place.at[at] = r.instants_before + r.instants
    r.step_place.at[at + 1] = r.slide_number
    for machine in range(machines):
        r.step_place.at[at + 2 + machine] = e.state[machine]
        r.step_place.at[at + 2 + machines + machine] = e.landed[machine]


def write_end(e: Engine, r: Report, y: Floats) -> None:
    """Write down the state at which the last step was ended."""
    n = e.states
    at = 3 * n * (r.steps - 1) + 2 * n
    copy_part(n, y, 0, r.step_state.at, at)


def report_end(e: Engine, r: Report) -> None:
    """Do nothing: the last step ends where the run does."""
    r.energy = e.energy


def keep_left(e: Engine, r: Report) -> None:
    """Keep the state at the left limit of what may be an event: there the last step was ended."""
    if r.steps > 0 and r.step_time.at[3 * r.steps - 1] == e.t:
        write_end(e, r, e.y)
    r.settling = True
    note_left(e, r)


def note_left(e: Engine, r: Report) -> None:
    """Note the present state as that before what happens next."""
    r.energy = e.energy
    copy_floats(e.states, e.y, r.left)


def report_event(e: Engine, r: Report, i: Instant) -> None:
    """Write down an instant at which something changed."""
    write_instant(e, r, i, i.cause)
    for step in range(i.steps):
        write_visit(r, i, step)
    # what a landing leaves is where it begins from, if another follows at once
    note_left(e, r)
    r.settling = False


def report_broken(e: Engine, r: Report, i: Instant) -> None:
    """Write down an instant at which a run was refused, as far as it was settled.

    Its cause is BROKEN more; the last mode visited is the one that was being tried.
    """
    if not r.settling:
        return
    r.settling = False
    if i.steps == 0 and i.waiting == 0:
        return
    if i.waiting > 0:
        note_step(i, MYTHICAL)
    write_instant(e, r, i, i.cause + BROKEN)
    for step in range(i.steps):
        write_visit(r, i, step)


def write_instant(e: Engine, r: Report, i: Instant, cause: int) -> None:
    """Write a row of an instant, but for the modes visited."""
    n = e.states
    machines = e.model.machines
    k = r.instants
    r.instants += 1
    grow_block(r.instant_time, 2 * r.instants)
    grow_block(r.instant_since, r.instants)
    grow_block(r.instant_state, 2 * n * r.instants)
    grow_places(r.instant_place, (3 + 2 * machines) * r.instants)
    r.instant_time.at[2 * k] = i.t
    r.instant_time.at[2 * k + 1] = r.energy
    r.instant_since.at[k] = i.since
    for j in range(n):
        r.instant_state.at[2 * n * k + j] = e.y[j] if i.cause == START else r.left[j]
        r.instant_state.at[2 * n * k + n + j] = e.y[j]
    at = (3 + 2 * machines) * k
    r.instant_place.at[at] = cause
    r.instant_place.at[at + 1] = i.steps
    r.instant_place.at[at + 2] = r.slide_number
    for machine in range(machines):
        r.instant_place.at[at + 3 + machine] = e.state[machine]
        r.instant_place.at[at + 3 + machines + machine] = e.landed[machine]


def write_visit(r: Report, i: Instant, step: int) -> None:
    """Write down a mode visited at an instant."""
    grow_places(r.visit, 5 * (r.visits + 1))
    grow_block(r.visit_energy, 3 * (r.visits + 1))
    at = 5 * r.visits
    r.visit.at[at] = i.kind.at[step]
    r.visit.at[at + 1] = i.first.at[step + 1] - i.first.at[step]
    r.visit.at[at + 2] = i.hit_first.at[step + 1] - i.hit_first.at[step]
    r.visit.at[at + 3] = i.open_first.at[step + 1] - i.open_first.at[step]
    r.visit.at[at + 4] = i.energies.at[step]
    for j in range(3):
        known = i.energies.at[step] != 0
        r.visit_energy.at[3 * r.visits + j] = i.energy.at[3 * step + j] if known else 0.0
    r.visits += 1
    for f in range(i.first.at[step], i.first.at[step + 1]):
        write_fired(r, i, f)
    for h in range(i.hit_first.at[step], i.hit_first.at[step + 1]):
        grow_places(r.hit, r.hits + 1)
        grow_block(r.hit_area, 2 * (r.hits + 1))
        r.hit.at[r.hits] = i.hit_bond.at[h]
        r.hit_area.at[2 * r.hits] = i.hit_area.at[h]
        r.hit_area.at[2 * r.hits + 1] = i.hit_floor.at[h]
        r.hits += 1
    for k in range(i.open_first.at[step], i.open_first.at[step + 1]):
        grow_places(r.open, r.opens + 1)
        r.open.at[r.opens] = i.open.at[k]
        r.opens += 1


def write_fired(r: Report, i: Instant, f: int) -> None:
    """Write down a transition, with what is told of it."""
    told = i.told
    row = i.reason.at[f]
    grow_places(r.fired, 6 * (r.fireds + 1))
    at = 6 * r.fireds
    r.fired.at[at] = i.machine.at[f]
    r.fired.at[at + 1] = i.source.at[f]
    r.fired.at[at + 2] = i.target.at[f]
    r.fired.at[at + 3] = told.why.at[row]
    r.fired.at[at + 4] = told.first.at[row + 1] - told.first.at[row]
    r.fired.at[at + 5] = told.over_first.at[row + 1] - told.over_first.at[row]
    r.fireds += 1
    for k in range(told.first.at[row], told.first.at[row + 1]):
        grow_block(r.read, 3 * (r.reads + 1))
        r.read.at[3 * r.reads] = told.finite.at[k]
        r.read.at[3 * r.reads + 1] = told.impulse.at[k]
        r.read.at[3 * r.reads + 2] = float(told.strikes.at[k])
        r.reads += 1
    for k in range(told.over_first.at[row], told.over_first.at[row + 1]):
        grow_places(r.over, r.overs + 1)
        r.over.at[r.overs] = told.over.at[k]
        r.overs += 1
