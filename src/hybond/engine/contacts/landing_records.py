"""What is known of impacts in a run: their instants by machine, and which machines have landed."""

from typing import Final

from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, floats, ints, record

LAST_TIMES: Final = 13
"""Instants kept of each machine: one more than the intervals that must shrink."""
CROWD: Final = 100
"""Events in a row between which no time passes that end a run."""


@record
class Landings:
    """The impacts of a run.

    Rows of LAST_TIMES belong to a machine: instants of its impacts in `times` (as many as `kept`
    says), of its other events in `others`. `since` is when the flight under way began, `speed` the
    most that an impact law has read, `flight` the longest flight. `sign` is that of the impulses of
    each reaction, 0 before any. `landed` is the contact at which a machine has landed, or -1.
    """

    times: Floats
    kept: Ints
    count: Ints
    since: Floats
    speed: Floats
    flight: Floats
    known: Ints
    others: Floats
    other_kept: Ints
    sign: Ints
    landed: Ints
    any_landed: bool
    held: Ints
    """Storages that landed contacts hold still."""

    # the impacts of the last event
    touches: int
    touch_contact: Ints
    touch_gap: Floats
    touch_approach: Floats
    touch_rebound: Floats
    touch_hidden: Floats
    """How long a flight is that rounding hides."""
    chosen: Ints

    # before the event: the state, the mode, and what is constant in the interval
    before: Floats
    before_laws: Floats
    """Room for that state on what machines ask for without their laws, where a run begins."""
    before_state: Ints
    before_piece: Ints
    before_at: Ints

    # a limit: when, and what is left to it
    limit_t: float
    limit_left: float
    limit_ratio: float
    """Of the intervals that shrink towards it; nan: it is not known."""
    found_t: float
    found_ratio: float

    # where events accumulate that nothing was landed for: whose they are, and why
    stuck_machine: int
    """-1: nobody's."""
    stuck_events: int
    stuck_why: int

    # why contacts do not land: the last verdict, and that of each machine
    why: int
    why_reaction: int
    why_force: float
    kept_why: Ints
    kept_reaction: Ints
    kept_force: Floats

    # room to work in
    state: Ints
    ahead: Ints
    """The mode that is looked at a moment later; `led_to` where rules lead each machine, or -1."""
    ahead_t: float
    """When that is."""
    led_to: Ints
    struck: Ints
    struck_state: Ints
    fired: Ints
    x: Floats
    s: Floats
    v: Floats
    at_rest: Floats
    moves: Ints
    loose: int
    area: Floats
    force: Floats
    size: Floats
    rate1: Floats
    rate2: Floats
    rate3: Floats
    rate4: Floats
    event_times: Floats
    events: int


def make_landings(m: Model) -> Landings:
    """Return what is known before a run."""
    g = Landings()
    n = m.storages + m.integrals
    g.times = floats(LAST_TIMES * m.machines)
    g.kept = ints(m.machines)
    g.count = ints(m.machines)
    g.since = floats(m.machines)
    g.speed = floats(m.machines)
    g.flight = floats(m.machines)
    g.known = ints(m.machines)
    g.others = floats(LAST_TIMES * m.machines)
    g.other_kept = ints(m.machines)
    g.sign = ints(m.reactions)
    g.landed = ints(m.machines)
    for k in range(m.machines):
        g.landed[k] = -1
    g.held = ints(m.storages)
    if m.tells != 0:
        g.kept_why = ints(m.machines)
        g.kept_reaction = ints(m.machines)
        g.kept_force = floats(m.machines)
    g.touch_contact = ints(m.machines)
    g.touch_gap = floats(m.machines)
    g.touch_approach = floats(m.machines)
    g.touch_rebound = floats(m.machines)
    g.touch_hidden = floats(m.machines)
    g.chosen = ints(m.machines)
    g.before = floats(n)
    g.before_laws = floats(n)
    g.before_state = ints(m.machines)
    g.before_piece = ints(m.inputs)
    g.before_at = ints(m.watches)
    g.state = ints(m.machines)
    g.ahead = ints(m.machines)
    g.led_to = ints(m.machines)
    g.struck = ints(m.machines)
    g.struck_state = ints(m.machines * m.machines)
    g.fired = ints(m.machines)
    g.x = floats(m.storages)
    g.s = floats(m.integrals)
    g.v = floats(2 * m.slots)
    g.at_rest = floats(n)
    g.moves = ints(m.storages)
    g.area = floats(2 * m.bonds)
    g.force = floats(2 * m.bonds)
    g.size = floats(2 * m.bonds)
    g.rate1 = floats(n)
    g.rate2 = floats(n)
    g.rate3 = floats(n)
    g.rate4 = floats(n)
    g.event_times = floats(CROWD)
    return g


def in_force(m: Model, g: Landings, machine: int, rule: int) -> bool:
    """Whether a rule is in force: some are only where its machine has landed, some not there."""
    landed = g.landed[machine]
    if m.rule_landed[rule] != 0:
        here = landed >= 0 and m.contact_state[landed] == m.rule_source[rule]
        return here and g.sign[m.rule_reaction[rule]] == m.rule_landed[rule]
    return landed < 0 or m.rule_source[rule] != m.contact_state[landed]
