"""Periods of a model, and a window that holds whole periods of it and of an injected sine."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from hybond.errors import HybondError, UsageError
from hybond.measures.naming import read_name
from hybond.model.expressions import (
    Call,
    Compare,
    Expr,
    Name,
    Number,
    compile_expression,
    differentiate,
    names,
    simplify,
)
from hybond.model.expressions.tree import transform, walk
from hybond.model.graph import FlatGraph
from hybond.model.inputs import Constant, Free, Pwm, Timetable
from hybond.model.unit_words import unit_of
from hybond.options import seconds
from hybond.units import try_quantity

WHOLE = 1e-9
"""Part by which a period may differ from a whole number of those of the model."""
CLOSE = 1e-3
"""Part of a frequency by which it may be moved, so that a window is short."""
TURNS = 24
"""Periods of the sine that a window has at most."""
RATIO = 10_000
"""Largest whole number in the ratio of two periods of a model that count as having one in
common."""


@dataclass(frozen=True, slots=True)
class Window:
    """Whole periods of two things at once.

    Parameters
    ----------
    frequency : float
        Of the sine, Hz: as asked for, or near it.
    turns : int
        Periods of the sine in the window.
    cycles : int
        Periods of the model in it; 0 if it has none.
    length : float
        s.
    """

    frequency: float
    turns: int
    cycles: int
    length: float


def period_of(graph: FlatGraph) -> float | None:
    """Return the time after which all that a model reads of time repeats, None if nothing does.

    Raises
    ------
    UsageError
        HB-A511 where that cannot be told, or there is no common period.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc")
    >>> m.add(V=hb.Se("1 V*sin(2*pi*time/(20 ms)) + u"), j=hb.One(), r=hb.R(2), c=hb.C(1))
    >>> m.bond("V -> j -> r", "j -> c")
    >>> m.input(u=hb.Input(pwm={"period": "5 ms", "duty": 0.5}))
    >>> round(period_of(m.flatten()), 9)
    0.02
    """
    return _common(periods_in(graph))


def times_of(asked: float, own: float) -> int:
    """Return which multiple of a model's own period another one is, 0 if it is none.

    Examples
    --------
    >>> times_of(60e-6, 20e-6), times_of(30e-6, 20e-6), times_of(10e-6, 20e-6)
    (3, 0, 0)
    """
    times = round(asked / own)
    return times if times >= 1 and abs(asked / own - times) <= WHOLE * times else 0


def time_said(graph: FlatGraph, said: float | str) -> float:
    """Return a period, s: a number, a quantity, or an expression of parameters.

    Raises
    ------
    UsageError
        HB-S106 for what is neither.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("clock", parameters={"f": "50 kHz"})
    >>> round(time_said(m.flatten(), "2/f"), 9), time_said(m.flatten(), "20 ms")
    (4e-05, 0.02)
    """
    if not isinstance(said, str) or try_quantity(said) is not None:
        return seconds(said, "period")
    try:
        found = read_name(graph, said)
    except HybondError as error:
        raise UsageError(
            f"{said!r} is not a time: {error.why}",
            code="HB-S106",
            where="period",
            hint=error.hint or "0.2, '200 ms', or an expression of parameters such as 2*pi/w",
        ) from None
    if names(found):
        raise UsageError(
            f"{said!r} reads signals, not parameters alone",
            code="HB-S106",
            where="period",
            hint="0.2, '200 ms', or an expression of parameters such as 2*pi/w",
        )
    unit = unit_of(found, graph)
    if unit not in ("", "1", "s"):
        raise UsageError(
            f"{said!r} is in {unit}, and no time",
            code="HB-S106",
            where="period",
            hint="0.2, '200 ms', or an expression of parameters such as 2*pi/w",
        )
    return float(compile_expression(found, {}, pre_offset=0)([]))


def periods_in(graph: FlatGraph) -> list[float]:
    """Return the periods of all that a model reads of time, as many as there are.

    Of a graph with slots they say what they are made of.

    Raises
    ------
    UsageError
        HB-A511 for what is not known to repeat.
    """
    found: list[float] = []
    for i in graph.inputs:
        match i.waveform:
            case Constant() | Free():
                pass
            case Pwm(period=period):
                found.append(period)
            case Timetable(period=period) if period:
                found.append(period)
            case _:
                raise _unknown(f"the input {i.path} does not repeat")
    for e, where in trees(graph):
        found += _in_tree(e, where)
    return found


def repeats_from(graph: FlatGraph) -> float:
    """Return when all has begun to repeat, s: tables and samples may begin late.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("late")
    >>> m.input(u=hb.Input(table=[(8e-6, 1.0), (14e-6, 0.0)], period=10e-6))
    >>> repeats_from(m.flatten())
    8e-06
    """
    tables = (i.waveform for i in graph.inputs if isinstance(i.waveform, Timetable))
    begin = [w.times[0] for w in tables if w.period]
    # within its first period nothing is missing before the first instant
    begin += [s.phase for s in graph.samples if s.phase >= s.every]
    return max(begin, default=0.0)


def trees(graph: FlatGraph) -> Iterator[tuple[Expr, str]]:
    """Yield what is evaluated while a model runs, and what it belongs to."""
    for node in graph.nodes:
        for e in node.law.expressions if node.law is not None else ():
            yield e, node.path
    for integral in graph.integrals:
        yield integral.rate, integral.path
    for sample in graph.samples:
        yield Call("mod", (Name("time"), Number(sample.every))), sample.path
    for machine in graph.machines:
        for rule in machine.rules:
            yield rule.guard, machine.path
    for watch in graph.watches:
        yield watch.compare, "a comparison of time"


def _in_tree(e: Expr, where: str) -> list[float]:
    """Return the periods of what an expression reads of time."""
    found: list[float] = []
    explained = 0
    many = 0
    for part, _ in walk(simplify(transform(e, _without_unit))):
        match part:
            case Name("time"):
                many += 1
            case Call("mod", (argument, Number(value))):
                speed = _speed(argument)
                if speed:
                    found.append(abs(value / speed))
                    explained += _times(argument)
            case Call("sin" | "cos", (argument,)):
                speed = _speed(argument)
                if speed:
                    found.append(2.0 * math.pi / abs(speed))
                    explained += _times(argument)
            case Compare():
                pass
    if many != explained:
        raise _unknown(f"{where} reads the time in a way that need not repeat")
    return found


def _without_unit(e: Expr) -> Expr:
    """Return a number with a unit as one in SI, so that products of them are numbers, too."""
    return Number(e.value) if isinstance(e, Number) and e.dimension is not None else e


def _times(e: Expr) -> int:
    return sum(part == Name("time") for part, _ in walk(e))


def _speed(e: Expr) -> float | None:
    """Return the constant slope by time of what reads nothing else."""
    if names(e) != {"time"}:
        return None
    slope = differentiate(e, "time")
    return slope.value if isinstance(slope, Number) else None


def _common(found: list[float]) -> float | None:
    if not found:
        return None
    common = Fraction(1)
    for period in found[1:]:
        ratio = Fraction(period / found[0]).limit_denominator(RATIO)
        if abs(float(ratio) * found[0] / period - 1.0) > 1e-9 or not ratio:
            raise _unknown(f"periods of {found[0]:g} s and {period:g} s have none in common")
        common = Fraction(
            math.lcm(common.numerator * ratio.denominator, ratio.numerator * common.denominator),
            common.denominator * ratio.denominator,
        )
    return float(common) * found[0]


def window_of(frequency: float, period: float | None) -> Window:
    """Return a window for a frequency near the one that is asked for.

    The shortest of at most `TURNS` periods of the sine whose frequency is off by less than `CLOSE`;
    else the one that is off least.

    Raises
    ------
    UsageError
        HB-A509 for half of the model's own frequency and its multiples, where the response has
        another part at the same frequency.

    Examples
    --------
    >>> window_of(333.0, 1e-3)
    Window(frequency=333.3333333333333, turns=1, cycles=3, length=0.003)
    """
    if period is None:
        return Window(frequency, 1, 0, 1.0 / frequency)
    best: Window | None = None
    for turns in range(1, TURNS + 1):
        cycles = max(round(turns / (frequency * period)), 1)
        if math.gcd(turns, cycles) != 1 or 2 * turns % cycles == 0:
            continue
        own = turns / (cycles * period)
        trial = Window(own, turns, cycles, cycles * period)
        if abs(own / frequency - 1.0) <= CLOSE:
            return trial
        if best is None or abs(own - frequency) < abs(best.frequency - frequency):
            best = trial
    if best is None or abs(best.frequency / frequency - 1.0) > 0.25:
        raise UsageError(
            f"{frequency:g} Hz cannot be told from the model's own {1 / period:g} Hz",
            code="HB-A509",
            where="frequencies",
            hint="not a multiple of half of the switching frequency",
        )
    return best


def _unknown(why: str) -> UsageError:
    return UsageError(
        why,
        code="HB-A511",
        where="period",
        hint='say after which time all repeats: hb.frequency_response(..., period="10 us")',
    )
