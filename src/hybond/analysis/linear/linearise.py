"""`linearise`: a model or a run near a point, as matrices."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, overload

import numpy as np

from hybond.analysis.linear.asked import Inputs, inputs_of, outputs_of
from hybond.analysis.linear.equilibrium import equilibrium
from hybond.analysis.linear.linearisation import Linearisation
from hybond.analysis.linear.point import Point, of_run, of_start, of_states, time_in
from hybond.calls import called
from hybond.equations.linear_rows import LinearRows, linear_rows
from hybond.equations.moving_constraints import turned
from hybond.errors import UsageError
from hybond.export.linear.proper import proper
from hybond.export.linear.state_space import check_proper
from hybond.model.builder import Model, graph_of
from hybond.model.expressions import Expr, Name, compile_expression, names
from hybond.model.graph import AnyMode, FlatGraph
from hybond.model.inputs import Constant, Free
from hybond.model.unit_words import unit_of
from hybond.result import Result

States = Mapping[str, float | str]


@overload
def linearise(
    model: Model | FlatGraph | Result,
    *,
    inputs: Sequence[str] | str | None = None,
    outputs: Sequence[str] | str | None = None,
    at: float | str | States | None = None,
    mode: AnyMode | None = None,
) -> Linearisation: ...
@overload
def linearise(
    model: Result,
    *,
    inputs: Sequence[str] | str | None = None,
    outputs: Sequence[str] | str | None = None,
    at: list[Any] | tuple[Any, ...] | np.ndarray[Any, Any],
    mode: AnyMode | None = None,
) -> tuple[Linearisation, ...]: ...
@called('hb.linearise(model, inputs=["V"], outputs=["c.e"], at="equilibrium")')
def linearise(
    model: Model | FlatGraph | Result,
    *,
    inputs: Sequence[str] | str | None = None,
    outputs: Sequence[str] | str | None = None,
    at: Any = None,
    mode: AnyMode | None = None,
) -> Linearisation | tuple[Linearisation, ...]:
    """Return how a model moves near a point of its states, in the mode that holds there.

    Every law is differentiated as the expression that it is; nothing is a difference quotient.
    Storage in derivative causality is not among the states, and goes into the motion of the others.

    Parameters
    ----------
    model : Model, FlatGraph or Result
    inputs : sequence of str, optional
        What is varied: a source (``"V"`` or ``"V.e"``: something is added to its value), an input
        of the model, or a parameter (of a `Model`). Default: all inputs, and the sources that
        have a value of their own.
    outputs : sequence of str, optional
        Signals, or expressions of them. Default: what the experiment plots, or else the states.
    at : optional
        Of a run: a time in s or as ``"2 ms"``, ``"start"`` or ``"end"`` (default); a sequence of
        times gives a tuple. Of a model: ``"start"`` (default); a mapping of stored quantities and
        integrated signals to values, those left out as at the start; or ``"equilibrium"``, the
        rest that Newton's iteration finds from the start.
    mode : tuple of int or mapping, optional
        Of a model: the mode. By default the one that holds at the point; from the start mode where
        there is a choice.

    Returns
    -------
    Linearisation, or a tuple of them for a sequence of times

    Raises
    ------
    UsageError
        HB-A501 for an input that there is not, HB-S109 for an output; HB-A503 for what is no point;
        HB-S110 for a time outside the run.
    EquationError
        HB-A502 for a parameter that cannot be varied, HB-A506 where a law has no finite slope,
        HB-E671 for what is sampled, HB-E672 for an output that needs the derivative of an input,
        HB-Q105 where the mode leaves an output open.
    NumericsError
        HB-A504 for states that contradict each other, HB-A505 where the motion slides, HB-A510
        where there is no equilibrium.
    ModelError
        HB-A507 for a mode that is left at once.

    Examples
    --------
    A tank with a nozzle, at rest where as much leaves as comes: at 25 kPa.

    >>> import hybond as hb
    >>> m = hb.Model("tank", domain="hydraulic", parameters={"Qn": "1 l/s"})
    >>> m.add(Q=hb.Sf("1 l/s"), tank=hb.C("5 l/bar", q="1 l"), n=hb.Zero())
    >>> m.add(out=hb.R({"f": "Qn*sqrt(e/(25 kPa))"}))
    >>> m.bond("Q -> n -> tank", "n -> out")
    >>> lin = hb.linearise(m, inputs=["Q"], outputs=["tank.e"], at="equilibrium")
    >>> round(lin.operating["tank.e"]), lin.exact, lin.poles().round(9).tolist()
    (25000, False, [-0.4])
    """
    if isinstance(model, Result):
        return _of_run(model, inputs, outputs, "end" if at is None else at, mode)
    graph = graph_of(model)
    asked = inputs_of(model, graph, inputs)
    signals = outputs_of(graph, outputs)
    wanted = graph.mode_of({} if mode is None else mode)
    chosen = mode is not None
    notes: list[str] = []
    if isinstance(at, Mapping):
        point = of_states(graph, at, wanted, chosen=chosen)
    elif at is None or (isinstance(at, str) and at == "start"):
        point = of_start(graph, wanted, chosen=chosen)
    elif isinstance(at, str) and at == "equilibrium":
        point, more = equilibrium(graph, wanted, chosen=chosen)
        notes += more
    else:
        raise UsageError(
            f"at = {at!r} is no point of a model",
            code="HB-A503",
            where="at",
            hint='"start", "equilibrium", a mapping of states; a time belongs to a run: '
            "hb.linearise(hb.simulate(model), at=...)",
        )
    return _made(graph, point, asked, signals, notes, steady=at == "equilibrium")


def _of_run(
    run: Result,
    inputs: Sequence[str] | str | None,
    outputs: Sequence[str] | str | None,
    at: Any,
    mode: AnyMode | None,
) -> Linearisation | tuple[Linearisation, ...]:
    if mode is not None:
        raise UsageError(
            "a run says itself in which mode it is",
            code="HB-A503",
            where="mode",
            hint="leave it out, or linearise the model: hb.linearise(model, at={...}, mode=...)",
        )
    if isinstance(at, Mapping) or at == "equilibrium":
        raise UsageError(
            "a run is where it is at some time",
            code="HB-A503",
            where="at",
            hint='a time, "start" or "end"; other states are for the model: hb.linearise(model, '
            "at=...)",
        )

    def near(when: float | str) -> Linearisation:
        t = time_in(run, when)
        own = run.at_one_model(t)
        graph = own.graph
        asked, signals = inputs_of(graph, graph, inputs), outputs_of(graph, outputs)
        return _made(graph, of_run(own, t), asked, signals, [], steady=False)

    if isinstance(at, list | tuple | np.ndarray):
        times = at.tolist() if isinstance(at, np.ndarray) else at
        return tuple(near(t) for t in times)
    return near(at)


def _made(
    graph: FlatGraph,
    point: Point,
    asked: Inputs,
    signals: Mapping[str, Expr],
    notes: list[str],
    *,
    steady: bool,
) -> Linearisation:
    rows = linear_rows(
        asked.graph,
        point.mode,
        point.values,
        inputs=asked.columns,
        outputs=_signals_of(asked.graph, graph, signals),
        landed=point.landed,
    )
    # integrated signals first: what storage follows is told by them, and not the other way round
    first = range(len(graph.storages), rows.stored)
    kept = proper(rows.E, rows.A, rows.B, rows.stored, keep=first).kept
    rows, sure = turned(rows, kept)
    found = proper(rows.E, rows.A, rows.B, rows.stored, keep=kept)
    if not sure or found.kept != kept:
        notes = [*notes, "a constraint that turns with the motion is taken as frozen at the point"]
    states = tuple(rows.variables[k] for k in found.kept)
    outputs = tuple(signals)
    check_proper(found, rows.outputs, outputs, asked.names, graph.mode_text(point.mode))
    canonical = {s.path: Name(f"x:{s.index}") for s in graph.storages}
    canonical |= {i.path: Name(f"s:{i.index}") for i in graph.integrals}
    return Linearisation(
        A=found.A,
        B=found.B,
        C=found.basis[rows.outputs],
        D=found.direct[0][rows.outputs],
        states=states,
        inputs=asked.names,
        outputs=outputs,
        state_units=tuple(unit_of(canonical[name], graph) for name in states),
        input_units=asked.units,
        output_units=tuple(unit_of(e, graph) for e in signals.values()),
        mode=graph.mode_names(point.mode),
        point=point.said,
        t=point.t,
        operating=_operating(point, asked, signals, {n: canonical[n] for n in states}),
        exact=rows.straight,
        kinks=rows.kinks,
        steady=steady,
        notes=tuple([*notes, *_held(graph, rows, point)]),
        shifts=found.direct[0][list(found.kept)],
        title=graph.title or graph.name,
    )


def _signals_of(
    slotted: FlatGraph, graph: FlatGraph, signals: Mapping[str, Expr]
) -> dict[str, Expr]:
    """Return the outputs as the graph with slots says them, where they are signals of the model."""
    if slotted is graph:
        return dict(signals)
    return {name: slotted.signals.get(name, e) for name, e in signals.items()}


def _operating(
    point: Point, asked: Inputs, signals: Mapping[str, Expr], states: Mapping[str, Expr]
) -> dict[str, float]:
    """Return the values of states, inputs and outputs at the point."""
    index = {name: k for k, name in enumerate(point.values)}
    row = list(point.values.values())

    def value(e: Expr | float) -> float:
        if isinstance(e, float | int):
            return float(e)
        return float(compile_expression(e, index, pre_offset=0)(row))

    found = {name: value(e) for name, e in states.items()}
    found |= {name: value(e) for name, e in zip(asked.names, asked.values, strict=True)}
    return found | {name: value(e) for name, e in signals.items()}


def _held(graph: FlatGraph, rows: LinearRows, point: Point) -> list[str]:
    """Return what is held although it moves."""
    moving = [*rows.timed]
    for i in graph.inputs:
        still = isinstance(i.waveform, Constant | Free)
        read = any(
            f"u:{i.index}" in names(e) for n in graph.nodes if n.law for e in n.law.expressions
        )
        if not still and read:
            moving.append(i.path)
    if not moving:
        return []
    return [f"{', '.join(moving)} held as at t = {point.t:.9g} s"]
