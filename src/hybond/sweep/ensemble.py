"""`ensemble`: one model, many sets of parameters, on all cores."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.calls import called
from hybond.engine.compiled.members import Ran
from hybond.errors import HybondError, UsageError
from hybond.model.builder import Model
from hybond.model.kept import Kind, kind_of
from hybond.model.parts import Value
from hybond.progress import Asked, shown
from hybond.result import Result
from hybond.runs.ends import Until, ends_of
from hybond.runs.times import end_of
from hybond.sweep.asking import asked_of, check_options
from hybond.sweep.collection import Ensemble, Outputs
from hybond.sweep.family import Family, family_of
from hybond.sweep.member import Task, read_outputs, run_of
from hybond.sweep.sets import Columns, columns_of, numbers_of
from hybond.sweep.threads import in_threads, workers_of

Vector = NDArray[np.float64]

_NONE = np.zeros(0)
NO_NUMBERS = -1
"""The kind of a member of which a value is an expression, or none at all."""


@called('hb.ensemble(model, "1 s", sets={"m": [1.0, 2.0]})')
def ensemble(
    model: Model,
    until: Until = None,
    *,
    sets: Mapping[str, Any] | Iterable[Mapping[str, Any]],
    outputs: str | Sequence[str] | None = None,
    samples: int | Sequence[float] | Vector | None = None,
    events: bool = False,
    workers: int | None = None,
    progress: Asked = None,
    **options: Any,
) -> Ensemble:
    """Simulate a model with many sets of parameters, on all cores.

    Members differ in numbers: tables are made once, parameters are written into them, and the
    library runs one member after the other, in threads of this process. One that it has more to say
    of (it stops, it warns, it slides, another solver than it has) is an ordinary run. One that
    stops with an error does not stop the others. What comes out is that of ordinary runs, and does
    not depend on the number of threads, not in a bit.

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
        Threads. Default: one for each core.
    progress : bool, bar of tqdm or callable
        True for a bar on stderr with the time to go; a bar of tqdm; or ``progress(done, total)``,
        members, in the thread of the call.
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
    options = check_options(options)
    threads = workers_of(workers)
    columns = columns_of(sets)
    end = end_of(until, model.experiment)
    conditions = ends_of(until, model.experiment).conditions
    if conditions:
        why = f"members do not end where {conditions[0]!r} holds"
        raise _refusal(why, "until", 'an ensemble ends at a time: until="1 s"')
    if model.experiment.get("start") is not None:
        raise _refusal("members start as the model says", "experiment.start", "leave start out")
    task = Task(
        model,
        end,
        options,
        (outputs,) if isinstance(outputs, str) else tuple(outputs or ()),
        _times(samples, end),
        events,
    )
    members = len(next(iter(columns.values())))
    with shown(progress, members, members=True) as looked:
        work = _Work(task, columns, looked)
        how = work.all(threads)
    return _gathered(work, how, time.perf_counter() - began)


