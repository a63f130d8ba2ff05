"""The parts of a run, its beginning, how many steps it may take, and why a motion ends."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.contacts.landing_records import LAST_TIMES
from hybond.engine.engine import OK, Engine, say_fault
from hybond.engine.guards.locator import NONE, Locator, another_locator, make_locator
from hybond.engine.guards.timetable_records import forget_timetable
from hybond.engine.inputs.interval import is_due, is_timed
from hybond.engine.instant.instant import INPUT, SAMPLE, TIME, Instant, make_instant
from hybond.engine.instant.settling import Settling, make_settling
from hybond.engine.reasons.facts import add_fact
from hybond.engine.run.log import Report
from hybond.engine.run.within_error import Resting, make_resting
from hybond.engine.words import Floats, Ints, Records, floats, ints, record, records, some

IDLE: Final = 100
"""Instants in a row without any change that end a run."""
PACES_KEPT: Final = 8
"""Times of a thousand or so events each that say whether these come ever faster."""
PATIENCE: Final = 64
"""Steps in a row that are next to no part of the run after which it is asked what holds it."""
STANDING: Final = 2000
"""Steps after which it is looked whether they lead on: ..."""
NOWHERE: Final = 1e-12
"""... those that are together less than this part of the run would never end it."""
LOCATORS: Final = 64
"""Modes of which it is known at once which guards leave them: as many as are kept."""
STOPPED: Final = 5
"""Why a motion ended: its stretch did, and nothing happened."""
PAUSED: Final = 7
"""Likewise: a run in slices has had the steps of this one."""
FRESH: Final = 0
"""How a run begins: as the model says, from a state that is given, or from where another ended,
with something changed or with nothing."""
GIVEN: Final = 1
CHANGED: Final = 2
GOES_ON: Final = 3


@record
class Run:
    """The parts of a run."""

    settling: Settling
    instant: Instant
    locator: Locator
    locators: Records[Locator]
    """One for each of some modes: what it knows of one is not forgotten in another."""
    located: Ints
    report: Report
    events: int
    event_at: Floats
    """When the last ones were, in a ring."""
    pace_at: Floats
    """When each thousandth or so of the last ones was, how many of these are known."""
    paced: int
    foreseen: float
    """How many more there would be up to the end of the run."""
    before: Floats
    idle: int
    idle_at: Floats
    """When the last instants were at which a guard held and nothing changed, in a ring."""
    rest_away: Floats
    """Of each kink: what was compared when it was seen last by how much the error of a step moves
    it, that much, and the number of the mode; how often it was asked for since."""
    rest_moved: Floats
    rest_here: Floats
    """What is compared at the present state; whether it is due to be looked at anew."""
    rest_due: Ints
    rest_mode: Ints
    rest_asked: Ints
    kinks: int
    """Steps that a kink has ended, and when the last ones were, in a ring."""
    kink_at: Floats
    kink: int
    """The last of them; as which guard it has ended the last step that one has, or NONE."""
    kink_guard: int
    jumps: bool
    """Whether rates jumped at the last one where that could be told."""
    told: bool
    """Whether it could be told at the kink that the last step met."""
    leads_back: bool
    """Whether rates jumped there, and led back behind it."""
    back: int
    """At how many of the last ones in a row they did."""
    hold_due: int
    """At which of them it is asked next whether it holds the motion, after how many again."""
    hold_waits: int
    crowd: int
    """Kinks without a jump in a row at which a step ended next to where it began."""
    nap: int
    """For how many steps none is looked for where they crowd."""
    since: int
    """Steps since the last kink."""
    dense: int
    """Kinks without a jump in a row with next to no steps between them."""
    lull: int
    """For how many steps none is looked for where they are dense."""
    crawled: int
    """Steps in a row that were next to no part of the run, after how many it is asked why."""
    patience: int
    rate: Floats
    beside: Floats
    """Rates on both sides of a kink."""
    after: Floats
    """A state on the way, or tolerances: of whoever asks."""
    flown: int
    """Instants lately at which a law jumped, and when they were."""
    flights: Floats
    crossing: float
    """How long straight on it is to a kink that holds the motion, s."""
    jumping: int
    """The state whose rate jumps at it, -1 where none does."""
    vain: bool
    """Whether a jump of a source was settled just now, and nothing came of it."""
    begun: bool
    way: int
    """How it begins: FRESH, GIVEN, CHANGED or GOES_ON."""
    remembers: bool
    """Whether it goes on with what another run has seen."""
    late: float
    """Up to when what is one instant with the end of the run happens, s; -inf: nothing does."""
    cut: bool
    """Whether the last step was ended by the end of the run alone: time would have gone on."""
    warm: bool
    """Whether the run goes on with such a step, which it takes once more, in full."""
    warm_t: float
    """When it began, the state there, and what it began with."""
    warm_y: Floats
    warm_rounding: Floats
    warm_h: float
    warm_error: float
    warm_grid: float
    warm_next: float
    warm_implicit: bool
    resumed: float
    """When the run went on: what was before is not reported."""
    flowing: bool
    """Whether time passes in a mode: a run in slices was paused there."""
    beyond: float
    """How many of the last steps have touched a place where a law has no value."""
    edge_at: float
    """When the state was last put on an edge that it had almost reached, s; -1: never."""
    edges: int
    """Edges in a row at which a step could not be made, with next to no time between them."""
    edge_t: float
    """When the last of them was, s."""
    edge_from: Floats
    """The state from which it went there, and in which time, s."""
    edge_time: float
    resting: Resting
    """Room to see what comes to rest there."""
    taken: int
    """Steps since the last instant."""
    began: float
    """When that was, s."""
    marked: float
    """Where steps were when it was last looked whether they lead on, s."""
    slice: int
    """Steps and instants that this slice of the run still has; -1: as many as it takes."""


def make_run(e: Engine, report: Report) -> Run:
    """Return a run that has not begun."""
    r = Run()
    r.settling = make_settling(e)
    r.instant = make_instant()
    r.locator = make_locator(e)
    r.locators = records(Locator, LOCATORS)
    r.locators[0] = r.locator
    r.located = ints(LOCATORS)
    r.located[0] = 1
    r.report = report
    r.before = floats(e.states)
    r.idle_at = floats(IDLE + 1)
    r.event_at = floats(IDLE + 1)
    r.pace_at = floats(PACES_KEPT + 1)
    r.kink_at = floats(IDLE + 1)
    r.flights = floats(LAST_TIMES)
    r.rest_away = floats(e.model.kinks)
    r.rest_moved = floats(e.model.kinks)
    r.rest_here = floats(e.model.kinks)
    r.rest_due = ints(e.model.kinks)
    r.rest_mode = ints(e.model.kinks)
    r.rest_asked = ints(e.model.kinks)
    r.rate = floats(e.states)
    r.beside = floats(4 * e.states)
    r.after = floats(e.states)
    r.kink = -1
    r.kink_guard = NONE
    r.jumping = -1
    r.nap = 1
    r.hold_waits = 1
    r.lull = 1
    r.patience = PATIENCE
    r.edge_at = -1.0
    r.edge_t = -math.inf
    r.edge_from = floats(e.states)
    r.resting = make_resting(e)
    r.warm_y = floats(e.states)
    r.warm_rounding = floats(e.model.storages)
    r.resumed = -math.inf
    r.late = -math.inf
    r.slice = -1
    return r


def take_locator(e: Engine, r: Run) -> None:
    """Take the locator that was last in the mode, if there is one."""
    if e.model.kinks > 0 or e.model.disks > 0:
        return
    k = e.mode_at % LOCATORS
    if r.located[k] == 0:
        r.located[k] = 1
        r.locators[k] = another_locator(e, r.locator)
    r.locator = some(r.locators[k])
    r.locator.looked = math.nan


def begin(e: Engine) -> None:
    """Put the model's start there."""
    m = e.model
    e.until = m.until
    e.stop = m.until
    e.span = m.span
    e.t = 0.0
    e.trial.settled_at = 0.0
    for k in range(m.storages):
        e.y[k] = m.storage_start[k]
    for k in range(m.integrals):
        e.y[m.storages + k] = m.integral_start[k]
    for k in range(m.machines):
        e.state[k] = m.start[k]
    forget_timetable(e.timetable, m.rule_first[m.machines])


