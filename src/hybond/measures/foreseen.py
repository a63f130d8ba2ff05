"""What a measurement asks for, looked at before a run is made: its times, periods and levels."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, get_args

from hybond.errors import UsageError
from hybond.measures.crossings import Edge
from hybond.measures.window import count_of, duration_of, frequency_of, time_of
from hybond.model.expressions import Expr
from hybond.model.graph import FlatGraph
from hybond.model.unit_words import unit_of
from hybond.units import parse_unit, try_quantity

LEVELS = ("level", "initial", "final")
"""Arguments that are values of what is measured."""


def check_options(options: Mapping[str, Any], signal: Expr, graph: FlatGraph, name: str) -> None:
    """Refuse arguments of a measurement that no run could make sense of.

    Parameters
    ----------
    options : mapping
        Its arguments.
    signal : Expr
        What is measured, in canonical names.
    name : str
        What that is called.

    Raises
    ------
    UsageError
        HB-R101.
    """
    for key, value in options.items():
        if key in ("start", "end", "t"):
            time_of(value, key)
        elif key == "period":
            duration_of(value)
        elif key == "f":
            frequency_of(value)
        elif key == "periods":
            count_of(value)
        elif key in LEVELS:
            level_of(value, unit_of(signal, graph), name, key)
        elif key == "edge" and value not in get_args(Edge):
            raise UsageError(
                f"edge = {value!r}", code="HB-R101", where="edge", hint='"rise", "fall" or "both"'
            )
    if "period" in options and "start" in options and "end" in options:
        raise UsageError(
            "start, end and period",
            code="HB-R101",
            where="period",
            hint="leave one of them out",
        )
    if "start" in options and "end" in options:
        start, end = time_of(options["start"], "start"), time_of(options["end"], "end")
        if not start < end:
            raise UsageError(
                f"a window from {start:.9g} to {end:.9g} s",
                code="HB-R101",
                where="end",
                hint="an end after start",
            )


def check_within(options: Mapping[str, Any], until: float) -> None:
    """Refuse a window that a run up to a time does not cover.

    Raises
    ------
    UsageError
        HB-R102.
    """
    for key in ("start", "end", "t"):
        if key in options and not 0.0 <= (t := time_of(options[key], key)) <= until * (1 + 1e-9):
            way = {"start": "the window from", "end": "the window to"}.get(key, "not to")
            raise UsageError(
                f"the run goes from 0 to {until:.9g} s, {way} {t:.9g} s",
                code="HB-R102",
                where=key,
                hint="measure within it, or let the run go on longer",
            )


def level_of(value: float | str, unit: str, name: str, where: str = "level") -> float:
    """Return a value of something that has a unit, SI.

    Raises
    ------
    UsageError
        HB-R101.
    """
    if not isinstance(value, str):
        return float(value)
    found = try_quantity(value)
    fits = found is not None and (
        not unit or found.dimension in (parse_unit(unit)[1], parse_unit("1")[1])
    )
    if found is None or not fits:
        raise UsageError(
            f"{value!r} is not a value of {name}",
            code="HB-R101",
            where=where,
            hint=f"a number in SI, or in {unit}" if unit else "a number in SI",
        )
    return float(found.value)
