"""Runs of one model with other numbers in its tables, one after the other, by the library.

What they are run with and what is kept of them are arrays; any number of threads may each run some
of them, on tables of their own. What an ordinary run has more to say of is left to one.
"""

from __future__ import annotations

import ctypes
import weakref
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.native import NativeModel, copied, library, model_struct
from hybond.engine.compiled.points import address
from hybond.engine.compiled.sliced import OK
from hybond.records import dataclass

Vector = NDArray[np.float64]
Whole = NDArray[np.intp]
_POINTERS = ("number", "place", "slot", "t", "stop", "status", "count", "end", "out")


class Sets(ctypes.Structure):
    """Members to run, and what is kept of them: as `HybondSets` in ``members.c``."""

    _fields_ = (
        *((name, ctypes.c_int) for name in ("many", "entries", "outputs", "times")),
        *((name, ctypes.c_void_p) for name in _POINTERS),
        ("done", ctypes.c_int),
        ("events", ctypes.c_size_t),
        ("event", ctypes.POINTER(ctypes.c_double)),
        ("stays", ctypes.c_void_p),
        ("rows", ctypes.c_size_t),
        ("since", ctypes.POINTER(ctypes.c_double)),
        ("mode", ctypes.POINTER(ctypes.c_int)),
        ("measured", ctypes.c_int),
        *((name, ctypes.c_void_p) for name in ("measure", "stepped", "struck", "energy")),
        ("laid", ctypes.c_size_t),
        ("time", ctypes.POINTER(ctypes.c_double)),
        ("motion", ctypes.POINTER(ctypes.c_int)),
    )


class Looked(ctypes.Structure):
    """Points to look at: as `HybondLooked` in ``members.c``."""

    _fields_ = (
        *(("points", ctypes.c_int), ("slots", ctypes.c_int)),
        *((name, ctypes.c_void_p) for name in ("member", "step", "slot", "t", "out", "blind")),
    )


@dataclass(frozen=True, slots=True)
class Kept:
    """The steps of members, one after the other, and where they may be looked at.

    Parameters
    ----------
    many : array of int, shape (members,)
        Steps of each.
    time : array, shape (steps, 2)
        When each begins and where it was ended, s.
    begins : array of bool, shape (steps,)
        Whether a motion begins with it.
    struck : array of bool, shape (members, slots)
        Whether what is measured had an impulse.
    look : callable
        Of members, steps and times of points in order: what is measured there, shape
        (points, slots), and the members of which not all can be read.
    """

    many: NDArray[np.intc]
    time: Vector
    begins: NDArray[np.bool_]
    struck: NDArray[np.bool_]
    look: Callable[[Whole, Whole, Vector], tuple[Vector, NDArray[np.bool_]]]


@dataclass(frozen=True, slots=True)
class Ran:
    """What is kept of members.

    Parameters
    ----------
    plain : array of bool, shape (members,)
        Which of them were run; the others an ordinary run has more to say of.
    count : array of int, shape (members,)
        Events.
    end : array, shape (members,)
        The time reached, s.
    out : array, shape (members, times + 1, outputs)
        Slots at the times, then at the end.
    events : array
        Times of the events of all members that were run.
    stays : array of int, shape (members,)
        How many modes each wrote; none if they were not asked for.
    since : array
        When these were entered, s, of all members.
    mode : array of int, shape (modes, machines)
        The states of the machines in them.
    kept : Kept or None
        Their steps, until the next are run.
    measured, known : arrays or None
        What was measured of them, shape (measures, members), and of which members all was.
    """

    plain: NDArray[np.bool_]
    count: NDArray[np.intc]
    end: Vector
    out: Vector
    events: Vector
    stays: NDArray[np.intc]
    since: Vector
    mode: NDArray[np.intc]
    kept: Kept | None = None
    measured: Vector | None = None
    known: NDArray[np.bool_] | None = None


