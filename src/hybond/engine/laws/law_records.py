"""What the laws of junctions need in a run: ports, their response, what is being tried."""

import math
from typing import Final

from hybond.engine.algebra.blocks import Block, Places, make_block, make_places
from hybond.engine.algebra.svd import Svd, make_svd
from hybond.engine.complementarity.decided_closely import MOST, Closer, make_closer
from hybond.engine.complementarity.law_roles import LawProblem, make_law_problem
from hybond.engine.complementarity.least_shares import Shares, make_shares
from hybond.engine.impacts.impact_records import NEWTON, Impact, make_impact
from hybond.engine.model import Model
from hybond.engine.words import (
    Floats,
    Ints,
    Records,
    floats,
    ints,
    record,
    records,
)

OPEN_KEPT: Final = 64
"""Configurations with open laws that are kept: the legs of three phases with dead time meet more
than 16."""
NOT_ASKED: Final = 0
BY_STORAGE: Final = 1
BY_OTHERS: Final = 2
AGAIN: Final = 4
"""States that differ by rounding from which branches are looked for."""
TURNED: Final = 8
"""Modes that are tried with what is violated turned."""


@record
class Ports:
    """What the equations of a configuration with all laws of junctions open say of these.

    `given` is COMMON or NET, port by port; `column` where a port stands among the sources; `sign`
    what the given variable is times `l`. ``w = partner times bond variables``. What follows is the
    same at every state of a linear graph, once it is known: see Response, and what `y` sees of what
    is stored and of rates of sources. The equations themselves stand at `place` among those that
    the run keeps.
    """

    place: int
    used: int
    stamp: int
    """Tells these equations from others that stood there."""
    key: Ints
    given: Ints
    column: Ints
    sign: Floats
    linear: bool
    known: bool
    monotone: bool
    """Of a linear graph: whether what laws give never makes what they feel less, all together."""
    moves: int
    """Whether anything but what is stored tells how ports share what they carry: BY_STORAGE,
    BY_OTHERS, or NOT_ASKED."""
    gain: Floats
    d: Floats
    e: Floats
    ce: Floats
    seen: Floats
    through: Floats


@record
class Response:
    """The graph seen from its ports at one state, linearised.

    `bonds` are bond variables with ``l = 0`` and `gain` their derivative by `l`, a row for each;
    `y` is `w` at ``l = 0``, `size` that of the terms that made it, `rate` its rate, `rate_size`
    that of the terms of the rate in a linear graph. It is ``w = y + d l``; what is stored moves by
    ``e l``, and `y` then by ``ce l``.
    """

    bonds: Floats
    gain: Floats
    y: Floats
    size: Floats
    d: Floats
    e: Floats
    ce: Floats
    rate: Floats
    rate_size: Floats


