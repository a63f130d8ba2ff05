"""What may take over parts of a run from the executive, and changes nothing but the speed.

A *march* is the smooth part of a motion: steps in which nothing happens. The executive asks for one
wherever a mode begins, and after every step of its own. What marches gives the steps up to the end,
or to the first instant at which a guard holds, or up to one that it is not sure of; that one the
executive makes itself.

A *passage* is a row of whole segments with the instants that end them, settled as the executive
would have them. It stops before the first segment whose end it is not sure of.

So both may give up at any time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hybond.equations.mode import ModeEquations
from hybond.equations.surfaces import Surface
from hybond.model.graph import Mode
from hybond.model.interval import Interval
from hybond.modes.landing.landing import Landings
from hybond.modes.locate import Watched
from hybond.modes.settle import Settler

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Marched:
    """Steps taken.

    Parameters
    ----------
    t : array, shape (steps,)
        Their ends, s.
        The last one may lie before the end of its step, at an event.
    y : array, shape (steps, states)
        The states there, on the constraints of the mode.
    stop, end : arrays, shape (steps,) and (steps, states)
        The ends of the steps, and the states as the steps gave them.
    dense : array, shape (steps, 4, states)
        Coefficients of ``x, ..., x^4``, as in `hybond.engine.outcome.polynomial.Polynomial`.
    rejected : int
    gaps : dict
        Machine to the largest distance of its contact.
    arrived : bool
        Whether the last step ends where it should.
    interrupted : bool
        Whether it could go on at once.
    event : bool
        Whether a guard holds at the end.
    """

    t: Vector
    y: Vector
    stop: Vector
    end: Vector
    dense: Vector
    rejected: int
    gaps: dict[int, float]
    arrived: bool
    interrupted: bool
    event: bool


@dataclass(frozen=True, slots=True)
class Course:
    """What a run is, for a passage through its events.

    Parameters
    ----------
    settler : Settler
    landings : Landings
        Learns of impacts. Nothing has landed.
    watch : callable
        The guards that leave a mode.
    surfaces : tuple of Surface
        Along which a motion may slide. It does not now.
    until, event_tol, max_events : float, float, int
        As in `Limits`.
    """

    settler: Settler
    landings: Landings
    watch: Callable[[Mode], Watched]
    surfaces: tuple[Surface, ...]
    until: float
    event_tol: float
    max_events: int


@dataclass(frozen=True, slots=True)
class Passage:
    """Segments that ended, in order, and the instants that ended them: rows.

    Parameters
    ----------
    start : tuple
        Time, state and mode in which the first segment begins.
    t : array, shape (rows,)
    before : array, shape (rows, stored quantities and signals)
        At the left limits.
    after : array, shape (rows, states)
        Where the next segment begins.
    mode : list of Mode, length rows
        In which it begins.
    timed, changed, struck : arrays of bool, shape (rows,)
        Whether a timed event ended the segment, whether more than the inputs changed there, and
        whether impulses were written.
    interval : array of int, shape (rows,)
        Which of `intervals` each segment lies in.
    intervals : list of Interval
    energy : array, shape (rows,)
        The largest energy that the run had seen before, J.
    approach, fired : arrays, shape (rows, machines)
        What the impact laws read that were struck, else nan; whether a machine fired.
    steps : array of int, shape (rows,)
        Steps up to the end of each segment, of those in `marched`.
    marched : Marched
    again : bool
        Whether it could go on at once.
    """

    start: tuple[float, Vector, Mode]
    t: Vector
    before: Vector
    after: Vector
    mode: list[Mode]
    timed: NDArray[np.bool_]
    changed: NDArray[np.bool_]
    struck: NDArray[np.bool_]
    interval: NDArray[np.intp]
    intervals: list[Interval]
    energy: Vector
    approach: Vector
    fired: NDArray[np.bool_]
    steps: NDArray[np.intp]
    marched: Marched
    again: bool

    def left(self, k: int) -> Mode:
        """Return the mode of segment k."""
        return self.mode[k - 1] if k else self.start[2]

    def around(self, k: int) -> tuple[Interval, Interval]:
        """Return the intervals before and after the instant that ends segment k."""
        at = int(self.interval[k])
        return self.intervals[at], self.intervals[at + int(self.timed[k])]


class Scale(Protocol):
    """What the error of a step is measured by: `ErrorScale`."""

    rtol: float
    energy: float
    largest: Vector
    rounding: Vector

    @property
    def atol_or_nan(self) -> float:
        """The absolute tolerance, nan if none is given."""

    @property
    def negligible(self) -> float:
        """Part of what a storage would hold with all energy below which it need not be right."""

    @property
    def rounded(self) -> float:
        """Part of the terms of a rate, in the time of the run, that rounding may come to."""

    @property
    def idle(self) -> float:
        """What an integrated signal may be wrong by at zero."""


class March(Protocol):
    """What marches."""

    def march(
        self,
        equations: ModeEquations,
        watched: Watched,
        *,
        interval: Interval,
        settler: Settler,
        end: float,
        instant: float,
        start: tuple[float, Vector] | None,
    ) -> Marched | None:
        """Return the steps, None if this mode is not for marching.

        A guard that holds within `instant` of `end`, s, is left to the executive. `start` are time
        and state where a motion begins; without it the last one goes on.
        """

    def cross(
        self,
        course: Course,
        *,
        mode: Mode,
        t: float,
        y: Vector,
        interval: Interval,
        last: float,
        events: int,
    ) -> Passage | None:
        """Return the segments from where one begins, None if nothing is known of its end.

        `last` is the time of the last event, s; `events` how many there were.
        """

    def reasons(self) -> list[str]:
        """Return why modes were not for marching, a text each."""
