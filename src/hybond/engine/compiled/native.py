"""The library from Python: tables handed over, a run in slices, and what it wrote down.

Any number of runs live beside each other, on the same tables or others, each in one thread at a
time; tables are only read. The interpreter's lock is released while a slice runs, but where it
calls inputs and blocks, which are each run's own.
"""

from __future__ import annotations

import ctypes
import functools
import os
import threading
import weakref
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybond.blocks.runners import Runner
from hybond.engine.compiled.answering import CALLBACK, Answering, Calls, Question
from hybond.engine.compiled.refusal import Refusal, refusal_of
from hybond.engine.compiled.rows import (
    MACHINES_OF_INSTANT,
    MACHINES_OF_STEP,
    Rows,
    Seen,
    copied_floats,
    copied_ints,
)
from hybond.engine.compiled.sources import NAME, digest
from hybond.engine.tables import ModelTables
from hybond.engine.tables.code import Code

OK, REFUSED, ACCUMULATES, SPENT, PAUSED, RAISED = 0, 1, 3, 4, 7, 8
LONGEST_SLICE = 2**31 - 1
SLICE = 2000
"""Steps and instants between two looks at the world outside."""
_KINDS: dict[str, Any] = {
    "int": ctypes.c_int,
    "float": ctypes.c_double,
    "Ints": ctypes.POINTER(ctypes.c_int),
    "Floats": ctypes.POINTER(ctypes.c_double),
    "Texts": ctypes.POINTER(ctypes.c_char_p),
}
_NAMES = {
    "node_names": "nodes",
    "bond_names": "bonds",
    "rule_texts": "rules",
    "machine_names": "machines",
    "state_names": "states",
    "stored_names": "stored",
    "output_names": "outputs",
}


class Unavailable(Exception):
    """There is no library here; the text says why."""


@functools.cache
def library() -> ctypes.CDLL:
    """Return the library, loaded once.

    Raises
    ------
    Unavailable
    """
    chosen = os.environ.get("HYBOND_ENGINE", "")
    path = Path(chosen) if chosen else Path(__file__).parent / NAME
    if not path.is_file():
        raise Unavailable(f"{path.name} was not built")
    try:
        found = ctypes.CDLL(str(path))
        found.hybond_source.restype = ctypes.c_char_p
        made = found.hybond_source().decode()
    except (OSError, AttributeError) as error:
        raise Unavailable(f"{path.name} cannot be loaded: {error}") from error
    if made != digest():
        raise Unavailable(f"{path.name} was built from other sources: install hybond again")
    found.hybond_columns.restype = ctypes.POINTER(ctypes.c_char_p)
    found.hybond_begin.restype = ctypes.c_void_p
    found.hybond_begin.argtypes = [ctypes.c_void_p]
    found.hybond_run.argtypes = [ctypes.c_void_p, ctypes.c_int]
    found.hybond_try.argtypes = [ctypes.c_void_p] * 3
    found.hybond_see.argtypes = [ctypes.c_void_p, ctypes.POINTER(Seen)]
    found.hybond_see.restype = None
    found.hybond_ask.argtypes = [ctypes.c_void_p, ctypes.POINTER(Question), CALLBACK]
    found.hybond_ask.restype = None
    found.hybond_fault.restype = None
    for name in ("hybond_forget", "hybond_end"):
        getattr(found, name).argtypes = [ctypes.c_void_p]
        getattr(found, name).restype = None
    return found


@functools.cache
def columns() -> dict[str, str]:
    """Return the columns of a model's record, in order, with the types that the library names."""
    found: dict[str, str] = {}
    for column in library().hybond_columns():
        if column is None:
            break
        kind, name = column.decode().split()
        found[name] = kind
    return found


@functools.cache
def model_struct() -> type[ctypes.Structure]:
    """Return the record of a model as the library has it."""
    fields = [(name, _KINDS[kind]) for name, kind in columns().items()]
    found = type("ModelRecord", (ctypes.Structure,), {"_fields_": fields})
    if ctypes.sizeof(found) != library().hybond_model_size():
        raise Unavailable("the library has a record of models of another size")
    return found


