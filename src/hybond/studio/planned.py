"""Sweeps of a plan: in a thread, part after part, with what there is to be looked at meanwhile."""

from __future__ import annotations

import threading
import time
import warnings
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Any

from hybond.errors import HybondError
from hybond.model.builder import Model
from hybond.studio.plans import Wanted
from hybond.studio.runs import defect
from hybond.sweep.job import Job
from hybond.sweep.part import Part
from hybond.sweep.runner import Runner
from hybond.sweep.table import SweepTable
from hybond.sweep.threads import cores

PART = 0.3
"""What a part takes, s: as often there is more to see, and that much is lost by a cancel."""
LARGEST = 50_000
"""Members in one."""
TOLD = 0.1
"""Least time between two words on how far it is, s."""


@dataclass(slots=True)
class Planned:
    """A sweep that goes on, or has ended.

    Parameters
    ----------
    number, revision : int
        Its own; that of the text it was made of.
    wanted : Wanted
    job : Job
    runner : Runner
    parts : list of Part
        What is done, in order.
    """

    number: int
    revision: int
    wanted: Wanted
    job: Job
    runner: Runner
    parts: list[Part] = field(default_factory=list)
    cancelled: threading.Event = field(default_factory=threading.Event)
    done: int = 0
    state: str = "running"
    error: HybondError | None = None
    began: float = field(default_factory=time.monotonic)
    took: float = 0.0

    def table(self) -> SweepTable:
        """Return what is done as a table."""
        parts = {(p.first, p.last): p for p in list(self.parts)}
        return SweepTable(self.job, self.runner.collectors, list(parts), lambda a, b: parts[a, b])

    def told(self) -> dict[str, Any]:
        """Return how far it is, and what there is to be drawn."""
        kept = sum(len(p) for p in list(self.parts))
        took = self.took or time.monotonic() - self.began
        members = len(self.job.plan)
        left = took * (members - self.done) / self.done if self.done else None
        found: dict[str, Any] = {
            "plan": self.number,
            "state": self.state,
            "done": self.done,
            "kept": kept,
            "members": members,
            "took": took,
            "left": left if self.state == "running" else None,
        }
        if self.error is not None:
            found["error"] = self.error.to_dict()
        return found

    def about(self) -> dict[str, Any]:
        """Return what varies and what is collected."""
        table = self.table()
        factors = [
            {
                "path": f.path,
                "unit": table.unit(f.path),
                "number": f.is_number,
                "levels": [] if f.levels is None else [_level(v) for v in f.levels],
            }
            for f in self.job.plan.factors
        ]
        columns = [{"name": c.text, "unit": c.unit, "kind": c.kind} for c in self.runner.collectors]
        return {"way": self.job.plan.way, "factors": factors, "columns": columns}


def _level(value: Any) -> str:
    return value if isinstance(value, str) else f"{float(value):.6g}"


class Plans:
    """The sweeps of plans of a session, one at a time.

    Parameters
    ----------
    tell : callable
        Called from the thread of a sweep with messages for the page.
    """

    def __init__(self, tell: Callable[[dict[str, Any]], None]) -> None:
        self._tell = tell
        self._count = 0
        self.current: Planned | None = None

    def start(self, model: Model, wanted: Wanted, revision: int) -> Planned:
        """Begin a sweep; one that goes on is cancelled.

        Raises
        ------
        HybondError
            For what is wrong with the plan.
        """
        job = wanted.job(deepcopy(model))  # what is edited meanwhile is another model
        cancelled = threading.Event()

        def look() -> None:
            if cancelled.is_set():
                raise KeyboardInterrupt

        runner = Runner(job, cores(), look=look)
        self.cancel()
        self._count += 1
        planned = Planned(self._count, revision, wanted, job, runner, cancelled=cancelled)
        self.current = planned
        thread = threading.Thread(
            target=self._run, args=(planned, look), name="hybond-plan", daemon=True
        )
        thread.start()
        return planned

    def cancel(self) -> None:
        """Stop what runs; the parts that are done stay."""
        if self.current is not None:
            self.current.cancelled.set()

    def forget(self) -> None:
        """Stop what runs, and let go of it: it was of another model."""
        self.cancel()
        self.current = None

    def _run(self, planned: Planned, look: Callable[[], None]) -> None:
        due = 0.0

        def more(many: int) -> None:
            nonlocal due
            planned.done += many
            now = time.monotonic()
            if now >= due:
                due = now + TOLD
                self._tell({"tell": "planning", **planned.told()})
            look()

        state = "done"
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                _parts(planned, more)
        except KeyboardInterrupt:
            state = "cancelled"
        except HybondError as error:
            planned.error, state = error, "error"
        except Exception as cause:  # a defect of ours: told as such, the studio goes on
            planned.error, state = defect(cause, "sweep"), "error"
        planned.done = sum(len(p) for p in planned.parts)
        planned.took = time.monotonic() - planned.began
        planned.state = state
        self._tell({"tell": "planning", **planned.told()})


def _parts(planned: Planned, more: Callable[[int], None]) -> None:
    """Run all members, in parts that take about as long as a look at them may wait."""
    size, first, members = planned.runner.workers, 0, len(planned.job.plan)
    while first < members:
        last = min(first + size, members)
        began = time.perf_counter()
        planned.parts.append(planned.runner.run(first, last, more))
        took = time.perf_counter() - began
        grown = min(4.0, PART / max(took, 1e-9))
        size = int(min(max(size * grown, planned.runner.workers), LARGEST))
        first = last
