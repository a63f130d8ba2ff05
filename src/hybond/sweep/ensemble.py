"""`ensemble`: one model, many sets of parameters, on all cores."""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.errors import HybondError, NumericsError, UsageError
from hybond.model.builder import Model
from hybond.model.parts import Value
from hybond.names import did_you_mean
from hybond.result import Result
from hybond.run_options import end_of
from hybond.simulation import simulate
from hybond.sweep.collection import Ensemble
from hybond.sweep.member import Member, Task, member_of, run_of
from hybond.sweep.processes import MOST, cores, in_processes, stays
from hybond.sweep.sets import Columns, columns_of, numbers_of

Vector = NDArray[np.float64]

STARTING = 0.5
"""What starting processes takes, s: most of it is their imports."""
TELLING = 0.1
"""Time that members must have taken, s, before it says what the others will take."""
CHUNK = 0.2
"""What a process gets to do at a time, s."""
SHARE = 4
"""Chunks that every process gets at the least, so that all end together."""
LARGE = 32
"""Members in a chunk at the most, while it is not known what one takes."""

_OWN = {
    "parameters": "the parameters are in sets",
    "on_error": "a member that stops with an error is kept, and stops no other",
    "journal": "ensemble.run(k) runs one member again: give it one there with hybond.simulate",
}
"""Options of `simulate` that an ensemble does not pass on, and what to do instead."""


def ensemble(
    model: Model,
    until: float | str | None = None,
    *,
    sets: Mapping[str, Any] | Iterable[Mapping[str, Any]],
    outputs: str | Sequence[str] | None = None,
    samples: int | Sequence[float] | Vector | None = None,
    events: bool = False,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    **options: Any,
) -> Ensemble:
    """Simulate a model with many sets of parameters, on all cores.

    Each member is an ordinary run. One that stops with an error does not stop the others. What
    comes out does not depend on the number of processes, not in a bit.

    Parameters
    ----------
    model : Model
        A model, built or loaded.
    until : float or str
        End time of all members, s or a quantity; default: what the experiment says.
    sets : mapping of path to sequence, or sequence of mappings of path to value
        The values that replace the model's own, by dotted path: columns of one length, or rows.
    outputs : str or sequence of str
        What is read of each member: names or expressions of names. Default: stored quantities,
        co-energy variables, signals and what the experiment lists.
    samples : int or sequence of float
        When outputs are sampled, s; a number of times means evenly spaced ones from 0 to the end.
        Default: not at all, only at the end.
    events : bool
        Whether to keep the times of all events; they are counted in any case.
    workers : int
        Processes. 1 runs all in this one. Default: one for each core, if the first members, which
        run in this process, take so long that starting others pays.
    progress : callable
        ``progress(done, total)``, members, in this process.
    **options
        Of `hybond.simulate`, for all members: ``solver``, ``rtol``, ``engine``, ...

    Returns
    -------
    Ensemble

    Raises
    ------
    UsageError
        HB-S114 for sets that do not fit, HB-S115 for an option that an ensemble does not have,
        and whatever else is wrong with the call.
    ModelError
        HB-M107 for a parameter that the model does not have.

    Examples
    --------
    A capacitor of 1 mF discharges over different resistors; exp(-1) of 10 V is left after one
    time constant.

    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical", parameters={"r": "1 kohm"})
    >>> m.add(c=hb.C("1 mF", e="10 V"), r1=hb.R("r"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r1")
    >>> many = hb.ensemble(m, "1 s", sets={"r": [500.0, 1000.0, 2000.0]}, outputs=["c.e"])
    >>> many.final["c.e"].round(6).tolist()
    [1.353353, 3.678794, 6.065307]
    """
    began = time.perf_counter()
    if not isinstance(model, Model):
        raise _refusal(
            f"the model is a {type(model).__name__}, whose parameters are numbers already",
            "model",
            "give the Model, not what model.flatten() returns",
        )
    _check_options(options)
    if workers is not None and (
        not isinstance(workers, int) or isinstance(workers, bool) or workers < 1
    ):
        raise _refusal(f"workers = {workers!r}", "workers", "1 for this process only, or more")
    columns = columns_of(sets)
    end = end_of(until, model.experiment)
    task = Task(
        model,
        end,
        options,
        (outputs,) if isinstance(outputs, str) else tuple(outputs or ()),
        _times(samples, end),
        events,
    )
    work = _Work(task, columns, progress)
    how = work.all(workers, named=outputs is not None)
    return _gathered(work, how, time.perf_counter() - began)


