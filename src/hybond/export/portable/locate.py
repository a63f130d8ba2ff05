"""Locating guards inside a step, on its dense output.

A guard is a level: none that leaves the current state is true when a step begins. Within a step
its comparisons are sampled; where one changes sign, or has an extremum on its way to zero, the
guard itself is asked, so that an even number of crossings or a touch is not lost. The instant found
is the first at which the guard holds, on the comparison that made it true (Illinois method),
confirmed by the test that settling applies. After modes/locate.py.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.export.portable.blend import sizes_here, solve_here
from hybond.export.portable.dopri import spacing
from hybond.export.portable.engine import OK, REFUSED, Engine, Mode, say_fault
from hybond.export.portable.in_force import is_asked
from hybond.export.portable.model import rule_text, value
from hybond.export.portable.paired import holds
from hybond.export.portable.products import times_matrix
from hybond.export.portable.stepping import between
from hybond.export.portable.svd import make_svd, pseudo_inverse
from hybond.export.portable.trial import refuse_pair, widen_sizes
from hybond.export.portable.values import set_state
from hybond.export.portable.words import Floats, Ints, float_table, floats, ints, record

SAMPLES: Final = 9
FRACTION: Final = float_table(0.0, 0.113, 0.261, 0.372, 0.5127, 0.6291, 0.7713, 0.8837, 1.0)
"""Where in a step guards are sampled: unevenly, so that no periodic signal looks constant."""
TERMS: Final = 6
GRID: Final = 65
UNRESOLVED: Final = 0.02
"""A block whose samples leave more than this part of their spread unexplained is halved."""
ROUNDED: Final = 1e-9
"""... unless that is less than this part of the largest sample."""
DEEPEST: Final = 14
"""Halvings of one step; a jump of a guard's signal is closed in on no further."""
AROUND: Final = 6
"""Grid points on either side of an extremum of the polynomial where the true one is sought."""
NEAR: Final = 0.05
"""An extremum is searched if the polynomial comes this near to zero, as a part of the spread."""
SEARCH: Final = 40
"""Most iterations of one root or extremum search."""
MOST: Final = 4000
ROUNDING: Final = 1e-13
WEIGHTS: Final = 32
"""Surfaces that may be slid on at once."""
BEYOND: Final = 1e-13
"""A weight this far beyond 0 or 1 has left."""


@record
class Instants:
    """Some instants."""

    count: int
    at: Floats


@record
class Locator:
    """The guards that may leave the current mode, and the search for the first that holds.

    `shape` has the samples of each comparison; `turn` is about where the first comparison of a
    guard changes sign.
    """

    guards: int
    rule: Ints
    atoms: int
    atom_first: Ints
    """Of each guard: its comparisons in `shape`."""
    atom: Ints
    left_over: Floats
    """Samples to what a polynomial of degree 5 does not explain of them."""
    fine: Floats
    """Samples to that polynomial on a fine grid."""
    rounded: bool
    """Whether a guard leaves as soon as it holds with rounding counted as zero."""
    failed: bool
    t: Floats
    low: Floats
    high: Floats
    depth: Ints
    shape: Floats
    truth: Ints
    rest: Floats
    doubtful: Ints
    calm: Ints
    turn: Floats
    done: Ints
    magnitude: Floats
    y: Floats
    d: Floats
    polynomial: Floats
    candidate: Instants
    mark: Instants
    looked: float
    sized: bool
    at: float
    root_low: float
    bracket_low: float
    bracket_high: float


def make_instants(n: int) -> Instants:
    """Return room for n instants."""
    i = Instants()
    i.at = floats(n)
    return i


def make_locator(e: Engine) -> Locator:
    """Return a locator without guards."""
    m = e.model
    rules = m.rule_first[m.machines] + 2 * WEIGHTS
    atoms = m.atom_first[m.rule_first[m.machines]] + 2 * WEIGHTS
    g = Locator()
    g.rule = ints(rules)
    g.atom_first = ints(rules + 1)
    g.atom = ints(atoms)
    g.t = floats(SAMPLES)
    g.low = floats(DEEPEST + 2)
    g.high = floats(DEEPEST + 2)
    g.depth = ints(DEEPEST + 2)
    g.shape = floats(atoms * SAMPLES)
    g.truth = ints(rules * SAMPLES)
    g.rest = floats(atoms)
    g.doubtful = ints(atoms)
    g.calm = ints(rules)
    g.turn = floats(rules)
    g.done = ints(rules)
    g.magnitude = floats(2 * m.bonds)
    g.y = floats(e.states)
    g.d = floats(SAMPLES)
    g.polynomial = floats(GRID)
    g.candidate = make_instants(MOST)
    g.mark = make_instants(MOST)
    fit_polynomials(g)
    return g


