"""How a signal gets from one value to another: rise, overshoot, settling."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

from hybond.errors import UsageError
from hybond.measures.averages import without_impulses
from hybond.measures.crossings import crossings_of
from hybond.measures.extremes import extreme_of
from hybond.measures.value import shown
from hybond.measures.window import TOLERANCE, Window
from hybond.names import html_table
from hybond.records import dataclass

if TYPE_CHECKING:
    from hybond.result import Result


@dataclass(frozen=True, slots=True)
class StepInfo:
    """A step response.

    Parameters
    ----------
    initial, final : float
        Values from and to which it goes, SI.
    rise_time : float or None
        From `low` to `high` of the way, s; None if it does not get so far.
    overshoot, undershoot : float
        How far it goes beyond the final value, and back behind the initial one, as parts of the
        way.
    peak, peak_time : float
        The value farthest on the way, and when it is taken after the begin of the window, s.
    settling_time : float or None
        From the begin of the window until it stays within `band` of the final value, s; None if
        it is outside at the end.
    band, low, high : float
        As asked for, parts of the way.
    unit : str
    """

    initial: float
    final: float
    rise_time: float | None
    overshoot: float
    undershoot: float
    peak: float
    peak_time: float
    settling_time: float | None
    band: float
    low: float
    high: float
    unit: str

    def rows(self) -> list[tuple[str, str]]:
        """Return what it is called, and its value for people."""

        def time(t: float | None) -> str:
            return "not reached" if t is None else shown(t, "s")

        return [
            ("initial", shown(self.initial, self.unit)),
            ("final", shown(self.final, self.unit)),
            (f"rise time, {self.low:g} to {self.high:g}", time(self.rise_time)),
            ("overshoot", f"{100.0 * self.overshoot + 0.0:.4g} %"),
            ("undershoot", f"{100.0 * self.undershoot + 0.0:.4g} %"),
            ("peak", f"{shown(self.peak, self.unit)} after {shown(self.peak_time, 's')}"),
            (f"settling time, {100.0 * self.band:g} %", time(self.settling_time)),
        ]

    def to_dict(self) -> dict[str, float | str | None]:
        """Return it as plain data."""
        return asdict(self)

    def __str__(self) -> str:
        rows = self.rows()
        wide = max(len(name) for name, _ in rows)
        return "\n".join(f"{name:{wide}}  {value}" for name, value in rows)

    def _repr_html_(self) -> str:
        return html_table(self.rows())


def step_of(
    run: Result,
    name: str,
    window: Window,
    *,
    initial: float | None = None,
    final: float | None = None,
    band: float = 0.02,
    low: float = 0.1,
    high: float = 0.9,
    tolerance: float = TOLERANCE,
) -> StepInfo:
    """Return how a signal gets from a value to another.

    Parameters
    ----------
    initial, final : float, optional
        By default its values at the begin (before what happens there) and at the end of the
        window.
    band : float
        Around the final value, as a part of the way.
    low, high : float
        Parts of the way between which the rise time is.

    Raises
    ------
    UsageError
        HB-R101 for parts that are none; HB-R106 for impulses; HB-R108 if there is no way to go.
    """
    if not (0.0 <= low < high <= 1.0 and 0.0 < band < 1.0):
        raise UsageError(
            f"band = {band!r}, low = {low!r}, high = {high!r}",
            code="HB-R101",
            where="step_info",
            hint="parts of the way: band=0.02, low=0.1, high=0.9",
        )
    without_impulses(run, name, window, "refuse", "step response")
    signal = run[name]
    side_of_end = "left" if window.end < run.t_end else "right"
    first = float(signal.at(window.start, side="right" if window.first else "left"))
    last = float(signal.at(window.end, side=side_of_end))  # type: ignore[arg-type]
    begin = first if initial is None else float(initial)
    goal = last if final is None else float(final)
    way = goal - begin
    top = max(abs(begin), abs(goal))
    if not abs(way) > 1e-9 * top:
        raise UsageError(
            f"{name} goes from {begin:.6g} to {goal:.6g}: there is no step",
            code="HB-R108",
            where=name,
            hint="give initial and final, or a window in which it steps",
        )
    sign = 1.0 if way > 0.0 else -1.0

    def options(edge: str) -> dict[str, object]:
        return {"edge": edge, "tolerance": tolerance}

    forth = "rise" if way > 0.0 else "fall"

    def reached(part: float) -> float | None:
        level = begin + part * way
        if sign * (first - level) >= 0.0:
            return window.start
        found = crossings_of(run, name, level, window, **options(forth))  # type: ignore[arg-type]
        return found[0].t if found else None

    from_low, to_high = reached(low), reached(high)
    far = extreme_of(run, name, window, sign, tolerance=tolerance)
    back = extreme_of(run, name, window, -sign, tolerance=tolerance)
    edges = [goal - band * abs(way), goal + band * abs(way)]
    settled: float | None = None
    if abs(last - goal) <= band * abs(way):
        found = [
            c.t
            for level in edges
            for c in crossings_of(run, name, level, window, **options("both"))  # type: ignore[arg-type]
        ]
        settled = max(found, default=window.start) - window.start
    assert far.t is not None
    return StepInfo(
        begin,
        goal,
        None if from_low is None or to_high is None else to_high - from_low,
        max(sign * (float(far) - goal) / abs(way), 0.0),
        max(sign * (begin - float(back)) / abs(way), 0.0),
        float(far),
        far.t - window.start,
        settled,
        band,
        low,
        high,
        signal.unit,
    )
