"""The equations of a mode made ready, and what belongs to them: impulses, leakage, what is read."""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import (
    Block,
    Places,
    Rows,
    make_block,
    make_places,
    make_rows,
)
from hybond.engine.algebra.sparse_lu import SparseLu, make_sparse_lu
from hybond.engine.mode.comparisons.standing_records import Stood, make_stood
from hybond.engine.mode.comparisons.sum_records import Sums, make_sums
from hybond.engine.mode.nonlinear.apart_records import Apart, make_apart
from hybond.engine.mode.nonlinear.followed_records import Branch, make_branch
from hybond.engine.mode.rows.acting_records import Acting, make_acting
from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, floats, ints, record

PACES: Final = 16
"""Sizes of steps that are remembered: modes that share one mislead each other, not the run."""
NOT_KNOWN: Final = 0
TIED: Final = 1
FREE: Final = 2
"""Whether sources lead all that moves: not known, so they do, they do not."""


@record
class Leakage:
    """What least leakage takes off: ``(1 - basis2 taken2)(1 - basis1 taken1) w``, in `stages`.

    Found, in so many stages, for `many` ways in which bond variables are free, `ways`, and for
    `leaks` rows of what leaks, `leak`; none: not found yet.
    """

    stages: int
    first: int
    second: int
    basis: Block
    taken: Block
    basis2: Block
    taken2: Block
    amount: Block
    many: int
    leaks: int
    found: int
    ways: Block
    leak: Block


@record
class Ways:
    """The impulses that a mode allows, and what they do to what is stored.

    `directions` are bond variables by `many`; `moving`, many by areas; `d`,
    storages by areas, those of storage k that are not zero in the columns `moves` from
    ``moves_first[k]`` on, by `moves_by`; `slope`, constraints by areas, its inverse and its rank.
    `part` is the part of the graph that each bond is in, once it is `parted`.

    Where there are many they are `sparse`: each area is what one storage moves by, `moved`, and
    these are solved for with the free impulses of the power structure, `areas` and `many` unknowns
    in the system `solver`, measured by `extent`.
    """

    known: bool
    many: int
    areas: int
    directions: Block
    moving: Block
    d: Block
    moves_first: Places
    moves: Places
    moves_by: Block
    sparse: bool
    moved: Places
    extent: Block
    solver: SparseLu
    slope: Block
    inverse: Block
    rank: int
    shares: int
    share: Block
    parted: bool
    part: Places


@record
class Ties:
    """Sources that lead all that moves in a mode along with its constraints, if that is so.

    `known` says whether it is: NOT_KNOWN, TIED, FREE. `factor` is what a unit of each of the
    `leaders`, which are sources of the model, moves of each storage, and `size` what that is
    rounding of; storages that are `given` hold nothing else, others the `rest` of the motion.
    `place` says which leader a source of the mode is, or -1; `level` are their values.
    """

    known: int
    leaders: int
    leader: Places
    place: Places
    factor: Block
    size: Block
    given: Places
    rest: Block
    level: Block


@record
class Reads:
    """Bond variables that are evaluated in a step, and the sources that these are made of.

    The first `many` of `bond`; `chosen` says of each bond variable whether it is one of them,
    `valued` and `rated` of each source whether a row of one reads its value, or its rate, and the
    first `stores` of `storage` are those whose co-energy is read, as `stored` says of each.
    """

    many: int
    bond: Ints
    chosen: Ints
    valued: Ints
    rated: Ints
    stores: int
    storage: Ints
    stored: Ints
    first_of: Ints
    """Of each row: the bond variable that was the first to be read by it, plus 1; else 0."""
    plain: bool
    """Whether no unknown has part in any that is read, of the rows eliminated `plain_of` times."""
    plain_of: int


