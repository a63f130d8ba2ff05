"""`gradient`: a goal of a run and its derivatives, forward or by the adjoint.

The chain of a run is d_k+1 = M_k d_k + G_k dp. A goal is l @ d_K + g @ dp at its end, or at the
switch whose instant it is. Forward, all columns of d go through the chain; the adjoint goes back
through the same links with the one row l:

    for k = K - 1 ... 0:   g = g + G_k^T l,   l = M_k^T l          then  g = g + d_0^T l

It is the adjoint of the steps themselves, so that both ways differ by rounding only. The adjoint
costs one row whatever the number of parameters.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Unpack

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.linear.words import unit_over
from hybond.analysis.sensitivity.collocation import Jump
from hybond.analysis.sensitivity.goals import EventTime, Final, Goal, Total
from hybond.analysis.sensitivity.landing import Landing
from hybond.analysis.sensitivity.opened import Opened, opened_model
from hybond.analysis.sensitivity.record import place_of
from hybond.analysis.sensitivity.sensitivities import Varied, check_followed, signal_of
from hybond.analysis.sensitivity.wanted import slotted
from hybond.calls import called
from hybond.errors import NumericsError, UsageError
from hybond.model.builder import Model
from hybond.model.expressions import names
from hybond.model.parts import Value
from hybond.model.unit_words import unit_of
from hybond.result import Result
from hybond.runs.asked import MethodOptions
from hybond.simulation import simulate

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Gradient:
    """A goal and its derivatives; made by `gradient`.

    Parameters
    ----------
    goal : Final, Total or EventTime
    value : float
        SI.
    wrt : tuple of str
    by : array, shape (wrt,)
    units : tuple of str
        Of `by`.
    run : Result
    notes : tuple of str
        What else is to be known.
    """

    goal: Goal
    value: float
    wrt: tuple[str, ...]
    by: Vector
    units: tuple[str, ...]
    run: Result = field(repr=False)
    notes: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> float:
        """Return the derivative by one thing.

        Raises
        ------
        UsageError
            HB-A523 for a name that was not asked for.
        """
        return float(self.by[place_of(name, self.wrt, "wrt")])

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _lines(self) -> Iterator[str]:
        yield f"{self.goal} = {self.value:.9g}"
        wide = max(len(name) for name in self.wrt)
        for name, value, unit in zip(self.wrt, self.by.tolist(), self.units, strict=True):
            yield f"  by {name.ljust(wide)}  {value:.6g} {unit}".rstrip()
        yield from self.notes


@called('hb.gradient(model, hb.Final("c.e"), "1 s", wrt=["R"])', options=MethodOptions)
def gradient(
    model: Model,
    goal: Goal,
    until: float | str | None = None,
    *,
    wrt: Sequence[str] | str,
    mode: Literal["adjoint", "forward"] = "adjoint",
    parameters: Mapping[str, Value] | None = None,
    **options: Unpack[MethodOptions],
) -> Gradient:
    """Return a goal of a run and its derivatives, through all switches.

    Parameters
    ----------
    model : Model
    goal : Final, Total or EventTime
        The value of a signal at the end, an integral over the run, or the instant of an event.
    until : float or str
        End time; by default that of the experiment.
    wrt : sequence of str
        As for `sensitivities`.
    mode : {"adjoint", "forward"}
        The same numbers: back through the run with one row, or forward with a column for each.
    parameters, **options
        As for `sensitivities`.

    Raises
    ------
    UsageError
        HB-A525 for what is no goal, or an event that the run does not have; others as
        `sensitivities`.
    NumericsError
        HB-A524 if the derivatives end before the goal.
    HybondError
        As `simulate`.

    Examples
    --------
    The energy that a resistor takes from a capacitor, 0.5 J, all of it whatever R is:

    >>> import hybond as hb
    >>> m = hb.Model("rc", parameters={"R": "2 ohm"}, domain="electrical")
    >>> m.add(c=hb.C("1 F", e="1 V"), r=hb.R("R"), n=hb.Zero())
    >>> m.bond("n -> c", "n -> r")
    >>> g = hb.gradient(m, hb.Total("r.e*r.f"), "100 s", wrt=["R", "c.C", "c.e"])
    >>> round(g.value, 9), [round(v, 9) + 0.0 for v in g.by.tolist()]
    (0.5, [0.0, 0.5, 1.0])
    """
    if not isinstance(goal, Final | Total | EventTime):
        raise no_goal(goal)
    if mode not in ("adjoint", "forward"):
        raise UsageError(
            f"mode = {mode!r}", code="HB-A525", where="mode", hint="adjoint or forward"
        )
    opened = opened_model(model, wrt, parameters or {})
    return gradient_of(opened, {}, goal, until, mode, options)


def no_goal(goal: object) -> UsageError:
    """Return what is said of something that is no goal."""
    return UsageError(
        f"{goal!r} is no goal",
        code="HB-A525",
        where="goal",
        hint='hb.Final("c.e"), hb.Total("r.e*r.f") or hb.EventTime(1)',
    )


def gradient_of(
    opened: Opened,
    given: Mapping[str, Value],
    goal: Goal,
    until: float | str | None,
    mode: Literal["adjoint", "forward"],
    options: Mapping[str, Any],
) -> Gradient:
    """Return the gradient of a model that is opened, with other values of what is varied.

    Parameters
    ----------
    given : mapping of path to value
        By the names of `opened.paths`.
    options : mapping
        Of `simulate`.
    """
    found = slotted(opened, given)
    check_followed(found.graph)
    run = simulate(found.plain, until, **options)
    outputs = [goal.signal] if isinstance(goal, Final) else []
    integrands = [goal.signal] if isinstance(goal, Total) else []
    varied = Varied.of(run, found, outputs, [], integrands)
    value, rows, direct, unit = _goal(varied, goal)
    by = _backward(varied, rows, direct)
    if mode == "forward":
        d = varied.chain.forward()
        by = direct + sum(row @ d[place] for place, row in rows.items())
    units = tuple(unit_over(unit, u) for u in found.units)
    notes = () if isinstance(goal, EventTime) else varied.chain.notes()
    return Gradient(goal, value, found.names, by @ found.follows, units, run, notes)


def _goal(varied: Varied, goal: Goal) -> tuple[float, dict[int, Vector], Vector, str]:
    """Return a goal as its value, rows at places of the chain, what parameters add, its unit."""
    chain, graph = varied.chain, varied.run.graph
    if isinstance(goal, EventTime):
        number = _number(varied.run, goal)
        for instant in chain.instants:
            if instant.event == number and instant.place is not None:
                link = chain.links[instant.place]
                if isinstance(link, Landing):
                    return instant.t, *link.rows(), "s"
                assert isinstance(link, Jump)
                return instant.t, {instant.place: link.time}, link.time_by, "s"
    if chain.ends is not None:
        raise NumericsError(
            f"{goal} has no derivative: at {chain.ends:.9g} s {chain.why}",
            code="HB-A524",
            where=f"t = {chain.ends:.9g} s",
            hint="end the run before, or take other values",
        )
    places = len(chain.links)
    if isinstance(goal, Final):
        last = chain.readings[-1]
        unit = unit_of(signal_of(graph, goal.signal), graph)
        return float(last.values[0]), {last.place: last.by[0]}, last.direct[0], unit
    assert isinstance(goal, Total)
    e = signal_of(graph, goal.signal)
    for event in varied.run.trace.events:
        for step in event.steps:
            hit = names(e) & step.areas.keys()
            if hit and step.kind != "mythical":
                raise NumericsError(
                    f"{goal} has no derivative: at {event.t:.9g} s it has an impulse",
                    code="HB-A524",
                    where=f"t = {event.t:.9g} s",
                    hint="integrate something else: what is stored tells the area",
                )
    row = np.zeros(varied.fields.size)
    row[-1] = 1.0
    value = float(varied.run[goal.signal].integral())
    unit = unit_of(e, graph)
    nothing = np.zeros(len(varied.found.names))
    return value, {places: row}, nothing, f"{unit}*s" if unit else "s"


def _number(run: Result, goal: EventTime) -> int:
    """Return the number of an event in the table of a run."""
    events = run.trace.events
    if not goal.machine:
        numbers = list(range(1, len(events)))
        wanted = goal.number if goal.number in numbers else None
    else:
        numbers = [
            k
            for k in range(1, len(events))
            if any(f.machine == goal.machine for step in events[k].steps for f in step.fired)
        ]
        wanted = numbers[goal.number - 1] if 1 <= goal.number <= len(numbers) else None
    if wanted is None:
        raise UsageError(
            f"the run has no such event: {goal}",
            code="HB-A525",
            where="goal",
            hint=f"there are {len(numbers)}; look at run.events",
        )
    return wanted


def _backward(varied: Varied, rows: Mapping[int, Vector], direct: Vector) -> Vector:
    """Return the derivatives of a goal by the adjoint."""
    g, waiting = direct.copy(), dict(rows)
    last = max(waiting)
    adjoint = waiting.pop(last)
    for place in range(last - 1, -1, -1):
        link = varied.chain.links[place]
        if isinstance(link, Landing):
            adjoint, more, (at, row) = link.backward(adjoint)
            waiting[at] = waiting.get(at, 0.0) + row
        else:
            adjoint, more = link.backward(adjoint)
        g += more
        adjoint = adjoint + waiting.pop(place, 0.0)
    return np.asarray(g + varied.chain.start.T @ adjoint)