class NativeModel:
    """The tables of a model where the library reads them.

    Parameters
    ----------
    tables : ModelTables
    """

    def __init__(self, tables: ModelTables) -> None:
        self.tables = tables
        self._kept: list[object] = []
        self.record = model_struct()()
        code = Code(tables.slots.index, tables.slots.size)
        values = [code.add(e, paired=False) for e in tables.values.all]
        pairs = [code.add(e, paired=True) for e in tables.pairs]
        ints = {**tables.ints, "code": code.instructions, "value_begins": values}
        ints["pair_begins"] = pairs
        floats = {**tables.floats, "code_number": code.numbers}
        for name, kind in columns().items():
            if kind in ("int", "float"):
                number = tables.numbers[name]
                setattr(self.record, name, int(number) if kind == "int" else float(number))
            elif kind == "Ints":
                self._put(name, np.array(ints[name] or [0], dtype=np.intc), ctypes.c_int)
            elif kind == "Floats":
                self._put(name, np.array(floats[name] or [0.0]), ctypes.c_double)
            else:
                texts = [t.encode() for t in getattr(tables, _NAMES[name])] or [b""]
                row = (ctypes.c_char_p * len(texts))(*texts)
                self._kept.append(row)
                setattr(self.record, name, ctypes.cast(row, ctypes.POINTER(ctypes.c_char_p)))

    def _put(self, name: str, column: NDArray[Any], kind: Any) -> None:
        self._kept.append(column)
        setattr(self.record, name, column.ctypes.data_as(ctypes.POINTER(kind)))


