"""What a bifurcation diagram is asked for: arguments looked through, as one record."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.sections import Cut
from hybond.errors import HybondError, UsageError
from hybond.measures.naming import read_name
from hybond.model.builder import Model
from hybond.model.expressions import Expr, compile_expression, names
from hybond.model.graph import FlatGraph
from hybond.model.kept import kept_graph
from hybond.model.unit_words import unit_of
from hybond.names import did_you_mean
from hybond.options import seconds_of
from hybond.runs.times import time_in
from hybond.sweep.asking import check_options
from hybond.sweep.factors import Factor, factor_of
from hybond.sweep.lifted import lifted
from hybond.units import is_of, try_quantity

Vector = NDArray[np.float64]
DIRECTIONS = ("fresh", "up", "down", "both")
MOST_KEPT = 100_000
MOST_NUMBERS = 200_000_000
"""Samples of all values that are kept."""


@dataclass(frozen=True, eq=False)
class Question:
    """What a diagram shows.

    Parameters
    ----------
    model : Model
        With parameters for what varies.
    factor : Factor
        What varies.
    path : str
        The parameter of `model` that it is.
    of : tuple of str
        Signals.
    units : tuple of str
    cut : Cut
        When they are looked at.
    period : str
        As written, an expression of parameters; empty: at events.
    at : str
        The event as written.
    limit : float
        Of events: how long a value may take, s.
    directions : tuple of str
    tolerance : float
    longest : int
    fixed, options : mapping
    """

    model: Model
    factor: Factor
    path: str
    of: tuple[str, ...]
    units: tuple[str, ...]
    cut: Cut
    period: str
    at: str
    limit: float
    directions: tuple[str, ...]
    tolerance: float
    longest: int
    fixed: Mapping[str, Any]
    options: Mapping[str, Any]

    @property
    def values(self) -> Vector:
        """What the parameter takes, SI."""
        assert isinstance(self.factor.levels, np.ndarray)
        return self.factor.levels

    def set(self, value: float) -> dict[str, Any]:
        """Return all parameters for a value."""
        return {**self.fixed, self.path: self.factor.shown(float(value))}

    def graph(self, value: float) -> FlatGraph:
        """Return the flat graph for a value."""
        return kept_graph(self.model, self.set(value))

    def duration(self, graph: FlatGraph) -> float:
        """Return the period, or how long a value may take; s.

        Raises
        ------
        UsageError
            HB-P132.
        """
        if not self.period:
            return self.limit
        e = period_expression(graph, self.period)
        found = float(compile_expression(e, {}, pre_offset=0)([]))
        check_period(found, self.period)
        return found


def question_of(
    model: Model,
    parameter: Mapping[str, Any],
    *,
    of: str | Sequence[str],
    period: float | str | None,
    at: str | None,
    before: bool,
    settle: int,
    keep: int,
    direction: str,
    tolerance: float,
    longest: int | None,
    limit: float | str | None,
    parameters: Mapping[str, Any] | None,
    options: Mapping[str, Any],
) -> Question:
    """Return what a call asks for.

    Raises
    ------
    UsageError
        HB-P131, HB-P132, HB-P101 and those of signals and options.
    """
    if not isinstance(model, Model):
        raise refusal(f"the model is a {type(model).__name__}", "model", "give the Model")
    if not isinstance(parameter, Mapping) or len(parameter) != 1:
        raise refusal(
            f"parameter = {parameter!r}", "parameter", 'one path: {"Iref": "0.5..1.5 A:500"}'
        )
    options = check_options(options)
    ((path, given),) = parameter.items()
    factor = factor_of(path, given)
    levels = factor.levels
    if not isinstance(levels, np.ndarray) or len(levels) < 2:
        raise refusal(
            f"{factor.path} = {factor.text!r} are not two numbers or more",
            factor.path,
            '"0.5..1.5 A:500" or a sequence of numbers',
        )
    up = np.diff(levels)
    if not ((up > 0.0).all() or (up < 0.0).all()):
        raise refusal(f"{factor.path} goes up and down", factor.path, "values in order")
    if (up < 0.0).all():
        factor = Factor(factor.path, factor.text, levels[::-1].copy(), factor.dimension)
    _check_counts(settle, keep, tolerance, longest)
    if direction not in DIRECTIONS:
        raise refusal(f"direction = {direction!r}", "direction", ", ".join(DIRECTIONS))
    if not isinstance(before, bool):
        raise refusal(f"before = {before!r}", "before", "True or False")
    fixed = {k: v for k, v in (parameters or {}).items() if k != factor.path}
    new, paths = lifted(model, [factor.path])
    graph = kept_graph(new, {**fixed, paths[factor.path]: factor.shown(float(levels[0]))})
    wanted = (of,) if isinstance(of, str) else tuple(of)
    if not wanted:
        raise refusal("no signal is looked at", "of", 'of="coil.current"')
    if len(wanted) * keep * len(levels) > MOST_NUMBERS:
        raise refusal(
            f"{len(wanted)} signals, {keep} samples, {len(levels)} values",
            "keep",
            f"together at most {MOST_NUMBERS} numbers",
        )
    units = tuple(unit_of(read_name(graph, name), graph) for name in wanted)
    if (period is None) == (at is None):
        raise section_refusal(
            "neither a period nor an event" if period is None else "a period and an event",
            "period",
            'period="T" looks once a period, at="M.s" each time the machine M enters its state s',
        )
    machine, state, longest_time, text = -1, -1, 0.0, ""
    if at is not None:
        machine, state = _entered(graph, at)
        own = seconds_of(time_in(graph.experiment.get("until")), "until")
        longest_time = seconds_of(limit, "limit") or (
            0.0 if own is None else own * (settle + keep + 1)
        )
        if not 0.0 < longest_time < math.inf:
            raise section_refusal(
                "nothing says how long to wait for the events", "limit", 'limit="10 s"'
            )
    else:
        text = repr(period) if isinstance(period, int | float) else str(period)
        if limit is not None:
            raise section_refusal("a limit of time, and a period", "limit", "leave one out")
    asked = Question(
        model=new,
        factor=factor,
        path=paths[factor.path],
        of=wanted,
        units=units,
        cut=Cut(settle, keep, machine, state, before),
        period=text,
        at=at or "",
        limit=longest_time,
        directions=("up", "down") if direction == "both" else (direction,),
        tolerance=tolerance,
        longest=min(longest or keep // 2, keep // 2),
        fixed=fixed,
        options=dict(options),
    )
    asked.duration(graph)
    return asked


def period_expression(graph: FlatGraph, text: str) -> Expr:
    """Return a period as an expression of nothing that changes with time.

    Raises
    ------
    UsageError
        HB-P132.
    """
    quantity = try_quantity(text)
    if quantity is not None and not is_of(quantity, "s"):
        raise section_refusal(f"period = {text!r} is no time", "period", 'period="20 us"')
    if quantity is not None:
        text = repr(quantity.value)
    try:
        found = read_name(graph, text)
    except HybondError as error:
        raise section_refusal(
            f"period = {text!r}: {error.why}", "period", error.hint or 'period="20 us"'
        ) from None
    others = sorted(n for n in names(found) if not n.startswith("p:"))
    if others:
        raise section_refusal(
            f"period = {text!r} reads signals, not parameters alone", "period", 'period="2*pi/w"'
        )
    return found


def check_period(found: float, text: str) -> None:
    """Refuse a period that is no time; HB-P132."""
    if not 0.0 < found < math.inf:
        raise section_refusal(f"period = {text} is {found:g} s", "period", "a positive time")


def _check_counts(settle: Any, keep: Any, tolerance: Any, longest: Any) -> None:
    for name, number, least in (("settle", settle, 0), ("keep", keep, 4), ("longest", longest, 1)):
        if name == "longest" and number is None:
            continue
        whole = isinstance(number, int) and not isinstance(number, bool)
        if not whole or not least <= number <= (MOST_KEPT if name == "keep" else 10**9):
            raise refusal(f"{name} = {number!r}", name, f"a whole number, {least} or more")
    if not isinstance(tolerance, float | int) or not 0.0 < tolerance < 1.0:
        raise refusal(f"tolerance = {tolerance!r}", "tolerance", "between 0 and 1: 1e-6")


def _entered(graph: FlatGraph, at: Any) -> tuple[int, int]:
    """Return the machine and the state that ``M.s`` says.

    Raises
    ------
    UsageError
        HB-P132.
    """
    known = [f"{m.path}.{s}" for m in graph.machines for s in m.states]
    if at not in known:
        raise section_refusal(
            f"at = {at!r} is no state of a machine",
            "at",
            did_you_mean(str(at), known) or ", ".join(known[:8]) or "period",
        )
    path, _, state = str(at).rpartition(".")
    machine = next(m for m in graph.machines if m.path == path)
    return machine.index, machine.states.index(state)


def refusal(why: str, where: str, hint: str) -> UsageError:
    """Return that of a call that makes no sense."""
    return UsageError(why, code="HB-P131", where=where, hint=hint)


def section_refusal(why: str, where: str, hint: str) -> UsageError:
    """Return that of what is no section."""
    return UsageError(why, code="HB-P132", where=where, hint=hint)
