"""`PeriodicOrbit`: a motion that repeats, with what becomes of motions near it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.linear.words import unit_over
from hybond.analysis.periodic.multipliers import CIRCLE, Multiplier, is_neutral, is_stable
from hybond.errors import HybondError, UsageError
from hybond.measures.signal import Signal
from hybond.names import did_you_mean, html_lines, html_table, numbers_in_columns
from hybond.result import Result
from hybond.runs.states import State
from hybond.units import format_quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Vector = NDArray[np.float64]

SHOWN = 8
"""Signals of which a table says mean and extremes."""


@dataclass(frozen=True, slots=True, eq=False)
class PeriodicOrbit:
    """A motion that repeats; made by `periodic`.

    Parameters
    ----------
    period : float
        After which it repeats, s.
    multiple : int
        How many periods of what drives it that are; 1 where nothing does.
    autonomous : bool
        Whether nothing drives it, so that the period is its own.
    state : State
        At its beginning.
    run : Result
        One period of it.
    states : tuple of str
        The rows and columns of `monodromy`.
    monodromy : array, shape (states, states)
        How the state after a period follows that at its beginning.
    multipliers : tuple of Multiplier
        Its eigenvalues, the largest first.
    wrt : tuple of str
        What `by` is differentiated by.
    by : array, shape (states, wrt)
        How the state at its beginning follows these, so that the motion still repeats.
    period_by : array, shape (wrt,)
    units : tuple of str
        Of what `by` is differentiated by.
    runs : int
        Runs that were made to find it: those that it settled in, and shots.
    periods : float
        Periods of `period` / `multiple` that were run, all together: the work.
    residual : float
        Largest part of a state by which the period does not close.
    history : tuple of float
        The same of all shots.
    free : tuple of str
        What is conserved: there are such motions with other values of it, too.
    notes : tuple of str
    """

    period: float
    multiple: int
    autonomous: bool
    state: State
    run: Result = field(repr=False)
    states: tuple[str, ...]
    monodromy: Vector
    multipliers: tuple[Multiplier, ...]
    wrt: tuple[str, ...]
    by: Vector
    period_by: Vector
    units: tuple[str, ...]
    runs: int
    periods: float
    residual: float
    history: tuple[float, ...]
    free: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def stable(self) -> bool:
        """Whether motions that begin near it come to it: all multipliers are below 1.

        Where something is conserved (`free`), those with the same of it.
        """
        return is_stable(self.multipliers)

    @property
    def neutral(self) -> bool:
        """Whether motions that begin near it neither come to it nor leave it."""
        return is_neutral(self.multipliers)

    @property
    def values(self) -> NDArray[np.complex128]:
        """The multipliers as numbers, shape (states,), the largest first."""
        return np.array([m.value for m in self.multipliers], dtype=complex)

    @property
    def lost(self) -> int:
        """How many directions are lost within a period: multipliers that are zero."""
        return sum(m.kind == "zero" for m in self.multipliers)

    def __getitem__(self, name: str) -> Signal:
        """Return a signal over one period, by name: ``orbit["out.e"].mean()``.

        Raises
        ------
        UsageError
            HB-S109 for a name that there is not.
        """
        return self.run[name]

    def derivative(self, name: str, by: str) -> float:
        """Return how a state at the beginning, or the period, follows what was asked for.

        Parameters
        ----------
        name : str
            One of `states`, or ``"period"``.
        by : str
            One of `wrt`.

        Raises
        ------
        UsageError
            HB-A523 for another name.
        """
        if by not in self.wrt:
            raise UsageError(
                f"{by!r} was not asked for",
                code="HB-A523",
                where="wrt",
                hint=did_you_mean(by, self.wrt) or f"hb.periodic(model, wrt=[{by!r}])",
            )
        j = self.wrt.index(by)
        if name == "period":
            return float(self.period_by[j])
        if name not in self.states:
            raise UsageError(
                f"{name!r} is no state",
                code="HB-A523",
                where="name",
                hint=did_you_mean(name, self.states) or ", ".join(self.states),
            )
        return float(self.by[self.states.index(name), j])

    def plot(self, *names: str, path: str | Path | None = None) -> Figure:
        """Plot signals over one period, and the multipliers in the unit circle.

        Parameters
        ----------
        names : str
            Signals; default: what the experiment plots, else the first ones.
        path : path, optional
            Write the figure there too, in the format of its ending.
        """
        from hybond.draw.orbit_plots import plot_orbit

        figure: Figure = plot_orbit(self, names or self._shown(), path=path)
        return figure

    def to_data(self) -> dict[str, Any]:
        """Return plain lists and texts, for JSON; complex numbers as pairs."""
        return {
            "title": self.run.title,
            "period": self.period,
            "multiple": self.multiple,
            "autonomous": self.autonomous,
            "stable": self.stable,
            "neutral": self.neutral,
            "multipliers": [
                {"value": [m.value.real, m.value.imag], "kind": m.kind} for m in self.multipliers
            ],
            "lost": self.lost,
            "state": {**self.state.stored, **self.state.signals},
            "mode": dict(self.state.machines),
            "states": list(self.states),
            "monodromy": self.monodromy.tolist(),
            "wrt": list(self.wrt),
            "by": self.by.tolist(),
            "period_by": self.period_by.tolist(),
            "signals": {
                name: {"mean": mean, "min": low, "max": high, "unit": unit}
                for name, mean, low, high, unit in self._measured()
            },
            "runs": self.runs,
            "periods": self.periods,
            "residual": self.residual,
            "history": list(self.history),
            "free": list(self.free),
            "notes": list(self.notes),
        }

    def to_json(self) -> str:
        """Return the same as JSON text."""
        return json.dumps(self.to_data(), ensure_ascii=False) + "\n"

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        tables = [
            html_table(self._multiplier_rows(), ("multiplier", "size", "")),
            html_table(self._state_rows(), ("at the beginning", "")),
            html_table(self._signal_rows(), ("over the period", "mean", "least", "largest")),
        ]
        return html_lines(self._head()) + "".join(tables) + html_lines(self._tail())

    # -- words

    def _shown(self) -> tuple[str, ...]:
        return tuple(self.run.graph.experiment.get("plot", ())) or tuple(self.run.names[:3])

    def _measured(self) -> Iterator[tuple[str, float, float, float, str]]:
        plotted = tuple(self.run.graph.experiment.get("plot", ()))
        for name in (plotted or tuple(self.run.names))[:SHOWN]:
            try:
                s = self.run[name]
                yield name, float(s.mean()), float(s.min()), float(s.max()), self.run.unit(name)
            except HybondError:
                continue  # what has no such measure in this run, an impulse of a product

    def _lines(self) -> Iterator[str]:
        yield from self._head()
        yield from numbers_in_columns(
            [["multiplier", "size", ""], *self._multiplier_rows()], words=(0, 2)
        )
        yield "at the beginning"
        yield from numbers_in_columns(self._state_rows(), words=(0,))
        rows = self._signal_rows()
        if rows:
            yield from numbers_in_columns(
                [["over the period", "mean", "least", "largest"], *rows], words=(0,)
            )
        yield from self._tail()

    def _head(self) -> Iterator[str]:
        of = f", {self.multiple} of what drives it" if self.multiple > 1 else ""
        own = ", its own" if self.autonomous else of
        yield f"{self.run.title}: repeats every {format_quantity(self.period, 's')}{own}"
        yield self._said()

    def _said(self) -> str:
        if self.stable:
            same = ", if they have the same of what is conserved" if self.free else ""
            return f"stable: motions near it come to it{same}"
        counts = [m for m in self.multipliers if m.counts]
        if not counts:
            return "neutral: one of a family; which one is decided by where it starts"
        if not self.neutral:
            largest = abs(counts[0].value)
            return f"unstable: a motion near it is {largest:.6g} times as far off after it"
        kinds = [m.kind for m in counts if m.kind in CIRCLE]
        if not kinds:
            return "neutral: motions near it neither come to it nor leave it; nothing damps them"
        if kinds[0] == "Neimark-Sacker":
            return (
                "at a Neimark-Sacker, or where nothing damps: a pair of multipliers is on the unit "
                "circle"
            )
        return f"at a {kinds[0]}: a multiplier is on the unit circle"

    def _multiplier_rows(self) -> list[list[str]]:
        found = [m for m in self.multipliers if m.kind != "zero"]
        rows = [
            [str(m), "0" if m.kind == "fast" else f"{abs(m.value):.9g}", _WORDS.get(m.kind, m.kind)]
            for m in found
        ]
        if self.lost:
            many = f"{self.lost} directions are" if self.lost > 1 else "one direction is"
            rows.append(["0", "0", f"{many} lost within the period"])
        return rows

    def _state_rows(self) -> list[list[str]]:
        values = {**self.state.stored, **self.state.signals}
        rows = [[n, format_quantity(v, self._unit(n))] for n, v in values.items()]
        rows += [[path, state] for path, state in self.state.machines.items()]
        for j, name in enumerate(self.wrt):
            for i, state in enumerate(self.states):
                unit = unit_over(self._unit(state), self.units[j])
                rows.append([f"{state} by {name}", f"{self.by[i, j]:.9g} {unit}".rstrip()])
            if self.period_by[j]:
                rows.append([f"period by {name}", f"{self.period_by[j]:.9g}"])
        return rows

    def _unit(self, name: str) -> str:
        return self.state.units.get(name) or "1"

    def _signal_rows(self) -> list[list[str]]:
        return [
            [name, *(format_quantity(v, unit or "1") for v in values)]
            for name, *values, unit in self._measured()
        ]

    def _tail(self) -> Iterator[str]:
        work = f"{self.runs} runs, {self.periods:.4g} periods"
        yield f"closes to {self.residual:.2g} of a state; {work}"
        for name in dict.fromkeys(self.free):
            many = self.free.count(name)
            times = f" ({many} quantities)" if many > 1 else ""
            yield f"conserved, so that there are others beside it: {name}{times}"
        yield from self.notes


_WORDS = {
    "phase": "1: nothing says when it begins",
    "conserved": "1: something is conserved",
    "neutral": "nothing damps it",
    "fast": "too small to be told",
}
