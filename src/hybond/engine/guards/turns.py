"""Instants of a block at which comparisons turn that are made of what is zero there.

``exp(-x^2) > 0.5`` holds between two instants that are far closer than samples, with x through zero
between them. What goes one way is sampled well enough by its signs: so what is zero where a
comparison turns is looked for from within outwards, each between the roots of those before it, and
the comparisons themselves between all of them.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.guards.bracket import root_between
from hybond.engine.guards.candidates import extrema, keep, sort
from hybond.engine.guards.guard_values import atom_at
from hybond.engine.guards.locator import SAMPLES, Locator
from hybond.engine.methods.explicit.dopri import spacing

BESIDE: Final = 8.0
"""How far beside a root it is looked, in last places: twice as far as roots are narrowed to."""


def mark_turns(e: Engine, g: Locator, k: int, end: float) -> bool:
    """Mark where what a guard compares turns, among all samples; False if there is no such place.

    It is asked there, unless it has no value.
    """
    if g.turn_first[k] == g.turn_first[k + 1]:
        return False
    for i in range(SAMPLES):
        keep(g.mark, g.t[i])
    for a in range(g.turn_first[k], g.turn_first[k + 1]):
        begin = g.candidate.count
        extrema(e, g, a, end)
        for i in range(begin, g.candidate.count):
            keep(g.mark, g.candidate.at[i])
        mark_roots(e, g, a, end, g.pole[a] == 0)
    if g.mark.count > SAMPLES:
        return True
    g.mark.count = 0
    return False


def between_turns(e: Engine, g: Locator, k: int, end: float) -> None:
    """Ask a guard halfway between any two neighbours of what is marked of it.

    With the roots of its comparisons, if there are several, or it has no value somewhere.
    """
    several = g.atom_first[k + 1] - g.atom_first[k] > 1
    for a in range(g.turn_first[k], g.turn_first[k + 1]):
        several = several or g.pole[a] != 0
    for a in range(g.atom_first[k], g.atom_first[k + 1] if several else g.atom_first[k]):
        mark_roots(e, g, a, end, True)
    sort(g.mark)
    for i in range(g.mark.count - 1):
        if g.mark.at[i + 1] > g.mark.at[i]:
            keep(g.candidate, 0.5 * (g.mark.at[i] + g.mark.at[i + 1]))


def keep_sides(g: Locator, low: float, at: float, high: float) -> None:
    """Mark both sides of a root: what jumps there may hold until then, or from then on, only."""
    away = BESIDE * spacing(max(math.fabs(low), math.fabs(high)))
    if at - away > low:
        keep(g.mark, at - away)
        keep(g.candidate, at - away)
    if at + away < high:
        keep(g.mark, at + away)
        keep(g.candidate, at + away)


def mark_roots(e: Engine, g: Locator, a: int, end: float, asked: bool) -> None:
    """Mark where a comparison changes its sign between any two neighbours of what is marked.

    If it is `asked` there, the guard is; it is not where it has no value.
    """
    sort(g.mark)
    many = g.mark.count
    before = atom_at(e, g, a, g.mark.at[0])
    for i in range(1, many):
        if g.failed or not g.mark.at[i - 1] < end:
            return
        there = atom_at(e, g, a, g.mark.at[i])
        if (before > 0.0 and there < 0.0) or (before < 0.0 and there > 0.0):
            at = root_between(e, g, a, g.mark.at[i - 1], before, g.mark.at[i], there)
            keep(g.mark, at)
            if asked:
                keep_sides(g, g.mark.at[i - 1], at, g.mark.at[i])
                keep(g.candidate, at)
        before = there
    if asked and many > 1 and g.mark.at[many - 1] < end:
        mark_end(e, g, a, g.mark.at[many - 2], g.mark.at[many - 1])
    sort(g.mark)


def mark_end(e: Engine, g: Locator, a: int, low: float, high: float) -> None:
    """Mark what is just before the last of these, where the comparison has a root: a clock's edge.

    What holds up to there would be passed over, as a saw is back at nothing then.
    """
    there = atom_at(e, g, a, high)
    away = BESIDE * spacing(high)
    if high - away > low and math.fabs(there) <= math.fabs(atom_at(e, g, a, high - away) - there):
        keep_sides(g, low, high, high)
