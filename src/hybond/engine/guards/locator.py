"""The guards that may leave a mode, and room to look for the first that holds.

A block of a step is sampled, and a polynomial of degree 5 laid through the samples.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import times_matrix
from hybond.engine.algebra.svd import make_svd, null_space, pseudo_inverse
from hybond.engine.engine import Engine
from hybond.engine.guards.quartic import COEFFICIENTS, Quartic, make_quartic
from hybond.engine.mode.comparisons.sum_records import Sums, begin_as_large, make_sums
from hybond.engine.mode.mode_records import Reads, make_reads
from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, float_table, floats, ints, record

SAMPLES: Final = 9
"""Of a guard in a block of a step."""
FRACTION: Final = float_table(0.0, 0.113, 0.261, 0.372, 0.5127, 0.6291, 0.7713, 0.8837, 1.0)
"""Where in a step guards are sampled: unevenly, so that no periodic signal looks constant."""
TERMS: Final = 6
"""Coefficients of the polynomial through the samples."""
GRID: Final = 65
"""Points of a block at which that polynomial is looked at."""
DEEPEST: Final = 14
"""Halvings of one step; a jump of a guard's signal is closed in on no further."""
INSTANTS: Final = 200
"""Of one block at which a guard is asked, unless there are more."""
BLOCKS: Final = 64
"""Of one step in which a kink is looked for, and longer only where it is a guard that is."""
MOST_BLOCKS: Final = 128
"""Of one step, to any depth; behind them halvings are few. So many are of signals that rounding or
chatter moves everywhere, which no halving shows more of."""
SHALLOW: Final = 4
"""These."""
MOST_LOOKS: Final = 1_000_000_000
"""Instants looked at after which they are counted anew."""
ALL_PARTS: Final = -1
"""A guard is asked of the motion as it is, not of one of the modes that are combined."""
NONE: Final = -1
COURSE: Final = COEFFICIENTS + 1
"""Numbers that say what a state does in a step: coefficients, and behind them how large it is."""
KEPT: Final = (SAMPLES + 1) // 2
"""Samples at which it is seen how far a step is off its constraints: every other one."""
NO_KINK: Final = 2
"""The side of what is no kink."""


@record
class Instants:
    """Some instants; there is room for `room` of them."""

    count: int
    room: int
    at: Floats


