"""A run by an engine, from tables to a trace; what was computed is kept whatever happens."""

from __future__ import annotations

import math
import signal
import threading
import time
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from types import FrameType

import numpy as np
from numpy.typing import NDArray

from hybond.blocks.runners import Runner
from hybond.engine.compiled.refusal import Refusal
from hybond.engine.compiled.rows import Rows
from hybond.engine.compiled.sliced import ACCUMULATES, REFUSED
from hybond.engine.method_numbers import AUTO
from hybond.engine.methods.linear.flow_records import LARGE
from hybond.engine.outcome.beginnings import Beginning, not_of_this_model
from hybond.engine.outcome.engines import Prepared
from hybond.engine.outcome.explain import Explaining
from hybond.engine.outcome.journal import EventFile
from hybond.engine.outcome.records import BROKEN, CAUSES, Instants, Records
from hybond.engine.outcome.signals import Signals
from hybond.errors import HybondError
from hybond.runs.trace import Accumulation, Trace, Turn

LOOKED = 0.05
"""Seconds between two looks at the world outside: progress, and whoever wants it to stop."""
LATE = 2.0 * LOOKED
"""Seconds after which a slice that has not ended is looked into: one step may be long."""
FIRST = 100
"""Steps of the first slice, so that a short run is one slice or two; where somebody is told of
progress the first has one step. Each may be longer than the one before by GROWS."""
GROWS = 8.0
MOST = 1_000_000
BYTES = 56
"""Those of a step for each state."""
LARGEST = 1 << 22
"""Bytes of the steps of a slice: the engine writes each slice into the same memory, which caches
hold, and allocators keep what is smaller for the next run; they return what is larger."""
TOLD = 4
"""Changes of method that are told one by one."""
STUCK = (
    "",
    "if the guards chatter, give them a hysteresis, or run with sliding = 'hysteresis'",
    "no time passes between them",
)
"""What to say of events that accumulate: impacts, other events of a machine, any events."""
CONTACTS = (
    "contacts that strike in turn come to rest there: solver moreau-jean goes on through it, and "
    "so does this run if one of them has a stiffness"
)
"""What to say of contacts without a rebound."""


