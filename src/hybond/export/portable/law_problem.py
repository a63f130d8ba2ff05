"""The laws of junctions, all at once, as one mixed linear complementarity problem.

Given ``w = M l + q``, each port takes part in one of these ways:

ONE_SIDED    ``0 <= l``, ``w + shift >= 0``, one of them zero
TWO_SIDED    the net variable in ``limit * Sgn(common variable)``: dry friction
CUT          ``l = 0``: OFF, where `l` is the common variable
SHUT         ``w = 0``, `l` of either sign: OFF, where `w` is the common variable
FORWARD      friction that surely slides forward: ``net = limit``; `l` is the net variable
BACKWARD     the same, backward

The limit of friction may be affine in `l`. As modes.laws.problem. Source: V. Acary, B. Brogliato,
*Numerical Methods for Nonsmooth Dynamical Systems*, Springer 2008, chapters 10 and 12.
"""

import math
from typing import Final

from hybond.export.portable.lcp import SOLVED, Lcp, make_lcp
from hybond.export.portable.lcp_forms import Mixed, make_mixed, solve_mixed
from hybond.export.portable.lemke import lemke
from hybond.export.portable.lu import SINGULAR, lu_factor, lu_solve
from hybond.export.portable.svd import Svd, least_squares, make_svd, rank_above, svd
from hybond.export.portable.words import Floats, Ints, floats, ints, record

ONE_SIDED: Final = 0
TWO_SIDED: Final = 1
CUT: Final = 2
SHUT: Final = 3
FORWARD: Final = 4
BACKWARD: Final = 5

CLEAR_PART: Final = 1e-6
"""Part of the largest of its kind from which a value is positive beyond doubt."""
LEVELS: Final = 4
"""Orders of magnitude at which pairs that are zero on both sides are looked at again."""
LEAST_SCALE: Final = 2.2250738585072014e-308


@record
class LawProblem:
    """A problem of up to `most` ports, and what the laws do.

    `common` says whether `l` is the common variable of the port's junction, else it is minus the
    net variable. Friction of port k is at most ``limit[k] + slope[k] l``, a row of `slope`. The
    answer is `l`; `branch`, which is 0 OFF or at rest, 1 ON or forward, -1 backward; and `open`,
    where both variables of a pair are zero. The rest is room to work in.
    """

    most: int
    n: int
    m: Floats
    q: Floats
    role: Ints
    common: Ints
    shifted: bool
    shift: Floats
    limit: Floats
    slope: Floats
    l: Floats
    branch: Ints
    open: Ints
    moved: Floats

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
    p.most = n
    p.m = floats(n * n)
    p.q = floats(n)
    p.role = ints(n)
    p.common = ints(n)
    p.shift = floats(n)
    p.limit = floats(n)
    p.slope = floats(n * n)
    p.l = floats(n)
    p.branch = ints(n)
    p.open = ints(n)
    p.moved = floats(n)
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


def solve_laws(p: LawProblem, start: Ints) -> bool:
    """Find what the laws of all ports do together; False if nothing was found.

    `start` is a guess of the branches. As modes.laws.problem.solve_laws.
    """
    n = p.n
    holds_any = False
    rubs = False
    for k in range(n):
        p.moved[k] = p.q[k] + p.shift[k] if p.shifted else p.q[k]
        p.l[k] = 0.0
        p.branch[k] = 0
        p.open[k] = 0
        if p.role[k] == SHUT:
            holds_any = True
        if p.role[k] == TWO_SIDED or p.role[k] >= FORWARD:
            rubs = True
    if rubs:
        return solve_with_friction(p, p.moved, start)
    if holds_any:
        for k in range(n):
            p.q[k] = p.moved[k]
        return solve_without_held(p, start)
    return solve_one_sided(p, n, p.m, p.moved, p.role, p.common, start, p.l, p.branch, p.open)


