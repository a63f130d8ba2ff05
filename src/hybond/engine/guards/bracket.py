"""When a guard becomes true between two instants, and where what it compares is zero."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.guards.guard_values import atom_at, holds_at
from hybond.engine.guards.locator import SAMPLES, Locator
from hybond.engine.guards.naps import is_asleep
from hybond.engine.guards.rim import asked_at, find_rim, forget_asked
from hybond.engine.methods.explicit.dopri import spacing

SEARCH: Final = 40
"""Most iterations of one root or extremum search."""
STEEP: Final = 20
"""Iterations of a root search after which it goes on by halves: of what is as steep as ``exp``."""
HALVED: Final = 64
"""Most iterations of one root search behind these."""
AT_ONCE: Final = 1e-9
"""Part of the run that a step is which takes next to no time."""
NEXT_TO: Final = 4.0
"""How far looks beside a root go, beside the first, before its comparison is asked how far to."""


def root(e: Engine, g: Locator, which: int, low: float, high: float) -> float:
    """Return the end of a bracket of the sign change of a comparison, a few last places wide."""
    at_low = atom_at(e, g, which, low)
    at_high = atom_at(e, g, which, high)
    return root_between(e, g, which, low, at_low, high, at_high)


def root_between(
    e: Engine, g: Locator, which: int, low: float, at_low: float, high: float, at_high: float
) -> float:
    """Return the same, of a comparison that is known at both ends."""
    a = low
    b = high
    fa = at_low
    fb = at_high
    if fa == 0.0 or fa * fb > 0.0:
        return high
    side = 0
    wide = 4.0 * spacing(max(math.fabs(low), math.fabs(high)))
    steep = is_steep(at_low, at_high)
    for i in range(STEEP + HALVED if steep else SEARCH):
        if b - a <= wide or fb == 0.0 or fb == fa:
            break
        c = b - fb * (b - a) / (fb - fa)
        if steep and (i >= STEEP or not (math.isfinite(fa) and math.isfinite(fb))):
            c = 0.5 * (a + b)
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


def is_steep(at_low: float, at_high: float) -> bool:
    """Whether one end is so much farther from zero than the other that straight lines lead nowhere.

    Each of these halves what is farther: as many as there are bring it no nearer than that.
    """
    less = min(math.fabs(at_low), math.fabs(at_high))
    more = max(math.fabs(at_low), math.fabs(at_high))
    return not math.isfinite(more) or more > math.pow(2.0, float(SEARCH)) * less


def sampled_at(e: Engine, g: Locator, k: int, a: int, t: float) -> float:
    """Return comparison a of guard k at t, as it was sampled there if it was."""
    if g.sampled and not is_asleep(g, k):
        for i in range(SAMPLES):
            if g.t[i] == t:
                return g.shape[a * SAMPLES + i]
    return atom_at(e, g, a, t)


def bracket(e: Engine, g: Locator, k: int, low: float, high: float) -> float:
    """Return the first instant in ``(low, high]`` at which guard k holds."""
    turned = 0
    which = 0
    at_low = 0.0
    at_high = 0.0
    crosses = False
    for a in range(g.atom_first[k], g.atom_first[k + 1]):
        before = sampled_at(e, g, k, a, low)
        after = sampled_at(e, g, k, a, high)
        if (before > 0.0) != (after > 0.0) or before * after == 0.0:
            turned += 1
            which = a
            at_low = before
            at_high = after
            crosses = before != 0.0 and before * after <= 0.0
    g.bracket_low = low
    g.bracket_high = high
    if turned == 1 and crosses:
        at = root_between(e, g, which, low, at_low, high, at_high)
        # in next to no time all that is compared may be rounding
        lasts = at - e.step.t0 > AT_ONCE * e.span
        around(e, g, k, at, False, which if lasts else -1, (at_high - at_low) / (high - low))
        return halve(e, g, k)
    forget_asked(g)
    return halve(e, g, k)


def halve(e: Engine, g: Locator, k: int) -> float:
    """Return the end of the bracket of a guard, made a few last places wide by halves."""
    low = g.bracket_low
    high = g.bracket_high
    wide = 4.0 * spacing(max(math.fabs(low), math.fabs(high)))
    while high - low > wide and not g.failed:
        middle = 0.5 * (low + high)
        if asked_at(e, g, k, middle):
            high = middle
        else:
            low = middle
    return high


def around(
    e: Engine, g: Locator, k: int, here: float, known: bool, which: int, rate: float
) -> None:
    """Narrow the bracket to near the root of its comparison, at which `known` says that it holds.

    The guard may hold a little before it, because rounding counts as zero, or a little after, where
    the comparison is strict. All guards are asked alike: a bounce ever smaller begins and ends at
    the same distance then. Of comparison `which`, if it is not negative, the `rate` is about known.
    """
    forget_asked(g)
    reach = 4.0 * spacing(here)
    low = g.bracket_low
    high = g.bracket_high
    far = here + NEXT_TO * reach
    if known or holds_at(e, g, k, here):
        g.already = here
        if not g.rounded and g.part[k] < 0:
            g.bracket_low = here
            g.bracket_high = here
            return
        far = here - NEXT_TO * reach
        yes = here
        at = here - reach
        while at > low and not g.failed and asked_at(e, g, k, at):
            yes = at
            reach = 2.0 * reach
            at = here - reach
            if at == far and which >= 0:
                find_rim(e, g, k, which, rate, yes)
        g.bracket_low = max(at, low)
        g.bracket_high = yes
        return
    g.not_yet = here
    no = here
    at = here + reach
    while at < high and not g.failed and not asked_at(e, g, k, at):
        no = at
        reach = 2.0 * reach
        at = here + reach
        if at == far and which >= 0:
            find_rim(e, g, k, which, rate, no)
    g.bracket_low = no
    g.bracket_high = min(at, high)