@record
class Mode:
    """The equations of one configuration.

    Bond variables are ``free r + known xi``, twice: before the hidden constraints (`power`, where
    impulses live) and after (`finite`, for finite values). `xi` are co-energy variables, values of
    sources, their rates.
    """

    made: int
    """Which of all the modes that were made it is: others had its place before."""
    behind: int
    """The next of those kept whose configurations are in the same bucket, or NO_MODE."""
    longest: float
    """How long a step may be for the sines of time alone that count there, s; 0: not known yet."""
    fastest: int
    """Which course has the fastest of them, -1: none does."""
    moves: bool
    """Whether other courses of time count there; ..."""
    phased: bool
    """... whether courses of phases that the plant moves do; and which of both: `course`."""
    course: Ints
    pace: int
    """Which of the sizes of steps that are remembered is that of the mode."""
    state: Ints
    """Of each machine, then of what else selects equations."""
    flags: Floats
    """Booleans: what is ON, then the states of machines."""
    on: Ints
    prior_acts: Ints
    """Whether each law that reads ``pre()`` acts."""
    too_high: bool
    knowns: int
    sources: int
    source: Ints
    rated: Ints
    """Whether the rate of a source is asked for."""
    source_level: Floats
    """Values of sources that are constant, or given from outside."""
    same: Ints
    power: Rows
    finite: Rows
    direct: Rows
    """Those of `finite` with least leakage taken off, where nothing is left to Newton."""
    shared: Rows
    """Room for them if least leakage takes anything off."""
    power_free: Block
    finite_free: Block
    share_first: Places
    """Where there are free unknowns: the first of those, in `share_of`, that have part in each bond
    variable, in order; few have in most."""
    share_of: Places
    free_rest: Block
    """By what each of these is more than it was rounded to."""
    power_frees: int
    eliminated: int
    """How often its rows have been eliminated."""
    finite_frees: int
    free_column: Ints
    bent: bool
    """Whether any law of one bond bends, or a constraint that is differentiated."""
    reluctant: Ints
    """Of each free unknown: whether a bent law reads it; Newton moves others in its place."""
    own_power: Rows
    own_power_free: Block
    free_rows: Rows
    """What free unknowns give there to each bond variable, where nothing else asks for it: ..."""
    free_sparse: bool
    """... in place of `own_power_free`."""
    constraints: Rows
    constraint_hidden: Ints
    """Of each constraint: the dynamic row that is its derivative, or -1."""
    bounds: int
    bound: Ints
    """The knowns that constraints are evaluated by: the first `bounds`; see `list_bound`."""
    bound_alone: Ints
    """Whether each of them is that of a storage with one port and a linear law."""
    agreements: Rows
    dynamics: int
    dynamic: Ints
    """Rows that are evaluated anew: of the model, or ``-1 - k`` of constraint k."""
    structures: int
    structure: Ints
    other: Ints
    rank: int
    affine: bool
    """Whether no row's slopes read bond variables; where the structure hides nothing, one step of
    Newton is exact."""
    regular: bool
    """Whether the last step of Newton shows that nothing is free."""
    clear: bool
    """Whether it shows that nothing is free but what no law sees: ..."""
    unseen: int
    """... so many ways, in unknowns, `unseen_ways`; which unknowns are held as others go them."""
    unseen_ways: Block
    unseen_held: Places
    apart: Apart
    acting: Acting
    port_acting: Acting
    """Of a mode with its laws open: the same of ports and bond variables, ..."""
    stored_acting: Acting
    """... and of what is stored and what ports are answered."""
    leakage: Leakage
    loose: int
    freedom: Block
    looks: int
    """How often time has begun to pass in it since it was made: laws are put back into themselves.
    """
    guessed: bool
    guess: Block
    branch: Branch
    ways: Ways
    ties: Ties
    connected: bool
    parts: int
    bond_part: Ints
    """The part of the graph that each bond hangs together with, once it is `connected`; `parts`
    where that stores nothing."""
    floored_at: float
    part_energy: Floats
    """What rounding on each of them is measured by, J, as of `Engine.energies_seen`; ..."""
    part_reach: Floats
    """... what `seen` is a factor of."""
    settles_with: Ints
    """Of each storage that settles within a moment, the first one of those it settles with, else
    -1; see `mode/digits/clusters`."""
    any_settles: bool
    never_settles: bool
    """Whether it is known that none does, whatever is stored: as storages are linear."""
    fading_known: bool
    fades_by: Floats
    """How fast what each storage holds is brought back, 1/s, or -1; see `digits/fading`; ..."""
    fades_with: Ints
    """... the first of those it hangs together with, ..."""
    fades_to: Floats
    """... and what rounding of it then is measured by."""
    reached: Floats
    """What `seen` was found from, at the instant `saw_at`; whether sums were taken with it."""
    saw_at: float
    seen_taken: bool
    saw: bool
    seen: Floats
    sized: bool
    sized_at: Floats
    free_size: Block
    """What rounding of the free unknowns is measured by, at the bond variables `sized_at`."""
    rates: Reads
    """What the rates of the state read."""
    rate_row: Ints
    """Of each stored quantity: the row of `direct` that is its rate, but for its sign."""
    signals: Reads
    """What the rates of integrated signals read."""
    stood: Stood
    summed: Sums
    """The rates of the state as sums of it; ..."""
    summed_known: bool
    """... whether they were taken of these rows, and whether all of them are such sums."""
    summed_straight: bool
    closely: bool
    """Whether rates are summed with all digits where large terms cancel: slow motions beside fast
    ones are nothing but rounding of these else."""
    flow_known: bool
    """Whether it was looked whether the mode is linear."""
    flow_why: int
    """The number of the reason why it is not, or -1."""
    flow: int
    """Where its flow is kept, or -1."""
    given: Ints
    """Which variable of each junction is given from outside."""
    doubted: bool
    """Whether elimination took a sum for zero that may be a coefficient."""
    weighed: bool
    """Whether rows were eliminated by how large bond variables are: `weight`."""
    weight: Floats
    lost: float
    """The part of laws that rounding of what was eliminated hid when that was done last; 0: never.
    """
    rows_lost: float
    """The same of rows with constant coefficients."""
    solves: int
    """How often it was solved."""
    looks_due: int
    """After how many such rows are looked at next."""
    opened: bool
    """Whether the laws of junctions are left open: the last sources are their ports."""


