"""Values of a run at points, as the laws with slots want them."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.gradients import PRIOR
from hybond.analysis.sensitivity.tangent import At
from hybond.analysis.sensitivity.wanted import Wanted, followed
from hybond.equations.slots import slots_of
from hybond.model.expressions import Expr, Name, compile_expression, differentiate, names
from hybond.model.expressions.slots import slot_of
from hybond.model.graph import Mode
from hybond.model.inputs import Called, Pwm, Timetable, Waveform
from hybond.result import Result
from hybond.runs.trace import Segment

Vector = NDArray[np.float64]

BESIDE = 1e-12
"""Part of a time by which its right limit is read."""


class Values:
    """The values of a run, by canonical name, with those of what is varied."""

    def __init__(self, run: Result, found: Wanted) -> None:
        self.run, self.found = run, found
        # comparisons of time are those of the graph with slots, which merges none
        self.names = [n for n in slots_of(run.graph).index if not n.startswith("at:")]
        self._asked: list[Expr] = [Name(n) for n in self.names]
        self.own = dict(zip(found.columns, found.values.tolist(), strict=True))
        self._index = {name: k for k, name in enumerate(found.columns)}
        self._varied = [i for i in found.graph.inputs if _slotted(i.waveform)]

    def of(self, run: Result, values: Vector) -> Values:
        """Return those of another run of the same model, with other values of what is varied."""
        found = copy.copy(self)
        found.run = run
        found.own = dict(zip(self.found.columns, values.tolist(), strict=True))
        return found

    def within(self, segment: Segment, t: Vector) -> At:
        """Return values at times of a segment."""
        if segment.sliding is not None or segment.bonds is not None:
            return self._at(self.run.signals.of(segment, self._asked, t), t, segment)
        _, read = self.run.signals.parts(segment, self.names, t)
        return self._at(list(np.ascontiguousarray(read[:, 0].T)), t, segment)

    def parts(self, segment: Segment, t: Vector) -> list[At]:
        """Return values at times of a segment, in each mode that it combines."""
        _, read = self.run.signals.parts(segment, self.names, t)
        return [
            self._at(list(np.ascontiguousarray(read[:, part].T)), t, segment)
            for part in range(read.shape[1])
        ]

    def before(self, segment: Segment, t: float, state: Vector) -> At:
        """Return values at the end of a segment, in a state that is given."""
        at = np.array([t])
        read = self.run.signals.at(segment, self._asked, at, state[None])
        return self._at(read, at, segment)

    def after(self, t: float, state: Vector, mode: Mode) -> At:
        """Return values at an instant, right limits of inputs, in a mode that is entered."""
        read = self.run.signals.after(t, state, mode, self._asked)
        return self._at([np.array([v]) for v in read], np.array([t]), None)

    def with_prior(self, at: At, prior: Mapping[str, float]) -> At:
        """Return values together with a priori ones."""
        values = {**at.values, **{PRIOR + n: v for n, v in prior.items()}}
        return At(values, at.inputs, at.points)

    def _at(self, read: Sequence[Vector], t: Vector, segment: Segment | None) -> At:
        begin = float(t[0]) if segment is None else float(segment.t[0])
        end = begin if segment is None else float(segment.t[-1])
        values: Mapping[str, Vector | float] = {
            **dict(zip(self.names, read, strict=True)),
            **self.own,
            **(self._truths(0.5 * (begin + end)) if end > begin else self.truths_after(begin)),
        }
        return At(values, self.inputs_of(t, begin), len(t))

    def truths_after(self, t: float) -> dict[str, float]:
        """Return which comparisons of time hold just behind a time."""
        return self._truths(t + BESIDE * abs(t))

    def _truths(self, t: float) -> dict[str, float]:
        """Return which comparisons of time hold at a time between two timed events."""
        if not self.found.graph.watches:
            return {}
        index = {"time": 0, **{name: k + 1 for name, k in self._index.items()}}
        row = [t, *self.own.values()]
        return {
            f"at:{w.index}": float(
                compile_expression(followed(w.compare), index, pre_offset=0)(row)
            )
            for w in self.found.graph.watches
        }

    def inputs_of(self, t: Vector, begin: float) -> Vector:
        """Return how inputs follow parameters in the piece that begins or lies at a time."""
        graph = self.found.graph
        slopes = np.zeros((len(t), len(graph.inputs), len(self.own)))
        for i in self._varied:
            piece = self.run.graph.inputs[i.index].waveform.piece(begin)
            moving = isinstance(i.waveform, Timetable) and i.waveform.linear
            for k, at in enumerate(t.tolist() if moving else [begin]):
                row = self.slope(i.waveform.value(at, piece))
                slopes[k if moving else slice(None), i.index] = row
        return slopes

    def slope(self, value: float) -> Vector:
        """Return the derivatives of a number that follows from parameters."""
        slot = slot_of(value)
        found = np.zeros(len(self.own))
        if slot is None:
            return found
        row = list(self.own.values())
        for name in names(slot.tree):
            slope = compile_expression(differentiate(slot.tree, name), self._index, pre_offset=0)
            found[self._index[name]] = float(slope(row))
        return found

    def edges(self, t: float, close: float) -> list[Vector]:
        """Return the derivatives of the instants of inputs that are at a time."""
        found = []
        for i in self.found.graph.inputs:
            # where the edge is says the run; what it is made of, the graph with slots
            plain, waveform = self.run.graph.inputs[i.index].waveform, i.waveform
            if isinstance(waveform, Called):
                # of a function nobody knows what it is made of; its breaks are given
                found += [np.zeros(len(self.own)) for b in waveform.breaks if abs(b - t) <= close]
                continue
            piece = plain.piece(t + close)
            if abs(_edge(plain, piece) - t) <= close:
                found.append(self.slope(_edge(waveform, piece)))
        return found


def _edge(waveform: Waveform, piece: int) -> float:
    """Return when a piece begins; infinite where there are no edges."""
    if isinstance(waveform, Pwm):
        return waveform._edge(piece)
    return waveform.begin(piece) if isinstance(waveform, Timetable) else math.inf


def _slotted(waveform: Waveform) -> bool:
    """Whether a value of a waveform may follow from a parameter, beside where its pieces begin."""
    if isinstance(waveform, Called):
        return False
    if isinstance(waveform, Pwm):
        return any(slot_of(v) is not None for v in (waveform.high, waveform.low))
    if isinstance(waveform, Timetable):
        numbers = [*waveform.values, *waveform.times, waveform.period]
        return any(slot_of(v) is not None for v in numbers)
    return True