class NativeRun:
    """One run of a model by the library.

    Parameters
    ----------
    model : NativeModel
    runners : mapping of str to Runner
        What runs each block, by its path; others have to close them. By default the run has its
        own, and closes them when it ends.
    fmus : bool
        The consent to run the code of functional mock-up units.

    Raises
    ------
    Unavailable
        If there is no library.
    UsageError
        HB-S117 for an FMU without consent.
    MemoryError

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.engine.tables import tables_of
    >>> graph = hb.load("examples/buck.toml").flatten()
    >>> run = NativeRun(NativeModel(tables_of(graph)))
    >>> sum(len(rows.instant_time) for rows in run.slices())
    12
    >>> run.status == OK, run.t
    (True, 1e-05)
    """

    def __init__(
        self,
        model: NativeModel,
        *,
        runners: Mapping[str, Runner] | None = None,
        fmus: bool = False,
    ) -> None:
        self.model = model
        self._library = library()
        numbers = model.tables.numbers
        self._answering: Answering | None = None
        self._close_runners: Callable[[], object] = do_nothing
        calls = None
        if numbers["called"] or numbers["blocks"]:
            calls = Calls(model.tables, runners, fmus=fmus)
        handle = self._library.hybond_begin(ctypes.byref(model.record))
        if not handle:
            raise MemoryError
        self._handle = ctypes.c_void_p(handle)
        self._lock = threading.Lock()
        self._close = weakref.finalize(self, self._library.hybond_end, self._handle)
        if calls is not None:
            self._answering = Answering(calls)
            question = ctypes.byref(self._answering.question)
            self._library.hybond_ask(self._handle, question, self._answering.callback)
            if runners is None:
                self._close_runners = weakref.finalize(self, calls.close)
        self._seen = Seen()
        self.status = PAUSED
        self._look()

    def _look(self) -> None:
        self._library.hybond_see(self._handle, ctypes.byref(self._seen))

    @property
    def t(self) -> float:
        """The time that was reached, s."""
        return float(self._seen.t)

    @property
    def y(self) -> NDArray[np.float64]:
        """The state there: stored quantities, then integrated signals."""
        return copied_floats(self._seen.y, self._seen.states)

    @property
    def fault(self) -> Refusal:
        """What stopped the run."""
        return refusal_of(self._library, self._handle, 0)

    @property
    def unrest(self) -> Refusal:
        """Why a structure at rest had no solution, the last time."""
        return refusal_of(self._library, self._handle, 1)

    @property
    def mode(self) -> tuple[int, ...]:
        """The state of each machine: in the mode that is being tried, or in which time passes."""
        seen = self._seen
        states = seen.tried if seen.settling else seen.state
        return tuple(states[k] for k in range(self.model.record.machines))

    @property
    def stuck(self) -> tuple[int, int, int, float, float]:
        """Of events that accumulate: machine or -1, how many, why, their limit, s, the ratio."""
        s = self._seen
        return s.stuck_machine, s.stuck_events, s.stuck_why, s.stuck_t, s.stuck_ratio

    @property
    def energy(self) -> float:
        """The largest energy that the run has seen, J."""
        return float(self._seen.energy)

    @property
    def rejected(self) -> int:
        """Steps that were tried and found too long."""
        return int(self._seen.rejected)

    @property
    def evaluations(self) -> int:
        """How often the rates of the state were evaluated."""
        return int(self._seen.evaluations)

    @property
    def modes_made(self) -> int:
        """Modes whose equations were made."""
        return int(self._seen.modes_made)

    @property
    def propagated(self) -> list[int]:
        """Modes that were propagated exactly; those that were not, reason by reason; slides.

        Empty if the method is another one.
        """
        seen = self._seen.propagated
        return seen[: int(self.model.record.reasons) + 2] if seen else []

    @property
    def error(self) -> BaseException | None:
        """What an input or a block raised, which ended the run; None if nothing was."""
        return None if self._answering is None else self._answering.error

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
            check_slice(steps)
        while self.status == PAUSED:
            many = steps if isinstance(steps, int) else steps()
            check_slice(many)
            with self._lock:
                self.status = self._library.hybond_run(self._handle, many)
                self._look()
                if self.status == SPENT:
                    raise MemoryError
                if self.error is not None:
                    self.status = RAISED
                rows = self._rows()
                self._library.hybond_forget(self._handle)
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
        hold = np.zeros(len(self.model.tables.rules), dtype=np.intc)
        check_fresh(self.status, self.t)
        with self._lock:
            status = self._library.hybond_try(self._handle, asked.ctypes.data, hold.ctypes.data)
            self._look()
            self.status = REFUSED
        if status == SPENT:
            raise MemoryError
        if self.error is not None:
            raise self.error
        return hold if status == OK else None

    def _rows(self) -> Rows:
        s = self._seen
        n, machines = s.states, self.model.record.machines
        return Rows(
            copied_floats(s.step_time, s.steps, 3),
            copied_floats(s.step_until, s.steps),
            copied_floats(s.step_state, s.steps, 3, n),
            copied_floats(s.step_dense, s.steps, 4, n),
            copied_ints(s.step_place, s.steps, MACHINES_OF_STEP + 2 * machines),
            copied_floats(s.instant_time, s.instants, 2),
            copied_floats(s.instant_state, s.instants, 2, n),
            copied_ints(s.instant_place, s.instants, MACHINES_OF_INSTANT + 2 * machines),
            copied_ints(s.visit, s.visits, 5),
            copied_floats(s.visit_energy, s.visits, 3),
            copied_ints(s.fired, s.fireds, 6),
            copied_floats(s.read, s.reads, 3),
            copied_ints(s.hit, s.hits),
            copied_floats(s.hit_area, s.hits, 2),
            copied_ints(s.over, s.overs),
            copied_ints(s.open, s.opens),
            copied_ints(s.slid, s.slids),
            copied_floats(s.slide_time, s.slides),
            copied_ints(s.warn, s.warns),
            copied_ints(s.warn_first, s.warns + 1 if s.warns else 0),
            copied_floats(s.warn_time, s.warns),
            copied_floats(s.about, s.abouts),
            copied_floats(s.step_bonds, s.bond_rows, 2 * self.model.record.bonds),
            copied_floats(s.step_energy, s.steps if s.bond_rows else 0, 3),
            copied_floats(s.instant_since, s.instants),
            copied_ints(s.step_bond, s.steps if s.bond_rows else 0),
        )


def check_slice(steps: int) -> None:
    """Refuse a slice that is none.

    Raises
    ------
    ValueError
    """
    if steps != -1 and not 1 <= steps <= LONGEST_SLICE:
        raise ValueError(f"a slice of {steps} steps: 1 to {LONGEST_SLICE}, or -1: all in one")


def check_fresh(status: int, t: float) -> None:
    """Refuse to try a mode in a run that has begun.

    Raises
    ------
    ValueError
    """
    if status != PAUSED or t > 0.0:
        raise ValueError("the run has begun")


def do_nothing() -> None:
    """Do nothing: a run without blocks has none to close."""
