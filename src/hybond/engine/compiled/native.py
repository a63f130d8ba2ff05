"""The library from Python: tables handed over, a run in slices, and what it wrote down.

Any number of runs live beside each other, on the same tables or others, each in one thread at a
time; tables are only read. The interpreter's lock is released while a slice runs, but where it
calls inputs and blocks, which are each run's own.
"""

from __future__ import annotations

import ctypes
import functools
import os
import weakref
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from hybond.blocks.runners import Runner
from hybond.engine.compiled.answering import CALLBACK, Answering, Question
from hybond.engine.compiled.fresh import HERE, NAME, WHY, is_of_these_sources
from hybond.engine.compiled.kept_rows import WIDE, KeptRows, SharedRows
from hybond.engine.compiled.refusal import Refusal, refusal_of
from hybond.engine.compiled.rows import COUNTS, STATES, STEPS, Rows, Seen, rows_of
from hybond.engine.compiled.sliced import OK, PAUSED, RAISED, SPENT, SlicedRun, fitted
from hybond.engine.tables import ModelTables
from hybond.engine.tables.code import Code
from hybond.model.expressions.slots import plain, slot_of

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
    path = chosen or os.path.join(HERE, NAME)
    name = os.path.basename(path)
    if not os.path.isfile(path):
        raise Unavailable(f"{name} was not built" + ("" if chosen else _why()))
    try:
        found = ctypes.CDLL(path)
        found.hybond_source.restype = ctypes.c_char_p
        made = found.hybond_source().decode()
    except (OSError, AttributeError) as error:
        raise Unavailable(f"{name} cannot be loaded: {error}") from error
    if not is_of_these_sources(made):
        raise Unavailable(f"{name} was built from other sources: install hybond again")
    found.hybond_columns.restype = ctypes.POINTER(ctypes.c_char_p)
    found.hybond_begin.restype = ctypes.c_void_p
    found.hybond_begin.argtypes = [ctypes.c_void_p, ctypes.c_int]
    found.hybond_run.argtypes = [ctypes.c_void_p, ctypes.c_int]
    found.hybond_try.argtypes = [ctypes.c_void_p] * 3
    found.hybond_see.argtypes = [ctypes.c_void_p, ctypes.POINTER(Seen)]
    found.hybond_see.restype = None
    found.hybond_ask.argtypes = [ctypes.c_void_p, ctypes.POINTER(Question), CALLBACK]
    found.hybond_ask.restype = None
    found.hybond_fault.restype = None
    found.hybond_take.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    found.hybond_put.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_double, ctypes.c_int]
    for name in ("hybond_forget", "hybond_end"):
        getattr(found, name).argtypes = [ctypes.c_void_p]
        getattr(found, name).restype = None
    return found


def _why() -> str:
    """Return what the installation noted when it could not build the library, in one line."""
    with suppress(OSError), open(os.path.join(HERE, WHY), encoding="utf-8") as file:
        return ": " + " ".join(file.read().split())
    return ""


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


