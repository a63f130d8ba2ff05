"""What is free: its start, its bounds, and the scale on which it is looked for."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.errors import UsageError
from hybond.model.parts import Value
from hybond.names import did_you_mean
from hybond.units import is_of, try_quantity

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Scale:
    """From the variables of a search to values and back.

    Parameters
    ----------
    names : tuple of str
    size : array, shape (free,)
        Values are these times a variable; or times its exponential, where `logs`.
    logs : array of bool, shape (free,)
    low, high : array, shape (free,)
        Bounds of values, SI.
    start : array, shape (free,)
        The variables at the start.
    """

    names: tuple[str, ...]
    size: Vector
    logs: NDArray[np.bool_]
    low: Vector
    high: Vector
    start: Vector

    def values(self, z: Vector) -> Vector:
        """Return the values that variables stand for.

        Examples
        --------
        >>> scale = scale_of(["C", "x"], np.array([2e-3, 0.5]), {"x": (0, 1)}, ["C"])
        >>> scale.values(np.array([0.0, 1.0])).tolist(), scale.start.tolist()
        ([0.002, 0.5], [0.0, 1.0])
        """
        with np.errstate(over="ignore"):
            return np.where(
                self.logs, self.size * np.exp(np.where(self.logs, z, 0.0)), self.size * z
            )

    def slopes(self, z: Vector) -> Vector:
        """Return the derivatives of values by variables."""
        return np.where(self.logs, self.values(z), self.size)

    def variables(self, values: Vector) -> Vector:
        """Return the variables of values; of a logarithm's 0 minus infinity."""
        with np.errstate(divide="ignore", invalid="ignore"):
            part = values / self.size
            return np.where(
                self.logs, np.log(np.where(self.logs, np.maximum(part, 0.0), 1.0)), part
            )

    @property
    def bounds(self) -> tuple[Vector, Vector]:
        """The bounds of variables."""
        both = np.sort(np.stack([self.variables(self.low), self.variables(self.high)]), axis=0)
        return both[0], both[1]


def scale_of(
    names: Sequence[str],
    start: Vector,
    bounds: Mapping[str, tuple[Value, Value]],
    logs: Sequence[str],
    units: Sequence[str] = (),
) -> Scale:
    """Return the scale of a search.

    Raises
    ------
    UsageError
        HB-A532 for bounds that are none or leave out the start, a logarithm of what is not
        positive, or a name that is not free.
    """
    for name in (*bounds, *logs):
        if name not in names:
            raise UsageError(
                f"{name!r} is not free", code="HB-A532", where=name, hint=did_you_mean(name, names)
            )
    low, high = np.full(len(names), -np.inf), np.full(len(names), np.inf)
    for name, pair in bounds.items():
        k = names.index(name)
        try:
            a, b = pair
        except (TypeError, ValueError):
            raise _wrong(name, f"{pair!r} are no bounds") from None
        unit = units[k] if units else ""
        low[k], high[k] = _bound(a, name, unit, -np.inf), _bound(b, name, unit, np.inf)
    for k, name in enumerate(names):
        if name in logs and not start[k] > 0.0:
            raise _wrong(name, f"it starts at {start[k]:g}, which has no logarithm")
        if name in logs:
            low[k] = max(low[k], 0.0)
        if not low[k] < high[k] or not low[k] <= start[k] <= high[k]:
            raise _wrong(
                name, f"from {low[k]:g} to {high[k]:g} does not hold its start {start[k]:g}"
            )
    # a start of zero says nothing of sizes: its bounds may
    size = start.copy()
    span = high - low
    size = np.where(size == 0.0, np.where(np.isfinite(span), span, 1.0), size)
    own = np.array([n in logs for n in names])
    return Scale(tuple(names), size, own, low, high, np.where(own, 0.0, start / size))


def _bound(value: Value, name: str, unit: str, nothing: float) -> float:
    if value is None:
        return nothing
    if isinstance(value, str):
        quantity = try_quantity(value)
        if quantity is not None and not is_of(quantity, unit):
            raise _wrong(name, f"{value!r} is no bound of what is in {unit}")
        if quantity is not None:
            return quantity.value
    elif isinstance(value, int | float) and not isinstance(value, bool) and not math.isnan(value):
        return float(value)
    raise _wrong(name, f"{value!r} is no bound")


def _wrong(name: str, why: str) -> UsageError:
    return UsageError(
        why, code="HB-A532", where=name, hint="bounds={'pad.C': (0.5e-3, '2 mm/N')}, log=['pad.C']"
    )


def value_of(name: str, names: Sequence[str], values: Vector) -> float:
    """Return what was found for a name, SI.

    Raises
    ------
    UsageError
        HB-A523 for a name that was not free.
    """
    if name not in names:
        raise UsageError(
            f"{name!r} was not free",
            code="HB-A523",
            where="free",
            hint=did_you_mean(name, names) or ", ".join(names),
        )
    return float(values[list(names).index(name)])
