"""Motion of stiff springs between masses, integrated up to where a spring changes its phase.

    p' = force(d),    d' = -way (base + w p),    force = k d**exponent while a spring acts

A leapfrog of equal steps is symmetric: its error is a series in even powers of its step. Steps of
one length, two halves, ... are extrapolated to no step at all (E. Hairer, S. P. Norsett, G. Wanner,
*Solving Ordinary Differential Equations I*, II.14, with the harmonic sequence), and the difference
of the last two answers is the error. Where a phase ends within a step, that step is made again,
shorter, until it ends there.
"""

import math
from typing import Final

from hybond.engine.impacts.impact_records import COLUMNS, Compliant

MARGIN: Final = 1e-14
"""A contact changes its phase when it is past its bound by this much, in scaled variables: then a
value that only touches the bound by rounding never repeats an event."""
TURN: Final = 0.5
"""Part of a radian that the fastest oscillation may turn in a step: no phase hides in one."""
MOST_STEPS: Final = 200000
LOCATING: Final = 200
LEAST_FACTOR: Final = 0.1
MOST_FACTOR: Final = 4.0


def find_forces(c: Compliant) -> None:
    """Find the forces of the springs as they are."""
    for a in range(c.n):
        c.force[a] = force_at(c, a, c.d[a])


def force_at(c: Compliant, a: int, d: float) -> float:
    """Return the force of a spring; odd in `d`, so that it is smooth where a step goes too far."""
    if c.acts[a] == 0 or d == 0.0:
        return 0.0
    if c.exponent == 1.0:
        return c.k[a] * d
    size = math.fabs(d)
    part = size * math.sqrt(size) if c.exponent == 1.5 else math.pow(size, c.exponent)
    return math.copysign(c.k[a] * part, d)


def find_separations(c: Compliant) -> None:
    """Find the separating velocities as they are."""
    for a in range(c.n):
        c.v[a] = c.base[a]
        for b in range(c.n):
            c.v[a] += c.w[a * c.n + b] * c.p[b]


def find_rate(c: Compliant, a: int) -> float:
    """Return the rate of a separating velocity under the forces that were found last."""
    total = 0.0
    for b in range(c.n):
        total += c.w[a * c.n + b] * c.force[b]
    return total


def advance_phase(c: Compliant, tolerance: float) -> bool:
    """Go on to the end of the phase; False if there is none within so many steps."""
    find_separations(c)
    for a in range(c.n):
        c.keep_margin[a] = MARGIN + max(0.0, -float(c.keeps[a]) * c.v[a])
        c.last_margin[a] = MARGIN + max(0.0, -c.d[a])
    while c.steps < MOST_STEPS:
        c.steps += 1
        find_forces(c)
        before = least_left(c, False)
        h = min(c.h, longest_step(c))
        error = make_spring_step(c, h) / tolerance
        if not error <= 1.0:
            part = 0.9 * math.pow(error, -1.0 / (2.0 * float(COLUMNS) - 1.0))
            c.h = h * (max(part, LEAST_FACTOR) if part == part else LEAST_FACTOR)
            if not c.h > 0.0:
                return False
            continue
        longer = 0.9 * math.pow(max(error, 1e-30), -1.0 / (2.0 * float(COLUMNS) - 1.0))
        c.h = h * min(max(longer, LEAST_FACTOR), MOST_FACTOR)
        after = least_left(c, True)
        if after <= 0.0:
            end_at(c, h, before, after)
            take_step(c)
            return True
        take_step(c)
    return False


def longest_step(c: Compliant) -> float:
    """Return how long a step may be, of the fastest oscillation about this state."""
    square = 0.0
    for a in range(c.n):
        if c.acts[a] != 0 and c.d[a] > 0.0:
            slope = c.exponent * c.force[a] / c.d[a]
            square += c.way[a] * c.w[a * c.n + a] * slope
    return TURN / math.sqrt(square) if square > 0.0 else math.inf


def make_spring_step(c: Compliant, h: float) -> float:
    """Put what a step adds to p and d into `c.gain`; return its error, relative to their sizes."""
    wide = 2 * c.n
    for a in range(wide):
        c.gain[a] = 0.0
    for j in range(COLUMNS):
        leap(c, h / float(j + 1), j + 1)
        for a in range(wide):
            new = c.half[a]
            for k in range(j):
                ratio = float(j + 1) / float(j - k)
                old = c.table[k * wide + a]
                c.table[k * wide + a] = new
                new += (new - old) / (ratio * ratio - 1.0)
            c.table[j * wide + a] = new
            # by how much the last answer but one was off
            c.off[a] = new - c.gain[a]
            c.gain[a] = new
    most = 0.0
    for a in range(wide):
        size = math.fabs(c.p[a]) if a < c.n else math.fabs(c.d[a - c.n])
        error = math.fabs(c.off[a]) / (1.0 + size)
        if not error <= most:
            most = error
    return most


def leap(c: Compliant, h: float, many: int) -> None:
    """Put what so many leapfrog steps of length `h` add into `c.half`."""
    n = c.n
    for a in range(n):
        c.half[a] = 0.5 * h * c.force[a]
        c.half[n + a] = 0.0
    for turn in range(many):
        for a in range(n):
            c.inner[a] = c.v[a]
            for b in range(n):
                c.inner[a] += c.w[a * n + b] * c.half[b]
        part = h if turn < many - 1 else 0.5 * h
        for a in range(n):
            c.half[n + a] -= h * c.way[a] * c.inner[a]
            c.half[a] += part * force_at(c, a, c.d[a] + c.half[n + a])


def take_step(c: Compliant) -> None:
    """Add what the step found."""
    for a in range(c.n):
        c.p[a] += c.gain[a]
        c.d[a] += c.gain[c.n + a]
    find_separations(c)


def least_left(c: Compliant, ahead: bool) -> float:
    """Return how far the nearest end of a phase is; of the step that was made, if `ahead`."""
    n = c.n
    least = math.inf
    for a in range(n):
        if c.keeps[a] != 0:
            v = c.v[a]
            if ahead:
                for b in range(n):
                    v += c.w[a * n + b] * c.gain[b]
            least = min(least, float(c.keeps[a]) * v + c.keep_margin[a])
        if c.lasts[a] != 0:
            d = c.d[a] + c.gain[n + a] if ahead else c.d[a]
            least = min(least, d + c.last_margin[a])
    return least


def end_at(c: Compliant, h: float, before: float, after: float) -> None:
    """Make the step shorter, of length `h`, so that it ends where the phase does, or just behind.

    Regula falsi with Illinois's halving, and bisection where that is slow.
    """
    low = 0.0
    high = h
    left = before
    right = after
    turn = 0
    side = 0
    while turn < LOCATING and right < -MARGIN:
        turn += 1
        middle = high - right * (high - low) / (right - left)
        if turn % 4 == 0 or not (middle > low and middle < high):
            middle = low + 0.5 * (high - low)
        if not (middle > low and middle < high):
            break
        make_spring_step(c, middle)
        found = least_left(c, True)
        if found <= 0.0:
            high = middle
            right = found
            left = 0.5 * left if side == 1 else left
            side = 1
        else:
            low = middle
            left = found
            right = 0.5 * right if side == 2 else right
            side = 2
    make_spring_step(c, high)
