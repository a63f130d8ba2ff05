"""Passages: whole segments with the instants between them, in the kernel (`c/run.c`)."""

from __future__ import annotations

import contextlib
import ctypes
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from hybond.equations.mode import ModeEquations
from hybond.errors import HybondError
from hybond.kernel.structs import Atlas, Filled, Log, Schedule
from hybond.model.graph import FlatGraph, Mode
from hybond.model.inputs import line
from hybond.model.interval import Interval, interval_after
from hybond.modes.landing import accumulation, landing
from hybond.modes.marching import Course
from hybond.modes.sliding import crossings, motion
from hybond.programs.program import Program

Vector = NDArray[np.float64]
KEPT = 256
"""Modes that are kept ready."""
AHEAD = 256
"""Intervals between timed events that are looked ahead."""
ROWS = 512
"""Segments of one passage."""
WRITES = 32
"""State writes of one instant that the kernel follows."""
MOMENT = 1000.0
"""Events are left to the reference if what separates them is less than this many times what counts
as one moment for a machine that chatters."""


class Modes:
    """The modes of a graph that the kernel knows, and what they share.

    Parameters
    ----------
    make : callable
        Makes a mode ready; None if the kernel was not made for it.
    """

    def __init__(
        self,
        program: Program,
        course: Course,
        make: Callable[[Mode, Interval, float], Filled | None],
        *,
        rounded: float,
    ) -> None:
        self.program = program
        self._make = make
        self._course = course
        self._place: dict[Mode, int] = {}
        self._ready: list[tuple[Mode, Filled | None]] = []
        self._newton: list[tuple[ModeEquations, Filled]] = []
        self._contacts = course.landings.contacts()
        self.atlas = Filled(Atlas())
        self._share()
        self.atlas.structure.rounded = rounded

    def place(self, mode: Mode, interval: Interval, t: float) -> int | None:
        """Return where a mode stands, None if it is not for the kernel."""
        k = self._place.get(mode)
        if k is None:
            if len(self._ready) == KEPT:
                self._place.clear()
                self._ready.clear()
                self._newton.clear()
            k = self._place[mode] = len(self._ready)
            found: Filled | None = None
            with contextlib.suppress(HybondError):
                # the reference says why, if it ever gets there
                found = self._make(mode, interval, t)
            if found is not None and found.structure.free:
                self._newton.append((self.program.equations(mode, interval, t), found))
            self._ready.append((mode, found))
            address = 0 if found is None else ctypes.addressof(found.structure)
            self.atlas.arrays["mode"][k] = address
            self.atlas.structure.modes = len(self._ready)
        return None if self._ready[k][1] is None else k

    def knows(self, mode: Mode) -> bool:
        """Whether a mode has been looked at."""
        return mode in self._place

    def mode(self, k: int) -> Mode:
        """Return the mode that stands at a place."""
        return self._ready[k][0]

    def hand_back(self) -> None:
        """Let the reference know where Newton ended in each mode, as it goes on from there."""
        for equations, filled in self._newton:
            equations.guess = filled.arrays["guess"].copy()

    def look(self) -> None:
        """Read what landings know of the impacts so far, and where Newton ended in each mode."""
        for equations, filled in self._newton:
            filled.arrays["guess"][:] = 0.0 if equations.guess is None else equations.guess
        landings, arrays = self._course.landings, self.atlas.arrays
        for m in self.program.graph.machines:
            arrays["since"][m.index], arrays["speed"][m.index] = landings.flown(m.index)
        for k, contact in enumerate(self._contacts):
            arrays["ready"][k] = landings.known(contact)

    def _share(self) -> None:
        program, course, atlas = self.program, self._course, self.atlas
        graph, a = program.graph, atlas.structure
        slots = program.slots
        a.machines, a.storages, a.signals = len(graph.machines), program.nx, program.ns
        a.states = max((len(m.states) for m in graph.machines), default=1)
        a.inputs, a.slots, a.bonds = len(graph.inputs), slots.size, slots.w.stop - slots.w.start
        a.ats, a.at_slot = len(graph.watches), slots.at.start
        a.most_writes = min(WRITES, course.settler.max_writes)
        a.until, a.event_tol = course.until, course.event_tol
        a.remaining, a.soonest = accumulation.REMAINING, accumulation.SOONEST
        a.moment = MOMENT * accumulation.CHATTERING
        a.slow, a.lively, a.fading = landing.SLOW, landing.LIVELY, landing.FADING
        atlas.put("mode", np.zeros(KEPT, dtype=np.uintp))
        classes = _classes(graph)
        a.classes = len(set(classes[0] + classes[1]))
        atlas.put("bond_class", classes[0])
        atlas.put("storage_class", classes[1])
        half = len(graph.bonds)
        at = [s.bond if s.kind == "C" else half + s.bond for s in graph.storages]
        atlas.put("store_slot", [slots.w.start + k for k in at])
        atlas.put("store_sign", [1.0 if s.kind == "C" else s.sign for s in graph.storages])
        storage = program.storage
        real = ~storage.pseudo
        for group in storage.groups:
            # as `StorageLaws.energy` has it
            real[list(group)] = not storage.pseudo[list(group)].any()
        atlas.put("real", real)
        of = np.full((a.machines, a.states), -1)
        rests = np.zeros((len(self._contacts), a.states))
        for k, contact in enumerate(self._contacts):
            machine = contact.machine
            of[machine.index, contact.state] = k
            rests[k, : len(machine.on)] = [on >= machine.on[contact.rest] for on in machine.on]
        atlas.put("contact_of", of)
        atlas.put("rests_in", rests)
        atlas.put("ready", np.zeros(len(self._contacts)))
        surfaces = course.surfaces
        a.surfaces, a.at_once, a.vanished = len(surfaces), motion.AT_ONCE, crossings.VANISHED
        atlas.put("surface_machine", [s.machine for s in surfaces])
        atlas.put("below", [s.below for s in surfaces])
        atlas.put("above", [s.above for s in surfaces])
        atlas.put("since", np.zeros(a.machines))
        atlas.put("speed", np.zeros(a.machines))
        atlas.check()


