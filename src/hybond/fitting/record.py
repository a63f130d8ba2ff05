"""`Fit`: values that were found, and how well the data tell them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hybond.fitting.data import Data
from hybond.fitting.varied import value_of
from hybond.names import in_columns, plural
from hybond.result import Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Vector = NDArray[np.float64]
OTHERS = 4
"""Other minima that are told."""


@dataclass(frozen=True, slots=True)
class Minimum:
    """Where searches from several starts ended.

    Parameters
    ----------
    values : tuple of float
        SI.
    left : float
        The sum of what residuals count there: of their squares, unless the loss says otherwise.
    starts : int
        How many searches ended there.
    """

    values: tuple[float, ...]
    left: float
    starts: int


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """Values of a model that bring its runs to data; made by `fit`.

    Parameters
    ----------
    names : tuple of str
        What was free.
    paths : tuple of str
        Where that is set in the model.
    values : array, shape (free,)
        SI.
    low, high : array, shape (free,)
        The 95 % confidence interval of each, from the slopes at the end; infinite where the data
        do not tell.
    units : tuple of str
    start : array, shape (free,)
        Where the search began.
    correlation : array, shape (free, free)
    residual : mapping
        By signal, the root of the mean square of what is left, SI.
    measurements : int
    runs : tuple of Result
        With the values that were found, one for each set of data.
    data : tuple of Data
    trials : int
        Runs that it took.
    converged : bool
    notes : tuple of str
        What else is to be known.
    starts : int
        How often the search began.
    minima : tuple of Minimum
        If more than once: where searches ended, the best first.
    """

    names: tuple[str, ...]
    paths: tuple[str, ...]
    values: Vector
    low: Vector
    high: Vector
    units: tuple[str, ...]
    start: Vector
    correlation: Vector
    residual: Mapping[str, float]
    measurements: int
    runs: tuple[Result, ...] = field(repr=False)
    data: tuple[Data, ...] = field(repr=False)
    trials: int
    converged: bool
    notes: tuple[str, ...] = ()
    starts: int = 1
    minima: tuple[Minimum, ...] = ()

    def __getitem__(self, name: str) -> float:
        """Return a value by name, SI.

        Raises
        ------
        UsageError
            HB-A523 for a name that was not free.
        """
        return value_of(name, self.names, self.values)

    @property
    def parameters(self) -> dict[str, float]:
        """The values by path, for ``hb.simulate(model, parameters=...)``."""
        return dict(zip(self.paths, self.values.tolist(), strict=True))

    def plot(self, path: str | Path | None = None) -> Figure:
        """Plot the data and the runs with the values that were found.

        Parameters
        ----------
        path : path, optional
            Write the figure there too, in the format of its ending.
        """
        from hybond.draw.variation_plots import plot_fit

        return plot_fit(self, path=path)

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _lines(self) -> Iterator[str]:
        title = self.runs[0].title if self.runs else ""
        files = ", ".join(d.name for d in self.data)
        yield f"{title}: fitted to {self.measurements} measurements of {files}"
        rows = [["", "value", "95 % interval", "start"]]
        for k, name in enumerate(self.names):
            interval = f"{self.low[k]:.6g} .. {self.high[k]:.6g}"
            unit = f" {self.units[k]}" if self.units[k] else ""
            rows.append([name, f"{self.values[k]:.6g}{unit}", interval, f"{self.start[k]:.6g}"])
        yield from (f"  {line}" for line in in_columns(rows))
        for i in range(len(self.names)):
            for j in range(i):
                if abs(self.correlation[i, j]) > 0.95:
                    yield (
                        f"{self.names[j]} and {self.names[i]} are told together: correlation "
                        f"{self.correlation[i, j]:.3f}"
                    )
        left = ", ".join(f"{v:.4g} of {name}" for name, v in self.residual.items())
        yield f"left, root mean square: {left}; {self.trials} {plural('run', self.trials)}"
        yield from self._told_of_minima()
        yield from self.notes

    def _told_of_minima(self) -> Iterator[str]:
        if not self.minima:
            return
        best, *others = self.minima
        lost = self.starts - sum(m.starts for m in self.minima)
        failed = f"; from {lost} the model does not run" if lost else ""
        yield f"{best.starts} of {self.starts} starts end here{failed}"
        for other in others[:OTHERS]:
            at = ", ".join(f"{n} = {v:.6g}" for n, v in zip(self.names, other.values, strict=True))
            ratio = f"{other.left / best.left:.4g} times" if best.left > 0.0 else "more than"
            yield f"  {other.starts} at {at}, where {ratio} as much is left"
        if len(others) > OTHERS:
            rest = sum(m.starts for m in others[OTHERS:])
            yield f"  {rest} in {len(others) - OTHERS} more minima"

    def to_dict(self) -> dict[str, object]:
        """Return all numbers as plain data, SI."""

        def plain(values: Vector) -> list[float | None]:
            return [v if np.isfinite(v) else None for v in values.tolist()]

        return {
            "free": list(self.names),
            "values": plain(self.values),
            "low": plain(self.low),
            "high": plain(self.high),
            "units": list(self.units),
            "start": plain(self.start),
            "correlation": [plain(row) for row in self.correlation],
            "residual": dict(self.residual),
            "measurements": self.measurements,
            "trials": self.trials,
            "converged": self.converged,
            "notes": list(self.notes),
            "starts": self.starts,
            "minima": [
                {"values": list(m.values), "left": m.left, "starts": m.starts} for m in self.minima
            ],
        }
