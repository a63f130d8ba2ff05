"""What a run keeps of the modes that it propagates exactly."""

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
from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, Records, floats, ints, record, records

LARGE: Final = 400
"""States beyond which full matrices are too much for what chooses by itself."""
NO_FLOW: Final = -1
FIRST_FLOWS: Final = 64
"""There is room for at first."""
ROOM: Final = 4194304
"""Numbers that the exponentials of all flows may take, about: of large modes fewer are kept."""
LEVELS: Final = 180
PARTS: Final = 5
"""Parts of a step in which its dense output is made from."""
TERMS: Final = 24
"""Terms of a series; in one unit of time they fall below rounding before."""
ORDERS: Final = 7
"""Derivatives that choose the first step."""


@record
class Flow:
    """The motion of a mode, ``z' = matrix z``: z is the state, then generators.

    In units in which the matrix is balanced, ``z = scale b``. Level k is the exponential for
    ``2^k`` units of time less the identity, made when it is needed.
    """

    owner: int
    """The place of its mode among those kept."""
    n: int
    gens: int
    gen: Ints
    """The generators that z ends with."""
    rows: Rows
    own: Rows
    """The same in coordinates in which slow motions are slow by themselves: these rows, or where
    there are fast ones beside them `apart`."""
    apart: Rows
    shares: int
    """Those coordinates are z but that one after the other a `share` of `row` is taken off `other`.
    """
    row: Places
    other: Places
    share: Block
    share_rest: Block
    """By what each share is more than it was rounded to."""
    standing: Places
    pivoted: Places
    scale: Block
    norm: float
    unit: float
    """A power of two, s; the norm of the matrix times it is at most 1. Infinite if that is zero."""
    levels: int
    level: Records[Block]
    watches: int
    watched: Places
    """Places in z of generators that are no polynomials of time: steps must resolve them."""


@record
class Exact:
    """The flows of a run, and room to work in."""

    on: bool
    """Whether the present mode is propagated."""
    flow: Flow
    flows: Records[Flow]
    places: int
    """For so many there is room, and so many are made."""
    made: int
    used: Ints
    """When each was used last, by `clock`."""
    clock: int
    found: Ints
    """Modes that are propagated, then those that are not, by the number of the reason; then
    motions along surfaces."""
    slid: Ints
    alongs: int
    along: Ints
    """Of each state: whether it is integrated along the others."""
    dense: Block
    rest: Block
    """By what its entries are more than they were rounded to."""
    largest: Block
    total: float
    """A sum with twice the digits: this and `over`."""
    over: float
    row: Floats
    place: Ints
    """Of each generator: its place in z, or -1."""
    left: Places
    """Of each row of a mode that is evaluated: whether it is not linear, or hangs together with
    one; `open` of each free unknown, whether such a row determines it."""
    open: Places
    touched: Block
    r: Block
    power: Block
    b: Block
    b2: Block
    terms: Block
    parts: Block
    """z at all parts of a step."""
    shared: Block
    """How large, in units of the flow, what each component of z is a sum or difference of was in a
    step, where others were taken off it."""
    rates: Floats
    """The rate of the state there."""
    y: Floats
    rate: Floats
    amplitude: Block
    """The largest value that each watched generator had since the start."""
    size: Block
    off: Block


def make_flow(m: Model) -> Flow:
    """Return room for the motion of a mode."""
    f = Flow()
    f.owner = NO_FLOW
    f.gen = ints(m.generators)
    f.rows = make_rows()
    f.own = f.rows
    f.apart = make_rows()
    f.row = make_places(1)
    f.other = make_places(1)
    f.share = make_block(1)
    f.share_rest = make_block(1)
    f.standing = make_places(1)
    f.pivoted = make_places(1)
    f.scale = make_block(1)
    f.level = records(Block, LEVELS)
    f.watched = make_places(1)
    return f


def make_exact(m: Model) -> Exact:
    """Return room for a run that propagates modes."""
    x = Exact()
    n = m.storages + m.integrals
    most = n + m.generators
    x.flows = records(Flow, FIRST_FLOWS)
    x.used = ints(FIRST_FLOWS)
    x.places = FIRST_FLOWS
    x.found = ints(m.reasons + 2)
    x.slid = ints(m.surfaces)
    x.along = ints(n)
    first = 2 * m.sources + m.dynamics
    for k in range(m.integrals):
        if m.form_why[first + k] >= 0:
            x.along[m.storages + k] = 1
            x.alongs += 1
    x.dense = make_block(1)
    x.rest = make_block(1)
    x.largest = make_block(1)
    x.row = floats(2 * m.bonds + most)
    x.place = ints(m.generators)
    x.left = make_places(1)
    x.open = make_places(1)
    x.touched = make_block(1)
    x.r = make_block(1)
    x.power = make_block(1)
    x.b = make_block(most)
    x.b2 = make_block(most)
    x.terms = make_block(TERMS * most)
    x.parts = make_block((PARTS + 1) * most)
    x.shared = make_block(1)
    x.rates = floats((PARTS + 1) * n)
    x.y = floats(n)
    x.rate = floats(n)
    x.amplitude = make_block(most)
    x.size = make_block(most)
    x.off = make_block(most)
    return x
