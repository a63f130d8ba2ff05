"""What a run hands to one that goes on from where it ended: the state, and what it remembers.

One walk writes the numbers down and reads them back, so that the two cannot differ. First comes
what any run can begin with: time, state, mode, what has landed, surfaces slid on. Then what this
run has seen and thresholds are measured by: sizes, impacts, the size of steps. What can be found
anew from these, as equations of modes, is found anew.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.blocks import (
    Block,
    Places,
    grow_block,
    grow_places,
    make_block,
    make_places,
)
from hybond.engine.contacts.landing_records import CROWD, LAST_TIMES
from hybond.engine.contacts.rest import find_moved
from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.course_records import many_kept
from hybond.engine.inputs.interval import is_due
from hybond.engine.instant.instant import CHANGE, SAMPLE, START, TIME
from hybond.engine.jumps.trial import a_priori
from hybond.engine.laws.branches import choose_at
from hybond.engine.method_numbers import MOREAU
from hybond.engine.methods.implicit.from_edges import may_turn
from hybond.engine.methods.implicit.stiffness import turn
from hybond.engine.methods.stepping import by_radau
from hybond.engine.mode.mode_records import PACES
from hybond.engine.run.courses_kept import give_back_courses
from hybond.engine.run.run_records import FRESH, GIVEN, GOES_ON, Run
from hybond.engine.sliding.what_happened import is_held
from hybond.engine.surfaces.branch_table import UNKNOWN, add_branches
from hybond.engine.surfaces.corners import most_combined
from hybond.engine.surfaces.surface import part_mode
from hybond.engine.words import Floats, Ints, record


@record
class Carrier:
    """Numbers on their way: into a run with `puts`, else out of it; and how many went."""

    puts: bool
    floats: int
    number: Block
    ints: int
    place: Places


def make_carrier(e: Engine) -> Carrier:
    """Return one that has nothing."""
    c = Carrier()
    c.number = make_block(e.states + 1)
    c.place = make_places(e.model.machines + 1)
    return c


def carry_number(c: Carrier, given: float) -> float:
    """Carry a number; return what it is then: the one that came, on the way into a run."""
    grow_block(c.number, c.floats + 1)
    if not c.puts:
        c.number.at[c.floats] = given
    c.floats += 1
    return c.number.at[c.floats - 1]


def carry_whole(c: Carrier, given: int) -> int:
    """Carry a whole number; return what it is then."""
    grow_places(c.place, c.ints + 1)
    if not c.puts:
        c.place.at[c.ints] = given
    c.ints += 1
    return c.place.at[c.ints - 1]


def carry_truth(c: Carrier, given: bool) -> bool:
    """Carry a truth; return what it is then."""
    return carry_whole(c, 1 if given else 0) != 0


def carry_floats(c: Carrier, n: int, row: Floats) -> None:
    """Carry a row of numbers."""
    carry_copy(c, n, row, row)


def carry_copy(c: Carrier, n: int, given: Floats, taken: Floats) -> None:
    """Carry a row of numbers that stands elsewhere on the way in than on the way out."""
    grow_block(c.number, c.floats + n)
    for k in range(n):
        if c.puts:
            taken[k] = c.number.at[c.floats + k]
        else:
            c.number.at[c.floats + k] = given[k]
    c.floats += n


def carry_ints(c: Carrier, n: int, row: Ints) -> None:
    """Carry a row of whole numbers."""
    grow_places(c.place, c.ints + n)
    for k in range(n):
        if c.puts:
            row[k] = c.place.at[c.ints + k]
        else:
            c.place.at[c.ints + k] = row[k]
    c.ints += n


def machines_carried(e: Engine) -> int:
    """Return how many machines there are beside the last one, if it is there to end the run."""
    return e.model.ends if e.model.ends >= 0 else e.model.machines


def carry_state(e: Engine, c: Carrier) -> None:
    """Carry what any run can begin with."""
    s = e.slide
    e.t = carry_number(c, e.t)
    carry_floats(c, e.states, e.y)
    if e.model.curved > 0:
        # what no storage feels is known only from where it was
        e.root_known = carry_number(c, e.root_known)
        carry_floats(c, 2 * e.model.bonds, e.root_now)
        carry_floats(c, 2 * e.model.bonds, e.root_before)
        e.root_given = c.puts and e.root_known != 0.0
        f = e.work.following
        f.spent = carry_number(c, f.spent)
        for k in range(2):
            asked = carry_number(c, float(f.asked.at[k]))
            f.asked.at[k] = int(asked)
            due = carry_number(c, float(f.due.at[k]))
            f.due.at[k] = int(due)
    carry_ints(c, machines_carried(e), e.state)
    carry_ints(c, machines_carried(e), e.landings.landed)
    if c.puts:
        s.many = 0
    for k in range(e.model.surfaces):
        if carry_truth(c, is_held(e, k)) and c.puts:
            s.surface[s.many] = k
            s.many += 1
    s.slid_product = carry_truth(c, s.slid_product)
    carry_branches(e, c)


def carry_branches(e: Engine, c: Carrier) -> None:
    """Carry the modes that are combined: which branches laws have in them was decided before.

    A one-way clutch that has just let go on the mean would be closed again in the state alone.
    """
    m = e.model
    s = e.slide
    parts = s.parts if s.many > 0 and s.k > 0 and not c.puts else 0
    if c.puts:
        s.branches = 0
    for part in range(most_combined(m.laws, m.surfaces)):
        known = True
        for k in range(m.machines):
            s.target[k] = e.state[k]
        for k in range(machines_carried(e)):
            now = part_mode(e, part).state[k] if part < parts else UNKNOWN
            s.target[k] = carry_whole(c, now)
            known = known and s.target[k] != UNKNOWN
        if c.puts and known:
            add_branches(m, s, s.target)
    for k in range(m.ports if most_combined(m.laws, m.surfaces) > 0 else 0):
        meant = carry_whole(c, s.meant[k] if parts > 0 else 0)
        s.meant[k] = meant if c.puts else s.meant[k]


def carry_memory(e: Engine, r: Run, c: Carrier) -> None:
    """Carry what the run has seen."""
    m = e.model
    g = e.landings
    many = machines_carried(e)
    carry_floats(c, e.states, e.largest_state)
    carry_floats(c, 5 * (e.states + m.storages + 1), e.lately)
    carry_floats(c, m.integrals, e.rate_rounding)
    carry_floats(c, m.integrals, e.least_signal)
    carry_floats(c, (m.storages + 1) * m.impulse_kinds, e.largest)
    carry_floats(c, m.classes, e.checks.largest)
    carry_floats(c, m.classes, e.checks.lasting)
    if m.laws > 0:
        carry_floats(c, m.ports, e.laws.largest)
        carry_floats(c, m.ports, e.laws.largest_limit)
        carry_floats(c, m.ports, e.laws.gap_before)
    carry_floats(c, LAST_TIMES * many, g.times)
    carry_floats(c, LAST_TIMES * many, g.others)
    carry_floats(c, many, g.since)
    carry_floats(c, many, g.speed)
    carry_floats(c, many, g.flight)
    carry_floats(c, CROWD, g.event_times)
    carry_floats(c, m.disks, e.planar.largest)
    carry_floats(c, m.disks, e.planar.ever)
    carry_ints(c, many, g.kept)
    carry_ints(c, many, g.count)
    carry_ints(c, many, g.known)
    carry_ints(c, many, g.other_kept)
    carry_ints(c, m.reactions, g.sign)
    carry_ints(c, m.storages, g.held)
    e.energy = carry_number(c, e.energy)
    e.parts = carry_whole(c, e.parts)
    carry_ints(c, m.storages, e.storage_part)
    # all there may be: how many parts there are depends on where the run is
    carry_rounding(e, c)
    carry_floats(c, m.storages + 1, e.part_energy)
    carry_floats(c, m.storages + 1, e.scale_energy)
    carry_floats(c, m.storages + 1, e.pushed_energy)
    e.energies_seen += 1.0
    e.checks.size = carry_number(c, e.checks.size)
    e.checks.moved = carry_number(c, e.checks.moved)
    e.checks.unbalanced = carry_number(c, e.checks.unbalanced)
    e.checks.may = carry_number(c, e.checks.may)
    e.checks.apart = carry_number(c, e.checks.apart)
    e.checks.brought = carry_number(c, e.checks.brought)
    e.sampled_at = carry_number(c, e.sampled_at)
    e.awaited_at = carry_number(c, e.awaited_at)
    carry_floats(c, m.integrals, e.awaited)
    carry_floats(c, e.states, e.rests.began)
    e.rests.began_at = carry_number(c, e.rests.began_at)
    e.rests.begun = carry_truth(c, e.rests.begun)
    e.rests.taken = c.puts and e.rests.begun
    e.rests.any = carry_truth(c, e.rests.any)
    carry_ints(c, m.rule_first[many], e.rests.rule)
    carry_ints(c, m.rule_first[many], e.rests.since)
    carry_floats(c, m.rule_first[many], e.rests.within)
    e.rests.some_stand = carry_truth(c, e.rests.some_stand)
    for a in range(m.atom_first[m.rule_first[many]]):
        which = m.atom_value[a]
        e.rests.crossed[which] = carry_number(c, e.rests.crossed[which])
        e.rests.crossed_at[which] = carry_number(c, e.rests.crossed_at[which])
    e.rests.some_crossed = carry_truth(c, e.rests.some_crossed)
    for k in range(m.rule_first[many]):
        e.rests.waits_until[k] = carry_number(c, e.rests.waits_until[k])
    e.rests.some_wait = carry_truth(c, e.rests.some_wait)
    atoms = m.atom_first[m.rule_first[many]]
    carry_floats(c, atoms, e.rests.stands_on)
    carry_ints(c, atoms, e.rests.atom)
    carry_floats(c, atoms, e.rests.band)
    carry_ints(c, atoms, e.rests.side)
    carry_ints(c, atoms, e.rests.turns)
    carry_ints(c, atoms, e.rests.away)
    carry_floats(c, atoms, e.rests.last)
    carry_floats(c, atoms, e.rests.older)
    carry_ints(c, atoms, e.rests.creeps)
    e.rests.some = carry_truth(c, e.rests.some)
    carry_floats(c, m.integrals, e.sample_terms)
    carry_standing(e, c)
    g.events = carry_whole(c, g.events)
    carry_step(e, r, c)


def carry_rounding(e: Engine, c: Carrier) -> None:
    """Carry what rounding is measured by in the motion that goes on."""
    m = e.model
    carry_floats(c, m.storages, e.remembered)
    carry_floats(c, m.storages, e.remembered_before)
    if m.laws > 0:
        carry_floats(c, 2 * m.bonds, e.seen_before)
        carry_floats(c, m.storages, e.fades_before)
        rules = m.rule_first[machines_carried(e)]
        carry_floats(c, rules, e.checks.carried)
        carry_floats(c, rules, e.checks.borne)
        carry_floats(c, rules, e.checks.most_borne)


def carry_standing(e: Engine, c: Carrier) -> None:
    """Carry what stands: it was found where the motion began that goes on."""
    x = e.standing
    x.some = carry_truth(c, x.some)
    carry_ints(c, e.model.storages, x.stands)
    for k in range(e.model.storages if not x.some else 0):
        x.stands[k] = 0
    x.goes_on = c.puts


def carry_step(e: Engine, r: Run, c: Carrier) -> None:
    """Carry the step that the end of the run has cut short, if it was one, and how it began."""
    s = e.step
    r.warm_t = carry_number(c, s.t0)
    r.warm_h = carry_number(c, s.h_asked)
    r.warm_error = carry_number(c, s.error_asked)
    r.warm_grid = carry_number(c, s.grid)
    r.warm_next = carry_number(c, s.grid_asked)
    # by another method, or with other steps, it would not be the same one
    same = carry_number(c, float(e.model.method)) == float(e.model.method)
    same = carry_number(c, e.model.step) == e.model.step and same
    sound = r.warm_h > 0.0 or r.warm_next > 0.0
    sound = sound and r.warm_t < e.t and r.warm_h < math.inf and r.warm_next < math.inf
    cut = carry_truth(c, r.cut)
    # behind an event at the end of a run another motion begins
    e.standing.goes_on = e.standing.goes_on and cut
    r.warm = c.puts and same and sound and cut
    r.warm_implicit = carry_truth(c, s.implicit)
    s.bound = carry_whole(c, s.bound)
    s.free = carry_whole(c, s.free)
    s.long_bound = carry_whole(c, s.long_bound)
    s.long_free = carry_whole(c, s.long_free)
    s.looked = carry_whole(c, s.looked)
    carry_floats(c, e.states, s.looked_at)
    carry_floats(c, PACES, s.pace)
    s.began = carry_number(c, s.began)
    carry_copy(c, e.states, s.y0, r.warm_y)
    carry_copy(c, e.model.storages, e.rounding, r.warm_rounding)
    if e.model.courses > 0:
        carry_floats(c, many_kept(e.model), e.courses.memory)


def take_out(e: Engine, r: Run, c: Carrier) -> None:
    """Write down where a run has come, with all that it remembers."""
    c.puts = False
    c.floats = 0
    c.ints = 0
    carry_state(e, c)
    carry_memory(e, r, c)


def take_over(e: Engine, r: Run, c: Carrier, way: int, until: float, deep: bool) -> None:
    """Let a run that has not begun begin with these numbers, the memory of another with `deep`."""
    e.until = until
    e.stop = until
    e.span = e.model.span
    r.way = way
    c.puts = True
    c.floats = 0
    c.ints = 0
    for k in range(e.model.machines):
        e.state[k] = e.model.start[k]
    carry_state(e, c)
    if deep:
        carry_memory(e, r, c)
    elif way != GIVEN:
        # within the run before, what happens there is over
        e.sampled_at = e.t
    if way != GOES_ON:
        e.awaited_at = -math.inf
    r.remembers = deep
    r.resumed = e.t


def cause_of_beginning(e: Engine, r: Run) -> int:
    """Return what the first instant of a run is."""
    m = e.model
    if r.way == FRESH or r.way == GIVEN:
        return START
    if r.way != GOES_ON:
        return CHANGE
    for k in range(m.samples):
        if is_due(m, k, e.t):
            return SAMPLE
    return TIME


def take_up(e: Engine, r: Run) -> int:
    """Know again what is at rest, and how the method went on, before a first instant is settled."""
    m = e.model
    g = e.landings
    if m.slides == 0:
        e.slide.many = 0
    if e.slide.many > 0:
        for k in range(m.integrals):
            g.s[k] = e.y[m.storages + k]
        choose_at(e, e.y, g.s)
    for k in range(m.machines):
        e.landed[k] = 1 if g.landed[k] >= 0 else 0
        g.any_landed = g.any_landed or g.landed[k] >= 0
    if may_turn(e) and r.warm_implicit != e.step.implicit:
        turn(e)
    if not g.any_landed or r.remembers:
        return OK
    for k in range(m.storages):
        g.x[k] = e.y[k]
    for k in range(m.integrals):
        g.s[k] = e.y[m.storages + k]
    found = a_priori(e, e.t, g.x, g.s, e.state)
    if found != OK:
        return found
    for k in range(m.machines):
        know_signs(e, g.landed[k])
    find_moved(e, g.held)
    return OK


def know_signs(e: Engine, contact: int) -> None:
    """Find the signs of the reactions of a contact at rest: those of what it carries."""
    m = e.model
    if contact < 0:
        return
    for j in range(m.reaction_first[contact], m.reaction_first[contact + 1]):
        force = e.pre[m.bond_slot + m.reaction_column[j]]
        e.landings.sign[j] = 0 if force == 0.0 else (1 if force > 0.0 else -1)


def begin_again(e: Engine, r: Run) -> bool:
    """Go back to where the step began that the end of the run before has cut short, if one was."""
    if not r.warm or r.way != GOES_ON or by_radau(e) or e.model.method >= MOREAU:
        r.warm = False
        return False
    e.t = r.warm_t
    for k in range(e.states):
        e.y[k] = r.warm_y[k]
    return True


def warm_up(e: Engine, r: Run) -> None:
    """Let the step be what it would have been if the end of the run had not cut it short."""
    r.warm = False
    e.step.h = r.warm_h
    e.step.error_before = r.warm_error
    e.step.grid = r.warm_grid
    e.step.grid_next = r.warm_next
    for k in range(e.model.storages):
        e.rounding[k] = r.warm_rounding[k]
        e.remembered[k] = e.remembered_before[k]
    if e.model.courses > 0:
        give_back_courses(e.model, e.courses)
