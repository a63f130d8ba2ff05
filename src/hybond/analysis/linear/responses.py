"""Responses as records: to sines of many frequencies, to steps; and how far to look."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybond.errors import UsageError
from hybond.units import parse_unit, try_quantity

Vector = NDArray[np.float64]

A_DECADE = 100
"""Points in a decade where no frequencies are given."""


@dataclass(frozen=True, slots=True, eq=False)
class Bode:
    """The response of one output to a sine at one input.

    Parameters
    ----------
    frequencies : array, shape (m,)
        Hz.
    response : array of complex, shape (m,)
        Output over input, SI.
    input, output, unit : str

    Examples
    --------
    >>> Bode(np.array([1.0]), np.array([-10j]), "u", "y", "").decibels.tolist()
    [20.0]
    """

    frequencies: Vector
    response: NDArray[np.complex128]
    input: str
    output: str
    unit: str

    @property
    def magnitude(self) -> Vector:
        """Absolute value, shape (m,)."""
        return np.abs(self.response)

    @property
    def decibels(self) -> Vector:
        """Magnitude, 20 log10, shape (m,)."""
        with np.errstate(divide="ignore"):
            return np.asarray(20.0 * np.log10(self.magnitude))

    @property
    def phase(self) -> Vector:
        """Degrees, without jumps of whole turns, shape (m,)."""
        return phase_of(self.response)

    def __repr__(self) -> str:
        return f"<Bode {self.output} / {self.input}, {len(self.frequencies)} frequencies>"


@dataclass(frozen=True, slots=True, eq=False)
class StepResponse:
    """Responses to a unit step of each input.

    Parameters
    ----------
    t : array, shape (m,)
        s.
    y : array, shape (m, q, p)
        What each output does when each input rises by one.
    inputs, outputs, input_units, output_units : tuple of str
    """

    t: Vector
    y: Vector
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    input_units: tuple[str, ...]
    output_units: tuple[str, ...]


def phase_of(response: NDArray[np.complex128]) -> Vector:
    """Return the phase in degrees, continued from the first value without jumps of turns."""
    there = np.isfinite(response) & (response != 0.0)
    found = np.full(len(response), np.nan)
    found[there] = np.degrees(np.unwrap(np.angle(response[there])))
    return found


def frequencies_of(
    given: ArrayLike | str | None,
    rates: NDArray[Any],
    *,
    decades: float = 1.0,
    points: int = A_DECADE,
) -> Vector:
    """Return frequencies, Hz: those that are given, or some around poles and zeros.

    Raises
    ------
    UsageError
        HB-A509 for what is none.

    Examples
    --------
    >>> frequencies_of(["1 kHz", 20], np.zeros(0)).tolist()
    [1000.0, 20.0]
    """
    if given is None:
        sizes = np.abs(rates[rates != 0.0]) / (2 * np.pi)
        low, high = (sizes.min(), sizes.max()) if len(sizes) else (1.0, 1.0)
        ends = np.log10(low) - decades, np.log10(high) + decades
        return np.logspace(*ends, int(np.ceil(points * (ends[1] - ends[0]))) + 1)
    listed = given if isinstance(given, Sequence) and not isinstance(given, str) else [given]
    if isinstance(given, np.ndarray):
        listed = np.atleast_1d(given).tolist()
    found = [_hertz(f) for f in listed]
    if not found:
        raise _no_frequency("nothing")
    return np.array(found)


def _hertz(value: object) -> float:
    if isinstance(value, str):
        quantity = try_quantity(value)
        units = (parse_unit("Hz")[1], parse_unit("1")[1])
        if quantity is None or quantity.dimension not in units:
            raise _no_frequency(repr(value))
        value = quantity.value
    if isinstance(value, bool) or not isinstance(value, int | float | np.number):
        raise _no_frequency(repr(value))
    if not 0.0 < float(value) < np.inf:
        raise _no_frequency(f"{float(value):g} Hz")
    return float(value)


def _no_frequency(what: str) -> UsageError:
    return UsageError(
        f"{what} is no frequency",
        code="HB-A509",
        where="frequencies",
        hint="positive numbers in Hz, or quantities: [100, '1 kHz']",
    )


def span_of(poles: NDArray[Any]) -> float:
    """Return how long a step response is worth looking at, s."""
    sizes = np.abs(poles)
    if not len(sizes) or not sizes.any():
        return 1.0
    slow = -poles.real[(poles.real < -1e-6 * sizes) & (sizes > 0.0)]
    if len(slow) == len(poles):
        return float(7.0 / slow.min())
    return float(max(7.0 / slow.min() if len(slow) else 0.0, 20 * np.pi / sizes[sizes > 0].min()))
