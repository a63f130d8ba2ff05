"""What Radau IIA keeps from step to step, and room for the step that is tried."""

import math
from typing import Final

from hybond.engine.algebra.blocks import Block, Places, make_block, make_places
from hybond.engine.algebra.lu_pair import Complex
from hybond.engine.algebra.sparse_lu import (
    Factoring,
    SparseLu,
    make_factoring,
    make_sparse_lu,
)
from hybond.engine.words import Floats, Ints, floats, ints, record

PIECES: Final = 128
"""Steps that the repetition of one may fall apart into."""
RATE_BLAMED: Final = 0
"""The rates where it starts: no factors were found."""
STAGES_BLAMED: Final = 1
"""Stages that do not converge."""
ERROR_BLAMED: Final = 2
"""Its error."""


@record
class Radau:
    """What one step leaves to the next, and room for the step that is tried.

    `matrix` says whether there is a Jacobian and whether it was made where the step starts; the
    factors are those of a step of size `served`, 0 if there are none. `polynomial`, in units of
    `span`, foresees the stages; `origin` is 1 if its step ends where the next one starts, 0 if both
    start there. Arrays of three rows hold stages: derivatives `f`, states `y`, differences `z` from
    the start, their `last` correction, coefficients of the dense output.
    """

    n: int
    matrix: int
    jacobian: Floats
    made_for: Floats
    """How large each state was taken to be when it was made."""
    served: float
    real: Floats
    real_row: Ints
    re: Floats
    im: Floats
    pair_row: Ints
    jacobian_rest: Block
    """What the Jacobian was rounded by, if `twofold_from` is finite: ..."""
    twofold_from: float
    """... the size of steps beyond which rounding of factors would tell."""
    sparse: bool
    """Whether the factors are sparse: `real_lu`, and `pair_lu` of the complex ones as twice as many
    real equations."""
    real_lu: SparseLu
    pair_lu: SparseLu
    factoring: Factoring
    twofold: bool
    """Whether the factors have twice the digits. Then `real_rest` stands beside `real`, and `pair`
    in place of the complex ones, with rates and right-hand sides rounded by so much:"""
    real_rest: Block
    pair: Block
    pair_rest: Block
    pair_pivot: Places
    f0_rest: Floats
    f0_closely: bool
    """Whether that is known where the step begins."""
    f_rest: Block
    x_rest: Block
    x_pair: Block
    x_pair_rest: Block
    left: float
    known: bool
    polynomial: Floats
    span: float
    origin: float
    h_before: float
    error_before: float
    slow: bool
    """Whether the iteration of the last step was so slow that the next makes a new Jacobian."""

    t0: float
    y0: Floats
    f0: Floats
    t1: float
    y1: Floats
    f1: Floats
    h: float
    trial: float
    """Its size before the end of time cut it."""
    next: float
    error: float
    rejected: int
    shrink: float
    f: Floats
    y: Floats
    z: Floats
    last: Floats
    vain_h: float
    vain_least: float
    """The length of the step from here of which no stages with slopes of their own were found, and
    the least part of a correction that it was asked to take; no length: none was looked for."""
    swings: bool
    """Whether they have swung about zero, which foresees nothing of the next step."""
    swung: Floats
    """The last correction of the stages, and the one before."""
    coefficients: Floats
    bent: Floats
    """How much of a quartic that is zero at the start and at all stages is in the dense output."""
    tolerance: Floats
    other: Floats
    rates_asked: bool
    """Whether something exchanges so much faster than the step lasts that rates are held too; what
    those of each storage may be off by over the step; how large what is beside each bond variable
    lately was, and whether that is known where the step begins. See `rates_in_stages`."""
    rate_may: Floats
    beside: Block
    beside_known: bool
    size: float
    rate: float
    now_left: float
    iterations: int
    shifted: Floats
    end: Floats
    begin: Floats
    """Where the step begins, while slopes are made a moment later, ..."""
    begin_rate: Floats
    begin_rest: Floats
    """... and its rates there, with what they were rounded by."""
    error_vector: Floats
    stage: Floats
    x_real: Floats
    x_re: Floats
    x_im: Floats
    number: Complex
    from_edge: bool
    """Whether the step that is tried leaves an edge."""
    whole: Block
    """All stages as one system, with the rows of its pivots; what is left of them; where they were;
    the correction after the last one."""
    part: Places
    parts: int
    taken: Ints
    """The states that it is of, and how many; which are among them."""
    stage_slopes: Block
    """Its slopes at each stage; whether its factors are sparse, and these."""
    whole_sparse: bool
    whole_lu: SparseLu
    given_whole: Block
    found_whole: Block
    delta: Floats
    """What each state is shifted by for its slopes; whether that was done with others together."""
    together: Ints
    acting_room: Places
    whole_row: Places
    left_over: Block
    kept: Block
    next_one: Block
    roots: Block  # what roots are taken of where the step begins, and the sizes of its terms
    blamed: int
    """What is to blame if the step tried is too long: see RATE_BLAMED and the like."""

    # to repeat the last step: where it started, and the memory that it was made with
    start: float
    start_y: Floats
    start_f: Floats
    again_matrix: int
    again_h_before: float
    again_error_before: float
    again_left: float
    again_span: float
    again_polynomial: Floats
    piece_z: Floats
    piece_coefficients: Floats
    """The stages of the last piece of a step that is made in pieces, and its dense output."""
    kept_jacobian: Floats
    kept_rest: Block
    kept_from: float
    made: int
    """Jacobians made so far."""
    nearer: float
    """What differences for the Jacobian are of the usual ones; when that was last in doubt."""
    doubted_at: float
    slopes_before: Block
    sided: bool
    """Whether the last one would have been another, had it not stayed on its side of a kink."""
    beyond: bool
    """Whether the attempt that was given up led to where something is not finite."""

    # dense output: of one step, or of those that its repetition took
    pieces: int
    piece_t0: Floats
    piece_t1: Floats
    piece_y0: Floats
    piece_y1: Floats
    piece_polynomial: Floats