class NativeMembers:
    """Members of one model in one thread, on a copy of what parameters write.

    Parameters
    ----------
    model : NativeModel
    slots : array of int
        What is looked at.
    t : array
        When, s, in order; and at the end besides.
    stop : ctypes.c_int
        Not zero: members end early.
    modes : bool
        Whether the modes that were written are kept.
    measured : array of int
        What is measured: steps are kept for it.

    Raises
    ------
    MemoryError
    """

    def __init__(
        self,
        model: NativeModel,
        slots: NDArray[np.intc],
        t: Vector,
        stop: ctypes.c_int,
        *,
        modes: bool = False,
        measured: NDArray[np.intc] | None = None,
    ) -> None:
        self._library = _running()
        self._modes = modes
        self._measured = np.zeros(0, dtype=np.intc) if measured is None else measured
        self._slots, self._t, self._stop = slots, t, stop
        self._model = model
        self._record = model_struct()()
        ctypes.memmove(
            ctypes.byref(self._record), ctypes.byref(model.record), ctypes.sizeof(self._record)
        )
        self._own: dict[str, Vector] = {}
        for name in dict.fromkeys(name for name, _, _ in model.written):
            own = self._own[name] = model.floats[name].copy()
            pointer = own.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
            setattr(self._record, name, pointer)
        self._places = np.array(
            [self._own[name].ctypes.data + 8 * k for name, k, _ in model.written], dtype=np.uintp
        )
        handle = self._library.hybond_members_begin(ctypes.byref(self._record), len(t))
        if not handle:
            raise MemoryError
        self._handle = ctypes.c_void_p(handle)
        self._close = weakref.finalize(self, self._library.hybond_members_end, self._handle)

    def run(self, numbers: Vector) -> Ran:
        """Run members; `numbers` has a row for each, what parameters write in it.

        Fewer come back than were given if they were stopped.
        """
        many = len(numbers)
        status, count = np.zeros((2, many), dtype=np.intc)
        end = np.zeros(many)
        out = np.full((many, len(self._t) + 1, len(self._slots)), np.nan)
        given = np.ascontiguousarray(numbers)
        stays = np.zeros(many if self._modes else 0, dtype=np.intc)
        sets = Sets(many, given.shape[1], len(self._slots), len(self._t))
        for name, column in (
            ("number", given),
            ("place", self._places),
            ("slot", self._slots),
            ("t", self._t),
            ("status", status),
            ("count", count),
            ("end", end),
            ("out", out),
        ):
            setattr(sets, name, address(column))
        sets.stop = ctypes.addressof(self._stop)
        if self._modes:
            sets.stays = address(stays)
        measured = len(self._measured)
        stepped = np.zeros(many if measured else 0, dtype=np.intc)
        struck = np.zeros((len(stepped), measured), dtype=np.uint8)
        energy = np.zeros(len(stepped))
        if measured:
            sets.measured, sets.measure = measured, address(self._measured)
            sets.stepped, sets.energy = address(stepped), address(energy)
            sets.struck = address(struck)
        done = self._library.hybond_members_run(self._handle, ctypes.byref(sets))
        events = copied(sets.event, np.float64, (sets.events,))
        since = copied(sets.since, np.float64, (sets.rows,))
        mode = copied(sets.mode, np.intc, (sets.rows, self._record.machines))
        kept = None
        if measured:
            motion = copied(sets.motion, np.intc, (sets.laid,))
            kept = Kept(
                stepped[:done],
                copied(sets.time, np.float64, (sets.laid, 3))[:, ::2].copy(),
                motion == np.arange(sets.laid),
                struck[:done].astype(bool),
                self._looking(sets, (given, energy)),
            )
        return Ran(
            *(status[:done] == OK, count[:done], end[:done], out[:done], events),
            *(stays[:done], since, mode, kept),
        )

    def _looking(
        self, sets: Sets, kept: tuple[Vector, ...]
    ) -> Callable[[Whole, Whole, Vector], tuple[Vector, NDArray[np.bool_]]]:
        """Return what looks at points of the members that have just run; `kept` is read by it."""

        def look(member: Whole, step: Whole, t: Vector) -> tuple[Vector, NDArray[np.bool_]]:
            whose, where = member.astype(np.intc), step.astype(np.intc)
            times = np.ascontiguousarray(t, dtype=float)
            out = np.full((len(times), len(self._measured)), np.nan)
            blind = np.zeros(len(kept[0]), dtype=np.uint8)
            record = Looked(len(times), len(self._measured))
            for name, column in (
                *(("member", whose), ("step", where), ("slot", self._measured)),
                *(("t", times), ("out", out), ("blind", blind)),
            ):
                setattr(record, name, address(column))
            self._library.hybond_members_look(
                self._handle, ctypes.byref(sets), ctypes.byref(record)
            )
            return out, blind.astype(bool)

        return look


def _running() -> Any:
    found = library()
    found.hybond_members_begin.restype = ctypes.c_void_p
    found.hybond_members_begin.argtypes = [ctypes.c_void_p, ctypes.c_int]
    found.hybond_members_run.argtypes = [ctypes.c_void_p, ctypes.POINTER(Sets)]
    found.hybond_members_look.argtypes = [
        *(ctypes.c_void_p, ctypes.POINTER(Sets), ctypes.POINTER(Looked))
    ]
    found.hybond_members_look.restype = None
    found.hybond_members_end.argtypes = [ctypes.c_void_p]
    found.hybond_members_end.restype = None
    return found
