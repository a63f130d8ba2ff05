"""Runs: each in a thread of its own, with progress, to be cancelled, kept for comparison."""

from __future__ import annotations

import threading
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from hybond.draw.doubts import doubt, doubted_from
from hybond.errors import HybondError, UsageError
from hybond.model.builder import Model
from hybond.model.parts import Value
from hybond.options import OPTIONS as KNOWN
from hybond.result import Result
from hybond.runs.ends import Until
from hybond.simulation import simulate
from hybond.studio.curves import MOST_PLOTTED, curve, strip

KEPT = 5
"""Finished runs that stay for comparison."""
PATIENCE = 5.0
"""Time after which a cancelled run that has not stopped is left behind, s."""
PICTURE = 0.25
"""Least time between two pictures of a run that goes on, s."""
SHARE = 0.1
"""Most of the time of a run that its pictures may take."""
OPTIONS = tuple(o.name for o in KNOWN.values() if o.part in ("method", "impacts", "surfaces"))
"""Options of a run that the page may give."""


@dataclass(slots=True)
class Running:
    """One run and how far it is."""

    number: int
    title: str
    until: Until
    revision: int
    result: Result | None = None
    error: HybondError | None = None
    cancelled: threading.Event = field(default_factory=threading.Event)
    done: threading.Event = field(default_factory=threading.Event)
    wanted: tuple[str, ...] = ()
    """Signals that are plotted while it goes on."""
    wide: int = 800
    parameters: Mapping[str, Value] = field(default_factory=dict)
    """Of this run alone, beside those of the model."""
    began: float = field(default_factory=time.monotonic)
    took: float = 0.0

    def summary(self) -> dict[str, Any]:
        """Return what the list of runs shows."""
        found: dict[str, Any] = {"run": self.number, "title": self.title, "took": self.took}
        found["own"] = bool(self.parameters)
        if self.result is not None:
            run = self.result
            found |= {
                "status": run.status,
                "tEnd": run.t_end,
                "tBegin": run.t_begin,
                "until": run.until,
                "events": len(run.events),
                "warnings": list(run.warnings),
                "method": run.method,
                "names": run.names,
                "machines": [
                    {"path": m.path, "states": list(m.states)} for m in run.graph.machines
                ],
                "plot": _plotted(run),
            }
            start = doubted_from(run)
            if start is not None:
                found["doubt"] = {"t": start, "said": doubt(run)}
        if self.error is not None:
            found["error"] = self.error.to_dict()
            found.setdefault("status", "error")
        return found


def _plotted(run: Result) -> list[str]:
    asked = run.graph.experiment.get("plot")
    names = [n for n in asked if isinstance(n, str)] if isinstance(asked, list | tuple) else []
    # the flow of a coil and its flux are one curve: the flow is what is looked at
    stored = {s.path for s in run.graph.storages}
    return names or [n for n in run.names if n not in stored][:3]


