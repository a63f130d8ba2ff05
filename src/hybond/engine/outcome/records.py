"""The records of a run, made of the rows that the library wrote: segments and events.

Each is made when somebody asks for it. What a run is told of at once, accumulations, slidings and
what its modes leave open, is noted as the rows come in.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.rows import MACHINES_OF_INSTANT, MACHINES_OF_STEP, Rows
from hybond.engine.outcome.beginnings import Beginning
from hybond.engine.outcome.combinations import (
    ALONE,
    Combination,
    Kind,
    combinations,
    corners_of,
    flipped,
)
from hybond.engine.outcome.explain import LANDS, Explaining
from hybond.engine.outcome.logged_steps import Block, Interpolants, Points, Steps, begin_later
from hybond.engine.outcome.warned import Warnings
from hybond.engine.tables import ModelTables
from hybond.engine.tables.start import start_of
from hybond.model.graph import Mode
from hybond.runs.trace import Accumulation, Cause, Event, Segment, Sliding, Trace, Turn

Vector = NDArray[np.float64]

CAUSES: dict[int, Cause] = {
    0: "start",
    1: "guard",
    2: "time",
    3: "input",
    4: "accumulation",
    5: "step",
    6: "sample",
    7: "change",
    8: "until",
    10: "law",
}
BROKEN = 16
"""What the cause of an instant is more than it was, if it could not be settled."""


class Instants:
    """The instants of a slice, with where the rows behind each of them begin.

    Parameters
    ----------
    mode : Mode
        In which time was before the first.
    """

    def __init__(self, rows: Rows, mode: Mode) -> None:
        self.rows = rows
        self.mode = mode
        self.visit = _first(rows.instant_place[:, 1])
        self.fired = _first(rows.visit[:, 1])
        self.hit = _first(rows.visit[:, 2])
        self.open = _first(rows.visit[:, 3])
        self.read = _first(rows.fired[:, 4])
        self.over = _first(rows.fired[:, 5])
        machines = (rows.instant_place.shape[1] - MACHINES_OF_INSTANT) // 2
        self.states = rows.instant_place[:, MACHINES_OF_INSTANT : MACHINES_OF_INSTANT + machines]
        self.landed = rows.instant_place[:, MACHINES_OF_INSTANT + machines :]

    def before(self, k: int) -> Mode:
        """Return the mode before instant k."""
        return tuple(self.states[k - 1].tolist()) if k else self.mode


class Records:
    """Turns the rows of one run into its trace."""

    def __init__(
        self,
        tables: ModelTables,
        trace: Trace,
        begin: Beginning | None = None,
        explain: Explaining | None = None,
    ) -> None:
        self.graph = tables.graph
        ends = self.graph.ends
        self.many = ends if ends >= 0 else len(self.graph.machines)
        """Machines that are shown: not the one that is there to end the run."""
        self.begin = begin
        self.trace = trace
        self.explain = Explaining(tables) if explain is None else explain
        self.warnings = Warnings(self.graph, self.explain, tables.ints["element_node"])
        self.trace.unsound = self.warnings.unsound
        self.trace.roots = self.warnings.roots
        self._open: list[frozenset[str]] = []
        self.broken: tuple[Instants, int] | None = None
        """An instant that could not be settled."""
        self.mode: Mode = self.graph.start_mode
        self.t = 0.0 if begin is None else begin.t
        self.steps = 0
        self.in_steps = False  # whether these are the records of time-stepping
        self.unbalanced = 0.0
        """Energy that came from nowhere in its steps, J."""
        self._passed = np.zeros(2)
        self._waiting: list[Steps] = []
        """Those of the segment that is not over."""
        self._combinations: list[tuple[Combination, int | None]] = [(ALONE, None)]
        """Each with the number of its sliding in the trace."""

    def add(self, rows: Rows) -> Instants | None:
        """Add the rows of a slice; return its instants, if there are any."""
        for t, combination in combinations(rows, len(self.graph.machines)):
            self._note_slide(t, combination.of(self.many))
        found = None
        if len(rows.instant_time):
            # rows of instants are kept as long as one of them may be asked for
            found = Instants(replace(rows, step_state=rows.step_state[:0]), self.mode)
            self._add_instants(found)
        for text in self.warnings.texts(rows):
            self.trace.warn(text)
        for t in rows.turn_time.tolist():
            back = len(self.trace.turns) % 2 == 1
            self.trace.turns.append(Turn(t, "rk45" if back else "radau"))
        if len(rows.step_time):
            self.t = float(rows.step_time[-1, 2])
            self.steps += len(rows.step_time)
            points = None
            if len(rows.step_bond):
                points = self._points(rows)
            new = Steps(
                rows.step_time,
                rows.step_until,
                rows.step_state,
                rows.step_dense,
                self._places(rows.step_place),
                points,
            )
            if self.begin is not None and float(new.time[0, 0]) < self.begin.t:
                new = begin_later(new, self.begin.t)
            self._add_steps(new)
        return found

    def close(self) -> None:
        """Note that the run is over."""
        if self._waiting:
            waiting, self._waiting = Steps.joined(self._waiting), []
            self._note_segments(waiting, np.array([0, len(waiting.time)]))
        self._slide_until(self.t)

    @contextmanager
    def so_far(self) -> Iterator[None]:
        """Have the segment that is not over among the others, for a look at the run meanwhile."""
        over = len(self.trace.segments)
        if self._waiting:
            waiting = Steps.joined(self._waiting)
            self._note_segments(waiting, np.array([0, len(waiting.time)]))
        try:
            yield
        finally:
            self.trace.segments.cut(over)

    # -- motion

    def _places(self, place: NDArray[np.intc]) -> NDArray[np.intc]:
        """Return places of steps, of the machines that are shown."""
        if self.graph.ends < 0:
            return place
        last = MACHINES_OF_STEP + self.graph.ends
        return np.ascontiguousarray(np.delete(place, [last, place.shape[1] - 1], axis=1))

    def _points(self, rows: Rows) -> Points:
        """Return what time-stepping tells besides; energies are those from the beginning on."""
        self.in_steps = True
        self.unbalanced += float(np.maximum(rows.step_energy[:, 2], 0.0).sum())
        # one by one from what was: where a slice ends decides no last digit
        passed = np.cumsum(np.vstack([self._passed, rows.step_energy[:, :2]]), axis=0)
        self._passed = passed[-1]
        return Points(rows.step_bonds, rows.step_bond, np.hstack([passed[:-1], passed[1:]]))

    def _add_steps(self, new: Steps) -> None:
        """Note the segments that are over; what belongs to the next one waits."""
        key = _key(new)
        changes = np.flatnonzero((key[1:] != key[:-1]).any(axis=1)) + 1
        if self._waiting:
            goes_on = bool((key[0] == _key(self._waiting[-1])[-1]).all())
            if goes_on and not len(changes):
                self._waiting.append(new)
                return
            # only what the segment has in this slice is copied to its rest
            head = int(changes[0]) if goes_on else 0
            waiting = [*self._waiting, new.part(0, head)] if head else self._waiting
            over = Steps.joined(waiting)
            self._note_segments(over, np.array([0, len(over.time)]))
            new = new.part(head, len(new.time))
            changes = (changes[1:] if goes_on else changes) - head
        begins = np.concatenate(([0], changes))
        self._note_segments(new, begins)
        at = int(begins[-1])
        self._waiting = [new.part(at, len(new.time))]

    def _note_segments(self, steps: Steps, begins: NDArray[np.intp]) -> None:
        """Note segments; each begins at a step, and ends where the next one does."""
        times = steps.time[begins[:-1], 0].tolist()
        if not times:
            return
        which = steps.place[begins[:-1], 1]

        def make(k: int) -> Segment:
            begin, end = int(begins[k]), int(begins[k + 1])
            return self._segment(steps, begin, end, self._combinations[which[k]])

        alone = np.array([sliding is None for _, sliding in self._combinations])[which]
        alone &= steps.points is None
        self.trace.segments.extend(times, Block(steps, begins, alone, make))

    def _segment(
        self, steps: Steps, first: int, last: int, which: tuple[Combination, int | None]
    ) -> Segment:
        machines = self.many
        place = steps.place[first, MACHINES_OF_STEP:].tolist()
        shown = self.graph.machines[:machines]
        landed = tuple(m.path for m, k in zip(shown, place[machines:], strict=True) if k)
        t0 = float(steps.time[first, 0])
        if steps.points is not None:
            return self._stepped(steps, first, last, tuple(place[:machines]))
        return Segment(
            tuple(place[:machines]),
            np.concatenate([[t0], steps.time[first:last, 2]]),
            np.vstack([steps.state[first : first + 1, 0], steps.state[first:last, 2]]),
            Interpolants(steps, first, last),
            landed,
            which[1],
            None if which[1] is None else which[0],
        )

    def _stepped(self, steps: Steps, first: int, last: int, mode: Mode) -> Segment:
        """Return a segment of time-stepping, which has the bond variables of its points."""
        assert steps.points is not None
        points = steps.points.part(first, last)
        t0 = float(steps.time[first, 0])
        state = np.vstack([steps.state[first : first + 1, 0], steps.state[first:last, 2]])
        passed = np.vstack([points.energy[:1, :2], points.energy[:, 2:]])
        return Segment(
            mode,
            np.concatenate([[t0], steps.time[first:last, 2]]),
            np.hstack([state, passed]),
            Interpolants(steps, first, last),
            bonds=points.bonds[[0, *points.at.tolist()]],
        )

    # -- events

    def _add_instants(self, found: Instants) -> None:
        rows = found.rows
        causes = rows.instant_place[:, 0]
        many = len(causes)
        if causes[-1] >= BROKEN:
            many -= 1
            self.broken = (found, many)
        times = rows.instant_time[:many, 0].tolist()
        calm = np.diff(found.hit[found.visit]) == 0
        self.trace.events.extend(times, lambda k: self._event(found, k), plain=calm[:many].tolist())
        for f in np.flatnonzero(rows.fired[:, 3] == LANDS).tolist():
            self._note_landing(found, f)
        if len(rows.open):
            self._note_open(found, many)
        if many:
            self.mode = tuple(found.states[many - 1].tolist())
            self.trace.energy = max(self.trace.energy, float(rows.instant_time[many - 1, 1]))
            self.t = times[-1]
        for text in self.warnings.of_created(found, many, self.trace.energy):
            self.trace.warn(text)
        for text in self.warnings.of_unwritten(found, many):
            self.trace.warn(text)

    def _event(self, found: Instants, k: int) -> Event:
        """Return one event."""
        rows = found.rows
        t = float(rows.instant_time[k, 0])
        before, after = rows.instant_state[k]
        cause: Cause = CAUSES[int(rows.instant_place[k, 0])]
        if cause == "start":
            # the row begins with what was settled
            before = np.array(start_of(self.graph) if self.begin is None else self.begin.state)
        steps = self.explain.steps(found, k)
        ends = self.graph.ends
        if ends >= 0:
            steps = tuple(replace(step, mode=step.mode[:ends]) for step in steps)
            cause = "until" if found.states[k][ends] != 0 else cause
        return Event(
            t,
            cause,
            steps,
            before,
            after,
            tuple(
                m.path
                for m, at in zip(self.graph.machines, found.landed[k].tolist(), strict=True)
                if at
            ),
            None if rows.instant_since[k] < 0.0 else float(rows.instant_since[k]),
        )

    def _note_landing(self, found: Instants, f: int) -> None:
        rows = found.rows
        count, t, ratio = rows.read[found.read[f] : found.read[f] + 3, 0].tolist()
        machine = self.graph.machines[int(rows.fired[f, 0])]
        self.trace.accumulations.append(
            Accumulation(
                t,
                None if math.isnan(ratio) else ratio,
                int(count),
                machine.path,
                landed=True,
                state=machine.states[int(rows.fired[f, 2])],
            )
        )

    def _note_slide(self, t: float, new: Combination) -> None:
        """Note what is slid in from a time on."""
        last, number = self._combinations[-1]
        if not new.is_like(last):
            self._slide_until(t)
            number = None
            if new.surfaces:
                number = len(self.trace.slidings)
                surfaces = [self.explain.surfaces[j] for j in new.surfaces]
                kind: Kind = "product" if new.product else "additive"
                corners = corners_of(len(surfaces), kind)
                self.trace.slidings.append(
                    Sliding(
                        t,
                        t,
                        tuple(self.graph.machines[s.machine].path for s in surfaces),
                        tuple(s.text for s in surfaces),
                        tuple(flipped(new.mode, surfaces, c) for c in corners),
                        kind,
                    )
                )
        self._combinations.append((new, number))

    def _slide_until(self, t: float) -> None:
        number = self._combinations[-1][1]
        if number is not None:
            self.trace.slidings[number] = replace(self.trace.slidings[number], t1=t)

    def _note_open(self, found: Instants, many: int) -> None:
        """Warn of what the modes leave open in which time goes on: of the same names once."""
        for k in range(many):
            last = int(found.visit[k + 1]) - 1
            names = self.explain.open(found, last)
            if names and not any(told.issuperset(names) for told in self._open):
                self._open.append(frozenset(names))
                mode: Mode = tuple(found.states[k].tolist())
                stored = self.explain.stored_open(found, last)
                moved = f", and by that how {', '.join(stored)} moves" if stored else ""
                self.trace.warn(
                    f"in mode ({self.graph.mode_text(mode)}) the equations leave "
                    f"{', '.join(names)} open; least leakage decides{moved}"
                )


def _first(counts: NDArray[np.intc]) -> NDArray[np.intp]:
    """Return where the rows of each begin that has so many, and where the last ends."""
    found = np.zeros(len(counts) + 1, dtype=np.intp)
    np.cumsum(counts, out=found[1:])
    return found


def _key(steps: Steps) -> Vector:
    """Return what steps of one segment have in common: instants, what is slid in, until when."""
    return np.column_stack([steps.place[:, :2], steps.until])
