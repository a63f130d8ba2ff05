"""Which branches junction laws take in each of the modes that sliding combines.

A diode beside a relay may conduct while the relay is on one side and block while it is on the
other. Each mode of the combination has the branches that complementarity gives it there; where
one of them changes, the motion is decided anew.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from hybond.errors import HybondError
from hybond.model.graph import Mode
from hybond.model.interval import Interval
from hybond.modes.trial import Trials
from hybond.programs.program import Program
from hybond.trace import Trace

Vector = NDArray[np.float64]


class BranchesBeside:
    """Chooses them for one run."""

    def __init__(self, program: Program, trace: Trace) -> None:
        self.program = program
        self.trials = Trials(program, trace)
        self.any = bool(self.trials.laws.laws)

    def at(self, t: float, y: Vector, interval: Interval) -> Callable[[Mode], Mode]:
        """Return what gives a mode the branches of its laws in one state."""
        known: dict[Mode, Mode] = {}

        def branch(mode: Mode) -> Mode:
            if not self.any:
                return mode
            if mode not in known:
                known[mode] = self._chosen(mode, t, y, interval)
            return known[mode]

        return branch

    def _chosen(self, mode: Mode, t: float, y: Vector, interval: Interval) -> Mode:
        nx, n = self.program.nx, self.program.nx + self.program.ns
        x, s = y[:nx], y[nx:n]
        try:
            pre = self.trials.a_priori(t, x, s, mode, interval)
            return self.trials.enter(t, x, s, mode, interval, pre, jump=True).mode
        except HybondError:
            return mode
