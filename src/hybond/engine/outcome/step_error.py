"""How far off a run of time-stepping is: the same run with longer steps.

Where laws change their branches the method is of first order, so that the difference between the
two runs, over what the other steps are longer by, estimates the error of the finer one
(Richardson); where nothing happens it is of second order with theta = 1/2, and the estimate is
2.6 times too high. Two figures are taken: the
difference at the end, and its mean over the run, each as a part of the largest value that the
variable has had. A mean, because around an impact any two step sizes differ by the whole jump
for a moment.
"""

from __future__ import annotations

import bisect

import numpy as np
from numpy.typing import NDArray

from hybond.model.graph import FlatGraph
from hybond.records import dataclass
from hybond.runs.trace import Trace
from hybond.units import format_quantity

Vector = NDArray[np.float64]

SAMPLES = 200
"""Times at which the runs are compared, the end besides."""
GOOD = 1e-3
"""Error to which the advised step would bring the run."""
BAD = 1e-2
"""Error from which a run is warned about."""
IDLE = 1e-9
"""A variable below this part of the largest one of its kind is not looked at."""


@dataclass(frozen=True, slots=True)
class StepError:
    """The estimated error of a run."""

    step: float
    """Of the run, s."""
    end: float
    mean: float
    """`end` and `mean`: of the worst variable, as a part of the largest value it has had."""
    variable: str
    """Which one."""

    @property
    def advised(self) -> float:
        """A step that would bring the error to a thousandth: it shrinks like the step.

        Examples
        --------
        >>> StepError(1e-3, end=0.02, mean=0.01, variable="c.q").advised
        5e-05
        """
        worst = max(self.end, self.mean)
        if worst <= GOOD:
            return self.step
        exact = self.step * GOOD / worst
        # one digit: it is advice
        return float(f"{exact:.0e}")

    def text(self) -> str:
        """Return the estimate in words."""
        return (
            f"estimated error with step = {format_quantity(self.step, 's')}: "
            f"{100.0 * self.end:.2g} % at the end, {100.0 * self.mean:.2g} % on average "
            f"({self.variable}, of its largest value); try step = "
            f"{format_quantity(self.advised, 's')} for 0.1 %"
        )


def compare(
    graph: FlatGraph, step: float, factor: float, fine: Trace, coarse: Trace
) -> StepError | None:
    """Return the error of `fine`, by a run with `factor` its step; None if nothing has a state."""
    n = len(graph.storages) + len(graph.integrals)
    if not n or not fine.segments or not coarse.segments:
        return None
    end = min(float(fine.segments[-1].t[-1]), float(coarse.segments[-1].t[-1]))
    times = np.linspace(float(fine.segments[0].t[0]), end, SAMPLES + 1)
    a, b = (_sampled(trace, times)[:, :n] for trace in (fine, coarse))
    largest = np.maximum(np.abs(a).max(axis=0), np.abs(b).max(axis=0))
    counts = np.zeros(n, dtype=bool)
    for chosen in (
        [s.index for s in graph.storages if s.kind == "C"],
        [s.index for s in graph.storages if s.kind == "I"],
        list(range(len(graph.storages), n)),
    ):
        if chosen:
            counts[chosen] = largest[chosen] > IDLE * largest[chosen].max()
    apart = np.where(counts, np.abs(a - b) / np.where(largest > 0.0, largest, 1.0), 0.0)
    apart /= factor - 1.0
    at_end, mean = apart[-1], apart.mean(axis=0)
    worst = int(np.argmax(np.maximum(at_end, mean)))
    paths = [s.path for s in graph.storages] + [i.path for i in graph.integrals]
    return StepError(step, float(at_end[worst]), float(mean[worst]), paths[worst])


def _sampled(trace: Trace, times: Vector) -> Vector:
    """Return the states of a run at some times, one row each."""
    starts = [float(s.t[0]) for s in trace.segments]
    rows = []
    for t in times.tolist():
        segment = trace.segments[max(bisect.bisect_right(starts, t) - 1, 0)]
        rows.append(segment.at(min(t, float(segment.t[-1]))))
    return np.array(rows)