@record
class Laws:
    """The laws of junctions of one run.

    The instant that is looked at: `t`, integrated signals `s`, states of machines `state`; `x` is
    what is stored on what the machines' mode alone asks for, and `v` the values there. `largest` is
    the largest gap of each port so far. `candidate` is the mode that was found last.
    """

    open: Records[Ports]
    made: int
    now: Ports
    response: Response
    key: Ints
    base: Ints
    given: Ints
    tried: Ints
    many_tried: int
    l: Floats
    chosen: Ints
    stored_taken: Ints
    port_taken: Ints
    truths: Places
    """Of ports that are tried together; see `laws/ports_together`."""
    width: Floats
    zero: Floats
    zero_terms: Floats
    field: Floats
    field_size: Floats
    """The size of the terms that made each rate of what is stored."""
    moved: Floats
    ahead: Floats
    kept: Floats
    later: Floats
    later_s: Floats
    rate_after: Floats
    rate_terms: Floats
    pushed: Floats
    """What sources have of each rate of `y`."""
    atom: Floats
    looks_ahead: bool
    """Whether what stands must stand a moment later, too."""
    saw_ahead: bool
    parting: bool
    """Whether sources that must agree do so at this instant only."""
    row: Floats
    row_terms: Floats
    terms: Floats

    t: float
    s: Floats
    state: Ints
    x: Floats
    v: Floats
    y: Floats
    q: Floats
    rounding: Floats
    """What rounding of each `y` is measured by."""
    able: Ints
    kept_state: Floats
    goes_apart: Ints
    """Contacts that were left out of an impact that rebounds, as they go apart."""
    pressed: Ints
    """Contacts that a source has jumped onto, and those in a row with them."""
    in_row: Ints
    gap_now: Floats
    reach: Floats
    """Gaps that are closed within the instant at `reach_t`."""
    reach_t: float
    gaps_given: bool
    """Whether the state is one that was given, whose contacts may be said to be closed."""
    gaps_noted: bool
    bonds_noted: bool
    bonds_before: Floats
    """Bond variables before a kink at which a source jumps onto a contact, if they are noted."""
    gap_before: Floats
    """Gaps just before the instant that is settled, where they may jump, ..."""
    gap_earlier: Floats
    """... and as long before that as that is before the instant."""
    comes: Ints
    """Machines of contacts that approach by what is stored: they strike in the next jump."""
    role: Ints
    start: Ints
    resting: Ints
    loose: Ints
    held_said: Ints
    """Whether it was said of friction that others hold it at rest."""
    halted: Ints
    """Friction that would turn round at once, and so may rest instead."""
    tilt: Floats
    """What each force of friction becomes where two trade their shares."""
    problem: LawProblem
    closer: Closer
    closely: bool
    """Whether the step is lost in the rounding of what acts at once."""
    limits_held: bool
    """Whether limits that bend are taken as they are, and not along their slopes."""
    svd: Svd
    block: Floats
    basis: Floats
    adrift: Ints
    shares: Ints
    """Laws that carry a share of what others beside them carry, or none of it."""
    idle: Ints
    """One-sided laws that carry nothing in the answer, and block nothing."""
    carries: Ints
    """Laws whose share is clear: what is far smaller is shared by others beside them."""
    share_l: Floats
    left: int
    """In how many ways shares are open beyond what the mode with ``left_state`` says: a law that
    has none, or friction at its limit, may take from others what they carry."""
    left_state: Ints
    left_l: Block
    left_room: Block
    room: Shares
    """Room to find these shares."""
    apart: Ints
    units: Floats
    rebound: Floats
    gone: Floats
    """By how much the approach that restitution reads is less than it was before the instant."""
    edge: Ints
    """Friction at rest that gives all it can where nothing jumps."""
    here_moved: Floats
    """How far an answer moves what each law decides on."""
    kept_energy: Floats
    """What the run has seen on each part, while it is set aside."""
    largest: Floats
    largest_limit: Floats
    branch: Ints
    answer: Ints
    answer_open: Ints
    answer_l: Floats
    candidate: Ints
    candidate_kept: bool

    undecided: bool
    """Whether no branches were found, or none that stand."""
    unanswered: bool
    """Whether the graph with its laws open had no values."""
    some_valueless: bool
    """Whether the laws of some mode that was tried had no common solution."""
    proved: bool
    """Whether it is proved of all that was asked in vain that there is no answer."""

    # where the search for what lasts stands
    attempt: int
    second: bool
    """Whether an answer with what is adrift parted, or shared, was given, and it is next itself."""
    solved: bool
    second_keep: bool
    shared: bool
    """Whether the answer given has shares: what these violate is turned before another is tried."""

    # trying what was found
    jumping: bool
    leaps: bool
    """Whether a mode tried is entered with whatever impulses that takes: no law has struck yet."""
    at_once: bool
    """Whether contacts that do not approach take part in the impacts of others."""
    struck: bool
    struck_moved: int
    factors: int
    swept_first: bool
    shifted: bool
    """Whether the state was swept since the mode was entered."""
    here: Floats
    landed: Floats
    begin: Floats
    swept: Floats
    struck_impulses: Floats
    through: Ints
    states: int
    state_at: Floats
    asked: int
    asked_at: Ints
    broken: int
    broken_machine: Ints
    broken_target: Ints
    answered: bool
    """Whether the graph has answered at the state `answered_x`, and nothing was asked since."""
    answered_x: Floats
    furthest: Floats
    """How far each closed contact has been apart when gaps were held against their bonds last."""
    gaps_known: bool
    """Whether gaps were held against what their bonds close."""
    sweep: bool
    """Whether approaches that are only rounding are taken away, as guards ask in vain."""
    rules_held: int
    rule_held: Places
    """Rules that held in the branches tried at an instant."""
    impact: Impact
    """Of laws of impacts that see all closed contacts at once."""


def make_ports(place: int, m: Model) -> Ports:
    """Return room for the ports of a configuration."""
    n = m.ports
    p = Ports()
    p.place = place
    p.key = ints(m.machines + m.discrete)
    p.given = ints(n)
    p.column = ints(n)
    p.sign = floats(n)
    p.gain = floats(2 * m.bonds * n)
    p.d = floats(n * n)
    p.e = floats(m.storages * n)
    p.ce = floats(n * n)
    p.seen = floats(n * m.storages)
    p.through = floats(n * m.most_sources)
    return p


