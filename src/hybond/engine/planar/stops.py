"""Where slip in the plane comes to its end, and where it begins.

The direction ``f / |f|`` has no limit that an integrator could step over. So slip is left a little
above zero, and led to its end by steps of its own (descent.py).
"""

import math
from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.methods.stepping import between
from hybond.engine.planar.descent import SLIP_CLOSE, freeze, slip_velocity, slow_place
from hybond.engine.planar.planar import NO_SLIP
from hybond.engine.surfaces.values import evaluate, field
from hybond.engine.words import Floats

SLIP_LOW: Final = 1e-4
"""Part of its largest speed at which slip is left to come to its end."""
SLIP_COARSE: Final = 300.0
"""The same in tolerances of the solver."""
SLIP_HIGHEST: Final = 0.3
"""The same at any tolerance: slip must have begun before it can end."""
SLIP_FLOOR: Final = 1e-7
"""The same of the largest speed that it ever had: slower ones are no better than tolerances."""
OUTGROWN: Final = 10.0
"""Slip has begun once it is this much faster than what its heading counts to."""
WEAK: Final = 0.02
"""Part of the friction below which what is left to begin slip with is next to nothing."""
LONGER: Final = 1e-5
"""Part of the speed that friction makes while the force grows by as much as friction, up to which
the heading then counts."""
SLIP_TURNS: Final = 0.5
"""Cosine of the angle by which slip may turn in one step."""
ASTRAY: Final = 0.1
"""Part of its largest change by which a velocity may be off, as an estimate says, in one step."""
PROBE: Final = 1e-6
"""Part of a step in which it is seen what drives slip."""
FIRST_PART: Final = 1e-2
"""Part of what slip gains in that time up to which its heading counts in any case."""
SOON: Final = 1e-7
"""Part of the run in which that growth is looked at."""


def slips_now(e: Engine, d: int) -> bool:
    """Whether a disk slips in the mode."""
    return e.state[e.model.disk_machine[d]] != 0


def arm_slips(e: Engine, t: float, y: Floats) -> None:
    """Put the speeds there from which slips are at their end, after a step."""
    m = e.model
    p = e.planar
    low_part = min(max(SLIP_LOW, SLIP_COARSE * m.rtol), SLIP_HIGHEST)
    if evaluate(e, e.mode, p.v, t, y) != OK:
        return
    for d in range(m.disks):
        if not slips_now(e, d):
            continue
        at = slow_place(m, d)
        speed = math.hypot(slip_velocity(m, d, p.v, 0), slip_velocity(m, d, p.v, 1))
        p.largest[d] = speed if y[at] < 0.0 else max(p.largest[d], speed)
        p.ever[d] = max(p.ever[d], speed)
        low = max(low_part * p.largest[d], SLIP_FLOOR * p.ever[d])
        begun = speed > max(2.0 * low, -OUTGROWN * y[at])
        if begun and low > 4.0 * y[at]:
            y[at] = low


def follows_slip(e: Engine) -> bool:
    """Whether the last step follows slip: without turning it round, at the rate of what drives it.

    Where slip is slow its direction changes faster than any error estimate tells that looks at the
    speed beside the speeds of the whole run.
    """
    m = e.model
    p = e.planar
    some_slip = False
    for d in range(m.disks):
        some_slip = some_slip or slips_now(e, d)
    if not some_slip:
        return True
    h = e.step.t1 - e.step.t0
    for point in range(3):
        t = e.step.t0 if point == 0 else e.step.t0 + 0.5 * h if point == 1 else e.step.t1
        between(e, t, p.y)
        if field(e, e.mode, t, p.y, p.rate) != OK:
            return False
        evaluate(e, e.mode, p.v, t, p.y)
        for d in range(m.disks):
            at = 6 * d + 2 * point
            x = slip_velocity(m, d, p.v, 0)
            z = slip_velocity(m, d, p.v, 1)
            p.points[at] = x
            p.points[at + 1] = z
            # the direction that friction acts against
            ahead = max(-p.y[slow_place(m, d)], NO_SLIP)
            angle = p.y[m.storages + m.disk_heading[d]]
            x += ahead * math.cos(angle)
            z += ahead * math.sin(angle)
            size = math.hypot(x, z)
            p.ways[at] = x / size
            p.ways[at + 1] = z / size
        for k in range(e.states):
            p.moved[k] = p.y[k] + PROBE * h * p.rate[k]
        evaluate(e, e.mode, p.v, t + PROBE * h, p.moved)
        for d in range(m.disks):
            at = 6 * d + 2 * point
            p.gains[at] = (slip_velocity(m, d, p.v, 0) - p.points[at]) / PROBE
            p.gains[at + 1] = (slip_velocity(m, d, p.v, 1) - p.points[at + 1]) / PROBE
    for d in range(m.disks):
        if slips_now(e, d) and goes_astray(e, 6 * d, p.largest[d]):
            return False
    return True


