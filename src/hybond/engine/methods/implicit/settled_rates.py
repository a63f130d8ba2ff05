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
from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.explicit.one_instant import jump_lies_between
from hybond.engine.methods.implicit.from_edges import end_stages
from hybond.engine.methods.implicit.radau_factors import BUTCHER_INVERSE
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.methods.implicit.radau_stages import place_stages, stage_rates
from hybond.engine.methods.implicit.rates_in_stages import IN_STAGES
from hybond.engine.methods.implicit.whole_stages import fit_whole, join, solve_whole
from hybond.engine.surfaces.values import evaluate

MOST: Final = 400
"""States of a part up to which its stages are solved for at once."""
NEARER_EDGE: Final = 0.5
"""Part of the longer way to an edge that the shorter one, at the other end of a step, is to be."""
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

    Those at the end of the step, of the stages as they are, are in ``r.end``. Behind a jump of a
    law they are others: the step is to end there.
    """
    m = e.model
    if m.begins == 0 or m.bends > 0.0 or e.slide.k > 0:
        return False
    n = r.n
    say_what_may(e, r)
    take_apart(e, r)
    if r.parts == 0 or goes_over_jump(e, r):
        return False
    join(r)
    if r.parts > MOST:
        return False
    refusal = e.refusal
    if is_beside_edge(e, r) or stage_rates(e, r) != OK:
        e.refusal = refusal
        return False
    before = rates_apart(e, r)
    fit_whole(r)
    fit(r.slopes_before, n * n)
    copy_floats(n * n, r.jacobian, r.slopes_before.at)
    left = before
    for _ in range(TRIES):
        copy_floats(3 * n, r.z, r.kept.at)
        if not solve_whole(e, r, rtol, SHORT_PART):
            break
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
    # what is left may still be more than a flow may be off by; beside where laws end, what is left
    # of a tank that stands all but empty is no matter
    r.swings = left > 1.0 and m.edges == 0
    return True


def goes_over_jump(e: Engine, r: Radau) -> bool:
    """Whether a kink that is no root lies between where the step begins and where it ends."""
    copy_part(r.n, r.y, 2 * r.n, r.shifted, 0)
    return jump_lies_between(e, r.t1, r.y0, r.shifted)


def take_apart(e: Engine, r: Radau) -> None:
    """Let the part be the storages whose rates at the end are not what they move by."""
    fit_places(r.part, r.n)
    r.parts = 0
    for i in range(e.model.storages):
        if apart_in_stage(r, 2, i, r.end[i]) > 1.0:
            r.part.at[r.parts] = i
            r.parts += 1


def is_beside_edge(e: Engine, r: Radau) -> bool:
    """Whether a step comes much nearer to where a law ends, or from there: both have their ways.

    What is beyond an edge at both ends has values there: a valve that is shut takes no root.
    """
    m = e.model
    s = e.step
    if m.edges == 0:
        return False
    if evaluate(e, e.mode, e.v, r.t0, r.y0) != OK:
        return True
    for k in range(m.edges):
        s.edge_there[k] = value(m, m.edge_value[k], e.v)
    copy_part(r.n, r.y, 2 * r.n, r.shifted, 0)
    if evaluate(e, e.mode, e.v, r.t1, r.shifted) != OK:
        return True
    for k in range(m.edges):
        there = value(m, m.edge_value[k], e.v)
        if there < 0.0 and s.edge_there[k] < 0.0:
            continue
        if min(there, s.edge_there[k]) < NEARER_EDGE * max(there, s.edge_there[k]):
            return True
    return False


def lessened(e: Engine, r: Radau, left: float) -> float:
    """Correct the stages by ``r.left_over``, or a part that lessens what is left; return that.

    Where none does they are what they were.
    """
    n = r.n
    part = 1.0
    while part >= LEAST:
        for s in range(3):
            for a in range(r.parts):
                k = s * n + r.part.at[a]
                r.z[k] = r.kept.at[k] + part * r.left_over.at[s * r.parts + a]
        place_stages(r)
        if stage_rates(e, r) == OK:
            now = rates_apart(e, r)
            if now < left:
                return now
        part *= 0.5
    copy_floats(3 * n, r.kept.at, r.z)
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
    """Return the most that a rate of the part is not what states move by, in what it may be."""
    most = 0.0
    for s in range(3):
        for a in range(r.parts):
            i = r.part.at[a]
            if i < e.model.storages:
                most = max(most, apart_in_stage(r, s, i, r.f[s * r.n + i]))
    return most


def apart_in_stage(r: Radau, s: int, i: int, rate: float) -> float:
    """Return how much a rate is not what a state moves by at a stage, in what it may be."""
    off = math.fabs(r.h * rate - moved_at_stage(r, s, i))
    if off == 0.0:
        return 0.0
    return off / r.swung[i] if r.swung[i] > 0.0 else math.inf
