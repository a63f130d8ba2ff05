"""Kinks that end no steps for a while: ending many of them at what a law hardly tells is costly.

A kink that a motion passes over and over, or that ends step after step, is left out for so many
steps, twice as many each time. Steps over it are as long as their error allows. What time alone
decides is where it is, whatever the motion does there: it crowds with no other, and is left out
only for what it does itself.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.guards.locator import NO_KINK, Locator

LONGEST_NAP: Final = 4096
"""Steps for which a kink ends none, at the most."""


def is_asleep(g: Locator, k: int) -> bool:
    """Whether guard k is a kink that ends no step just now."""
    if g.side[k] == NO_KINK:
        return False
    return (g.asleep > 0 and g.timed[k] == 0) or g.sleep[k] > 0 or g.blurred[k] != 0


def let_sleep(g: Locator, k: int) -> None:
    """Let a kink end no steps for a while, longer each time."""
    g.sleep[k] = g.nap[k]
    g.nap[k] = min(2 * g.nap[k], LONGEST_NAP)


def pass_step(g: Locator) -> None:
    """Count a step for kinks that are asleep."""
    g.asleep = max(g.asleep - 1, 0)
    for k in range(g.guards):
        g.sleep[k] = max(g.sleep[k] - 1, 0)
