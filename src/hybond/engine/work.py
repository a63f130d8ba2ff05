"""Room for the work of a run: arrays that are filled and read again within one question."""

from __future__ import annotations

import math

from hybond.engine.algebra.blocks import (
    Block,
    Places,
    Rows,
    make_block,
    make_places,
    make_rows,
)
from hybond.engine.algebra.separate import Separate, make_separate
from hybond.engine.algebra.sparse_lu import Factoring, SparseLu, make_factoring, make_sparse_lu
from hybond.engine.algebra.svd import Svd, make_svd
from hybond.engine.expressions.pairs import Stack, make_stack
from hybond.engine.mode.digits.cluster_records import Cluster, make_cluster
from hybond.engine.mode.mode_records import Leakage, Ways, make_leakage, make_ways
from hybond.engine.mode.nonlinear.followed_records import Following, make_following
from hybond.engine.mode.rows.elimination_records import Elimination, make_elimination
from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, floats, ints, record


@record
class Work:
    """Room for what is computed on the way; nothing in it is kept."""

    power: Elimination
    finite: Elimination
    built: Elimination
    """Rows of the mode that was built last: those of `power`, or of `finite`, with the derivatives
    of constraints, where there are any."""
    table: Elimination
    weighed: bool
    steady_known: bool
    steady: Elimination
    steady_table: Elimination
    """Rows that are the same in every mode, as they are once they are eliminated, if that is
    known; and constraints among them."""
    at_start: Floats
    """Values at the start, of what is stored alone."""
    plain: Rows
    """Rows of a mode as they were before they are eliminated by how large bond variables are."""
    timed: Floats
    timed_at: Floats
    """Values of sources that move by a law of time alone, then their rates; and at which time."""
    told: Ints
    wide: Ints
    """Junctions whose sums are added last, and determine something; see `tableau.WIDE`."""
    agreements: int
    agreement_entries: int
    agreement_first: Ints
    agreement_column: Ints
    agreement_value: Floats
    xi: Floats
    w: Floats
    base: Floats
    f: Floats
    sizes: Floats
    base_size: Floats
    guess: Block
    found_apart: Block
    """Of a solution, its free unknowns: where it is looked what laws leave free there."""
    kept_guess: Block
    had_guess: bool
    kept_bonds: Floats
    had_values: bool
    """Whether laws that have none at zero had values beside what is known."""
    freedom: Block
    terms: Floats
    slopes: Block
    frozen: Block
    jacobian: Block
    jacobian2: Block
    seen_slopes: Block
    seen_step: Block
    """Of Newton's system what is not held, and its step; which bond variables its rows read."""
    read_by_laws: Places
    inverse: Block
    whole: Block
    """Of Newton with shorter steps: the whole step, what it is measured by, where a part leads,
    and the slopes where it begins."""
    weight: Block
    left_over: Block
    """Of Newton's residuals: what a step leaves."""
    before: Block
    """Of Newton's shorter steps: the last one."""
    trial: Block
    slopes_there: Block
    rounded: Block
    """Of a whole step: what rounding it may be."""
    swung: Block
    """Where full steps have ended: a root that they swing about, if `swings` is not 0."""
    swings: int
    flat_sides: bool
    """Whether slopes of laws at a corner are those of the side where they are flat."""
    in_step: bool
    """Whether nothing is shown or decided by what is solved for but rates."""
    flat_about: bool
    """Whether a slope that was looked at is zero just beside, on one side."""
    kind_beside: Floats
    """By kinds of bond variables: how far one is moved to be beside a corner."""
    kept_at_corner: Places
    """Of each row: whether it is kept at a corner, so that its slope is that of the other side."""
    holds_rows: bool
    """Whether Newton keeps how rows of the power structure are combined."""
    held_jump: int
    """One more than the row of a law that is held at its jump while the others are solved for."""
    takes_rounding: bool
    """Whether shorter steps may end where no part of one helps if all laws hold to rounding."""
    met_rounding: bool
    """Whether some have ended there, in vain if they may not."""
    residual: Block
    residual_before: Block
    residual_size: Block
    """The sizes of the terms of each residual, to first order."""
    w_size: Floats
    """The sizes of the terms of each bond variable, by which residuals are measured."""
    kind_reach: Floats
    w_reach: Floats
    """The largest bond variable of its kind: what it is solved beside."""
    residual_reach: Block
    """The same of a row: what rounding of a solution is measured by."""
    lost: float
    """The part of a law that rounding of what was eliminated hides, where it was put back last."""
    lost_at: Floats
    """The bond variables there, if it is more than `put_back.HIDDEN`."""
    over: float
    """By what a rate that was summed with twice the digits is more than it was rounded to,
    and the size of its terms."""
    over_size: float
    row_known: float
    row_hidden: float
    """Of a row: the terms that have digits, and what rounding may be of all of them."""
    aid: float
    """A resistance beside each law, on the way from linear laws to the given ones; 0: none."""
    step: Block
    # free directions: a matrix reduced, its scales, which row determines each unknown
    reduced: Block
    reduced_size: Block
    row_scale: Block
    column_scale: Block
    across: Block
    down: Block
    pivot_row: Places
    row_taken: Places
    bends: bool
    """Whether the laws of the mode whose system is there bend."""
    reluctant: Ints
    """Of each free unknown of the mode whose system is there: whether a bent law reads it."""
    moved: Block
    """Bond variables, moved to see whether laws still hold; and where they begin."""
    begun: Block
    led: Block
    led_from: Block
    led_by: Block
    onto: Block
    left: Block
    left_before: Block
    refrozen: Block
    held: Block
    """Where rows that were held have led."""
    reach_free: Block
    reach_slope: Block
    reach_rest: Block
    reach_step: Block
    """What the power structure leaves free where its rows hold, slopes, what is left, a step."""
    known: Block
    rate_part: Block
    row: Block
    a: Block
    b: Block
    c: Block
    pivots: Places
    single: Places
    column: Places
    svd: Svd
    columns: Ints
    # entering a mode: constraints, their residuals, what was before
    constraints: int
    lefts: int
    origin: float
    """Whether energy is counted from what a storage starts with: 1, or from zero: 0."""
    counted: bool
    """Whether the energy of anything was counted; ..."""
    counted_x: Floats
    counted_energy: float
    """... of what is stored, the last time, and how much it was, J, ..."""
    counted_of: Floats
    """... in each storage; of several that bend together in the first."""
    linear_of: Floats
    """The same of those whose laws are linear, of what was looked at last."""
    part_here: Floats
    part_tried: Floats
    part_root: Floats
    """Room for a number of each part of the graph, and for others; ..."""
    fading_most: Floats
    fading_here: Floats
    lately_energy: Floats
    """... what tolerances are measured by there, J; ..."""
    part_still: Ints
    """... whether nothing has been stored there yet, or nothing pushes; ..."""
    part_number: Ints
    """... a number, and of each storage the part that it comes to."""
    new_part: Ints
    base_root: Ints
    base_part: Ints
    """Of each of those parts that hang together however machines switch: what stands for the one
    that it is in, and the number of that."""
    gap: Block
    gap_size: Block
    gap_first: Block
    gap_before: Block
    missing: float
    """What the constraints of a jump lacked at first, as a part of their terms."""
    nu_found: Block
    nu_led: Block
    pushed: Block
    slope_alone: Block
    tried: Block
    base_gap: Block
    scaled: Block
    row_size: Block
    left_gap: Block
    left_area: Block
    free_seen: Block
    nearest: Block
    farthest: Block
    between: Block
    co_energy: Block
    """What laws of storages give before a difference is taken."""
    extents: Block
    """How much each storage may hold."""
    column_size: Block
    separate: Separate
    factoring: Factoring
    newton_factors: SparseLu
    newton_order: bool
    """Whether an order is known in which Newton's slopes can be factored."""
    newton_moved: bool
    cluster: Cluster
    sides: Block
    """Of a sparse jump: what its equations come to, ..."""
    found: Block
    """... and its unknowns; ..."""
    sent: Block
    """... and of these the impulses that are free."""
    two_port: Block
    by_stored: Block
    seen_by: Block
    nu: Block
    combined: Block
    kept: Floats
    met: Ints
    reach: Floats
    as_ever: Floats
    reach_before: Floats
    known_size: Floats
    here: Floats
    ahead: Floats
    landed: Floats
    beside: Floats
    leakage: Leakage
    ways: Ways
    """Impulses that contacts at rest allow."""
    following: Following
    generic: Floats
    values: Floats
    """Values to try something with."""
    stack: Stack


