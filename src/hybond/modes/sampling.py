"""Sampled signals at the instants at which they are set."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from hybond.errors import NumericsError
from hybond.model.graph import Mode
from hybond.modes.trial import Trials
from hybond.programs.interval import Interval
from hybond.programs.program import Program

Vector = NDArray[np.float64]


class Sampling:
    """The sampled signals of one run; it remembers the last instant, which samples once."""

    def __init__(self, program: Program) -> None:
        self._samples = [(s, program.compile(s.value)) for s in program.graph.samples]
        self._graph = program.graph
        self._last = -math.inf

    def held(
        self, t: float, x: Vector, s: Vector, mode: Mode, before: Interval, trials: Trials
    ) -> Vector | None:
        """Return the integrated signals with those set that are due at `t`; None if none is.

        Values are a priori: those of the mode and the inputs before the instant.
        """
        due = [(sample, value) for sample, value in self._samples if sample.due(t)]
        if not due or t <= self._last:
            return None
        self._last = t
        prior = trials.a_priori(t, x, s, mode, before)
        values = [*prior, *prior]
        found = s.copy()
        for sample, value in due:
            found[sample.signal] = value(values)
            if not math.isfinite(found[sample.signal]):
                path = self._graph.integrals[sample.signal].path
                raise NumericsError(
                    f"{path} samples {found[sample.signal]} at t = {t:.9g} s",
                    code="HB-N305",
                    where=f"signals.{path}",
                    hint="look for a division by zero or a root of a negative number",
                )
        return found