def fit_polynomials(g: Locator) -> None:
    """Find what a polynomial of degree 5 makes of samples, and what it leaves of them."""
    powers = floats(SAMPLES * TERMS)
    inverse = floats(TERMS * SAMPLES)
    grid = floats(GRID * TERMS)
    put_powers(SAMPLES, powers, True)
    put_powers(GRID, grid, False)
    d = make_svd(SAMPLES, SAMPLES)
    pseudo_inverse(d, SAMPLES, TERMS, powers, 1e-15, inverse)
    g.left_over = floats(SAMPLES * SAMPLES)
    g.fine = floats(GRID * SAMPLES)
    times_matrix(SAMPLES, TERMS, SAMPLES, powers, inverse, g.left_over)
    for k in range(SAMPLES * SAMPLES):
        g.left_over[k] = -g.left_over[k]
    for k in range(SAMPLES):
        g.left_over[k * SAMPLES + k] += 1.0
    times_matrix(GRID, TERMS, SAMPLES, grid, inverse, g.fine)


def put_powers(n: int, a: Floats, sampled: bool) -> None:
    """Put powers of the samples' places, or of those of an even grid, into the rows of `a`."""
    for i in range(n):
        x = 2.0 * (FRACTION[i] if sampled else float(i) / float(GRID - 1)) - 1.0
        power = 1.0
        for j in range(TERMS):
            a[i * TERMS + TERMS - 1 - j] = power
            power *= x


def watch(e: Engine, g: Locator, state: Ints) -> None:
    """Take the guards that leave a mode."""
    m = e.model
    g.guards = 0
    g.atoms = 0
    for k in range(m.machines):
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            if m.rule_watched[r] == 0 or not is_asked(e, k, r, state[k]):
                continue
            if e.planar.leading and m.law_planar[k] != 0:
                continue
            g.rule[g.guards] = r
            g.atom_first[g.guards] = g.atoms
            for a in range(m.atom_first[r], m.atom_first[r + 1]):
                g.atom[g.atoms] = a
                g.atoms += 1
            g.guards += 1
    g.rounded = e.slide.k == 0
    for margin in range(2 * e.slide.k):
        # where a weight leaves 0 ... 1, a machine leaves its surface
        g.rule[g.guards] = -1 - margin
        g.atom_first[g.guards] = g.atoms
        g.atom[g.atoms] = -1 - margin
        g.atoms += 1
        g.guards += 1
    g.atom_first[g.guards] = g.atoms


def locate(e: Engine, g: Locator) -> int:
    """Find the first instant of the last step at which a guard holds, or infinity, into `g.at`."""
    g.at = math.inf
    g.failed = False
    g.looked = math.nan
    if g.guards == 0:
        return OK
    left = 1
    g.low[0] = e.step.t0
    g.high[0] = e.step.t1
    g.depth[0] = 0
    while left > 0:
        left -= 1
        low = g.low[left]
        high = g.high[left]
        depth = g.depth[left]
        for k in range(SAMPLES):
            g.t[k] = low + (high - low) * FRACTION[k]
        g.t[SAMPLES - 1] = high
        sample(e, g)
        find_shape(g)
        if has_failed(g):
            return REFUSED
        if depth < DEEPEST and not is_resolved(e, g):
            middle = 0.5 * (low + high)
            g.low[left] = middle
            g.high[left] = high
            g.depth[left] = depth + 1
            g.low[left + 1] = low
            g.high[left + 1] = middle
            g.depth[left + 1] = depth + 1
            left += 2
            continue
        first_of_block(e, g)
        if has_failed(g):
            return REFUSED
        if g.at < math.inf:
            return OK
    return OK


def has_failed(g: Locator) -> bool:
    """Whether a guard or a law had no value."""
    return g.failed


