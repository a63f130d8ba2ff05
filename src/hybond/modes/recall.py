"""The records of a passage, made when somebody asks for them.

A passage knows when each segment ended, in which mode and with what state the next began. Which
guards fired on which values, and what impulses passed, follows from that: the instant is settled
once more, by the reference.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import overload

import numpy as np
from numpy.typing import NDArray

from hybond.engine.outcome.polynomial import Polynomial
from hybond.errors import HybondError
from hybond.model.graph import Mode
from hybond.model.interval import Interval
from hybond.modes.marching import Marched, Passage
from hybond.modes.settle import Settled, Settler, event_of
from hybond.programs.program import Program
from hybond.trace import Cause, Event, Fired, Segment, Step, Trace

Vector = NDArray[np.float64]
SAME = 1e-9
"""Part of the largest stored quantity by which two states may differ and are one."""


@dataclass(frozen=True, slots=True)
class _Steps(Sequence[Callable[[float], Vector]]):
    """The dense output of some steps, from the one numbered `first` on, made when asked for."""

    taken: Marched
    first: int
    t: Vector
    y: Vector

    def __len__(self) -> int:
        return len(self.t) - 1

    @overload
    def __getitem__(self, k: int) -> Polynomial: ...

    @overload
    def __getitem__(self, k: slice) -> list[Polynomial]: ...

    def __getitem__(self, k: int | slice) -> Polynomial | list[Polynomial]:
        if isinstance(k, slice):
            return [self[j] for j in range(*k.indices(len(self)))]
        k = range(len(self))[k]
        taken, n = self.taken, self.first + k
        return Polynomial(
            float(self.t[k]), float(taken.stop[n]), self.y[k], taken.end[n], taken.dense[n]
        )


class Recall:
    """Makes the records of one run's passages.

    Parameters
    ----------
    program : Program
    max_writes : int
    cause : callable
        The cause of the timed event that ends an interval.
    """

    def __init__(
        self, program: Program, *, max_writes: int, cause: Callable[[Interval], Cause]
    ) -> None:
        self.program = program
        self._max_writes = max_writes
        self._cause = cause

    @cached_property
    def _settler(self) -> Settler:
        return Settler(self.program, Trace(), max_writes=self._max_writes)

    def note(self, passage: Passage, trace: Trace) -> None:
        """Add the segments and events of a passage to a trace."""
        begins = [passage.start[0], *passage.t[:-1].tolist()]
        trace.segments.extend(begins, lambda k: self.segment(passage, k))
        rows = np.flatnonzero(passage.changed).tolist()
        if rows:
            times = passage.t[rows].tolist()
            calm = ~passage.struck[rows]
            trace.events.extend(times, lambda k: self.event(passage, rows[k]), plain=calm.tolist())

    def causes(self, passage: Passage) -> list[Cause]:
        """Return what ended each segment."""
        return [self._cause_of(passage, k) for k in range(len(passage.t))]

    def _cause_of(self, passage: Passage, k: int) -> Cause:
        return self._cause(passage.around(k)[0]) if passage.timed[k] else "guard"

    def segment(self, passage: Passage, k: int) -> Segment:
        """Return one segment."""
        taken = passage.marched
        first, last = int(passage.steps[k - 1]) if k else 0, int(passage.steps[k])
        t0, y0 = (passage.t[k - 1], passage.after[k - 1]) if k else passage.start[:2]
        t = np.concatenate([[t0], taken.t[first:last]])
        y = np.vstack([y0, taken.y[first:last]])
        interpolants = _Steps(taken, first, t, y)
        return Segment(passage.left(k), passage.around(k)[0], t, y, interpolants)

    def event(self, passage: Passage, k: int) -> Event:
        """Return the event that ended segment k."""
        nx, ns = self.program.nx, self.program.ns
        t, y = float(passage.t[k]), passage.before[k]
        cause = self._cause_of(passage, k)
        x, s = y[:nx].copy(), y[nx:].copy()
        settled = self._settled(t, x, s, passage, k)
        stored = passage.after[k, : nx + ns].copy()
        mode = passage.mode[k]
        steps = () if settled is None else self._with_idle(settled.steps, mode)
        if settled is None or not steps or not _close(settled.x, stored[:nx]):
            step = self._plain(passage.left(k), mode)
            return Event(t, cause, (step,), y.copy(), stored)
        return replace(event_of(t, cause, settled, x, s), steps=steps, after=stored)

    def _with_idle(self, steps: tuple[Step, ...], mode: Mode) -> tuple[Step, ...]:
        """Return the steps that end in a mode; none if they do not.

        Which diode is called conducting while it carries nothing may be rounding, and come out the
        other way here.
        """
        if not steps or steps[-1].mode == mode:
            return steps
        last, machines = steps[-1], self.program.graph.machines
        differ = [m for m, a, b in zip(machines, last.mode, mode, strict=True) if a != b]
        if any(m.law is None for m in differ):
            return ()
        paths = {m.path for m in differ}
        fired = tuple(f for f in last.fired if f.machine not in paths)
        return (*steps[:-1], replace(last, mode=mode, fired=fired))

    def _settled(self, t: float, x: Vector, s: Vector, passage: Passage, k: int) -> Settled | None:
        """Settle an instant of the past: nothing had landed then."""
        program, settler = self.program, self._settler
        landed, program.landed = program.landed, frozenset()
        settler.trace.energy = float(passage.energy[k])
        try:
            return settler.settle(t, x, s, passage.left(k), *passage.around(k))
        except HybondError:
            return None
        finally:
            program.landed = landed

    def _plain(self, source: Mode, target: Mode) -> Step:
        """Return what is known without the values that guards read.

        Where rounding decides, the kernel and the reference may not settle alike.
        """
        fired = tuple(
            Fired(m.path, m.states[a], m.states[b], "settled by the kernel", {}, {})
            for m, a, b in zip(self.program.graph.machines, source, target, strict=True)
            if a != b
        )
        return Step(target, "continuous", fired, {}, None)


def _close(a: Vector, b: Vector) -> bool:
    """Whether two states are one but for rounding."""
    size = float(np.abs(b).max(initial=0.0))
    return bool((np.abs(a - b) <= SAME * size).all())
