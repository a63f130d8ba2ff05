"""Stages at which rates are those that states move by, where a law is flat at rest.

Two tanks that a pipe ``k*f*abs(f)`` has made level differ by next to nothing, and the flow is the
root of that: stages that are right by many digits more than their tolerance may say a flow that is
many times what passes. What passes is known all the same, since the stages move by it. So they are
corrected, each by slopes of its own over differences that are short beside what drives the flow,
until both agree.

Where all that drives a flow is rounding nothing can be found, and the stages stay what they were.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.algebra.lu import SINGULAR, lu_factor, lu_solve
from hybond.engine.algebra.products import copy_floats
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.implicit.from_edges import FEW, end_stages, put_whole
from hybond.engine.methods.implicit.radau_factors import BUTCHER_INVERSE
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.methods.implicit.radau_stages import place_stages, stage_rates
from hybond.engine.methods.implicit.rates_in_stages import IN_STAGES
from hybond.engine.words import Floats

SHORT_PART: Final = 2.0**-36
"""Part of a state that it is shifted by: what drives a flow may be a billionth of it."""
TRIES: Final = 24
"""Corrections, each of which lessens what is left: that of a root takes half of its digits."""
LEAST: Final = 0.125
"""The least part of a correction that is tried: a root is thrown beyond zero by twice what it is
off by, the root of a cube by thrice."""
OWN: Final = 1e-3
"""Part of itself that a rate may be off by, where tolerances of states would allow more."""
AGREE: Final = 0.1
"""Part of what rates may be off by that is left open."""


def settle_rates(e: Engine, r: Radau, rtol: float) -> bool:
    """Correct the stages until rates there are those that they move by; True where that helped.

    Those at the end of the step, of the stages as they are, are in ``r.end``.
    """
    m = e.model
    if m.begins == 0 or m.edges > 0 or m.bends > 0.0 or e.slide.k > 0 or r.n > FEW:
        return False
    n = r.n
    say_what_may(e, r)
    if not apart_at_stage(e, r, 2, r.end) > 1.0:
        return False
    refusal = e.refusal
    if stage_rates(e, r) != OK:
        e.refusal = refusal
        return False
    before = rates_apart(e, r)
    many = 3 * n
    fit(r.whole, many * many)
    fit(r.left_over, many)
    fit(r.kept, many)
    fit(r.slopes_before, n * n)
    fit_places(r.whole_row, many)
    copy_floats(n * n, r.jacobian, r.slopes_before.at)
    left = before
    for _ in range(TRIES):
        copy_floats(many, r.z, r.kept.at)
        put_whole(e, r, rtol, SHORT_PART)
        if lu_factor(many, r.whole.at, r.whole_row.at) == SINGULAR:
            break
        lu_solve(many, r.whole.at, r.whole_row.at, 1, r.left_over.at)
        now = lessened(e, r, left)
        if not now < left:
            break
        left = now
        if now <= AGREE:
            break
    e.refusal = refusal
    if not left < before:
        copy_floats(n * n, r.slopes_before.at, r.jacobian)
        return False
    end_stages(r)
    # what is left may still be more than a flow may be off by
    r.swings = left > 1.0
    return True


def lessened(e: Engine, r: Radau, left: float) -> float:
    """Correct the stages by ``r.left_over``, or a part that lessens what is left; return that.

    Where none does they are what they were.
    """
    many = 3 * r.n
    part = 1.0
    while part >= LEAST:
        for k in range(many):
            r.z[k] = r.kept.at[k] + part * r.left_over.at[k]
        place_stages(r)
        if stage_rates(e, r) == OK:
            now = rates_apart(e, r)
            if now < left:
                return now
        part *= 0.5
    copy_floats(many, r.kept.at, r.z)
    place_stages(r)
    return left if stage_rates(e, r) == OK else math.inf


def say_what_may(e: Engine, r: Radau) -> None:
    """Put what rates of storages may be off by, times the step, into ``r.swung``.

    That is a part of the largest by which the state moves at stages, and no more than tolerances of
    states say over the step.
    """
    for i in range(e.model.storages):
        size = 0.0
        for s in range(3):
            size = max(size, math.fabs(moved_at_stage(r, s, i)))
        r.swung[i] = OWN * size
        if r.tolerance[i] > 0.0:
            r.swung[i] = min(r.swung[i], IN_STAGES * r.tolerance[i])


def moved_at_stage(r: Radau, s: int, i: int) -> float:
    """Return the rate by which a state moves at a stage, times the step."""
    total = 0.0
    for j in range(3):
        total += BUTCHER_INVERSE[3 * s + j] * r.z[j * r.n + i]
    return total


def rates_apart(e: Engine, r: Radau) -> float:
    """Return the most that a rate at a stage is not what states move by, in what it may be."""
    most = 0.0
    for s in range(3):
        for i in range(r.n):
            r.end[i] = r.f[s * r.n + i]
        most = max(most, apart_at_stage(e, r, s, r.end))
    return most


def apart_at_stage(e: Engine, r: Radau, s: int, rate: Floats) -> float:
    """Return the most that rates are not what states move by at a stage, in what they may be."""
    most = 0.0
    for i in range(e.model.storages):
        off = math.fabs(r.h * rate[i] - moved_at_stage(r, s, i))
        if off > 0.0:
            most = max(most, off / r.swung[i] if r.swung[i] > 0.0 else math.inf)
    return most
