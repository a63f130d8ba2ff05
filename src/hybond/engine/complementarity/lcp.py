"""The record of a linear complementarity problem: ``z >= 0, w = M z + q >= 0, z w = 0``."""

from typing import Final

from hybond.engine.words import Floats, Ints, floats, ints, record

SOLVED: Final = 0
ON_A_RAY: Final = 1
"""The path ended on a secondary ray."""
TOO_MANY_PIVOTS: Final = 2
"""Too many pivots."""
NO_CHOICE: Final = 3
"""No choice of one unknown of each pair leaves a regular matrix."""


@record
class Lcp:
    """Room for a problem of up to `most` pairs, and its answer.

    `active` says of each pair whether its z is basic, `open` whether both z and w are zero, and
    `proved` whether a path ended on a ray that proves that there is no solution. The rest is room
    to work in: the scaled problem, Lemke's table, blocks of chosen pairs.
    """

    z: Floats
    w: Floats
    active: Ints
    open: Ints
    pivots: int
    proved: bool
    matrix: Floats
    q: Floats
    d: Floats
    size: float
    pivoted: Floats
    constant: Floats
    table: Floats
    column: Floats
    line: Floats
    basic: Ints
    beside: Ints
    place: Ints
    rows: Ints
    fall: Floats
    ratio: Floats
    path: Ints
    ray: Floats
    on: Ints
    off: Ints
    block: Floats
    inverse: Floats
    right: Floats
    pivot: Ints


def make_lcp(n: int) -> Lcp:
    """Return room for problems of up to n pairs."""
    p = Lcp()
    p.z = floats(n)
    p.w = floats(n)
    p.active = ints(n)
    p.open = ints(n)
    p.matrix = floats(n * n)
    p.q = floats(n)
    p.d = floats(n)
    p.pivoted = floats(n * n)
    p.constant = floats(n)
    p.table = floats(n * (n + 2))
    p.column = floats(n + 2)
    p.line = floats(n + 2)
    p.basic = ints(n)
    p.beside = ints(n + 1)
    p.place = ints(2 * n + 1)
    p.rows = ints(n)
    p.fall = floats(n)
    p.ratio = floats(n)
    p.path = ints(n)
    p.ray = floats(2 * n + 1)
    p.on = ints(n)
    p.off = ints(n)
    p.block = floats(n * n)
    p.inverse = floats(n * n)
    p.right = floats(n)
    p.pivot = ints(n)
    return p
