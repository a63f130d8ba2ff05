"""The last part of a slip in the plane, down to rest.

Close to rest the speed falls to zero in a finite time, while the direction turns at a rate that
goes with the friction over the speed. The rest of the way is done in steps that fall with the speed
itself. Once the direction does not turn any more it is held, and what remains is motion on a
straight line. Each step is compared with two of half its length.
"""

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats
from hybond.engine.algebra.rounding import SMALLEST
from hybond.engine.answers import machine_name
from hybond.engine.engine import NOT_FINITE, OK, REFUSED, Engine, say_fault
from hybond.engine.model import Model
from hybond.engine.planar.planar_records import Planar
from hybond.engine.reasons.facts import add_fact
from hybond.engine.surfaces.values import evaluate, field
from hybond.engine.words import Floats

DESCENT_PART: Final = 0.2
"""Part of the time in which the direction turns, or the speed is gone, which one step takes."""
STRAIGHT: Final = 0.999
"""Part of the time that is left which one step takes where the direction does not turn."""
MOVES: Final = 1e-3
"""Part of its largest value by which a velocity is moved to see how fast it does."""
SLIP_ROUNDING: Final = 1e-14
"""Part of the largest speed below which one straight step ends slip."""
SLIP_CLOSE: Final = 1e-9
"""Part of the largest speed within which slip that passes rest has come to rest."""
FROZEN: Final = 1e30
"""Speed beside which any slip is nothing."""
DESCENT_STEPS: Final = 20000
DESCENT_HALVINGS: Final = 40
DESCENT_WRONG: Final = 1e-6
"""Part of its own change by which a step may be wrong."""
DESCENT_FINE: Final = 1e-9
"""The same of what is stored."""
DESCENT_NOTHING: Final = 1e-12
"""The same of the largest change of all."""

DESCENDS: Final = 0
IS_DOWN: Final = 1
ENDLESS: Final = 2


def slip_velocity(m: Model, d: int, v: Floats, way: int) -> float:
    """Return the slip velocity of a disk in one of its directions."""
    row = 2 * m.disk_port[2 * d + way]
    total = 0.0
    for i in range(m.pair_first[row], m.pair_first[row + 1]):
        total += m.pair_value[i] * v[m.bond_slot + m.pair_column[i]]
    return total


def least_slip(p: Planar, d: int) -> float:
    """Return the speed below which one straight step is the rest of the way."""
    return max(SLIP_ROUNDING * p.largest[d], 10.0 * SMALLEST)


def slow_place(m: Model, d: int) -> int:
    """Return where in the state the speed stands at which slip ends."""
    return m.storages + m.disk_slow[d]


def freeze(e: Engine, d: int, angle: float, y: Floats, held: Floats) -> None:
    """Put the state there with the direction of slip held."""
    m = e.model
    copy_floats(e.states, y, held)
    held[m.storages + m.disk_heading[d]] = angle
    held[slow_place(m, d)] = -FROZEN


def begin_descent(e: Engine, t: float, y: Floats) -> bool:
    """Whether any slip is slow enough to be led to its end."""
    m = e.model
    p = e.planar
    any_slips = False
    p.steps = 0
    for d in range(m.disks):
        p.ours[d] = 0
        p.ends[d] = 0
        p.ahead[d] = 0.0
        slips = e.state[m.disk_machine[d]] != 0 and y[slow_place(m, d)] > 0.0
        p.still[d] = 1 if slips else 0
        any_slips = any_slips or slips
    return any_slips and take_slow(e, t, y)


def take_slow(e: Engine, t: float, y: Floats) -> bool:
    """Take the slips that are slow enough; return whether there are any."""
    m = e.model
    p = e.planar
    evaluate(e, e.mode, p.v, t, y)
    some_slow = False
    for d in range(m.disks):
        if p.still[d] != 0:
            speed = math.hypot(slip_velocity(m, d, p.v, 0), slip_velocity(m, d, p.v, 1))
            if speed <= y[slow_place(m, d)] * (1.0 + DESCENT_FINE):
                p.still[d] = 0
                p.ours[d] = 1
        some_slow = some_slow or p.ours[d] != 0
    return some_slow


def slip_later(e: Engine, d: int, t: float, y: Floats, h: float, rate: Floats) -> None:
    """Put the slip velocity a time h later into `p.slip`."""
    p = e.planar
    for k in range(e.states):
        p.moved[k] = y[k] + h * rate[k]
    evaluate(e, e.mode, p.v, t + h, p.moved)
    p.slip[0] = slip_velocity(e.model, d, p.v, 0)
    p.slip[1] = slip_velocity(e.model, d, p.v, 1)