@functools.cache
def places(kind: str) -> dict[str, int]:
    """Return the columns of a kind, and which pointer of the record each is."""
    record, size = model_struct(), np.dtype(np.uintp).itemsize
    return {n: getattr(record, n).offset // size for n, k in columns().items() if k == kind}


class NativeModel:
    """The tables of a model where the library reads them."""

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
        self.written = [
            (name, k, slot.tree)
            for name, row in floats.items()
            for k, slot in enumerate(map(slot_of, row))
            if slot is not None
        ]
        """What parameters write: columns, places in them, and expressions of parameters."""
        for name, kind in columns().items():
            if kind in ("int", "float"):
                number = tables.numbers[name]
                setattr(self.record, name, int(number) if kind == "int" else float(number))
            elif kind == "Texts":
                self._put_texts(name, [t.encode() for t in getattr(tables, _NAMES[name])] or [b""])
        self._put_all("Ints", ints, np.intc)
        numbers = {name: [*map(plain, floats[name])] for name in places("Floats")}
        self.floats = self._put_all("Floats", numbers, np.float64)

    def written_with(self, tables: ModelTables) -> NativeModel:
        """Return this model with other numbers in its slots: those of the graph of `tables`."""
        written = tables.graph.written
        assert written is not None
        found = NativeModel.__new__(NativeModel)
        found.tables = tables
        found.written = []
        found._kept = [self]
        found.record = model_struct()()
        size = ctypes.sizeof(found.record)
        ctypes.memmove(ctypes.byref(found.record), ctypes.byref(self.record), size)
        found.floats = dict(self.floats)
        for name in dict.fromkeys(name for name, _, _ in self.written):
            found.floats[name] = self.floats[name].copy()
            found._put(name, found.floats[name], ctypes.c_double)
        for name, k, tree in self.written:
            found.floats[name][k] = written.writing.value(tree, written.row)
        return found

    def _put_all(
        self, kind: str, rows: Mapping[str, Sequence[float]], dtype: DTypeLike
    ) -> dict[str, NDArray[Any]]:
        """Put all columns of a kind, which stand behind each other in one array; return them."""
        at = places(kind)
        numbers: list[float] = []
        begins = []
        for name in at:
            begins.append(len(numbers))
            numbers += rows[name] or (0,)  # a pointer must be to something
        whole = np.array(numbers, dtype=dtype)
        self._kept.append(whole)
        record = np.frombuffer(memoryview(self.record), dtype=np.uintp)
        record[[*at.values()]] = whole.ctypes.data + whole.itemsize * np.array(begins)
        ends = [*begins[1:], len(whole)]
        return {name: whole[a:b] for name, a, b in zip(at, begins, ends, strict=True)}

    def _put_texts(self, name: str, texts: Sequence[bytes]) -> None:
        """Put texts one behind the other in one piece of memory, and where each begins."""
        whole = np.frombuffer(b"\0".join(texts) + b"\0", dtype=np.uint8)
        begins = np.zeros(len(texts), dtype=np.uintp)
        np.cumsum([len(t) + 1 for t in texts[:-1]], out=begins[1:])
        begins += whole.ctypes.data
        self._kept += [whole, begins]
        pointer = ctypes.POINTER(ctypes.c_char_p)
        setattr(self.record, name, ctypes.cast(begins.ctypes.data, pointer))

    def _put(self, name: str, column: NDArray[Any], kind: Any) -> None:
        self._kept.append(column)
        setattr(self.record, name, column.ctypes.data_as(ctypes.POINTER(kind)))


class Carried(ctypes.Structure):
    """What a run hands to one that goes on from it, as the library shows it."""

    _fields_: ClassVar[Any] = [
        ("floats", ctypes.c_int),
        ("ints", ctypes.c_int),
        ("number", ctypes.POINTER(ctypes.c_double)),
        ("place", ctypes.POINTER(ctypes.c_int)),
    ]


class NativeRun(SlicedRun):
    """One run of a model by the library.

    Parameters
    ----------
    runners : mapping of str to Runner
        As `SlicedRun`.
    fmus : bool
        Likewise.

    Raises
    ------
    Unavailable
        If there is no library.

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.engine.tables import tables_of
    >>> graph = hb.load("examples/buck.toml").flatten()
    >>> run = NativeRun(NativeModel(tables_of(graph)))
    >>> sum(len(rows.instant_time) for rows in run.slices())
    11
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
        super().__init__(model.tables, runners, fmus=fmus)
        self.model = model
        self._library = library()
        self._handle = begun(self, model)
        self._answering = Answering(self._calls, self.onlooker)
        self._answering.of(self._library, self._handle)
        self._seen = Seen()
        self._kept = KeptRows()
        self._see()

    def _refusal(self, which: int) -> Refusal:
        return refusal_of(self._library, self._handle, which)

    def _see(self) -> None:
        s, model = self._seen, self.model.record
        self._library.hybond_see(self._handle, ctypes.byref(s))
        self.t, self.energy = s.t, s.energy
        self.y = copied(s.y, np.float64, (s.states,))
        self.mode = tuple((s.tried if s.settling else s.state)[: model.machines])
        self.stuck = s.stuck_machine, s.stuck_events, s.stuck_why, s.stuck_t, s.stuck_ratio
        self.rejected, self.evaluations, self.modes_made = s.rejected, s.evaluations, s.modes_made
        self.propagated = s.propagated[: model.reasons + 2] if s.propagated else []
        self.error = self._answering.error

    def _go(self, many: int) -> None:
        self.status = self._library.hybond_run(self._handle, many)
        self._see()
        if self.status == SPENT:
            raise MemoryError
        if self.error is not None:
            self.status = RAISED

    def _try(self, state: NDArray[np.intc]) -> NDArray[np.intc] | None:
        hold = np.zeros(len(self.tables.rules), dtype=np.intc)
        status = self._library.hybond_try(self._handle, state.ctypes.data, hold.ctypes.data)
        self._see()
        if status == SPENT:
            raise MemoryError
        if self.error is not None:
            raise self.error
        return hold if status == OK else None

    def carried(self) -> tuple[NDArray[np.float64], NDArray[np.intc]]:
        """Return what a run that goes on from here is handed."""
        seen = self._taken_out()
        return (
            copied(seen.number, np.float64, (seen.floats,)),
            copied(seen.place, np.intc, (seen.ints,)),
        )

    def _taken_out(self) -> Carried:
        seen = Carried()
        if self._library.hybond_take(self._handle, ctypes.byref(seen)) == SPENT:
            raise MemoryError
        return seen

    def begin_from(
        self, number: ArrayLike, place: ArrayLike, *, way: int, until: float, deep: bool
    ) -> None:
        """Let the run, which has not begun, begin with such numbers."""
        if self.status != PAUSED or self.t > 0.0:
            raise ValueError("the run has begun")
        numbers, places = fitted(self.carried(), number, place, deep=deep)
        seen = self._taken_out()
        ctypes.memmove(seen.number, numbers.ctypes.data, numbers.nbytes)
        ctypes.memmove(seen.place, places.ctypes.data, places.nbytes)
        if self._library.hybond_put(self._handle, way, until, int(deep)) == SPENT:
            raise MemoryError
        self._see()

    def _taken(self) -> Rows:
        s, model = self._seen, self.model.record
        rows = rows_of(
            {name: getattr(s, name) for name in (*COUNTS, "warns", "abouts")},
            self._column,
            states=s.states,
            machines=model.machines,
            bonds=model.bonds,
        )
        self._library.hybond_forget(self._handle)
        return rows

    def _column(self, name: str, kind: type, shape: tuple[int, ...]) -> Any:
        begin = getattr(self._seen, name)
        if name in STATES and shape[-1] >= WIDE and all(shape):
            return SharedRows.of(_shown(begin, kind, shape), self._kept, name)
        if name in STEPS and all(shape):
            return self._kept.added(name, _shown(begin, kind, shape))
        return copied(begin, kind, shape)


def begun(owner: object, model: NativeModel, *, looking: bool = False) -> ctypes.c_void_p:
    """Return a new run or look in the library, whose memory is given back with its owner.

    Raises
    ------
    MemoryError
    """
    handle = library().hybond_begin(ctypes.byref(model.record), int(looking))
    if not handle:
        raise MemoryError
    found = ctypes.c_void_p(handle)
    weakref.finalize(owner, library().hybond_end, found)
    return found


def copied(begin: Any, kind: type, shape: tuple[int, ...]) -> NDArray[Any]:
    """Return an array of the library as our own."""
    found: NDArray[Any] = np.empty(shape, dtype=kind)
    # not as an array of ctypes: a type of its own for each size takes fifty times as long
    if found.size:
        ctypes.memmove(found.ctypes.data, begin, found.nbytes)
    return found


class _Place:
    """An array where the library has it, as numpy reads it."""

    def __init__(self, begin: Any, kind: type, shape: tuple[int, ...]) -> None:
        at = ctypes.cast(begin, ctypes.c_void_p).value
        self.__array_interface__ = {
            "data": (at, True),
            "shape": shape,
            "typestr": np.dtype(kind).str,
            "version": 3,
        }


def _shown(begin: Any, kind: type, shape: tuple[int, ...]) -> NDArray[Any]:
    """Return an array where the library has it."""
    return np.asarray(_Place(begin, kind, shape))
