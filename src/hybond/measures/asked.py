"""What is to be measured, as text: ``mean(L.f)``, ``rms(out.e, period=20 us, periods=5)``.

    measurement = function "(" [signal] {"," key "=" value} ")"

The signal is a name or an expression of names. Values are numbers, quantities or words. Text is
read, not run.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from typing import TYPE_CHECKING, Any

from hybond.errors import HybondError, ModelError, UsageError
from hybond.measures.foreseen import check_options, check_within
from hybond.measures.naming import read_name
from hybond.measures.value import About, Measurement
from hybond.measures.window import time_of, window_of
from hybond.model.graph import FlatGraph
from hybond.names import did_you_mean
from hybond.records import dataclass

if TYPE_CHECKING:
    from hybond.measures.signal import Signal
    from hybond.measures.stepping_up import StepInfo
    from hybond.result import Result

_WINDOW = ("start", "end", "tolerance")
_PERIODS = (*_WINDOW, "period", "periods")
_STEP = (*_WINDOW, "initial", "final", "band", "low", "high")
_HARMONICS = (*_WINDOW, "f", "periods", "harmonics")
_CROSSING = (*_WINDOW, "level", "edge")

Make = Callable[["Signal", dict[str, Any]], Measurement]


def _method(name: str) -> Make:
    def make(signal: Signal, options: dict[str, Any]) -> Measurement:
        found: Measurement = getattr(signal, name)(**options)
        return found

    return make


def _time_of(name: str) -> Make:
    def make(signal: Signal, options: dict[str, Any]) -> Measurement:
        found: Measurement = getattr(signal, name)(**options)
        assert found.t is not None
        return Measurement(found.t, About("s", found.start, found.end, how=found.how))

    return make


def _step(name: str) -> Make:
    def make(signal: Signal, options: dict[str, Any]) -> Measurement:
        info: StepInfo = signal.step_info(**options)
        value = getattr(info, name)
        if value is None:
            raise UsageError(
                f"{signal.name} gets from {info.initial:.6g} towards {info.final:.6g}, but has no "
                f"{name.replace('_', ' ')} in the window",
                code="HB-R108",
                where=f"{name}({signal.name})",
                hint="let the run go on longer, or give final=, band= or high=",
            )
        unit = "s" if name.endswith("time") else ""
        return Measurement(value, _about(signal, unit, options))

    return make


def _ripple(name: str) -> Make:
    def make(signal: Signal, options: dict[str, Any]) -> Measurement:
        value = getattr(signal.ripple(**options), name)
        return Measurement(value, _about(signal, "", options))

    return make


def _final(signal: Signal, options: dict[str, Any]) -> Measurement:
    return _at(signal, {"t": signal.run.t_end})


def _at(signal: Signal, options: dict[str, Any]) -> Measurement:
    if "t" not in options:
        raise _when(signal.name, f"at({signal.name})")
    t, side = time_of(options["t"], f"at({signal.name})"), options.get("side", "right")
    value = signal.at(t, side=side)
    return Measurement(value, About(signal.unit, t, t, t, "left" if side == "left" else ""))


def _when(name: str, where: str) -> UsageError:
    """Return the refusal of a value at no time."""
    why = f"at({name}) does not say when"
    return UsageError(why, code="HB-R120", where=where, hint=f"at({name}, 1 ms)")


def _about(signal: Signal, unit: str, options: dict[str, Any]) -> About:
    """Return over which window something was measured that does not say so itself."""
    asked = {k: v for k, v in options.items() if k in ("start", "end", "period", "periods")}
    window = window_of(signal.run, **asked)
    return About(unit, window.start, window.end)


FUNCTIONS: Mapping[str, tuple[Make, tuple[str, ...], str]] = {
    "final": (_final, (), "the value where the run ended"),
    "at": (_at, ("t", "side"), "the value at a time t, after what happened there"),
    "mean": (_method("mean"), _PERIODS, "the mean, impulses included"),
    "rms": (_method("rms"), (*_PERIODS, "impulses"), "the root of the mean square"),
    "max": (_method("max"), (*_PERIODS, "impulses"), "the maximum of the motion"),
    "min": (_method("min"), (*_PERIODS, "impulses"), "the minimum of the motion"),
    "max_at": (_time_of("max"), (*_PERIODS, "impulses"), "when the maximum is taken first"),
    "min_at": (_time_of("min"), (*_PERIODS, "impulses"), "when the minimum is taken first"),
    "peak_to_peak": (_method("peak_to_peak"), (*_PERIODS, "impulses"), "maximum less minimum"),
    "integral": (_method("integral"), _PERIODS, "the integral over time, impulses included"),
    "ripple": (_ripple("peak_to_peak"), _PERIODS, "peak to peak, as a part of the mean"),
    "ripple_rms": (_ripple("rms"), _PERIODS, "rms without the mean, as a part of the mean"),
    "thd": (_method("thd"), _HARMONICS, "distortion, as a part of the fundamental f"),
    "duty": (_method("duty"), (*_PERIODS, "level"), "part of the time above a level"),
    "frequency": (_method("frequency"), _CROSSING, "of crossings of a level, Hz"),
    "period": (_method("period"), _CROSSING, "between crossings of a level, s"),
    "rise_time": (_step("rise_time"), _STEP, "from 10 to 90 % of a step, s"),
    "overshoot": (_step("overshoot"), _STEP, "beyond the end of a step, as a part of it"),
    "settling_time": (_step("settling_time"), _STEP, "until it stays within 2 % of its end, s"),
}
"""Each with what makes it, the arguments it takes, and a line that says what it is."""

SECOND = {"at": "t", "thd": "f", "frequency": "level", "period": "level", "duty": "level"}
"""Arguments that may come second without a name."""

_CALL = re.compile(r"\s*(\w+)\s*\((.*)\)\s*\Z", re.DOTALL)
_KEY = re.compile(r"\s*(\w+)\s*=(?!=)\s*(.*?)\s*\Z", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Asked:
    """A measurement that is asked for.

    Parameters
    ----------
    text : str
        As written.
    function, signal : str
    options : mapping
    """

    text: str
    function: str
    signal: str
    options: Mapping[str, Any] = field(default_factory=dict)

    def of(self, run: Result) -> Measurement:
        """Return it, measured.

        Raises
        ------
        UsageError, NumericsError
            As the methods of `Signal`; HB-S109 for a signal that is not there.
        """
        make = FUNCTIONS[self.function][0]
        return make(run[self.signal], dict(self.options))

    def check(self, graph: FlatGraph) -> None:
        """Refuse what no run of a model could be asked for.

        Raises
        ------
        UsageError
            HB-S109 for a signal that is not there, HB-R101 for a time, period or level that is
            none.
        """
        check_options(self.options, read_name(graph, self.signal), graph, self.signal)


def read_measure(text: str, *, where: str = "measure") -> Asked:
    """Return what a text asks for.

    Raises
    ------
    UsageError
        HB-R120 for what is no measurement, HB-R121 for a function or an argument that is none.

    Examples
    --------
    >>> read_measure("rms(out.e, period=20 us, periods=5)").options
    {'period': '20 us', 'periods': 5.0}
    >>> read_measure("means(L.f)")
    Traceback (most recent call last):
        ...
    hybond.errors.UsageError: HB-R121 at measure: there is no measurement 'means'
      try: did you mean 'mean'?
    """
    match = _CALL.match(text) if isinstance(text, str) else None
    if match is None:
        is_open = isinstance(text, str) and text.count("(") > text.count(")")
        raise UsageError(
            f"a parenthesis in {text!r} is left open" if is_open else f"{text!r} is no measurement",
            code="HB-R120",
            where=where,
            hint="such as mean(L.f) or rms(out.e, period=20 us, periods=5)",
        )
    name = match[1]
    if name not in FUNCTIONS:
        raise UsageError(
            f"there is no measurement {name!r}",
            code="HB-R121",
            where=where,
            hint=did_you_mean(name, FUNCTIONS),
        )
    words = split_arguments(match[2])
    if words is None or not words or not words[0] or _KEY.match(words[0]):
        raise UsageError(
            f"{text.strip()!r} does not say what is measured"
            if words is not None
            else f"a parenthesis or quote in {text.strip()!r} is left open",
            code="HB-R120",
            where=where,
            hint=f"{name}(L.f)",
        )
    takes = FUNCTIONS[name][1]
    options: dict[str, Any] = {}
    for k, word in enumerate(words[1:]):
        found = _KEY.match(word)
        key = found[1] if found else SECOND.get(name, "") if k == 0 else ""
        if not key:
            raise UsageError(
                f"{word!r} in {text.strip()!r} has no name",
                code="HB-R120",
                where=where,
                hint=f"KEY=VALUE; {name} takes {', '.join(takes)}" if takes else f"{name}(L.f)",
            )
        if key not in takes:
            raise UsageError(
                f"{name} has no argument {key!r}",
                code="HB-R121",
                where=where,
                hint=did_you_mean(key, takes) if takes else f"leave it out: {name}({words[0]})",
            )
        if key in options:
            raise UsageError(
                f"{key} is given twice in {text.strip()!r}",
                code="HB-R120",
                where=where,
                hint="give it once",
            )
        options[key] = _value(key, found[2] if found else word, where)
    if name == "at" and "t" not in options:
        raise _when(words[0], where)
    return Asked(text.strip(), name, words[0], options)


_NUMBERS = ("tolerance", "band", "low", "high")
_WORDS = ("impulses", "edge", "side")


def _value(key: str, text: str, where: str) -> Any:
    """Return the value of an argument: a number where it is one, else the text."""
    word = text.strip().strip("\"'")
    if key in _WORDS:
        return word
    try:
        number = float(word)
    except ValueError:
        if key in (*_NUMBERS, "harmonics", "periods"):
            raise UsageError(
                f"{key} = {word!r} is not a number",
                code="HB-R120",
                where=where,
                hint=f"{key}={'0.02' if key in _NUMBERS else '5'}",
            ) from None
        return word
    return int(number) if key == "harmonics" and number.is_integer() else number


def split_arguments(text: str) -> list[str] | None:
    """Split at commas outside of parentheses and quotes; None if one of those is left open.

    Examples
    --------
    >>> split_arguments('max(a.e, b.e), start=1')
    ['max(a.e, b.e)', 'start=1']
    >>> split_arguments("max(a.e") is None
    True
    """
    words, word, depth, quoted = [], "", 0, False
    for letter in text:
        quoted ^= letter == '"'
        if not quoted:
            depth += (letter in "([") - (letter in ")]")
        if depth < 0:
            return None
        if letter == "," and not quoted and not depth:
            words.append(word.strip())
            word = ""
        else:
            word += letter
    if quoted or depth:
        return None
    return [*words, word.strip()] if word.strip() or words else []


def asked_of_experiment(graph: FlatGraph, until: float | None = None) -> list[Asked]:
    """Return what ``[experiment] measure`` asks for, its names, times and levels looked at.

    Parameters
    ----------
    until : float, optional
        When the run ends, s, if that is known: no window goes beyond.

    Raises
    ------
    ModelError
        With the place in the file.
    """
    found = []
    for k, text in enumerate(graph.experiment.get("measure", ())):
        try:
            asked = read_measure(text, where=f"experiment.measure[{k}]")
            asked.check(graph)
            if until is not None:
                check_within(asked.options, until)
        except HybondError as error:
            where = f"experiment.measure[{k}]"
            refusal = ModelError(error.why, code=error.code, where=where, hint=error.hint)
            raise (graph.locate(refusal) if graph.locate is not None else refusal) from None
        found.append(asked)
    return found


def measured(run: Result, asked: Sequence[Asked]) -> dict[str, Measurement]:
    """Return measurements by their text."""
    return {one.text: one.of(run) for one in asked}
