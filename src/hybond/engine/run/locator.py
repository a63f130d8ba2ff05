"""The guards that may leave a mode, and room to look for the first that holds.

A block of a step is sampled, and a polynomial of degree 5 laid through the samples. After
modes/locate.py.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import times_matrix
from hybond.engine.algebra.svd import make_svd, null_space, pseudo_inverse
from hybond.engine.engine import Engine, Reads, make_reads
from hybond.engine.instant.in_force import is_asked
from hybond.engine.mode.reading import read_guard, read_nothing
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
MOST: Final = 4000
"""Instants of one block at which a guard may be asked."""
WEIGHTS: Final = 32
"""Surfaces that may be slid on at once."""


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
    g.reads = make_reads(m)
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


def watch(e: Engine, g: Locator, state: Ints) -> None:
    """Take the guards that leave a mode."""
    m = e.model
    g.guards = 0
    g.atoms = 0
    read_nothing(m, g.reads)
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
            read_guard(m, e.mode, g.reads, r)
    g.rounded = e.slide.k == 0
    for margin in range(2 * e.slide.k):
        # where a weight leaves 0 ... 1, a machine leaves its surface
        g.rule[g.guards] = -1 - margin
        g.atom_first[g.guards] = g.atoms
        g.atom[g.atoms] = -1 - margin
        g.atoms += 1
        g.guards += 1
    g.atom_first[g.guards] = g.atoms


def has_failed(g: Locator) -> bool:
    """Whether a guard or a law had no value."""
    return g.failed
