"""Signals of a run by the reference: what the equations of its modes say at times of a segment."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.model.expressions import Expr
from hybond.model.graph import FlatGraph, Mode
from hybond.model.interval import Interval, interval_after
from hybond.modes.jump import constrained, on_constraints
from hybond.modes.sliding.view import equations_of
from hybond.programs.combined import Combined
from hybond.programs.program import Program
from hybond.trace import Segment, Trace

Vector = NDArray[np.float64]

KEPT = 4_000_000
"""Values that are kept for the next question about the same instants."""


class SignalsOfModes:
    """What the segments of a run have for signals: a `SignalSource`.

    Parameters
    ----------
    program : Program
    trace : Trace
    """

    def __init__(self, program: Program, trace: Trace) -> None:
        self.program = program
        self.graph: FlatGraph = program.graph
        self.trace = trace
        self._grids: dict[tuple[int, bytes], tuple[Vector, list[Vector]]] = {}
        self._kept = 0

    def of(self, segment: Segment, expressions: Sequence[Expr], t: Vector) -> list[Vector]:
        """Return expressions in canonical names at times of a segment, each of shape (times,)."""
        equations = equations_of(self.program, segment)
        y, columns = self._evaluated(segment, t)
        return [
            equations.average(e, t, y)
            if isinstance(equations, Combined) and equations.switched(e)
            else self._value(e, columns, t)
            for e in expressions
        ]

    def _value(self, e: Expr, columns: list[Vector], t: Vector) -> Vector:
        value = self.program.compile_arrays(e)(columns)
        return np.array(np.broadcast_to(np.asarray(value, dtype=float), t.shape))

    def after(
        self, t: float, state: Vector, mode: Mode, expressions: Sequence[Expr]
    ) -> list[float]:
        """Return expressions at an instant after which nothing follows, in a mode."""
        interval = interval_after(self.graph, t)
        equations = self.program.equations(mode, interval, t)
        v = self.program.evaluate(t, state, interval, equations)
        return [float(self.program.compile(e)(v)) for e in expressions]

    def bonds(self, segment: Segment) -> Vector:
        """Return bond variables at the accepted points, shape (2 bonds, points)."""
        _, columns = self._evaluated(segment, segment.t)
        return np.array(columns[self.program.slots.w])

    def energies(self, segment: Segment) -> Vector:
        """Return energy supplied and dissipated up to the accepted points, J, shape (points, 2)."""
        return np.asarray(segment.y[:, -2:] - segment.y[0, -2:])

    def weight(self, segment: Segment, t: float, machine: int, state: int) -> float:
        """Return the part of the time that a machine spends in a state at a time."""
        if segment.bonds is None:
            equations = equations_of(self.program, segment)
            if isinstance(equations, Combined):
                shares = equations.shares(t, equations.onto(t, segment.at(t)))
                return sum(c for c, m in shares if m[machine] == state)
        return float(segment.mode[machine] == state)

    def _evaluated(self, segment: Segment, t: Vector) -> tuple[Vector, list[Vector]]:
        """Return states and all values at times of a segment; the last ones asked for are kept."""
        key = (id(segment), t.tobytes())
        known = self._grids.get(key)
        if known is not None:
            return known
        interval = segment.interval
        assert isinstance(interval, Interval)
        equations = equations_of(self.program, segment)
        y = np.array(self._rows(segment, t))
        if isinstance(equations, Combined):
            y = np.array([equations.onto(float(a), b) for a, b in zip(t, y, strict=True)])
        values = self.program.evaluate_many(t, y, interval, equations)
        found = (y, list(values))
        if self._kept + values.size > KEPT:
            self._grids.clear()
            self._kept = 0
        self._grids[key] = found
        self._kept += values.size
        return found

    def _rows(self, segment: Segment, t: Vector) -> list[Vector]:
        """Return the states at times of a segment, on its constraints."""
        assert isinstance(segment.interval, Interval)
        equations = equations_of(self.program, segment)
        times = t.tolist()
        rows = segment.rows(times)
        if not constrained(equations):
            return rows
        accepted = set(segment.t.tolist())
        for k, a in enumerate(times):
            if a not in accepted:
                # between accepted points the interpolant is off the constraints by its own error
                rows[k] = on_constraints(
                    self.program, equations, segment.interval, a, rows[k], energy=self.trace.energy
                )
        return rows
