"""What the executive writes down: segments of motion, events, the steps within an event.

Records only; they are made by `modes` and read by results, tables and drawings.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hybond.model.graph import Mode

Vector = NDArray[np.float64]
StepKind = Literal["mythical", "pinnacle", "continuous"]
Cause = Literal["start", "guard", "time", "input"]


@dataclass(frozen=True, slots=True)
class Fired:
    """A transition that fired.

    `values` are the a posteriori and a priori values that its guard read, by name as written;
    `impulses` the impulse parts of those that had one.
    """

    machine: str
    source: str
    target: str
    guard: str
    values: Mapping[str, float]
    impulses: Mapping[str, float]
    passed_over: tuple[str, ...] = ()
    """Guards of the same state, later in the list, that were true as well."""


@dataclass(frozen=True, slots=True)
class Energy:
    """Energy of a step that writes: ``after = before + source - lost``, in J."""

    before: float
    after: float
    source: float
    lost: float


@dataclass(frozen=True, slots=True)
class Step:
    """One mode visited within an event, entered by `fired`."""

    mode: Mode
    kind: StepKind
    fired: tuple[Fired, ...]
    impulses: Mapping[str, float]
    """Area of the impulse part of each signal that has one; trial values in a mythical step."""
    energy: Energy | None
    undetermined: tuple[str, ...] = ()
    exchanged: Mapping[str, float] = field(default_factory=dict)
    """What sources and OFF junctions took from storage: impulse areas by bond."""


@dataclass(frozen=True, slots=True)
class Event:
    """An instant at which the mode was settled. `steps` end with the continuous mode."""

    t: float
    cause: Cause
    steps: tuple[Step, ...]
    before: Vector
    """Stored quantities and integrated signals at the left limit."""
    after: Vector


@dataclass(frozen=True, slots=True)
class Segment:
    """Motion in one mode: half-open ``[t[0], t[-1])`` seen from the right, closed from the left.

    Parameters
    ----------
    mode : Mode
    interval : object
        What inputs and timed comparisons are within it.
    t : array, shape (n,)
        Accepted points.
    y : array, shape (n, m)
        Stored quantities, integrated signals, energy supplied, energy dissipated.
    interpolants : tuple of callables
        One per step, n - 1.
    """

    mode: Mode
    interval: object
    t: Vector
    y: Vector
    interpolants: tuple[Callable[[float], Vector], ...]

    def at(self, t: float) -> Vector:
        """Return the state at a time within the segment."""
        k = int(np.searchsorted(self.t, t, side="left"))
        if k < len(self.t) and self.t[k] == t:
            return np.asarray(self.y[k])
        return np.asarray(self.interpolants[min(max(k - 1, 0), len(self.interpolants) - 1)](t))


@dataclass(frozen=True, slots=True)
class Accumulation:
    """Events that follow one another ever faster, towards the time `t`.

    `ratio` is that of successive intervals, None if the events were too close to tell.
    """

    t: float
    ratio: float | None
    events: int


@dataclass(slots=True)
class Trace:
    """Everything a run wrote down, in order."""

    segments: list[Segment] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    accumulations: list[Accumulation] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    stats: dict[str, float] = field(default_factory=dict)
    energy: float = 0.0
    """The largest energy seen, J: what rounding of stored quantities is measured by."""

    def warn(self, text: str) -> None:
        """Note a warning once."""
        if text not in self.warnings:
            self.warnings.append(text)
