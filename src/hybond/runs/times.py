"""When a run ends at the latest, and what its thresholds of time are parts of."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from hybond.errors import UsageError
from hybond.model.graph import FlatGraph, Sample
from hybond.options import seconds_of

FARTHEST = 1000.0
"""How many times longer or shorter than a run its scale of time may be."""
INSTANTS = 1e9
"""Instants of one signal or input that a run may come to: they take hours, and no room is left."""
_CONDITION = re.compile(r"[<>=!]|\b(and|or|not|true|false)\b|\.on\b")


def time_in(until: Any) -> Any:
    """Return what of an end is a time: of a list the one that is no condition; None if none is.

    Examples
    --------
    >>> time_in("v.f < 0"), time_in(["v.f < 0", "10 s"]), time_in(2)
    (None, '10 s', 2)
    """
    listed = until if isinstance(until, list | tuple) else [until]
    return next((u for u in listed if u is not None and not is_condition(u)), None)


def is_condition(until: Any) -> bool:
    """Whether an end is a condition, and no time.

    Examples
    --------
    >>> is_condition("v.f < 0"), is_condition("valve.on"), is_condition("10 s")
    (True, True, False)
    """
    return isinstance(until, str) and _CONDITION.search(until) is not None


def end_of(
    until: float | str | Sequence[float | str] | None, experiment: Mapping[str, Any]
) -> float:
    """Return when a run ends at the latest, s: as asked for, or as the experiment says.

    Raises
    ------
    UsageError
        HB-S106 if neither says so, or it is no time after 0.

    Examples
    --------
    >>> end_of(None, {"until": "50 ms"})
    0.05
    """
    given = time_in(until)
    end = seconds_of(given if given is not None else time_in(experiment.get("until")), "until")
    if end is None or not 0.0 < end < math.inf:
        raise UsageError(
            "the run has no end time" if end is None else f"until = {end:g} s",
            code="HB-S106",
            where="until",
            hint='give until="1 s", or [experiment] until in the file',
        )
    return end


def check_instants(graph: FlatGraph, end: float) -> None:
    """Refuse a run with more instants that are given in advance than it could ever come to.

    Raises
    ------
    UsageError
        HB-S142 for what is sampled, or repeats, more often than `INSTANTS` times.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model()
    >>> m.input(u=hb.Input(pwm={"period": "1 fs", "duty": 0.5, "low": 0, "high": 1}))
    >>> check_instants(m.flatten(), 1.0)
    Traceback (most recent call last):
        ...
    hybond.errors.UsageError: HB-S142 at inputs.u: a period of 1e-15 s in a run of 1 s: 1e+15 times
      try: a longer period, or a shorter run: at most 1e+09 times
    """
    periods = [(f"inputs.{i.path}", getattr(i.waveform, "period", 0.0)) for i in graph.inputs]
    for where, period in [*periods, *((_sampled(s), s.every) for s in graph.samples)]:
        if period > 0.0 and period * INSTANTS < end:
            raise UsageError(
                f"a period of {period:.6g} s in a run of {end:.6g} s: {end / period:.6g} times",
                code="HB-S142",
                where=where,
                hint=f"a longer period, or a shorter run: at most {INSTANTS:g} times",
            )


def _sampled(sample: Sample) -> str:
    return f"{'signals' if sample.block is None else 'blocks'}.{sample.path}"


def span_of(experiment: Mapping[str, Any], end: float) -> float:
    """Return what thresholds of time in a run are parts of, s.

    It is how long the experiment lasts, and not the run that is made of it: then a shorter run is
    the beginning of the longer one, and runs that go on from one another are the whole. Only a run
    that is a thousand times shorter or longer has a scale of its own.

    Examples
    --------
    >>> span_of({"until": "2 s"}, 0.5), span_of({}, 0.5), span_of({"until": "1 h"}, 1e-3)
    (2.0, 0.5, 1.0)
    """
    own = seconds_of(time_in(experiment.get("until")), "until")
    if own is None or not 0.0 < own < math.inf:
        return end
    return min(max(own, end / FARTHEST), end * FARTHEST)