def _classes(graph: FlatGraph) -> tuple[list[int], list[int]]:
    """Return which impulses of bonds and stored quantities are compared with each other."""
    number: dict[tuple[str, int], int] = {}

    def of(bond: int, kind: int) -> int:
        return number.setdefault((graph.bonds[bond].domain.name, kind), len(number))

    bonds = range(len(graph.bonds))
    return [of(b, kind) for kind in (0, 1) for b in bonds], [
        of(s.bond, 0 if s.kind == "I" else 1) for s in graph.storages
    ]


class Ahead:
    """The intervals between timed events from some time on."""

    def __init__(self, graph: FlatGraph, until: float) -> None:
        self.graph = graph
        self.until = until
        self.intervals: list[Interval] = []
        self._rows: list[list[tuple[float, float, float]]] = []
        self.schedule = Filled(Schedule())

    def look(self, t: float, interval: Interval) -> list[Interval]:
        """Fill the schedule from `t`, which lies in an interval; return the intervals."""
        gone = next((k for k, i in enumerate(self.intervals) if i.end == interval.end), None)
        known = [] if gone is None else self.intervals[gone + 1 :]
        rows = [] if gone is None else self._rows[gone + 1 :]
        self.intervals, self._rows = [interval, *known], [self._row(t, interval), *rows]
        while (end := self.intervals[-1].end) < self.until and len(self.intervals) < AHEAD:
            if any(s.due(end) for s in self.graph.samples):
                break  # the reference samples
            following = interval_after(self.graph, end)
            self.intervals.append(following)
            self._rows.append(self._row(end, following))
        filled = self.schedule
        filled.structure.count = len(self.intervals)
        filled.put("end", [i.end for i in self.intervals])
        filled.put("at", [i.at for i in self.intervals])
        lines = np.array(self._rows).reshape(len(self._rows), len(self.graph.inputs), 3)
        for k, name in enumerate(("time", "input", "rate")):
            filled.put(name, lines[:, :, k])
        return self.intervals

    def _row(self, t: float, interval: Interval) -> list[tuple[float, float, float]]:
        pairs = zip(self.graph.inputs, interval.pieces, strict=True)
        return [line(i.waveform, t, p) for i, p in pairs]


def log_for(rows: int, stored: int, machines: int) -> Filled:
    """Return an empty log."""
    log = Filled(Log())
    for name in ("t", "energy"):
        log.put(name, np.zeros(rows))
    log.put("before", np.zeros((rows, stored)))
    log.put("after", np.zeros((rows, stored + 2)))
    log.put("approach", np.zeros((rows, machines)))
    for name in ("steps", "mode", "interval", "timed", "changed", "struck"):
        log.put(name, np.zeros(rows))
    log.put("fired", np.zeros((rows, machines)))
    log.put("wanted", np.zeros(machines))
    log.check()
    return log


def mode_of(wanted: NDArray[np.int32]) -> Mode:
    """Return a mode from what the kernel wrote."""
    return tuple(wanted.tolist())