def solve_one_sided(
    p: LawProblem,
    n: int,
    m: Floats,
    q: Floats,
    role: Ints,
    common: Ints,
    start: Ints,
    l: Floats,
    branch: Ints,
    open: Ints,
) -> bool:
    """Solve where all laws are one-sided, or cut. As modes.laws.problem._one_sided."""
    many = 0
    for k in range(n):
        l[k] = 0.0
        branch[k] = 0
        open[k] = 0
        if role[k] == ONE_SIDED:
            p.who[many] = k
            many += 1
    if many == 0:
        return True
    for i in range(many):
        one = p.who[i]
        p.guess[i] = 1 if (start[one] == 1) == (common[one] != 0) else 0
        p.own_q[i] = q[one]
        for j in range(many):
            p.own[i * many + j] = m[one * n + p.who[j]]
    if as_before(p, many):
        for i in range(many):
            one = p.who[i]
            l[one] = p.z[i]
            branch[one] = 1 if (p.guess[i] != 0) == (common[one] != 0) else 0
        return True
    if not by_levels(p, many):
        return False
    for i in range(many):
        one = p.who[i]
        l[one] = p.z[i]
        branch[one] = 1 if (p.active[i] != 0) == (common[one] != 0) else 0
        open[one] = p.left[i]
    return True


def as_before(p: LawProblem, n: int) -> bool:
    """Whether the guessed active set clearly is the solution, which is p.z then.

    As modes.laws.problem._as_before.
    """
    many = 0
    for k in range(n):
        p.z[k] = 0.0
        if p.guess[k] != 0:
            p.active[many] = k
            many += 1
    for i in range(many):
        p.sub_q[i] = -p.own_q[p.active[i]]
        for j in range(many):
            p.block[i * many + j] = p.own[p.active[i] * n + p.active[j]]
    if many > 0:
        if lu_factor(many, p.block, p.pivot) == SINGULAR:
            return False
        lu_solve(many, p.block, p.pivot, 1, p.sub_q)
    most = 0.0
    for i in range(many):
        p.z[p.active[i]] = p.sub_q[i]
        if not p.sub_q[i] <= most:
            most = p.sub_q[i]
    size = 0.0
    for i in range(n):
        total = 0.0
        terms = 0.0
        for j in range(n):
            total += p.own[i * n + j] * p.z[j]
            terms += math.fabs(p.own[i * n + j]) * p.z[j]
        p.sub_q[i] = total + p.own_q[i]
        size = max(size, terms + math.fabs(p.own_q[i]))
    clear = True
    for k in range(n):
        if p.guess[k] != 0:
            clear = clear and p.z[k] > CLEAR_PART * most
        else:
            clear = clear and p.sub_q[k] > CLEAR_PART * size
    return clear


def by_levels(p: LawProblem, n: int) -> bool:
    """Solve ``0 <= l``, ``q + m l >= 0``, one of them zero, level by level of magnitude.

    Pairs that are zero on both sides, measured by the largest of them, are decided by what is left
    of q once the others are: a current that passes through zero while others flow. The answer is
    p.z, p.active, and what stays open at every level in p.left. As modes.laws.problem._by_levels.
    """
    if lemke(p.lcp, n, p.own, p.own_q, p.guess) != SOLVED:
        return False
    several = 0
    for k in range(n):
        p.z[k] = p.lcp.z[k]
        p.active[k] = p.lcp.active[k]
        p.left[k] = p.lcp.open[k]
        several += p.left[k]
    level = 0
    while level < LEVELS and several > 0:
        level += 1
        if not finer_level(p, n, several):
            break
        still = 0
        i = 0
        for k in range(n):
            if p.left[k] != 0:
                p.active[k] = p.lcp.active[i]
                p.left[k] = p.lcp.open[i]
                still += p.left[k]
                i += 1
        if still == several:
            break
        several = still
    return True


