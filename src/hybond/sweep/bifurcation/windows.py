"""Windows: stretches of the parameter with one orbit, and how far it can be followed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hybond.engine.compiled.sections import Carry
from hybond.names import in_columns
from hybond.sweep.bifurcation.branch import Branch
from hybond.sweep.bifurcation.orbits import Orbit, Word, turned
from hybond.sweep.bifurcation.values import Point, Values
from hybond.units import format_quantity

IMPACT = "impact"
"""The state of machines in which a contact is hit."""
CLOSE = 1.0 / 16.0
"""Of the distance of two values: from nearer than that a value goes on only if it does not from
there, so that it has to settle, and shows whether it does."""
STEPS = 8
"""From the last value to one that it has missed."""


@dataclass(frozen=True, slots=True)
class Window:
    """A stretch of the parameter in which one orbit is seen.

    Parameters
    ----------
    direction : str
        The branch: ``fresh``, ``up`` or ``down``.
    first, last : int
        Numbers of its values.
    low, high : float
        Where it begins and ends; in the middle between two values if it was not followed further.
    low_error, high_error : float
        Half of what is between the last value with the orbit and the first one without; nan at the
        end of the diagram, beyond which nobody has looked.
    period : int
        0: none up to the longest one looked for; -1: runs that stopped.
    events : float
        Modes entered in a period of the section, on average.
    orbit : str
        The modes of one turn; samples are apart by bars.
    ends_in : str
        What becomes of it at its upper end: ``period doubling``, ``period halving``, ``border
        collision``, ``grazing``, ``irregular``; empty at the end of the diagram.
    """

    direction: str
    first: int
    last: int
    low: float
    high: float
    low_error: float
    high_error: float
    period: int
    events: float
    orbit: str
    ends_in: str = ""

    @property
    def name(self) -> str:
        """``period 3``, ``not periodic`` or ``stopped``."""
        return {0: "not periodic", -1: "stopped"}.get(self.period, f"period {self.period}")

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data; None where there is no number."""
        found = {name: getattr(self, name) for name in self.__slots__}
        return {
            name: None if isinstance(v, float) and not math.isfinite(v) else v
            for name, v in found.items()
        }


class Windows(tuple[Window, ...]):
    """Windows in order of branch and parameter; prints as a table."""

    unit: str = ""
    path: str = ""

    @staticmethod
    def of(windows: Sequence[Window], path: str, unit: str) -> Windows:
        """Return windows of a parameter."""
        found = Windows(windows)
        found.path, found.unit = path, unit
        return found

    def periodic(self) -> Iterator[Window]:
        """Yield those with a period."""
        return (w for w in self if w.period > 0)

    def __repr__(self) -> str:
        rows = [["branch", "from", "to", "orbit", "events", "modes of a turn", "ends in"]]
        for w in self:
            low, high = self._border(w.low, w.low_error), self._border(w.high, w.high_error)
            seen = [f"{w.events:.3g}", _short(w.orbit)] if w.period > 0 else ["", ""]
            rows.append([w.direction, low, high, w.name, *seen, w.ends_in])
        return "\n".join([f"windows of {self.path}", *(f"  {line}" for line in in_columns(rows))])

    def _border(self, at: float, error: float) -> str:
        if not math.isfinite(error):
            return format_quantity(at, self.unit or "1", digits=6)
        digits = 6
        if error > 0.0 and at != 0.0:
            digits = min(max(math.ceil(math.log10(abs(at) / error)) + 1, 3), 12)
        return format_quantity(at, self.unit or "1", digits=digits)


def _short(text: str) -> str:
    return text if len(text) <= 60 else f"{text[:57]}..."


def spans_of(branch: Branch) -> list[tuple[int, int]]:
    """Return the first and last number of values in a row with one orbit."""
    found: list[tuple[int, int]] = []
    for k, orbit in enumerate(branch.orbits):
        if found and _same(branch.orbits[k - 1], orbit):
            found[-1] = found[-1][0], k
        else:
            found.append((k, k))
    return found


def _same(a: Orbit | None, b: Orbit | None) -> bool:
    if a is None or b is None:
        return a is b
    return a.kind == b.kind


