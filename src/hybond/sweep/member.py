"""One member of an ensemble: an ordinary run, and what is kept of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.errors import HybondError, UsageError
from hybond.model.builder import Model
from hybond.model.parts import Value
from hybond.result import Result, Status
from hybond.simulation import simulate

Vector = NDArray[np.float64]

NO_SUCH_PARAMETER = "HB-M107"
"""All members name the same parameters, so it is the call that is wrong."""


@dataclass(frozen=True, slots=True)
class Task:
    """What all members have in common.

    Parameters
    ----------
    model : Model
    until : float
        s.
    options : mapping
        Of `hybond.simulate`.
    names : tuple of str
        The outputs.
    t : array, shape (times,)
        When they are sampled, s.
    events : bool
        Whether the times of events are kept.
    """

    model: Model
    until: float
    options: Mapping[str, Any]
    names: tuple[str, ...]
    t: Vector
    events: bool


@dataclass(frozen=True, slots=True)
class Member:
    """What is kept of one run.

    Parameters
    ----------
    status : {"ok", "accumulation", "error", "interrupted"}
    t_end : float
        The time reached, s.
    count : int
        Number of events.
    events : array, shape (events,)
        Their times, s, if they were asked for.
    final : array, shape (outputs,)
        Values at `t_end`.
    samples : array, shape (outputs, times)
        Limits from the right, nan beyond `t_end`.
    error : HybondError or None
    warnings : tuple of str
    """

    status: Status
    t_end: float
    count: int
    events: Vector
    final: Vector
    samples: Vector
    error: HybondError | None
    warnings: tuple[str, ...]


def run_of(task: Task, parameters: Mapping[str, Value]) -> Result | HybondError:
    """Return the run of a set, or why there is none.

    Raises
    ------
    HybondError
        For what is wrong with the call, and so with every member.
    """
    try:
        run = simulate(
            task.model, task.until, parameters=parameters, on_error="return", **task.options
        )
    except UsageError:
        raise
    except HybondError as error:
        if error.code == NO_SUCH_PARAMETER:
            raise
        return error
    if isinstance(run.error, UsageError):
        raise run.error
    return run


def member_of(task: Task, run: Result | HybondError) -> Member:
    """Return what is kept of a run.

    Raises
    ------
    UsageError
        HB-S109 for an output that does not exist.
    """
    final = np.full(len(task.names), np.nan)
    samples = np.full((len(task.names), len(task.t)), np.nan)
    none = np.zeros(0)
    if isinstance(run, HybondError):
        return Member("error", 0.0, 0, none, final, samples, run, ())
    error = run.error
    times = np.array(run.trace.events.times) if task.events else none
    try:
        _read(task, run, final, samples)
    except UsageError:
        raise
    except HybondError as failure:
        error = error or failure
    return Member(
        status=run.status if error is None else "error",
        t_end=run.t_end,
        count=run.trace.events.total,
        events=times,
        final=final,
        samples=samples,
        error=error,
        warnings=run.warnings,
    )


def _read(task: Task, run: Result, final: Vector, samples: Vector) -> None:
    """Read all outputs at the end and at the times of the grid that the run has reached."""
    for name in task.names:
        run.expression(name)
    if not run.segments:
        return
    there = (task.t >= run.t_begin) & (task.t <= run.t_end)
    values = run.sample([*task.t[there].tolist(), run.t_end], task.names)
    for k, name in enumerate(task.names):
        samples[k, there] = values[name][:-1]
        final[k] = values[name][-1]
