"""What the executive writes down: segments of motion, events, the steps within an event.

Records only; the engine makes them, and results, tables and drawings read them.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hybond.chronicle import Chronicle
from hybond.model.graph import Mode
from hybond.records import dataclass

Vector = NDArray[np.float64]
VisitKind = Literal["mythical", "pinnacle", "continuous"]
Cause = Literal[
    "start", "guard", "time", "input", "sample", "law", "accumulation", "step", "change", "until"
]


@dataclass(frozen=True, slots=True)
class Fired:
    """A transition that fired.

    `values` are the a posteriori and a priori values that its guard read, by the full path of what
    is read in a part; `impulses` the impulse parts of those that had one.
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
class Visit:
    """One step of an event: a mode that was visited, entered by `fired`."""

    mode: Mode
    kind: VisitKind
    fired: tuple[Fired, ...]
    impulses: Mapping[str, float]
    """Area of the impulse part of each signal that has one; trial values in a mythical step."""
    energy: Energy | None
    undetermined: tuple[str, ...] = ()
    exchanged: Mapping[str, float] = field(default_factory=dict)
    """What sources and OFF junctions took from storage: impulse areas by bond."""
    areas: Mapping[str, float] = field(default_factory=dict)
    """Area of the impulse part of each bond variable that has one, by canonical name."""


@dataclass(frozen=True, slots=True)
class Event:
    """An instant at which the mode was settled. `steps` end with the continuous mode."""

    t: float
    cause: Cause
    steps: tuple[Visit, ...]
    before: Vector
    """Stored quantities and integrated signals at the left limit."""
    after: Vector
    landed: tuple[str, ...] = ()
    """Machines that stay in their pinnacle state when time goes on: their impacts are over."""
    t0: float | None = None
    """Beginning of the step within which it happened, in a run that does not locate events."""
    label: str = ""
    """What a script calls the step that begins there."""


@dataclass(frozen=True, slots=True)
class Segment:
    """Motion in one mode: half-open ``[t[0], t[-1])`` seen from the right, closed from the left."""

    mode: Mode
    t: Vector
    """Shape (n,). Accepted points."""
    y: Vector
    """Shape (n, m). Stored quantities, integrated signals; then, in time-stepping, energy supplied
    and energy dissipated."""
    interpolants: Sequence[Callable[[float], Vector]]
    """One per step, n - 1."""
    landed: tuple[str, ...] = ()
    """Machines that stay in their pinnacle state, its impact law with ``pre()`` terms at zero."""
    sliding: int | None = None
    """Which of the trace's slidings it belongs to."""
    combined: object = None
    """What its signals are made of while it slides."""
    bonds: Vector | None = None
    """Shape (n, 2 * bonds), or None. Bond variables at the points, where they come from the steps
    themselves and not from the equations of the mode; such a segment has no interpolants: between
    points all is linear."""

    def at(self, t: float) -> Vector:
        """Return the state at a time within the segment."""
        k = int(np.searchsorted(self.t, t, side="left"))
        if k < len(self.t) and self.t[k] == t:
            return np.asarray(self.y[k])
        if self.bonds is not None:
            return self._between(self.y, t)
        return np.asarray(self.interpolants[min(max(k - 1, 0), len(self.interpolants) - 1)](t))

    def rows(self, times: Sequence[float]) -> list[Vector]:
        """Return the states at some times within the segment, those of `at`."""
        if self.bonds is not None or not len(self.interpolants):
            return [self.at(t) for t in times]
        points = self.t.tolist()
        found: list[Vector] = []
        last, step = -1, self.interpolants[0]
        for t in times:
            k = bisect_left(points, t)
            if k < len(points) and points[k] == t:
                found.append(np.asarray(self.y[k]))
                continue
            k = min(max(k - 1, 0), len(self.interpolants) - 1)
            if k != last:
                last, step = k, self.interpolants[k]
            found.append(np.asarray(step(t)))
        return found

    def _between(self, rows: Vector, t: float) -> Vector:
        k = min(max(int(np.searchsorted(self.t, t, side="left")), 1), max(len(self.t) - 1, 0))
        if not k or self.t[k] == t:
            return np.asarray(rows[k])
        part = (t - self.t[k - 1]) / (self.t[k] - self.t[k - 1])
        return np.asarray(rows[k - 1] + part * (rows[k] - rows[k - 1]))


@dataclass(frozen=True, slots=True)
class Accumulation:
    """Events of a machine that follow one another ever faster, towards the time `t`.

    Parameters
    ----------
    t : float
        The limit, s, extrapolated.
    ratio : float or None
        Of successive intervals, None if the events were too close or too few to tell.
    events : int
        How many there were.
    machine : str
    landed : bool
        Whether the run went on, at rest; else it stopped there, and a warning says why.
    state : str
        The pinnacle state in which the machine landed.
    """

    t: float
    ratio: float | None
    events: int
    machine: str = ""
    landed: bool = False
    state: str = ""