def windows_of(
    values: Values,
    branch: Branch,
    at: Sequence[float],
    tolerance: float | None,
    settle: int | None,
) -> list[Window]:
    """Return the windows of a branch; with a tolerance each orbit is followed to where it ends."""
    spans = spans_of(branch)
    borders: list[tuple[float, float, float, float]] = []
    for first, last in spans:
        low, low_error = _between(at, first - 1, first)
        high, high_error = _between(at, last, last + 1)
        orbit = branch.orbits[first]
        if tolerance is not None and orbit is not None and orbit.period > 0:
            follow = Follower(values, branch, at, tolerance, settle)
            if first > 0:
                low, low_error = follow.from_value(first, -1)
            if last + 1 < len(at):
                high, high_error = follow.from_value(last, 1)
        borders.append((low, high, low_error, high_error))
    found = []
    for k, (first, last) in enumerate(spans):
        low, high, low_error, high_error = borders[k]
        orbit = branch.orbits[first]
        period = -1 if orbit is None else orbit.period
        if period <= 0 and tolerance is not None:
            # what is between two orbits that were followed
            if k > 0:
                low, low_error = borders[k - 1][1], borders[k - 1][3]
            if k + 1 < len(spans):
                high, high_error = borders[k + 1][0], borders[k + 1][2]
        events = [o.events for o in branch.orbits[first : last + 1] if o is not None]
        ends_in = "" if k + 1 == len(spans) else change_of(values, branch, first, spans[k + 1][0])
        found.append(
            Window(
                branch.direction,
                first,
                last,
                *(low, high, low_error, high_error, period),
                float(np.mean(events)) if events else math.nan,
                "" if orbit is None else values.word_text(orbit.words),
                ends_in,
            )
        )
    return found


def _between(at: Sequence[float], a: int, b: int) -> tuple[float, float]:
    if a < 0:
        return float(at[b]), math.nan
    if b >= len(at):
        return float(at[a]), math.nan
    return 0.5 * (float(at[a]) + float(at[b])), 0.5 * abs(float(at[b]) - float(at[a]))


def change_of(values: Values, branch: Branch, left: int, right: int) -> str:
    """Return what lies between two orbits, as far as their periods and events say."""
    a, b = branch.orbits[left], branch.orbits[right]
    if a is None or b is None:
        return "stopped"
    if not a.period or not b.period:
        return "irregular"
    few, many = (a, b) if a.period <= b.period else (b, a)
    if many.period == 2 * few.period and many.words == turned(few.words * 2):
        return "period doubling" if few is a else "period halving"
    if _impacts(values, a.words) * b.period != _impacts(values, b.words) * a.period:
        return "grazing"
    return "border collision"


def _impacts(values: Values, words: tuple[Word, ...]) -> int:
    hit = [
        any(m.states[k] == IMPACT for m, k in zip(values.machines, mode, strict=True))
        for mode in values.modes
    ]
    return sum(hit[m] for word in words for m in word[1:])


class Follower:
    """Follows an orbit to where it ends, and halves what is between.

    Parameters
    ----------
    values : Values
    branch : Branch
    at : sequence of float
        Values of the parameter.
    tolerance : float
        In the unit of the parameter.
    settle : int or None
        Periods that each value takes to settle.
    """

    def __init__(
        self,
        values: Values,
        branch: Branch,
        at: Sequence[float],
        tolerance: float,
        settle: int | None,
    ) -> None:
        self.values, self.branch, self.at = values, branch, at
        self.tolerance, self.settle = tolerance, settle

    def from_value(self, k: int, way: int) -> tuple[float, float]:
        """Return where the orbit of a value ends, up (1) or down (-1), and half what is left."""
        orbit, carry = self.branch.orbits[k], self.branch.carries[k]
        assert orbit is not None
        inside, j = float(self.at[k]), k + way
        while True:
            if not 0 <= j < len(self.at):
                return float(self.at[k]), math.nan
            outside = float(self.at[j])
            again = self._goes_on(orbit, carry, outside)
            if again is None:
                break
            inside, carry, k, j = outside, again, j, j + way
        apart = abs(outside - inside)
        near = carry
        while abs(outside - inside) > 2.0 * self.tolerance:
            middle = 0.5 * (inside + outside)
            if middle in (inside, outside):
                break
            again = self._goes_on(orbit, carry, middle)
            if again is None:
                # little may be attracted there, less and less: short steps lead to it
                again = self._goes_on(orbit, near, *np.linspace(inside, middle, STEPS + 1)[1:])
            if again is None:
                outside = middle
                continue
            inside, near = middle, again
            if abs(outside - middle) > CLOSE * apart:
                carry = again
        return 0.5 * (inside + outside), 0.5 * abs(outside - inside)

    def _goes_on(self, orbit: Orbit, carry: Carry | None, *values: float) -> Carry | None:
        """Return where the last of some values has come if its orbit is the same; else None."""
        points: list[Point] = []
        self.values.carried(
            np.array(values), lambda _, found: points.extend(found), carry, self.settle
        )
        found = self.branch.orbit_of(points[-1], self.values)
        return points[-1].carry if found is not None and found.kind == orbit.kind else None
