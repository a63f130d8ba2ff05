"""What is collected of each member of a sweep, as text: ``final(ball.p)``, ``count(events)``.

    collector = "ended" | "mode" | "sequence" | function "(" what {"," argument} ")"

Functions are `COLLECTORS` and all measurements (`hybond.measures.asked.FUNCTIONS`). Text is read,
not run.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Literal

from hybond.errors import HybondError, UsageError
from hybond.measures.asked import FUNCTIONS, Asked, read_measure, split_arguments
from hybond.measures.naming import read_name
from hybond.measures.window import time_of
from hybond.model.graph import FlatGraph
from hybond.model.unit_words import unit_of
from hybond.names import did_you_mean, is_number
from hybond.records import dataclass

COLLECTORS: Mapping[str, str] = {
    "final": f"final(x): {FUNCTIONS['final'][2]}",
    "at": f"at(x, 1 ms): {FUNCTIONS['at'][2]}",
    "curve": "curve(x, 101): values at so many even times, 0 and the end among them",
    "count": "count(events), the start included; count(M): how often machine M changed its state",
    "mode_time": "mode_time(M.s): how long machine M was in its state s; junctions: x.on, x.off",
    "first": "first(M.s): when machine M was in its state s first; nan if it never was",
    "ended": "ended: what ended it: time, a condition, accumulation, unsound or error",
    "mode": "mode: the states of all machines where the run ended",
    "sequence": "sequence: the modes one after the other",
}
"""Each with how it is written and what it is; those that are measurements, too, are read together
for all runs."""

WORDS = ("ended", "mode", "sequence")
"""Those that are given nothing, and are texts."""
Kind = Literal["number", "whole", "text", "curve"]
_CALL = re.compile(r"\s*(\w+)\s*\((.*)\)\s*\Z", re.DOTALL)
POINTS = 100_000
"""Values of a curve, at the most."""


@dataclass(frozen=True, slots=True)
class Collector:
    """One thing that is collected.

    Parameters
    ----------
    text : str
        As written, the name of its column.
    function : str
    signal : str
        The signal, or the machine; ``M.s`` of `mode_time` and `first`.
    t : float
        Of ``at``, s.
    points : int
        Of ``curve``.
    measure : Asked or None
        A measurement of a whole run.
    machine : int
        Its number, -1 if there is none; `states` are those that count.
    unit : str
        SI; empty if there is none.
    """

    text: str
    function: str
    signal: str = ""
    t: float = 0.0
    points: int = 0
    measure: Asked | None = None
    machine: int = -1
    states: tuple[int, ...] = ()
    unit: str = ""

    @property
    def kind(self) -> Kind:
        """What its column holds."""
        if self.function in WORDS:
            return "text"
        if self.function == "count":
            return "whole"
        return "curve" if self.function == "curve" else "number"

    @property
    def of_modes(self) -> bool:
        """Whether it asks for the modes of a run."""
        of_machine = self.function in ("mode_time", "first", "mode", "sequence")
        return of_machine or (self.function == "count" and self.machine >= 0)


def collectors_of(graph: FlatGraph, texts: str | Sequence[str]) -> tuple[Collector, ...]:
    """Return what texts ask for; several may stand in one, with commas between.

    Raises
    ------
    UsageError
        HB-P103 for what is no collector, HB-P104 for a function, machine or state that there is
        not, HB-S109 for a signal, and those of measurements.
    """
    whole = [texts] if isinstance(texts, str) else list(texts)
    words: list[str] = []
    for text in whole:
        found = split_arguments(text) if isinstance(text, str) else None
        if found is None or not any(found):
            raise _refusal(f"{text!r} asks for nothing")
        words += [word for word in found if word]
    asked = [_collector(graph, word) for word in words]
    for k, one in enumerate(asked):
        if one.text in words[:k]:
            raise _refusal(f"{one.text} is asked for twice")
    return tuple(asked)


def _collector(graph: FlatGraph, text: str) -> Collector:
    if text in WORDS:
        return Collector(text, text)
    call = _CALL.match(text)
    if call is None or call[1] in WORDS:
        raise _refusal(f"{text!r} is nothing to collect", _meant(graph, text))
    name, words = call[1], split_arguments(call[2])
    if name not in COLLECTORS and name not in FUNCTIONS:
        raise UsageError(
            f"there is no {name!r} to collect",
            code="HB-P104",
            where="collect",
            hint=did_you_mean(name, [*COLLECTORS, *FUNCTIONS]),
        )
    if name not in COLLECTORS:
        measure = read_measure(text, where="collect")
        read_name(graph, measure.signal)
        return Collector(text, name, measure.signal, measure=measure)
    takes = 2 if name in ("at", "curve") else 1
    if words is None or len(words) != takes or not all(words):
        raise _refusal(f"{text!r} is not as it is written", COLLECTORS[name])
    match name:
        case "final" | "at" | "curve":
            unit = unit_of(read_name(graph, words[0]), graph)
            if name == "curve":
                return Collector(text, name, words[0], points=_points(text, words[1]), unit=unit)
            t = 0.0 if name == "final" else _time(text, words[1])
            return Collector(text, name, words[0], t=t, unit=unit)
        case "count":
            return Collector(text, name, words[0], machine=_counted(graph, words[0]))
        case _:
            machine, states = _states(graph, words[0])
            return Collector(text, name, words[0], machine=machine, states=states, unit="s")


def _meant(graph: FlatGraph, text: str) -> str:
    """Return what to collect of what is a signal; else nothing better than the usual."""
    try:
        read_name(graph, text)
    except HybondError:
        return did_you_mean(text, WORDS) if text.isidentifier() else ""
    return f"final({text}), at({text}, 1 ms), max({text})"


def _points(text: str, word: str) -> int:
    if not word.isdecimal() or not 2 <= int(word) <= POINTS:
        raise _refusal(f"{text!r} has {word!r} values", f"2 to {POINTS}: curve(height, 101)")
    return int(word)


def _time(text: str, word: str) -> float:
    try:
        t = time_of(word if not is_number(word) else float(word), "collect")
    except HybondError as error:
        raise _refusal(f"{text!r}: {error.why}", COLLECTORS["at"]) from None
    if not t >= 0.0:
        raise _refusal(f"{text!r} is before the start", COLLECTORS["at"])
    return t


def _counted(graph: FlatGraph, name: str) -> int:
    if name == "events":
        return -1
    by_path = {m.path: m.index for m in graph.machines}
    if name not in by_path:
        raise UsageError(
            f"there is no machine {name!r}",
            code="HB-P104",
            where="collect",
            hint=did_you_mean(name, ["events", *by_path]),
        )
    return by_path[name]


def _states(graph: FlatGraph, text: str) -> tuple[int, tuple[int, ...]]:
    """Return a machine and its states: one by its name, or those in which a junction is ON."""
    path, _, state = text.rpartition(".")
    for machine in graph.machines:
        if machine.path == path and state in machine.states:
            return machine.index, (machine.states.index(state),)
    if state in ("on", "off"):
        for machine in graph.machines:
            for node in machine.controls:
                if graph.nodes[node].path == path:
                    on = (state == "on",)
                    which = [k for k, nodes in enumerate(machine.on) if (node in nodes) in on]
                    return machine.index, tuple(which)
    known = [f"{m.path}.{s}" for m in graph.machines for s in m.states]
    switched = {graph.nodes[n].path for m in graph.machines for n in m.controls}
    known += [f"{path}.{s}" for path in sorted(switched) for s in ("on", "off")]
    raise UsageError(
        f"there is no state {text!r}",
        code="HB-P104",
        where="collect",
        hint=did_you_mean(text, known) or "MACHINE.STATE, or JUNCTION.on",
    )


def _refusal(why: str, hint: str = "") -> UsageError:
    return UsageError(
        why,
        code="HB-P103",
        where="collect",
        hint=hint or "such as 'final(ball.p), max(contact.e), count(events)'",
    )
