"""Gain and phase margin of a loop from its frequency response."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.units import format_quantity

CLEAR = 1e-12
"""Part of a value below which its imaginary part is rounding."""

CROSSES = 1e-6
"""Part of a value that its imaginary part is at most where it crosses the axis."""


@dataclass(frozen=True, slots=True)
class Margins:
    """How much a loop with negative feedback can take; None where it never crosses.

    Parameters
    ----------
    gain : float or None
        By what the loop may be multiplied before it swings: the factor nearest to one. Below one
        it is a reduction that it must not go through.
    gain_at : float or None
        Hz: where its phase is -180 degrees.
    phase : float or None
        Degrees by which the loop may be turned: the smallest in size.
    phase_at : float or None
        Hz: where its magnitude is one.
    """

    gain: float | None
    gain_at: float | None
    phase: float | None
    phase_at: float | None

    def __str__(self) -> str:
        said = []
        if self.gain is not None and self.gain_at is not None:
            size = 20.0 * np.log10(self.gain)
            said.append(f"gain margin {size:.3g} dB at {format_quantity(self.gain_at, 'Hz', 4)}")
        if self.phase is not None and self.phase_at is not None:
            where = format_quantity(self.phase_at, "Hz", 4)
            said.append(f"phase margin {self.phase:.3g}° at {where}")
        return ", ".join(said) or "no crossing, no margins"


def margins_of(response: Callable[[Any], NDArray[np.complex128]], f: NDArray[Any]) -> Margins:
    """Return the margins of a loop.

    Crossings are looked for between the frequencies `f` and then found by bisection.

    Parameters
    ----------
    response : callable
        From frequencies in Hz to complex values.
    f : array, shape (m,)
        Rising.

    Examples
    --------
    ``L = 1/s``, one at 1 rad/s with -90 degrees:

    >>> found = margins_of(lambda f: 1 / (2j * np.pi * f), np.logspace(-3, 1, 50))
    >>> found.gain, round(found.phase, 9), round(2 * np.pi * found.phase_at, 9)
    (None, 90.0, 1.0)
    """
    values = response(f)
    fine = np.isfinite(values) & (values != 0.0)
    f, values = f[fine], values[fine]
    if len(f) < 2:
        return Margins(None, None, None, None)
    best_phase: tuple[float, float] | None = None
    for k in np.flatnonzero(np.diff(np.abs(values) > 1.0)):
        at = _crossing(lambda x: float(np.abs(response(np.array([x]))[0]) - 1.0), f[k], f[k + 1])
        own = float((np.degrees(np.angle(response(np.array([at]))[0])) + 360.0) % 360.0 - 180.0)
        if best_phase is None or abs(own) < abs(best_phase[0]):
            best_phase = own, at
    best_gain: tuple[float, float] | None = None
    # a point that lies on the axis says nothing of a side
    clear = np.abs(values.imag) > CLEAR * np.abs(values)
    f, values = f[clear], values[clear]
    for k in np.flatnonzero(np.diff(values.imag > 0.0)):
        at = _crossing(lambda x: float(response(np.array([x]))[0].imag), f[k], f[k + 1])
        value = complex(response(np.array([at]))[0])
        # through a pole on the axis the phase turns where nothing is finite: that is no crossing
        turns = not np.isfinite(value) or abs(value.imag) > CROSSES * abs(value)
        real = value.real
        if turns or real >= 0.0:
            continue
        own = -1.0 / real
        if best_gain is None or abs(np.log(own)) < abs(np.log(best_gain[0])):
            best_gain = own, at
    return Margins(*(best_gain or (None, None)), *(best_phase or (None, None)))


def _crossing(g: Callable[[float], float], low: float, high: float) -> float:
    """Return where a function changes its sign, to the last digits, by halving the logarithm."""
    below = g(low)
    for _ in range(200):
        middle = float(np.sqrt(low * high))
        if not low < middle < high:
            break
        value = g(middle)
        if (value > 0.0) == (below > 0.0):
            low = middle
        else:
            high = middle
    return float(np.sqrt(low * high))
