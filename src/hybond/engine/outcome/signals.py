"""Signals of a finished run, segment by segment, read in the library."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.native import NativeModel
from hybond.engine.compiled.native_look import NativeLook
from hybond.engine.compiled.points import Points, Within
from hybond.engine.compiled.points import Steps as StepsToLook
from hybond.engine.outcome.combinations import ALONE, Combination
from hybond.engine.outcome.records import Interpolants
from hybond.model.expressions import ARRAYS, Expr, compile_expression, names, uses_pre
from hybond.model.graph import FlatGraph, Mode
from hybond.trace import Segment, Trace

Vector = NDArray[np.float64]


class Signals:
    """What the segments of a run have for signals.

    Parameters
    ----------
    model : NativeModel
        The tables that the run was made with.
    trace : Trace
    """

    def __init__(self, model: NativeModel, trace: Trace) -> None:
        self.graph: FlatGraph = model.tables.graph
        self._slots = model.tables.slots
        self._trace = trace
        self._look = NativeLook(model)
        self._into: object = None

    def of(self, segment: Segment, expressions: Sequence[Expr], t: Vector) -> list[Vector]:
        """Return expressions in canonical names at times of a segment, each of shape (times,)."""
        steps, times = self._within(segment, t)
        self._enter(segment)
        slots = self._read(expressions)
        switched = [e for e in expressions if self._switched(segment, e)]
        found: dict[int, Vector] = {}
        if len(switched) < len(expressions):
            columns = self._columns(slots, self._look.values(Within(steps, times), slots))
            for e in expressions:
                found[id(e)] = self._value(e, columns, times.shape)
        if switched:
            shares, values = self._look.parts(Within(steps, times), slots)
            for e in switched:
                total = np.zeros(times.shape)
                for part in range(shares.shape[1]):
                    columns = self._columns(slots, values[:, part])
                    total += shares[:, part] * self._value(e, columns, times.shape)
                found[id(e)] = total
        return [found[id(e)] for e in expressions]

    def after(
        self, t: float, state: Vector, mode: Mode, expressions: Sequence[Expr]
    ) -> list[float]:
        """Return expressions at an instant after which nothing follows, in its last mode."""
        self._into = None
        self._look.into(t, list(mode), energy=self._trace.energy)
        slots = self._read(expressions)
        at = Points([t], state[None, : self._states], accepted=True)
        columns = self._columns(slots, self._look.values(at, slots))
        return [float(self._value(e, columns, (1,))[0]) for e in expressions]

    def bonds(self, segment: Segment) -> Vector:
        """Return bond variables at the accepted points, shape (2 bonds, points times modes).

        While machines slide each mode that is combined has its own.
        """
        steps, times = self._within(segment, segment.t)
        self._enter(segment)
        first, last = self._slots.w.start, self._slots.w.stop
        _, values = self._look.parts(Within(steps, times), np.arange(first, last))
        return np.ascontiguousarray(values.reshape(-1, last - first).T)

    def energies(self, segment: Segment) -> Vector:
        """Return energy supplied and dissipated up to the accepted points, J, shape (points, 2)."""
        steps, _ = self._within(segment, segment.t)
        self._enter(segment)
        found = np.zeros((len(segment.t), 2))
        np.cumsum(self._look.energies(steps)[:, :2], axis=0, out=found[1:])
        return found

    def weight(self, segment: Segment, t: float, machine: int, state: int) -> float:
        """Return the part of the time that a machine spends in a state at a time."""
        steps, times = self._within(segment, np.array([t]))
        self._enter(segment)
        shares, _ = self._look.parts(Within(steps, times), np.zeros(0, dtype=np.intc))
        return float(shares[0, self._look.modes()[:, machine] == state].sum())

    # -- the segment that is looked into

    @property
    def _states(self) -> int:
        return len(self.graph.storages) + len(self.graph.integrals)

    def _enter(self, segment: Segment) -> None:
        """Look into a segment; the last one is known."""
        if self._into is segment:
            return
        made = segment.combined if isinstance(segment.combined, Combination) else ALONE
        landed = [m.path in segment.landed for m in self.graph.machines]
        self._look.into(
            float(segment.t[0]),
            list(segment.mode),
            landed=landed,
            surfaces=made.surfaces,
            product=made.product,
            modes=made.modes,
            energy=self._trace.energy,
        )
        self._into = segment

    @staticmethod
    def _within(segment: Segment, t: Vector) -> tuple[StepsToLook, Vector]:
        """Return the steps in which times of a segment lie."""
        made = segment.interpolants
        assert isinstance(made, Interpolants)
        times = np.asarray(t, dtype=float)
        first, last = 0, len(made)
        if len(times):
            # the first time is that of the state before the first step
            low, high = np.searchsorted(segment.t[1:], [times.min(), times.max()])
            first, last = int(low), min(int(high) + 1, last)
        steps, k = made.steps, slice(made.first + first, made.first + last)
        return StepsToLook(steps.time[k], steps.state[k], steps.dense[k]), times

    # -- expressions

    def _read(self, expressions: Sequence[Expr]) -> NDArray[np.intc]:
        """Return the slots that expressions read, a priori values beside those after."""
        index, size = self._slots.index, self._slots.size
        found: set[int] = set()
        for e in expressions:
            own = {index[n] for n in names(e)}
            found |= own
            if uses_pre(e):
                found |= {k + size for k in own}
        return np.array(sorted(found), dtype=np.intc)

    def _columns(self, slots: NDArray[np.intc], values: Vector) -> list[Vector]:
        """Return columns of values where closures look for them."""
        nothing = np.zeros(0)
        columns = [nothing] * (2 * self._slots.size)
        for k, column in zip(slots.tolist(), values.T, strict=True):
            columns[k] = np.ascontiguousarray(column)
        return columns

    def _value(self, e: Expr, columns: list[Vector], shape: tuple[int, ...]) -> Vector:
        f = compile_expression(e, self._slots.index, ARRAYS, pre_offset=self._slots.size)
        return np.array(np.broadcast_to(np.asarray(f(columns), dtype=float), shape))

    def _switched(self, segment: Segment, e: Expr) -> bool:
        """Whether an expression reads what the sliding machines of a segment switch."""
        if segment.sliding is None:
            return False
        paths = set(self._trace.slidings[segment.sliding].machines)
        flags: set[str] = set()
        for m in self.graph.machines:
            if m.path in paths:
                flags |= {f"in:{m.index}:{k}" for k in range(len(m.states))}
                flags |= {f"on:{k}" for on in m.on for k in on}
        return bool(flags & names(e))
