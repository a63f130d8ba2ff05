"""Netlists where a model file is asked for: converted, with their warnings on stderr."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from hybond.cli.streams import complain, say
from hybond.errors import UsageError
from hybond.files import load
from hybond.files.parse import CIRCUITS
from hybond.model.builder import Model

if TYPE_CHECKING:
    from hybond.circuits.circuit import Conversion
    from hybond.result import Result


def read_model(file: str, current: str | None = None) -> tuple[Model, Conversion | None]:
    """Return the model of a model file or netlist; of a netlist its conversion, too.

    Raises
    ------
    HybondError
    """
    if Path(file).suffix.lower() not in CIRCUITS:
        if current:
            raise UsageError(
                "--diode-current is for netlists", code="HB-X101", where=file, hint="leave it out"
            )
        return load(file), None
    from hybond.circuits.circuit import read_circuit

    conversion = read_circuit(file, diode_current=currents_of(current))
    for warning in conversion.warnings:
        complain(f"warning: {warning}")
    return conversion.model, conversion


def currents_of(text: str | None) -> str | float | dict[str, float | str]:
    """Return what ``--diode-current`` says: one for all diodes, or ``D1=10 A,D2=50 mA``."""
    if not text:
        return 1.0
    if "=" not in text:
        return text
    pairs = (part.partition("=") for part in text.split(","))
    return {name.strip(): value.strip() for name, _, value in pairs}


def in_words_of(conversion: Conversion | None, texts: Sequence[str] | None) -> list[str]:
    """Return texts with ``v(a)`` and ``i(L1)`` of a netlist in words of its model."""
    if conversion is None or not texts:
        return list(texts or ())
    return [conversion.signal(text) for text in texts]


def steps_of(conversion: Conversion | None) -> list[str]:
    """Return what a netlist says itself of what varies, as words behind ``--vary``."""
    steps = () if conversion is None else conversion.steps
    return [f"{k}={','.join(map(repr, values))}" for k, values in steps]


def aside_of(conversion: Conversion | None) -> set[str]:
    """Return the signals that only ``.meas`` reads: no outputs of their own."""
    if conversion is None:
        return set()
    return {name for one in conversion.measures for name in one.signals}


def measurements(run: Result, conversion: Conversion | None) -> dict[str, float | None]:
    """Return what ``.meas`` asks for."""
    if conversion is None or not conversion.measures:
        return {}
    from hybond.circuits.measured import measure

    return measure(run, conversion.measures)


def notes(run: Result, conversion: Conversion | None) -> list[str]:
    """Return what a run of a netlist suggests: diodes that carry another current."""
    if conversion is None:
        return []
    from hybond.circuits.fitting import fits

    found = [str(fit) for fit in fits(run, conversion.diodes)]
    if conversion.steps:
        found.append(".step is run at its first value, or at that of .param; hybond sweep runs all")
    return found


def print_measurements(values: Mapping[str, float | None]) -> None:
    """Print measurements, one a line."""
    width = max(map(len, values), default=0)
    for name, value in values.items():
        shown = "nothing to measure" if value is None else f"{value:.6g}"
        say(f"  {name:{width}} = {shown}")
    if values:
        say()