def make_work(m: Model) -> Work:
    """Return the room that a run works in."""
    w = Work()
    n = 2 * m.bonds
    knowns = m.storages + 2 * m.most_sources
    w.power = make_elimination(n, n + knowns)
    w.finite = make_elimination(n, n + knowns)
    w.built = w.power
    w.table = make_elimination(m.storages, knowns)
    w.plain = make_rows()
    w.steady = make_elimination(n, n + knowns)
    w.steady_table = make_elimination(m.storages, knowns)
    w.at_start = floats(2 * m.slots)
    w.timed = floats(2 * m.sources)
    w.timed_at = floats(2 * m.sources)
    for k in range(2 * m.sources):
        w.timed_at[k] = math.nan
    w.told = ints(m.storages)
    w.wide = ints(m.junctions)
    # one row for each end of a bond: not more can be left over
    w.agreement_first = ints(n + 1)
    w.agreement_column = ints(n * 2 * m.most_sources)
    w.agreement_value = floats(n * 2 * m.most_sources)
    w.xi = floats(knowns)
    w.w = floats(n)
    w.base = floats(n)
    w.f = floats(m.most_dynamic + m.storages)
    w.sizes = floats(n)
    w.base_size = floats(n)
    w.guess = make_block(1)
    w.found_apart = make_block(1)
    w.kept_guess = make_block(1)
    w.kept_bonds = floats(n)
    w.freedom = make_block(1)
    w.terms = floats(m.slots)
    w.slopes = make_block(1)
    w.frozen = make_block(1)
    w.jacobian = make_block(1)
    w.jacobian2 = make_block(1)
    w.seen_slopes = make_block(1)
    w.seen_step = make_block(1)
    w.read_by_laws = make_places(1)
    w.inverse = make_block(1)
    w.whole = make_block(1)
    w.weight = make_block(1)
    w.before = make_block(1)
    w.left_over = make_block(1)
    w.trial = make_block(1)
    w.swung = make_block(1)
    w.kind_beside = floats(max(m.classes, 1))
    w.kept_at_corner = make_places(1)
    w.slopes_there = make_block(1)
    w.rounded = make_block(1)
    w.residual = make_block(1)
    w.residual_before = make_block(1)
    w.residual_size = make_block(1)
    w.w_size = floats(n)
    w.kind_reach = floats(max(m.classes, 1))
    w.w_reach = floats(n)
    w.lost_at = floats(n)
    w.residual_reach = make_block(1)
    w.step = make_block(1)
    w.reduced = make_block(1)
    w.reduced_size = make_block(1)
    w.row_scale = make_block(1)
    w.column_scale = make_block(1)
    w.across = make_block(1)
    w.down = make_block(1)
    w.pivot_row = make_places(1)
    w.row_taken = make_places(1)
    w.reluctant = ints(n)
    w.moved = make_block(1)
    w.begun = make_block(1)
    w.led = make_block(1)
    w.led_from = make_block(1)
    w.led_by = make_block(1)
    w.onto = make_block(1)
    w.left = make_block(1)
    w.left_before = make_block(1)
    w.refrozen = make_block(1)
    w.held = make_block(1)
    w.reach_free = make_block(1)
    w.reach_slope = make_block(1)
    w.reach_rest = make_block(1)
    w.reach_step = make_block(1)
    w.known = make_block(1)
    w.rate_part = make_block(1)
    w.row = make_block(1)
    w.a = make_block(1)
    w.b = make_block(1)
    w.c = make_block(1)
    w.pivots = make_places(1)
    w.single = make_places(1)
    w.column = make_places(1)
    w.svd = make_svd(8, 8)
    w.columns = ints(n)
    w.gap = make_block(1)
    w.gap_size = make_block(1)
    w.gap_first = make_block(1)
    w.gap_before = make_block(1)
    w.nu_found = make_block(1)
    w.nu_led = make_block(1)
    w.pushed = make_block(1)
    w.slope_alone = make_block(1)
    w.tried = make_block(1)
    w.base_gap = make_block(1)
    w.scaled = make_block(1)
    w.row_size = make_block(1)
    w.left_gap = make_block(1)
    w.left_area = make_block(1)
    w.free_seen = make_block(1)
    w.nearest = make_block(1)
    w.farthest = make_block(1)
    w.between = make_block(1)
    w.co_energy = make_block(1)
    w.extents = make_block(1)
    w.column_size = make_block(1)
    w.separate = make_separate()
    w.factoring = make_factoring()
    w.newton_factors = make_sparse_lu()
    w.cluster = make_cluster(m.storages)
    w.sides = make_block(1)
    w.found = make_block(1)
    w.sent = make_block(1)
    w.two_port = make_block(1)
    w.by_stored = make_block(1)
    w.seen_by = make_block(1)
    w.nu = make_block(1)
    w.combined = make_block(1)
    w.kept = floats(n)
    w.reach = floats(m.storages)
    w.as_ever = floats(m.storages)
    w.met = ints(m.storages + 2 * m.most_sources)
    w.reach_before = floats(m.storages)
    w.known_size = floats(knowns)
    w.counted_x = floats(m.storages)
    w.counted_of = floats(m.storages)
    w.linear_of = floats(m.storages)
    w.part_here = floats(m.storages + 1)
    w.part_tried = floats(m.storages + 1)
    w.part_root = floats(m.storages + 1)
    w.fading_most = floats(m.storages)
    w.fading_here = floats(m.storages)
    w.lately_energy = floats(m.storages + 1)
    w.part_still = ints(m.storages + 1)
    w.part_number = ints(m.storages + 1)
    w.new_part = ints(m.storages)
    w.base_root = ints(m.bases)
    w.base_part = ints(m.bases)
    w.here = floats(m.storages)
    w.ahead = floats(m.storages)
    w.landed = floats(m.storages)
    w.beside = floats(m.storages)
    w.leakage = make_leakage()
    w.ways = make_ways()
    w.following = make_following()
    w.generic = floats(2 * m.slots)
    w.values = floats(2 * m.slots)
    w.stack = make_stack()
    return w
