"""A run by the engine as it stands, in this interpreter.

What `hybond.engine.compiled.native` has of the library, with the same log, row for row.
"""

from __future__ import annotations

from collections.abc import Mapping
from traceback import walk_tb
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybond.blocks.runners import Runner
from hybond.engine.compiled.answering import Calls, Onlooker
from hybond.engine.compiled.refusal import Refusal
from hybond.engine.compiled.rows import COUNTS, FLOATS, INTS, Rows, rows_of
from hybond.engine.compiled.sliced import OK, PAUSED, RAISED, REFUSED, SlicedRun, fitted
from hybond.engine.engine import Fault, make_engine
from hybond.engine.model import Model
from hybond.engine.run.carried import make_carrier, take_out, take_over
from hybond.engine.run.log import forget_rows, make_report, report_broken
from hybond.engine.run.motion import run_to_end
from hybond.engine.run.run_records import make_run
from hybond.engine.run.trying import try_at_start
from hybond.engine.tables import ModelTables, answered

CALLS = tuple(f.__code__ for f in (Calls.value, Calls.rate, Calls.block, Onlooker.look))


class PythonModel:
    """The tables of a model where the engine in Python reads them."""

    def __init__(self, tables: ModelTables) -> None:
        self.tables = tables
        self.record: Model = answered(tables)


class PythonRun(SlicedRun):
    """One run of a model by the engine in Python.

    An interrupt that is raised in the midst of a slice, and not in what an input or a block does,
    ends the run without its rows: the last of them may be half written.

    Parameters
    ----------
    runners : mapping of str to Runner
        As `SlicedRun`.
    fmus : bool
        Likewise.

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.engine.tables import tables_of
    >>> graph = hb.load("examples/buck.toml").flatten()
    >>> run = PythonRun(PythonModel(tables_of(graph)))
    >>> sum(len(rows.instant_time) for rows in run.slices())
    11
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
        super().__init__(model.tables, runners, fmus=fmus)
        self.model = model
        self._engine = make_engine(model.record)
        self._log = make_report(self._engine)
        self._run = make_run(self._engine, self._log)
        self._settling = False
        if self._calls is not None:
            self._engine.calls.answers = self._calls
        if model.record.tells != 0:
            self._engine.calls.outside = self.onlooker
        self._see()

    def _refusal(self, which: int) -> Refusal:
        return refusal(self._engine.fault if which == 0 else self._engine.unrest)

    def _see(self) -> None:
        e, g, m = self._engine, self._engine.landings, self.model.record
        self.t, self.energy = e.t, e.energy
        self.y = np.array(e.y, dtype=np.float64)
        self.mode = tuple((e.trial.state if self._settling else e.state)[: m.machines])
        self.stuck = g.stuck_machine, g.stuck_events, g.stuck_why, g.limit_t, g.limit_ratio
        self.rejected, self.evaluations = self._log.rejected, e.evaluations
        self.modes_made = e.modes_made
        exact: Any = e.exact
        self.propagated = [] if exact is None else exact.found[: m.reasons + 2]

    def _go(self, many: int) -> None:
        self._run.slice = many
        try:
            self.status = run_to_end(self._engine, self._run)
        except BaseException as error:  # whatever a function or a user raises
            self.status = RAISED
            self.error = error
            if not _raised_by_calls(error):
                forget_rows(self._log)
        if self.status == REFUSED:
            self._settling = self._log.settling
            report_broken(self._engine, self._log, self._run.instant)
        self._see()

    def _try(self, state: NDArray[np.intc]) -> NDArray[np.intc] | None:
        hold = [0] * len(self.tables.rules)
        self._settling = True
        status = try_at_start(self._engine, self._run, state.tolist(), hold)
        self._see()
        return np.array(hold, dtype=np.intc) if status == OK else None

    def carried(self) -> tuple[NDArray[np.float64], NDArray[np.intc]]:
        """Return what a run that goes on from here is handed."""
        c = make_carrier(self._engine)
        take_out(self._engine, self._run, c)
        return (
            np.array(c.number.at[: c.floats], dtype=np.float64),
            np.array(c.place.at[: c.ints], dtype=np.intc),
        )

    def begin_from(
        self, number: ArrayLike, place: ArrayLike, *, way: int, until: float, deep: bool
    ) -> None:
        """Let the run, which has not begun, begin with such numbers."""
        if self.status != PAUSED or self.t > 0.0:
            raise ValueError("the run has begun")
        numbers, places = fitted(self.carried(), number, place, deep=deep)
        c = make_carrier(self._engine)
        take_out(self._engine, self._run, c)
        c.number.at[: len(numbers)] = numbers.tolist()
        c.place.at[: len(places)] = places.tolist()
        take_over(self._engine, self._run, c, way, until, deep)
        self._see()

    def _taken(self) -> Rows:
        log, warned, m = self._log, self._log.warned, self.model.record
        columns = {name: getattr(log, name).at for name in (*FLOATS, *INTS)}
        columns["warn"], columns["warn_first"] = warned.kind.at, warned.first.at
        columns["warn_time"], columns["about"] = warned.time.at, warned.number.at
        many = {name: getattr(log, name) for name in COUNTS}
        rows = rows_of(
            {**many, "warns": warned.rows, "abouts": warned.numbers},
            lambda name, kind, shape: np.array(
                columns[name][: int(np.prod(shape))], dtype=kind
            ).reshape(shape),
            states=self._engine.states,
            machines=m.machines,
            bonds=m.bonds,
        )
        forget_rows(log)
        return rows


def refusal(fault: Fault | None) -> Refusal:
    """Return a refusal as the log's reader has it; empty texts if nothing was refused."""
    if fault is None:
        return Refusal("", "", "", 0.0, ())
    about = tuple(fault.about.at[: fault.many]) if fault.many > 0 else ()
    return Refusal(fault.code, fault.why, fault.place, fault.t, about)


def _raised_by_calls(error: BaseException) -> bool:
    """Whether an input or a block raised it: then all rows are whole."""
    return any(frame.f_code in CALLS for frame, _ in walk_tb(error.__traceback__))
