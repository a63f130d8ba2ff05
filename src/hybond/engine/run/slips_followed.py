"""Slip in the plane: steps that follow it, and the way to its end."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.guards.locate import locate
from hybond.engine.guards.watching import watch
from hybond.engine.methods.stepping import retry
from hybond.engine.planar.descent import (
    ENDLESS,
    IS_DOWN,
    any_ends,
    begin_descent,
    end_descent,
    step_descent,
)
from hybond.engine.planar.stops import follows_slip
from hybond.engine.run.noted import note
from hybond.engine.run.run_records import Run
from hybond.engine.run.stranded import no_slip
from hybond.engine.surfaces.values import begin_field

SHORTER: Final = 30
"""Times that a step is repeated, each time a quarter as long, if it does not follow slip."""


def follow(e: Engine) -> int:
    """Repeat a step shorter until it follows slip in the plane."""
    for _ in range(SHORTER):
        if follows_slip(e):
            return OK
        h = 0.25 * (e.step.t1 - e.step.t0)
        if e.step.t0 + h == e.step.t0:
            if e.model.tells != 0:
                return no_slip(e)
            return say_fault(e, "HB-N408", "no step follows the slip", "")
        if retry(e, e.step.t0 + h) != OK:
            return REFUSED
    return OK


def lead_to_rest(e: Engine, r: Run, end: float) -> int:
    """Lead slip in the plane to its end, if it is about to end."""
    m = e.model
    p = e.planar
    if not begin_descent(e, e.t, e.y):
        return OK
    p.leading = True
    watch(e, r.locator, e.state)
    p.leading = False
    begin_field(e, e.mode)
    while e.t < end:
        found = step_descent(e, e.t, e.y, end)
        if found == ENDLESS:
            return REFUSED
        if found == IS_DOWN or e.step.t1 == e.step.t0:
            break
        r.locator.held = False
        if locate(e, r.locator) != OK:
            return REFUSED
        if r.locator.at < math.inf:
            for d in range(m.disks):
                p.ends[d] = 0
            if note(e, r, r.locator.at, r.locator.at) != OK:
                return REFUSED
            break
        if note(e, r, e.step.t1, e.step.t1) != OK:
            return REFUSED
        if any_ends(e):
            break
    end_descent(e, e.t, e.y)
    return OK
