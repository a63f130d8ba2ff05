"""Runs looked at once a period, or at events of one kind, value after value, by the library.

While a run settles nothing of it is kept. A value begins as the model does, or goes on from where
the one before has come. What an ordinary run has more to say of is left to one.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.members import NativeMembers
from hybond.engine.compiled.native import NativeModel, copied
from hybond.engine.compiled.points import address
from hybond.engine.compiled.sliced import OK, SPENT

Vector = NDArray[np.float64]
_WHOLE = ("many", "entries", "outputs", "settle", "keep", "machine", "state", "before", "carry")
_POINTERS = ("number", "place", "slot", "period", "stop", "status", "found", "when", "out", "stays")


class Sections(ctypes.Structure):
    """Values to run, and what is kept of them: as `HybondSections` in ``sections.c``."""

    _fields_ = (
        *((name, ctypes.c_int) for name in (*_WHOLE, "begun")),
        *((name, ctypes.c_void_p) for name in _POINTERS),
        ("counted", ctypes.c_double),
        ("floats", ctypes.c_int),
        ("ints", ctypes.c_int),
        ("carried", ctypes.c_void_p),
        ("carried_place", ctypes.c_void_p),
        ("left", ctypes.c_void_p),
        ("left_place", ctypes.c_void_p),
        ("left_counted", ctypes.c_void_p),
        ("done", ctypes.c_int),
        ("rows", ctypes.c_size_t),
        ("since", ctypes.POINTER(ctypes.c_double)),
        ("mode", ctypes.POINTER(ctypes.c_int)),
    )


@dataclass(frozen=True, slots=True)
class Cut:
    """When runs are looked at.

    Parameters
    ----------
    settle, keep : int
        Periods, or events: passed over, then looked at.
    machine, state : int
        The event is that this machine enters this state; -1: once a period.
    before : bool
        Whether the left limit is looked at.
    """

    settle: int
    keep: int
    machine: int = -1
    state: int = -1
    before: bool = False


@dataclass(frozen=True, slots=True)
class Carry:
    """Where a run has come, for one that goes on with other numbers.

    Parameters
    ----------
    number : array
    place : array of int
        As `engine.run.carried` has them.
    counted : float
        Whole periods behind it.
    """

    number: Vector
    place: NDArray[np.intc]
    counted: float


@dataclass(frozen=True, slots=True)
class Looks:
    """What is kept of values, in order.

    Parameters
    ----------
    plain : array of bool, shape (values,)
        Which of them were run; the others an ordinary run has more to say of.
    found : array of int, shape (values,)
        Samples.
    when : array, shape (values, keep + 1)
        When the samples were taken, s; behind the last one the end.
    out : array, shape (values, keep, outputs)
        Slots.
    stays : array of int, shape (values,)
        Modes: the one in which the first sample was taken, and those written from then on.
    since : array
        When these were entered, s, of all values.
    mode : array of int, shape (modes, machines)
    left : array, shape (values, numbers)
    left_place : array of int, shape (values, whole numbers)
    left_counted : array, shape (values,)
        Where each has come: `carry` of it.
    """

    plain: NDArray[np.bool_]
    found: NDArray[np.intc]
    when: Vector
    out: Vector
    stays: NDArray[np.intc]
    since: Vector
    mode: NDArray[np.intc]
    left: Vector
    left_place: NDArray[np.intc]
    left_counted: Vector

    def carry(self, k: int) -> Carry:
        """Return where a value has come, for one that goes on from it."""
        return Carry(self.left[k], self.left_place[k], float(self.left_counted[k]))


class NativeSections(NativeMembers):
    """Values of one model in one thread, looked at once a period or at events.

    Parameters
    ----------
    model, slots, stop
        As for `NativeMembers`.
    cut : Cut

    Raises
    ------
    MemoryError
    """

    def __init__(
        self, model: NativeModel, slots: NDArray[np.intc], cut: Cut, stop: ctypes.c_int
    ) -> None:
        super().__init__(model, slots, np.zeros(cut.keep + 1), stop)
        self._cut = cut
        self._library.hybond_sections_begin.argtypes = [ctypes.c_void_p, ctypes.POINTER(Sections)]
        self._library.hybond_sections_run.argtypes = [ctypes.c_void_p, ctypes.POINTER(Sections)]
        made = Sections()
        if self._library.hybond_sections_begin(self._handle, ctypes.byref(made)) == SPENT:
            raise MemoryError
        self._sizes = int(made.floats), int(made.ints)

    def looks(
        self, numbers: Vector, period: Vector, *, carries: bool, carry: Carry | None = None
    ) -> Looks:
        """Run values; `numbers` has a row for each, what parameters write in it.

        Fewer come back than were given if they were stopped, or if they carry on from each other
        and one of them is not plain.

        Parameters
        ----------
        period : array, shape (values,)
            s; of events, the longest time that a value may take.
        carries : bool
            Whether each goes on from the one before; the first one from `carry`.
        """
        many, c = len(numbers), self._cut
        status, found, stays = np.zeros((3, many), dtype=np.intc)
        when = np.full((many, c.keep + 1), np.nan)
        out = np.full((many, c.keep, len(self._slots)), np.nan)
        given = np.ascontiguousarray(numbers)
        periods = np.ascontiguousarray(period, dtype=np.float64)
        floats, ints = self._sizes
        number, place = np.zeros(floats + 1), np.zeros(ints + 1, dtype=np.intc)
        left, left_place = np.zeros((many, floats)), np.zeros((many, ints), dtype=np.intc)
        counted = np.zeros(many)
        s = Sections(many, given.shape[1], len(self._slots), c.settle, c.keep, c.machine, c.state)
        s.before, s.carry, s.floats, s.ints = c.before, carries, floats, ints
        if carry is not None:
            number[:floats], place[:ints] = carry.number, carry.place
            s.begun, s.counted = 1, carry.counted
        for name, column in (
            *(("number", given), ("place", self._places), ("slot", self._slots)),
            *(("period", periods), ("status", status), ("found", found), ("when", when)),
            *(("out", out), ("stays", stays), ("carried", number), ("carried_place", place)),
            *(("left", left), ("left_place", left_place), ("left_counted", counted)),
        ):
            setattr(s, name, address(column))
        s.stop = ctypes.addressof(self._stop)
        done = self._library.hybond_sections_run(self._handle, ctypes.byref(s))
        since = copied(s.since, np.float64, (s.rows,))
        mode = copied(s.mode, np.intc, (s.rows, self._record.machines))
        return Looks(
            *(status[:done] == OK, found[:done], when[:done], out[:done]),
            *(stays[:done], since, mode),
            *(left[:done], left_place[:done], counted[:done]),
        )
