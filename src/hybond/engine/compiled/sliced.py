"""A run in slices: what the library and the engine in Python have in common."""

from __future__ import annotations

import threading
import weakref
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybond.blocks.runners import Runner
from hybond.engine.compiled.answering import Calls, Onlooker
from hybond.engine.compiled.refusal import Refusal
from hybond.engine.compiled.rows import Rows
from hybond.engine.tables import ModelTables

OK, REFUSED, ACCUMULATES, SPENT, PAUSED, RAISED = 0, 1, 3, 4, 7, 8
LONGEST_SLICE = 2**31 - 1
SLICE = 2000
"""Steps and instants between two looks at the world outside."""


class SlicedRun(ABC):
    """One run of a model.

    Parameters
    ----------
    runners : mapping of str to Runner
        What runs each block, by its path; others have to close them. By default the run has its
        own, and closes them when it ends.
    fmus : bool
        The consent to run the code of functional mock-up units.

    Raises
    ------
    UsageError
        HB-S117 for an FMU without consent.
    MemoryError
    """

    t: float
    """The time that was reached, s."""
    y: NDArray[np.float64]
    """The state there: stored quantities, then integrated signals."""
    mode: tuple[int, ...]
    """The state of each machine: in the mode that is being tried, or in which time passes."""
    stuck: tuple[int, int, int, float, float]
    """Of events that accumulate: machine or -1, how many, why, their limit, s, the ratio."""
    energy: float
    """The largest energy that the run has seen, J."""
    rejected: int
    """Steps that were tried and found too long."""
    evaluations: int
    """How often the rates of the state were evaluated."""
    modes_made: int
    """Modes whose equations were made."""
    propagated: list[int]
    """Modes that were propagated exactly; those that were not, reason by reason; slides. Empty if
    the method is another one."""

    def __init__(
        self, tables: ModelTables, runners: Mapping[str, Runner] | None, *, fmus: bool
    ) -> None:
        self.tables = tables
        self.status = PAUSED
        self.error: BaseException | None = None
        """What an input or a block raised, which ended the run; None if nothing was."""
        self.onlooker = Onlooker()
        """Who looks on within slices; one that raises ends the run as an input does."""
        self._lock = threading.Lock()
        self._calls: Calls | None = None
        self._close_runners: Callable[[], object] = _do_nothing
        if tables.numbers["called"] or tables.numbers["blocks"]:
            self._calls = Calls(tables, runners, fmus=fmus)
            if runners is None:
                self._close_runners = weakref.finalize(self, self._calls.close)

    @property
    def fault(self) -> Refusal:
        """What stopped the run."""
        return self._refusal(0)

    @property
    def unrest(self) -> Refusal:
        """Why a structure at rest had no solution, the last time."""
        return self._refusal(1)

    @abstractmethod
    def _refusal(self, which: int) -> Refusal:
        """Return what stopped the run, 0, or why what was struck cannot rest, 1."""

    @abstractmethod
    def _go(self, many: int) -> None:
        """Run on by so many steps and instants; set the status, and what was reached."""

    @abstractmethod
    def _try(self, state: NDArray[np.intc]) -> NDArray[np.intc] | None:
        """Enter a mode, as `tried`."""

    @abstractmethod
    def carried(self) -> tuple[NDArray[np.float64], NDArray[np.intc]]:
        """Return what a run that goes on from here is handed: see `engine.run.carried`."""

    @abstractmethod
    def begin_from(
        self, number: ArrayLike, place: ArrayLike, *, way: int, until: float, deep: bool
    ) -> None:
        """Let the run, which has not begun, begin with such numbers.

        Parameters
        ----------
        number, place : array_like
            As `carried` returns them; without `deep` as many as the state takes.
        way : int
            GIVEN, CHANGED or GOES_ON of `engine.run.run_records`.
        until : float
            When it ends, s.
        deep : bool
            Whether they hold what a run of the same model remembers.

        Raises
        ------
        ValueError
            For other numbers than a run of this model has, or a run that has begun.
        """

    @abstractmethod
    def _taken(self) -> Rows:
        """Return what was written down, and forget it."""

    def slices(
        self,
        *,
        steps: int | Callable[[], int] = SLICE,
        between: Callable[[float], None] | None = None,
    ) -> Iterator[Rows]:
        """Run on to the end; yield what was written down, slice after slice.

        Who leaves the loop can go on later: nothing is lost, nothing comes twice. What an input or
        a block raises is raised here, after what was written down before it; so is an interrupt
        that comes meanwhile. The run has ended then.

        Parameters
        ----------
        steps : int or callable
            Steps and instants of a slice; -1: all in one. A callable is asked before each.
        between : callable
            Called with the time after each slice; what it raises ends the run there.

        Raises
        ------
        ValueError
            For a slice of no steps.
        MemoryError
        NumericsError
            HB-N306 if a block fails.
        """
        if isinstance(steps, int):
            _check_slice(steps)
        while self.status == PAUSED:
            many = steps if isinstance(steps, int) else steps()
            _check_slice(many)
            with self._lock:
                self._go(many)
                rows = self._taken()
            yield rows
            if between is not None and self.status != RAISED:
                between(self.t)
        self._close_runners()
        if self.status == RAISED:
            # there is none if a second interrupt came while the first one was kept
            raise self.error or KeyboardInterrupt

    def tried(self, state: ArrayLike) -> NDArray[np.intc] | None:
        """Enter a mode at the start of a run that has not begun: of each rule whether it leaves it.

        None if it cannot be entered: `fault` says why. The run can do nothing else any more.

        Parameters
        ----------
        state : array of int, shape (machines,)

        Raises
        ------
        ValueError
            For a run that has begun.
        MemoryError
        """
        asked = np.ascontiguousarray(state, dtype=np.intc)
        if self.status != PAUSED or self.t > 0.0:
            raise ValueError("the run has begun")
        with self._lock:
            self.status = REFUSED
            return self._try(asked)


def fitted(
    own: tuple[NDArray[np.float64], NDArray[np.intc]],
    number: ArrayLike,
    place: ArrayLike,
    *,
    deep: bool,
) -> tuple[NDArray[np.float64], NDArray[np.intc]]:
    """Return numbers that a run begins with, if they are as many as its own are.

    Raises
    ------
    ValueError
    """
    numbers = np.ascontiguousarray(number, dtype=np.float64).reshape(-1)
    places = np.ascontiguousarray(place, dtype=np.intc).reshape(-1)
    most = len(own[0]), len(own[1])
    fits = (len(numbers), len(places)) == most if deep else len(numbers) <= most[0]
    if not fits or len(places) > most[1]:
        raise ValueError(f"{len(numbers)} and {len(places)} numbers, where a run has {most}")
    return numbers, places


def _check_slice(steps: int) -> None:
    if steps != -1 and not 1 <= steps <= LONGEST_SLICE:
        raise ValueError(f"a slice of {steps} steps: 1 to {LONGEST_SLICE}, or -1: all in one")


def _do_nothing() -> None:
    """Do nothing: a run without blocks has none to close."""
