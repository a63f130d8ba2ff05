"""Coulomb's disk: the friction force in the plane that a slip velocity and its cause agree on.

A force `p` on the edge of a disk changes a velocity, ``f = f0 - A p``, and must point along it:
``p = L f / |f|``. With ``p = L d`` and ``d = (cos phi, sin phi)`` that is one equation of one
angle, ``d x (f0 - L A d) = 0``, with ``d . (f0 - L A d) >= 0``. The limit may follow the force,
``L = limit + slope . p``.

Source: V. Acary, F. Cadoux, C. Lemarechal, J. Malick, *A formulation of the linear discrete
Coulomb friction problem via convex optimization*, ZAMM 91 (2011).
"""

import math
from typing import Final

from hybond.engine.words import Floats, floats, record

DIRECTIONS: Final = 96
"""Angles at which a change of sign is looked for."""
AGAINST: Final = 1e-9
"""A slip this far against the force, as a part of its terms, is rounding."""
HALVINGS_OF_ANGLE: Final = 70
CLOSED_ANGLE: Final = 1e-16
"""Width of a bracket that has closed, rad."""


@record
class Disk:
    """One problem and its answer, the direction of slip.

    `f0` is the velocity without friction, `a` (2 by 2) what one unit of friction takes from it,
    `limit` and `slope` how large friction is.
    """

    f0: Floats
    a: Floats
    limit: float
    slope: Floats
    x: float
    y: float
    across: float
    along: float


def make_disk() -> Disk:
    """Return a problem of zeros."""
    d = Disk()
    d.f0 = floats(2)
    d.a = floats(4)
    d.slope = floats(2)
    return d


def on_disk(d: Disk) -> bool:
    """Find the direction of the force on the edge of the disk; False if there is none."""
    size = max(math.fabs(d.f0[0]), math.fabs(d.f0[1]))
    most = max(max(math.fabs(d.a[0]), math.fabs(d.a[1])), max(math.fabs(d.a[2]), math.fabs(d.a[3])))
    size += math.fabs(d.limit) * most
    if not size > 0.0:
        return False
    best = -math.inf
    at = 0.0
    for k in range(DIRECTIONS):
        low = angle_mark(k)
        high = angle_mark(k + 1)
        slip_towards(d, low)
        at_low = d.across
        slip_towards(d, high)
        at_high = d.across
        if at_low * at_high <= 0.0:
            phi = root_of_slip(d, low, high, at_low, at_high)
            slip_towards(d, phi)
            if d.along > best or (d.along == best and phi > at):
                best = d.along
                at = phi
    if best == -math.inf or best < -AGAINST * size:
        return False
    d.x = math.cos(at)
    d.y = math.sin(at)
    return True


def angle_mark(k: int) -> float:
    """Return the k-th angle at which the slip is looked at."""
    last = DIRECTIONS
    step = 2.0 * math.pi / float(last)
    angle = math.pi if k == last else float(k) * step - math.pi
    return angle + 0.5 / float(last)


def slip_towards(d: Disk, phi: float) -> None:
    """Find the parts of the slip across and along a direction."""
    x = math.cos(phi)
    y = math.sin(phi)
    along = 1.0 - d.slope[0] * x - d.slope[1] * y
    force = d.limit / along if along > 0.0 else math.inf
    u = d.f0[0] - force * (d.a[0] * x + d.a[1] * y)
    v = d.f0[1] - force * (d.a[2] * x + d.a[3] * y)
    d.across = x * v - y * u
    d.along = x * u + y * v


def root_of_slip(d: Disk, low: float, high: float, at_low: float, at_high: float) -> float:
    """Return a root of the slip across in a bracket (Illinois method).

    Beside pi angles are further apart than the slip across is from its root: an end from which a
    straight line does not lead away is as near as an angle can be.
    """
    if at_low == 0.0:
        return low
    side = 0
    for _ in range(HALVINGS_OF_ANGLE):
        if at_high == at_low:
            break
        middle = (low * at_high - high * at_low) / (at_high - at_low)
        if middle == low or middle == high:
            return middle
        slip_towards(d, middle)
        value = d.across
        if value == 0.0 or math.fabs(high - low) <= CLOSED_ANGLE:
            return middle
        if value * at_high > 0.0:
            high = middle
            at_high = value
            if side == -1:
                at_low = 0.5 * at_low
            side = -1
        else:
            low = middle
            at_low = value
            if side == 1:
                at_high = 0.5 * at_high
            side = 1
    return 0.5 * (low + high)