class Runs:
    """The runs of a session.

    Parameters
    ----------
    tell : callable
        Called from the thread of a run with messages for the page.
    """

    def __init__(self, tell: Callable[[dict[str, Any]], None]) -> None:
        self._tell = tell
        self._lock = threading.Lock()
        self._count = 0
        self.kept: dict[int, Running] = {}
        self.current: Running | None = None

    def start(
        self,
        model: Model,
        *,
        until: Until = None,
        options: Mapping[str, Any] | None = None,
        revision: int = 0,
        wanted: Sequence[str] = (),
        wide: int = 800,
        parameters: Mapping[str, Value] | None = None,
        title: str = "",
    ) -> Running:
        """Begin a run; what is running is cancelled. `wanted` is plotted while it goes on.

        Values of `parameters` are those of this run alone.

        Raises
        ------
        UsageError
            HB-W103 for an option that there is not.
        """
        given = dict(options or {})
        wrong = next((k for k in given if k not in OPTIONS), None)
        if wrong is not None:
            raise UsageError(
                f"a run has no option {wrong!r}",
                code="HB-W103",
                where=wrong or "options",
                hint=", ".join(OPTIONS),
            )
        self.cancel()
        with self._lock:
            self._count += 1
            title = title or model.title or model.name
            running = Running(
                *(self._count, title, until, revision),
                wanted=tuple(wanted[:MOST_PLOTTED]),
                wide=wide,
                parameters=dict(parameters or {}),
            )
            self.current = running
        thread = threading.Thread(
            target=self._run, args=(running, model, given), name="hybond-run", daemon=True
        )
        thread.start()
        return running

    def cancel(self) -> None:
        """Ask what is running to stop; what it computed is kept.

        One that does not answer is left behind: others begin, and nobody waits for it.
        """
        running = self.current
        if running is not None and not running.done.is_set() and not running.cancelled.is_set():
            running.cancelled.set()
            timer = threading.Timer(PATIENCE, self._leave, (running,))
            timer.daemon = True
            timer.start()

    def result(self, number: object) -> Result:
        """Return a finished run.

        Raises
        ------
        UsageError
            HB-W103 if there is none of this number.
        """
        running = self.kept.get(number) if isinstance(number, int) else None
        if running is None or running.result is None:
            raise UsageError(
                f"there is no run {number!r}", code="HB-W103", where="run", hint="run the model"
            )
        return running.result

    def _leave(self, running: Running) -> None:
        error = UsageError(
            f"the run did not stop within {PATIENCE:g} s of being cancelled, and is left behind",
            code="HB-W109",
            where="run",
            hint="edit and run on; end the studio if the processor stays busy",
        )
        self._finished(running, None, error)

    def _finished(self, running: Running, result: Result | None, error: HybondError | None) -> None:
        """Note how a run ended and tell it, once."""
        with self._lock:
            if running.done.is_set():
                return
            running.result, running.error = result, error
            running.took = time.monotonic() - running.began
            self.kept[running.number] = running
            for old in list(self.kept)[:-KEPT]:
                del self.kept[old]
            running.done.set()
        self._tell({"tell": "finished", **running.summary()})

    def _run(self, running: Running, model: Model, options: dict[str, Any]) -> None:
        due = told = running.began

        def watch(run: Result) -> None:
            nonlocal due, told
            if running.cancelled.is_set():
                raise KeyboardInterrupt
            now = time.monotonic()
            if now >= told:
                told = now + 0.05
                t, events = run.t_end, run.trace.events.total
                self._tell({"tell": "progress", "run": running.number, "t": t, "events": events})
            if now >= due + PICTURE and run.segments:
                self._tell({"tell": "partial", "run": running.number, **so_far(run, running)})
                after = time.monotonic()
                due = after + (after - now) / SHARE

        result: Result | None = None
        error: HybondError | None = None
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                result = simulate(
                    *(model, running.until),
                    parameters=running.parameters,
                    watch=watch,
                    on_error="return",
                    **options,
                )
            error = result.error
        except HybondError as refusal:
            error, result = refusal, refusal.partial
        except KeyboardInterrupt:
            error = UsageError(
                "the run was cancelled before it began",
                code="HB-W103",
                where="run",
                hint="run the model again",
            )
        except Exception as cause:  # a defect of ours: told as such, the studio goes on
            error = defect(cause, "run")
        self._finished(running, result, error)


def defect(cause: Exception, where: str) -> HybondError:
    """Return the refusal that tells of a defect of hybond."""
    return HybondError(
        f"{type(cause).__name__}: {cause}",
        code="HB-X001",
        where=where,
        hint="this is a defect of hybond: please report it with the model",
    )


def so_far(run: Result, running: Running) -> dict[str, Any]:
    """Return the curves and lanes of a run that goes on, over all of its time."""
    curves = []
    for name in running.wanted or _plotted(run):
        try:
            curves.append(curve(run, name, run.t_begin, run.t_end, running.wide))
        except HybondError as error:
            curves.append({"name": name, "error": error.to_dict()})
    lanes = strip(run, run.t_begin, run.t_end, running.wide)
    end = float(run.until)
    return {"curves": curves, "strip": lanes, "tBegin": run.t_begin, "tEnd": end}
