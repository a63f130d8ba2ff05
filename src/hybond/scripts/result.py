"""The run of a script as a result: the runs of its steps, one after the other."""

from __future__ import annotations

import bisect
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from hybond.engine.outcome.audit import Audit
from hybond.engine.outcome.signals import Signals
from hybond.errors import HybondError
from hybond.measures.naming import read_name
from hybond.model.expressions import Expr
from hybond.model.graph import FlatGraph
from hybond.model.parts import Value
from hybond.options import seconds_of
from hybond.records import dataclass
from hybond.result import Result, Status
from hybond.runs.states import State
from hybond.runs.trace import Event, Segment, Trace, Visit

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Done:
    """A step that was done.

    Parameters
    ----------
    label : str
    t0, t1 : float
        s.
    ended_by : str
        A condition as written, ``"time"``, or the status of a run that stopped.
    set : mapping
        What was set at its beginning.
    """

    label: str
    t0: float
    t1: float
    ended_by: str
    set: Mapping[str, Value]


@dataclass(frozen=True, slots=True)
class Part:
    """The run of one step: its model, what it wrote down."""

    graph: FlatGraph
    trace: Trace
    signals: Signals


class ScriptResult(Result):
    """The run of a script: one `Result`, in which every step has the parameters it had.

    Attributes
    ----------
    steps : tuple of Done
    marks : tuple of (float, str)
        When steps begin, s, and their labels.
    """

    def __init__(
        self,
        graph: FlatGraph,
        parts: Sequence[Part],
        done: Sequence[Done],
        status: Status,
        until: float,
        solver: str,
        error: HybondError | None,
    ) -> None:
        self.parts = tuple(parts)
        self.steps = tuple(done)
        super().__init__(graph, joined(parts, done), status, until, solver, error)
        self.marks = tuple((d.t0, d.label) for d in done if d.label)
        self._first = np.cumsum([0, *(len(p.trace.segments) for p in parts)])
        self._read: dict[tuple[int, str], Expr] = {}

    @cached_property
    def signals(self) -> Signals:
        """What tells the signals of the last step."""
        return self.parts[-1].signals

    def part_of(self, segment: int) -> int:
        """Return in which step a segment lies, by their numbers."""
        return int(bisect.bisect_right(self._first.tolist(), segment)) - 1

    def signals_of(self, number: int) -> Signals:
        """Return what tells the signals of a segment: those of its step."""
        return self.parts[self.part_of(number)].signals

    def expression_of(self, number: int, name: str) -> Expr:
        """Return an expression of names with the parameters of the step that a segment is of."""
        return self._expression_in(self.part_of(number), name)

    def changes(self) -> list[tuple[float, Signals, Signals, Vector]]:
        """Return when steps begin that set something, with the state that they found."""
        found = []
        for k, (last, part, step) in enumerate(
            zip(self.parts, self.parts[1:], self.steps[1:], strict=False)
        ):
            if step.set and last.trace.carried is not None:
                n = len(part.graph.storages) + len(part.graph.integrals)
                state = np.array(last.trace.carried[0][1 : 1 + n], dtype=float)
                found.append((part.trace.begin, last.signals, self.parts[k + 1].signals, state))
        return found

    def _of(
        self, names: Iterable[str | Expr], which: Sequence[int] | NDArray[np.intp], t: Vector
    ) -> list[Vector]:
        asked = list(names)
        segments = np.asarray(which, dtype=np.intp)
        found = [np.zeros(len(t)) for _ in asked]
        for k, part in enumerate(self.parts):
            first, beyond = self._first[k], self._first[k + 1]
            places = np.flatnonzero((segments >= first) & (segments < beyond))
            if not len(places):
                continue
            read = part.signals.of_points(
                part.trace.segments,
                segments[places] - first,
                t[places],
                [self._expression_in(k, n) if isinstance(n, str) else n for n in asked],
            )
            for row, values in zip(found, read, strict=True):
                row[places] = values
        return found

    def _expression_in(self, k: int, name: str | Expr) -> Expr:
        if not isinstance(name, str):
            return name  # canonical names are the same in all steps
        if (k, name) not in self._read:
            self._read[k, name] = read_name(self.parts[k].graph, name)
        return self._read[k, name]

    def _after_last_event(self, names: Sequence[str | Expr]) -> list[float]:
        event = self.trace.events[-1]
        last = len(self.parts) - 1
        expressions = [self._expression_in(last, n) for n in names]
        found = self.signals.after(event.t, event.after, event.steps[-1].mode, expressions)
        return [float(value) for value in found]

    def weight(
        self, machine: str, state: str, t: float, *, side: Literal["left", "right"] = "right"
    ) -> float:
        """Return the part of the time that a machine spends in a state at `t`."""
        self.sample([t], [], side=side)
        return self._alone(self.part_of(self._segment_at(t, side))).weight(
            machine, state, t, side=side
        )

    def energies(self, segment: Segment) -> Vector:
        """Return energy supplied and dissipated within a segment, as `Result.energies`."""
        times = self.trace.segments.times
        at = bisect.bisect_right(times, float(segment.t[0])) - 1
        k = self.part_of(at)
        part = self.parts[k]
        return part.signals.energies(part.trace.segments[at - int(self._first[k])])

    def at_one_model(self, t: float) -> Result:
        """Return the step in which a time lies, as a run of its own."""
        return self._alone(self.part_of(self._segment_at(t, "right")))

    def audit(self) -> Audit:
        """Return the worst imbalance of power and energy over all steps."""
        found = [self._alone(k).audit() for k, p in enumerate(self.parts) if p.trace.segments]
        if not found:
            return Audit(0.0, 0.0, 0.0, beyond=0.0)
        return Audit(
            max(a.power for a in found),
            max(a.energy for a in found),
            max(a.created for a in found),
            max(a.accuracy for a in found),
            tuple(law for a in found for law in a.laws),
            max(a.beyond for a in found),
            max(a.rtol for a in found),
        )

    def state(self, t: float | str | None = None) -> State:
        """Return the state at a time, or at the end, as `Result.state`."""
        asked = seconds_of(t, "t")
        if asked is None or not self.parts:
            return self._alone(len(self.parts) - 1).state()
        begins = [p.trace.begin for p in self.parts]
        return self._alone(max(bisect.bisect_right(begins, asked) - 1, 0)).state(asked)

    def _alone(self, k: int) -> Result:
        part = self.parts[k]
        return Result(part.graph, part.trace, self.status, self.until, self.solver, None)


