"""`Sensitivities`: derivatives of a run, read by name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.linear.words import unit_over
from hybond.errors import NumericsError, UsageError
from hybond.names import did_you_mean, numbers_in_columns
from hybond.result import Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class EventDerivative:
    """How the instant of an event moves.

    Parameters
    ----------
    t : float
        s.
    event : int
        Its number in the table of the run, from 0.
    text : str
        What became zero; or, where the instant has no derivative, why.
    by : array, shape (wrt,), or None
        The derivatives of `t`; None where it has none.
    """

    t: float
    event: int
    text: str
    by: Vector | None


@dataclass(frozen=True, slots=True, eq=False)
class Sensitivities:
    """Derivatives of a run by parameters and starts; made by `sensitivities`.

    Parameters
    ----------
    run : Result
    wrt : tuple of str
        What it is differentiated by.
    values : array, shape (wrt,)
        What these are, SI.
    units : tuple of str
    of : tuple of str
        What is differentiated: signals.
    of_units : tuple of str
    t : array, shape (points,)
        s. At a switch twice: before and after it.
    y : array, shape (points, of)
        The signals, SI.
    derivatives : array, shape (points, of, wrt)
    events : tuple of EventDerivative
        Those of the run's table, but for the start, up to where the derivatives end.
    ends : float or None
        Where the derivatives end before the run does, s.
    why : str
        Why they end there.
    notes : tuple of str
        What else is to be known.
    """

    run: Result = field(repr=False)
    wrt: tuple[str, ...]
    values: Vector
    units: tuple[str, ...]
    of: tuple[str, ...]
    of_units: tuple[str, ...]
    t: Vector
    y: Vector
    derivatives: Vector
    events: tuple[EventDerivative, ...]
    ends: float | None = None
    why: str = ""
    notes: tuple[str, ...] = ()

    def __getitem__(self, name: str | tuple[str, str]) -> Vector:
        """Return the derivatives of a signal, shape (points, wrt); by one thing: (points,).

        Raises
        ------
        UsageError
            HB-A523 for a name that was not asked for.
        """
        if isinstance(name, tuple):
            return np.asarray(self[name[0]][:, place_of(name[1], self.wrt, "wrt")])
        return np.asarray(self.derivatives[:, place_of(name, self.of, "of")])

    def at(self, t: float, name: str, by: str) -> float:
        """Return one derivative at a time that was asked for; at a switch after it.

        Raises
        ------
        UsageError
            HB-A523 for a name or a time that was not asked for.
        NumericsError
            HB-A524 behind the end of the derivatives.
        """
        if self.ends is not None and t >= self.ends:
            raise self._over(t)
        k = int(np.searchsorted(self.t, t, side="right")) - 1
        if k < 0 or self.t[k] != t:
            raise UsageError(
                f"{t:g} s is not among the times",
                code="HB-A523",
                where="t",
                hint=f"ask for it: hb.sensitivities(..., times=[{t:g}])",
            )
        return float(self[name, by][k])

    def final(self, name: str, by: str) -> float:
        """Return one derivative at the end of the run.

        Raises
        ------
        UsageError
            HB-A523 for a name that was not asked for.
        NumericsError
            HB-A524 if the derivatives end before.
        """
        found = self[name, by]
        if self.ends is not None:
            raise self._over(self.run.t_end)
        return float(found[-1])

    def of_event(self, event: int, by: str) -> float:
        """Return the derivative of the instant of an event, by its number in the run's table.

        Raises
        ------
        UsageError
            HB-A523 for what was not asked for, or an event that there is not.
        NumericsError
            HB-A524 if the instant has no derivative.
        """
        place = place_of(by, self.wrt, "wrt")
        for found in self.events:
            if found.event == event and found.by is not None:
                return float(found.by[place])
        events = self.run.trace.events
        if not 1 <= event < len(events):
            raise UsageError(
                f"there is no event {event}",
                code="HB-A523",
                where="event",
                hint=f"1 to {len(events) - 1}; 0 is the start",
            )
        raise self._over(events[event].t)

    def _over(self, t: float) -> NumericsError:
        assert self.ends is not None
        return NumericsError(
            f"at {t:.9g} s there is no derivative: at {self.ends:.9g} s {self.why}",
            code="HB-A524",
            where=f"t = {self.ends:.9g} s",
            hint="end the run before, or take other values",
        )

    def unit(self, name: str, by: str) -> str:
        """Return the unit of a derivative, SI."""
        over = self.units[place_of(by, self.wrt, "wrt")]
        return unit_over(self.of_units[place_of(name, self.of, "of")], over)

    def plot(self, *names: str, path: str | Path | None = None) -> Figure:
        """Plot signals' derivatives, each times its parameter: what a change by a part makes.

        Parameters
        ----------
        names : str
            Signals; default: all.
        path : path, optional
            Write the figure there too, in the format of its ending.
        """
        from hybond.draw.variation_plots import plot_sensitivities

        for name in names:
            place_of(name, self.of, "of")
        figure: Figure = plot_sensitivities(self, names or self.of, path=path)
        return figure

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _lines(self) -> Iterator[str]:
        end = self.run.t_end if self.ends is None else self.ends
        yield f"{self.run.title}: derivatives by {', '.join(self.wrt)}"
        head = ["t [s]", "", *(f"by {w}" for w in self.wrt)]
        rows = [head]
        for e in self.events:
            if e.by is not None:
                rows.append([f"{e.t:.9g}", e.text, *(f"{v:.6g}" for v in e.by)])
        if len(rows) > 1:
            yield "instants of events"
            yield from numbers_in_columns(rows, words=(0, 1))
        if len(self.t):
            yield f"{'at the end' if self.ends is None else 'before that'}, t = {end:.9g} s"
            rows = [["", "value", *(f"by {w}" for w in self.wrt)]]
            for i, name in enumerate(self.of):
                row = [f"{v:.6g}" for v in self.derivatives[-1, i]]
                rows.append([name, f"{self.y[-1, i]:.6g}", *row])
            yield from numbers_in_columns(rows, words=(0, 1))
        if self.ends is not None:
            yield f"no derivatives from {self.ends:.9g} s on: {self.why}"
        yield from self.notes


def place_of(name: str, known: Sequence[str], where: str) -> int:
    """Return where a name is among those that were asked for.

    Raises
    ------
    UsageError
        HB-A523.
    """
    if name not in known:
        raise UsageError(
            f"{name!r} was not asked for",
            code="HB-A523",
            where=where,
            hint=did_you_mean(name, known) or ", ".join(known),
        )
    return known.index(name)
