"""How the laws of junctions take part in a complementarity problem, and room to solve it.

Given ``w = M l + q``, each port takes part in one of these ways:

ONE_SIDED    ``0 <= l``, ``w + shift >= 0``, one of them zero
TWO_SIDED    the net variable in ``limit * Sgn(common variable)``: dry friction
CUT          ``l = 0``: OFF, where `l` is the common variable
SHUT         ``w = 0``, `l` of either sign: OFF, where `w` is the common variable
FORWARD      friction that surely slides forward: ``net = limit``; `l` is the net variable
BACKWARD     the same, backward
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.svd import Svd, make_svd
from hybond.engine.complementarity.branch_records import (
    ANSWERS_KEPT,
    Branching,
    make_branching,
)
from hybond.engine.complementarity.lcp import Lcp, make_lcp
from hybond.engine.complementarity.lcp_forms import Mixed, make_mixed
from hybond.engine.words import Floats, Ints, floats, ints, record

ONE_SIDED: Final = 0
TWO_SIDED: Final = 1
CUT: Final = 2
SHUT: Final = 3
FORWARD: Final = 4
BACKWARD: Final = 5


@record
class LawProblem:
    """A problem of up to `most` ports, and what the laws do.

    `common` says whether `l` is the common variable of the port's junction, else it is minus the
    net variable. Friction of port k is at most ``limit[k] + slope[k] l``, a row of `slope`. The
    answer is `l`; `branch`, which is 0 OFF or at rest, 1 ON or forward, -1 backward; and `open`,
    where both variables of a pair are zero, `doubtful` if some nearly are. The rest is room to work
    in.

    `rank` is the place of each port's law by name. Of what was asked last, `proved` says that there
    is no answer, `answers` how many there are of laws that have several, else 1, `more_answers`
    that these are not all, `answer_way` their branches (NOT_OF_PART for other laws), the answer
    taken first, and `answer_why` why it was taken.
    """

    n: int
    m: Floats
    q: Floats
    role: Ints
    common: Ints
    noise: Floats
    """By how much each `q` may be off: rounding of what it is a difference of."""
    shifted: bool
    shift: Floats
    limit: Floats
    slope: Floats
    sloped: Ints
    l: Floats
    branch: Ints
    open: Ints
    doubtful: bool
    moved: Floats
    rank: Ints
    proved: bool
    answers: int
    more_answers: bool
    answer_why: int
    answer_way: Ints
    branching: Branching

    lcp: Lcp
    mixed: Mixed
    svd: Svd
    who: Ints
    own: Floats
    own_q: Floats
    guess: Ints
    z: Floats
    active: Ints
    left: Ints
    held: Ints
    free: Ints
    block: Floats
    fixed: Floats
    into: Floats
    kept: Floats
    pivot: Ints
    inner: Floats
    rest: Floats
    inner_role: Ints
    inner_common: Ints
    inner_start: Ints
    inner_l: Floats
    inner_branch: Ints
    inner_open: Ints
    sub: Floats
    sub_q: Floats
    sub_start: Ints
    pair_of: Ints
    pair_way: Ints
    place: Ints


def make_law_problem(n: int) -> LawProblem:
    """Return room for n ports."""
    p = LawProblem()
    p.m = floats(n * n)
    p.q = floats(n)
    p.role = ints(n)
    p.common = ints(n)
    p.noise = floats(n)
    p.shift = floats(n)
    p.limit = floats(n)
    p.slope = floats(n * n)
    p.sloped = ints(n)
    p.l = floats(n)
    p.branch = ints(n)
    p.open = ints(n)
    p.moved = floats(n)
    p.rank = ints(n)
    p.answer_way = ints(ANSWERS_KEPT * n)
    p.branching = make_branching(n)
    p.lcp = make_lcp(n)
    p.mixed = make_mixed(2 * n, n)
    p.svd = make_svd(n, n)
    p.who = ints(n)
    p.own = floats(n * n)
    p.own_q = floats(n)
    p.guess = ints(2 * n)
    p.z = floats(n)
    p.active = ints(n)
    p.left = ints(n)
    p.held = ints(n)
    p.free = ints(n)
    p.block = floats(n * n)
    p.fixed = floats(n * (n + 1))
    p.into = floats(n * (n + 1))
    p.kept = floats(n * (n + 1))
    p.pivot = ints(n)
    p.inner = floats(n * n)
    p.rest = floats(n)
    p.inner_role = ints(n)
    p.inner_common = ints(n)
    p.inner_start = ints(n)
    p.inner_l = floats(n)
    p.inner_branch = ints(n)
    p.inner_open = ints(n)
    p.sub = floats(n * n)
    p.sub_q = floats(n)
    p.sub_start = ints(n)
    p.pair_of = ints(2 * n)
    p.pair_way = ints(2 * n)
    p.place = ints(2 * n)
    return p
