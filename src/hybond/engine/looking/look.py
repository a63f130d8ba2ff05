"""Values of a motion that is known already: at points of it, as long as its mode stays.

Who looks has an engine of his own, so that no run is disturbed, and says first into what he looks
(`look_into`): the interval, the states of machines, which of them have landed, which surfaces are
slid on. Then come points, all of them there: their states are put back on the constraints of the
mode, as a run does at the end of a step, unless they are accepted points, which are on them. In a
linear mode only what is asked for is evaluated, and of the state only what that reads.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import fit_places
from hybond.engine.algebra.products import copy_part, copy_places
from hybond.engine.contacts.landing import keep_still
from hybond.engine.contacts.rest import find_moved
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.inputs.interval import interval_after
from hybond.engine.jumps.jump import all_follow, on_constraints
from hybond.engine.looking.asked import Ask, ask_for_powers, make_ask, prepare, solve_asked
from hybond.engine.looking.led_back import lead_back, lead_between, ways_back
from hybond.engine.method_numbers import MOREAU
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.limits import put_limits
from hybond.engine.mode.mode_records import Mode, is_constrained
from hybond.engine.mode.nonlinear.agreement import check_agreement
from hybond.engine.mode.nonlinear.branch import forget_points, take_points
from hybond.engine.model import Model
from hybond.engine.surfaces.averages import solve_here
from hybond.engine.surfaces.branch_table import add_branches
from hybond.engine.surfaces.combine import combine_here
from hybond.engine.surfaces.jumps_near import note_jumps
from hybond.engine.surfaces.onto import onto_surfaces
from hybond.engine.surfaces.surface import part_mode
from hybond.engine.surfaces.values import evaluate, set_motion
from hybond.engine.words import Floats, Ints, floats, ints, record

LED_ON: Final = 0.125
"""Part of the way from where a step begins that is led on, at a time, from what is found there."""


@record
class Points:
    """Points of the motion: `many` of them.

    Either each has its state, a row of `y`, or, where `in_steps`, it lies in a step: `step` says in
    which, and `step_time`, `step_state`, `step_dense` are rows as in the log of a run.
    """

    many: int
    t: Floats
    y: Floats
    accepted: Ints
    """Of each with its state: whether that is on the constraints already."""
    in_steps: bool
    step: Ints
    step_time: Floats
    step_state: Floats
    step_dense: Floats


@record
class Look:
    """What looking into a motion keeps."""

    values: Ask
    meters: Ask
    """Bond variables through which power enters and leaves."""
    points: Points
    corrects: bool
    """Whether a state between accepted points has to be put back on anything."""
    held_known: bool
    y: Floats
    past: float
    """How far within a step a point lies behind its time, s: what rounding has taken off that."""
    vanishing: Ints
    """Of each slot: whether ``pre()`` of it is zero, at the limit of what has landed."""


def make_look(e: Engine) -> Look:
    """Return what looks into nothing yet."""
    m = e.model
    l = Look()
    l.values = make_ask(m)
    l.meters = make_ask(m)
    l.points = Points()
    l.y = floats(e.states)
    l.vanishing = ints(m.slots)
    ask_for_powers(m, l.meters)
    return l


def ask_for(l: Look, many: int, slot: Ints) -> None:
    """Ask for slots of the values; those behind the first copy are a priori values."""
    a = l.values
    same = many == a.many
    fit_places(a.slot, many)
    for k in range(many):
        same = same and a.slot.at[k] == slot[k]
        a.slot.at[k] = slot[k]
    a.many = many
    a.known = a.known and same


def look_into(
    e: Engine,
    l: Look,
    t: float,
    state: Ints,
    landed: Ints,
    surfaces: int,
    surface: Ints,
    product: int,
    rows: int,
    branch: Ints,
    energy: float,
) -> int:
    """Take the equations of a motion that begins at t.

    They are told by the states of machines, by which of these have landed, and by the surfaces slid
    on: whether all corners are combined, and, where junctions have laws, the states of machines in
    the modes around, `rows` of `branch`. `energy` is the largest that the run has seen, which
    rounding is measured by everywhere: a run keeps no more of it.
    """
    m = e.model
    g = e.landings
    e.t = t
    e.energy = energy
    for p in range(e.parts):
        e.part_energy[p] = energy
    e.energies_seen += 1.0
    interval_after(e, t)
    g.any_landed = False
    for k in range(m.machines):
        e.state[k] = state[k]
        e.landed[k] = landed[k]
        g.landed[k] = m.contact_at[m.state_first[k] + state[k]] if landed[k] != 0 else -1
        g.any_landed = g.any_landed or landed[k] != 0
    e.slide.many = surfaces
    e.slide.slid_product = product != 0
    e.slide.has_last = False
    copy_places(surfaces, surface, 0, e.slide.surface, 0)
    e.slide.branches = 0
    e.slide.given = rows > 0
    for row in range(rows if m.laws > 0 or m.followers > 0 else 0):
        copy_places(m.machines, branch, row * m.machines, e.slide.target, 0)
        add_branches(m, e.slide, e.slide.target)
    l.held_known = False
    l.values.known = False
    l.meters.known = False
    if mode_of(e, e.state) != OK or combine_here(e, e.state) != OK:
        return REFUSED
    # between the ends of steps of fixed length all is straight, and laws hold at ends only
    l.corrects = is_constrained(e.mode) or e.slide.k > 0 or g.any_landed
    l.corrects = l.corrects and m.method != MOREAU
    # what is found does not depend on what was looked into before
    e.mode.guessed = False
    forget_points(e.mode)
    for part in range(e.slide.parts if e.slide.k > 0 else 0):
        part_mode(e, part).guessed = False
    for k in range(2 * m.slots):
        e.v[k] = 0.0
        e.shown[k] = 0.0
    set_flags(m, e.mode, e.v)
    set_flags(m, e.mode, e.shown)
    put_limits(e, e.mode, e.v)
    put_limits(e, e.mode, e.shown)
    for k in range(m.slots):
        l.vanishing[k] = 0
    for k in range(m.priors):
        for i in range(m.prior_read[k], m.prior_read[k + 1]):
            if e.mode.prior_acts[k] != 0:
                l.vanishing[m.prior_slot[i]] = 1
    return OK


def look_from(e: Engine, many: int, wide: int, when: Floats, given: Floats) -> None:
    """Follow the solution that the motion had of laws with several, at so many points."""
    if wide == 2 * e.model.bonds and e.slide.k == 0:
        take_points(e, e.mode, many, when, given)


def set_flags(m: Model, mode: Mode, v: Floats) -> None:
    """Write the Booleans of a mode."""
    copy_part(m.switches + m.state_first[m.machines], mode.flags, 0, v, m.on_slot)


def points_at(l: Look, many: int, t: Floats, y: Floats, accepted: Ints) -> None:
    """Look at points with their states; `accepted` says which are on the constraints already."""
    p = l.points
    p.in_steps = False
    p.many = many
    p.t = t
    p.y = y
    p.accepted = accepted


def points_within(
    l: Look,
    many: int,
    t: Floats,
    step: Ints,
    step_time: Floats,
    step_state: Floats,
    step_dense: Floats,
) -> None:
    """Look at points within steps, each in the one that `step` says."""
    p = l.points
    p.in_steps = True
    p.many = many
    p.t = t
    p.step = step
    p.step_time = step_time
    p.step_state = step_state
    p.step_dense = step_dense


# -- one point


def take_point(e: Engine, l: Look, a: Ask, i: int, t: float) -> int:
    """Evaluate what is asked for at the time t, which is that of point i or in its step."""
    if l.points.in_steps:
        accepted = take_from_step(e, l, a, l.points.step[i], t)
    else:
        for p in range(a.parts):
            l.y[a.part[p]] = l.points.y[i * e.states + a.part[p]]
        accepted = l.points.accepted[i] != 0
    e.t = t
    if a.sparse:
        if l.corrects and not accepted and correct(e, l, t) != OK:
            return REFUSED
        solve_asked(e, a, t, l.y)
        return OK
    found = solve_point(e, l, t, accepted)
    if found != OK and l.points.in_steps and l.corrects and not accepted:
        found = from_between(e, l, a, i, t)
    way = 0
    ways = ways_back(e) if l.points.in_steps and e.model.edges > 0 and not accepted else 0
    while found != OK and way < ways:
        step = l.points.step[i]
        take_from_step(e, l, a, step, t)
        lead_back(e, way, part_of_step(l, step, t), l.points.step_state, 3 * e.states * step, l.y)
        found = solve_point(e, l, t, accepted)
        way += 1
    return from_its_end(e, l, a, i, t) if found != OK and l.points.in_steps else found


def from_between(e: Engine, l: Look, a: Ask, i: int, t: float) -> int:
    """Evaluate it from between the ends of its step, where constraints hold what they move."""
    step = l.points.step[i]
    end = l.points.step_time[3 * step + 2]
    take_from_step(e, l, a, step, end)
    if e.slide.k > 0 or evaluate(e, e.mode, e.shown, end, l.y) != OK:
        return REFUSED
    if not all_follow(e, e.mode, e.shown, l.y):
        return REFUSED
    take_from_step(e, l, a, step, t)
    lead_between(e, e.mode.ways, l.points.step_state, 3 * e.states * step, l.y)
    return solve_point(e, l, t, False)


def from_its_end(e: Engine, l: Look, a: Ask, i: int, t: float) -> int:
    """Evaluate it from what laws say at the end of its step, led on towards its beginning.

    From nothing Newton's method may not find what is next to nothing, where laws are flat, or
    steep, as just behind the instant at which a source passes zero; nor from what is far larger.
    """
    step = l.points.step[i]
    begin = l.points.step_time[3 * step]
    at = l.points.step_time[3 * step + 2]
    e.mode.guessed = False
    accepted = take_from_step(e, l, a, step, at)
    e.t = at
    found = solve_point(e, l, at, accepted)
    while found == OK and at > t:
        nearer = begin + LED_ON * (at - begin)
        at = nearer if nearer > t and nearer < at else t
        accepted = take_from_step(e, l, a, step, at)
        e.t = at
        found = solve_point(e, l, at, accepted)
    return found


def solve_point(e: Engine, l: Look, t: float, accepted: bool) -> int:
    """Find all values with the state in `l.y`, put back on what holds it if need be."""
    if l.corrects and not accepted and correct(e, l, t) != OK:
        return REFUSED
    set_motion(e, e.v, t, l.y)
    return OK if solve_here(e, e.mode, e.v) == OK else REFUSED


def part_of_step(l: Look, step: int, t: float) -> float:
    """Return which part of a step is over at a time within it."""
    p = l.points
    t0 = p.step_time[3 * step]
    return ((t - t0) + l.past) / (p.step_time[3 * step + 1] - t0)


def take_from_step(e: Engine, l: Look, a: Ask, step: int, t: float) -> bool:
    """Put the state within a step into `l.y`; return whether it is at an end that was accepted."""
    n = e.states
    p = l.points
    t0 = p.step_time[3 * step]
    at = 3 * n * step
    if l.past == 0.0 and (t == t0 or t == p.step_time[3 * step + 2]):
        at += 0 if t == t0 else 2 * n
        for i in range(a.parts):
            k = a.part[i]
            l.y[k] = p.step_state[at + k]
        return True
    dense = 4 * n * step
    x = part_of_step(l, step, t)
    x2 = x * x
    x3 = x2 * x
    x4 = x3 * x
    for i in range(a.parts):
        k = a.part[i]
        l.y[k] = p.step_state[at + k] + (
            x * p.step_dense[dense + k]
            + x2 * p.step_dense[dense + n + k]
            + x3 * p.step_dense[dense + 2 * n + k]
            + x4 * p.step_dense[dense + 3 * n + k]
        )
    return False


def correct(e: Engine, l: Look, t: float) -> int:
    """Put the state in `l.y` back on what holds it: constraints, surfaces, contacts at rest."""
    mode = e.mode
    if is_constrained(mode):
        if mode.dynamics == 0 and e.slide.k == 0:
            # constraints of a linear mode read no bond variables
            set_motion(e, e.shown, t, l.y)
        elif evaluate(e, mode, e.shown, t, l.y) != OK:
            return REFUSED
        # a run ends at a contradiction, or an instant behind where sources begin to: none holds it
        apart = mode.agreements.rows > 0 and check_agreement(e, mode, e.shown) != OK
        if not apart and on_constraints(e, mode, e.shown, l.y) != OK:
            return REFUSED
    # where a surface just jumps, the motion was still where it was led
    if e.slide.k > 0 and not note_jumps(e, t, l.y) and onto_surfaces(e, t, l.y) != OK:
        return REFUSED
    if e.landings.any_landed:
        if not l.held_known:
            set_motion(e, e.v, t, l.y)
            if solve_here(e, mode, e.v) != OK:
                return REFUSED
            find_moved(e, e.landings.held)
            l.held_known = True
        keep_still(e, l.y)
    return OK


# -- all points


def look_values(e: Engine, l: Look, out: Floats) -> int:
    """Put what is asked for there, a row for each point."""
    a = l.values
    prepare(e, a, l.corrects)
    for i in range(l.points.many):
        if take_point(e, l, a, i, l.points.t[i]) != OK:
            return REFUSED
        put_asked(e, l, out, i * a.many)
    return OK


def put_asked(e: Engine, l: Look, out: Floats, at: int) -> None:
    """Put the slots that are asked for there, from `at` on."""
    a = l.values
    n = e.model.slots
    for j in range(a.many):
        slot = a.slot.at[j]
        if slot < n:
            out[at + j] = e.v[slot]
        else:
            out[at + j] = 0.0 if l.vanishing[slot - n] != 0 else e.v[slot - n]


def look_parts(e: Engine, l: Look, coefficient: Floats, out: Floats) -> int:
    """Put what is asked for there in each mode that is combined, and the share of that mode.

    A row for each part of each point; where nothing is slid on there is one, the mode.
    """
    m = e.model
    s = e.slide
    a = l.values
    parts = s.parts
    prepare(e, a, l.corrects)
    for i in range(l.points.many):
        if take_point(e, l, a, i, l.points.t[i]) != OK:
            return REFUSED
        for part in range(parts):
            at = i * parts + part
            coefficient[at] = s.coefficient[part] if s.k > 0 else 1.0
            if s.k > 0:
                set_flags(m, part_mode(e, part), e.v)
                copy_part(2 * m.bonds, s.solution, part * 2 * m.bonds, e.v, m.bond_slot)
            put_asked(e, l, out, at * a.many)
        set_flags(m, e.mode, e.v)
    return OK


def parts_of(e: Engine, state: Ints) -> int:
    """Put the states of machines in each mode that is combined there; return how many they are."""
    m = e.model
    parts = e.slide.parts
    for part in range(parts):
        for k in range(m.machines):
            state[part * m.machines + k] = (
                part_mode(e, part).state[k] if e.slide.k > 0 else e.state[k]
            )
    return parts
