"""A run as a chain of linear maps of its variations: steps of motion, and switches between them.

    start:      d = derivatives of the start, through what is settled there
    motion:     d' = A(t) d + B(t), A and B at the states of the run's dense output; steps by
                collocation, halved until two halves agree with the whole to `TOLERANCE`; where the
                mode is linear with constant coefficients, the exponential (`flow`)
    switch:     d+ = S d- + P, the saltation matrix (`switch`)

Forward, the chain gives all variations; from its end, the adjoint of one goal. It ends where a
derivative ends: at an instant that is only touched, or that two things share.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.chain import Chain, Reading, RunSwitch
from hybond.analysis.sensitivity.collocation import STAGES, Jump, VariationStep, radau
from hybond.analysis.sensitivity.crossing import (
    LOCATED,
    NO_CAUSE,
    SAME,
    Crossing,
    crossing,
    timed,
)
from hybond.analysis.sensitivity.fields import Field, Fields
from hybond.analysis.sensitivity.flow import flows
from hybond.analysis.sensitivity.gradients import Compiled
from hybond.analysis.sensitivity.kinks import edges_at, jumped, jumps_at_end, kinks_of
from hybond.analysis.sensitivity.landing import landed
from hybond.analysis.sensitivity.switch import started, switched
from hybond.analysis.sensitivity.tangent import Read, Tangent, Undetermined
from hybond.errors import HybondError
from hybond.model.expressions import Expr
from hybond.result import Result
from hybond.runs.trace import Event, Segment

Vector = NDArray[np.float64]

TOLERANCE = 1e-9
"""Part of the variations by which a step and its two halves, which are taken, may differ."""
NOTHING = 1e-5
"""Of the largest variation, or of what a state is for each unit of a parameter: what is below
`TOLERANCE` of this part of it is rounding."""
HALVINGS = 10
SKIPPED = 4
"""Accepted points that a step of the variations goes over at first, where nothing is read."""
AT_ONCE = 64
"""Steps whose fields are read together."""


UNSEEN = 1e-6
"""Part by which rates on both sides of an instant without a cause may differ."""
ONE = 1e-4
"""Part by which the derivatives of two instants may differ and they are one and the same."""
AT_THE_END = "something happens at the very end of the run"
LANDS = "accumulation"
"""The cause of an event at which impacts that accumulate are over."""
ENDS = {
    "step": "time-stepping locates no events",
    "law": "a source jumps onto what is stored",
    "until": "the run ends where a condition holds, not at a time",
    "change": "the run was changed from outside",
}
"""Causes of events behind which there are no derivatives, and why."""


def chain_of(
    run: Result,
    fields: Fields,
    start: Vector,
    outputs: Sequence[Expr],
    times: Sequence[float],
    end: Vector | None = None,
) -> Chain:
    """Return the chain of a run.

    Parameters
    ----------
    start : array, shape (states, more + parameters)
        Derivatives of the start before it is settled. Columns before those of the parameters are
        variations of the start alone.
    outputs : sequence of Expr
        Read at the ends of segments, at accepted points and at `times`.
    end : array, shape (parameters,), optional
        Derivatives of the time at which the run ends, where it follows parameters: what happens
        there may then move, if it moves with it.
    """
    more = start.shape[1] - len(fields.columns.parameters)
    return _Along(run, fields, outputs, times, more, end).made(start)


class _Along:
    def __init__(
        self,
        run: Result,
        fields: Fields,
        outputs: Sequence[Expr],
        times: Sequence[float],
        more: int,
        end: Vector | None,
    ) -> None:
        self.run, self.fields, self.outputs = run, fields, list(outputs)
        self.more = more
        many = more + len(fields.columns.parameters)
        self.end = np.zeros(many)
        if end is not None:
            self.end[more:] = end
        self.times = np.unique(np.asarray(list(times), dtype=float))
        self.events: dict[float, list[int]] = {}
        for k, t in enumerate(run.trace.events.times):
            self.events.setdefault(float(t), []).append(k)
        self._read_by: dict[Tangent, tuple[Compiled, Read]] = {}
        self._now = 0.0
        self._moves: Vector | None = None
        self.largest = np.zeros((fields.size, many))
        self.sizes = np.zeros(fields.size)
        for segment in run.segments:
            own = np.abs(segment.y[:, : fields.columns.time]).max(axis=0, initial=0.0)
            self.sizes[: len(own)] = np.maximum(self.sizes[: len(own)], own)
        p = np.abs(np.concatenate([self.sizes[:more], fields.values.found.values]))
        self.per_parameter = np.where(p > 0.0, 1.0 / np.where(p > 0.0, p, 1.0), 0.0)

    def made(self, start: Vector) -> Chain:
        whole = np.zeros((self.fields.size, start.shape[1]))
        self.chain = Chain(whole)
        segments = list(self.run.segments)
        try:
            first = self._begin(segments[0], None)
            events = self.run.trace.events
            if len(events) and events[0].cause == "start":
                start = started(self.fields, events[0], start, first)
            whole[: len(start)] = start
            n = self.fields.columns.time
            own = whole[:n, self.more :]
            self.chain.edges = edges_at(self.fields, first, segments[0].mode, own)
            d = whole
            for k, segment in enumerate(segments):
                d = self._motion(segment, d)
                following = segments[k + 1] if k + 1 < len(segments) else None
                d = self._switch(segment, following, d)
                if following is None or self.chain.ends is not None:
                    break
        except Undetermined as reason:
            self._end(str(reason))
        except HybondError as error:
            self._end(error.why)
        return self.chain

    # -- motion

    def _motion(self, segment: Segment, d: Vector) -> Vector:
        self._now = float(segment.t[0])
        if segment.bonds is not None:
            raise Undetermined("time-stepping locates no events")
        mesh, self._field = self.fields.whole(segment, self.times)
        self._places = {0: len(self.chain.links)}
        exact = flows(self.fields, segment, mesh, self._field)
        if exact is not None:
            for k, link in enumerate(exact):
                self.chain.links.append(link)
                self._places[k + 1] = len(self.chain.links)
                d = link.forward(d)
                self.largest = np.maximum(self.largest, np.abs(d))
            self._put(mesh)
            return d
        self._kinks = {kink.t: kink for kink in kinks_of(self.fields, segment)}
        if not self.outputs:
            # steps begin and end at every accepted point only where something is read
            mesh = np.unique(np.concatenate([mesh[:-1:SKIPPED], mesh[-1:], [*self._kinks]]))
        for some in _slices(len(mesh) - 1):
            a, b = mesh[some], mesh[some.start + 1 : some.stop + 1]
            for k, (whole, halves) in enumerate(self._steps(segment, a, b)):
                d = self._accepted(segment, d, whole, halves, 0)
                self._now = float(b[k])
                d = self._kink(segment, d)
                self._places[some.start + k + 1] = len(self.chain.links)
        self._put(mesh)
        return d

    def _kink(self, segment: Segment, d: Vector) -> Vector:
        """Take the jump of a law where there is one."""
        kink = self._kinks.get(self._now)
        jump = None if kink is None else jumped(self.fields, segment, kink)
        if jump is None:
            return d
        jump = self._wide(jump)
        self.chain.links.append(jump)
        return jump.forward(d)

    def _wide(self, jump: Jump) -> Jump:
        """Return a jump with the columns of the start, which it does not depend on by itself."""
        if not self.more:
            return jump
        P = np.hstack([np.zeros((len(jump.P), self.more)), jump.P])
        by = np.concatenate([np.zeros(self.more), jump.time_by])
        return replace(jump, P=P, time_by=by)

    def _is_end(self, moves: Vector) -> bool:
        """Whether an instant moves as the end of the run does."""
        size = np.abs(moves) + np.abs(self.end)
        return bool((np.abs(moves - self.end) <= SAME * size).all())

    def _accepted(
        self,
        segment: Segment,
        d: Vector,
        whole: VariationStep,
        halves: list[VariationStep],
        depth: int,
    ) -> Vector:
        """Take a step by its halves, if these and the whole agree; else each half as a step."""
        coarse = whole.forward(d)
        fine = halves[1].forward(halves[0].forward(d))
        h = whole.t1 - whole.t0
        size = np.abs(whole.A).max(axis=0) @ np.abs(d) + np.abs(whole.B).max(axis=0)
        unit = np.where(self.sizes > 0.0, self.sizes, 1.0)[:, None]
        most = np.maximum(np.abs(fine) / unit, self.largest / unit).max(axis=0, initial=0.0)
        floor = NOTHING * unit * np.maximum(most, self.per_parameter)
        size = np.maximum.reduce([np.abs(d), np.abs(fine), self.largest, h * size, floor])
        good = bool((np.abs(fine - coarse) <= TOLERANCE * size).all())
        if good or depth == HALVINGS:
            if not good:
                self.chain.rough.append(whole.t0)
            self.chain.links += halves
            self.largest = np.maximum(self.largest, np.abs(fine))
            return fine
        for half in halves:
            ((own, quarters),) = self._steps(segment, np.array([half.t0]), np.array([half.t1]))
            d = self._accepted(segment, d, own, quarters, depth + 1)
        return d

    def _steps(
        self, segment: Segment, a: Vector, b: Vector
    ) -> Iterator[tuple[VariationStep, list[VariationStep]]]:
        """Yield each step and its halves."""
        c, _, _ = radau()
        middle = 0.5 * (a + b)
        spans = [(a, b), (a, middle), (middle, b)]
        # rounding must not put the last stage behind the end
        stages = [np.minimum(x[:, None] + (y - x)[:, None] * c, y[:, None]) for x, y in spans]
        t = np.stack(stages, axis=1)
        read = t.copy()
        for kink in self._kinks.values():
            read[t == kink.t] = kink.left
        slopes = self.fields.within(segment, read.ravel()).slopes
        n = self.fields.columns.time
        size = self.fields.size
        many = slopes.shape[2] - n - 1
        if len(slopes) == 1:
            slopes = np.broadcast_to(slopes, (t.size, *slopes.shape[1:]))
        A = np.zeros((t.size, size, size))
        A[:, :, :n] = slopes[:, :, :n]
        A = A.reshape(len(a), 3, STAGES, size, size)
        B = np.zeros((t.size, size, self.more + many))
        B[:, :, self.more :] = slopes[:, :, n + 1 :]
        B = B.reshape(len(a), 3, STAGES, size, self.more + many)
        for k in range(len(a)):
            made = [
                VariationStep(float(x[k]), float(y[k]), A[k, j], B[k, j])
                for j, (x, y) in enumerate(spans)
            ]
            yield made[0], made[1:]

    # -- switches

    def _switch(self, segment: Segment, following: Segment | None, d: Vector) -> Vector:
        t = float(segment.t[-1])
        self._now = t
        own = [k for k in self.events.get(t, []) if self.run.trace.events[k].cause != "start"]
        limit = None
        if following is not None and following.t[0] > t:
            limit, following = following, None
        if following is None and not own:
            end = self.fields.ending(segment, None)
            edges = [c.by[self.fields.size :] for c in timed(self.fields, end, t)]
            if not all(self._is_end(np.append(np.zeros(self.more), by)) for by in edges):
                self.chain.ends, self.chain.why = t, AT_THE_END
            self._last_kink(segment, d)
            return d
        if len(own) > 1:
            raise Undetermined("two events happen at one instant: which comes first would change")
        event = self.run.trace.events[own[0]] if own else None
        number = own[0] if own else None
        if event is not None and event.cause == LANDS:
            raise Undetermined("impacts accumulated at once and came to rest")
        if event is not None and event.cause in ENDS:
            raise Undetermined(ENDS[event.cause])
        end = self.fields.ending(segment, None if event is None else np.asarray(event.before))
        begin = self._begin(following, event)
        same = not _differs(end, begin)
        try:
            found = crossing(self.fields, segment, end, event)
        except Undetermined:
            # a diode that begins to conduct where no current may flow: its instant does nothing
            if not same or event is None or not np.array_equal(event.before, event.after):
                raise
            many = len(self.fields.columns.parameters)
            found = Crossing(np.zeros(self.fields.size + many), NO_CAUSE)
        if found.text == NO_CAUSE and not same:
            raise Undetermined("the motion changes, and what became zero was not found")
        jump = self._wide(switched(self.fields, t, end, found, event, begin))
        moves = jump.moved(d)
        self._together(segment, moves)
        self.chain.instants.append(RunSwitch(len(self.chain.links), t, found.text, number))
        self.chain.links.append(jump)
        d = jump.forward(d)
        self.largest = np.maximum(self.largest, np.abs(d))
        if t >= (1.0 - LOCATED) * self.run.t_end and not self._is_end(moves):
            # one side of it is before the event, and the other one behind
            self.chain.ends, self.chain.why = t, AT_THE_END
        elif limit is not None:
            return self._land(begin, limit)
        elif following is None:
            self._read_last(begin, t)
        return d

    def _last_kink(self, segment: Segment, d: Vector) -> None:
        """Note a law that jumps at the very end: derivatives are those to one side, before it."""
        if segment.sliding is not None:
            return
        kink = self.fields.last_kink(segment)
        found = None if kink is None else jumps_at_end(self.fields, segment, kink)
        if isinstance(found, str):
            self.chain.ends, self.chain.why = self._now, found
        if not isinstance(found, Crossing):
            return
        n = self.fields.size
        moves = found.by[:n] @ d
        moves[self.more :] += found.by[n:]
        if self._is_end(moves):
            return
        if self.more:
            self.chain.ends, self.chain.why = self._now, "a law jumps at the very end of the run"
            return
        own, known = moves - self.end, self.fields.values.found
        by = np.abs(own @ known.follows) > SAME * (np.abs(own) @ np.abs(known.follows))
        self.chain.last = [known.names[k] for k in np.flatnonzero(by).tolist()]

    def _land(self, flight: Field, limit: Segment) -> Vector:
        """Take the limit of impacts, behind the last of them."""
        t = float(limit.t[0])
        numbers = [k for k in self.events.get(t, []) if self.run.trace.events[k].cause == LANDS]
        records = [a for a in self.run.trace.accumulations if a.t == t and a.landed]
        if len(numbers) != 1 or len(records) != 1:
            raise Undetermined("impacts accumulate")
        event = self.run.trace.events[numbers[0]]
        rest = self._begin(limit, event)
        found = self.chain.forward()
        machine = records[0].machine
        made = landed(self.fields, event, flight, rest, self._impacts(machine), found, machine)
        self.chain.instants.append(
            RunSwitch(len(self.chain.links), t, "impacts come to rest", numbers[0])
        )
        self.chain.links.append(made)
        d = made.after(found)
        self.largest = np.maximum(self.largest, np.abs(d))
        self._moves = None
        return d

    def _impacts(self, machine: str) -> list[tuple[int, Jump]]:
        """Return the last impacts of the machine that lands, and where in the chain they are."""
        found: list[tuple[int, Jump]] = []
        for instant in self.chain.instants:
            if instant.event is None or instant.place is None:
                continue
            steps = self.run.trace.events[instant.event].steps
            link = self.chain.links[instant.place]
            if isinstance(link, Jump) and any(
                fired.machine == machine for step in steps for fired in step.fired
            ):
                found.append((instant.place, link))
        return found

    def _together(self, segment: Segment, moves: Vector) -> None:
        """Refuse two instants that are one as far as the run can tell, and move differently."""
        t, last = float(segment.t[-1]), self._moves
        self._moves = moves
        if last is None or t - float(segment.t[0]) > LOCATED * t:
            return
        if (np.abs(moves - last) > ONE * (np.abs(moves) + np.abs(last))).any():
            raise Undetermined("two events happen at one instant: which comes first would change")

    def _begin(self, segment: Segment | None, event: Event | None) -> Field:
        """Return the field with which a segment begins, or that of a last event."""
        if segment is None:
            assert event is not None
            return self.fields.entered(event.t, np.asarray(event.after), event.steps[-1].mode)
        return self.fields.whole(segment, self.times)[1].point(0)

    def _end(self, why: str) -> None:
        """Note where the derivative ends."""
        self.chain.ends, self.chain.why = self._now, why
        number = next(iter(self.events.get(self._now, [])), None)
        self.chain.instants.append(RunSwitch(None, self._now, why, number))

    # -- readings

    def _put(self, mesh: Vector) -> None:
        if not self.outputs:
            return
        values, by = self._outputs(self._field)
        n, size = self.fields.columns.time, self.fields.size
        for k, t in enumerate(mesh.tolist()):
            row = by[min(k, len(by) - 1)]
            whole = np.zeros((len(row), size))
            whole[:, :n] = row[:, :n]
            self.chain.readings.append(
                Reading(self._places[k], t, values[k], whole, row[:, n + 1 :])
            )

    def _read_last(self, field: Field, t: float) -> None:
        self._field, self._places = field, {0: len(self.chain.links)}
        self._put(np.array([t]))

    def _outputs(self, field: Field) -> tuple[Vector, Vector]:
        made = self._read_by.get(field.tangent)
        if made is None:
            own = [field.tangent.rows.moving(e) for e in self.outputs]
            made = self._read_by[field.tangent] = Compiled(own), Read(field.tangent, own)
            if made[1].is_open(field.at):
                raise Undetermined("the mode leaves open how what is read is shared")
        return made[0].at(field.at.values, field.at.points), made[1].at(field.at, field.bonds)


def _differs(end: Field, begin: Field) -> bool:
    """Whether a motion goes on at other rates than those it came with."""
    size = np.abs(end.f[0]) + np.abs(begin.f[0])
    return bool((np.abs(end.f[0] - begin.f[0]) > UNSEEN * size).any())


def _slices(many: int) -> Iterator[slice]:
    for first in range(0, many, AT_ONCE):
        yield slice(first, min(first + AT_ONCE, many))
