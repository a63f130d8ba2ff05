"""`sweep`: all members of a plan, here or on a cluster; what is done is kept whatever happens."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from hybond.errors import UsageError
from hybond.model.builder import Model
from hybond.progress import Asked, shown
from hybond.runs.ends import Until, ends_of
from hybond.runs.times import end_of
from hybond.sweep.asking import check_options
from hybond.sweep.folder import Folder, told
from hybond.sweep.full_runs import check_form
from hybond.sweep.job import Job, key_of
from hybond.sweep.parquet import has_parquet
from hybond.sweep.part import Part
from hybond.sweep.plan import Plan
from hybond.sweep.runner import Runner
from hybond.sweep.table import SweepTable
from hybond.sweep.threads import workers_of

GOAL = 2.0
"""What a part of a sweep takes, s: what is lost at the most when somebody dies."""
LARGEST = 100_000
"""Members in one."""
ROOM = 64e6
"""Bytes that are looked at of one."""
TRIED = 0.004
"""How long members are tried to see how long they take, s."""
LONG = 1.0
"""A member that takes so long is tried once, s; beside it, tables take no time."""
Range = tuple[int, int]


def sweep(
    model: Model,
    plan: Plan | Mapping[str, Any],
    *,
    collect: str | Sequence[str],
    until: Until = None,
    parameters: Mapping[str, Any] | None = None,
    out: str | Path | None = None,
    runs: str = "",
    workers: int | None = None,
    executor: Any = None,
    part: int | None = None,
    progress: Asked = None,
    **options: Any,
) -> SweepTable:
    """Run all members of a plan, and collect a row of each.

    Members are rows of numbers in the same tables, run by threads of the library; what they need
    more than that (a measurement of the whole run, a warning, a surface that is slid on) is an
    ordinary run. What comes out does not depend on threads, machines or interruptions, not in a
    bit.

    Parameters
    ----------
    model : Model
    plan : Plan or mapping
        A mapping is a grid.
    collect : str or sequence of str
        What is collected: ``"final(ball.p), max(contact.e), count(events)"``; see
        `hybond.sweep.collect.COLLECTORS` and `hybond.measures.asked.FUNCTIONS`.
    until : float, str or list
        What ends members, as for `hybond.simulate`: a time, or conditions and a time; default: what
        the experiment says.
    parameters : mapping
        Of `hybond.simulate`, the same for all members.
    out : str or Path
        A folder. Parts of the sweep are written there as they are done, and ``table.csv`` (with
        pyarrow ``table.parquet``) at the end. The same call again goes on where it was. Without
        one all is kept in memory.
    runs : {"", "netcdf", "zarr"}
        Whether full runs are kept as well, in ``out/runs``, a file for each member.
    workers : int
        Threads, one for each core by default.
    executor : str, distributed.Client or concurrent.futures.Executor
        Where members run: the address of a scheduler of Dask (``"tcp://127.0.0.1:8786"``), a
        client of one, or any executor. Parts go there as a model file and numbers; lost ones are
        run again.
    part : int
        Members that are written at once, what is lost at the most when somebody dies; by default
        as many as run in two seconds. A folder that is there has its own.
    progress : bool, bar of tqdm or callable
        As for `hybond.ensemble`.
    **options
        Of `hybond.simulate`, for all members: ``solver``, ``rtol``, ...

    Returns
    -------
    SweepTable
        After Ctrl-C with the members that are done; `interrupted` says so.

    Raises
    ------
    UsageError
        HB-P101 to HB-P104 for plans and collectors that mean nothing, HB-P105 to HB-P107 for a
        folder that is in use, cannot be written or holds another sweep, HB-P108 for a form that
        there is not, HB-P110 and HB-P111 for a cluster that is not there or dies; and what is
        wrong with every member.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical", parameters={"r": "1 kohm"})
    >>> m.add(c=hb.C("1 mF", e="10 V"), r1=hb.R("r"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r1")
    >>> plan = hb.Plan({"r": "uniform(1 kohm, 2 kohm)", "c.C": "1 mF"}, sample="lhs:200", seed=7)
    >>> table = hb.sweep(m, plan, until="1 s", collect="final(c.e)")
    >>> round(float(table["final(c.e)"].mean()), 2)
    5.05
    """
    began = time.perf_counter()
    job = job_of(model, plan, collect, until, parameters, runs, options)
    if job.runs and out is None:
        raise UsageError(
            "full runs are kept, but no folder is given",
            code="HB-P108",
            where="runs",
            hint='out="sweep"',
        )
    threads = workers_of(workers)
    if part is not None and (not isinstance(part, int) or isinstance(part, bool) or part < 1):
        raise UsageError(f"part = {part!r}", code="HB-S115", where="part", hint="1 or more members")
    folder = None if out is None else Folder(Path(out))
    try:
        found = _swept(job, folder, threads, executor, part, progress, began)
    except BaseException:
        if folder is not None:
            folder.leave()
        raise
    if folder is not None:
        folder.close()
    return found


def job_of(
    model: Model,
    plan: Plan | Mapping[str, Any],
    collect: str | Sequence[str],
    until: Until,
    parameters: Mapping[str, Any] | None,
    runs: str,
    options: Mapping[str, Any],
) -> Job:
    """Return what a call asks for.

    Raises
    ------
    UsageError
    """
    if not isinstance(model, Model):
        raise UsageError(
            f"the model is a {type(model).__name__}",
            code="HB-S115",
            where="model",
            hint="give the Model, built or loaded",
        )
    options = check_options(options)
    if not isinstance(plan, Plan):
        plan = Plan(plan)
    end, ends = end_of(until, model.experiment), ends_of(until, model.experiment).conditions
    if isinstance(model.experiment.get("start"), str):
        raise UsageError(
            "members start from the file of a state, which is no part of the model",
            code="HB-S115",
            where="experiment.start",
            hint="leave start out, or give values by name",
        )
    texts = (collect,) if isinstance(collect, str) else tuple(collect)
    fixed = {k: v for k, v in (parameters or {}).items() if k not in plan.paths}
    return Job(model, plan, texts, end, options, fixed, check_form(runs), ends)


def _swept(
    job: Job,
    folder: Folder | None,
    threads: int,
    executor: Any,
    part: int | None,
    progress: Asked,
    began: float,
) -> SweepTable:
    runner = Runner(job, threads, None if folder is None or not job.runs else folder.runs)
    data, key = None, ""
    if folder is not None or executor is not None:
        data = job.to_dict(runner.graph)
        key = key_of(data)
    about = None if folder is None else folder.about()
    size = int(about["part"]) if about is not None else part or part_size(runner)
    if folder is not None and data is not None:
        size = folder.begin(data, key, size)
        if job.runs:
            with told(folder.path):
                folder.runs.mkdir(exist_ok=True)
    done = _Done(folder, [c.text for c in runner.collectors])
    ranges = [(a, min(a + size, len(job.plan))) for a in range(0, len(job.plan), size)]
    missing = done.missing(ranges)
    count = begun = len(job.plan) - sum(b - a for a, b in missing)
    interrupted = False
    with shown(progress, len(job.plan), members=True) as looked:

        def tell(more: int) -> None:
            nonlocal count
            count += more
            if looked is not None:
                looked(count, len(job.plan))

        try:
            if executor is None:
                how = _here(runner, missing, done.keep, tell, threads)
            else:
                from hybond.sweep.cluster import elsewhere

                assert data is not None
                how = elsewhere(
                    executor, data, key, missing, done.keep, tell, done.note, runner.runs
                )
        except KeyboardInterrupt:
            interrupted, how = True, "interrupted"
    if begun:
        how = f"{begun} members were there; {how}"
    if interrupted:
        lost = {r for r in missing if done.found(*r) is None}
        ranges = [r for r in ranges if r not in lost]
    table = SweepTable(
        job, runner.collectors, ranges, done.read, None if folder is None else folder.path
    )
    table.interrupted, table.how, table.notes = interrupted, how, tuple(done.notes)
    if folder is not None and not interrupted:
        with told(folder.path):
            table.to_csv(folder.path / "table.csv")
            if has_parquet():
                table.to_parquet(folder.path / "table.parquet")
    table.seconds = time.perf_counter() - began
    return table


class _Done:
    """The parts that are done, in a folder or in memory; and notes of what went wrong.

    `names` are those of the columns that a part has, by which a damaged one is known.
    """

    def __init__(self, folder: Folder | None, names: list[str]) -> None:
        self._folder = folder
        self._names = names
        self._kept: dict[Range, Part] = {}
        self._latest: Part | None = None
        self.notes: list[str] = []

    def missing(self, ranges: list[Range]) -> list[Range]:
        """Return those that are to be run; a part that is damaged is one of them."""
        if self._folder is None:
            return ranges
        missing = [r for r in ranges if self.found(*r) is None]
        for a, b in missing:
            if self._folder.place(a, b).exists():
                self.note(f"the part of members {a} to {b - 1} is damaged: run again")
        return missing

    def found(self, first: int, last: int) -> Part | None:
        """Return a part, None if it is not there."""
        if self._folder is None:
            return self._kept.get((first, last))
        part = self._folder.read(first, last)
        return None if part is None or list(part.columns) != self._names else part

    def keep(self, part: Part) -> None:
        """Keep a part."""
        self._latest = part
        if self._folder is None:
            self._kept[part.first, part.last] = part
        else:
            self._folder.write(part)

    def read(self, first: int, last: int) -> Part:
        """Return a part that was done; HB-P106 if somebody has taken it away."""
        latest = self._latest
        if latest is not None and (latest.first, latest.last) == (first, last):
            return latest
        found = self.found(first, last)
        if found is None:
            raise UsageError(
                f"the part of members {first} to {last - 1} is not there any more",
                code="HB-P106",
                where="table" if self._folder is None else str(self._folder.path),
                hint="give the same command again: it is run anew",
            )
        return found

    def note(self, text: str) -> None:
        """Note what went wrong."""
        self.notes.append(text)
        if self._folder is not None:
            self._folder.note(text)


def _here(
    runner: Runner,
    missing: Sequence[Range],
    keep: Callable[[Part], None],
    tell: Callable[[int], None],
    threads: int,
) -> str:
    for first, last in missing:
        keep(runner.run(first, last, tell))
    many = sum(b - a for a, b in missing)
    how = f"{many} members in {threads} thread{'s' * (threads != 1)}"
    return f"{how}, each as an ordinary run" if runner.alone or runner.is_ordinary else how


def part_size(runner: Runner) -> int:
    """Return how many members make a part: as many as run in about two seconds, two a thread."""
    wide = sum(max(c.points, 1) for c in runner.collectors) + runner.looked
    most = min(LARGEST, max(int(ROOM / (8.0 * wide)), 1))
    least = 2.0 * runner.workers
    size = int(min(max(GOAL / max(each_takes(runner, TRIED)[0], 1e-9), least), most))
    return 1 << (size.bit_length() - 1)


def each_takes(runner: Runner, patience: float) -> tuple[float, Part]:
    """Return how long a member takes, s, if many run one after the other; and those tried.

    Some are run, spread over all of them, until that has taken `patience`.
    """
    members = len(runner.job.plan)
    began = time.perf_counter()
    part = runner.trial(range(1))
    took = time.perf_counter() - began
    if took >= LONG:
        return took / runner.workers, part
    many, alone = 1, 0.0
    while True:
        began = time.perf_counter()
        part = runner.trial(range(0, members, max(members // many, 1))[:many])
        took = time.perf_counter() - began
        if many == 1:
            alone = took
        if took >= patience or many >= members:
            break
        many *= 8
    # what is paid once for all of them is no part of it
    return max(took - alone, 0.0) / (many - 1) if many > 1 and took > alone else took / many, part