def goes_astray(e: Engine, at: int, largest: float) -> bool:
    """Whether a slip turns in the last step, or is not where what drives it leads."""
    p = e.planar
    for k in range(2):
        a = at + 2 * k
        if p.ways[a] * p.ways[a + 2] + p.ways[a + 1] * p.ways[a + 3] < SLIP_TURNS:
            return True
    # what drives it over the step, by Simpson's rule
    x = (p.gains[at] + 4.0 * p.gains[at + 2] + p.gains[at + 4]) / 6.0
    y = (p.gains[at + 1] + 4.0 * p.gains[at + 3] + p.gains[at + 5]) / 6.0
    off = math.hypot(p.points[at + 4] - p.points[at] - x, p.points[at + 5] - p.points[at + 1] - y)
    most = 0.0
    for k in range(3):
        most = max(most, math.hypot(p.gains[at + 2 * k], p.gains[at + 2 * k + 1]))
    return off > ASTRAY * most + SLIP_CLOSE * largest


def begin_slips(e: Engine, t: float, y: Floats) -> None:
    """Put the state there from which slip begins.

    Friction that breaks loose exactly at its limit has next to no force left to move with: there
    the heading counts a little longer.
    """
    m = e.model
    p = e.planar
    for d in range(m.disks):
        at = slow_place(m, d)
        if not slips_now(e, d) or y[at] >= 0.0:
            continue
        evaluate(e, e.mode, p.v, t, y)
        speed = math.hypot(slip_velocity(m, d, p.v, 0), slip_velocity(m, d, p.v, 1))
        if speed <= -y[at]:
            counts = heading_counts_to(e, d, t, y)
            y[at] = min(y[at], -counts)


def find_push(e: Engine, d: int, t: float, y: Floats, h: float) -> bool:
    """Find what the slip velocity gains in the time h, into `p.slip`."""
    m = e.model
    p = e.planar
    if field(e, e.mode, t, y, p.rate) != OK:
        return False
    evaluate(e, e.mode, p.v, t, y)
    x = slip_velocity(m, d, p.v, 0)
    z = slip_velocity(m, d, p.v, 1)
    for k in range(e.states):
        p.moved[k] = y[k] + h * p.rate[k]
    evaluate(e, e.mode, p.v, t, p.moved)
    p.slip[0] = slip_velocity(m, d, p.v, 0) - x
    p.slip[1] = slip_velocity(m, d, p.v, 1) - z
    return True


def heading_counts_to(e: Engine, d: int, t: float, y: Floats) -> float:
    """Return the speed up to which the heading counts where slip begins."""
    m = e.model
    p = e.planar
    h = SOON * max(e.span - t, t)
    angle = y[m.storages + m.disk_heading[d]]
    freeze(e, d, angle, y, p.y)
    if not find_push(e, d, t, p.y, h):
        return 0.0
    x = p.slip[0]
    z = p.slip[1]
    freeze(e, d, angle + math.pi, y, p.frozen)
    if not find_push(e, d, t, p.frozen, h):
        return 0.0
    friction = 0.5 * math.hypot(x - p.slip[0], z - p.slip[1])
    if math.hypot(x, z) > WEAK * friction:
        return FIRST_PART * math.hypot(x, z)
    if field(e, e.mode, t, p.y, p.rate) != OK:
        return 0.0
    for k in range(e.states):
        p.frozen[k] = p.y[k] + h * p.rate[k]
    if not find_push(e, d, t + h, p.frozen, h):
        return 0.0
    grows = math.hypot(p.slip[0] - x, p.slip[1] - z) / h
    lasts = friction / grows if grows > 0.0 else max(e.span - t, t)
    return LONGER * friction / h * lasts
