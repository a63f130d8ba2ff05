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
from hybond.units import is_of, try_quantity

LEVELS = ("level", "initial", "final")
"""Arguments that are values of what is measured."""
REACH = 1e-9
"""Part of a run by which a window may go beyond it: rounding of times that are written."""
LONGER = "measure within it, or let the run go on longer"


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
        if key in options and not 0.0 <= (t := time_of(options[key], key)) <= until * (1 + REACH):
            way = {"start": "the window from", "end": "the window to"}.get(key, "not to")
            raise UsageError(
                f"the run goes from 0 to {until:.9g} s, {way} {t:.9g} s",
                code="HB-R102",
                where=key,
                hint=LONGER,
            )
    if "period" not in options:
        return
    # what `window_of` makes of it
    length = count_of(options.get("periods", 1)) * duration_of(options["period"])
    begin = time_of(options["start"], "start") if "start" in options else None
    end = begin + length if begin is not None else time_of(options.get("end", until), "end")
    begin = end - length if begin is None else begin
    if begin < -REACH * until or end > until * (1.0 + REACH):
        way = f"from {begin:.9g} s" if begin < 0.0 else f"to {end:.9g} s"
        raise UsageError(
            f"the run goes from 0 to {until:.9g} s, the window {way}",
            code="HB-R102",
            where="periods",
            hint=LONGER,
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
    if found is None or not is_of(found, unit):
        raise UsageError(
            f"{value!r} is not a value of {name}",
            code="HB-R101",
            where=where,
            hint=f"a number in SI, or in {unit}" if unit else "a number in SI",
        )
    return float(found.value)