def finer_level(p: LawProblem, n: int, several: int) -> bool:
    """Solve for the pairs in p.left with what the others leave of q; False if nothing is left."""
    wide = several + 1
    sure = 0
    left = 0
    for k in range(n):
        if p.left[k] != 0:
            p.free[left] = k
            left += 1
        elif p.active[k] != 0:
            p.held[sure] = k
            sure += 1
    for i in range(sure):
        for j in range(sure):
            p.block[i * sure + j] = p.own[p.held[i] * n + p.held[j]]
        for j in range(several):
            p.fixed[i * wide + j] = p.own[p.held[i] * n + p.free[j]]
        p.fixed[i * wide + several] = p.own_q[p.held[i]]
    if sure > 0:
        least_squares(p.svd, sure, sure, p.block, -1.0, wide, p.fixed, p.into)
    most = 0.0
    for i in range(several):
        one = p.free[i]
        for j in range(wide):
            total = 0.0
            for s in range(sure):
                total += p.own[one * n + p.held[s]] * p.into[s * wide + j]
            if j < several:
                p.sub[i * several + j] = p.own[one * n + p.free[j]] - total
            else:
                p.sub_q[i] = p.own_q[one] - total
        most = max(most, math.fabs(p.sub_q[i]))
        p.sub_start[i] = p.guess[one]
    if most == 0.0:
        return False
    for i in range(several):
        p.sub_q[i] /= most
    return lemke(p.lcp, several, p.sub, p.sub_q, p.sub_start) == SOLVED


def solve_without_held(p: LawProblem, start: Ints) -> bool:
    """Put in the `l` that hold ``w = 0``, and solve for the others.

    As modes.laws.problem._without_held.
    """
    n = p.n
    many = 0
    free = 0
    for k in range(n):
        if p.role[k] == SHUT:
            p.held[many] = k
            many += 1
        else:
            p.free[free] = k
            free += 1
    for i in range(many):
        a = held_scale(p, p.held[i])
        for j in range(many):
            entry = p.m[p.held[i] * n + p.held[j]]
            p.block[i * many + j] = entry / held_scale(p, p.held[j]) / a
    svd(p.svd, many, many, p.block)
    if rank_above(p.svd, many, 1e-9) < many:
        # what is held depends on the others, not on its own l alone
        return solve_with_friction(p, p.q, start)
    wide = free + 1
    for i in range(many):
        one = p.held[i]
        for j in range(many):
            p.block[i * many + j] = p.m[one * n + p.held[j]]
        for j in range(free):
            p.fixed[i * wide + j] = p.m[one * n + p.free[j]]
        p.fixed[i * wide + free] = p.q[one]
    least_squares(p.svd, many, many, p.block, -1.0, wide, p.fixed, p.into)
    for i in range(free):
        one = p.free[i]
        for j in range(wide):
            total = 0.0
            for s in range(many):
                total += p.m[one * n + p.held[s]] * p.into[s * wide + j]
            if j < free:
                p.inner[i * free + j] = p.m[one * n + p.free[j]] - total
            else:
                p.rest[i] = p.q[one] - total
        p.inner_role[i] = p.role[one]
        p.inner_common[i] = p.common[one]
        p.inner_start[i] = start[one]
        # solve_one_sided lists pairs in the same places
        p.place[i] = one
    for i in range(many):
        p.place[free + i] = p.held[i]
    for k in range(many * wide):
        p.kept[k] = p.into[k]
    if not inner_solved(p, free):
        return False
    for i in range(free):
        one = p.place[i]
        p.l[one] = p.inner_l[i]
        p.branch[one] = p.inner_branch[i]
        p.open[one] = p.inner_open[i]
    for i in range(many):
        total = 0.0
        for j in range(free):
            total += p.kept[i * wide + j] * p.inner_l[j]
        p.l[p.place[free + i]] = -(total + p.kept[i * wide + free])
    return True


def inner_solved(p: LawProblem, free: int) -> bool:
    """Solve for the ports that are not held."""
    return solve_one_sided(
        p,
        free,
        p.inner,
        p.rest,
        p.inner_role,
        p.inner_common,
        p.inner_start,
        p.inner_l,
        p.inner_branch,
        p.inner_open,
    )


def held_scale(p: LawProblem, k: int) -> float:
    """Return the square root of what a port feels of itself."""
    return math.sqrt(max(math.fabs(p.m[k * p.n + k]), LEAST_SCALE))