class _Work:
    """The members of one call: what is kept of those that have run, and how the others will."""

    def __init__(
        self, task: Task, columns: Columns, progress: Callable[[int, int], object] | None
    ) -> None:
        self.task = task
        self.columns = columns
        self.total = n = len(next(iter(columns.values())))
        self.units: dict[str, str] = {}
        self.interrupted = False
        self.known = bool(task.names)
        """Whether it is known what the outputs are."""
        self.status = np.full(n, "interrupted", dtype="<U12")
        self.t_end = np.zeros(n)
        self.counts = np.zeros(n, dtype=np.intp)
        self.events: list[Vector] = [_NONE] * n
        self.errors: dict[int, HybondError] = {}
        self.warnings: dict[int, tuple[str, ...]] = {}
        self._progress = progress
        self._done = 0
        self._outputs(task.names)

    def _outputs(self, names: tuple[str, ...]) -> None:
        self.task = replace(self.task, names=names)
        self.final = np.full((len(names), self.total), np.nan)
        self.samples = np.full((len(names), self.total, len(self.task.t)), np.nan)

    def _tell(self, names: tuple[str, ...], units: Mapping[str, str]) -> None:
        """Note what the outputs are, once."""
        if not self.known:
            self._outputs(names)
            self.known = True
        self.units = self.units or dict(units)

    def set(self, k: int) -> dict[str, Value]:
        return {path: column[k] for path, column in self.columns.items()}

    def all(self, workers: int) -> str:
        """Run all members; return how it was done."""
        try:
            return self._all(workers)
        except KeyboardInterrupt:
            self.interrupted = True
            return f"interrupted after {self._done} of {_members(self.total)}"

    def _all(self, workers: int) -> str:
        asked, alone = asked_of(self.task)
        together = ordinary = 0
        rest = np.arange(self.total)
        if asked is None:
            # whoever runs first says what the outputs are, and what is wrong with the call
            ordinary, rest = self._ordinary(rest.tolist()), rest[:0]
        kinds, values = _read(self.columns)
        while len(rest) and asked is not None:
            first = int(rest[0])
            own, left = rest[:1], [first]
            family = None
            if kinds[first] != NO_NUMBERS:
                impact = self.task.options.get("impact")
                family = family_of(
                    self.task.model, self.set(first), *asked, self.task.names, impact
                )
            if family is not None:
                self._tell(family.names, family.units)
                given = {path: column[rest] for path, column in values.items()}
                fits, numbers, read = family.numbers(given, len(rest))
                fits &= kinds[rest] == kinds[first]
                if fits[0]:
                    own = rest[fits]
                    left = self._together(family, own, numbers[fits], read[fits], workers)
            together += len(own) - len(left)
            ordinary += self._ordinary(left)
            rest = np.setdiff1d(rest, own, assume_unique=True)
        how = []
        if together:
            count = min(workers, together)
            how.append(f"{_members(together)} in {count} thread{'s' * (count != 1)}")
        if ordinary:
            how.append(f"{_members(ordinary)} one after the other{alone and f': {alone}'}")
        return ", ".join(how)

    def _together(
        self, family: Family, own: NDArray[np.intp], numbers: Vector, read: Vector, workers: int
    ) -> list[int]:
        """Run members of a family; return those that an ordinary run has more to say of."""
        left: list[int] = []
        order = np.argsort(self.task.t, kind="stable")

        def keep(first: int, ran: Ran) -> None:
            here = slice(first, first + len(ran.plain))
            members, plain = own[here], ran.plain
            values = family.values(ran.out[plain], read[here][plain])
            done = members[plain]
            self.final[:, done] = values[:, :, -1]
            for at, k in enumerate(order.tolist()):
                self.samples[:, done, k] = values[:, :, at]
            self.status[done] = "ok"
            self.t_end[done] = ran.end[plain]
            self.counts[done] = ran.count[plain]
            if family.warnings:
                self.warnings.update(dict.fromkeys(done.tolist(), family.warnings))
            if self.task.events:
                times = np.split(ran.events, np.cumsum(ran.count[plain])[:-1])
                for k, own_times in zip(done.tolist(), times):
                    self.events[k] = own_times
            left.extend(members[~plain].tolist())
            self._note(len(done))

        t = self.task.t[order]
        in_threads(family.model, family.looked, t, numbers, min(workers, len(own)), keep)
        return sorted(left)

    def _ordinary(self, members: list[int]) -> int:
        """Run members each as an ordinary run; return how many."""
        for k in members:
            run = run_of(self.task, self.set(k))
            if isinstance(run, Result):
                if run.status == "interrupted":
                    raise KeyboardInterrupt
                names = self.task.names if self.known else tuple(run.names)
                self._tell(names, {name: run.unit(name) for name in names})
            self._keep(k, run)
            self._note(1)
        return len(members)

    def _keep(self, k: int, run: Result | HybondError) -> None:
        error = run if isinstance(run, HybondError) else None
        self.status[k] = "error"
        if isinstance(run, Result):
            error = read_outputs(self.task, run, self.final[:, k], self.samples[:, k])
            self.status[k] = run.status if error is None else "error"
            self.t_end[k], self.counts[k] = run.t_end, run.trace.events.total
            self.events[k] = np.array(run.trace.events.times) if self.task.events else _NONE
            if run.warnings:
                self.warnings[k] = run.warnings
        if error is not None:
            self.errors[k] = error

    def _note(self, many: int) -> None:
        self._done += many
        if self._progress is not None and many:
            self._progress(self._done, self.total)


def _read(columns: Columns) -> tuple[NDArray[np.intp], dict[str, Vector]]:
    """Return of each member a number for the kinds of its values, and the values in SI.

    Members whose values are of the same kinds have the same number.
    """
    kinds, values = [], {}
    for path, column in columns.items():
        own = [kind_of(value) for value in column]
        kinds.append([kind for kind, _ in own])
        values[path] = np.array([value for _, value in own])
    place: dict[tuple[Kind, ...], int] = {}
    found = [
        NO_NUMBERS if any(isinstance(k, str) for k in row) else place.setdefault(row, len(place))
        for row in zip(*kinds, strict=True)
    ]
    return np.array(found), values


def _members(count: int) -> str:
    return f"{count} member{'s' * (count != 1)}"


def _gathered(work: _Work, how: str, seconds: float) -> Ensemble:
    task = work.task
    return Ensemble(
        model=task.model,
        until=task.until,
        options=dict(task.options),
        sets={path: tuple(column) for path, column in work.columns.items()},
        parameters={path: numbers_of(column) for path, column in work.columns.items()},
        units=work.units,
        status=work.status,
        t_end=work.t_end,
        counts=work.counts,
        events=tuple(work.events) if task.events else (),
        final=Outputs(zip(task.names, work.final, strict=True)),
        t=task.t,
        samples=Outputs(zip(task.names, work.samples, strict=True) if len(task.t) else ()),
        errors=dict(sorted(work.errors.items())),
        warnings=dict(sorted(work.warnings.items())),
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


def _refusal(why: str, where: str, hint: str) -> UsageError:
    return UsageError(why, code="HB-S115", where=where, hint=hint)


__all__ = ["Ensemble", "ensemble"]
