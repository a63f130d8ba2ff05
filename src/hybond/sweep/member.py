"""One member of an ensemble as an ordinary run, and its outputs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.errors import HybondError, UsageError
from hybond.model.builder import Model
from hybond.model.parts import Value
from hybond.records import dataclass

if TYPE_CHECKING:
    from hybond.result import Result

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


def run_of(task: Task, parameters: Mapping[str, Value]) -> Result | HybondError:
    """Return the run of a set, or why there is none.

    Raises
    ------
    HybondError
        For what is wrong with the call, and so with every member.
    """
    from hybond.simulation import simulate

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


def read_outputs(task: Task, run: Result, final: Vector, samples: Vector) -> HybondError | None:
    """Read outputs at the end and at the times that the run has reached; return what failed.

    Parameters
    ----------
    final : array, shape (outputs,)
        Filled in, as are `samples`.
    samples : array, shape (outputs, times)

    Raises
    ------
    UsageError
        HB-S109 for an output that does not exist.
    """
    for name in task.names:
        run.expression(name)
    if not run.segments:
        return run.error
    there = (task.t >= run.t_begin) & (task.t <= run.t_end)
    try:
        values = run.sample([*task.t[there].tolist(), run.t_end], task.names)
    except UsageError:
        raise
    except HybondError as failure:
        return run.error or failure
    for k, name in enumerate(task.names):
        samples[k, there] = values[name][:-1]
        final[k] = values[name][-1]
    return run.error
