"""Inputs as they are written become waveforms; what is given to those of submodels."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from hybond.errors import ModelError, UnitError
from hybond.model.expressions import Binary, Number
from hybond.model.hierarchy import Opened, Scope, constant
from hybond.model.inputs import Called, Constant, Input, Pwm, Timetable, Waveform
from hybond.model.parts import InputPart, Value
from hybond.model.resolve import Resolver
from hybond.units import Dimension, parse_unit

_TIME = parse_unit("s")[1]
_PLAIN = Dimension()
_ROUNDED = 1e-12
"""Part of a period that two sums of times may differ by and still be the same instant."""


def inputs_of(opened: Opened) -> tuple[Input, ...]:
    """Return the inputs of a model and its submodels.

    Raises
    ------
    ModelError
        HB-M150 for an input that has no waveform.
    """
    return tuple(
        _input(k, path, scope, part)
        for k, (path, (scope, part)) in enumerate(opened.inputs.items())
    )


def _input(index: int, path: str, scope: Scope, part: InputPart) -> Input:
    where = f"inputs.{path}"
    given = [
        name for name in ("constant", "table", "pwm", "function") if getattr(part, name) is not None
    ]
    if len(given) != 1:
        raise ModelError(
            f"an input is one of constant, table, pwm or function; given: {given or 'nothing'}",
            code="HB-M150",
            where=where,
            hint="keep one of them" if given else 'give one: hb.Input(constant="5 V")',
        )

    def number(value: Value, what: str) -> Number:
        return constant(value, scope.parameters, f"{where}.{what}")

    if part.period is not None and part.table is None:
        raise ModelError(
            f"'period' belongs to a table, not to {given[0]!r}",
            code="HB-M150",
            where=where,
            hint="leave it out; a pwm has its period within",
        )

    def timed(value: Value, what: str) -> float:
        found = number(value, what)
        _fits(found.dimension, _TIME, f"{where}.{what}")
        return found.value

    waveform: Waveform
    if part.constant is not None:
        level = number(part.constant, "constant")
        return Input(index, path, Constant(level.value), level.dimension)
    if part.function is not None:
        return Input(index, path, Called(part.function, tuple(sorted(part.breaks))), None)
    if part.pwm is not None:
        unknown = set(part.pwm) - {"period", "duty", "high", "low", "phase"}
        missing = {"period", "duty"} - set(part.pwm)
        if unknown or missing:
            raise ModelError(
                f"pwm has no {min(unknown)!r}" if unknown else f"pwm needs {min(missing)!r}",
                code="HB-M150",
                where=where,
                hint="period, duty, high, low, phase",
            )
        values = {k: number(v, f"pwm.{k}") for k, v in part.pwm.items()}
        for key, wanted in (("period", _TIME), ("phase", _TIME), ("duty", _PLAIN)):
            if key in values:
                _fits(values[key].dimension, wanted, f"{where}.pwm.{key}")
        waveform = Pwm(**{k: v.value for k, v in values.items()})
        if waveform.period <= 0 or not 0.0 <= waveform.duty <= 1.0:
            raise ModelError(
                f"period = {waveform.period:g} s, duty = {waveform.duty:g}",
                code="HB-M150",
                where=where,
                hint="a positive period and a duty from 0 to 1",
            )
        ends = [(values[k], f"pwm.{k}") for k in ("high", "low") if k in values]
        return Input(index, path, waveform, _kind(ends, where))
    rows = list(part.table or ())
    if not rows or any(not isinstance(r, list | tuple) or len(r) != 2 for r in rows):
        raise ModelError(
            "a table is rows of [time, value]", code="HB-M150", where=where, hint="[[0, 1], [2, 5]]"
        )
    instants = [timed(r[0], f"table[{k}][0]") for k, r in enumerate(rows)]
    levels = [number(r[1], f"table[{k}][1]") for k, r in enumerate(rows)]
    if any(b < a for a, b in pairwise(instants)):
        raise ModelError(
            "the times of a table must not decrease", code="HB-M150", where=where, hint="sort it"
        )
    period = 0.0
    if part.period is not None:
        period = timed(part.period, "period")
        instants[-1] = _closing(instants, period, where)
    waveform = Timetable(
        tuple(instants), tuple(n.value for n in levels), linear=part.linear, period=period
    )
    named = [(n, f"table[{k}][1]") for k, n in enumerate(levels)]
    return Input(index, path, waveform, _kind(named, where))


def _kind(levels: list[tuple[Number, str]], where: str) -> Dimension | None:
    """Return what kind of quantity an input is: that of its values with a unit, which is one."""
    kind = None
    for level, what in levels:
        _fits(level.dimension, kind, f"{where}.{what}")
        kind = kind or level.dimension
    return kind


def _fits(given: Dimension | None, wanted: Dimension | None, where: str) -> None:
    if given is not None and wanted is not None and given != wanted:
        plain = wanted == _PLAIN
        raise UnitError(
            f"it is in {given}; this place wants {'a plain number' if plain else wanted}",
            code="HB-U103",
            where=where,
            hint="give a number without a unit" if plain else f"give it in {wanted}",
        )


def _closing(times: list[float], period: float, where: str) -> float:
    """Return the last time of a table that repeats, exactly a period after the first if it is."""
    lasts = times[-1] - times[0]
    if not period > 0.0 or lasts > period * (1.0 + _ROUNDED):
        raise ModelError(
            f"the table lasts {lasts:g} s, its period is {period:g} s",
            code="HB-M150",
            where=where,
            hint="a positive period, not shorter than the table",
        )
    # a sum of times that should be the period is off by rounding: no piece is that short
    return times[0] + period if lasts > period * (1.0 - _ROUNDED) else times[-1]


def give_units(
    opened: Opened, resolver: Resolver, dimensions: Mapping[str, Dimension | None]
) -> None:
    """Read what is given to an input without a unit in the unit of the input's own value."""
    for path, (scope, part) in opened.given.items():
        own = _input(0, path, scope, part).dimension
        if own is None:
            continue
        tree = resolver.signal(path)
        scaled = Binary("*", tree, Number(1.0, own))
        where = f"signals.{path}"
        plain = resolver.dimension(tree, dimensions, where) is None
        # times a unit, plain numbers have it; what is unknown stays unknown
        if plain and resolver.dimension(scaled, dimensions, where) == own:
            resolver.read_as(path, scaled)


def check_given(path: str, given: Dimension | None, opened: Opened) -> None:
    """Refuse an input of a submodel in another unit than its own value has."""
    scope, part = opened.given[path]
    own = _input(0, path, scope, part).dimension
    if own is not None and given is not None and own != given:
        # as its part writes it: a torque is in N*m, and not in J
        unit = str(part.constant).partition(" ")[2] or str(own)
        lacks = f"{unit}/s" if str(given) == "s" else str(own / given)
        raise UnitError(
            f"the input is in {unit}, and is given in {given}",
            code="HB-U103",
            where=path,
            hint=f"give it in {unit}: a number in it may lack its unit, as in 2 [{lacks}]",
        )