def first_of_block(e: Engine, g: Locator) -> None:
    """Find the first instant of the block at which a guard holds: the likeliest first."""
    for k in range(g.guards):
        g.done[k] = 0
    for _ in range(g.guards):
        next_one = -1
        for k in range(g.guards):
            if g.done[k] == 0 and (next_one < 0 or g.turn[k] < g.turn[next_one]):
                next_one = k
        g.done[next_one] = 1
        quiet = g.calm[next_one] != 0
        for i in range(SAMPLES):
            quiet = quiet and g.truth[next_one * SAMPLES + i] == 0
        if not quiet:
            g.at = min(g.at, of_rule(e, g, next_one, g.at))
        if g.failed:
            return


# -- looking


def look(e: Engine, g: Locator, t: float) -> None:
    """Fill the values at t."""
    if g.looked == t:
        return
    between(e, t, g.y)
    set_state(e, e.mode, e.v, t, g.y)
    if solve_here(e, e.mode, e.v) != OK:
        g.failed = True
    g.looked = t
    g.sized = False


def atom_at(e: Engine, g: Locator, a: int, t: float) -> float:
    """Return the difference that comparison a of the locator looks at."""
    look(e, g, t)
    return atom_here(e, g, a)


def atom_here(e: Engine, g: Locator, a: int) -> float:
    """Return the same at the values of the motion."""
    if g.atom[a] < 0:
        return e.slide.margin[-1 - g.atom[a]]
    return value(e.model, e.model.atom_value[g.atom[a]], e.v)


def size_here(e: Engine, g: Locator, a: int) -> float:
    """Return what the magnitudes of the two sides of a comparison add up to."""
    return 1.0 if g.atom[a] < 0 else value(e.model, e.model.atom_size[g.atom[a]], e.v)


def test_here(e: Engine, rule: int) -> bool:
    """Return the truth of a guard at the values of the motion, rounding being counted."""
    if rule < 0:
        return e.slide.margin[-1 - rule] < -BEYOND
    return value(e.model, e.model.rule_test[rule], e.v) != 0.0


def holds_at(e: Engine, g: Locator, k: int, t: float) -> bool:
    """Ask a guard as settling will: with rounding counted as zero."""
    look(e, g, t)
    return holds_here(e, g, g.rule[k])


def holds_here(e: Engine, g: Locator, rule: int) -> bool:
    """Ask a guard at the values of the motion; nothing jumps there."""
    m = e.model
    stack = e.work.stack
    if rule < 0:
        return test_here(e, rule)
    if not g.sized:
        put_sizes(e, e.mode)
        g.sized = True
    stack.now = e.v
    stack.was = e.v
    stack.was_first = 0
    stack.jump = e.v
    stack.jumps = False
    stack.terms = e.work.terms
    true = holds(m, rule, stack)
    if stack.refused != 0:
        refuse_pair(e, e.v[0], rule_text(m, rule))
        g.failed = True
    return true


def put_sizes(e: Engine, mode: Mode) -> None:
    """Put what rounding of each signal is measured by into `e.work.terms`, after `solve`."""
    m = e.model
    sizes_here(e, mode, e.v)
    for k in range(m.slots):
        e.work.terms[k] = math.fabs(e.v[k])
    read_stored(e, e.work.here)
    widen_sizes(e, mode, e.work.here)
    for k in range(2 * m.bonds):
        e.work.terms[m.bond_slot + k] = e.work.sizes[k]


def read_stored(e: Engine, x: Floats) -> None:
    """Put what is stored at the values of the motion into `x`."""
    for k in range(e.model.storages):
        x[k] = e.v[e.model.stored_slot + k]


def sample(e: Engine, g: Locator) -> None:
    """Sample all guards of the block."""
    for i in range(SAMPLES):
        look(e, g, g.t[i])
        for k in range(g.guards):
            g.truth[k * SAMPLES + i] = 1 if test_here(e, g.rule[k]) else 0
        for a in range(g.atoms):
            g.shape[a * SAMPLES + i] = atom_here(e, g, a)


def find_shape(g: Locator) -> None:
    """Say what the samples of all comparisons look like. After _Shape.of."""
    for k in range(g.guards):
        g.calm[k] = 1
        g.turn[k] = math.inf
        for a in range(g.atom_first[k], g.atom_first[k + 1]):
            if not stays(g, a):
                g.calm[k] = 0
            g.turn[k] = min(g.turn[k], first_turn(g, a))


