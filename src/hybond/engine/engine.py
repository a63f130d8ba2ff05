"""What a run works with: the model, its modes, the state, and room for the work."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import Block, make_block
from hybond.engine.algebra.svd import Svd, make_svd
from hybond.engine.checks.check_records import Checks, make_checks
from hybond.engine.contacts.landing_records import Landings, make_landings
from hybond.engine.expressions.course_records import Courses, make_courses
from hybond.engine.guards.rest_records import Rests, make_rests
from hybond.engine.guards.timetable_records import Timetable, make_timetable
from hybond.engine.inputs.calls import Calls, call_outside, make_calls
from hybond.engine.laws.law_records import OPEN_KEPT, Laws, make_laws
from hybond.engine.method_numbers import AUTO, EXACT, MOREAU, QSS1, RADAU
from hybond.engine.methods.explicit.step_room import Step, make_step
from hybond.engine.methods.implicit.radau_room import Radau, make_radau
from hybond.engine.methods.linear.flow_records import Exact, make_exact
from hybond.engine.methods.quantised.qss_room import Quantised, make_quantised
from hybond.engine.mode.comparisons.standing_records import Standing, make_standing
from hybond.engine.mode.comparisons.sum_records import Sums, make_sums
from hybond.engine.mode.mode_records import Mode
from hybond.engine.model import Model
from hybond.engine.planar.planar_records import Planar, make_planar
from hybond.engine.reasons.warned import Warned, make_warned
from hybond.engine.surfaces.slide_records import Slide, make_slide
from hybond.engine.timestepping.step_records import Stepping, make_stepping
from hybond.engine.words import Floats, Ints, Records, Text, floats, ints, record, records
from hybond.engine.work import Work, make_work

OK: Final = 0
REFUSED: Final = 1
NOT_FINITE: Final = 2
"""A trial point beyond where the laws hold: the step is shortened."""
NO_MODE: Final = -1
BUCKETS: Final = 4093
"""Of configurations, to find the modes that are kept."""
FIRST_PLACES: Final = 64
"""For modes that are kept; there are more when they are needed."""
NOT_ASKED: Final = 2
"""No sign of a slope is known yet."""
LOOKED_ON: Final = 20_000
"""Work after which whoever is outside may look on: milliseconds in C, a fifth of a second as
Python."""
NO_PIECE: Final = -2147483647
"""No number of a piece of an input."""


@record
class Fault:
    """Why a run stopped: an error code, the reason, and when."""

    code: Text
    why: Text
    place: Text
    t: float
    many: int
    about: Block
    """What is known of it, `many` numbers, for whoever puts it into words: see `facts`."""


@record
class Trial:
    """A mode being tried: its jump, and the signals that follow, which stand in `v` of the run."""

    state: Ints
    x: Floats
    s: Floats
    xi: Floats
    """What the bond variables were found from."""
    jumps: bool
    """Whether impulses move what is stored."""
    energy_before: float
    """What is stored before the jump and after it, J."""
    energy_after: float
    energy_struck: float
    """What is stored behind the impulses, before rounding of it is swept up."""
    jump: Floats
    """The impulse of each signal: zero unless it `jumps`."""
    terms: Floats
    """The size of the terms that made each signal that a guard asked for."""
    prior_terms: Floats
    """Of what it was before, ..."""
    prior_turn: Ints
    turn: int
    """... since that turn; each time that what ``pre()`` reads becomes another, one begins."""
    valueless: bool
    """Whether its laws had no common solution."""
    loose: int
    """In how many directions bond variables are undetermined."""
    freedom: Block
    was_loose: int
    """In how many directions bond variables were before, as ``pre()`` reads them."""
    was_freedom: Block
    settled_at: float
    """The instant that was the last to settle."""
    rates: Floats
    """How fast integrated signals change in the trial, to find how they are free."""
    kept_signals: Floats
    """Integrated signals before they are moved: three numbers of each."""
    ways: Block
    """The ways in which integrated signals are free: each has a number for each of them."""
    dusted: bool
    """Whether rounding was swept out of what is stored."""
    factors: int
    factor: Block
    """What multiplies impulses in laws declared impulsive, before the jump."""
    struck: bool
    through: Ints
    """The branches of junction laws that carried the impulses, if `struck` and others last."""


@record
class Engine:
    """One run."""

    model: Model
    fault: Fault
    warned: Warned
    checks: Checks
    unrest: Fault
    """Why a structure at rest had no solution, the last time."""
    modes: Records[Mode]
    modes_kept: int
    """Of how many there is room."""
    modes_made: int
    modes_used: Ints
    """When each was used last, by `clock`."""
    modes_together: int
    """How many there must be room for whatever they take, besides those of an instant."""
    modes_size: float
    """Numbers that each took, when they were counted."""
    modes_counted: int
    """When they are counted again, by `modes_built`."""
    bucket: Ints
    """The first mode kept in each bucket of configurations, or NO_MODE."""
    clock: int
    work: Work
    v: Floats
    """Values: of the trial, or of the motion."""
    shown: Floats
    """Values at a point of the motion, where it is looked at."""
    pre: Floats
    """What ``pre()`` reads at an instant."""
    mode: Mode
    mode_at: int
    """Where it stands in `modes`."""
    trial: Trial
    step: Step
    slide: Slide
    rounding: Floats
    """What the rates of stored quantities may be wrong by, in the time of the run: ..."""
    rate_noise: Floats
    """... the rates themselves, ..."""
    noise_matters: bool
    """Whether a tolerance was set by that since it was measured last; when that was."""
    noise_at: float
    settled: Floats
    """... and what is left of that where they lead a state back to where it settles."""
    push_alone: Floats
    """What pushes of sources, and of what laws leave free, would store in a moment."""
    moved_rounding: Floats
    """What they may be wrong by in that time a moment after motion starts, of those that rates of
    zero say nothing of."""
    rate_rest: Floats
    """By what the rates of the state that were found last are more than they were rounded to, where
    the mode is summed closely."""
    rate_rounding: Floats
    """What rates of integrated signals may be wrong by, where that matters, ..."""
    least_signal: Floats
    sample_terms: Floats
    """Of each signal that is sampled: the size of the terms that it was made of."""
    """... and what each of these signals is measured by at the least."""
    largest_state: Floats
    scale_energy: Floats
    """The largest energy there ever was on each part, or that what pushes would give in a moment.
    """
    pushed_energy: Floats
    lately: Floats
    """The size that each state has lately had, the roots of energies of parts behind them; what
    it comes from, `methods/tolerances/lately`."""
    state: Ints
    """Of each machine, now."""
    t: float
    y: Floats
    states: int
    until: float
    span: float
    """What thresholds of time are parts of, s: the same for runs that go on from one another."""
    stop: float
    """Where this stretch of the run ends: at `until`, unless somebody drives it in pieces."""
    sampled_at: float
    awaited: Floats
    """What was sampled at the end of the run, for one that goes on from there; and when that is."""
    awaited_at: float
    samples_end: float
    """From when on nothing is sampled any more: the end of a run shows what leads up to it."""
    calls: Calls
    level: Floats
    asked: Floats
    """Of inputs that are set from outside: their levels, and those from the next instant on."""
    energy: float
    """The largest energy that the run has seen, J."""
    parts: int
    storage_part: Ints
    """Of each storage: the part of the graph that it hangs together with, as time last passed."""
    remembered: Floats
    """What each storage held that its rounding is still measured by; see `mode/digits/fading`."""
    remembered_before: Floats
    """The same where the last step began."""
    slope_known: Ints
    """Of each slope of laws: the sign that it was found to keep, see `mode/nonlinear/one_root`."""
    root_known: float
    """Whether a solution of laws with several is handed on: 1, else 0; ..."""
    root_given: bool
    """... and whether one was, to a run that has not begun to move."""
    roots_kept: float
    """How many solutions were kept as those where the motion is."""
    root_now: Floats
    root_before: Floats
    """Its bond variables where the motion is, and where the last step began."""
    seen_before: Floats
    fades_before: Floats
    """What was `seen` in the mode of a run that goes on, and what it faded to."""
    part_energy: Floats
    """The largest energy of each part, J: what rounding there is measured by."""
    instants: float
    """How often states were to be settled."""
    energies_seen: float
    """How often these have become others."""
    courses: Courses
    longest: float
    """How long a step may be in the mode, for sines of time alone, s."""
    next_break: float
    late: float
    """Time is not read before it, nor behind the next: where what depends on time alone jumps at an
    end of the interval."""
    early: float
    within_from: float
    """The interval for which these were found last, in whose pieces of inputs time still is; how
    many jumps were asked for at its end; what was found."""
    within_to: float
    within_many: int
    within_late: float
    within_early: float
    piece: Ints
    line_piece: Ints
    """Of each input: the piece whose line is known: its value, its rate, and where it begins."""
    line_value: Floats
    line_rate: Floats
    line_begin: Floats
    at: Ints
    """Of the present interval: pieces of inputs, comparisons of time, and its end."""
    evaluations: int
    refusal: bool
    """Whether a law had no value at a trial point since it was last asked."""
    modes_built: int
    landed: Ints
    """Machines that stay in their pinnacle state."""
    key: Ints
    given: Ints
    impulses: Floats
    """Of bond variables, in the last jump."""
    largest: Floats
    floor: Floats
    """Below it the impulse of a bond variable counts as zero."""
    moved: int
    """What the last entry into a mode did."""
    laws: Laws
    open_modes: Records[Mode]
    """Equations with the laws of junctions left open."""
    radau: Radau
    exact: Exact
    quantised: Quantised
    landings: Landings
    planar: Planar
    rests: Rests
    timetable: Timetable
    stepping: Stepping
    rates: Sums
    """The rates of the state in the motion, if they are `straight`: sums of the state, all."""
    straight: bool
    standing: Standing
    curved: bool  # whether the last step is one of a descent: a cubic, whatever the method


def say_fault(e: Engine, code: Text, why: Text, place: Text) -> int:
    """Note why the run stops; return REFUSED."""
    e.fault.code = code
    e.fault.why = why
    e.fault.place = place
    e.fault.t = e.t
    if e.model.tells != 0:
        e.fault.many = 0
    return REFUSED


def count_work(e: Engine, many: int) -> None:
    """Count work within a step or an instant; after some of it, whoever is outside looks on.

    What solves laws of one instant may take longer than anybody waits for an answer to Ctrl-C.
    """
    if e.model.tells != 0:
        e.calls.work += many
        if e.calls.work >= LOOKED_ON:
            e.calls.work = 0
            call_outside(e.calls)


def make_trial(m: Model) -> Trial:
    """Return room for a trial."""
    trial = Trial()
    trial.state = ints(m.machines)
    trial.x = floats(m.storages)
    trial.s = floats(m.integrals)
    trial.xi = floats(m.storages + 2 * m.most_sources)
    trial.jump = floats(m.slots)
    trial.terms = floats(m.slots)
    trial.prior_terms = floats(m.slots)
    trial.prior_turn = ints(m.slots)
    trial.freedom = make_block(1)
    trial.was_freedom = make_block(1)
    trial.settled_at = 0.0
    trial.rates = floats(m.integrals)
    trial.kept_signals = floats(3 * m.integrals)
    trial.ways = make_block(1)
    trial.factor = make_block(1)
    trial.through = ints(m.machines)
    return trial


def make_engine(m: Model) -> Engine:
    """Return a run of a model that has not begun."""
    e = Engine()
    e.model = m
    e.fault = Fault()
    if m.tells != 0:
        e.fault.about = make_block(16)
        e.unrest = Fault()
        e.unrest.about = make_block(16)
        e.warned = make_warned()
    e.checks = make_checks(m)
    e.modes = records(Mode, FIRST_PLACES)
    e.modes_used = ints(FIRST_PLACES)
    e.modes_kept = FIRST_PLACES
    e.bucket = ints(BUCKETS)
    for k in range(BUCKETS):
        e.bucket[k] = NO_MODE
    e.work = make_work(m)
    e.v = floats(2 * m.slots)
    e.shown = floats(2 * m.slots)
    e.pre = floats(m.slots)
    e.trial = make_trial(m)
    e.largest = floats((m.storages + 1) * m.impulse_kinds)
    e.floor = floats(2 * m.bonds)
    e.state = ints(m.machines)
    e.states = m.storages + m.integrals
    e.y = floats(e.states)
    e.step = make_step(e.states, m.kinks, m.begins, m.rule_first[m.machines])
    e.step.peak_read = floats(3 * (2 * m.bonds + m.arguments))
    e.slide = make_slide(m)
    e.rounding = floats(m.storages)
    e.rate_noise = floats(m.storages)
    e.noise_at = math.nan
    e.settled = floats(m.storages)
    for k in range(m.storages):
        e.settled[k] = math.inf
    e.push_alone = floats(m.storages)
    e.moved_rounding = floats(m.storages)
    e.rate_rest = floats(e.states)
    e.rate_rounding = floats(m.integrals)
    e.least_signal = floats(m.integrals)
    e.sample_terms = floats(m.integrals)
    e.largest_state = floats(e.states)
    e.lately = floats(5 * (e.states + m.storages + 1))
    e.scale_energy = floats(m.storages + 1)
    e.pushed_energy = floats(m.storages + 1)
    e.remembered = floats(m.storages)
    e.remembered_before = floats(m.storages)
    e.slope_known = ints(m.slope_first[m.dynamics] + 1)
    for p in range(m.slope_first[m.dynamics]):
        e.slope_known[p] = NOT_ASKED
    e.root_known = 0.0
    e.root_given = False
    e.roots_kept = 0.0
    e.root_now = floats(2 * m.bonds)
    e.root_before = floats(2 * m.bonds)
    e.seen_before = floats(2 * m.bonds)
    e.fades_before = floats(m.storages)
    e.part_energy = floats(m.storages + 1)
    e.storage_part = ints(m.storages)
    e.parts = 1
    for k in range(m.storages if m.most_parts > 1 else 0):
        e.storage_part[k] = m.storage_base[k]
        e.parts = m.most_parts
    e.piece = ints(m.inputs)
    e.line_piece = ints(m.inputs)
    e.line_value = floats(m.inputs)
    e.line_rate = floats(m.inputs)
    e.line_begin = floats(m.inputs)
    for i in range(m.inputs):
        e.line_piece[i] = NO_PIECE
    if m.called > 0 or m.blocks > 0 or m.tells != 0:
        e.calls = make_calls(m.most_called)
    e.sampled_at = -math.inf
    e.awaited = floats(m.integrals)
    e.awaited_at = -math.inf
    e.level = floats(m.inputs)
    e.asked = floats(m.inputs)
    e.at = ints(m.watches)
    e.landed = ints(m.machines)
    e.key = ints(m.machines + m.discrete)
    e.given = ints(m.junctions)
    e.impulses = floats(2 * m.bonds)
    e.longest = math.inf
    if m.courses > 0:
        e.courses = make_courses(m)
    e.next_break = math.inf
    e.late = -math.inf
    e.early = math.inf
    e.within_from = math.nan
    e.within_to = math.nan
    e.open_modes = records(Mode, OPEN_KEPT)
    if m.laws > 0 or m.method == MOREAU:
        e.laws = make_laws(m)
    if m.method == MOREAU:
        e.stepping = make_stepping(m)
    e.rates = make_sums()
    e.standing = make_standing(m.storages)
    e.landings = make_landings(m)
    e.planar = make_planar(m)
    e.rests = make_rests(m)
    e.timetable = make_timetable(m)
    if m.method == RADAU:
        e.radau = make_radau(e.states)
    if m.method == EXACT or m.method == AUTO or m.method >= QSS1:
        e.exact = make_exact(m)
    if m.method >= QSS1:
        e.quantised = make_quantised(m)
    return e


def svd_room(e: Engine, rows: int, columns: int) -> Svd:
    """Return room for a decomposition of that size, and for the somewhat larger ones to come."""
    have = e.work.svd
    if rows > have.rows or columns > have.columns:
        most = max(rows, columns)
        most += most // 2
        e.work.svd = make_svd(max(most, have.rows), max(most, have.columns))
    return e.work.svd
