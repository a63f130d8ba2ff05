"""A run by the engine as it stands, in this interpreter.

What `hybond.engine.compiled.native` has of the library, with the same log, row for row.
"""

from __future__ import annotations

import threading
import weakref
from collections.abc import Callable, Iterator, Mapping
from traceback import walk_tb
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybond.blocks.runners import Runner
from hybond.engine.compiled.answering import Calls
from hybond.engine.compiled.native import (
    PAUSED,
    RAISED,
    REFUSED,
    SLICE,
    check_fresh,
    check_slice,
    do_nothing,
)
from hybond.engine.compiled.refusal import Refusal
from hybond.engine.compiled.rows import MACHINES_OF_INSTANT, MACHINES_OF_STEP, Rows
from hybond.engine.engine import OK, Fault, make_engine
from hybond.engine.model import Model
from hybond.engine.run.log import forget_rows, make_report, report_broken
from hybond.engine.run.motion import run_to_end
from hybond.engine.run.run_records import make_run
from hybond.engine.run.trying import try_at_start
from hybond.engine.tables import ModelTables, answered

CALLS = (Calls.value.__code__, Calls.rate.__code__, Calls.block.__code__)


class PythonModel:
    """The tables of a model where the engine in Python reads them.

    Parameters
    ----------
    tables : ModelTables
    """

    def __init__(self, tables: ModelTables) -> None:
        self.tables = tables
        self.record: Model = answered(tables)