class EngineRun:
    """One run by an engine; `trace` holds what it did.

    Parameters
    ----------
    runners : mapping
        What runs each block, by its path.
    begin : Beginning
        Where it begins, if not where the model says.
    until : float
        When it ends, s, if before the time that its tables have.
    shown : Prepared
        The model without the machine that ends the run.
    explain : Explaining
        The words of the model, for who makes many runs of it.
    """

    def __init__(
        self,
        model: Prepared,
        *,
        progress: Callable[[float, int], object] | None = None,
        keep: int | None = None,
        journal: EventFile | None = None,
        runners: Mapping[str, Runner] | None = None,
        begin: Beginning | None = None,
        until: float | None = None,
        shown: Prepared | None = None,
        explain: Explaining | None = None,
    ) -> None:
        self.tables = model.tables
        self.trace = Trace()
        if begin is not None:
            self.trace.begin = begin.t
        self.records = Records(model.tables, self.trace, begin, explain)
        self.progress = progress
        self.keep = keep
        self.journal = journal
        states = model.tables.numbers["storages"] + model.tables.numbers["integrals"]
        most = min(LARGEST / (BYTES * (states + 1.0)) + 1.0, model.tables.numbers["max_steps"])
        self._most = int(max(min(most, MOST), 1))
        self._slice = 1 if progress is not None else min(FIRST, self._most)
        self._events = 0
        self._since = 0
        """Steps since the last event, ..."""
        self._last = self.trace.begin if begin is not None else 0.0
        """... and when that was."""
        self._run = model.run(runners)
        self._end = float(model.tables.numbers["until"]) if until is None else until
        if begin is not None:
            try:
                self._run.begin_from(
                    begin.number, begin.place, way=begin.way, until=self._end, deep=begin.deep
                )
            except ValueError as error:
                raise not_of_this_model(str(error)) from None
        self.trace.signals = Signals(shown or model, self.trace)

    def run(self) -> str:
        """Run to the end; return ``"ok"`` or ``"accumulation"``.

        Raises
        ------
        HybondError
            What stopped the run. `trace` is complete up to there.
        KeyboardInterrupt
            Likewise.
        """
        try:
            with _interrupts() as answer:
                self._go(answer)
        finally:
            self._run.onlooker.asked = None
            self.records.close()
            self._count()
            self._tidy()
            if self.journal is not None:
                self.journal.close()
        if self._run.status == REFUSED:
            raise self._error()
        self.trace.carried = self._run.carried()
        ends = self.tables.graph.ends
        if ends >= 0 and self._run.mode[ends] != 0:
            rules = self.tables.graph.machines[ends].rules
            self.trace.ended_by = rules[self._run.mode[ends] - 1].text
        if self._run.status == ACCUMULATES:
            self._note_stuck()
            return "accumulation"
        return "ok"

    def begin(self) -> None:
        """Settle the start, and go on no further than that takes.

        Raises
        ------
        HybondError
            What stopped it there. The run can do nothing else any more.
        """
        rows = next(self._run.slices(steps=1))
        self.records.add(rows)
        self.records.close()
        if not self.trace.events:
            raise self._error()

    def begun(self) -> NDArray[np.float64]:
        """Return the state that the start is settled to, as `begin` would, and tell nothing of it.

        Raises
        ------
        HybondError
            What stopped it there.
        """
        rows = next(self._run.slices(steps=1))
        if not len(rows.instant_time) or rows.instant_place[0, 0] >= BROKEN:
            self.records.add(rows)
            raise self._error()
        after: NDArray[np.float64] = rows.instant_state[0, 1]
        return after

    def tried(self, mode: Sequence[int]) -> NDArray[np.intc]:
        """Enter a mode at the start of a run that has not begun: of each rule whether it leaves it.

        Raises
        ------
        HybondError
            If it cannot be entered, or a guard has no truth there.
        """
        found = self._run.tried(mode)
        if found is None:
            raise self._error()
        return found

    def so_far(self) -> AbstractContextManager[None]:
        """Have all that was computed in `trace`, as long as one looks at it between two slices."""
        return self.records.so_far()

    def _go(self, answer: Callable[[], None]) -> None:
        """Run in slices about as long as whoever looks on waits."""
        begin = looked = time.perf_counter()

        def look() -> None:
            nonlocal looked
            if time.perf_counter() - looked >= LATE:
                if self.progress is not None:
                    self.progress(self._run.t, self.trace.events.total)
                answer()
                looked = time.perf_counter()

        self._run.onlooker.asked = look
        for rows in self._run.slices(steps=self._next):
            took = time.perf_counter() - begin
            fits = self._slice * LOOKED / max(took, 1e-6)
            self._slice = int(
                min(max(fits, 0.25 * self._slice, 1.0), GROWS * self._slice, self._most)
            )
            instants = self.records.add(rows)
            if self.journal is not None and instants is not None:
                _write(self.journal, instants)
            self._tidy()
            self._bound(rows)
            if self.progress is not None:
                self.progress(self._run.t, self.trace.events.total)
            answer()
            begin = looked = time.perf_counter()

    def _tidy(self) -> None:
        """Let go of what need not be kept, in large pieces."""
        if self.journal is not None:
            self.journal.flush()
        if self.keep is None:
            return
        for record in (self.trace.events, self.trace.segments):
            if len(record) > 2 * self.keep:
                record.forget(len(record) - self.keep)
        roots = self.trace.roots
        if roots and self.trace.segments:
            del roots[: bisect_right(roots, self.trace.segments.times[0], key=lambda r: r[0]) - 1]

    def _next(self) -> int:
        """Return how long the next slice is: a run ends at its limit, however long slices take."""
        left = int(self.tables.numbers["max_steps"]) + 1 - self._since
        return min(self._slice, max(left, 1)) if self.keep is None else self._slice

    def _bound(self, rows: Rows) -> None:
        """Refuse more steps without an event than are to be recorded, clocks among them or none.

        The engine counts anew where signals are sampled, and needs no memory for what it has done.
        """
        events = self.trace.events
        ends = rows.step_time[:, 2]
        if events.total != self._events:
            self._events, self._since, self._last = events.total, 0, events[-1].t
            ends = ends[ends > self._last]
        self._since += len(ends)
        if self.keep is None and self._since > self.tables.numbers["max_steps"]:
            t = self._run.t
            mean = (t - self._last) / self._since
            raise self._refused(Refusal("HB-N409", "", "", t, (mean,)))

    def _is_large(self) -> bool:
        """Whether ``auto`` leaves all modes to steps, since states are many."""
        states = len(self.tables.graph.storages) + len(self.tables.graph.integrals)
        return int(self.tables.numbers["method"]) == AUTO and states > LARGE

    def _count(self) -> None:
        run = self._run
        self.trace.energy = max(self.trace.energy, run.energy)
        self.trace.stats.update(
            steps=float(self.records.steps),
            rejected=float(run.rejected),
            events=float(self.trace.events.total),
            evaluations=float(run.evaluations),
            modes=float(run.modes_made),
        )
        if self.records.in_steps:
            del self.trace.stats["rejected"], self.trace.stats["events"]
            self.trace.stats["energy_unbalanced"] = self.records.unbalanced
        found = run.propagated
        if found:
            self.trace.stats["propagated"] = float(found[0])
            left = [*zip(self._why, found[1:], strict=True)]
            self.trace.method = _method(left, found[0], self.trace.turns, self._is_large())
        if self.trace.turns:
            self.trace.stats["turns"] = float(len(self.trace.turns))

    @property
    def _why(self) -> list[str]:
        return [*self.tables.reasons, "motion along a surface"]

    def _note_stuck(self) -> None:
        number, count, why, t, ratio = self._run.stuck
        graph = self.tables.graph
        if number >= 0:
            machine = graph.machines[number].path
        else:
            fired = [f.machine for step in self.trace.events[-1].steps for f in step.fired]
            machine = fired[0] if fired else graph.machines[0].path
        self.trace.accumulations.append(
            Accumulation(t, None if math.isnan(ratio) else ratio, count, machine)
        )
        shrinking = "" if math.isnan(ratio) else f", intervals shrinking by {ratio:.6g}"
        unrest = self._run.unrest
        no_solution = self._refused(unrest).why if unrest.code else ""
        rest = f"{machine} cannot rest: {self.records.warnings.why_no_rest(no_solution)}"
        law = graph.machines[number].law if number >= 0 else None
        reason = STUCK[why] or rest
        if why == 1 and law is not None and law.gap is not None:
            reason = CONTACTS
        self.trace.warn(
            f"events of {machine} accumulate at t = {t:.9g} s{shrinking}: the run stops there; "
            f"{reason}"
        )

    def _error(self) -> HybondError:
        refusal = self._run.fault
        return self._refused(refusal)

    def _refused(self, refusal: Refusal) -> HybondError:
        # only who is refused needs the words for it
        from hybond.engine.outcome.faults import Fault, error_of

        numbers = self.tables.numbers
        limits = {name: numbers[name] for name in ("max_writes", "max_events", "max_steps")}
        limits["until"] = self._end
        fault = Fault(refusal, self._run.mode, limits, int(numbers["method"]))
        records = self.records
        return error_of(
            fault, self.tables.graph, records.explain, records.broken, self.trace.events
        )