@record
class Locator:
    """The guards that may leave the current mode, and the search for the first that holds.

    `shape` has the samples of each comparison; `turn` is about where the first comparison of a
    guard changes sign.
    """

    guards: int
    room: int
    """Guards that there is room for, and comparisons."""
    room_atoms: int
    rule: Ints
    """Of each guard: the rule that says it, or NONE."""
    pair: Ints
    """What settling asks; NONE for how far a weight is from leaving, which is `margin`."""
    test: Ints
    margin: Ints
    part: Ints
    """The mode that it is asked of, among those that are combined, or ALL_PARTS."""
    side: Ints
    """Of a kink: the sign that it begins the step with, 0 where it is zero; else NO_KINK."""
    atoms: int
    atom_first: Ints
    """Of each guard: its comparisons in `shape`."""
    atom: Ints
    turn_first: Ints
    """Of each guard: what is zero where its comparisons turn, in `shape`, behind all of these."""
    pole: Ints
    """Of each of these: whether something in the guard has no value there."""
    atom_part: Ints
    atom_guard: Ints
    """Of each comparison: its guard, and the part of that."""
    sums: Sums
    """The comparisons that are sums of the state: polynomials of a step, of which `step` has the
    coefficients, `extent` what the magnitudes of terms add up to, and `sign` the sign all over the
    step, 0 where it may be zero."""
    step: Floats
    extent: Floats
    sign: Ints
    wave: Floats
    """Samples of the sources that stand in `sums` beside the state; below and above which each
    stays in the step, where samples show that, `wave_shown`."""
    wave_low: Floats
    wave_high: Floats
    wave_shown: Ints
    quartic: Quartic
    solved: Ints
    """Of each guard: whether its comparisons are polynomials of the step, or nowhere near zero, and
    no samples needed."""
    foreseen: Ints
    """Of each guard: whether time alone decides it, and when it holds next is known."""
    asked_from: int
    asked_until: int
    """Which guards are looked for in blocks of the step: all, or one."""
    still: Ints
    """Of each guard: whether it was asked while nothing moved of what it compares, and did not
    hold; what its comparisons were then, and the sizes of their terms: 0 and -1 of what was zero.
    """
    still_value: Floats
    still_extent: Floats
    motion: Ints
    course: Floats
    """Of each state: whether the step moves it or it is anything; its coefficients, its size."""
    drift: Floats
    """Of each state: how far it is moved in the step where it is put on constraints; whether any
    may be; of each comparison: how far it may be off for that; by what, at each sample kept."""
    drifted: bool
    astray: Floats
    moved: Floats
    kept_at: Floats
    """Instants of the step at which states on their constraints are known, the first so many."""
    kept_y: Floats
    keeps: int
    denied: Ints
    """Of each guard: signs of its comparisons, a bit for all together, with which it is false."""
    rough: bool
    """Whether it is enough to know about when a guard begins to hold: the step is repeated."""
    about: bool
    """Whether the instant found is such a one."""
    found: int
    """The guard that held when it was asked at `found_at`, in the step as it is."""
    found_at: float
    shown_to: float
    """The end of the step whose comparisons are there as polynomials."""
    watched: int
    """The place of the mode that was watched last, and which of all that were made it is."""
    watched_made: int
    kept: bool
    """Whether the guards depend on nothing but that mode."""
    reads: Reads
    left_over: Floats
    """Samples to what a polynomial of degree 5 does not explain of them."""
    beyond: Floats
    """Samples to their components beyond that polynomial, in three rows of length one."""
    fine: Floats
    """Samples to that polynomial on a fine grid."""
    swing: float
    """How far it can be from the middle of the samples, in units of their distance from there."""
    rounded: bool
    """Whether a guard leaves as soon as it holds with rounding counted as zero."""
    failed: bool
    showing: int
    """The part whose values are shown, or ALL_PARTS."""
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
    y: Floats
    d: Floats
    polynomial: Floats
    candidate: Instants
    mark: Instants
    timed: Ints
    """Of each kink: whether time alone decides it: what it compares has no rounding of the motion.
    """
    asleep: int
    """Steps for which other kinks end none: there were too many of them at one place."""
    sleep: Ints
    """Of each kink: likewise, as it was rounding that changed its sign, all over a step."""
    nap: Ints
    """Of each kink: for how many it will be the next time."""
    blurred: Ints
    """Of each kink: whether it ends no step from `blurred_from`, as its tolerance does not tell it
    from zero there; whether there are any; how many steps such kinks have ended in a row. Of all
    kinks of the model, and edges behind them: how far what is compared may be off, what it is, and
    what it is with one state shifted."""
    blurred_from: float
    blurs: bool
    in_a_row: int
    blur: Floats
    unblurred: Floats
    beside_here: Floats
    shifted_y: Floats
    looks: int
    """Instants that were looked at; the last of them at which the bond variables of each guard
    were evaluated, and each row of them, if that is done as guards are asked, `singly`."""
    seen: Ints
    row_seen: Ints
    singly: bool
    sampled: bool
    """Whether the samples in `shape` are those of the step as it is."""
    looked: float
    sized: bool
    """Whether terms of the motion as it is are known there."""
    lost: bool
    """Whether no combination holds the state on its surfaces there."""
    held: bool
    """Whether states are on their constraints where guards are asked: an event begins there, and
    what integration drifts off would say something else of it."""
    tied: bool  # whether the motion is tied to its sources, see jumps/tied
    began: float
    """The first instant at which a guard holds; `at` is the last that is one with it."""
    at: float
    bracket_low: float
    bracket_high: float
    not_yet: float
    """The last instant at which a guard whose beginning is looked for is known not to hold."""
    already: float
    """The first at which it is known to."""


def make_instants(n: int) -> Instants:
    """Return room for n instants."""
    i = Instants()
    i.room = n
    i.at = floats(n)
    return i


def make_locator(e: Engine) -> Locator:
    """Return a locator without guards."""
    g = begin_locator(e)
    fit_polynomials(g)
    return g


def another_locator(e: Engine, first: Locator) -> Locator:
    """Return one more, which has what is the same in all of them from the first."""
    g = begin_locator(e)
    begin_as_large(g.sums, first.sums)
    g.left_over = first.left_over
    g.beyond = first.beyond
    g.fine = first.fine
    g.swing = first.swing
    return g


def begin_locator(e: Engine) -> Locator:
    """Return a locator that does not know yet what samples say."""
    m = e.model
    rules = m.rule_first[m.machines]
    g = Locator()
    fit_locator(g, rules, m.atom_first[rules])
    g.t = floats(SAMPLES)
    g.low = floats(DEEPEST + 2)
    g.high = floats(DEEPEST + 2)
    g.depth = ints(DEEPEST + 2)
    g.reads = make_reads(m)
    g.sums = make_sums()
    g.sums.waving = m.called == 0
    g.wave = floats(2 * m.most_sources * SAMPLES)
    g.wave_low = floats(2 * m.most_sources)
    g.wave_high = floats(2 * m.most_sources)
    g.wave_shown = ints(2 * m.most_sources)
    g.quartic = make_quartic()
    g.motion = ints(e.states)
    g.course = floats(COURSE * e.states)
    g.drift = floats(e.states)
    g.moved = floats(KEPT * e.states)
    g.kept_at = floats(KEPT)
    g.kept_y = floats(KEPT * e.states)
    g.row_seen = ints(2 * m.bonds)
    g.y = floats(e.states)
    g.shifted_y = floats(e.states)
    g.blur = floats(m.kinks + m.edges)
    g.unblurred = floats(m.kinks + m.edges)
    g.beside_here = floats(m.kinks + m.edges)
    g.d = floats(SAMPLES)
    g.polynomial = floats(GRID)
    g.candidate = make_instants(INSTANTS)
    g.mark = make_instants(INSTANTS)
    g.showing = ALL_PARTS
    g.watched = NONE
    return g


