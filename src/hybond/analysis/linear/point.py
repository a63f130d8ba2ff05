"""A point at which a model is linearised: where it is in its states, and in which mode."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.engine.outcome.apart import Apart
from hybond.engine.outcome.signals import Signals
from hybond.equations.slots import slots_of
from hybond.errors import ModelError, NumericsError, UsageError
from hybond.model.expressions import Expr, Name
from hybond.model.graph import FlatGraph, Mode
from hybond.model.unit_words import unit_of
from hybond.names import did_you_mean
from hybond.options import seconds
from hybond.result import Result
from hybond.units import is_of, try_quantity

Vector = NDArray[np.float64]

MOVED = 1e-9
"""Part of the largest stored quantity of its kind by which a given state may be off."""


@dataclass(frozen=True, slots=True)
class Point:
    """Where a model is.

    Parameters
    ----------
    t : float
        s.
    mode : Mode
    state : array, shape (states,)
        Stored quantities, then integrated signals, SI.
    values : mapping
        Of every canonical name.
    landed : bool
        Whether machines stay in a state whose impacts are over.
    said : str
        The point in words.
    """

    t: float
    mode: Mode
    state: Vector
    values: Mapping[str, float]
    landed: bool = False
    said: str = ""


def names_at(graph: FlatGraph) -> list[Expr]:
    """Return every canonical name of a graph."""
    return [Name(name) for name in slots_of(graph).index]


def valued(graph: FlatGraph, signals: Signals, t: float, state: Vector, mode: Mode) -> Point:
    """Return a point by its state: the engine tells all bond variables.

    Raises
    ------
    NumericsError
        If a law has no value there.
    """
    asked = names_at(graph)
    found = signals.after(t, state, mode, asked)
    return Point(t, mode, state, dict(zip(slots_of(graph).index, found, strict=True)))


def time_in(run: Result, at: float | str) -> float:
    """Return a time within a run, s.

    Raises
    ------
    UsageError
        HB-S110 for a time outside the run.
    """
    if not run.segments:
        raise UsageError(
            "the run has no motion", code="HB-S110", where="at", hint="run it for some time first"
        )
    if isinstance(at, str) and at in ("start", "end"):
        t = run.t_begin if at == "start" else run.t_end
    else:
        t = seconds(at, "at")
    run.sample([t], [])
    return t


def of_run(run: Result, t: float) -> Point:
    """Return the point of a run at a time; at an event after all that happened there.

    Raises
    ------
    NumericsError
        HB-A505 where it slides and has no one mode.
    """
    graph = run.graph
    events = run.trace.events
    said = f"t = {t:.9g} s of the run"
    if t == run.t_end and t > 0.0 and events and events.times[-1] == t:
        last = events[-1]
        if last.cause != "step" and not last.landed:
            found = valued(graph, run.signals, t, last.after, last.steps[-1].mode)
            return Point(t, found.mode, last.after, found.values, said=said)
    starts = run.trace.segments.times
    segment = run.segments[max(int(np.searchsorted(starts, t, side="right")) - 1, 0)]
    if segment.sliding is not None:
        slides = run.sliding[segment.sliding]
        raise NumericsError(
            f"at {t:.9g} s the motion slides along {', '.join(slides.surfaces)}: no one mode holds "
            "there",
            code="HB-A505",
            where="at",
            hint="take a time outside the sliding, or a model in which friction or the relay is "
            "smooth",
        )
    state = np.asarray(segment.at(t))[: len(graph.storages) + len(graph.integrals)]
    if segment.bonds is not None:
        found = valued(graph, run.signals, t, state, segment.mode)
        return Point(t, segment.mode, state, found.values, said=said)
    read = run.signals.of(segment, names_at(graph), np.array([t]))
    values = {name: float(v[0]) for name, v in zip(slots_of(graph).index, read, strict=True)}
    state = np.array(
        [values[f"x:{s.index}"] for s in graph.storages]
        + [values[f"s:{i.index}"] for i in graph.integrals]
    )
    return Point(t, segment.mode, state, values, landed=bool(segment.landed), said=said)


def of_start(graph: FlatGraph, mode: Mode, *, chosen: bool) -> Point:
    """Return the point at which a run starts, in the mode in which it goes on.

    With `chosen` it is an error if that is another mode than the one that is asked for.
    """
    return entered(Apart(graph), graph, Apart(graph).start, mode, chosen=chosen, said="the start")


def of_states(
    graph: FlatGraph, given: Mapping[str, float | str], mode: Mode, *, chosen: bool
) -> Point:
    """Return a point by its states; those left out are as at the start.

    Raises
    ------
    UsageError
        HB-A503 for a name that is no state, or a value that does not fit it.
    NumericsError
        HB-A504 if the states that are given contradict each other.
    """
    apart = Apart(graph)
    state = apart.start.copy()
    places: dict[str, int] = {s.path: s.index for s in graph.storages}
    places |= {i.path: len(graph.storages) + i.index for i in graph.integrals}
    for name, value in given.items():
        if name not in places:
            raise UsageError(
                f"{name!r} is no stored quantity and no integrated signal",
                code="HB-A503",
                where="at",
                hint=did_you_mean(name, places) or ", ".join(places),
            )
        state[places[name]] = _number(graph, name, value)
    found = entered(apart, graph, state, mode, chosen=chosen, said="the states that are given")
    sizes = {"x": np.abs(state[: len(graph.storages)]), "s": np.abs(state)}
    for name in given:
        k = places[name]
        largest = max(float(sizes["x"].max(initial=0.0)), abs(state[k]))
        if abs(found.state[k] - state[k]) > MOVED * largest:
            raise NumericsError(
                f"{name} = {state[k]:.6g} cannot stay: the mode makes it {found.state[k]:.6g}, "
                "because it follows from other states or from a source",
                code="HB-A504",
                where=graph.mode_text(found.mode),
                hint="give all states that depend on each other, with values that fit",
            )
    return found


def entered(
    apart: Apart, graph: FlatGraph, state: Vector, mode: Mode, *, chosen: bool, said: str
) -> Point:
    """Return where a run would go on from a state and a mode.

    Raises
    ------
    ModelError
        HB-A507 if a mode was chosen, and is left at once.
    """
    event = apart.settled(state, mode)
    last = event.steps[-1].mode
    if chosen and last != mode:
        raise ModelError(
            f"at this point the mode ({graph.mode_text(mode)}) is left at once for "
            f"({graph.mode_text(last)})",
            code="HB-A507",
            where="mode",
            hint="leave the mode out to take the one that holds, or give other states",
        )
    found = valued(graph, apart.signals, 0.0, event.after, last)
    return Point(0.0, last, event.after, found.values, bool(event.landed), said)


def _number(graph: FlatGraph, name: str, value: float | str) -> float:
    """Return a state as a number in SI."""
    if isinstance(value, str):
        quantity = try_quantity(value)
        assert graph.read is not None
        unit = unit_of(graph.read(name), graph)
        if quantity is None or not is_of(quantity, unit):
            raise UsageError(
                f"{name} = {value!r} is not in {unit or 'a unit that is known'}",
                code="HB-A503",
                where="at",
                hint="a number in SI, or a quantity such as '5 mm'",
            )
        return quantity.value
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise UsageError(
            f"{name} = {value!r} is no number", code="HB-A503", where="at", hint="a number in SI"
        )
    return float(value)
