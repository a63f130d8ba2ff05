"""Inputs as equations of time."""

from __future__ import annotations

from dataclasses import dataclass, field

from hybond.errors import ModelError
from hybond.export.modelica.expressions import number
from hybond.model.inputs import Constant, Input, Pwm, Timetable


@dataclass
class InputText:
    """Declarations and equations of an input; `piece` changes wherever it may jump."""

    declarations: list[str] = field(default_factory=list)
    equations: list[str] = field(default_factory=list)
    piece: str = ""


def input_text(given: Input, name: str, slope: str) -> InputText:
    """Return the text of one input.

    Parameters
    ----------
    given : Input
    name, slope : str
        Names of its value and, where it is read, of its slope; `slope` may be empty.
    """
    waveform, found = given.waveform, InputText()
    match waveform:
        case Constant(level=level):
            found.equations.append(f"{name} = {number(level)};")
            if slope:
                found.equations.append(f"{slope} = 0;")
        case Timetable():
            _table(found, waveform, name, slope)
        case Pwm():
            _pulses(found, waveform, name, slope)
        case _:
            raise ModelError(
                f"the input {given.path} is a Python function",
                code="HB-E680",
                where=f"inputs.{given.path}",
                hint="give it as a table",
            )
    return found


def _table(found: InputText, table: Timetable, name: str, slope: str) -> None:
    times = [t for t in table.times if t > 0.0]
    pieces = [table.piece(0.0), *(table.piece(t) for t in times)]
    found.piece = f"{name}_piece"
    found.declarations.append(f'Integer {found.piece} "piece of the table {name}";')
    found.equations.append(f"{found.piece} = {_choice(times, [str(p) for p in pieces])};")
    values = []
    for p in pieces:
        begin = table.times[p - 1] if p else 0.0
        value, rate = table.value(begin, p), table.rate(begin, p)
        moved = f" + {number(rate)}*(time - {number(begin)})" if rate else ""
        values.append(f"{number(value)}{moved}")
    found.equations.append(f"{name} = {_choice(times, values)};")
    if slope:
        rates = [number(table.rate(table.times[p - 1] if p else 0.0, p)) for p in pieces]
        found.equations.append(f"{slope} = {_choice(times, rates)};")


def _choice(times: list[float], values: list[str]) -> str:
    parts = [f"if time < {number(t)} then {v} else" for t, v in zip(times, values, strict=False)]
    return " ".join([*parts, values[-1]]).replace("else if", "elseif")


def _pulses(found: InputText, pwm: Pwm, name: str, slope: str) -> None:
    if slope:
        found.equations.append(f"{slope} = 0;")
    if pwm.duty in (0.0, 1.0):
        found.equations.append(f"{name} = {number(pwm.high if pwm.duty else pwm.low)};")
        return
    first = pwm.piece(0.0)
    high = f"{name}_high"
    found.piece = high
    truth = "false" if first % 2 else "true"
    edges = {(first + k) % 2: number(_edge(pwm, first + k)) for k in (1, 2)}
    period = number(pwm.period)
    found.declarations += [
        f'Boolean {high}(start = {truth}, fixed = true) "whether {name} is high";',
        f"Boolean {name}_rises;",
        f"Boolean {name}_falls;",
    ]
    found.equations += [
        f"{name}_rises = sample({edges[0]}, {period});",
        f"{name}_falls = sample({edges[1]}, {period});",
        f"{high} = if {name}_rises then true elseif {name}_falls then false else pre({high});",
        f"{name} = if {high} then {number(pwm.high)} else {number(pwm.low)};",
    ]


def _edge(pwm: Pwm, piece: int) -> float:
    """Return the time at which a piece begins."""
    cycle, falling = divmod(piece, 2)
    return pwm.phase + (cycle + (pwm.duty if falling else 0.0)) * pwm.period
