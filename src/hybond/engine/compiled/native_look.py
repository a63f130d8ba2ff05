"""Values of a finished run, by the library: signals, powers and energies at points of its motion.

The log of a run has states and modes. All else follows from them, by the equations that the run
itself was made with: here they are asked.
"""

from __future__ import annotations

import ctypes
import functools
import threading
import weakref
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from hybond.engine.compiled.answering import Answering, Calls
from hybond.engine.compiled.native import OK, RAISED, SPENT, NativeModel, library
from hybond.engine.compiled.points import (
    Numbers,
    Points,
    PointsRecord,
    Steps,
    Vector,
    Within,
    address,
    floats,
    whole,
)
from hybond.errors import NumericsError

AT_ONCE = 4096
"""Points between two looks at the world outside: a call of the library cannot be interrupted."""


@functools.cache
def _looking() -> ctypes.CDLL:
    """Return the library with the functions used here declared."""
    found = library()
    handle, number = ctypes.c_void_p, ctypes.c_int
    points = ctypes.POINTER(PointsRecord)
    arguments: dict[str, list[Any]] = {
        "begin": [handle],
        "into": [
            *(handle, ctypes.c_double, handle, handle, number, handle),
            *(number, number, handle, ctypes.c_double),
        ],
        "modes": [handle, handle],
        "linear": [handle, ctypes.POINTER(number)],
        "values": [handle, points, number, handle, handle],
        "parts": [handle, points, number, handle, handle, handle],
        "powers": [handle, points, handle],
        "energies": [handle, points, handle, handle],
        "fault": [handle, ctypes.POINTER(ctypes.c_char_p), ctypes.POINTER(ctypes.c_double)],
        "end": [handle],
    }
    for name, types in arguments.items():
        getattr(found, f"hybond_look_{name}").argtypes = types
    found.hybond_look_begin.restype = ctypes.c_void_p
    for name in ("fault", "end"):
        getattr(found, f"hybond_look_{name}").restype = None
    return found


