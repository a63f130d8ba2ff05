"""The contact phase of a mass on a spring and a damper, in closed form.

``m w' = -d/C - R w + m a``, ``d' = w``, from ``d = 0, w = speed``: compression d, its rate w, and
the rate's change a that sources cause (gravity presses: a > 0). The restitution is ``-w/speed``
at the end of contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Ends = Literal["release", "zero compression"]
ENDS: tuple[Ends, ...] = ("release", "zero compression")
"""The force becomes zero (a floor pushes, never pulls), or the compression does."""


@dataclass(frozen=True, slots=True)
class Phase:
    """How a contact phase ended: restitution and duration; infinite if it never ends."""

    value: float
    duration: float


def damping_ratio(mass: float, compliance: float, resistance: float) -> float:
    """Return zeta, 1 at critical damping.

    Examples
    --------
    >>> round(damping_ratio(1.0, 1e-3, 10.0), 6)
    0.158114
    """
    return 0.5 * resistance * math.sqrt(compliance / mass)


def half_period(mass: float, compliance: float, resistance: float, *, ends: Ends) -> Phase:
    r"""Return restitution and duration of the contact phase without sources.

    At zero compression, after half a period, it is :math:`\exp(-\pi\zeta/\sqrt{1-\zeta^2})`, and
    zero if the damping is critical or more: the compression never returns to zero. The force is
    zero earlier, at :math:`\exp(-2\zeta\arccos\zeta/\sqrt{1-\zeta^2})`, and beyond critical
    damping at :math:`\exp(-2\zeta\,\mathrm{arcosh}\,\zeta/\sqrt{\zeta^2-1})`.

    Parameters
    ----------
    mass, compliance, resistance : float
        SI values; `resistance` is effort per flow.
    ends : {"release", "zero compression"}

    Examples
    --------
    >>> round(half_period(1.0, 1e-3, 10.0, ends="zero compression").value, 3)
    0.605
    >>> round(half_period(1.0, 1e-3, 10.0, ends="release").value, 3)
    0.636
    """
    zeta = damping_ratio(mass, compliance, resistance)
    omega = 1.0 / math.sqrt(mass * compliance)
    root = math.sqrt(abs(1.0 - zeta) * (1.0 + zeta))
    if ends == "zero compression":
        if zeta >= 1.0:
            return Phase(0.0, math.inf)
        return Phase(math.exp(-math.pi * zeta / root), math.pi / (omega * root))
    if root < 1e-6:
        # arccos(zeta)/root tends to 1
        return Phase(math.exp(-2.0 * zeta), 2.0 / omega)
    angle = math.acos(zeta) if zeta < 1.0 else math.acosh(zeta)
    return Phase(math.exp(-2.0 * zeta * angle / root), 2.0 * angle / (omega * root))


def loaded_half_period(
    mass: float,
    compliance: float,
    resistance: float,
    *,
    ends: Ends,
    speed: float,
    pull: float,
) -> Phase:
    """Return restitution and duration if sources accelerate the compression by `pull`.

    The motion is a sum of exponentials, the end of contact its first root. If there is none the
    bodies stay together: restitution 0, duration infinite.

    Examples
    --------
    The weight of a ball takes part; at 0.1 m/s the ball does not leave the floor again:

    >>> for speed in (0.1, 1.0, 10.0):
    ...     phase = loaded_half_period(1.0, 1e-3, 1.0, ends="release", speed=speed, pull=9.81)
    ...     print(f"{phase.value:.6f}")
    0.000000
    0.937225
    0.951029
    """
    from scipy.optimize import brentq

    sigma = 0.5 * resistance / mass
    omega2 = 1.0 / (mass * compliance)
    rest = mass * pull * compliance
    delta = np.sqrt(complex(sigma**2 - omega2))

    def motion(t: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return d and w: the exponential of the matrix [[0, 1], [-omega2, -2 sigma]]."""
        slow = -omega2 / (sigma + delta)
        fast = -(sigma + delta)
        a, b = np.exp(slow * t), np.exp(fast * t)
        even = 0.5 * (a + b).real
        # sinh(delta t)/delta near critical damping
        small = np.abs(delta * t) < 1e-4
        series = np.exp(-sigma * t) * t * (1.0 + (delta * t) ** 2 / 6.0)
        odd = np.where(small, series, (a - b) / (2.0 * delta if delta else 1.0)).real
        d0, w0 = -rest, speed
        d = even * d0 + odd * (sigma * d0 + w0) + rest
        w = even * w0 - odd * (omega2 * d0 + sigma * w0)
        return d, w

    def end(t: NDArray[np.float64]) -> NDArray[np.float64]:
        d, w = motion(t)
        return d / compliance + resistance * w if ends == "release" else d

    if sigma**2 < omega2:
        # the deepest minimum of a decaying oscillation is its first
        period = 2.0 * math.pi / abs(delta.imag)
        even_steps = np.linspace(0.0, period, 4001)[1:]
        # near critical damping the period is long, and all happens at its very beginning
        begin = min(1e-3 / math.sqrt(omega2), period)
        t = np.union1d(even_steps, np.geomspace(begin, period, 4001))
    else:
        longest = 60.0 * (sigma + delta.real) / omega2
        t = np.geomspace(1e-3 / (sigma + delta.real), longest, 20001)
    values = end(t)
    crossed = np.flatnonzero((values[:-1] > 0.0) & (values[1:] <= 0.0))
    if not len(crossed):
        return Phase(0.0, math.inf)
    k = int(crossed[0])
    root = brentq(lambda s: float(end(np.array([s]))[0]), t[k], t[k + 1], xtol=1e-300, rtol=8.9e-16)
    _, w = motion(np.array([root]))
    return Phase(-float(w[0]) / speed, float(root))
