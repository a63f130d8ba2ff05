"""Values of the parameter, run in threads, or in order where each goes on from the one before."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.sections import Carry, Cut, Looks, NativeSections
from hybond.engine.tables.options import settings_of
from hybond.errors import HybondError
from hybond.model.graph import Mode
from hybond.sweep.asking import asked_of
from hybond.sweep.bifurcation.orbits import Word, words_of
from hybond.sweep.bifurcation.ordinary import Read, ordinary
from hybond.sweep.bifurcation.question import Question, check_period
from hybond.sweep.family import Family, family_of
from hybond.sweep.member import Task
from hybond.sweep.threads import spread

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class Point:
    """What came of a value.

    Parameters
    ----------
    samples : array, shape (signals, samples)
    when : array, shape (samples,)
        When they were taken, s.
    words : tuple of Word
        The modes from each sample to the next.
    carry : Carry or None
        Where the run has come.
    warnings : tuple of str
    error : HybondError or None
    """

    samples: Vector
    when: Vector
    words: tuple[Word, ...]
    carry: Carry | None
    warnings: tuple[str, ...]
    error: HybondError | None


@dataclass(frozen=True, eq=False, slots=True)
class _Lot:
    """Values of a family, ready to be run in one thread."""

    family: Family
    native: NativeSections
    fits: NDArray[np.bool_]
    numbers: Vector
    read: Vector
    period: Vector


class Values:
    """Runs values of a question.

    Raises
    ------
    HybondError
        For what is wrong with every value.
    """

    def __init__(self, question: Question) -> None:
        self.question = q = question
        self.modes: list[Mode] = []
        """Modes by their numbers in words."""
        self._numbers: dict[bytes, int] = {}
        graph = q.graph(float(q.values[0]))
        ends = [q.duration(q.graph(float(v))) for v in (q.values[0], q.values[-1])]
        span = max(ends) if q.at else (q.cut.settle + q.cut.keep) * max(ends)
        options = {k: v for k, v in q.options.items() if k not in ("engine", "keep", "fmus")}
        self._settings, self._band = settings_of(graph.experiment, span, **options)
        task = Task(q.model, span, q.options, q.of, np.zeros(0), False)
        self._asked, _ = asked_of(task)
        self._family = self._family_of(float(q.values[0]))
        self.machines = graph.machines
        self.ordinary = 0
        """Values that were ordinary runs."""

    def fresh(self, values: Vector, workers: int, keep: Callable[[int, list[Point]], None]) -> None:
        """Run values from the start of the model, each alone, in threads.

        Raises
        ------
        KeyboardInterrupt
        """
        spread(len(values), workers, lambda stop: self._doing(values, stop, False, None), keep)

    def carried(
        self,
        values: Vector,
        keep: Callable[[int, list[Point]], None],
        carry: Carry | None = None,
        settle: int | None = None,
    ) -> None:
        """Run values in order, each from where the one before has come.

        Raises
        ------
        KeyboardInterrupt
        """
        spread(len(values), 1, lambda stop: self._doing(values, stop, True, carry, settle), keep)

    def _doing(
        self,
        values: Vector,
        stop: ctypes.c_int,
        carries: bool,
        carry: Carry | None,
        settle: int | None = None,
    ) -> Callable[[range], list[Point]]:
        """Return what runs the values of a part; parts come in order where each goes on."""
        q = self.question
        cut = q.cut if settle is None else replace(q.cut, settle=settle)
        all_of_them = self._lot(self._family, values, cut, stop)
        last = [carry]

        def one(k: int) -> Point:
            self.ordinary += 1
            found = ordinary(q, float(values[k]), last[0], self._settings, self._band, cut.settle)
            if carries:
                # after a run that has stopped the next one begins as the model does
                last[0] = found.carry
            return self._point_of(found)

        def several(lot: _Lot, first: int, k: int, to: int) -> tuple[list[Point], int]:
            """Run values from k to before `to`, of a lot that begins with `first`."""
            here = slice(k - first, to - first)
            looks = lot.native.looks(
                lot.numbers[here], lot.period[here], carries=carries, carry=last[0]
            )
            points = []
            for j, point in enumerate(self._points(lot, looks, lot.read[here])):
                if point is None:
                    points.append(one(k + j))
                    continue
                points.append(point)
                last[0] = point.carry if carries else None
            return points, len(looks.plain)

        def do(part: range) -> list[Point]:
            points: list[Point] = []
            k = part.start
            while k < part.stop and not stop.value:
                lot, first, to = all_of_them, 0, k
                while lot is not None and to < part.stop and lot.fits[to]:
                    to += 1
                if to == k:
                    # other parts of a model: tables of its own
                    family = self._family_of(float(values[k]))
                    lot, first, to = self._lot(family, values[k : k + 1], cut, stop), k, k + 1
                if lot is None or not lot.fits[k - first]:
                    points.append(one(k))
                    k += 1
                    continue
                found, many = several(lot, first, k, to)
                points += found
                k += many
            return points

        return do

    def _family_of(self, value: float) -> Family | None:
        """Return the model of a value with slots; None where only an ordinary run tells of it."""
        q = self.question
        if self._asked is None:
            return None
        wanted = (*q.of, q.period) if q.period else q.of
        return family_of(q.model, q.set(value), *self._asked, wanted, q.options.get("impact"))

    def _lot(
        self, family: Family | None, values: Vector, cut: Cut, stop: ctypes.c_int
    ) -> _Lot | None:
        if family is None:
            return None
        q, period = self.question, np.full(len(values), self.question.limit)
        given = {q.path: np.ascontiguousarray(values, dtype=float)}
        fits, numbers, read = family.numbers(given, len(values))
        if q.period:
            found = family.constant(len(q.of), read)
            if found is None:
                return None
            period = found
            for value in period[fits].tolist():
                check_period(value, q.period)
        native = NativeSections(family.model, family.looked, cut, stop)
        return _Lot(family, native, fits, numbers, read, period)

    def _points(self, lot: _Lot, looks: Looks, read: Vector) -> list[Point | None]:
        many = len(looks.plain)
        values = lot.family.values(looks.out, read[:many])[: len(self.question.of)]
        ends = np.cumsum(looks.stays)
        points: list[Point | None] = []
        for k in range(many):
            if not looks.plain[k]:
                points.append(None)
                continue
            n = int(looks.found[k])
            rows = slice(int(ends[k] - looks.stays[k]), int(ends[k]))
            modes = [self._number(row) for row in looks.mode[rows]]
            words = words_of(looks.when[k, : n + 1], looks.since[rows], modes) if n else ()
            when = looks.when[k, :n].copy()
            samples = values[:, k, :n].copy()
            said = lot.family.warnings
            points.append(Point(samples, when, words, looks.carry(k), said, None))
        return points

    def _point_of(self, found: Read) -> Point:
        modes = [self._number(np.array(mode, dtype=np.intc)) for mode in found.modes]
        n = found.samples.shape[1]
        words = words_of(found.when, found.since, modes) if n else ()
        return Point(found.samples, found.when[:n], words, found.carry, found.warnings, found.error)

    def _number(self, mode: NDArray[np.intc]) -> int:
        key = mode.tobytes()
        number = self._numbers.get(key)
        if number is None:
            number = self._numbers.setdefault(key, len(self._numbers))
            while len(self.modes) <= number:
                self.modes.append(())
            self.modes[number] = cast(Mode, tuple(mode.tolist()))
        return number

    def word_text(self, words: Sequence[Word]) -> str:
        """Return the modes of a turn in words, samples apart by bars."""
        names = [
            ", ".join(m.states[k] for m, k in zip(self.machines, mode, strict=True))
            for mode in self.modes
        ]
        return " | ".join(" > ".join(names[m] for m in word) for word in words)