def solve_with_friction(p: LawProblem, moved: Floats, start: Ints) -> bool:
    """Write the laws as rows ``A a + B b + C l = d`` with ``a, b >= 0`` and ``a b = 0``; solve.

    As modes.laws.problem._mixed.
    """
    n = p.n
    pairs = 0
    for k in range(n):
        if p.role[k] == ONE_SIDED:
            p.pair_of[pairs] = k
            p.pair_way[pairs] = 0
            pairs += 1
        elif p.role[k] == TWO_SIDED:
            p.pair_of[pairs] = k
            p.pair_way[pairs] = 1
            p.pair_of[pairs + 1] = k
            p.pair_way[pairs + 1] = -1
            pairs += 2
    x = p.mixed
    rows = pairs + n
    wide = 2 * pairs + n
    for k in range(rows * wide):
        x.whole[k] = 0.0
    for k in range(rows):
        x.right[k] = 0.0
    row = 0
    pair = 0
    for k in range(n):
        at = row * wide + 2 * pairs
        role = p.role[k]
        own = p.m[k * n + k]
        if role == CUT:
            x.whole[at + k] = 1.0
            row += 1
        elif role == SHUT:
            for j in range(n):
                x.whole[at + j] = p.m[k * n + j]
            x.right[row] = -p.q[k]
            row += 1
        elif role >= FORWARD:
            way = 1.0 if role == FORWARD else -1.0
            for j in range(n):
                x.whole[at + j] = way * p.slope[k * n + j]
            x.whole[at + k] += 1.0
            x.right[row] = -way * p.limit[k]
            row += 1
        elif role == ONE_SIDED:
            per = 1.0 / own if own > 0.0 else 1.0
            x.whole[row * wide + pair] = 1.0
            x.whole[at + k] = -1.0
            x.whole[(row + 1) * wide + pairs + pair] = 1.0
            for j in range(n):
                x.whole[at + wide + j] = -p.m[k * n + j] * per
            x.right[row + 1] = moved[k] * per
            row += 2
            pair += 1
        else:
            give_friction(p, k, row, pair, pairs)
            row += 3
            pair += 2
    for i in range(pairs):
        one = p.pair_of[i]
        if p.pair_way[i] != 0:
            p.guess[i] = 1 if start[one] == p.pair_way[i] else 0
        else:
            p.guess[i] = 1 if (start[one] == 1) == (p.common[one] != 0) else 0
    if solve_mixed(x, pairs, n, p.guess, True) != SOLVED:
        return False
    for k in range(n):
        p.l[k] = x.c[k]
        p.open[k] = 0
        p.branch[k] = 1 if p.role[k] == FORWARD else -1 if p.role[k] == BACKWARD else 0
    for i in range(pairs):
        one = p.pair_of[i]
        if p.pair_way[i] == 0:
            p.branch[one] = 1 if (x.active[i] != 0) == (p.common[one] != 0) else 0
        elif x.active[i] != 0:
            p.branch[one] = p.pair_way[i]
        if x.open[i] != 0:
            p.open[one] = 1
    return True


def give_friction(p: LawProblem, k: int, row: int, pair: int, pairs: int) -> None:
    """Give the three rows of a friction law; its pairs are `pair` and the next one.

    Speeds are written as the forces that would make them: tolerances then agree.
    """
    n = p.n
    x = p.mixed
    wide = 2 * pairs + n
    at = row * wide + 2 * pairs
    own = p.m[k * n + k]
    is_common = p.common[k] != 0
    per = 1.0
    if own > 0.0:
        per = own if is_common else 1.0 / own
    held = -p.q[k] if is_common else 0.0
    x.whole[row * wide + pair] = 1.0
    x.whole[row * wide + pair + 1] = -1.0
    x.whole[(row + 1) * wide + pairs + pair] = 1.0
    x.whole[(row + 2) * wide + pairs + pair + 1] = 1.0
    for j in range(n):
        unit = 1.0 if j == k else 0.0
        speed = unit if is_common else p.m[k * n + j]
        force = -p.m[k * n + j] if is_common else -unit
        slope = p.slope[k * n + j]
        x.whole[at + j] = -speed * per
        x.whole[at + wide + j] = force - slope
        x.whole[at + 2 * wide + j] = -force - slope
    x.right[row] = 0.0 if is_common else p.q[k] * per
    x.right[row + 1] = p.limit[k] - held
    x.right[row + 2] = p.limit[k] + held
