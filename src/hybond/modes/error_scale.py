"""The tolerance of each state in a run by the reference, from the size it has had."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from hybond.model.interval import interval_after
from hybond.programs.program import Program

Vector = NDArray[np.float64]

NEGLIGIBLE = 1e-6
"""A stored quantity is measured against at least this part of what the system's energy would
make of it, so that rounding in an idle storage does not steer the step size."""
IDLE = 1e-12
"""Absolute size, in SI, below which an integrated signal is idle."""
ROUNDED = 10.0 * float(np.finfo(float).eps)
"""Part of its terms that the rate of a stored quantity may be off by."""
SHORT = 1e-6
"""Part of the run in which what that adds up to is no error."""


class ErrorScale:
    """The tolerance of each state, from the size it has had (see `simulate`, `rtol`)."""

    def __init__(self, program: Program, rtol: float, atol: float | None, until: float) -> None:
        self.nx, self.ns = program.nx, program.ns
        self.rtol = rtol
        self.atol = atol
        self.until = until
        self.rounding = np.zeros(self.nx)
        self.largest = np.zeros(self.nx + self.ns)
        self.energy = 0.0
        graph = program.graph
        equations = program.equations(graph.start_mode, interval_after(graph, 0.0), 0.0)
        self.storage = equations.storage

    @property
    def atol_or_nan(self) -> float:
        """The absolute tolerance, nan if none is given."""
        return math.nan if self.atol is None else self.atol

    @property
    def negligible(self) -> float:
        """Part of what a storage would hold with all energy below which it need not be right."""
        return NEGLIGIBLE

    @property
    def rounded(self) -> float:
        """Part of the terms of a rate, in the time of the run, that rounding may come to."""
        return ROUNDED * SHORT * self.until

    @property
    def idle(self) -> float:
        """What an integrated signal may be wrong by at zero."""
        return float(IDLE * self.rtol**0.5)

    def start(self, terms: Vector) -> None:
        """Learn what the rates of stored quantities cancel from, where motion starts.

        From rest, rates may be nothing but rounding of these terms: then no step is small enough
        to be right to a part of what it adds.
        """
        self.rounding = self.rounded * terms

    def __call__(self, y0: Vector, y1: Vector) -> Vector:
        """Return the tolerance per state, shape (nx + ns + 2,); quadratures are not controlled."""
        n = self.nx + self.ns
        size = np.maximum(np.abs(y0[:n]), np.abs(y1[:n]))
        # what a rejected step tried must not loosen the tolerance for good
        self.largest = np.maximum(self.largest, np.abs(y0[:n]))
        size = np.maximum(size, self.largest)
        tolerance = np.full(n + 2, np.inf)
        if self.atol is not None:
            tolerance[:n] = self.rtol * size + self.atol
            return tolerance
        stiffness = np.abs(self.storage.own_stiffness(y0[: self.nx]))
        x = y0[: self.nx]
        self.energy = max(self.energy, 0.5 * float(np.sum(stiffness * x * x)))
        tried = 0.5 * float(np.sum(stiffness * y1[: self.nx] ** 2))
        with np.errstate(divide="ignore", invalid="ignore"):
            whole = np.sqrt(2.0 * max(self.energy, tried) / stiffness)
        floor = np.zeros(n)
        floor[: self.nx] = np.where(np.isfinite(whole), NEGLIGIBLE * whole, 0.0)
        tolerance[:n] = self.rtol * np.maximum(size, floor)
        # what has not moved yet has no size: the solver chooses its first step without it
        moved = np.where(size[: self.nx] > 0.0, self.rounding, 0.0)
        tolerance[: self.nx] = np.maximum(tolerance[: self.nx], moved)
        tolerance[self.nx : n] += self.idle
        return tolerance
