"""Laws that carry, or block, what is hardly more than rounding: their branch is not resolved.

A diode of a nano-ohm beside hundreds of volts carries amperes by a voltage that is no more than
rounding of these: it blocks as soon as that has turned for sure, which is late by as much. What
cannot be told is said.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.guard_values import holds_at, look, terms_here
from hybond.engine.guards.locator import ALL_PARTS, FRACTION, SAMPLES, Locator, is_sampled
from hybond.engine.guards.quartic import COEFFICIENTS, DEGREE, horner
from hybond.engine.reasons.warned import UNRESOLVED, add_about, begin_warning

BESIDE: Final = 1e-3
"""Part of what a law carries from which on rounding of it is not small."""
SEEN: Final = 1e-2
"""Part of its rounding below which what it carries may be nothing else, ..."""
MATTERS: Final = 1e-6
"""... and part of the largest variable of its kind below which nobody looks for it."""


def see_carried(e: Engine, g: Locator) -> None:
    """See how much laws carry, or block, at both ends of a step and in its middle."""
    for k in range(g.guards):
        r = g.rule[k]
        if r < 0 or not is_one_sum(g, k):
            continue
        most = e.checks.carried[r]
        for i in range(0, SAMPLES, 4):
            most = max(most, math.fabs(value_at(g, g.atom_first[k], i)))
        e.checks.carried[r] = most


def see_held_back(e: Engine, g: Locator) -> None:
    """See of laws that are sampled what is beyond zero at the end of a step, but for rounding.

    A diode behind an amplifier of a million carries milliamperes backward before its voltage, times
    that, is more than rounding.
    """
    m = e.model
    if m.laws == 0 or m.tells == 0 or not g.sampled or g.at < math.inf or e.slide.k > 0:
        return
    c = e.checks
    for k in range(g.guards if e.mode.finite_frees > 0 else 0):
        r = g.rule[k]
        a = g.atom_first[k]
        if r < 0 or not is_sampled(g, k) or g.part[k] != ALL_PARTS or g.atom_first[k + 1] != a + 1:
            continue
        for i in range(0, SAMPLES, 4):
            c.carried[r] = max(c.carried[r], math.fabs(g.shape[a * SAMPLES + i]))
        beyond = math.fabs(g.shape[a * SAMPLES + SAMPLES - 1])
        if g.truth[k * SAMPLES + SAMPLES - 1] == 0 or beyond <= c.unresolved[r]:
            continue
        look(e, g, g.t[SAMPLES - 1])
        rounding = ROUNDING * terms_here(e, g, k, a)
        if beyond <= rounding and rounding > BESIDE * c.carried[r]:
            c.unresolved[r] = beyond
            c.unresolved_at[r] = g.t[SAMPLES - 1]
            c.unresolved_by[r] = rounding


def see_borne(e: Engine, g: Locator) -> None:
    """Add what laws carry in a step to what each has carried, or to what was not told from nothing.

    A diode whose other side has once been at a million volts may carry milliamperes backward for
    good, by what is rounding of those; a surge of nanoseconds that it carried does not make that
    small, nor do large currents elsewhere.
    """
    if e.model.laws == 0 or e.model.tells == 0 or g.at < math.inf or e.slide.k > 0:
        return
    if math.isnan(g.shown_to):
        return
    c = e.checks
    h = e.step.t1 - e.step.t0
    for k in range(g.guards):
        r = g.rule[k]
        if r < 0 or not is_one_sum(g, k):
            continue
        here = math.fabs(value_at(g, g.atom_first[k], SAMPLES - 1))
        rounding = ROUNDING * g.extent[g.atom_first[k]]
        if here > rounding:
            c.borne[r] += h * here
            c.most_borne[r] = max(c.most_borne[r], here)
        elif here > SEEN * rounding:
            c.vague[r] += h * here
            if here > c.most_vague[r]:
                c.most_vague[r] = here
                c.vague_at[r] = e.step.t1
                c.vague_by[r] = rounding


def is_vague(e: Engine, r: int) -> bool:
    """Whether what a law was not told to carry is not small beside what it carried.

    Where that was next to nothing, it has been idle, and all of it is rounding.
    """
    c = e.checks
    return c.vague[r] > BESIDE * c.borne[r] and c.most_borne[r] > BESIDE * c.most_vague[r]


def value_at(g: Locator, a: int, i: int) -> float:
    """Return what comparison a has at a sample of the step."""
    s = g.sums
    total = horner(g.step, COEFFICIENTS * a, DEGREE, FRACTION[i])
    for p in range(s.wave_first.at[a], s.wave_first.at[a + 1] if s.waved.at[a] != 0 else 0):
        total += s.wave_factor.at[p] * g.wave[s.wave_source.at[p] * SAMPLES + i]
    return total


def is_one_sum(g: Locator, k: int) -> bool:
    """Whether a guard is one comparison that is a sum of the state."""
    a = g.atom_first[k]
    if g.part[k] != ALL_PARTS or g.atom_first[k + 1] != a + 1:
        return False
    return g.sums.known.at[a] != 0 or g.sums.waved.at[a] != 0


def see_unresolved(e: Engine, g: Locator, at: float) -> None:
    """See of each law whether its rounding is small beside what it carried until `at`.

    Of what each has carried so the most is told where the run ends: only then it is known what is
    large beside it.
    """
    if e.model.laws == 0 or e.model.tells == 0 or math.isnan(g.shown_to):
        return
    c = e.checks
    for k in range(g.guards):
        r = g.rule[k]
        if r < 0 or not is_one_sum(g, k) or c.carried[r] <= c.unresolved[r]:
            continue
        carried = c.carried[r]
        rounding = ROUNDING * g.extent[g.atom_first[k]]
        if rounding <= BESIDE * carried or carried <= SEEN * rounding:
            continue
        if carried > rounding and not holds_at(e, g, k, at):
            continue
        c.unresolved[r] = carried
        c.unresolved_at[r] = at
        c.unresolved_by[r] = rounding


def tell_unresolved(e: Engine) -> None:
    """Warn of laws that have carried hardly more than rounding, and not next to nothing."""
    m = e.model
    c = e.checks
    for r in range(m.rule_first[m.machines] if m.laws > 0 and m.tells != 0 else 0):
        if c.unresolved[r] > MATTERS * largest_beside(e, r):
            begin_warning(e.warned, UNRESOLVED, c.unresolved_at[r])
            add_about(e.warned, float(r))
            add_about(e.warned, c.unresolved[r])
            add_about(e.warned, c.unresolved_by[r])
            c.unresolved[r] = 0.0
        elif is_vague(e, r):
            begin_warning(e.warned, UNRESOLVED, c.vague_at[r])
            add_about(e.warned, float(r))
            add_about(e.warned, c.most_vague[r])
            add_about(e.warned, c.vague_by[r])
            c.vague[r] = 0.0


def largest_beside(e: Engine, r: int) -> float:
    """Return the largest variable of the kind that a rule compares, infinity if it is another."""
    m = e.model
    for i in range(m.read_first[r], m.read_first[r + 1]):
        b = m.read_slot[i] - m.bond_slot
        if b >= 0 and b < 2 * m.bonds:
            return e.checks.largest[m.bond_class[b]]
    return math.inf


def forget_carried(e: Engine) -> None:
    """Begin anew with what laws carry that have changed their branch."""
    m = e.model
    for k in range(m.machines if m.laws > 0 else 0):
        for r in range(m.rule_first[k], m.rule_first[k + 1]):
            if m.rule_source[r] != e.state[k]:
                e.checks.carried[r] = 0.0