def make_leakage() -> Leakage:
    """Return a projection that takes nothing off."""
    p = Leakage()
    p.basis = make_block(1)
    p.taken = make_block(1)
    p.basis2 = make_block(1)
    p.taken2 = make_block(1)
    p.amount = make_block(1)
    p.ways = make_block(1)
    p.leak = make_block(1)
    return p


def make_ways() -> Ways:
    """Return room for the impulses of a mode."""
    w = Ways()
    w.directions = make_block(1)
    w.moving = make_block(1)
    w.d = make_block(1)
    w.moves_first = make_places(1)
    w.moves = make_places(1)
    w.moves_by = make_block(1)
    w.moved = make_places(1)
    w.extent = make_block(1)
    w.solver = make_sparse_lu()
    w.slope = make_block(1)
    w.inverse = make_block(1)
    w.share = make_block(1)
    w.part = make_places(1)
    return w


def make_ties() -> Ties:
    """Return no ties."""
    t = Ties()
    t.leader = make_places(1)
    t.place = make_places(1)
    t.factor = make_block(1)
    t.size = make_block(1)
    t.given = make_places(1)
    t.rest = make_block(1)
    t.level = make_block(1)
    return t


def make_reads(m: Model) -> Reads:
    """Return room for what a mode of a model is read of; nothing is."""
    r = Reads()
    r.bond = ints(2 * m.bonds)
    r.chosen = ints(2 * m.bonds)
    r.valued = ints(m.most_sources)
    r.rated = ints(m.most_sources)
    r.storage = ints(m.storages)
    r.stored = ints(m.storages)
    r.first_of = ints(2 * m.bonds)
    r.plain = False
    return r


def make_mode(m: Model) -> Mode:
    """Return room for the equations of a mode."""
    mode = Mode()
    n = 2 * m.bonds
    mode.state = ints(m.machines + m.discrete)
    mode.flags = floats(m.switches + m.state_first[m.machines])
    mode.on = ints(m.switches)
    mode.course = ints(m.courses)
    mode.prior_acts = ints(m.priors)
    mode.source = ints(m.most_sources)
    mode.rated = ints(m.most_sources)
    mode.source_level = floats(m.most_sources)
    mode.same = ints(n)
    mode.finite = make_rows()
    mode.shared = make_rows()
    mode.own_power = make_rows()
    mode.finite_free = make_block(1)
    mode.share_first = make_places(1)
    mode.share_of = make_places(1)
    mode.free_rest = make_block(1)
    mode.own_power_free = make_block(1)
    mode.free_rows = make_rows()
    mode.free_column = ints(n)
    mode.reluctant = ints(n)
    mode.constraints = make_rows()
    mode.constraint_hidden = ints(m.storages)
    mode.bound = ints(m.storages + 2 * m.most_sources)
    mode.bound_alone = ints(m.storages + 2 * m.most_sources)
    mode.agreements = make_rows()
    mode.dynamic = ints(m.most_dynamic + m.storages)
    mode.structure = ints(m.most_dynamic + m.storages)
    mode.other = ints(m.most_dynamic + m.storages)
    mode.unseen_ways = make_block(1)
    mode.unseen_held = make_places(1)
    mode.apart = make_apart()
    mode.acting = make_acting()
    mode.port_acting = make_acting()
    mode.stored_acting = make_acting()
    mode.leakage = make_leakage()
    mode.freedom = make_block(1)
    mode.guess = make_block(1)
    mode.branch = make_branch()
    mode.ways = make_ways()
    mode.ties = make_ties()
    mode.bond_part = ints(m.bonds)
    mode.part_energy = floats(m.storages + 1)
    mode.part_reach = floats(m.storages + 1)
    mode.settles_with = ints(m.storages)
    for k in range(m.storages):
        mode.settles_with[k] = -1
    mode.fades_by = floats(m.storages)
    mode.fades_with = ints(m.storages)
    mode.fades_to = floats(m.storages)
    mode.reached = floats(m.storages)
    mode.seen = floats(n)
    mode.sized_at = floats(n)
    mode.free_size = make_block(1)
    mode.rates = make_reads(m)
    mode.stood = make_stood(m.storages)
    mode.summed = make_sums()
    mode.rate_row = ints(m.storages)
    mode.signals = make_reads(m)
    mode.given = ints(m.junctions)
    mode.weight = floats(n)
    return mode


def is_constrained(mode: Mode) -> bool:
    """Whether a mode has constraints on what is stored, off which a motion may drift."""
    return mode.constraints.rows > 0 or mode.structures > 0 or mode.agreements.rows > 0