class _Work:
    """The members of one call: those that have run, and how the others will."""

    def __init__(
        self, task: Task, columns: Columns, progress: Callable[[int, int], None] | None
    ) -> None:
        self.task = task
        self.columns = columns
        self.total = len(next(iter(columns.values())))
        self.members: dict[int, Member] = {}
        self.units: dict[str, str] = {}
        self.interrupted = False
        self._progress = progress
        self._spent: list[float] = []

    def set(self, k: int) -> dict[str, Value]:
        return {path: column[k] for path, column in self.columns.items()}

    def all(self, workers: int | None, *, named: bool) -> str:
        """Run all members, here and in other processes; return how it was done."""
        try:
            return self._all(workers, named=named)
        except KeyboardInterrupt:
            self.interrupted = True
            return f"interrupted after {len(self.members)} of {self.total} members"

    def _all(self, workers: int | None, *, named: bool) -> str:
        known = False
        kept_here = ""
        count = cores() if workers is None else workers
        for k in range(self.total):
            rest = self.total - k
            if known and not kept_here and count > 1 and self._pays(rest, workers):
                # looked at once, and only if there is a use for it
                kept_here = stays(self.task)
                if not kept_here:
                    return self._elsewhere(k, min(count, rest, MOST))
            known = self._here(k, known, named=named) or known
        ending = f": {kept_here}" if kept_here else ""
        return f"{_members(self.total)} in this process{ending}"

    def _here(self, k: int, known: bool, *, named: bool) -> bool:
        """Run a member in this process; whether it has told what the outputs are."""
        began = time.perf_counter()
        run = run_of(self.task, self.set(k))
        found = isinstance(run, Result)
        if isinstance(run, Result):
            if run.status == "interrupted":
                raise KeyboardInterrupt
            if not known:
                names = self.task.names if named else tuple(run.names)
                self.task = replace(self.task, names=names)
                self.units = {name: run.unit(name) for name in names}
        self.keep([member_of(self.task, k, run)])
        self._spent.append(time.perf_counter() - began)
        return found

    def _pays(self, rest: int, workers: int | None) -> bool:
        """Whether other processes would be done sooner than this one."""
        if workers is not None:
            return True
        # the first member imports what it needs
        told = self._spent[1:]
        if sum(told) < TELLING and sum(self._spent) < 2.0 * STARTING:
            return False
        return rest * self._each() * (1.0 - 1.0 / cores()) > 2.0 * STARTING

    def _each(self) -> float:
        told = self._spent[1:] or self._spent
        return sum(told) / len(told)

    def _elsewhere(self, first: int, count: int) -> str:
        """Run the members from `first` on in other processes."""
        rest = self.total - first
        most = LARGE if len(self._spent) < 2 else int(CHUNK / max(self._each(), 1e-9))
        chunk = max(1, min(most, -(-rest // (SHARE * count))))
        sets = [(k, self.set(k)) for k in range(first, self.total)]
        try:
            lost = in_processes(self.task, sets, count, chunk, self.keep)
        except OSError as error:
            # a system that has no processes to give, or no semaphores
            for k in range(first, self.total):
                if k not in self.members:
                    self._here(k, True, named=True)
            return f"{_members(self.total)} in this process: no other could be started ({error})"
        if lost:
            self._give_up(lost)
        words = "process" if count == 1 else "processes"
        return f"{_members(first)} in this process, {rest} in {count} {words}"

    def _give_up(self, why: str) -> None:
        """Write down what a process that ended has not done."""
        nothing = HybondError("", code="")
        empty = member_of(self.task, 0, nothing)
        for k in range(self.total):
            if k not in self.members:
                error = NumericsError(
                    why,
                    code="HB-S116",
                    where=f"sets[{k}]",
                    hint="ensemble.run(k) shows what one member does; is there memory for all?",
                )
                self.members[k] = replace(empty, number=k, error=error)

    def keep(self, members: list[Member]) -> None:
        """Keep what has been run."""
        for member in members:
            self.members[member.number] = member
        if self._progress is not None:
            self._progress(len(self.members), self.total)


def _members(count: int) -> str:
    return f"{count} member{'s' * (count != 1)}"


def _gathered(work: _Work, how: str, seconds: float) -> Ensemble:
    task, n = work.task, work.total
    final = np.full((len(task.names), n), np.nan)
    samples = np.full((len(task.names), n, len(task.t)), np.nan)
    status = np.full(n, "interrupted", dtype="<U12")
    t_end, counts = np.zeros(n), np.zeros(n, dtype=np.intp)
    for k, member in work.members.items():
        if len(member.final) == len(task.names):
            final[:, k], samples[:, k] = member.final, member.samples
        status[k], t_end[k], counts[k] = member.status, member.t_end, member.count
    in_order = sorted(work.members.items())
    nothing = np.zeros(0)
    times = tuple(work.members[k].events if k in work.members else nothing for k in range(n))
    return Ensemble(
        model=task.model,
        until=task.until,
        options=dict(task.options),
        sets={path: tuple(column) for path, column in work.columns.items()},
        parameters={path: numbers_of(column) for path, column in work.columns.items()},
        units=work.units,
        status=status,
        t_end=t_end,
        counts=counts,
        events=times if task.events else (),
        final=dict(zip(task.names, final, strict=True)),
        t=task.t,
        samples=dict(zip(task.names, samples, strict=True)) if len(task.t) else {},
        errors={k: m.error for k, m in in_order if m.error is not None},
        warnings={k: m.warnings for k, m in in_order if m.warnings},
        interrupted=work.interrupted,
        seconds=seconds,
        how=how,
    )


def _times(samples: int | Sequence[float] | Vector | None, end: float) -> Vector:
    """Return when to sample, s."""
    if samples is None:
        return np.zeros(0)
    if isinstance(samples, int) and not isinstance(samples, bool) and samples >= 2:
        return np.linspace(0.0, end, samples)
    try:
        t = np.array(samples, dtype=float)
    except (TypeError, ValueError):
        t = np.zeros((0, 0))
    if t.ndim != 1:
        raise _refusal(f"samples = {samples!r}", "samples", "two or more, or a list of times in s")
    outside = t[~((t >= 0.0) & (t <= end))]
    if len(outside):
        raise UsageError(
            f"the runs go from 0 to {end:.9g} s, not to {outside[0]:g} s",
            code="HB-S110",
            where="samples",
            hint="ask for times within them",
        )
    return t


def _check_options(options: Mapping[str, Any]) -> None:
    known = inspect.signature(simulate).parameters.keys() - {"model", "until", "progress"}
    for name in options:
        if name in _OWN:
            raise _refusal(f"an ensemble has no {name!r}", name, _OWN[name])
        if name not in known:
            raise _refusal(
                f"there is no option {name!r}", name, did_you_mean(name, known - _OWN.keys())
            )


def _refusal(why: str, where: str, hint: str) -> UsageError:
    return UsageError(why, code="HB-S115", where=where, hint=hint)


__all__ = ["Ensemble", "ensemble"]
