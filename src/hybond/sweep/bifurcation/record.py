"""`Bifurcation`: samples of all values, what they repeat, and the windows that they make."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.errors import HybondError, UsageError
from hybond.files.whole import write_rows, write_whole
from hybond.names import did_you_mean, html_lines, html_table
from hybond.sweep.bifurcation.branch import Branch
from hybond.sweep.bifurcation.question import refusal
from hybond.sweep.bifurcation.values import Values
from hybond.sweep.bifurcation.windows import Windows, windows_of
from hybond.units import DIMENSIONLESS, try_quantity

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Bifurcation:
    """A bifurcation diagram: signals, looked at once a period or at events, over a parameter.

    Parameters
    ----------
    title : str
        Of the model.
    values : array, shape (values,)
        Of the parameter, SI, from the smallest to the greatest.
    branches : tuple of Branch
        One for each direction: what was sampled, periods, sequences of modes.
    how : str
        How many values were run, and how.
    interrupted : bool
    seconds : float
    """

    title: str
    values: Vector
    branches: tuple[Branch, ...]
    how: str
    interrupted: bool
    seconds: float
    runner: Values = field(repr=False)

    @property
    def parameter(self) -> str:
        """The path of what varies."""
        return self.runner.question.factor.path

    @property
    def unit(self) -> str:
        """Its unit, empty if it has none."""
        dimension = self.runner.question.factor.dimension
        return "" if dimension is None else str(dimension)

    @property
    def of(self) -> tuple[str, ...]:
        """The signals."""
        return self.runner.question.of

    @property
    def units(self) -> dict[str, str]:
        """The units of the signals."""
        return dict(zip(self.of, self.runner.question.units, strict=True))

    @property
    def section(self) -> str:
        """When signals are looked at, in words."""
        q = self.runner.question
        alone = q.period.replace(".", "", 1).replace("e-", "", 1).isdecimal()
        once = f"once in {q.period}{' s' if alone else ''}"
        when = once if q.period else f"each time {q.at} is entered"
        return f"{when}, {'before' if q.cut.before else 'after'} what happens there"

    @property
    def errors(self) -> dict[tuple[str, int], HybondError]:
        """What stopped runs, by branch and number of the value."""
        return {(b.direction, k): e for b in self.branches for k, e in b.errors.items()}

    def branch(self, direction: str) -> Branch:
        """Return the branch of a direction.

        Raises
        ------
        UsageError
            HB-P133.
        """
        for found in self.branches:
            if found.direction == direction:
                return found
        known = [b.direction for b in self.branches]
        raise _missing(
            f"there is no branch {direction!r}",
            "branch",
            did_you_mean(direction, known) or ", ".join(known),
        )

    def points(
        self, signal: str | None = None, direction: str | None = None
    ) -> tuple[Vector, Vector]:
        """Return parameter and signal of all samples, two arrays of one length.

        Raises
        ------
        UsageError
            HB-P133 for a signal or a branch that there is not.
        """
        name = self._signal(signal)
        branches = self.branches if direction is None else (self.branch(direction),)
        across, up = [], []
        for b in branches:
            y = b.samples[name]
            x = np.broadcast_to(self.values[:, None], y.shape)
            there = np.isfinite(y)
            across.append(x[there])
            up.append(y[there])
        return np.concatenate(across), np.concatenate(up)

    def windows(
        self, tolerance: float | str | None = None, *, settle: int | None = None
    ) -> Windows:
        """Return the stretches of the parameter in which one orbit is seen.

        Values next to each other belong to one window if period and sequence of modes are the same.
        With a tolerance each orbit is followed beyond its last values, the state carried on, to
        where it ends, and what is between is halved; windows of orbits that coexist overlap then.

        Parameters
        ----------
        tolerance : float or str
            Of the borders, in the unit of the parameter or a quantity. Where an orbit loses its
            stability slowly, as at a period doubling, they are as exact as it has settled: give a
            longer `settle`. Default: windows end in the middle between two values.
        settle : int
            Periods, or events, in which an orbit settles that is followed; default as it was.

        Raises
        ------
        UsageError
            HB-P131 for a tolerance that is none.
        """
        number = self._tolerance(tolerance)
        if settle is not None and (not isinstance(settle, int) or settle < 0):
            raise refusal(f"settle = {settle!r}", "settle", "a whole number, 0 or more")
        found = []
        for b in self.branches:
            found += windows_of(self.runner, b, self.values.tolist(), number, settle)
        return Windows.of(found, self.parameter, self.unit)

    def plot(
        self, signal: str | None = None, *, windows: bool = True, path: str | Path | None = None
    ) -> Any:
        """Draw the diagram, windows named above it; write it to a file with `path`.

        Raises
        ------
        UsageError
            HB-P133 for a signal that there is not.
        """
        from hybond.draw.bifurcation_plot import draw_bifurcation

        return draw_bifurcation(self, self._signal(signal), windows=windows, path=path)

    # -- as data

    def table(self) -> dict[str, NDArray[Any]]:
        """Return columns with a row for each sample: parameter, branch, period, time, signals."""
        columns: dict[str, list[NDArray[Any]]] = {}
        for b in self.branches:
            there = np.isfinite(b.when)
            k = np.nonzero(there)[0]
            own: dict[str, NDArray[Any]] = {
                self.parameter: self.values[k],
                "direction": np.full(len(k), b.direction, dtype=object),
                "period": b.period[k],
                "t": b.when[there],
                **{name: b.samples[name][there] for name in self.of},
            }
            for name, column in own.items():
                columns.setdefault(name, []).append(column)
        return {name: np.concatenate(column) for name, column in columns.items()}

    def to_csv(self, path: str | Path) -> None:
        """Write the table, a row for each sample."""
        write_rows(path, self.table())

    def to_dict(self) -> dict[str, Any]:
        """Return everything as plain data in SI; None where there is no number."""
        q = self.runner.question
        return {
            "title": self.title,
            "parameter": self.parameter,
            "unit": self.unit,
            "values": self.values.tolist(),
            "signals": list(self.of),
            "units": self.units,
            "period": q.period or None,
            "at": q.at or None,
            "before": q.cut.before,
            "settle": q.cut.settle,
            "keep": q.cut.keep,
            "tolerance": q.tolerance,
            "longest": q.longest,
            "branches": [self._branch_data(b) for b in self.branches],
            "windows": [w.to_dict() for w in self.windows()],
            "interrupted": self.interrupted,
            "how": self.how,
            "seconds": self.seconds,
        }

    def to_json(self, path: str | Path) -> None:
        """Write everything as JSON."""
        write_whole(path, json.dumps(self.to_dict(), ensure_ascii=False, allow_nan=False) + "\n")

    def _branch_data(self, b: Branch) -> dict[str, Any]:
        def plain(row: list[float]) -> list[float | None]:
            return [x if math.isfinite(x) else None for x in row]

        return {
            "direction": b.direction,
            "samples": {n: [plain(row) for row in x.tolist()] for n, x in b.samples.items()},
            "t": [plain(row) for row in b.when.tolist()],
            "periods": b.period.tolist(),
            "settled": b.settled.tolist(),
            "events": plain(b.events.tolist()),
            "sequences": list(b.sequence),
            "errors": [{"value": k, **e.to_dict()} for k, e in b.errors.items()],
            "warnings": [{"value": k, "warnings": list(w)} for k, w in b.warnings.items()],
        }

    # -- names

    def _signal(self, signal: str | None) -> str:
        if signal is None:
            return self.of[0]
        if signal not in self.of:
            hint = did_you_mean(str(signal), self.of) or ", ".join(self.of)
            raise _missing(f"{signal!r} was not looked at", "signal", hint)
        return signal

    def _tolerance(self, tolerance: float | str | None) -> float | None:
        if tolerance is None:
            return None
        quantity = try_quantity(tolerance) if isinstance(tolerance, str) else None
        number = tolerance if isinstance(tolerance, float | int) else None
        if quantity is not None:
            own = self.runner.question.factor.dimension
            if quantity.dimension in (own or DIMENSIONLESS, DIMENSIONLESS):
                number = quantity.value
        if number is None or not 0.0 < number < math.inf:
            raise refusal(
                f"tolerance = {tolerance!r}", "tolerance", f"above zero, in {self.unit or 'SI'}"
            )
        return float(number)

    @property
    def notes(self) -> tuple[str, ...]:
        """What is to be known of how far values have come."""
        cut = self.runner.question.cut
        slow = sum(int((~b.settled & (b.period > 0)).sum()) for b in self.branches)
        short = 0
        for b in self.branches:
            there = np.isfinite(b.when).sum(axis=1)
            failed = np.isin(np.arange(len(there)), list(b.errors))
            short += int(((there < cut.keep) & ~failed).sum())
        found = []
        if slow:
            found.append(
                f"{slow} of all values still settle after {cut.settle} periods: their period is "
                "extrapolated; a longer `settle` tells it"
            )
        if none := sum(int((b.period == 0).sum()) for b in self.branches):
            found.append(
                f"{none} of all values came to no period: they are irregular, or have not settled "
                f"after {cut.settle} periods, which a longer `settle` tells"
            )
        if short and not self.interrupted:
            found.append(
                f"{short} of all values came to fewer than {cut.settle} + {cut.keep} samples in "
                "the time that they have: a longer `limit` lets them"
            )
        return tuple(found)

    def __str__(self) -> str:
        head = f"{self.title}\n{', '.join(self.of)}, {self.section}"
        notes = "".join(f"\nnote: {note}" for note in self.notes)
        return f"{head}\n{self.windows()!r}\n{self.how}, {self.seconds:.3g} s{notes}"

    def __repr__(self) -> str:
        periods = sorted({int(p) for b in self.branches for p in b.period.tolist() if p > 0})
        said = f"periods {', '.join(map(str, periods))}" if periods else "no periods"
        rest = sum(int((b.period == 0).sum()) for b in self.branches)
        stopped = sum(len(b.errors) for b in self.branches)
        said += f", {rest} not periodic" if rest else ""
        said += f", {stopped} stopped" if stopped else ""
        many = len(self.values)
        return f"<Bifurcation {self.title!r}: {many} values of {self.parameter}, {said}>"

    def _repr_html_(self) -> str:
        head = ("branch", f"{self.parameter} from", "to", "what", "events", "modes", "end")
        rows = []
        for w in self.windows():
            low, high = f"{w.low:.6g}", f"{w.high:.6g}"
            rows.append((w.direction, low, high, w.name, f"{w.events:.3g}", w.orbit, w.ends_in))
        return html_lines([repr(self)[1:-1]]) + html_table(rows, head)


def _missing(why: str, where: str, hint: str) -> UsageError:
    return UsageError(why, code="HB-P133", where=where, hint=hint)
