"""Which states some mode holds in: verification by the phase space of what is stored.

At an instant every state must have a mode in which time goes on. Mosterman & Biswas verify this
mode by mode: what is stored does not change while modes are tried, so that the conditions that
leave a mode cut its part out of the phase space, and the parts that are left must cover all of it.
Here one stored quantity is swept, the instant is settled at each value as a run would, and the
values at which this changes are found by bisection.

Source: P. J. Mosterman and G. Biswas, *A hybrid modeling and simulation methodology for dynamic
physical systems*, SIMULATION 78(1), 2002, on divergence of time and its verification.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.calls import called
from hybond.engine.outcome.apart import Apart
from hybond.errors import DivergenceOfTime, HybondError, UsageError
from hybond.model.builder import Model
from hybond.model.given import check_model
from hybond.model.graph import AnyMode, FlatGraph, Mode
from hybond.model.planar_friction import kept_paths
from hybond.names import did_you_mean

Vector = NDArray[np.float64]

MODES = 64
"""All modes are looked at if there are not more than this."""
EDGE = 1e-13
"""Part of the range to which its edges are found: closer to zero, values are only rounding."""

What = tuple[str | None, tuple[str, ...], str]
"""The mode that holds, those that were passed before, and the code of a refusal."""


@dataclass(frozen=True, slots=True)
class Tried:
    """One mode at an instant: the rules that leave it at once, or why it cannot be entered."""

    mode: str
    left_by: tuple[str, ...]
    barred: str = ""

    def __str__(self) -> str:
        """Return it as a line."""
        if self.barred:
            return f"({self.mode}) cannot be entered: {self.barred}"
        if not self.left_by:
            return f"({self.mode}) would hold, but no rule leads there"
        return f"({self.mode}) is left by {'; '.join(self.left_by)}"


@dataclass(frozen=True, slots=True)
class Range:
    """Values of the swept quantity at which the same happens."""

    low: float
    high: float
    holds: str | None
    """The mode in which time goes on; None if there is none."""
    passed: tuple[str, ...]
    """The modes passed before."""
    tried: tuple[Tried, ...] = ()
    """Where no mode holds: what becomes of each."""
    why: str = ""
    """Where no mode holds: what the run would say, such as the cycle of modes."""


@dataclass(frozen=True, slots=True)
class Coverage:
    """What `coverage` found; its text names what no mode covers."""

    quantity: str
    at: Mapping[str, float]
    mode: str
    ranges: tuple[Range, ...]

    @property
    def uncovered(self) -> tuple[Range, ...]:
        """The ranges in which no mode holds."""
        return tuple(r for r in self.ranges if r.holds is None)

    def record(self) -> dict[str, Any]:
        """Return everything as plain data that JSON can hold."""
        return {
            "quantity": self.quantity,
            "at": dict(self.at),
            "from": self.mode,
            "ranges": [asdict(r) for r in self.ranges],
        }

    def __str__(self) -> str:
        """Return the ranges; for those without a mode, which guard throws each mode out."""
        where = ", ".join(f"{name} = {value:.6g}" for name, value in self.at.items())
        lines = [f"from ({self.mode})" + (f" with {where}" if where else "")]
        for r in self.ranges:
            span = f"  {self.quantity} from {r.low:.6g} to {r.high:.6g}: "
            if r.holds is None:
                lines += [f"{span}no mode holds", *(f"    {t}" for t in r.tried or (r.why,))]
            else:
                path = [*(f"({p})" for p in r.passed), f"({r.holds})"]
                lines.append(span + " -> ".join(path))
        return "\n".join(lines)


@called("hb.coverage(model)")
def coverage(
    model: Model | FlatGraph,
    quantity: str,
    low: float,
    high: float,
    *,
    at: Mapping[str, float] | None = None,
    mode: AnyMode | None = None,
    points: int = 200,
) -> Coverage:
    """Settle the instant at every value of one stored quantity, and say where no mode holds.

    Parameters
    ----------
    model : Model or FlatGraph
    quantity : str
        What is swept: a stored quantity such as ``ball.p``, or an integrated signal.
    low, high : float
        From where to where, in SI.
    at : mapping
        Values of others; what is not named is at its start.
    mode : mapping, optional
        The mode that the instant is entered from, by default the start mode.
    points : int
        Values to begin with; a range narrower than their distance may be missed.

    Returns
    -------
    Coverage

    Raises
    ------
    UsageError
        HB-A209 for a name that nothing is stored under, or a range that is none.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("relay")
    >>> m.add(c=hb.C(1), n=hb.Zero(), f=hb.Sf(0), s=hb.One(), r=hb.R(1))
    >>> m.bond("f -> n -> c", "n -> s -> r")
    >>> m.machine("m", states={"off": [], "on": ["s"]}, start="off",
    ...           rules=["off -> on when c.e > 1", "on -> off when c.e < 2"])
    >>> print(hb.coverage(m, "c.q", 0, 3))
    from (off)
      c.q from 0 to 1: (off)
      c.q from 1 to 2: no mode holds
        (off) is left by m: c.e > 1
        (on) is left by m: c.e < 2
      c.q from 2 to 3: (on)
    """
    check_model(model)
    graph = model.flatten() if isinstance(model, Model) else model
    instant = _Instant(graph, dict(at or {}), mode)
    instant.index(quantity)
    if quantity in (at or {}):
        raise UsageError(
            f"{quantity} is swept and held at {(at or {})[quantity]:g}",
            code="HB-A209",
            where=quantity,
            hint="leave it out of what is held",
        )
    if not (math.isfinite(low) and math.isfinite(high) and low < high and points >= 2):
        raise UsageError(
            f"{quantity} from {low:g} to {high:g} in {points} points is no range",
            code="HB-A209",
            where=quantity,
            hint="low < high, and at least 2 points",
        )
    # not at round numbers: what happens at a single value is not what happens around it
    grid = low + (high - low) * (np.arange(points) + 0.5) / points
    found = [instant.settled(quantity, float(a)) for a in grid]
    ranges: list[Range] = []
    begin = float(low)
    for k, what in enumerate(found):
        last = k + 1 == len(found)
        if not last and found[k + 1] == what:
            continue
        ends = float(grid[k]), float(grid[min(k + 1, points - 1)])
        end = float(high) if last else _edge(instant, quantity, *ends, EDGE * (high - low))
        middle = 0.5 * (begin + end)
        holds, passed, _ = what
        tried, why = instant.explained(quantity, middle) if holds is None else ((), "")
        ranges.append(Range(begin, end, holds, passed, tried, why))
        begin = end
    return Coverage(quantity, dict(at or {}), graph.mode_text(instant.mode), tuple(ranges))


def _edge(instant: _Instant, quantity: str, a: float, b: float, close: float) -> float:
    """Return where what happens at `a` ends, by bisection."""
    here = instant.settled(quantity, a)
    while b - a > close and a < (middle := 0.5 * (a + b)) < b:
        a, b = (middle, b) if instant.settled(quantity, middle) == here else (a, middle)
    return 0.0 if abs(b) <= 10.0 * close else b


class _Instant:
    """The instant t = 0 of a model, settled from any state."""

    def __init__(self, graph: FlatGraph, at: Mapping[str, float], mode: AnyMode | None) -> None:
        self.graph = graph
        self.apart = Apart(graph)
        self.mode: Mode = graph.start_mode if mode is None else graph.mode_of(mode)
        self.start = self.apart.start
        for name, value in at.items():
            self.start[self.index(name)] = value

    def index(self, name: str) -> int:
        """Return the place of a stored quantity or integrated signal in the state."""
        places = {s.path: s.index for s in self.graph.storages}
        kept = kept_paths(self.graph)
        nx = len(self.graph.storages)
        places |= {i.path: nx + i.index for i in self.graph.integrals if i.path not in kept}
        if name not in places:
            raise UsageError(
                f"nothing is stored under {name!r}",
                code="HB-A209",
                where=name,
                hint=did_you_mean(name, places) or f"one of {', '.join(places)}",
            )
        return places[name]

    def settled(self, quantity: str, value: float) -> What:
        """Return the mode in which time goes on, None if there is none, and those passed."""
        try:
            return self._settle(quantity, value)
        except HybondError as error:
            return None, (), error.code

    def _settle(self, quantity: str, value: float) -> What:
        event = self.apart.settled(self._state(quantity, value), self.mode)
        text = self.graph.mode_text
        steps = event.steps
        if steps[0].kind == "mythical" and not (steps[0].fired or steps[0].impulses):
            # where it began: nothing led there
            steps = steps[1:]
        return text(steps[-1].mode), tuple(text(step.mode) for step in steps[:-1]), ""

    def _state(self, quantity: str, value: float) -> Vector:
        y = self.start.copy()
        y[self.index(quantity)] = value
        return y

    def explained(self, quantity: str, value: float) -> tuple[tuple[Tried, ...], str]:
        """Return which rules leave each mode, entered from the same state, and the refusal."""
        why = ""
        try:
            self._settle(quantity, value)
        except DivergenceOfTime as error:
            why = error.why
        except HybondError as error:
            # not the modes' guards: the instant has no solution
            return (), f"{error.code}: {error.why}"
        y = self._state(quantity, value)
        choices = [
            (self.mode[m.index],) if m.law is not None else range(len(m.states))
            for m in self.graph.machines
        ]
        if math.prod(len(c) for c in choices) > MODES:
            return (), why
        found = []
        for mode in itertools.product(*choices):
            left: list[str] = []
            barred = ""
            try:
                leaving = self.apart.leaving(y, self.mode, mode)
                left = [f"{m}: {text}" for m, texts in leaving.items() for text in texts]
            except HybondError as error:
                barred = error.why
            found.append(Tried(self.graph.mode_text(mode), tuple(left), barred))
        return tuple(found), why