def is_over(e: Engine) -> bool:
    """Whether the machine has fired that ends the run."""
    m = e.model
    return m.ends >= 0 and e.state[m.ends] != m.start[m.ends]


def bound_of(e: Engine) -> float:
    """Return up to when a motion may go on: what its first step is chosen by.

    A run that is made in parts has the same first steps as in one.
    """
    return min(e.next_break, max(e.stop, e.span))


def begin_count(e: Engine, r: Run) -> None:
    """Count steps anew from the present instant on."""
    r.taken = 0
    r.marked = e.t
    if e.model.tells != 0:
        r.began = e.t


def count_step(e: Engine, r: Run) -> int:
    """Count a step, and refuse one too many without an event, or many that lead nowhere."""
    m = e.model
    r.taken += 1
    stands = False
    if r.taken % STANDING == 0:
        stands = e.t - r.marked < NOWHERE * e.span and e.span < math.inf
        r.marked = e.t
    if r.taken <= m.max_steps and not stands:
        return OK
    refused = say_fault(e, "HB-N409", "too many steps without an event", "")
    if m.tells != 0:
        add_fact(e.fault, (e.t - r.began) / float(r.taken))
        if stands:
            add_fact(e.fault, float(r.taken))
    return refused


def timed_cause(e: Engine) -> int:
    """Return why a timed event is one."""
    if is_timed(e, e.next_break):
        return TIME
    for k in range(e.model.samples):
        if is_due(e.model, k, e.next_break):
            return SAMPLE
    return INPUT


def last_in_vain(r: Run) -> float:
    """Return when a guard held last of which nothing came, if one did."""
    return r.idle_at[(r.idle - 1) % (IDLE + 1)] if r.idle > 0 else -math.inf


def times_in_vain(r: Run, instant: float) -> int:
    """Return how often a guard held up to there, each time within an instant of the one before."""
    times = min(r.idle, 1)
    while times < r.idle and times < IDLE:
        later = r.idle_at[(r.idle - times) % (IDLE + 1)]
        if later - r.idle_at[(r.idle - times - 1) % (IDLE + 1)] > instant:
            return times
        times += 1
    return times