@dataclass(frozen=True, slots=True)
class Sliding:
    """Motion along switching surfaces, from `t0` to `t1`.

    Parameters
    ----------
    t0, t1 : float
        s.
    machines : tuple of str
        The machines that switch infinitely fast, one per surface.
    surfaces : tuple of str
        As written: ``v.f = 0``.
    modes : tuple of Mode
        The modes that are combined, as they were at `t0`.
    kind : {"additive", "product"}
        Whether the switches act independently of each other, so that the weights follow from the
        surfaces alone, or the products of weights were chosen.
    """

    t0: float
    t1: float
    machines: tuple[str, ...]
    surfaces: tuple[str, ...]
    modes: tuple[Mode, ...]
    kind: Literal["additive", "product"]


def _begin(segment: Segment) -> float:
    return float(segment.t[0])


def _instant(event: Event) -> float:
    return event.t


ONE_SOLUTION = "one solution"
"""What laws should have that were found to have more."""
GOES_ON = "the solution followed goes on"

UNBALANCED = "no energy comes from nowhere"
CREATES = "a jump creates no energy"
"""What should be so of energy, in steps and in jumps."""


@dataclass(frozen=True, slots=True)
class Violation:
    """A law that the values of a run do not satisfy.

    Parameters
    ----------
    t : float
        When it was seen first, s.
    place : str
        The element or junction.
    off : float
        What is left when all values are put into it, SI.
    size : float
        The sum of the magnitudes of its terms, SI.
    law : str
        The law in words.
    mode : str
    """

    t: float
    place: str
    off: float
    size: float
    law: str
    mode: str

    def __str__(self) -> str:
        if self.law == ONE_SOLUTION:
            return (
                f"at t = {self.t:.9g} s in mode ({self.mode}) the laws around {self.place} have "
                f"more than one solution, {self.off:.6g} apart: the run moved by one of them, and "
                "what is read of it may be another"
            )
        if self.law == GOES_ON:
            return (
                f"at t = {self.t:.9g} s in mode ({self.mode}) the solution of the laws around "
                f"{self.place} that the run has followed ends (a fold): the laws have another, "
                f"{self.off:.6g} away, and do not say how it is gone to"
            )
        if self.law == UNBALANCED:
            return (
                f"at t = {self.t:.9g} s in mode ({self.mode}) {self.off:.6g} J have come from "
                f"nowhere, or are lost, of {self.size:.6g} J that have moved; most moves in "
                f"{self.place} there"
            )
        if self.law == CREATES:
            return (
                f"at t = {self.t:.9g} s the jump into mode ({self.mode}) creates {self.off:.6g} J "
                f"that no source supplies, where {self.size:.6g} J are stored or supplied; most of "
                f"it in {self.place}"
            )
        return (
            f"at t = {self.t:.9g} s in mode ({self.mode}) the law of {self.place}, {self.law}, is "
            f"off by {self.off:.6g} where its terms add up to {self.size:.6g}"
        )


@dataclass(frozen=True, slots=True)
class Turn:
    """From `t` on modes that are not linear are left to another solver: stiff, or no more.

    Parameters
    ----------
    t : float
        s.
    solver : {"radau", "rk45"}
    """

    t: float
    solver: str

    def __str__(self) -> str:
        return f"{self.solver} from t = {self.t:.6g} s on"


@dataclass(slots=True)
class Trace:
    """Everything a run wrote down, in order."""

    segments: Chronicle[Segment] = field(default_factory=lambda: Chronicle(_begin))
    events: Chronicle[Event] = field(default_factory=lambda: Chronicle(_instant))
    accumulations: list[Accumulation] = field(default_factory=list)
    slidings: list[Sliding] = field(default_factory=list)
    turns: list[Turn] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    engine: str = ""
    """What made the run."""
    method: str = ""
    """How many of the modes a solver took that is not for all, and why not more."""
    stats: dict[str, float] = field(default_factory=dict)
    unsound: list[Violation] = field(default_factory=list)
    """Laws that were found not to hold, each the first time."""
    roots: list[tuple[float, list[float]]] = field(default_factory=list)
    """Of laws with several solutions: times, and bond variables of the one that was followed."""
    signals: object = None
    """What tells signals, powers and energies; the engine sets it."""
    energy: float = 0.0
    """The largest energy seen, J: what rounding is measured by where the run is looked into."""
    begin: float = 0.0
    """When the run began, s."""
    ended_by: str = ""
    """The condition that ended it, as written, if one did."""
    carried: tuple[Vector, NDArray[np.intc]] | None = None
    """What a run that goes on from its end is handed; the engine takes it."""

    def warn(self, text: str) -> None:
        """Note a warning once."""
        if text not in self.warnings:
            self.warnings.append(text)
