"""Runs: each in a thread of its own, with progress, to be cancelled, kept for comparison."""

from __future__ import annotations

import threading
import time
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from hybond.errors import HybondError, UsageError
from hybond.model.builder import Model
from hybond.result import Result
from hybond.simulation import simulate

KEPT = 5
"""Finished runs that stay for comparison."""
OPTIONS = ("solver", "rtol", "atol", "step", "max_step", "theta", "impact", "sliding", "hysteresis")
"""Options of a run that the page may give."""


@dataclass(slots=True)
class Running:
    """One run and how far it is."""

    number: int
    title: str
    until: float | str | None
    revision: int
    result: Result | None = None
    error: HybondError | None = None
    cancelled: threading.Event = field(default_factory=threading.Event)
    done: threading.Event = field(default_factory=threading.Event)
    t: float = 0.0
    events: int = 0
    took: float = 0.0

    def summary(self) -> dict[str, Any]:
        """Return what the list of runs shows."""
        found: dict[str, Any] = {"run": self.number, "title": self.title, "took": self.took}
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
        if self.error is not None:
            found["error"] = self.error.to_dict()
            found.setdefault("status", "error")
        return found


def _plotted(run: Result) -> list[str]:
    asked = run.graph.experiment.get("plot")
    names = [n for n in asked if isinstance(n, str)] if isinstance(asked, list | tuple) else []
    return names or run.names[:3]


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
        until: float | str | None = None,
        options: Mapping[str, Any] | None = None,
        revision: int = 0,
    ) -> Running:
        """Begin a run; what is running is cancelled.

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
                where=wrong,
                hint=", ".join(OPTIONS),
            )
        self.cancel()
        with self._lock:
            self._count += 1
            running = Running(self._count, model.title or model.name, until, revision)
            self.current = running
        thread = threading.Thread(
            target=self._run, args=(running, model, given), name="hybond-run", daemon=True
        )
        thread.start()
        return running

    def cancel(self) -> None:
        """Ask what is running to stop; what it computed is kept."""
        if self.current is not None and not self.current.done.is_set():
            self.current.cancelled.set()

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

    def _run(self, running: Running, model: Model, options: dict[str, Any]) -> None:
        begin = time.monotonic()
        due = begin

        def progress(t: float, events: int) -> None:
            nonlocal due
            running.t, running.events = t, events
            if running.cancelled.is_set():
                raise KeyboardInterrupt
            if time.monotonic() >= due:
                due = time.monotonic() + 0.05
                self._tell({"tell": "progress", "run": running.number, "t": t, "events": events})

        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                running.result = simulate(
                    model, running.until, progress=progress, on_error="return", **options
                )
            running.error = running.result.error
        except HybondError as error:
            running.error = error
            running.result = error.partial
        except KeyboardInterrupt:
            running.error = UsageError(
                "the run was cancelled before it began", code="HB-W103", where="run"
            )
        except Exception as error:  # a defect of ours: told as such, the studio goes on
            running.error = HybondError(
                f"{type(error).__name__}: {error}",
                code="HB-X001",
                where="run",
                hint="this is a defect of hybond: please report it with the model",
            )
        running.took = time.monotonic() - begin
        with self._lock:
            self.kept[running.number] = running
            for old in list(self.kept)[:-KEPT]:
                del self.kept[old]
        running.done.set()
        self._tell({"tell": "finished", **running.summary()})