def stays(g: Locator, a: int) -> bool:
    """Whether a comparison stays away from zero; note what a polynomial leaves of its samples."""
    at = a * SAMPLES
    least = g.shape[at]
    most = g.shape[at]
    size = 0.0
    rest = 0.0
    finite = True
    for i in range(SAMPLES):
        total = 0.0
        for j in range(SAMPLES):
            total += g.left_over[i * SAMPLES + j] * g.shape[at + j]
        finite = finite and math.isfinite(total)
        rest = max(rest, math.fabs(total))
        least = min(least, g.shape[at + i])
        most = max(most, g.shape[at + i])
        size = max(size, math.fabs(g.shape[at + i]))
    spread = most - least
    g.rest[a] = rest
    shown = rest <= UNRESOLVED * spread or rest <= ROUNDED * size or not finite
    g.doubtful[a] = 0 if shown else 1
    if size == 0.0:
        return True
    up = 1.0 if g.shape[at] > 0.0 else -1.0 if g.shape[at] < 0.0 else 0.0
    low = least if up > 0.0 else -most if up < 0.0 else 0.0
    bound = NEAR * spread + 3.0 * rest
    if not low > bound:
        return False
    for i in range(GRID):
        total = 0.0
        for j in range(SAMPLES):
            total += g.fine[i * SAMPLES + j] * g.shape[at + j]
        if not up * total > bound:
            return False
    return True


def first_turn(g: Locator, a: int) -> float:
    """Return where samples that begin positive first become negative, or the other way round."""
    at = a * SAMPLES
    up = 1.0 if g.shape[at] > 0.0 else -1.0 if g.shape[at] < 0.0 else 0.0
    for i in range(1, SAMPLES):
        if up * g.shape[at + i] < 0.0:
            before = up * g.shape[at + i - 1]
            share = before / (before - up * g.shape[at + i])
            return FRACTION[i - 1] + share * (FRACTION[i] - FRACTION[i - 1])
    return math.inf


def is_resolved(e: Engine, g: Locator) -> bool:
    """Whether the samples show all that the guards do, rounding left out."""
    m = e.model
    many = 0
    for a in range(g.atoms):
        many += g.doubtful[a]
    if many == 0:
        return True
    # what a bond variable cancels from: its own value may be nothing but rounding
    g.looked = math.nan
    look(e, g, g.t[0])
    sizes_here(e, e.mode, e.v)
    read_stored(e, e.work.here)
    widen_sizes(e, e.mode, e.work.here)
    for k in range(2 * m.bonds):
        g.magnitude[k] = e.work.sizes[k]
    for a in range(g.atoms):
        if g.doubtful[a] == 0:
            continue
        largest = 0.0
        for i in range(SAMPLES):
            look(e, g, g.t[i])
            for k in range(2 * m.bonds):
                own = math.fabs(e.v[m.bond_slot + k])
                e.v[m.bond_slot + k] = max(own, g.magnitude[k])
            largest = max(largest, size_here(e, g, a))
            g.looked = math.nan
        if not largest * ROUNDING >= g.rest[a]:
            return False
    return True


# -- searching


def keep(e: Engine, g: Locator, list_of: Instants, t: float) -> None:
    """Add an instant."""
    if list_of.count < MOST:
        list_of.at[list_of.count] = t
        list_of.count += 1
    else:
        g.failed = True
        say_fault(e, "HB-E634", "a guard has too many instants to be asked at in one step", "")


def sort(list_of: Instants) -> None:
    """Put instants in order."""
    a = list_of.at
    for i in range(1, list_of.count):
        t = a[i]
        j = i
        while j > 0 and a[j - 1] > t:
            a[j] = a[j - 1]
            j -= 1
        a[j] = t


def of_rule(e: Engine, g: Locator, k: int, before: float) -> float:
    """Return the first instant of the block at which guard k holds, infinity if none.

    `before` is one at which another guard does.
    """
    first = g.atom_first[k]
    stop = g.atom_first[k + 1]
    end = math.inf
    if before < math.inf and not holds_at(e, g, k, before):
        # unless it holds and ceases to before that, it becomes true later than another guard
        end = before
    c = g.candidate
    c.count = 0
    g.mark.count = 0
    for i in range(1, SAMPLES):
        if g.truth[k * SAMPLES + i] != 0:
            keep(e, g, c, g.t[i])
    for a in range(first, stop):
        begin = c.count
        extrema(e, g, a, end)
        for i in range(begin, c.count):
            if stop - first > 1:
                beside(e, g, a, c.at[i])
    if stop - first > 1:
        between_roots(e, g, first, stop, end)
    sort(c)
    for i in range(c.count):
        if g.failed:
            break
        # true there: it may have become so at any time after the candidate before
        at = c.at[i]
        low = g.t[0]
        for j in range(SAMPLES):
            if g.t[j] < at:
                low = max(low, g.t[j])
        for j in range(i):
            if c.at[j] < at:
                low = max(low, c.at[j])
        if at >= end or low >= before:
            break
        if at > e.step.t0 and holds_at(e, g, k, at):
            return bracket(e, g, k, low, at)
    return math.inf