def make_response(m: Model) -> Response:
    """Return room for a response."""
    n = m.ports
    a = Response()
    a.bonds = floats(2 * m.bonds)
    a.y = floats(n)
    a.size = floats(n)
    a.rate = floats(n)
    a.rate_size = floats(n)
    return a


def make_laws(m: Model) -> Laws:
    """Return what the laws of a run need."""
    n = m.ports
    r = Laws()
    r.open = records(Ports, OPEN_KEPT)
    r.response = make_response(m)
    r.key = ints(m.machines + m.discrete)
    r.base = ints(m.machines)
    r.given = ints(m.junctions)
    r.tried = ints(n)
    r.l = floats(n)
    r.chosen = ints(n)
    r.stored_taken = ints(m.storages)
    r.port_taken = ints(n)
    r.truths = make_places(1)
    r.width = floats(n)
    r.zero = floats(2 * m.bonds)
    r.zero_terms = floats(2 * m.bonds)
    r.field = floats(m.storages)
    r.field_size = floats(m.storages)
    r.moved = floats(m.storages)
    r.ahead = floats(m.integrals)
    r.kept = floats(2 * m.slots)
    r.later = floats(2 * m.slots)
    r.later_s = floats(m.integrals)
    r.rate_after = floats(n)
    r.pushed = floats(n)
    r.rate_terms = floats(n)
    r.atom = floats(m.atom_first[m.rule_first[m.machines]])
    r.row = floats(m.storages + 2 * m.most_sources + n)
    r.row_terms = floats(m.storages + 2 * m.most_sources + n)
    r.terms = floats(m.slots)
    r.s = floats(m.integrals)
    r.state = ints(m.machines)
    r.x = floats(m.storages)
    r.v = floats(2 * m.slots)
    r.y = floats(n)
    r.q = floats(n)
    r.rounding = floats(n)
    r.able = ints(n)
    r.kept_state = floats(m.storages + m.integrals)
    r.goes_apart = ints(n)
    r.pressed = ints(n)
    r.in_row = ints(n)
    r.gap_now = floats(n)
    r.reach = floats(n)
    r.reach_t = math.nan
    r.gap_before = floats(n)
    r.bonds_noted = False
    r.bonds_before = floats(2 * m.bonds)
    r.gap_earlier = floats(n)
    r.comes = ints(m.machines)
    r.role = ints(n)
    r.start = ints(n)
    r.resting = ints(n)
    r.loose = ints(n)
    r.halted = ints(n)
    r.tilt = floats(n)
    r.held_said = ints(n)
    r.problem = make_law_problem(n)
    r.closer = make_closer(n if n < MOST else MOST)
    for k in range(n):
        r.problem.rank[k] = m.port_rank[k]
    r.svd = make_svd(2 * n, n)
    r.block = floats(2 * n * n)
    r.basis = floats(n * n)
    r.adrift = ints(n)
    r.shares = ints(n)
    r.idle = ints(n)
    r.carries = ints(n)
    r.share_l = floats(n)
    r.left_state = ints(m.machines)
    r.left_l = make_block(1)
    r.left_room = make_block(1)
    r.room = make_shares()
    r.apart = ints(n)
    r.units = floats(n)
    r.rebound = floats(n)
    r.gone = floats(n)
    r.edge = ints(n)
    r.here_moved = floats(n)
    r.kept_energy = floats(m.storages + 1)
    r.largest = floats(n)
    r.furthest = floats(n)
    r.largest_limit = floats(n)
    r.branch = ints(n)
    r.answer = ints(n)
    r.answer_open = ints(n)
    r.answer_l = floats(n)
    r.candidate = ints(m.machines)
    r.landed = floats(m.storages)
    r.here = floats(m.storages)
    r.answered_x = floats(m.storages)
    r.begin = floats(m.storages)
    r.swept = floats(m.storages)
    r.struck_impulses = floats(2 * m.bonds)
    r.through = ints(m.machines)
    r.state_at = floats(AGAIN * m.storages)
    r.asked_at = ints(TURNED * m.machines)
    r.broken_machine = ints(2 * m.machines)
    r.broken_target = ints(2 * m.machines)
    if m.tells != 0:
        r.rule_held = make_places(8)
    r.impact = make_impact(0 if m.impact == NEWTON else n)
    return r
