"""Sampled signals and blocks of signals, at the instants at which they are set."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.blocks.runners import Runner
from hybond.errors import NumericsError
from hybond.model.graph import Mode, Sample, one_instant
from hybond.model.interval import Interval
from hybond.modes.trial import Trials
from hybond.programs.program import Program

Vector = NDArray[np.float64]


class Sampling:
    """The sampled signals of one run; it remembers the last instant, which samples once.

    Parameters
    ----------
    program : Program
    runners : mapping
        What runs each block, by its path.
    until : float
        The end of the run, at which nothing is sampled: it shows what leads up to it.
    """

    def __init__(
        self, program: Program, runners: Mapping[str, Runner] | None = None, *, until: float
    ) -> None:
        self._until = until
        self._samples: list[tuple[Sample, list[Callable[[Sequence[float]], float]]]] = [
            (s, [program.compile(e) for e in s.values]) for s in program.graph.samples
        ]
        self._graph = program.graph
        self._runners = runners or {}
        self._last = -math.inf

    def held(
        self, t: float, x: Vector, s: Vector, mode: Mode, before: Interval, trials: Trials
    ) -> Vector | None:
        """Return the integrated signals with those set that are due at `t`; None if none is.

        What is read is a priori: of the mode and the inputs before the instant.

        Raises
        ------
        NumericsError
            HB-N305 if a value is not finite, HB-N306 if a block fails.
        """
        due = [(sample, values) for sample, values in self._samples if sample.due(t)]
        if not due or t <= self._last or one_instant(self._last, t) or t >= self._until:
            return None
        self._last = t
        prior = trials.a_priori(t, x, s, mode, before)
        signals = [*prior, *prior]
        found = s.copy()
        for sample, values in due:
            read = [float(value(signals)) for value in values]
            if sample.block is not None:
                read = list(self._runners[sample.path].step(t, read))
            for k, value in zip(sample.signals, read, strict=True):
                found[k] = value
                if not math.isfinite(value):
                    raise self._no_value(k, value, t)
        return found

    def close(self) -> None:
        """Let the blocks go."""
        for runner in self._runners.values():
            runner.close()

    def _no_value(self, k: int, value: float, t: float) -> NumericsError:
        path = self._graph.integrals[k].path
        return NumericsError(
            f"{path} samples {value} at t = {t:.9g} s",
            code="HB-N305",
            where=f"signals.{path}",
            hint="look for a division by zero or a root of a negative number",
        )