def make_radau(n: int) -> Radau:
    """Return room for n states."""
    r = Radau()
    r.n = n
    r.jacobian = floats(n * n)
    r.made_for = floats(n)
    r.real = floats(n * n)
    r.real_row = ints(n)
    r.re = floats(n * n)
    r.im = floats(n * n)
    r.pair_row = ints(n)
    r.jacobian_rest = make_block(1)
    r.twofold_from = math.inf
    r.real_lu = make_sparse_lu()
    r.real_lu.least = 0.0
    r.pair_lu = make_sparse_lu()
    r.pair_lu.least = 0.0
    r.factoring = make_factoring()
    r.real_rest = make_block(1)
    r.pair = make_block(1)
    r.pair_rest = make_block(1)
    r.pair_pivot = make_places(1)
    r.f0_rest = floats(n)
    r.f_rest = make_block(1)
    r.x_rest = make_block(1)
    r.x_pair = make_block(1)
    r.x_pair_rest = make_block(1)
    r.left = 1.0
    r.polynomial = floats(3 * n)
    r.span = 1.0
    r.origin = 1.0
    r.y0 = floats(n)
    r.f0 = floats(n)
    r.y1 = floats(n)
    r.f1 = floats(n)
    r.f = floats(3 * n)
    r.y = floats(3 * n)
    r.z = floats(3 * n)
    r.last = floats(3 * n)
    r.swung = floats(3 * n)
    r.coefficients = floats(3 * n)
    r.bent = floats(n)
    r.tolerance = floats(n)
    r.other = floats(n)
    r.rate_may = floats(n)
    r.beside = make_block(1)
    r.shifted = floats(n)
    r.end = floats(n)
    r.begin = floats(n)
    r.begin_rate = floats(n)
    r.begin_rest = floats(n)
    r.error_vector = floats(n)
    r.stage = floats(n)
    r.x_real = floats(n)
    r.x_re = floats(n)
    r.x_im = floats(n)
    r.number = Complex()
    r.whole = make_block(1)
    r.part = make_places(n)
    r.taken = ints(n)
    r.stage_slopes = make_block(1)
    r.whole_lu = make_sparse_lu()
    r.whole_lu.least = 0.0
    r.given_whole = make_block(1)
    r.found_whole = make_block(1)
    r.delta = floats(n)
    r.together = ints(n)
    r.acting_room = make_places(1)
    r.whole_row = make_places(1)
    r.left_over = make_block(1)
    r.kept = make_block(1)
    r.next_one = make_block(1)
    r.roots = make_block(1)
    r.start_y = floats(n)
    r.start_f = floats(n)
    r.again_polynomial = floats(3 * n)
    r.piece_z = floats(3 * n)
    r.piece_coefficients = floats(3 * n)
    r.kept_jacobian = floats(n * n)
    r.nearer = 1.0
    r.doubted_at = math.nan
    r.slopes_before = make_block(1)
    r.kept_rest = make_block(1)
    r.piece_t0 = floats(PIECES)
    r.piece_t1 = floats(PIECES)
    r.piece_y0 = floats(PIECES * n)
    r.piece_y1 = floats(PIECES * n)
    r.piece_polynomial = floats(PIECES * 4 * n)
    return r