def _method(left: list[tuple[str, int]], many: int, turns: Sequence[Turn], large: bool) -> str:
    """Return how many modes were propagated exactly, why not more, and who had the others."""
    texts = [f"{_modes(many)} propagated exactly"] if many or not any(n for _, n in left) else []
    if large and not many:
        texts = [f"all modes by steps of rk45: more than {LARGE} states"]
    texts += [f"{_modes(n)} by steps of rk45: {why}" for why, n in sorted(left) if n]
    if turns:
        texts.append(f"stiff: {', '.join(map(str, turns[:TOLD]))}")
        if len(turns) > TOLD:
            texts[-1] += f" and {len(turns) - TOLD} more changes"
    return "; ".join(texts)


def _modes(n: int) -> str:
    return f"{n} mode{'' if n == 1 else 's'}"


def _write(journal: EventFile, found: Instants) -> None:
    """Write the events of a slice."""
    rows = found.rows
    for k, t in enumerate(rows.instant_time[:, 0].tolist()):
        cause = CAUSES.get(int(rows.instant_place[k, 0]))
        if cause is not None:
            mode = tuple(found.states[k].tolist())[: len(journal.graph.machines)]
            journal.row(t, cause, mode, rows.instant_state[k, 1].tolist())


@contextmanager
def _interrupts() -> Iterator[Callable[[], None]]:
    """Note Ctrl-C where it would be raised while rows could be lost; what is yielded answers it.

    A second one is answered at once. Whoever has a handler of his own keeps it.
    """
    noted: list[int] = []
    try:
        here = threading.current_thread() is threading.main_thread()
        before = signal.getsignal(signal.SIGINT) if here else None
    except ValueError:
        before = None
    if not callable(before):
        yield lambda: None
        return
    handler = before

    def note(number: int, frame: FrameType | None) -> None:
        if noted:
            handler(number, frame)
        noted.append(number)

    def answer() -> None:
        if noted:
            noted.clear()
            handler(signal.SIGINT, None)

    signal.signal(signal.SIGINT, note)
    try:
        yield answer
    finally:
        signal.signal(signal.SIGINT, before)
