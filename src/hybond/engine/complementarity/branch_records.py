"""Room to try all branches of a few laws that feel each other, and what was found."""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.least_distance import LeastDistance, make_least_distance
from hybond.engine.words import Floats, Ints, floats, ints, record

PART_PORTS: Final = 16
"""Most ports of a part whose branches are tried."""
ANSWERS_KEPT: Final = 6
"""Answers of a part that are kept."""
NOT_OF_PART: Final = 9
"""What stands for the way of a port that has no part in an answer."""


@record
class Branching:
    """A part of a problem of laws, scaled, and its answers.

    `port` are the ports of the part, `of` the part of each port of the problem. In units of the
    part, `unit` times `size` of each `l`, and its inverse of `w`, it is ``w = m l + q``, friction
    ``limit + slope l``. A way is 1 or 0, ON or OFF, of a one-sided law; 0, 1 or -1 of friction.

    `a l = right` is what one choice of ways asks for; `column` are the unknowns in the order in
    which they were solved for, `basis` what leaves the equations alone, and `g`, `floor` what is to
    be at least zero: ``g l + floor``, `slack` being what its rounding is measured by and `faint`
    what is rounding anyway, of what `q`, by `noise`, is a difference of.

    `answers` counts answers with different `w`, up to ANSWERS_KEPT; `more` says that there are
    more. Their `l`, `w`, ways and how many ways differ from the start are `kept_l`, `kept_w`,
    `kept_way` and `kept_turned`, with room for one more to be compared with them. `doubt` says
    that some choice was left out though its equations were all but singular.
    """

    of: Ints
    waiting: Ints
    n: int
    port: Ints
    m: Floats
    q: Floats
    noise: Floats
    slope: Floats
    limit: Floats
    unit: Floats
    size: float
    role: Ints
    common: Ints
    start: Ints
    rank: Ints
    turn: Ints
    way: Ints
    room: Floats
    square: Floats

    a: Floats
    right: Floats
    terms: Floats
    column: Ints
    basis: Floats
    g: Floats
    floor: Floats
    slack: Floats
    faint: Floats
    moved: Floats
    bound: Floats
    z: Floats
    l: Floats
    w: Floats
    largest: float
    distance: LeastDistance

    answers: int
    more: bool
    kept_l: Floats
    kept_w: Floats
    kept_way: Ints
    kept_turned: Ints
    doubt: bool


def make_branching(n: int) -> Branching:
    """Return room for problems of n ports."""
    b = Branching()
    b.of = ints(n)
    b.waiting = ints(n)
    k = min(n, PART_PORTS)
    rows = 4 * k
    b.port = ints(k)
    b.m = floats(k * k)
    b.q = floats(k)
    b.noise = floats(k)
    b.slope = floats(k * k)
    b.limit = floats(k)
    b.unit = floats(k)
    b.role = ints(k)
    b.common = ints(k)
    b.start = ints(k)
    b.rank = ints(k)
    b.turn = ints(k)
    b.way = ints(k)
    b.room = floats(k)
    b.square = floats(k * k)
    b.a = floats(k * k)
    b.right = floats(k)
    b.terms = floats(k)
    b.column = ints(k)
    b.basis = floats(k * k)
    b.g = floats(rows * k)
    b.floor = floats(rows)
    b.slack = floats(rows)
    b.faint = floats(rows)
    b.moved = floats(rows * k)
    b.bound = floats(rows)
    b.z = floats(k)
    b.l = floats(k)
    b.w = floats(k)
    b.distance = make_least_distance(rows, k)
    b.kept_l = floats((ANSWERS_KEPT + 1) * k)
    b.kept_w = floats((ANSWERS_KEPT + 1) * k)
    b.kept_way = ints((ANSWERS_KEPT + 1) * k)
    b.kept_turned = ints(ANSWERS_KEPT + 1)
    return b
