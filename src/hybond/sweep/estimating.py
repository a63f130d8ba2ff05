"""`estimate`: the time and space that a sweep takes, told from a few of its members."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hybond.calls import called
from hybond.model.builder import Model
from hybond.runs.ends import Until
from hybond.sweep.full_runs import path_of, write_run
from hybond.sweep.plan import Plan
from hybond.sweep.runner import Runner
from hybond.sweep.sweeping import each_takes, job_of, part_size
from hybond.sweep.table import SweepTable
from hybond.sweep.threads import workers_of

if TYPE_CHECKING:
    from hybond.result import Result

PATIENCE = 1.0
"""How long members are tried, s."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """What a sweep takes, told from some of its members.

    Parameters
    ----------
    members, tried, failed : int
        How many there are, how many were run, how many of those failed.
    each : float
        Seconds that a member adds.
    threads, part : int
        Threads, and members that are written at once.
    parts, table, runs : float
        Bytes of the parts, of ``table.csv`` and of full runs.
    free : float
        Bytes that are free where the sweep goes; nan if that is not said.
    ordinary : str
        Why each member is an ordinary run, empty if the library runs them.
    """

    members: int
    tried: int
    failed: int
    each: float
    threads: int
    part: int
    parts: float
    table: float
    runs: float
    free: float
    ordinary: str

    @property
    def seconds(self) -> float:
        """How long all members take, s."""
        return self.each * self.members

    @property
    def space(self) -> float:
        """Bytes of everything."""
        return self.parts + self.table + self.runs

    def __str__(self) -> str:
        threads = f"{self.threads} thread{'s' * (self.threads != 1)}"
        lines = [
            f"{self.members} members, {self.tried} of them tried, {self.failed} of those failed",
            f"time   {time_text(self.seconds)} in {threads}, {self.each * 1e3:.3g} ms each",
            f"space  {size_text(self.space)}: parts {size_text(self.parts)}, table "
            f"{size_text(self.table)}"
            + (f", runs {size_text(self.runs)}" if self.runs else "")
            + ("" if self.free != self.free else f"; {size_text(self.free)} are free"),
            f"parts  of {self.part} members: what is lost at the most",
        ]
        if self.ordinary:
            lines.append(f"each member is an ordinary run: {self.ordinary}")
        if self.space > self.free:
            lines.append("there is not enough room")
        return "\n".join(lines)


@called('hb.sweep.estimate(model, plan, collect="final(ball.p)")')
def estimate(
    model: Model,
    plan: Plan | Mapping[str, Any],
    *,
    collect: str | Sequence[str],
    until: Until = None,
    parameters: Mapping[str, Any] | None = None,
    out: str | Path | None = None,
    runs: str = "",
    workers: int | None = None,
    **options: Any,
) -> Estimate:
    """Return what a sweep takes; arguments as `hybond.sweep.sweeping.sweep`. Nothing is kept.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical", parameters={"r": "1 kohm"})
    >>> m.add(c=hb.C("1 mF", e="10 V"), r1=hb.R("r"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r1")
    >>> found = estimate(m, {"r": "1:2:0.001"}, until="1 s", collect="final(c.e)")
    >>> found.members, found.failed, found.space > 1001*8
    (1001, 0, True)
    """
    job = job_of(model, plan, collect, until, parameters, runs, options)
    threads = workers_of(workers)
    runner = Runner(job, threads)
    each, part = each_takes(runner, PATIENCE)
    table = SweepTable(job, runner.collectors, [(0, len(part))], lambda a, b: part)
    members, tried = len(job.plan), len(part)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        table.to_csv(folder / "table.csv")
        head = len(",".join(table.columns))
        row = max((folder / "table.csv").stat().st_size - head, 1) / tried
        run = 0.0
        if job.runs:
            made: Result = table.run(0)
            write_run(made, folder, 0, job.runs, {})
            whole = path_of(folder, 0, job.runs)
            files = whole.rglob("*") if whole.is_dir() else [whole]
            run = float(sum(f.stat().st_size for f in files if f.is_file()))
    wide = 8 + sum(
        8 * c.points if c.points else 4 if c.kind == "text" else 8 for c in runner.collectors
    )
    said = sum(len("".join(words)) for words in part.said.values()) / tried
    free = float("nan")
    if out is not None:
        there = next(p for p in (Path(out), *Path(out).absolute().parents) if p.exists())
        free = float(shutil.disk_usage(there).free)
    why = ""
    if runner.is_ordinary:
        asked = [c.text for c in runner.collectors if c.measure is not None]
        why = runner.alone or (f"{asked[0]} measures all of it" if asked else "full runs are kept")
    return Estimate(
        *(members, tried, part.status.count("error"), each, threads, part_size(runner)),
        *((wide + 4 + said) * members, row * members, run * members, free, why),
    )


def size_text(size: float) -> str:
    """Return a number of bytes for people.

    Examples
    --------
    >>> size_text(12.0), size_text(3.2e6), size_text(4.1e12)
    ('12 B', '3.2 MB', '4.1 TB')
    """
    for unit in ("B", "kB", "MB", "GB"):
        if size < 1000.0:
            return f"{size:.3g} {unit}"
        size /= 1000.0
    return f"{size:.3g} TB"


def time_text(seconds: float) -> str:
    """Return a duration for people.

    Examples
    --------
    >>> time_text(0.04), time_text(90.0), time_text(1e4), time_text(1e6)
    ('under 1 s', '90 s', '2.8 h', '11.6 days')
    """
    if seconds < 1.0:
        return "under 1 s"
    if seconds < 120.0:
        return f"{seconds:.0f} s"
    if seconds < 7200.0:
        return f"{seconds / 60.0:.0f} min"
    return f"{seconds / 3600.0:.1f} h" if seconds < 172800.0 else f"{seconds / 86400.0:.1f} days"
