"""Independent sources: functions of time as expressions or inputs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from hybond.circuits.numerals import short
from hybond.circuits.opened import Branch, Value
from hybond.circuits.texts import Texts
from hybond.model.expressions import Number
from hybond.model.parts import InputPart

ZERO = Value(Number(0.0), 0.0)
PULSES = 10_000
"""Pulses of a source that has a number of them."""
_UNITS = {"v": "V", "i": "A"}


@dataclass(frozen=True, slots=True)
class Drive:
    """What an independent source imposes."""

    text: str | float
    """An expression, if it is no input."""
    input: InputPart | None
    initial: float
    """Its value at t = 0, from the right."""
    constant: bool
    ramp: str = ""
    """A factor that an input has, too."""

    @property
    def zero(self) -> bool:
        """Whether it is always zero: an ammeter, or nothing."""
        return self.constant and self.initial == 0.0 and self.text in ("0 V", "0 A", 0.0)


@dataclass(frozen=True, slots=True)
class Clock:
    """The times of ``.tran``, which are the defaults of functions of time; zero if not known."""

    step: Value
    stop: Value
    startup: bool = False


def drive_of(branch: Branch, texts: Texts, clock: Clock) -> Drive:
    """Return what an independent source imposes.

    Raises
    ------
    FileError
        HB-F130 (arguments missing or too many), HB-F136 (a function without meaning here),
        HB-F140 (times that cannot be).
    """
    unit = _UNITS[branch.kind]
    if branch.wave is None:
        value = branch.value or ZERO
        return Drive(texts.value(value, unit), None, value.number, True)
    name, given = branch.wave
    match name:
        case "pulse":
            return _pulse(branch, given, texts, clock, unit)
        case "sin":
            return _sine(branch, given, texts, clock, unit)
        case "exp":
            return _exponential(branch, given, texts, clock, unit)
        case "pwl":
            return _lines(branch, given, texts, unit)
        case "sffm":
            return _modulated(branch, given, texts, clock, unit)
        case "am":
            return _amplitude(branch, given, texts, unit)
        case _:
            raise branch.line.refuse(
                f"the function of time {name.upper()} has no meaning here",
                code="HB-F136",
                hint="PULSE, SIN, EXP, PWL, SFFM or AM; an input of the model may be a function in "
                "Python",
            )


def _counted(branch: Branch, given: tuple[Value, ...], least: int, most: int) -> None:
    if not least <= len(given) <= most:
        name = branch.wave[0].upper() if branch.wave else ""
        raise branch.line.refuse(
            f"{name} has {len(given)} values, not {least} to {most}",
            code="HB-F130",
            hint="see the form of the function in the manual of SPICE",
        )


def _impossible(branch: Branch, why: str, hint: str) -> Exception:
    return branch.line.refuse(why, code="HB-F140", hint=hint)


def _pick(given: tuple[Value, ...], k: int, default: Value) -> Value:
    """Return argument k; SPICE takes zero and nothing for the default."""
    return given[k] if k < len(given) and (given[k].number or given[k].parametric) else default


def _pulse(
    branch: Branch, given: tuple[Value, ...], texts: Texts, clock: Clock, unit: str
) -> Drive:
    _counted(branch, given, 2, 8)
    low, high = given[0], given[1]
    delay = _pick(given, 2, ZERO)
    rise, fall = _pick(given, 3, clock.step), _pick(given, 4, clock.step)
    width, period = _pick(given, 5, ZERO), _pick(given, 6, ZERO)
    numbers = [v.number for v in (rise, fall, width, period)]
    if min(numbers) < 0.0:
        raise _impossible(branch, "a time of the pulse is negative", "check the times")
    corners = [([delay], low), ([delay, rise], high)]
    if not width.number:  # it lasts as long as the run: a step that stays
        rising = rise.number + fall.number
        if period.number and rising + clock.stop.number > period.number * (1 + 1e-12):
            raise _impossible(
                branch,
                "a pulse without a width lasts as long as the run to some simulators, and no time "
                f"at all to others; its period is {period.number:g} s",
                "write the width that is meant, such as 1n, or leave the period out",
            )
        return _table(branch, corners, None, texts, unit)
    corners += [([delay, rise, width], high), ([delay, rise, width, fall], low)]
    if not period.number:
        return _table(branch, corners, None, texts, unit)
    lasts = rise.number + width.number + fall.number
    if lasts > period.number * (1 + 1e-12):  # the next one begins before it is over
        ends = [(float(sum(v.number for v in at)), level.number) for at, level in corners]
        cut = cut_at(ends, ends[0][0] + period.number)
        corners = [([number_of(t)], number_of(y)) for t, y in cut]
    if len(given) == 8 and given[7].number:
        return _table(branch, _train(branch, corners, period, given[7]), None, texts, unit)
    if not rise.number and not fall.number and not delay.number:
        wave: dict[str, Any] = {"period": texts.value(period, "s")}
        if width.parametric or period.parametric:
            wave["duty"] = f"{texts.factor(width, 's')}/({texts.factor(period, 's')})"
        else:
            wave["duty"] = width.number / period.number
        wave |= {"high": texts.value(high, unit), "low": texts.value(low, unit)}
        return Drive("", InputPart(pwm=wave), high.number, False)
    return _table(branch, corners, period, texts, unit)


def number_of(value: float) -> Value:
    """Return a number as a value."""
    return Value(Number(value), value)


def cut_at(corners: list[tuple[float, float]], end: float) -> list[tuple[float, float]]:
    """Return lines between corners as far as `end`.

    Examples
    --------
    >>> cut_at([(0.0, 0.0), (1.0, 2.0), (5.0, 2.0), (6.0, 0.0)], 3.0)
    [(0.0, 0.0), (1.0, 2.0), (3.0, 2.0)]
    """
    kept = [corners[0]]
    for (t0, y0), (t1, y1) in pairwise(corners):
        if t1 >= end:
            kept.append((end, y0 + (y1 - y0) * (end - t0) / (t1 - t0)))
            return kept
        kept.append((t1, y1))
    return kept


def _train(
    branch: Branch, corners: list[tuple[list[Value], Value]], period: Value, number: Value
) -> list[tuple[list[Value], Value]]:
    """Return so many pulses, one after another."""
    count = number.number
    if not 0.0 < count <= PULSES or count % 1.0:
        raise _impossible(
            branch, f"{count:g} pulses", f"a whole number of at most {PULSES}, or none"
        )
    return [
        ([*at, number_of(k * period.number)], level)
        for k in range(int(count))
        for at, level in corners
    ]


def _table(
    branch: Branch,
    corners: list[tuple[list[Value], Value]],
    period: Value | None,
    texts: Texts,
    unit: str,
) -> Drive:
    """Return a source of straight lines between corners, perhaps repeated."""
    times = [sum(v.number for v in at) for at, _ in corners]
    if times[0] < 0.0 and period is None and times[-1] < 0.0:
        raise _impossible(branch, "all of it is before t = 0", "check the delay")
    rows = [(texts.total(at, "s"), texts.value(level, unit)) for at, level in corners]
    initial = _at_zero(times, [level.number for _, level in corners], period)
    span = None if period is None else texts.value(period, "s")
    return Drive("", InputPart(table=rows, linear=True, period=span), initial, False)


def _at_zero(times: list[float], levels: list[float], period: Value | None) -> float:
    t = 0.0
    if period is not None and times[0] < 0.0:
        t = times[0] + (-times[0]) % period.number
        times, levels = [*times, times[0] + period.number], [*levels, levels[0]]
    if t < times[0]:
        return levels[0]
    for k in range(len(times) - 1, -1, -1):
        if times[k] <= t:
            if k + 1 == len(times):
                return levels[k]
            part = (t - times[k]) / (times[k + 1] - times[k])
            return levels[k] + part * (levels[k + 1] - levels[k])
    return levels[0]


def _since(delay: Value, texts: Texts) -> str:
    if delay.number < 0.0 and not delay.parametric:
        return f"(time + {texts.factor(number_of(-delay.number), 's')})"
    return f"(time - {texts.factor(delay, 's')})" if delay.number or delay.parametric else "time"


def _angle(frequency: Value, since: str, texts: Texts) -> str:
    if frequency.parametric:
        return f"2*pi*{texts.factor(frequency, 'Hz')}*{since}/(1 s)"
    return f"2*pi*{texts.factor(frequency, 'Hz')}*{since}"


def _turn(phase: Value, texts: Texts) -> str:
    """Return a phase in degrees, to be added to an angle."""
    if phase.parametric:
        return f" + {texts.factor(phase, '')}*pi/180"
    if not phase.number:
        return ""
    return f" {'-' if phase.number < 0 else '+'} {short(abs(phase.number))}*pi/180"


def _offset(value: Value, texts: Texts, unit: str) -> str:
    return f"{texts.factor(value, unit)} + " if value.number or value.parametric else ""


def _delayed(delay: Value, before: str, after: str, texts: Texts) -> str:
    if delay.number <= 0.0 and not delay.parametric:
        return after
    return f"if time >= {texts.factor(delay, 's')} then {after} else {before}"


def _sine(branch: Branch, given: tuple[Value, ...], texts: Texts, clock: Clock, unit: str) -> Drive:
    _counted(branch, given, 2, 7)
    offset, size = given[0], given[1]
    frequency = _pick(given, 2, ZERO)
    cycles = _pick(given, 6, ZERO)
    delay, damping, phase = (_pick(given, k, ZERO) for k in (3, 4, 5))
    if not frequency.number:
        if not clock.stop.number:
            raise _impossible(branch, "the sine has no frequency", "give it, or .tran")
        frequency = Value(Number(1.0 / clock.stop.number), 1.0 / clock.stop.number)
    since = _since(delay, texts)
    turn = _turn(phase, texts)
    wave = f"{texts.factor(size, unit)}*sin({_angle(frequency, since, texts)}{turn})"
    if damping.parametric:
        wave += f"*exp(-{texts.factor(damping, '')}*{since}/(1 s))"
    elif damping.number:
        wave += f"*exp({short(-damping.number)} [1/s]*{since})"
    first = f"{texts.factor(size, unit)}*sin({turn.removeprefix(' + ').strip()})" if turn else ""
    shift = _offset(offset, texts, unit)
    before = f"{shift}{first}" if first else texts.factor(offset, unit)
    text = _delayed(delay, before, f"{shift}{wave}", texts)
    if cycles.number or cycles.parametric:  # over after so many, as before the first
        last = f"{texts.factor(cycles, '')}/({texts.factor(frequency, 'Hz')})"
        if frequency.parametric:
            last = f"{texts.factor(cycles, '')}/({texts.factor(frequency, '')}*(1 Hz))"
        if delay.number or delay.parametric:
            last = f"{texts.factor(delay, 's')} + {last}"
        text = f"if time < {last} then ({text}) else {before}"
    lead = max(0.0, -delay.number)
    angle = math.radians(phase.number) + 2.0 * math.pi * frequency.number * lead
    initial = offset.number + size.number * math.sin(angle) * math.exp(-damping.number * lead)
    return Drive(text, None, initial, False)


def _exponential(
    branch: Branch, given: tuple[Value, ...], texts: Texts, clock: Clock, unit: str
) -> Drive:
    _counted(branch, given, 2, 6)
    low, high = given[0], given[1]
    first, rising = _pick(given, 2, ZERO), _pick(given, 3, clock.step)
    later = first.number + clock.step.number
    second = _pick(given, 4, Value(Number(later), later))
    falling = _pick(given, 5, clock.step)
    if min(rising.number, falling.number) <= 0.0:
        raise _impossible(branch, "a time constant is not positive", "give it, or .tran")
    if second.number < first.number or first.number < 0.0:
        raise _impossible(branch, "the delays do not follow each other", "swap them")

    def decay(delay: Value, constant: Value) -> str:
        return f"(1 - exp(-{_since(delay, texts)}/({texts.factor(constant, 's')})))"

    v1, v2 = texts.factor(low, unit), texts.factor(high, unit)
    if low.parametric or low.number:
        rise = f"{v1} + ({v2} - {_bracketed(v1)})*{decay(first, rising)}"
        fall = f"{rise} + ({v1} - {_bracketed(v2)})*{decay(second, falling)}"
    else:
        rise = f"{v2}*{decay(first, rising)}"
        fall = f"{v2}*({decay(first, rising)} - {decay(second, falling)})"
    text = f"if time < {texts.factor(second, 's')} then {rise} else {fall}"
    return Drive(_delayed(first, v1, text, texts), None, low.number, False)


def _bracketed(text: str) -> str:
    return f"({text})" if text.startswith("-") else text


def _lines(branch: Branch, given: tuple[Value, ...], texts: Texts, unit: str) -> Drive:
    if len(given) < 2 or len(given) % 2:
        raise branch.line.refuse(
            f"PWL has {len(given)} values", code="HB-F130", hint="pairs of time and value"
        )
    corners = [([given[k]], given[k + 1]) for k in range(0, len(given), 2)]
    times = [at[0].number for at, _ in corners]
    if any(b < a for a, b in pairwise(times)):
        raise _impossible(branch, "the times of PWL decrease", "sort the pairs")
    delay, repeat = branch.shape.get("td"), branch.shape.get("r")
    if delay is not None:
        corners = [([*at, delay], level) for at, level in corners]
    if repeat is None or repeat.number < 0.0:
        return _table(branch, corners, None, texts, unit)
    return _repeated(branch, corners, times, repeat, texts, unit)


def _repeated(
    branch: Branch,
    corners: list[tuple[list[Value], Value]],
    times: list[float],
    repeat: Value,
    texts: Texts,
    unit: str,
) -> Drive:
    """Return lines that go on from the time `repeat`, which is one of theirs, at their end."""
    if repeat.number not in (0.0, *times) or repeat.number >= times[-1]:
        raise _impossible(
            branch,
            f"it cannot be repeated from {repeat.number:g} s",
            "zero, or the time of one of its points before the last",
        )
    span = number_of(times[-1] - repeat.number)
    if repeat.number > times[0]:
        raise _impossible(
            branch,
            "a part of it comes once, another one again and again",
            "two sources in series: one for what comes once, one that is repeated from 0",
        )
    if times[0] > 0.0:
        before = [branch.shape["td"]] if "td" in branch.shape else [ZERO]
        corners = [(before, corners[0][1]), *corners]
    return _table(branch, corners, span, texts, unit)


def _modulated(
    branch: Branch, given: tuple[Value, ...], texts: Texts, clock: Clock, unit: str
) -> Drive:
    _counted(branch, given, 2, 7)
    stop = 1.0 / clock.stop.number if clock.stop.number else 0.0
    default = Value(Number(stop), stop)
    carrier, index, signal = (
        _pick(given, 2, default),
        _pick(given, 3, ZERO),
        _pick(given, 4, default),
    )
    turns = [_pick(given, k, ZERO) for k in (5, 6)]
    ahead, within = (_turn(phase, texts) for phase in turns)
    inner = f"{texts.factor(index, '')}*sin({_angle(signal, 'time', texts)}{within})"
    wave = f"{texts.factor(given[1], unit)}*sin({_angle(carrier, 'time', texts)}{ahead} + {inner})"
    angle, other = (math.radians(phase.number) for phase in turns)
    first = given[1].number * math.sin(angle + index.number * math.sin(other))
    text = f"{_offset(given[0], texts, unit)}{wave}"
    return Drive(text, None, given[0].number + first, False)


def _amplitude(branch: Branch, given: tuple[Value, ...], texts: Texts, unit: str) -> Drive:
    """Return a carrier of modulated amplitude: size (offset + sin) sin, since the delay."""
    _counted(branch, given, 4, 5)
    size, offset, signal, carrier = given[:4]
    delay = _pick(given, 4, ZERO)
    since = _since(delay, texts)
    shape = f"{_offset(offset, texts, '')}sin({_angle(signal, since, texts)})"
    wave = f"{texts.factor(size, unit)}*({shape})*sin({_angle(carrier, since, texts)})"
    return Drive(_delayed(delay, f"0 {unit}", wave, texts), None, 0.0, False)