class PythonRun:
    """One run of a model by the engine in Python.

    Parameters
    ----------
    model : PythonModel
    runners : mapping of str to Runner
        What runs each block, by its path; others have to close them. By default the run has its
        own, and closes them when it ends.
    fmus : bool
        The consent to run the code of functional mock-up units.

    Raises
    ------
    UsageError
        HB-S117 for an FMU without consent.

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.engine.compiled.native import OK
    >>> from hybond.engine.tables import tables_of
    >>> graph = hb.load("examples/buck.toml").flatten()
    >>> run = PythonRun(PythonModel(tables_of(graph)))
    >>> sum(len(rows.instant_time) for rows in run.slices())
    12
    >>> run.status == OK, run.t
    (True, 1e-05)
    """

    def __init__(
        self,
        model: PythonModel,
        *,
        runners: Mapping[str, Runner] | None = None,
        fmus: bool = False,
    ) -> None:
        self.model = model
        self.status = PAUSED
        self.error: BaseException | None = None
        """What an input or a block raised, which ended the run; None if nothing was."""
        self._lock = threading.Lock()
        self._engine = make_engine(model.record)
        self._log = make_report(self._engine)
        self._run = make_run(self._engine, self._log)
        self._settling = False
        self._close_runners: Callable[[], object] = do_nothing
        if model.record.called or model.record.blocks:
            calls = Calls(model.tables, runners, fmus=fmus)
            self._engine.calls.answers = calls
            if runners is None:
                self._close_runners = weakref.finalize(self, calls.close)

    @property
    def t(self) -> float:
        """The time that was reached, s."""
        return self._engine.t

    @property
    def y(self) -> NDArray[np.float64]:
        """The state there: stored quantities, then integrated signals."""
        return np.array(self._engine.y, dtype=np.float64)

    @property
    def fault(self) -> Refusal:
        """What stopped the run."""
        return refusal(self._engine.fault)

    @property
    def unrest(self) -> Refusal:
        """Why a structure at rest had no solution, the last time."""
        return refusal(self._engine.unrest)

    @property
    def mode(self) -> tuple[int, ...]:
        """The state of each machine: in the mode that is being tried, or in which time passes."""
        e = self._engine
        states = e.trial.state if self._settling else e.state
        return tuple(states[: e.model.machines])

    @property
    def stuck(self) -> tuple[int, int, int, float, float]:
        """Of events that accumulate: machine or -1, how many, why, their limit, s, the ratio."""
        g = self._engine.landings
        return g.stuck_machine, g.stuck_events, g.stuck_why, g.limit_t, g.limit_ratio

    @property
    def energy(self) -> float:
        """The largest energy that the run has seen, J."""
        return self._engine.energy

    @property
    def rejected(self) -> int:
        """Steps that were tried and found too long."""
        return self._log.rejected

    @property
    def evaluations(self) -> int:
        """How often the rates of the state were evaluated."""
        return self._engine.evaluations

    @property
    def modes_made(self) -> int:
        """Modes whose equations were made."""
        return self._engine.modes_made

    @property
    def propagated(self) -> list[int]:
        """Modes that were propagated exactly; those that were not, reason by reason; slides.

        Empty if the method is another one.
        """
        exact: Any = self._engine.exact
        return [] if exact is None else exact.found[: self._engine.model.reasons + 2]

    def slices(
        self,
        *,
        steps: int | Callable[[], int] = SLICE,
        between: Callable[[float], None] | None = None,
    ) -> Iterator[Rows]:
        """Run on to the end; yield what was written down, slice after slice.

        As `hybond.engine.compiled.native.NativeRun.slices`. An interrupt that is raised in the
        midst of a slice, and not in what an input or a block does, ends the run without its rows:
        the last of them may be half written.

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
        NumericsError
            HB-N306 if a block fails.
        """
        if isinstance(steps, int):
            check_slice(steps)
        while self.status == PAUSED:
            many = steps if isinstance(steps, int) else steps()
            check_slice(many)
            with self._lock:
                self._go(many)
                rows = self._rows()
                forget_rows(self._log)
            yield rows
            if between is not None and self.status != RAISED:
                between(self.t)
        self._close_runners()
        if self.error is not None:
            raise self.error

    def tried(self, state: ArrayLike) -> NDArray[np.intc] | None:
        """Enter a mode at the start of a run that has not begun: of each rule whether it leaves it.

        As `hybond.engine.compiled.native.NativeRun.tried`.
        """
        check_fresh(self.status, self.t)
        asked = np.asarray(state, dtype=np.intc).tolist()
        hold = [0] * len(self.model.tables.rules)
        with self._lock:
            self.status = REFUSED
            self._settling = True
            status = try_at_start(self._engine, self._run, asked, hold)
        return np.array(hold, dtype=np.intc) if status == OK else None

    def _go(self, many: int) -> None:
        self._run.slice = many
        try:
            self.status = run_to_end(self._engine, self._run)
        except BaseException as error:  # whatever a function or a user raises
            self.status = RAISED
            self.error = error
            if not _raised_by_calls(error):
                forget_rows(self._log)
            return
        if self.status == REFUSED:
            self._settling = self._log.settling
            report_broken(self._engine, self._log, self._run.instant)

    def _rows(self) -> Rows:
        r, n, machines = self._log, self._engine.states, self._engine.model.machines
        warned = r.warned
        return Rows(
            _floats(r.step_time.at, r.steps, 3),
            _floats(r.step_until.at, r.steps),
            _floats(r.step_state.at, r.steps, 3, n),
            _floats(r.step_dense.at, r.steps, 4, n),
            _ints(r.step_place.at, r.steps, MACHINES_OF_STEP + 2 * machines),
            _floats(r.instant_time.at, r.instants, 2),
            _floats(r.instant_state.at, r.instants, 2, n),
            _ints(r.instant_place.at, r.instants, MACHINES_OF_INSTANT + 2 * machines),
            _ints(r.visit.at, r.visits, 5),
            _floats(r.visit_energy.at, r.visits, 3),
            _ints(r.fired.at, r.fireds, 6),
            _floats(r.read.at, r.reads, 3),
            _ints(r.hit.at, r.hits),
            _floats(r.hit_area.at, r.hits, 2),
            _ints(r.over.at, r.overs),
            _ints(r.open.at, r.opens),
            _ints(r.slid.at, r.slids),
            _floats(r.slide_time.at, r.slides),
            _ints(warned.kind.at, warned.rows),
            _ints(warned.first.at, warned.rows + 1 if warned.rows else 0),
            _floats(warned.time.at, warned.rows),
            _floats(warned.number.at, warned.numbers),
            _floats(r.step_bonds.at, r.bond_rows, r.bond_wide),
            _floats(r.step_energy.at, r.steps if r.bond_rows else 0, 3),
            _floats(r.instant_since.at, r.instants),
            _ints(r.step_bond.at, r.steps if r.bond_rows else 0),
        )


def refusal(fault: Fault | None) -> Refusal:
    """Return a refusal as the log's reader has it; empty texts if nothing was refused."""
    if fault is None:
        return Refusal("", "", "", 0.0, ())
    about = tuple(fault.about.at[: fault.many]) if fault.many > 0 else ()
    return Refusal(fault.code, fault.why, fault.place, fault.t, about)


def _raised_by_calls(error: BaseException) -> bool:
    """Whether an input or a block raised it: then all rows are whole."""
    return any(frame.f_code in CALLS for frame, _ in walk_tb(error.__traceback__))


def _floats(column: list[float], *shape: int) -> NDArray[np.float64]:
    return np.array(column[: int(np.prod(shape))], dtype=np.float64).reshape(shape)


def _ints(column: list[int], *shape: int) -> NDArray[np.intc]:
    return np.array(column[: int(np.prod(shape))], dtype=np.intc).reshape(shape)
