"""The job in hybond: flatten, simulate, read the output points."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import hybond as hb
from measuring.problem import Outcome

Read = Callable[[hb.Result], tuple[float, ...]]


def in_hybond(
    model: hb.Model, until: float, count: int, names: Sequence[str], read: Read, **options: Any
) -> Outcome:
    """Do it from the model as written; `read` is not timed.

    Flattening and the equations of the modes are done anew in each run, so they are in the fixed
    cost.
    """
    at = np.linspace(0.0, until, count)
    start = time.perf_counter()
    run = hb.simulate(model, until=until, **options)
    run.sample(at, names)
    seconds = time.perf_counter() - start
    return Outcome(seconds, read(run), len(run.events))