def fit_locator(g: Locator, guards: int, atoms: int) -> None:
    """Make room for so many guards and comparisons; what was there is lost."""
    if guards <= g.room and atoms <= g.room_atoms and g.room > 0:
        return
    g.room = max(max(guards, g.room), 1)
    g.room_atoms = max(atoms, g.room_atoms)
    g.rule = ints(g.room)
    g.pair = ints(g.room)
    g.test = ints(g.room)
    g.margin = ints(g.room)
    g.part = ints(g.room)
    g.side = ints(g.room)
    g.sleep = ints(g.room)
    g.nap = ints(g.room)
    g.timed = ints(g.room)
    g.blurred = ints(g.room)
    g.atom_first = ints(g.room + 1)
    g.turn_first = ints(g.room + 1)
    g.truth = ints(g.room * SAMPLES)
    g.calm = ints(g.room)
    g.turn = floats(g.room)
    g.done = ints(g.room)
    g.solved = ints(g.room)
    g.foreseen = ints(g.room)
    g.denied = ints(g.room)
    g.seen = ints(g.room)
    g.still = ints(g.room)
    g.atom = ints(g.room_atoms)
    g.atom_part = ints(g.room_atoms)
    g.atom_guard = ints(g.room_atoms)
    g.shape = floats(g.room_atoms * SAMPLES)
    g.rest = floats(g.room_atoms)
    g.pole = ints(g.room_atoms)
    g.step = floats(COEFFICIENTS * g.room_atoms)
    g.extent = floats(g.room_atoms)
    g.astray = floats(g.room_atoms)
    g.still_value = floats(g.room_atoms)
    g.still_extent = floats(g.room_atoms)
    g.sign = ints(g.room_atoms)
    g.doubtful = ints(g.room_atoms)


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
    put_beyond(g, powers)
    g.fine = floats(GRID * SAMPLES)
    times_matrix(SAMPLES, TERMS, SAMPLES, powers, inverse, g.left_over)
    for k in range(SAMPLES * SAMPLES):
        g.left_over[k] = -g.left_over[k]
    for k in range(SAMPLES):
        g.left_over[k * SAMPLES + k] += 1.0
    times_matrix(GRID, TERMS, SAMPLES, grid, inverse, g.fine)
    g.swing = 0.0
    for i in range(GRID):
        total = 0.0
        for j in range(SAMPLES):
            total += math.fabs(g.fine[i * SAMPLES + j])
        g.swing = max(g.swing, total)


def put_beyond(g: Locator, powers: Floats) -> None:
    """Find rows of length one that see nothing of a polynomial, and are right-angled."""
    across = floats(TERMS * SAMPLES)
    for i in range(SAMPLES):
        for j in range(TERMS):
            across[j * SAMPLES + i] = powers[i * TERMS + j]
    many = SAMPLES - TERMS
    basis = floats(SAMPLES * SAMPLES)
    null_space(make_svd(SAMPLES, SAMPLES), TERMS, SAMPLES, across, 1e-10, basis)
    g.beyond = floats(many * SAMPLES)
    for i in range(SAMPLES):
        for j in range(many):
            g.beyond[j * SAMPLES + i] = basis[i * many + j]


def put_powers(n: int, a: Floats, sampled: bool) -> None:
    """Put powers of the samples' places, or of those of an even grid, into the rows of `a`."""
    for i in range(n):
        x = 2.0 * (FRACTION[i] if sampled else float(i) / float(GRID - 1)) - 1.0
        power = 1.0
        for j in range(TERMS):
            a[i * TERMS + TERMS - 1 - j] = power
            power *= x


def begin_looks(m: Model, g: Locator) -> None:
    """Begin to look at another step: nothing is known at any instant of it."""
    g.looked = math.nan
    g.keeps = 0
    if g.looks < MOST_LOOKS:
        return
    g.looks = 0
    for k in range(g.room):
        g.seen[k] = 0
    for b in range(2 * m.bonds):
        g.row_seen[b] = 0


def is_sampled(g: Locator, k: int) -> bool:
    """Whether it takes samples of a guard to know when it holds."""
    return g.solved[k] == 0 and g.foreseen[k] == 0


def has_failed(g: Locator) -> bool:
    """Whether a guard or a law had no value."""
    return g.failed