def between_roots(e: Engine, g: Locator, first: int, stop: int, end: float) -> None:
    """Ask halfway between any two neighbouring roots of the comparisons of one guard.

    A window between two crossings may be narrower than the sampling.
    """
    c = g.candidate
    for a in range(first, stop):
        for i in range(SAMPLES - 1):
            here = g.shape[a * SAMPLES + i]
            there = g.shape[a * SAMPLES + i + 1]
            turns = (here > 0.0 and there < 0.0) or (here < 0.0 and there > 0.0)
            if turns and g.t[i] < end and not g.failed:
                keep(e, g, g.mark, root(e, g, a, g.t[i], g.t[i + 1]))
    if g.mark.count == 0:
        return
    roots = g.mark.count
    for i in range(roots):
        keep(e, g, c, g.mark.at[i])
    for i in range(SAMPLES):
        keep(e, g, g.mark, g.t[i])
    sort(g.mark)
    for i in range(g.mark.count - 1):
        if g.mark.at[i + 1] - g.mark.at[i] > 0.0:
            keep(e, g, c, 0.5 * (g.mark.at[i] + g.mark.at[i + 1]))


def beside(e: Engine, g: Locator, a: int, c: float) -> None:
    """Mark the roots of a comparison on both sides of an extremum beyond zero between samples.

    Another comparison may hold on one side of it only: of a ball that grazes, on the way up.
    """
    after = 0
    while after < SAMPLES and g.t[after] < c:
        after += 1
    if after == 0 or after == SAMPLES or g.t[after] == c:
        return
    low = g.t[after - 1]
    high = g.t[after]
    middle = atom_at(e, g, a, c)
    if atom_at(e, g, a, low) * middle < 0.0:
        keep(e, g, g.mark, root(e, g, a, low, c))
    if atom_at(e, g, a, high) * middle < 0.0:
        keep(e, g, g.mark, root(e, g, a, c, high))


def extrema(e: Engine, g: Locator, a: int, end: float) -> None:
    """Add extrema of a comparison that reach, or nearly reach, zero between samples."""
    least = g.shape[a * SAMPLES]
    most = least
    for i in range(SAMPLES):
        least = min(least, g.shape[a * SAMPLES + i])
        most = max(most, g.shape[a * SAMPLES + i])
    near = NEAR * (most - least) + 3.0 * g.rest[a]
    if most > 0.0:
        dips(e, g, a, 1.0, near, end)
    if least < 0.0:
        dips(e, g, a, -1.0, near, end)


def grid_time(g: Locator, k: int) -> float:
    """Return the instant of a point of the grid."""
    return g.t[0] + (g.t[SAMPLES - 1] - g.t[0]) * (float(k) / float(GRID - 1))


def dips(e: Engine, g: Locator, a: int, sign: float, near: float, end: float) -> None:
    """Add minima of ``sign * comparison`` near zero, between samples where it is positive."""
    last = GRID - 1
    d = g.d
    fine = g.polynomial
    for i in range(SAMPLES):
        d[i] = sign * g.shape[a * SAMPLES + i]
    for i in range(GRID):
        total = 0.0
        for j in range(SAMPLES):
            total += g.fine[i * SAMPLES + j] * d[j]
        fine[i] = total
    after = 0
    for i in range(1, last):
        while after < SAMPLES and FRACTION[after] <= float(i) / float(last):
            after += 1
        if (
            fine[i] <= fine[i - 1]
            and fine[i] <= fine[i + 1]
            and fine[i] <= near
            and d[after - 1] > 0.0
            and d[after] > 0.0
        ):
            dip(e, g, a, max(i - AROUND, 0), min(i + AROUND, last), sign, end)
    # the polynomials of two neighbouring blocks may each place an extremum in the other
    for side in range(2):
        edge = 0 if side == 0 else last
        away = AROUND if side == 0 else last - AROUND
        at = d[0] if side == 0 else d[SAMPLES - 1]
        if not (at > 0.0 and at <= near and fine[edge] <= fine[away]):
            continue
        begin = grid_time(g, edge)
        there = grid_time(g, away)
        if sign * atom_at(e, g, a, begin + 1e-3 * (there - begin)) < at:
            dip(e, g, a, min(edge, away), max(edge, away), sign, end)


