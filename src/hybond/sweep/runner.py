"""`Runner`: members of a job, by their numbers, in threads; tables are made once and kept."""

from __future__ import annotations

import copy
import threading
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.members import Ran
from hybond.engine.tables.options import Settings
from hybond.errors import HybondError, NumericsError, UsageError
from hybond.model.graph import FlatGraph
from hybond.model.parts import Value
from hybond.model.paths import with_parts
from hybond.sweep.asking import asked_of
from hybond.sweep.collect import Collector, collectors_of
from hybond.sweep.family import Family, family_of
from hybond.sweep.full_runs import write_run
from hybond.sweep.job import Job
from hybond.sweep.journeys import Journeys
from hybond.sweep.lifted import lifted
from hybond.sweep.member import Task
from hybond.sweep.part import Part
from hybond.sweep.reading import of_modes, read_run
from hybond.sweep.threads import in_threads

if TYPE_CHECKING:
    from hybond.result import Result
    from hybond.sweep.measured import Measure

Vector = NDArray[np.float64]
KEPT = 8
"""Families that are kept: members that are made of the same parts."""
Done = Callable[[int], object]


class Runner:
    """Runs members of a job.

    Parameters
    ----------
    job : Job
    workers : int
        Threads.
    runs : Path, optional
        Where full runs go.
    look : callable, optional
        Called now and then, in any thread, while members run; raises KeyboardInterrupt to stop.

    Raises
    ------
    HybondError
        For what is wrong with every member: a collector, a path, an option.
    """

    def __init__(
        self,
        job: Job,
        workers: int,
        runs: Path | None = None,
        *,
        look: Callable[[], object] | None = None,
    ) -> None:
        self.job, self.workers, self.runs, self._look = job, workers, runs, look
        self.graph, self.collectors = checked(job)
        self._numbers = [f for f in job.plan.factors if f.is_number]
        model, self._of = lifted(job.model, [*(f.path for f in self._numbers)])
        curves = [np.linspace(0.0, job.until, c.points) for c in self.collectors if c.points]
        single = [c.t for c in self.collectors if c.function == "at"]
        self._t = np.array(sorted({*single, *(t for row in curves for t in row.tolist())}))
        read = [c.signal for c in self.collectors if c.function in ("final", "at", "curve")]
        self._names = tuple(dict.fromkeys(read))
        self._modes = any(c.of_modes for c in self.collectors)
        early = bool(job.ends) or job.model.experiment.get("start") is not None
        self._measures = _told(self.collectors, job.until)
        whole = early or bool(job.runs) or None in self._measures
        task = Task(job.model, job.until, job.options, self._names, self._t, False)
        asked, self.alone = asked_of(task)
        self._asked: tuple[Settings, float | None] | None = None if whole else asked
        self._model = model
        self._families: dict[tuple[Value, ...], list[Family]] = {}
        self._wanted = self._names or ("time",)
        self._local = threading.local()

    def run(self, first: int, last: int, done: Done | None = None) -> Part:
        """Run the members from `first` to `last` - 1.

        Parameters
        ----------
        done : callable
            Called in this thread with how many more are done; may raise KeyboardInterrupt.
        """
        return self._run_rows(first, self.job.plan.rows(first, last), last - first, done)

    def _run_rows(self, first: int, rows: dict[str, Any], many: int, done: Done | None) -> Part:
        work = _Work(self, first, rows, many, done)
        rest = np.arange(many)
        if self._asked is not None:
            rest = self._together(work, rest)
        self._ordinary(work, rest.tolist())
        return work.part()

    def places(self, c: Collector) -> Any:
        """Return where the times of a collector are among those that are looked at."""
        if c.function == "at":
            return int(np.searchsorted(self._t, c.t))
        return np.searchsorted(self._t, np.linspace(0.0, self.job.until, c.points))

    @property
    def is_ordinary(self) -> bool:
        """Whether each member is an ordinary run."""
        return self._asked is None

    @property
    def looked(self) -> int:
        """How many values the library looks at of one member."""
        return len(self._names) * (len(self._t) + 1)

    def trial(self, members: Sequence[int]) -> Part:
        """Run some members; full runs are not kept."""
        rows = [self.job.plan.rows(k, k + 1) for k in members]
        joined: dict[str, Any] = {}
        for path in self.job.plan.paths:
            columns = [row[path] for row in rows]
            joined[path] = (
                [c[0] for c in columns] if isinstance(columns[0], list) else np.concatenate(columns)
            )
        runs, self.runs = self.runs, None
        try:
            return self._run_rows(0, joined, len(rows), None)
        finally:
            self.runs = runs

    # -- by the library

    def _together(self, work: _Work, rest: NDArray[np.intp]) -> NDArray[np.intp]:
        """Run the members that the library tells all of; return the others."""
        left = []
        for words, members in work.by_words(rest).items():
            families = self._families.setdefault(words, [])
            for family in list(families):
                members, more = self._of_family(family, work, members)
                left.append(more)
            while len(members):
                made = self._made(work, words, int(members[0]))
                if made is None:
                    left.append(members[:1])
                    members = members[1:]
                    continue
                self._families[words] = families = [*families[1 - KEPT :], made]
                before = len(members)
                members, more = self._of_family(made, work, members)
                left.append(more)
                if len(members) == before:
                    left.append(members[:1])
                    members = members[1:]
        return np.sort(np.concatenate(left)) if left else rest[:0]

    def _made(self, work: _Work, words: Sequence[Value], k: int) -> Family | None:
        assert self._asked is not None
        texts = dict(zip(work.words, words, strict=True))
        try:
            model, left = with_parts(self._model, {**self.job.fixed, **texts})
        except HybondError:
            return None
        own = {self._of[p]: float(column[k]) for p, column in work.numbers.items()}
        impact = self.job.options.get("impact")
        given = {**left, **own}
        measures = [m for m in self._measures if m is not None]
        return family_of(model, given, *self._asked, self._wanted, impact, measures)

    def _of_family(
        self, family: Family, work: _Work, members: NDArray[np.intp]
    ) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Run the members of a family; return those that are not, and those left to others."""
        given = {self._of[p]: column[members] for p, column in work.numbers.items()}
        fits, numbers, read = family.numbers(given, len(members))
        own, numbers, read = members[fits], numbers[fits], read[fits]
        if not len(own):
            return members, members[:0]
        left: list[NDArray[np.intp]] = []

        def keep(begin: int, ran: Ran) -> None:
            here = slice(begin, begin + len(ran.plain))
            plain = ran.plain
            values = family.values(ran.out[plain], read[here][plain])
            journeys = None
            if self._modes:
                stays = ran.stays[plain].astype(np.intp)
                journeys = Journeys(stays, ran.since, ran.mode, ran.end[plain])
            known = plain if ran.known is None else ran.known
            again = own[here][plain & ~known]
            members = own[here][plain]
            work.keep(members, values, ran.count[plain], ran.end[plain], journeys, len(again))
            if ran.measured is not None:
                work.measured(own[here][known], self._measures, ran.measured[:, known])
            if family.warnings:
                work.warned(members, family.warnings)
            left.append(own[here][~plain])
            left.append(again)

        def measure(begin: int, ran: Ran) -> Ran:
            found, known = family.measure(ran, read[begin : begin + len(ran.plain)])
            return replace(ran, kept=None, measured=found, known=known)

        workers = min(self.workers, len(own))
        in_threads(
            *(family.model, family.looked, self._t, numbers, workers, keep),
            modes=self._modes,
            look=self._look,
            measured=family.measured,
            measure=measure if self._measures else None,
        )
        return members[~fits], np.concatenate(left)

    # -- as ordinary runs

    def _ordinary(self, work: _Work, members: list[int]) -> None:
        if not members:
            return
        stopped = threading.Event()

        def look(*_: object) -> None:
            if stopped.is_set():
                raise KeyboardInterrupt
            if self._look is not None:
                self._look()

        def one(k: int) -> None:
            if not stopped.is_set():
                work.keep_run(k, self._run(work.set(k), look), stopped)

        if self.workers == 1 or len(members) == 1:
            for k in members:
                one(k)
                work.tell()
            return
        from concurrent.futures import ThreadPoolExecutor

        with ThreadPoolExecutor(self.workers) as pool:
            found = [pool.submit(one, k) for k in members]
            try:
                for future in found:
                    future.result()
                    work.tell()
            finally:
                stopped.set()
                for future in found:
                    future.cancel()

    def _run(self, given: dict[str, Value], look: Any) -> Result | HybondError:
        """Return a run, or why there is none; whatever it is, it ends no other."""
        from hybond.simulation import simulate

        if not hasattr(self._local, "model"):
            self._local.model = copy.deepcopy(self.job.model)  # each thread has tables of its own
        parameters = {**self.job.fixed, **given}
        options = {"progress": look, **self.job.options}
        try:
            return simulate(
                *(self._local.model, self.job.whole_until),
                **{"parameters": parameters, "on_error": "return", **options},
            )
        except HybondError as error:
            return error
        except Exception as error:
            return NumericsError(
                f"internal error: {type(error).__name__}: {error}",
                code="HB-X001",
                where="hybond",
                hint="this is a bug of hybond: please report it with the model file",
            )


class _Work:
    """What is kept of the members of one part, while they run."""

    def __init__(
        self, runner: Runner, first: int, rows: dict[str, Any], many: int, done: Done | None
    ) -> None:
        self.runner, self.first = runner, first
        self.numbers: dict[str, Vector] = {}
        self.words: dict[str, list[Value]] = {}
        for path, column in rows.items():
            if isinstance(column, np.ndarray):
                self.numbers[path] = column
            else:
                self.words[path] = column
        self._done, self._new = done, 0
        self.status = ["error"] * many
        self.t_end = np.zeros(many)
        self.said: dict[int, tuple[str, str, str, str]] = {}
        self.columns: dict[str, Any] = {c.text: _empty(c, many) for c in runner.collectors}
        self._lock = threading.Lock()

    def set(self, k: int) -> dict[str, Value]:
        """Return the parameters of a member."""
        found: dict[str, Value] = {p: float(column[k]) for p, column in self.numbers.items()}
        return found | {p: column[k] for p, column in self.words.items()}

    def by_words(self, members: NDArray[np.intp]) -> dict[tuple[Value, ...], NDArray[np.intp]]:
        """Return members by those of their values that are no numbers."""
        if not self.words:
            return {(): members}
        found: dict[tuple[Value, ...], list[int]] = {}
        for k in members.tolist():
            found.setdefault(tuple(c[k] for c in self.words.values()), []).append(k)
        return {words: np.array(own) for words, own in found.items()}

    def keep(
        self,
        members: NDArray[np.intp],
        values: Vector,
        count: NDArray[Any],
        end: Vector,
        journeys: Journeys | None,
        again: int = 0,
    ) -> None:
        """Keep what the library tells of members: values at times, then at the end.

        So many of them an ordinary run tells more of.
        """
        runner = self.runner
        for k in members.tolist():
            self.status[k] = "ok"
        self.t_end[members] = end
        for c in runner.collectors:
            column = self.columns[c.text]
            if c.measure is not None:
                continue
            if c.function in ("final", "at", "curve"):
                row = values[runner._names.index(c.signal)]
                column[members] = row[:, -1] if c.function == "final" else row[:, runner.places(c)]
            elif c.kind == "text":
                texts = ["time"] * len(members)
                if journeys is not None and c.function != "ended":
                    texts = of_modes(c, journeys, runner.graph)
                for k, text in zip(members.tolist(), texts, strict=True):
                    column[k] = text
            elif journeys is not None and c.of_modes:
                column[members] = of_modes(c, journeys, runner.graph)
            else:
                column[members] = count
        self._new += len(members) - again
        self.tell()

    def measured(
        self, members: NDArray[np.intp], measures: Sequence[Measure | None], values: Vector
    ) -> None:
        """Keep measurements, shape (measures, members)."""
        for measure, row in zip(measures, values, strict=True):
            assert measure is not None
            self.columns[measure.text][members] = row

    def keep_run(self, k: int, run: Result | HybondError, stopped: threading.Event) -> None:
        """Keep an ordinary run; called in any thread."""
        error = run if isinstance(run, HybondError) else run.error
        if not isinstance(run, HybondError):
            if run.status == "interrupted":
                if stopped.is_set():
                    return
                raise KeyboardInterrupt
            found, failed = read_run(
                run, self.runner.collectors, self.runner.graph, modes=self.runner._modes
            )
            error = error or failed
            for text, value in found.items():
                self.columns[text][k] = value
            self.status[k] = run.status
            self.t_end[k] = run.t_end
            if self.runner.runs is not None:
                write_run(run, self.runner.runs, self.first + k, self.runner.job.runs, self.set(k))
        elif "ended" in self.columns:
            self.columns["ended"][k] = "error"
        warned = "; ".join(run.warnings) if not isinstance(run, HybondError) else ""
        with self._lock:
            if error is not None:
                self.said[k] = (error.code, error.where, error.why, warned)
            elif warned:
                self.said[k] = ("", "", "", warned)
            self._new += 1

    def warned(self, members: NDArray[np.intp], warnings: Sequence[str]) -> None:
        """Note what the library says of all members of a family."""
        for k in members.tolist():
            self.said[k] = ("", "", "", "; ".join(warnings))

    def tell(self) -> None:
        """Say how many more are done."""
        with self._lock:
            new, self._new = self._new, 0
        if self._done is not None and new:
            self._done(new)

    def part(self) -> Part:
        """Return what was kept."""
        return Part(
            self.first, self.status, self.t_end, dict(sorted(self.said.items())), self.columns
        )


def _told(collectors: Sequence[Collector], until: float) -> list[Measure | None]:
    """Return what the library tells of measurements; None for what a run must be asked."""
    asked = [(c.measure, c.text) for c in collectors if c.measure is not None]
    if not asked:
        return []
    from hybond.sweep.measured import measure_of

    return [measure_of(measure, text, until) for measure, text in asked]


def checked(job: Job) -> tuple[FlatGraph, tuple[Collector, ...]]:
    """Return the flat graph of the first member, and the collectors.

    Raises
    ------
    HybondError
        For what is wrong with every member. What is wrong with the first alone is a row.
    """
    first = {}
    for factor in job.plan.factors:
        value = job.plan.rows(0, 1)[factor.path][0]
        first[factor.path] = factor.shown(float(value)) if factor.is_number else value
    model, left = with_parts(job.model, {**job.fixed, **first})
    try:
        graph = model.flatten(parameters=left)
    except HybondError as error:
        if error.code in ("HB-M107", "HB-U103") or error.code.startswith("HB-U"):
            raise
        graph = job.model.flatten(parameters=dict(job.fixed))
    found = collectors_of(graph, job.collect)
    for c in found:
        if c.function == "at" and c.t > job.until:
            raise UsageError(
                f"the runs go from 0 to {job.until:.9g} s, not to {c.t:g} s",
                code="HB-S110",
                where=c.text,
                hint="ask for a time within them",
            )
    return graph, found


def _empty(c: Collector, many: int) -> Any:
    match c.kind:
        case "text":
            return [""] * many
        case "curve":
            return np.full((many, c.points), np.nan)
        case _:
            return np.full(many, np.nan)
