"""Lists, times, signals and modes as they are written behind options."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence

from hybond.errors import HybondError, ModelError, UnitError, UsageError
from hybond.measures.asked import asked_of_experiment
from hybond.model.graph import FlatGraph, Mode
from hybond.names import did_you_mean
from hybond.options import seconds
from hybond.runs.ends import Until, ended, ends_of
from hybond.runs.times import is_condition, time_in
from hybond.scripts.steps import conditions_of, steps_of, unrolled
from hybond.units import try_quantity


def split(texts: Iterable[str]) -> list[str]:
    """Split at commas, but not within parentheses or quotes.

    Examples
    --------
    >>> split(["height, max(a.e, b.e)", '"a -> b".f'])
    ['height', 'max(a.e, b.e)', '"a -> b".f']
    """
    found = []
    for text in texts:
        word, depth, quoted = "", 0, False
        for letter in text + ",":
            quoted ^= letter == '"'
            if not quoted:
                depth += (letter == "(") - (letter == ")")
            if letter == "," and not quoted and depth <= 0:
                found.append(word.strip())
                word = ""
            else:
                word += letter
        found.append(word.strip())  # what an open parenthesis or quote has kept
    return [word for word in found if word]


_SUFFIX = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))\s?([kunpµμ])")
_POWERS = {"k": 3, "u": -6, "µ": -6, "μ": -6, "n": -9, "p": -12}


def scaled(text: str) -> str:
    """Return a number with a prefix and no unit, as circuits have it, as a plain number.

    Only with prefixes that are no unit by themselves and mean the same in circuits: ``m`` is a
    metre, and ``M`` is a thousandth there.

    Examples
    --------
    >>> scaled("1k"), scaled("4.7 u"), scaled("1 m"), scaled("2*k")
    ('1e3', '4.7e-6', '1 m', '2*k')
    """
    match = _SUFFIX.fullmatch(text.strip())
    return f"{match[1]}e{_POWERS[match[2]]}" if match else text


def setting(text: str, where: str) -> tuple[str, float]:
    """Return the name and number of ``name=value``; the number with any unit, in SI.

    Raises
    ------
    UsageError
        HB-X101.

    Examples
    --------
    >>> setting("height=20 mm", "--at")
    ('height', 0.02)
    """
    name, _, value = (word.strip() for word in text.partition("="))
    quantity = try_quantity(value)
    if not name or quantity is None:
        raise UsageError(
            f"{text!r} is not NAME=VALUE", code="HB-X101", where=where, hint="such as height=0"
        )
    return name, quantity.value


def sweep(text: str, where: str) -> tuple[str, float, float]:
    """Return the name and the range of ``name=low..high``, in SI.

    Raises
    ------
    UsageError
        HB-X101.

    Examples
    --------
    >>> sweep("ball.p=-3..1 N*s", "--coverage")
    ('ball.p', -3.0, 1.0)
    """
    name, _, span = (word.strip() for word in text.partition("="))
    low, _, high = (try_quantity(word.strip()) for word in span.partition(".."))
    if not name or low is None or high is None:
        raise UsageError(
            f"{text!r} is not QUANTITY=LOW..HIGH",
            code="HB-X101",
            where=where,
            hint="such as ball.p=-3..1",
        )
    return name, low.value, high.value


def sample_times(texts: Sequence[str], until: float) -> list[float]:
    """Return the times of ``--at``, all within the run to come.

    Raises
    ------
    UsageError
        HB-S106 no time, HB-S110 a time outside the run.
    """
    times = [seconds(text, "--at") for text in split(texts)]
    for t in times:
        if not 0.0 <= t <= until:
            raise UsageError(
                f"the run goes from 0 to {until:.9g} s, not to {t:g} s",
                code="HB-S110",
                where="--at",
                hint="ask for a time within it, or give --until",
            )
    return times


def run_until(graph: FlatGraph, until: Sequence[str] | None) -> tuple[Until, float]:
    """Return what ends the run, and when it ends at the latest, s.

    Raises
    ------
    UsageError
        HB-S106 if neither the options nor the file say so, or they make no sense; HB-S132 for
        conditions without a time.
    ModelError
        HB-S106 if what the file says makes no sense.
    """
    given = list(until) if until else None
    where = "experiment.until" if given is None else "--until"
    try:
        ends = ends_of(given, graph.experiment)
    except UsageError as error:
        kind = ModelError if given is None else UsageError
        raise kind(error.why, code=error.code, where=where, hint=error.hint) from None
    if given is None:
        return None, end_time(graph, None)
    time = ends.time
    return given, end_time(graph, None if time is None else str(time))


def end_time(graph: FlatGraph, until: str | None) -> float:
    """Return when the run is to end at the latest, s.

    Raises
    ------
    UsageError
        HB-S106 if neither the option nor the file says so, or the option makes no sense.
    ModelError
        HB-S106 if what the file says makes no sense.
    """
    given = time_in(graph.experiment.get("until")) if until is None else until
    if given is None:
        raise UsageError(
            "the run has no end time",
            code="HB-S106",
            where="--until",
            hint="give --until 1s, or [experiment] until in the file",
        )
    where = "experiment.until" if until is None else "--until"
    try:
        end = seconds(given, where)
        if not 0.0 < end < math.inf:
            raise UsageError(
                f"until = {end:g} s", code="HB-S106", where=where, hint="a time after 0"
            )
    except UsageError as error:
        if until is None:
            raise ModelError(
                error.why, code=error.code, where=error.where, hint=error.hint
            ) from None
        raise
    return end


def check_signals(graph: FlatGraph, names: Iterable[str], where: str) -> list[str]:
    """Return `names` if the model has them all, before a long run finds out.

    Raises
    ------
    UsageError or ModelError
        HB-S109, by who asked: an option or the file.
    """
    assert graph.read is not None
    known = [*(s.path for s in graph.storages), *(i.path for i in graph.integrals)]
    for name in (wanted := list(names)):
        try:
            graph.read(name)
        except UnitError as error:
            error.where = where
            raise
        except HybondError as error:
            refusal = UsageError if where.startswith("--") else ModelError
            raise refusal(
                f"there is no signal {name!r}: {error.why}",
                code="HB-S109",
                where=where,
                hint=error.hint or did_you_mean(name, [*known, *graph.signals]),
            ) from None
    return wanted


def check_experiment(graph: FlatGraph) -> None:
    """Refuse an experiment with names that the model does not have, or steps without sense."""
    for key in ("plot", "outputs"):
        check_signals(graph, map(str, graph.experiment.get(key, ())), f"experiment.{key}")
    until = graph.experiment.get("until")
    listed = until if isinstance(until, list | tuple) else [until]
    conditions = [("experiment.until", u) for u in listed if is_condition(u)]
    script = graph.experiment.get("script")
    steps = steps_of(script, "experiment.script") if script is not None else ()
    conditions += [("experiment.script", c) for s in unrolled(steps) for c in conditions_of(s)]
    for where, text in dict.fromkeys(conditions):
        try:
            ended(graph, [str(text)])
        except UsageError as error:
            raise ModelError(error.why, code=error.code, where=where, hint=error.hint) from None
    asked_of_experiment(graph)


def mode_of(graph: FlatGraph, text: str | None) -> Mode:
    """Return the mode written as ``machine=state,...``; machines not named are in their start.

    Raises
    ------
    UsageError
        HB-X105 with the nearest names.
    """
    mode = list(graph.start_mode)
    machines = {m.path: m for m in graph.machines}
    for pair in split([text or ""]):
        name, _, state = (word.strip() for word in pair.partition("="))
        if name not in machines:
            raise UsageError(
                f"there is no machine {name!r}",
                code="HB-X105",
                where="--mode",
                hint=did_you_mean(name, machines) or "the model has no machines",
            )
        machine = machines[name]
        if state not in machine.states:
            raise UsageError(
                f"the machine {name!r} has no state {state!r}",
                code="HB-X105",
                where="--mode",
                hint=did_you_mean(state, machine.states),
            )
        mode[machine.index] = machine.states.index(state)
    return tuple(mode)