def dip(e: Engine, g: Locator, a: int, first: int, stop: int, sign: float, end: float) -> None:
    """Add the instant between two points of the grid where ``sign * comparison`` is least.

    Golden section; it ends where zero is reached.
    """
    low = grid_time(g, first)
    high = grid_time(g, stop)
    if not low < end or g.failed:
        return
    ratio = 0.5 * (math.sqrt(5.0) - 1.0)
    c = high - ratio * (high - low)
    d = low + ratio * (high - low)
    fc = sign * atom_at(e, g, a, c)
    fd = sign * atom_at(e, g, a, d)
    for _ in range(SEARCH):
        if min(fc, fd) <= 0.0:
            break
        if fc < fd:
            high = d
            d = c
            fd = fc
            c = high - ratio * (high - low)
            fc = sign * atom_at(e, g, a, c)
        else:
            low = c
            c = d
            fc = fd
            d = low + ratio * (high - low)
            fd = sign * atom_at(e, g, a, d)
    keep(e, g, g.candidate, c if fc <= fd else d)


def root(e: Engine, g: Locator, which: int, low: float, high: float) -> float:
    """Return the end of a bracket of the sign change of a comparison, a few last places wide."""
    a = low
    b = high
    fa = atom_at(e, g, which, a)
    fb = atom_at(e, g, which, b)
    if fa == 0.0 or fa * fb > 0.0:
        return high
    side = 0
    wide = 4.0 * spacing(max(math.fabs(low), math.fabs(high)))
    for _ in range(SEARCH):
        if b - a <= wide or fb == 0.0 or fb == fa:
            break
        c = b - fb * (b - a) / (fb - fa)
        # a step off either end keeps the bracket shrinking from both sides
        c = min(max(c, a + 0.25 * wide), b - 0.25 * wide)
        fc = atom_at(e, g, which, c)
        if fc * fb > 0.0 or fc == 0.0:
            b = c
            fb = fc
            if side > 0:
                fa = 0.5 * fa
            side = 1
        else:
            a = c
            fa = fc
            if side < 0:
                fb = 0.5 * fb
            side = -1
    return b


def bracket(e: Engine, g: Locator, k: int, low: float, high: float) -> float:
    """Return the first instant in ``(low, high]`` at which guard k holds."""
    turned = 0
    which = 0
    crosses = False
    for a in range(g.atom_first[k], g.atom_first[k + 1]):
        before = atom_at(e, g, a, low)
        after = atom_at(e, g, a, high)
        if (before > 0.0) != (after > 0.0) or before * after == 0.0:
            turned += 1
            which = a
            crosses = before != 0.0 and before * after <= 0.0
    g.bracket_low = low
    g.bracket_high = high
    if turned == 1 and crosses:
        around(e, g, k, root(e, g, which, low, high))
    low = g.bracket_low
    high = g.bracket_high
    wide = 4.0 * spacing(max(math.fabs(low), math.fabs(high)))
    while high - low > wide and not g.failed:
        middle = 0.5 * (low + high)
        if holds_at(e, g, k, middle):
            high = middle
        else:
            low = middle
    return high


def around(e: Engine, g: Locator, k: int, here: float) -> None:
    """Narrow the bracket to near the root of its comparison.

    The guard may hold a little before it, because rounding counts as zero, or a little after, where
    the comparison is strict. All guards are asked alike: a bounce ever smaller begins and ends at
    the same distance then.
    """
    reach = 4.0 * spacing(here)
    low = g.bracket_low
    high = g.bracket_high
    if holds_at(e, g, k, here):
        if not g.rounded:
            g.bracket_low = here
            g.bracket_high = here
            return
        yes = here
        at = here - reach
        while at > low and not g.failed and holds_at(e, g, k, at):
            yes = at
            reach = 2.0 * reach
            at = here - reach
        g.bracket_low = max(at, low)
        g.bracket_high = yes
        return
    no = here
    at = here + reach
    while at < high and not g.failed and not holds_at(e, g, k, at):
        no = at
        reach = 2.0 * reach
        at = here + reach
    g.bracket_low = no
    g.bracket_high = min(at, high)
