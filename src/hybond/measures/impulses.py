"""The impulses of a signal within a window: at which instants, with which areas."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

import numpy as np

from hybond.errors import UsageError
from hybond.measures.window import Window
from hybond.model.expressions import Expr, Number, differentiate, names, simplify
from hybond.names import plural
from hybond.records import dataclass
from hybond.runs.trace import Event

if TYPE_CHECKING:
    from hybond.result import Result

SAME = 1e-9
"""Part of a factor by which it may differ before and after a jump and count as the same."""


@dataclass(frozen=True, slots=True)
class Impulse:
    """An impulse of a signal: its time, s, and its area."""

    t: float
    area: float


def impulses_in(run: Result, name: str, window: Window) -> tuple[Impulse, ...]:
    """Return the impulses of a signal, or of an expression, within a window.

    Steps of one instant that write add up; a mythical step writes nothing. In time-stepping
    impulses are forces within a step, and there are none beside them.

    Raises
    ------
    UsageError
        HB-R105 if the impulse part of the expression has no meaning there: a product of two
        impulses, a factor that jumps, a function of one.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("ball", domain="translational")
    >>> m.add(ball=hb.I("2 kg", f="3 m/s"), v=hb.One(), stop=hb.Sf("0 m/s"))
    >>> m.bond("v -> ball", "stop -> v")
    >>> run = hb.simulate(m, until="1 s")
    >>> impulses_in(run, "2*ball.e", Window(0.0, 1.0, True))
    (Impulse(t=0.0, area=-12.0),)
    """
    expression = run.expression(name)
    read = {n for n in names(expression) if n[:2] in ("e:", "f:")}
    if not read:
        return ()
    found = []
    for event in run.events.with_impulses():
        if event.cause == "step" or not window.has(event.t):
            continue
        area = 0.0
        expression = run.expression_of(run._segment_at(event.t, "right"), name)
        for step in event.steps:
            struck = sorted(read & step.areas.keys()) if step.kind != "mythical" else []
            for variable in struck:
                factor = _factor(run, name, expression, variable, event, step.areas.keys())
                area += factor * step.areas[variable]
        if area:
            found.append(Impulse(event.t, area))
    return tuple(found)


def _factor(
    run: Result, name: str, e: Expr, variable: str, event: Event, struck: Collection[str]
) -> float:
    """Return what an expression multiplies an impulse with."""
    slope = simplify(differentiate(e, variable))
    if isinstance(slope, Number):
        return float(slope.value)
    if not set(struck).isdisjoint(names(slope)):
        raise _meaningless(run, name, event, "it is not linear in what has an impulse")
    if event.t == run.t_begin and any(n[:2] in ("e:", "f:", "x:") for n in names(slope)):
        # what it was before the run is not known
        raise _meaningless(run, name, event, "what it multiplies an impulse with begins there")
    k = run._segment_at(event.t, "right")
    beside = sorted({k, max(k - 1, 0)} if event.t > run.t_begin else {k})
    at = np.full(len(beside), event.t)
    (values,) = run._of([slope], np.array(beside), at)
    least, most = float(values.min()), float(values.max())
    if not abs(most - least) <= SAME * max(abs(most), abs(least)):
        raise _meaningless(run, name, event, "what it multiplies an impulse with jumps there")
    return float(values[-1])


def _meaningless(run: Result, name: str, event: Event, why: str) -> UsageError:
    return UsageError(
        f"{name} has no meaning at t = {event.t:.9g} s: {why}",
        code="HB-R105",
        where=name,
        hint="measure the signals apart, or a window without this instant: run.explain"
        f"({event.t:.9g}) tells it",
    )


def told(found: tuple[Impulse, ...], what: str) -> str:
    """Return that impulses were included or left out."""
    if not found:
        return ""
    return f"{len(found)} {plural('impulse', len(found))} {what}"
