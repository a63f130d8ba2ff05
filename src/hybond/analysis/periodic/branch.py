"""`Continuation`: branches of orbits along a parameter, with what is passed on them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.periodic.arc import OrbitPoint
from hybond.analysis.periodic.points import KINDS, SpecialPoint
from hybond.errors import UsageError
from hybond.names import did_you_mean, html_lines, html_table
from hybond.units import format_quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Vector = NDArray[np.float64]
What = Literal["begin", "max", "min", "mean"]


@dataclass(frozen=True, slots=True, eq=False)
class Branch:
    """Orbits that follow one another along a parameter.

    Parameters
    ----------
    multiple : int
        How many periods of what drives them, or of the orbits that they were doubled from, they
        need.
    points : tuple of OrbitPoint
    special : tuple of SpecialPoint
        What is passed, in order.
    ended : str
        Why it ends.
    born : SpecialPoint or None
        The period doubling that it begins at, a little beside it.
    """

    multiple: int
    points: tuple[OrbitPoint, ...]
    special: tuple[SpecialPoint, ...]
    ended: str
    born: SpecialPoint | None = None

    @property
    def values(self) -> Vector:
        """The parameter, shape (points,), SI."""
        return np.array([p.value for p in self.points])

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Which of them are stable, shape (points,)."""
        return np.array([p.stable for p in self.points], dtype=bool)

    def of(self, signal: str, what: What = "begin", *, turn: int = 0) -> Vector:
        """Return a signal of each orbit: at its beginning, or its extreme or mean over the period.

        Parameters
        ----------
        signal : str
        what : {"begin", "max", "min", "mean"}
        turn : int
            Of orbits that need several periods of what drives them: at which one's beginning.

        Raises
        ------
        UsageError
            HB-S109 for a signal that there is not, HB-A544 for another value or turn.
        """
        if isinstance(turn, bool) or not isinstance(turn, int) or not 0 <= turn < self.multiple:
            raise _nothing(f"turn = {turn!r}", "turn", f"0 to {self.multiple - 1}")
        return np.array([value_of(p, signal, what, turn / self.multiple) for p in self.points])


def value_of(point: OrbitPoint, signal: str, what: What, part: float = 0.0) -> float:
    """Return a signal of an orbit; at its beginning, or a part of the period later.

    Raises
    ------
    UsageError
        HB-A544 for what is no value of one, HB-S109 for a signal that there is not.
    """
    if what not in get_args(What):
        raise _nothing(
            f"an orbit has no {what!r} of a signal", "what", did_you_mean(str(what), get_args(What))
        )
    read, run = point.run[signal], point.run
    if what == "begin":
        t = (point.period if run.t_begin else 0.0) + part * point.period
        return float(read.at(t if t <= run.t_end else t - point.period))
    return float(getattr(read, what)())


def _nothing(why: str, where: str, hint: str) -> UsageError:
    return UsageError(why, code="HB-A544", where=where, hint=hint)


@dataclass(frozen=True, slots=True, eq=False)
class Continuation:
    """Branches of orbits along a parameter; made by `continuation`.

    Parameters
    ----------
    title : str
    parameter : str
    unit : str
    branches : tuple of Branch
        The one that was followed first, then those that were doubled from it.
    runs : int
        Shots, all together.
    notes : tuple of str
    """

    title: str
    parameter: str
    unit: str
    branches: tuple[Branch, ...]
    runs: int
    notes: tuple[str, ...] = ()

    @property
    def special(self) -> tuple[SpecialPoint, ...]:
        """What is passed on all branches."""
        return tuple(s for b in self.branches for s in b.special)

    def __getitem__(self, kind: str) -> tuple[SpecialPoint, ...]:
        """Return what is passed of one kind, ``found["period doubling"]``; empty if nothing is.

        Raises
        ------
        UsageError
            HB-A544 for what is no kind.
        """
        if kind not in KINDS:
            raise _nothing(f"{kind!r} is no kind of point", "kind", did_you_mean(str(kind), KINDS))
        return tuple(s for s in self.special if s.kind == kind)

    def plot(
        self, signal: str | None = None, what: What = "begin", *, path: str | Path | None = None
    ) -> Figure:
        """Plot a signal of all orbits over the parameter; dashed where they are not stable.

        Parameters
        ----------
        signal : str, optional
            Default: what the experiment plots first, else the first state.
        what : {"begin", "max", "min", "mean"}
            Which value of it.
        path : path, optional
            Write the figure there too, in the format of its ending.
        """
        from hybond.draw.orbit_plots import plot_continuation

        graph = self.branches[0].points[0].run.graph
        plotted = tuple(graph.experiment.get("plot", ()))
        chosen = signal or (plotted or tuple(self.branches[0].points[0].run.names))[0]
        figure: Figure = plot_continuation(self, chosen, what, value_of, path=path)
        return figure

    def to_data(self) -> dict[str, Any]:
        """Return plain lists and texts, for JSON; complex numbers as pairs."""
        return {
            "title": self.title,
            "parameter": self.parameter,
            "unit": self.unit,
            "runs": self.runs,
            "notes": list(self.notes),
            "branches": [
                {
                    "multiple": b.multiple,
                    "ended": b.ended,
                    "points": [_data(p) for p in b.points],
                    "special": [
                        {
                            "kind": s.kind,
                            "value": s.value,
                            "within": s.within,
                            "text": s.text,
                            "orbit": _data(s.orbit),
                        }
                        for s in b.special
                    ],
                }
                for b in self.branches
            ],
        }

    def to_json(self) -> str:
        """Return the same as JSON text."""
        return json.dumps(self.to_data(), ensure_ascii=False) + "\n"

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        lines = [line for line in self._lines() if not line.startswith("  ")]
        rows = [(s.kind, self._value(s), s.text) for s in self.special]
        return html_lines(lines) + html_table(rows)

    def _value(self, point: SpecialPoint) -> str:
        return f"{self.parameter} = {point.value:.9g} {self.unit}".rstrip()

    def _lines(self) -> Iterator[str]:
        yield f"{self.title}: orbits along {self.parameter}"
        for branch in self.branches:
            values = branch.values
            low, high = (format_quantity(v, self.unit or "1") for v in (values[0], values[-1]))
            times = f", {branch.multiple} periods each" if branch.multiple > 1 else ""
            yield (
                f"{len(values)} orbits{times}, from {low} to {high}, {_stretches(branch)}; "
                f"{branch.ended}"
            )
            wide = max((len(s.kind) for s in branch.special), default=0)
            many = max((len(self._value(s)) for s in branch.special), default=0)
            for s in branch.special:
                yield f"  {s.kind.ljust(wide)}  {self._value(s).ljust(many)}  {s.text}".rstrip()
        yield f"{self.runs} periods run"
        yield from self.notes


def _stretches(branch: Branch) -> str:
    stable = branch.stable
    if stable.all():
        return "all stable"
    if not stable.any():
        return "none stable"
    return f"{int(stable.sum())} of them stable"


def _data(point: OrbitPoint) -> dict[str, Any]:
    return {
        "value": point.value,
        "period": point.period,
        "stable": point.stable,
        "state": dict(point.state),
        "mode": dict(point.mode),
        "multipliers": [
            {"value": [m.value.real, m.value.imag], "kind": m.kind} for m in point.multipliers
        ],
    }
