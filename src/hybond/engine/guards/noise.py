"""Whether what samples of a comparison leave unexplained is noise, of which halving shows no more.

A law of large gain makes much of the last digit of what it reads: an amplifier of ten thousand.
Bond variables behind it are as rough as that, whatever a guard makes of them. Instants next to each
other tell: there a signal moves by next to nothing, and noise by as much as anywhere.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.engine import Engine
from hybond.engine.guards.guard_values import atom_here, look
from hybond.engine.guards.locator import SAMPLES, Locator

PLACES: Final = 2
NEIGHBOURS: Final = 4
"""Noise is everywhere: it is looked for at so many places of a block, by so many instants each."""
BESIDE: Final = 2.0**-20
"""Part of the block by which they are apart: far less than the least block halving leads to."""
FEWEST: Final = 8.0
"""Units of rounding of the time that they are apart at the least, ..."""
WIDE: Final = 1e3
"""... which is this much less than a block."""
TIMES: Final = 2.0
"""What noise leaves of nine samples, in parts of its spread over a few, at the most."""


def is_noise(e: Engine, g: Locator, k: int, a: int) -> bool:
    """Whether comparison a, of guard k, moves as much between neighbours as samples leave open."""
    if g.margin[k] >= 0:
        return False
    for place in range(PLACES):
        at = 0.5 * (g.t[2 + 3 * place] + g.t[3 + 3 * place])
        spread = spread_near(e, g, a, at)
        if not TIMES * spread >= g.rest[a]:
            return False
    return True


def spread_near(e: Engine, g: Locator, a: int, at: float) -> float:
    """Return how far a comparison is spread over a few instants next to each other; 0: no room."""
    width = g.t[SAMPLES - 1] - g.t[0]
    apart = max(BESIDE * width, FEWEST * EPSILON * math.fabs(at))
    if not WIDE * apart < width:
        return 0.0
    least = math.inf
    most = -math.inf
    for i in range(NEIGHBOURS):
        look(e, g, at + float(i) * apart)
        here = atom_here(e, g, a)
        least = min(least, here)
        most = max(most, here)
    return most - least
