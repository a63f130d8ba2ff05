"""A trial of a fit: the run with some values, what it leaves of the data, and its slopes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.sensitivity.opened import Opened
from hybond.analysis.sensitivity.sensitivities import Varied
from hybond.analysis.sensitivity.wanted import Wanted, slotted
from hybond.errors import HybondError
from hybond.fitting.data import Data
from hybond.model.kept import kept_graph
from hybond.result import Result
from hybond.simulation import simulate

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class FittedData:
    """Data, and the model that they are of.

    Parameters
    ----------
    data : Data
    opened : Opened
        With a parameter for all that is free.
    sizes : mapping
        By signal: what its residuals are divided by.
    until : float
        s.
    """

    data: Data
    opened: Opened
    sizes: Mapping[str, float]
    until: float

    @property
    def signals(self) -> list[str]:
        """The signals that were measured."""
        return list(self.data.columns)

    def residuals(self, run: Result) -> Vector:
        """Return what a run leaves of the data, in order of signals, divided by sizes."""
        read = run.sample(self.data.t.tolist(), self.signals)
        parts = [
            (read[name] - column)[~np.isnan(column)] / self.sizes[name]
            for name, column in self.data.columns.items()
        ]
        return np.concatenate(parts)


@dataclass
class Trials:
    """Residuals and slopes of all cases; the last trial is kept.

    Parameters
    ----------
    cases : sequence of FittedData
    options : mapping
        Of `simulate`.
    """

    cases: Sequence[FittedData]
    options: Mapping[str, Any]
    runs: int = 0
    missing: int = 0
    """Residuals without a slope in the last Jacobian: behind the end of the derivatives."""
    why: str = ""
    """Why derivatives of the last Jacobian end, and where."""
    error: HybondError | None = None
    """Why the last trial that failed did."""
    _last: tuple[bytes, list[tuple[Result, Mapping[str, float]]], Vector] | None = field(
        default=None, repr=False
    )

    def residuals(self, values: Vector) -> Vector:
        """Return all residuals; infinite where a case cannot be run to its end."""
        key = values.tobytes()
        if self._last is not None and self._last[0] == key:
            return self._last[2]
        runs: list[tuple[Result, Mapping[str, float]]] = []
        parts = []
        for case in self.cases:
            given = dict(zip(case.opened.paths, values.tolist(), strict=True))
            try:
                graph = kept_graph(case.opened.model, {**case.opened.given, **given})
                run = simulate(graph, case.until, **self.options)
                self.runs += 1
                parts.append(case.residuals(run))
            except HybondError as error:
                self.error = error
                many = sum(int((~np.isnan(c)).sum()) for c in case.data.columns.values())
                parts.append(np.full(many, np.inf))
                continue
            runs.append((run, given))
        found = np.concatenate(parts)
        self._last = key, runs, found
        return found

    def slopes(self, values: Vector) -> Vector:
        """Return the derivatives of all residuals by values, shape (residuals, free)."""
        self.residuals(values)
        assert self._last is not None
        self.missing, self.why = 0, ""
        parts = []
        for case, (run, given) in zip(self.cases, self._last[1], strict=True):
            found = slotted(case.opened, given)
            varied = Varied.of(run, found, case.signals, case.data.t.tolist())
            parts.append(self._rows(case, varied, found))
        return np.concatenate(parts)

    def _rows(self, case: FittedData, varied: Varied, found: Wanted) -> Vector:
        chain = varied.chain
        d = chain.forward()
        times = np.array([r.t for r in chain.readings])
        if chain.ends is not None and not self.why:
            self.why = f"at t = {chain.ends:.6g} s {chain.why}"
        rows = []
        for i, column in enumerate(case.data.columns.values()):
            size = case.sizes[case.signals[i]]
            for t in case.data.t[~np.isnan(column)].tolist():
                k = int(np.searchsorted(times, t, side="right")) - 1
                if k < 0 or times[k] != t or (chain.ends is not None and t >= chain.ends):
                    # a value still, only without a slope
                    self.missing += 1
                    rows.append(np.zeros(len(found.names)))
                    continue
                reading = chain.readings[k]
                row = reading.by[i] @ d[reading.place] + reading.direct[i]
                rows.append(row @ found.follows / size)
        return np.array(rows)

    def last_runs(self) -> list[Result]:
        """Return the runs of the last trial."""
        assert self._last is not None
        return [run for run, _ in self._last[1]]
