"""Poles as people say them: frequency, damping ratio, time constant."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.units import format_quantity


@dataclass(frozen=True, slots=True)
class Damping:
    """A pole, or a pair of them, as people say it.

    Parameters
    ----------
    pole : complex
        1/s; of a pair the one with the positive imaginary part.
    frequency : float
        Natural frequency, ``abs(pole) / (2 pi)``, Hz.
    ratio : float
        Damping ratio: 1 and more does not swing, below 0 grows; nan at the origin.
    time_constant : float
        ``-1 / real part``, s: negative where it grows, infinite where it stays.
    """

    pole: complex
    frequency: float
    ratio: float
    time_constant: float

    def __str__(self) -> str:
        where = f"{self.pole.real:.6g}"
        if self.pole.imag:
            where += f" ± {self.pole.imag:.6g}j"
        if not self.pole:
            return "0 1/s: it stays where it is put"
        swing = f"{format_quantity(self.frequency, 'Hz', 5)}, damping {self.ratio:.4g}"
        if not np.isfinite(self.time_constant):
            return f"{where} 1/s: {swing}"
        return f"{where} 1/s: {swing}, {format_quantity(self.time_constant, 's', 5)}"


def damping_of(poles: NDArray[Any]) -> tuple[Damping, ...]:
    """Return natural frequency, damping ratio and time constant of each pole or pair.

    Examples
    --------
    >>> print(*damping_of(np.array([-3.0 - 4.0j, -3.0 + 4.0j])))
    -3 ± 4j 1/s: 795.77 mHz, damping 0.6, 333.33 ms
    """
    found = []
    for pole in poles:
        if pole.imag < 0.0:
            continue
        size = abs(pole)
        ratio = -pole.real / size if size else float("nan")
        constant = -1.0 / pole.real if pole.real else float("inf")
        found.append(Damping(complex(pole), size / (2 * np.pi), float(ratio), float(constant)))
    return tuple(found)
