"""Values of a finished run by the engine as it stands, in this interpreter."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from hybond.engine.compiled.answering import Calls
from hybond.engine.compiled.look import Look, Motion, Motions
from hybond.engine.compiled.points import Numbers, Points, Vector, Within
from hybond.engine.engine import OK, make_engine
from hybond.engine.interpreted.run import PythonModel
from hybond.engine.looking.energies import look_energies, look_powers, make_meter
from hybond.engine.looking.known import look_by_knowns, look_sources, look_stored
from hybond.engine.looking.look import (
    ask_for,
    look_from,
    look_into,
    look_parts,
    look_values,
    make_look,
    parts_of,
    points_at,
    points_within,
)
from hybond.errors import NumericsError


class PythonLook(Look):
    """Looks into the motion of finished runs of a model, by the engine in Python."""

    def __init__(self, model: PythonModel) -> None:
        super().__init__(model.tables)
        self.model = model
        self._record = model.record
        self._calls = Calls(model.tables, looking=True) if model.record.called else None
        self._motion: Motion | None = None
        self._begin()

    def _begin(self) -> None:
        self._engine = make_engine(self._record)
        if self._calls is not None:
            self._engine.calls.answers = self._calls
        self._own = make_look(self._engine)
        self._meter = make_meter()
        self._broken = False

    def _enter(self, motion: Motion) -> int:
        m, self._motion = motion, motion
        if self._broken:
            self._begin()
        self._check(
            *(look_into, m.t, m.state.tolist(), m.landed.tolist()),
            *(len(m.surfaces), m.surfaces.tolist(), int(m.product)),
            *(len(m.modes), m.modes.ravel().tolist(), m.energy),
        )
        return self._engine.slide.parts

    def _follow(self, when: Vector, roots: Vector) -> None:
        many, wide = roots.shape
        given = many, wide, when.tolist(), roots.ravel().tolist()
        look_from(self._engine, *given)

    def _modes(self) -> Numbers:
        machines = self._record.machines
        found = [0] * (self._parts * machines)
        parts_of(self._engine, found)
        return np.array(found, dtype=np.intc).reshape(self._parts, machines)

    def _ask(
        self,
        what: str,
        points: Points | Within,
        first: int,
        last: int,
        outs: tuple[Vector, ...],
        slots: Numbers | None,
        end: Vector | None,
    ) -> None:
        if self._broken and self._motion is not None:
            self._enter(self._motion)
        self._take(points, first, last)
        if slots is not None:
            ask_for(self._own, len(slots), slots.tolist())
        found = [[0.0] * out.size for out in outs]
        if what == "values":
            self._check(look_values, *found)
        elif what == "parts":
            self._check(look_parts, *found)
        elif what == "powers":
            self._check(look_powers, self._meter, *found)
        else:
            assert end is not None
            self._check(look_energies, self._meter, end.tolist(), *found)
        for out, row in zip(outs, found, strict=True):
            out[...] = np.array(row).reshape(out.shape)

    def _along(
        self,
        what: str,
        motions: Motions,
        points: Within,
        out: Vector,
        slots: Numbers | None,
        end: Vector | None,
    ) -> None:
        m, nothing = motions, np.zeros(0, dtype=np.intc)
        for k, (a, b) in enumerate(pairwise(m.first.tolist())):
            rows = np.zeros((0, m.state.shape[1]), dtype=np.intc)
            motion = Motion(float(m.t[k]), m.state[k], m.landed[k], nothing, False, rows, m.energy)
            self._enter(motion)
            if b > a:
                to = None if end is None else end[a:b]
                self._ask(what, points, a, b, (out[a:b],), slots, to)

    def _stored(self, y: Vector) -> Vector:
        out = [0.0] * len(y)
        look_stored(self._engine, self._own, len(y), y.ravel().tolist(), out)
        return np.array(out)

    def _sources(self) -> tuple[Numbers, Numbers] | None:
        source, rated = ([0] * self._record.most_sources for _ in range(2))
        many = look_sources(self._engine, source, rated)
        if many < 0:
            return None
        return np.array(source[:many], dtype=np.intc), np.array(rated[:many], dtype=np.intc)

    def _by_knowns(self, known: Vector) -> Vector:
        out = [0.0] * (len(known) * 2 * self._record.bonds)
        look_by_knowns(self._engine, len(known), known.ravel().tolist(), out)
        return np.array(out).reshape(len(known), 2 * self._record.bonds)

    def _take(self, points: Points | Within, first: int, last: int) -> None:
        """Hand over points, and of steps those in which they lie."""
        t = points.t[first:last].tolist()
        if isinstance(points, Points):
            y, accepted = points.y[first:last], points.accepted[first:last]
            points_at(self._own, len(t), t, y.ravel().tolist(), accepted.tolist())
            return
        which, step = np.unique(points.step[first:last], return_inverse=True)
        steps = points.steps
        rows = (a[which].ravel().tolist() for a in (steps.time, steps.state, steps.dense))
        points_within(self._own, len(t), t, step.tolist(), *rows)

    def _check(self, look: Any, *given: Any) -> None:
        """Look; refuse what the engine does.

        What an input raises, or a user, leaves an engine that is half way: the next look has one of
        its own.
        """
        self._broken = True
        status = look(self._engine, self._own, *given)
        self._broken = False
        if status == OK:
            return
        fault = self._engine.fault
        why = f"{fault.why}, at t = {self._engine.t:.9g} s"
        hint = "look at the values just before: what is asked for has none there"
        raise NumericsError(why, code=fault.code, where=fault.place, hint=hint)