def find_ahead(e: Engine, d: int, t: float, y: Floats) -> float:
    """Return a time in which the slip velocity moves by a small part of its largest value."""
    p = e.planar
    size = 0.0
    most = p.largest[d]
    for k in range(e.states):
        size = max(size, math.fabs(p.rate[k]))
        most = max(most, math.fabs(y[k]))
    h = 1e-6 * most / max(size, 1e-300)
    for _ in range(3):
        slip_later(e, d, t, y, h, p.rate)
        moved = math.hypot(p.slip[0] - p.fx[d], p.slip[1] - p.fy[d])
        if moved <= 0.0:
            break
        h *= MOVES * p.largest[d] / moved
    return h


def find_approach(e: Engine, d: int, t: float, y: Floats) -> int:
    """Find how one slip comes to rest; p.rate is the rate at y."""
    m = e.model
    p = e.planar
    evaluate(e, e.mode, p.v, t, y)
    p.fx[d] = slip_velocity(m, d, p.v, 0)
    p.fy[d] = slip_velocity(m, d, p.v, 1)
    speed = math.hypot(p.fx[d], p.fy[d])
    p.now[d] = speed
    # a velocity follows what is stored smoothly: a difference gives its slope
    if p.ahead[d] == 0.0:
        h = find_ahead(e, d, t, y)
        p.ahead[d] = h
    ahead = p.ahead[d]
    slip_later(e, d, t, y, ahead, p.rate)
    pull_x = (p.slip[0] - p.fx[d]) / ahead
    pull_y = (p.slip[1] - p.fy[d]) / ahead
    angle = math.atan2(p.fy[d], p.fx[d])
    freeze(e, d, angle, y, p.frozen)
    if field(e, e.mode, t, p.frozen, p.other) != OK:
        return NOT_FINITE
    slip_later(e, d, t, y, ahead, p.other)
    x = p.slip[0]
    z = p.slip[1]
    freeze(e, d, angle + math.pi, y, p.frozen)
    if field(e, e.mode, t, p.frozen, p.other) != OK:
        return NOT_FINITE
    slip_later(e, d, t, y, ahead, p.other)
    friction = 0.5 * math.hypot(x - p.slip[0], z - p.slip[1]) / ahead
    p.falls[d] = 0.0
    p.across[d] = 0.0
    if speed > 0.0:
        p.falls[d] = -(pull_x * p.fx[d] + pull_y * p.fy[d]) / speed
        p.across[d] = math.fabs(pull_x * p.fy[d] - pull_y * p.fx[d]) / speed
    p.left[d] = speed / p.falls[d] if p.falls[d] > 0.0 else 0.0
    p.turns[d] = max(friction, math.hypot(pull_x, pull_y))
    return OK


def is_at_rest(p: Planar, d: int, t: float) -> bool:
    """Whether one straight step is the rest of the way."""
    if p.falls[d] <= 0.0 or p.now[d] <= least_slip(p, d):
        return True
    # or friction would stop it within the rounding of time
    return t + DESCENT_PART * p.now[d] / p.turns[d] == t


def step_descent(e: Engine, t: float, y: Floats, end: float) -> int:
    """Make the next step into ``e.step``: DESCENDS, IS_DOWN if no slip is on its way any more.

    ENDLESS with HB-N408 if the end of a slip is not found.
    """
    m = e.model
    p = e.planar
    take_slow(e, t, y)
    p.steps += 1
    if field(e, e.mode, t, y, p.rate) != OK:
        return ENDLESS
    some_left = False
    for d in range(m.disks):
        if p.ours[d] == 0:
            continue
        if find_approach(e, d, t, y) != OK:
            return ENDLESS
        if p.falls[d] <= 0.0 and p.now[d] > SLIP_CLOSE * p.largest[d]:
            # past the slowest point: slip goes on
            y[slow_place(m, d)] = -least_slip(p, d)
            p.ours[d] = 0
        some_left = some_left or p.ours[d] != 0
    if not some_left:
        return IS_DOWN
    if p.steps > DESCENT_STEPS:
        return no_end(e, t)
    least = math.inf
    ends = False
    calm = True
    for d in range(m.disks):
        p.ends[d] = 0
        if p.ours[d] == 0:
            continue
        if is_at_rest(p, d, t):
            ends = True
            p.ends[d] = 1
            least = min(least, p.left[d])
            p.heading[d] = math.atan2(p.fy[d], p.fx[d])
        calm = calm and p.across[d] * p.left[d] <= SLIP_ROUNDING * p.largest[d]
    if ends:
        h = min(least, end - t)
        if not (t + h < end or t + h == t):
            for d in range(m.disks):
                p.ends[d] = 0
        for k in range(e.states):
            p.final[k] = y[k] + h * p.rate[k]
        put_curve(e, t, y, h, p.final, p.rate, p.rate)
        return DESCENDS
    copy_floats(e.states, y, p.y)
    for d in range(m.disks):
        if p.ours[d] == 0:
            continue
        if calm:
            freeze(e, d, math.atan2(p.fy[d], p.fx[d]), p.y, p.frozen)
            copy_floats(e.states, p.frozen, p.y)
            least = min(least, STRAIGHT * p.left[d])
        else:
            least = min(least, DESCENT_PART * p.now[d] / max(p.falls[d], p.turns[d]))
    return control_descent(e, t, y, min(least, end - t))


