"""Signals of a finished run, segment by segment, read in the engine."""

from __future__ import annotations

import copy
import sys
import threading
from bisect import bisect_left
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.chronicle import Chronicle
from hybond.engine.compiled.look import Look, Motions
from hybond.engine.compiled.points import Points, Within
from hybond.engine.compiled.rows import MACHINES_OF_STEP
from hybond.engine.outcome.along import Along, begins_of
from hybond.engine.outcome.combinations import ALONE, Combination
from hybond.engine.outcome.engines import Prepared
from hybond.engine.outcome.left_limits import left_limits
from hybond.engine.outcome.logged_steps import Block, roots_within, steps_around
from hybond.engine.tables import ModelTables
from hybond.model.expressions import ARRAYS, Expr, Name, Number, compile_expression, names, uses_pre
from hybond.model.graph import FlatGraph, Mode
from hybond.runs.trace import Segment, Trace

Vector = NDArray[np.float64]


class Signals:
    """What the segments of a run have for signals; any number of threads may ask.

    Parameters
    ----------
    model : Prepared
        That the run was made with.
    """

    def __init__(self, model: Prepared, trace: Trace) -> None:
        self.graph: FlatGraph = model.tables.graph
        self._slots = model.tables.slots
        self._trace = trace
        self._model = model
        self._looks: Look | None = None
        self._lock = threading.RLock()
        """Who asks has first to say into what: nobody else may come between."""
        self._into: object = None

    @property
    def _look(self) -> Look:
        """What looks into the run, made when somebody does: it takes as much room as the run."""
        with self._lock:
            if self._looks is None:
                self._looks = self._model.look()
            return self._looks

    @property
    def tables(self) -> ModelTables:
        """The tables of the model."""
        return self._model.tables

    def __deepcopy__(self, memo: dict[int, Any]) -> Signals:
        """Return signals of a copied run, with a look of their own."""
        return Signals(self._model, copy.deepcopy(self._trace, memo))

    def of(self, segment: Segment, expressions: Sequence[Expr], t: Vector) -> list[Vector]:
        """Return expressions in canonical names at times of a segment, each of shape (times,)."""
        resting = np.asarray(t, dtype=float) > segment.t[-1]
        with self._lock:
            if not resting.any():
                return self._of(segment, expressions, t)
            found = np.zeros((len(expressions), len(resting)))
            if not resting.all():
                found[:, ~resting] = self._of(segment, expressions, t[~resting])
            for k in np.flatnonzero(resting).tolist():
                state, mode = self.rest(segment, float(t[k]))
                found[:, k] = self.after(float(t[k]), state, mode, expressions)
        return list(found)

    def of_points(
        self,
        segments: Chronicle[Segment],
        which: NDArray[np.intp],
        t: Vector,
        expressions: Sequence[Expr],
    ) -> list[Vector]:
        """Return expressions at points of segments, each of shape (points,).

        What can be is read in one call.

        Parameters
        ----------
        which : array of int, shape (points,)
            The segment of each point, in order.
        t : array, shape (points,)
        expressions : sequence of Expr
            In canonical names.
        """
        before = left_limits(self._model.tables, self._trace, segments, which, t, self._of_points)
        return self._of_points(segments, which, before, expressions)

    def _of_points(
        self,
        segments: Chronicle[Segment],
        which: NDArray[np.intp],
        t: Vector,
        expressions: Sequence[Expr],
    ) -> list[Vector]:
        found = np.zeros((len(expressions), len(t)))
        first = np.flatnonzero(begins_of(which))
        asked = which[first]
        ends = np.append(first[1:], len(t))
        along, apart = [], []
        for block, places, numbers in segments.origins(asked):
            alone = np.zeros(len(places), dtype=bool)
            if isinstance(block, Block):
                alone = block.alone[numbers] & (not self._trace.roots)
                if alone.any():
                    of_block = numbers[alone], places[alone]
                    along.append(Along.of(block, *of_block, first, ends, t))
            apart += places[~alone].tolist()
        for some_along in along:
            self._read_along(some_along, t, expressions, found)
        for place in [*apart, *(p for a in along for p in a.resting)]:
            some = slice(int(first[place]), int(ends[place]))
            segment = segments[int(asked[place])]
            for row, values in zip(found, self.of(segment, expressions, t[some])):
                row[some] = values
        return list(found)

    def _read_along(
        self, along: Along, t: Vector, expressions: Sequence[Expr], found: Vector
    ) -> None:
        """Read points of segments in which nothing is slid on; put what they say there."""
        motions = self.motions(along.begin, along.place, along.many)
        within = Within(along.to_look(), t[along.points], along.step)
        slots = self._read(expressions)
        columns = self._columns(slots, self.values_along(motions, within, slots))
        for k, e in enumerate(expressions):
            found[k, along.points] = self._value(e, columns, along.points.shape)

    def motions(self, begin: Vector, place: NDArray[np.intc], many: NDArray[np.intp]) -> Motions:
        """Return segments: begins, their rows of places in the log, how many points of each."""
        machines = len(self.graph.machines)
        return Motions(
            begin,
            np.ascontiguousarray(place[:, MACHINES_OF_STEP : MACHINES_OF_STEP + machines]),
            np.ascontiguousarray(place[:, MACHINES_OF_STEP + machines :]),
            np.append(0, np.cumsum(many)).astype(np.intc),
            self._energy,
        )

    def values_along(self, motions: Motions, points: Within, slots: NDArray[Any]) -> Vector:
        """Return values at points of many segments, shape (points, slots)."""
        with self._lock:
            self._into = None
            return self._look.values_along(motions, points, slots)

    def energies_along(self, motions: Motions, points: Within, end: Vector) -> Vector:
        """Return energies from points of many segments on, shape (points, 3)."""
        with self._lock:
            self._into = None
            return self._look.energies_along(motions, points, end)

    def rest(self, segment: Segment, t: float) -> tuple[Vector, Mode]:
        """Return state and mode at a time behind the last step of a segment.

        Between the last of impacts that come to rest and their limit nothing is integrated: there
        it is as the last one left it.
        """
        events = self._trace.events
        k = bisect_left(events.times, t) - 1
        if k < 0 or events.times[k] < segment.t[-1]:
            return segment.y[-1], segment.mode
        return events[k].after, events[k].steps[-1].mode

    def _of_steps(self, segment: Segment, expressions: Sequence[Expr], t: Vector) -> list[Vector]:
        """Return expressions within time-stepping: what its steps found, between them straight.

        An impulse and a force are one in a step, so that what the equations of the mode would say
        is not asked.
        """
        assert segment.bonds is not None
        steps, times = steps_around(segment, t)
        self._enter(segment)
        slots = self._read(expressions)
        place, size = self._slots, self._slots.size
        own = {}
        stored, signals = len(self.graph.storages), len(self.graph.integrals)
        for kind, table, first, many in (
            (place.w, segment.bonds, 0, segment.bonds.shape[1]),
            (place.x, segment.y, 0, stored),
            (place.s, segment.y, stored, signals),
        ):
            for k in range(many):
                own[kind.start + k] = table[:, first + k]
        asked = np.array([k for k in slots.tolist() if k % size not in own], dtype=np.intc)
        columns = self._columns(asked, self._look.values(Within(steps, times), asked))
        for k in slots.tolist():
            if k % size in own:
                columns[k] = np.interp(times, segment.t, own[k % size])
        return [self._value(e, columns, times.shape) for e in expressions]

    def _of(self, segment: Segment, expressions: Sequence[Expr], t: Vector) -> list[Vector]:
        if segment.bonds is not None:
            return self._of_steps(segment, expressions, t)
        steps, times = steps_around(segment, t)
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
        with self._lock:
            self._into = None
            self._look.into(t, list(mode), energy=self._energy)
            found = self._at(expressions, np.array([t]), state[None])
        return [float(values[0]) for values in found]

    def at(
        self, segment: Segment, expressions: Sequence[Expr], t: Vector, y: Vector
    ) -> list[Vector]:
        """Return expressions by the equations of a segment in states beside its own motion.

        Parameters
        ----------
        expressions : sequence of Expr
            In canonical names.
        t : array, shape (times,)
        y : array, shape (times, states)
            Taken as they are, and not put back on constraints.
        """
        with self._lock:
            self._enter(segment)
            return self._at(expressions, t, y)

    def powers_at(self, segment: Segment, t: Vector, y: Vector) -> Vector:
        """Return power supplied and dissipated in states as `at` has them, W, shape (times, 2)."""
        with self._lock:
            self._enter(segment)
            return self._look.powers(Points(t, y[:, : self._states], accepted=True))

    def _at(self, expressions: Sequence[Expr], t: Vector, y: Vector) -> list[Vector]:
        slots = self._read(expressions)
        points = Points(t, y[:, : self._states], accepted=True)
        columns = self._columns(slots, self._look.values(points, slots))
        return [self._value(e, columns, t.shape) for e in expressions]

    def stored(self, y: Vector) -> Vector:
        """Return the energy that is stored in states, rows of `y`, J."""
        return self._look.stored(y[:, : self._states])

    def own_stiffness(self) -> list[Expr]:
        """Return the derivative of each co-energy variable by what its storage itself stores."""
        ints = self._model.tables.ints
        first, other, law = (ints[name] for name in ("stiff_first", "stiff_other", "stiff_value"))
        rows = (range(first[k], first[k + 1]) for k in range(len(self.graph.storages)))
        return [
            self._expression(law[i], "stiff_constant", i)
            for k, row in enumerate(rows)
            for i in row
            if other[i] == k
        ]

    def _expression(self, law: int, constant: str, k: int) -> Expr:
        """Return an entry of the tables: an expression by its number, or a constant."""
        tables = self._model.tables
        return tables.values.all[law] if law >= 0 else Number(tables.floats[constant][k])

    def sources(self, segment: Segment) -> tuple[list[Expr], list[bool]] | None:
        """Return the sources of a linear mode, and which of their rates are asked for.

        None where bond variables are no matrix times what is known.
        """
        with self._lock:
            self._enter(segment)
            found = self._look.sources()
        if found is None:
            return None
        numbers, rated = found
        law = self._model.tables.ints["source_value"]
        values = [self._expression(law[k], "source_constant", k) for k in numbers.tolist()]
        return values, [bool(k) for k in rated.tolist()]

    def by_knowns(self, segment: Segment, known: Vector) -> Vector:
        """Return the bond variables that knowns make in a linear mode, shape (2 bonds, points).

        Parameters
        ----------
        known : array, shape (storages + 2 * sources, points)
            Co-energy variables, values of `sources`, their rates; or derivatives of all of these.
        """
        with self._lock:
            self._enter(segment)
            return self._look.by_knowns(known.T).T

    def left_ends(self, places: Sequence[int]) -> Vector:
        """Return when segments end, a moment earlier where that is at a kink: the left limits."""
        segments, which = self._trace.segments, np.array(places, dtype=np.intp)
        ends = np.array([segments[k].t[-1] for k in places])
        given = self._model.tables, self._trace, segments, which, ends, self._of_points
        return left_limits(*given)

    @property
    def bond_slots(self) -> NDArray[np.intp]:
        """The slots of bond variables: all efforts, then all flows."""
        return np.arange(self._slots.w.start, self._slots.w.stop)

    def bonds(self, segment: Segment, end: float | None = None) -> Vector:
        """Return bond variables at the accepted points, shape (2 bonds, points times modes).

        While machines slide each mode that is combined has its own. The last point may be another:
        that of a left limit.
        """
        slots = self.bond_slots
        t = segment.t if end is None else np.append(segment.t[:-1], end)
        _, values = self._parts(segment, t, slots)
        return np.ascontiguousarray(values.reshape(-1, len(slots)).T)

    def parts(self, segment: Segment, names_: Sequence[str], t: Vector) -> tuple[Vector, Vector]:
        """Return the share of each mode that a segment combines, and values in it by name.

        Returns
        -------
        shares : array, shape (times, parts)
            Where nothing is slid on there is one part.
        values : array, shape (times, parts, names)
        """
        return self._parts(segment, t, np.array([self._slots.index[n] for n in names_], np.intc))

    def _parts(self, segment: Segment, t: Vector, slots: NDArray[Any]) -> tuple[Vector, Vector]:
        steps, times = steps_around(segment, t)
        with self._lock:
            self._enter(segment)
            return self._look.parts(Within(steps, times), slots)

    def powers(self, segment: Segment, bonds: Sequence[int], t: Vector) -> Vector:
        """Return effort times flow of bonds at times of a segment, shape (bonds, times).

        While machines slide it is the mean of the products in the modes that are combined, which
        is not the product of the means.
        """
        names_ = [Name(f"{v}:{b}") for v in "ef" for b in bonds]
        if segment.sliding is None:
            values = np.array(self.of(segment, names_, t)).reshape(2, len(bonds), len(t))
            return np.asarray(values[0] * values[1])
        shares, read = self.parts(segment, [n.path for n in names_], t)
        efforts, flows = read[:, :, : len(bonds)], read[:, :, len(bonds) :]
        return np.asarray((shares[:, :, None] * efforts * flows).sum(axis=1).T)

    def energies(self, segment: Segment) -> Vector:
        """Return energy supplied and dissipated up to the accepted points, J, shape (points, 2)."""
        if segment.bonds is not None:
            return np.asarray(segment.y[:, -2:] - segment.y[0, -2:])
        steps, _ = steps_around(segment, segment.t)
        found = np.zeros((len(segment.t), 2))
        with self._lock:
            self._enter(segment)
            np.cumsum(self._look.energies(steps)[:, :2], axis=0, out=found[1:])
        return found

    def weight(self, segment: Segment, t: float, machine: int, state: int) -> float:
        """Return the part of the time that a machine spends in a state at a time."""
        if t > segment.t[-1]:
            return float(self.rest(segment, t)[1][machine] == state)
        steps, times = steps_around(segment, np.array([t]))
        with self._lock:
            self._enter(segment)
            shares, _ = self._look.parts(Within(steps, times), np.zeros(0, dtype=np.intc))
            return float(shares[0, self._look.modes()[:, machine] == state].sum())

    # -- the segment that is looked into

    @property
    def _energy(self) -> float:
        """The largest energy that the run has seen, J; what overflows is large enough."""
        return min(self._trace.energy, sys.float_info.max)

    @property
    def _states(self) -> int:
        return len(self.graph.storages) + len(self.graph.integrals)

    def _enter(self, segment: Segment) -> None:
        """Look into a segment; the last one is known."""
        if self._into is segment:
            return
        made = segment.combined if isinstance(segment.combined, Combination) else ALONE
        landed = [m.path in segment.landed for m in self.graph.machines]
        # into nothing, if that fails
        self._into = None
        self._look.into(
            float(segment.t[0]),
            list(segment.mode),
            landed=landed,
            surfaces=made.surfaces,
            product=made.product,
            modes=made.modes,
            energy=self._energy,
        )
        if own := roots_within(self._trace.roots, segment):
            self._look.follow([t for t, _ in own], [root for _, root in own])
        self._into = segment

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
        if isinstance(e, Name):
            return np.array(np.broadcast_to(columns[self._slots.index[e.path]], shape))
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
