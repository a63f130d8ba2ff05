"""Kinks that a step comes nowhere near: they are not sampled.

What is compared may be a sum of the state, as where a table of a storage bends: a polynomial of the
step, which is clear of zero all over it. Of nothing else is that known from a few looks: what bends
by ``max(0, ...)`` of a lobe may be flat where the step begins, in its middle and where it ends, and
have passed zero there and back in between, by steps that see no error.
"""

from __future__ import annotations

from hybond.engine.engine import Engine
from hybond.engine.guards.far_guards import is_far
from hybond.engine.guards.locator import Locator


def stays_afar(e: Engine, g: Locator, k: int) -> bool:
    """Whether the kink of guard k is a sum of the state that keeps its sign all over the step."""
    if g.side[k] == 0 or e.slide.k > 0:
        return False
    return is_far(e, g, k) and g.sign[g.atom_first[k]] == g.side[k]
