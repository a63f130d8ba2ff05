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
    name, slope : str
        Names of its value and, where it is read, of its slope; `slope` may be empty.
    """
    waveform, found = given.waveform, InputText()
    match waveform:
        case Constant(level=level):
            found.equations.append(f"{name} = {number(level)};")
            if slope:
                found.equations.append(f"{slope} = 0;")
        case Timetable() if waveform.period:
            _repeating(found, waveform, name, slope)
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
        values.append(_line(value, number(rate) if rate else "0", _behind(begin)))
    found.equations.append(f"{name} = {_choice(times, values)};")
    if slope:
        rates = [number(table.rate(table.times[p - 1] if p else 0.0, p)) for p in pieces]
        found.equations.append(f"{slope} = {_choice(times, rates)};")


def _repeating(found: InputText, table: Timetable, name: str, slope: str) -> None:
    """Write a table that repeats.

    Each row begins at a sample, which counts periods from its own first instant: nothing drifts.
    """
    rows, first = table.rows(), table.piece(0.0)
    found.piece, turn = f"{name}_row", f"{name}_round"
    ticks = [f"{name}_begins_{k + 1}" for k in range(rows)]
    rounds, row = divmod(first - 1, rows)  # before the first row: the last one of round -1
    found.declarations += [
        f"Integer {found.piece}(start = {row + 1 if first else 0}, fixed = true) "
        f'"row of {name}, 0 before the first one";',
        f'Integer {turn}(start = {rounds}, fixed = true) "how often {name} has begun anew";',
        *(f"Boolean {tick};" for tick in ticks),
    ]
    for k, tick in enumerate(ticks):
        p = next(p for p in range(k + 1, first + 2 * rows + 1, rows) if table.begin(p) > 0.0)
        found.equations.append(
            f"{tick} = sample({number(table.begin(p))}, {number(table.period)});"
        )
    # of two rows at one time, a jump of straight lines, the later one holds
    last_first = reversed(list(enumerate(ticks)))
    now = " ".join(f"if {tick} then {k + 1} else" for k, tick in last_first)
    now = now.replace("else if", "elseif")
    found.equations.append(f"{found.piece} = {now} pre({found.piece});")
    found.equations.append(f"{turn} = if edge({ticks[0]}) then pre({turn}) + 1 else pre({turn});")
    rates = ["0", *(_rate(table, p) for p in range(1, rows + 1))]
    values = [number(table.values[0])]
    for k, rate in enumerate(rates[1:]):
        since = f"{_behind(table.times[k])} - {number(table.period)}*{turn}"
        values.append(_line(table.values[k], rate, since))
    found.equations.append(f"{name} = {_row(found.piece, values)};")
    if slope:
        found.equations.append(f"{slope} = {_row(found.piece, rates)};")


def _line(value: float, rate: str, since: str) -> str:
    """Return a straight line; Modelica has no sign behind another operator."""
    slope = f"({rate})" if rate.startswith("-") else rate
    return number(value) + (f" + {slope}*({since})" if rate != "0" else "")


def _behind(begin: float) -> str:
    """Return the time since an instant, which may lie before the run."""
    return f"time + {number(-begin)}" if begin < 0.0 else f"time - {number(begin)}"


def _rate(table: Timetable, piece: int) -> str:
    """Return the slope of a piece; one without width, at a jump, has none."""
    begin = table.begin(piece)
    rate = table.rate(begin, piece) if table.begin(piece + 1) > begin else 0.0
    return number(rate) if rate else "0"


def _row(row: str, values: list[str]) -> str:
    """Return the value of a row, 0 and those behind it."""
    parts = [f"if {row} == {k} then {v} else" for k, v in enumerate(values[:-1])]
    return " ".join([*parts, values[-1]]).replace("else if", "elseif")


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