class NativeLook:
    """Looks into the motion of finished runs of a model: by one thread at a time.

    First `into` says what the motion is, from its mode to what it slides on; what is asked next
    lies there. It does not matter what was looked into before.

    Parameters
    ----------
    model : NativeModel

    Raises
    ------
    Unavailable
        If there is no library.
    MemoryError

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.engine.compiled.native import NativeRun
    >>> from hybond.engine.tables import tables_of
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(c=hb.C("1 F", e="2 V"), r=hb.R("1 ohm"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> model = NativeModel(tables_of(m.flatten(), until="1 s", rtol=1e-10))
    >>> (rows,) = NativeRun(model).slices(steps=-1)
    >>> look = NativeLook(model)
    >>> look.into(0.0, [], energy=2.0)
    >>> power = Within(Steps.of(rows), [0.0, 1.0])
    >>> look.powers(power).tolist()
    [[0.0, 4.0], [0.0, 0.541341133]]
    """

    def __init__(self, model: NativeModel) -> None:
        self.model = model
        self._library = _looking()
        handle = self._library.hybond_look_begin(ctypes.byref(model.record))
        if not handle:
            raise MemoryError
        self._handle = ctypes.c_void_p(handle)
        self._answering: Answering | None = None
        if model.tables.numbers["called"]:
            self._answering = Answering(Calls(model.tables, looking=True))
            question = ctypes.byref(self._answering.question)
            self._library.hybond_ask(self._handle, question, self._answering.callback)
        self._lock = threading.Lock()
        self._close = weakref.finalize(self, self._library.hybond_look_end, self._handle)
        self._parts = 0
        record = model.record
        self._states = record.storages + record.integrals
        first = np.array(model.tables.ints["state_first"])
        self._state_first = first[:-1]
        self._states_of = np.diff(first)
        self._contact_at = np.array(model.tables.ints["contact_at"], dtype=int)

    def into(
        self,
        t: float,
        state: ArrayLike,
        *,
        landed: ArrayLike = False,
        surfaces: Sequence[int] = (),
        product: bool = False,
        modes: ArrayLike | None = None,
        energy: float = 0.0,
    ) -> None:
        """Look into a motion.

        Parameters
        ----------
        t : float
            When it begins, s: inputs and comparisons of time are those of the interval that begins
            then or that contains it.
        state : array of int, shape (machines,)
            The state of each machine.
        landed : bool or array of bool, shape (machines,)
            Which of them have landed.
        surfaces : sequence of int
            The switching surfaces that are slid on, by their number in the tables.
        product : bool
            Whether all corners of the cube of their weights are combined.
        modes : array of int, shape (parts, machines), optional
            The states of machines in the modes that are combined: of them the branches of junction
            laws are taken, which are those of `state` if it is not given.
        energy : float
            The largest energy that the run has seen, J: what rounding is measured by.

        Raises
        ------
        ValueError
            For a time outside the run, or a machine, state or surface that there is not.
        NumericsError
            If the motion cannot be looked into.
        MemoryError
        """
        m = self.model.record
        if not 0.0 <= t <= m.until:
            raise ValueError(f"a run from 0 to {m.until} s does not have {t} s")
        if not 0.0 <= energy < np.inf:
            raise ValueError(f"energy = {energy}")
        mode = whole(state, "state")
        if mode.shape != (m.machines,):
            raise ValueError(f"the states of {m.machines} machines, not shape {mode.shape}")
        if not ((mode >= 0) & (mode < self._states_of)).all():
            raise ValueError("a machine does not have that state")
        on = np.ascontiguousarray(
            np.broadcast_to(np.asarray(landed, dtype=bool), mode.shape), dtype=np.intc
        )
        if (self._contact_at[(self._state_first + mode)[on != 0]] < 0).any():
            raise ValueError("a machine has landed in a state that closes no contact")
        found = whole(surfaces, "surfaces")
        if len(set(found.tolist())) != len(found):
            raise ValueError("surfaces: each once")
        if not ((found >= 0) & (found < m.surfaces)).all():
            raise ValueError("a surface that there is not")
        rows = np.zeros((0, m.machines), dtype=np.intc)
        if modes is not None:
            rows = np.ascontiguousarray(modes, dtype=np.intc)
            if rows.ndim != 2 or rows.shape[1] != m.machines:
                raise ValueError(f"modes of {m.machines} machines, not shape {rows.shape}")
            if not ((rows >= 0) & (rows < self._states_of)).all():
                raise ValueError("a machine does not have that state")
        with self._lock:
            self._parts = 0
            self._check(
                self._library.hybond_look_into(
                    *(self._handle, t, address(mode), address(on), len(found), address(found)),
                    *(int(product), len(rows), address(rows), energy),
                )
            )
            self._parts = self._library.hybond_look_modes(self._handle, None)

    def modes(self) -> Numbers:
        """Return the states of machines in each mode that is combined, shape (parts, machines).

        Where nothing is slid on there is one.
        """
        self._ready()
        found = np.zeros((self._parts, self.model.record.machines), dtype=np.intc)
        with self._lock:
            self._library.hybond_look_modes(self._handle, address(found))
        return found

    def why_not_linear(self) -> int:
        """Return why the mode is not linear: a reason by its number; -1: it is; -2: no motion.

        The tables are those for solver ``"exact"``.

        Raises
        ------
        NumericsError, MemoryError
        """
        self._ready()
        why = ctypes.c_int()
        with self._lock:
            self._check(self._library.hybond_look_linear(self._handle, ctypes.byref(why)))
        return why.value

    def values(self, points: Points | Within, slots: ArrayLike) -> Vector:
        """Return values at points, shape (points, slots).

        Parameters
        ----------
        points : Points or Within
        slots : array of int
            Which: slots of the vector of values, those of stored quantities and integrated signals
            with the state put back on its constraints; a second copy follows, a priori values.
            While machines slide it is the average of bond variables.

        Raises
        ------
        ValueError
            For points of another model, or a slot that there is not.
        NumericsError
            If a law has no value at one of the points.
        MemoryError
        """
        chosen = self._slots(slots)
        out = np.zeros((len(points.t), len(chosen)))
        for some, begin, end in self._chunks(points):
            with self._lock:
                place = address(out[begin:end])
                self._check(
                    self._library.hybond_look_values(
                        self._handle, some, len(chosen), address(chosen), place
                    )
                )
        return out

    def parts(self, points: Points | Within, slots: ArrayLike) -> tuple[Vector, Vector]:
        """Return the share of each mode that is combined, and values in that mode.

        Parameters
        ----------
        points : Points or Within
        slots : array of int
            As for `values`.

        Returns
        -------
        shares : array, shape (points, parts)
            They add up to one.
        values : array, shape (points, parts, slots)

        Raises
        ------
        ValueError, NumericsError, MemoryError
            As `values`.
        """
        chosen = self._slots(slots)
        shares = np.zeros((len(points.t), self._parts))
        out = np.zeros((len(points.t), self._parts, len(chosen)))
        for some, begin, end in self._chunks(points):
            with self._lock:
                places = address(shares[begin:end]), address(out[begin:end])
                self._check(
                    self._library.hybond_look_parts(
                        self._handle, some, len(chosen), address(chosen), *places
                    )
                )
        return shares, out

    def powers(self, points: Points | Within) -> Vector:
        """Return power supplied by sources and dissipated by resistors, W, shape (points, 2).

        Bonds on which effort times flow is no power are left out.

        Raises
        ------
        ValueError, NumericsError, MemoryError
            As `values`.
        """
        out = np.zeros((len(points.t), 2))
        for some, begin, end in self._chunks(points):
            with self._lock:
                place = address(out[begin:end])
                self._check(self._library.hybond_look_powers(self._handle, some, place))
        return out

    def energies(
        self, steps: Steps, begin: ArrayLike | None = None, end: ArrayLike | None = None
    ) -> Vector:
        """Return energies between pairs of instants, each pair in one step, J, shape (pairs, 3).

        Energy supplied, energy dissipated, and an estimate of the error of either: below a part of
        1e-11 of all that passes but where the powers jump or have many kinks within a step.

        Parameters
        ----------
        steps : Steps
        begin, end : array, shape (pairs,), optional
            s; from the begin of each step to where it was ended if they are not given.

        Raises
        ------
        ValueError
            For instants that are not in one step, or an end before its begin, or another model.
        NumericsError, MemoryError
            As `values`.
        """
        first = steps.time[:, 0] if begin is None else floats(begin, 1, "begin")
        last = floats(steps.time[:, 2] if end is None else end, 1, "end")
        if first.shape != last.shape or (last < first).any():
            raise ValueError("each interval has an end behind its begin")
        points = Within(steps, first, Within(steps, last).step)
        out = np.zeros((len(first), 3))
        for some, low, high in self._chunks(points):
            with self._lock:
                places = address(last[low:high]), address(out[low:high])
                self._check(self._library.hybond_look_energies(self._handle, some, *places))
        return out

    def _chunks(self, points: Points | Within) -> Iterator[tuple[Any, int, int]]:
        self._ready()
        if points.states != self._states:
            raise ValueError(f"points with {points.states} states, the model has {self._states}")
        for begin in range(0, len(points.t), AT_ONCE):
            end = min(begin + AT_ONCE, len(points.t))
            yield ctypes.byref(points.record(begin, end)), begin, end

    def _ready(self) -> None:
        if not self._parts:
            raise ValueError("nothing is looked into yet")

    def _slots(self, slots: ArrayLike) -> Numbers:
        found = whole(slots, "slots")
        if not ((found >= 0) & (found < 2 * self.model.record.slots)).all():
            raise ValueError(f"slots from 0 to {2 * self.model.record.slots - 1}")
        return found

    def _check(self, status: int) -> None:
        if status == OK:
            return
        if status == SPENT:
            self._parts = 0
            raise MemoryError
        if status == RAISED and self._answering is not None:
            raise self._answering.taken()
        texts, t = (ctypes.c_char_p * 3)(), ctypes.c_double()
        self._library.hybond_look_fault(self._handle, texts, ctypes.byref(t))
        code, why, place = ((text or b"").decode() for text in texts)
        raise NumericsError(f"{why}, at t = {t.value:.9g} s", code=code, where=place)