def control_descent(e: Engine, t: float, y: Floats, h: float) -> int:
    """Make a step of at most h that agrees with two of half its length.

    `p.y` is `y` with what is held on the way: directions.
    """
    p = e.planar
    n = e.states
    if field(e, e.mode, t, p.y, p.first) != OK:
        return ENDLESS
    for _ in range(DESCENT_HALVINGS):
        good = classical(e, t, p.y, h, p.first, p.whole)
        good = classical(e, t, p.y, 0.5 * h, p.first, p.middle) and good
        good = good and field(e, e.mode, t + 0.5 * h, p.middle, p.second) == OK
        if good:
            copy_floats(n, p.second, p.other)
            good = classical(e, t + 0.5 * h, p.middle, 0.5 * h, p.other, p.half)
        most = 0.0
        for k in range(n):
            most = max(most, math.fabs(h * p.first[k]))
        for k in range(n):
            allowed = DESCENT_WRONG * math.fabs(h * p.first[k])
            allowed += DESCENT_FINE * math.fabs(p.y[k]) + DESCENT_NOTHING * most
            good = good and math.fabs(p.half[k] - p.whole[k]) <= allowed
        if good:
            for k in range(n):
                p.final[k] = p.half[k] + (p.half[k] - p.whole[k]) / 15.0
            if field(e, e.mode, t + h, p.final, p.fourth) != OK:
                return ENDLESS
            for k in range(n):
                if p.y[k] != y[k]:
                    p.final[k] = y[k]
            put_curve(e, t, y, h, p.final, p.first, p.fourth)
            return DESCENDS
        h *= 0.5
    return no_end(e, t)


def classical(e: Engine, t: float, y: Floats, h: float, first: Floats, there: Floats) -> bool:
    """Put the state a time h later there, by the classical method of order four."""
    p = e.planar
    n = e.states
    for k in range(n):
        p.moved[k] = y[k] + 0.5 * h * first[k]
    if field(e, e.mode, t + 0.5 * h, p.moved, p.second) != OK:
        return False
    for k in range(n):
        p.moved[k] = y[k] + 0.5 * h * p.second[k]
    if field(e, e.mode, t + 0.5 * h, p.moved, p.third) != OK:
        return False
    for k in range(n):
        p.moved[k] = y[k] + h * p.third[k]
    if field(e, e.mode, t + h, p.moved, p.fourth) != OK:
        return False
    for k in range(n):
        inner = first[k] + 2.0 * p.second[k] + 2.0 * p.third[k] + p.fourth[k]
        there[k] = y[k] + h / 6.0 * inner
    return True


def put_curve(
    e: Engine, t: float, y: Floats, h: float, there: Floats, first: Floats, last: Floats
) -> None:
    """Let the last step be this one, with Hermite's cubic between its ends."""
    s = e.step
    n = e.states
    s.t0 = t
    s.t1 = t + h
    e.curved = True
    for k in range(n):
        rise = there[k] - y[k]
        s.y0[k] = y[k]
        s.y1[k] = there[k]
        s.dense[k] = h * first[k]
        s.dense[n + k] = 3.0 * rise - h * (2.0 * first[k] + last[k])
        s.dense[2 * n + k] = h * (first[k] + last[k]) - 2.0 * rise
        s.dense[3 * n + k] = 0.0


def end_descent(e: Engine, t: float, y: Floats) -> None:
    """Put the state at the end of the descent there, wherever that is."""
    m = e.model
    p = e.planar
    evaluate(e, e.mode, p.v, t, y)
    for d in range(m.disks):
        if p.ours[d] == 0:
            continue
        speed = math.hypot(slip_velocity(m, d, p.v, 0), slip_velocity(m, d, p.v, 1))
        if p.ends[d] != 0:
            # the law has the direction in which slip ended, until it is decided anew
            y[m.storages + m.disk_heading[d]] = p.heading[d]
            y[slow_place(m, d)] = -max(10.0 * speed, least_slip(p, d))
        else:
            y[slow_place(m, d)] = 0.5 * speed


def no_end(e: Engine, t: float) -> int:
    """Refuse a slip whose end is not found."""
    place = machine_name(e.model, e.model.disk_machine[0])
    if say_fault(e, "HB-N408", "the end of this slip is not found", place) == REFUSED:
        e.fault.t = t
    if e.model.tells != 0:
        add_fact(e.fault, 1.0)
        for d in range(e.model.disks):
            if e.planar.ours[d] != 0:
                add_fact(e.fault, float(e.model.disk_machine[d]))
    return ENDLESS


def any_ends(e: Engine) -> bool:
    """Whether the last step has brought a slip to rest."""
    found = False
    for d in range(e.model.disks):
        found = found or e.planar.ends[d] != 0
    return found