def joined(parts: Sequence[Part], done: Sequence[Done]) -> Trace:
    """Return what the runs of all steps wrote down, as one; labels stand at their events."""
    whole = Trace()
    whole.begin = parts[0].trace.begin if parts else 0.0
    for k, (part, step) in enumerate(zip(parts, done, strict=True)):
        own = part.trace
        before = len(whole.slidings)
        whole.segments.extend(own.segments.times, _moved(own, before))
        events = list(own.events)
        if k == 0 and events and step.label:
            events[0] = replace(events[0], label=step.label)
        elif k:
            if not events or events[0].cause != "change" or events[0].t != step.t0:
                events.insert(0, _begin(part, parts[k - 1]))
            events[0] = replace(events[0], label=step.label)
        for event in events:
            whole.events.append(event)
        whole.slidings += own.slidings
        whole.accumulations += own.accumulations
        whole.turns += own.turns
        whole.unsound += own.unsound
        for text in own.warnings:
            whole.warn(text)
        for name, value in own.stats.items():
            most = name in ("step_error", "step_advised")
            whole.stats[name] = (
                max(whole.stats.get(name, 0.0), value)
                if most
                else (whole.stats.get(name, 0.0) + value)
            )
        whole.energy = max(whole.energy, own.energy)
        whole.engine, whole.method = own.engine, own.method
        whole.ended_by, whole.signals, whole.carried = own.ended_by, own.signals, own.carried
    whole.stats["events"] = float(len(whole.events))
    return whole


def _moved(own: Trace, before: int) -> Any:
    """Return what makes the segments of a step, with the number of their sliding in all steps."""

    def make(k: int) -> Segment:
        segment = own.segments[k]
        if segment.sliding is None or not before:
            return segment
        return replace(segment, sliding=segment.sliding + before)

    return make


def _begin(part: Part, last: Part) -> Event:
    """Return the event of a step at which nothing was set: it begins there, and nothing happens."""
    carried = last.trace.carried
    assert carried is not None
    n = len(part.graph.storages) + len(part.graph.integrals)
    many = len(part.graph.machines)
    y = carried[0][1 : 1 + n]
    mode = tuple(carried[1][:many].tolist())
    landed = carried[1][many : 2 * many].tolist()
    at_rest = tuple(m.path for m, k in zip(part.graph.machines, landed, strict=True) if k >= 0)
    visit = Visit(mode, "continuous", (), {}, None)
    return Event(part.trace.begin, "change", (visit,), y, y, at_rest)
