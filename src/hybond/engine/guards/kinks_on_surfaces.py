"""Kinks that lie on the surfaces along which a run slides: a sign of what a relay holds at zero.

What they compare is zero all along, and has the sign of rounding, or of what a step drifts off the
surfaces before it is put back: it passes nothing. So they are looked at where the state has been
put on the surfaces, at the end of the step and halfway there.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.guards.guard_values import atom_at, atom_here, look_at_state, size_here
from hybond.engine.guards.locator import Locator
from hybond.engine.methods.stepping import between
from hybond.engine.surfaces.onto import onto_surfaces

ON: Final = 1e-11
"""Part of its terms up to which what is compared is zero on the surfaces."""


def lies_on_surfaces(e: Engine, g: Locator, k: int) -> bool:
    """Whether the kink of guard k stays on the surfaces in the whole step.

    Where the state cannot be put on them there it does not.
    """
    a = g.atom_first[k]
    y = g.shifted_y
    here = math.fabs(atom_at(e, g, a, e.step.t0))
    size = size_here(e, g, a)
    if not here <= ON * size:
        return False
    refusal = e.refusal
    lies = True
    for half in range(2):
        t = e.step.t1 if half == 0 else 0.5 * (e.step.t0 + e.step.t1)
        if lies:
            between(e, t, y)
            lies = onto_surfaces(e, t, y) == OK
            e.slide.known = False
        if lies:
            look_at_state(e, g, t, y)
            here = math.fabs(atom_here(e, g, a))
            size = size_here(e, g, a)
            lies = here <= ON * size
    g.looked = math.nan
    e.refusal = refusal
    return lies
