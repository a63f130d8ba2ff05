"""What a run is asked for: options as given, else as the experiment of the model says."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any, Literal

from hybond.errors import UsageError
from hybond.names import did_you_mean
from hybond.units import parse_unit, try_quantity

RTOL = 1e-8
"""Default relative tolerance."""

Choice = Literal["filippov", "hysteresis", "refuse"]
CHOICES: tuple[Choice, ...] = ("filippov", "hysteresis", "refuse")
"""What to do on a surface into which both sides push."""

IMPACT_LAWS: dict[str, str] = {
    "newton": "approaching contacts rebound together, step by step until none approaches",
    "newton_simultaneous": "all closed contacts rebound at once by their velocity before",
    "poisson": "all closed contacts compress, then return a part of their impulse",
    "lzb": "all closed contacts act as stiff springs that return a part of their energy",
}
"""The laws by name, each with its meaning in one line."""

SOLVERS: dict[str, str] = {
    "auto": "exact for linear modes, else rk45, and radau where that is stiff; the default",
    "rk45": "explicit Runge-Kutta 5(4) of Dormand and Prince, adaptive",
    "radau": "implicit Runge-Kutta of order 5 (Radau IIA), adaptive; for stiff models",
    "exact": "exact propagation of linear modes by the exponential of a matrix; rk45 elsewhere",
    "rk4": "classical Runge-Kutta of order 4, fixed step",
    "euler": "forward Euler, fixed step; to reproduce published results",
    "qss1": "quantised states of order 1: constant between their events; for coarse tolerances",
    "qss2": "quantised states of order 2: lines between their events",
    "qss3": "quantised states of order 3: parabolas between their events; also named qss",
    "liqss1": "linearly implicit quantised states of order 1; stiff, for coarse tolerances",
    "liqss2": "linearly implicit quantised states of order 2, for stiff models; also named liqss",
    "liqss3": "linearly implicit quantised states of order 3, for stiff models",
}
"""Names of the solvers, each with a line that says what it is."""

FIXED = ("rk4", "euler")
"""Those with a fixed step."""

_CONDITION = re.compile(r"[<>=!]|\b(and|or|not|true|false)\b|\.on\b")
DEFAULT = "auto"
"""The one of a run that does not say."""

STEPPING: dict[str, str] = {
    "moreau-jean": "time-stepping of Moreau and Jean: fixed steps, contacts and diodes within them",
}
"""Methods that replace the executive as well, each with a line that says what it is."""

QUANTISED = ("qss1", "qss2", "qss3", "liqss1", "liqss2", "liqss3")
"""Those that quantise states."""

ALIASES: dict[str, str] = {"qss": "qss3", "liqss": "liqss2"}
"""Families of solvers by the member to begin with."""

STEPPING_IMPACT = "newton_simultaneous"
"""The law of impacts that time-stepping has built in."""


def solver_of(solver: str | None, experiment: Mapping[str, Any]) -> str:
    """Return the solver of a run, as asked for or as the experiment says, by its own name.

    Raises
    ------
    UsageError
        HB-S101 if there is none of that name.

    Examples
    --------
    >>> solver_of(None, {"solver": "qss"})
    'qss3'
    """
    name = str(solver or experiment.get("solver", DEFAULT))
    name = ALIASES.get(name, name)
    known = (*SOLVERS, *STEPPING)
    if name not in known:
        raise UsageError(
            f"no solver {name!r}", code="HB-S101", where="solver", hint=did_you_mean(name, known)
        )
    return name


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


FARTHEST = 1000.0
"""How many times longer or shorter than a run its scale of time may be."""


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


def tolerances_of(
    rtol: float | None, atol: float | None, experiment: Mapping[str, Any]
) -> tuple[float, float | None]:
    """Return relative and absolute tolerance, as asked for or as the experiment says.

    Raises
    ------
    UsageError
        HB-S107.

    Examples
    --------
    >>> tolerances_of(None, None, {"atol": 1e-6})
    (1e-08, 1e-06)
    """
    rtol = _number(rtol if rtol is not None else experiment.get("rtol", RTOL), "rtol")
    if not 1e-14 <= rtol < 1.0:
        raise UsageError(
            f"rtol = {rtol:g} is out of range", code="HB-S107", where="rtol", hint="1e-12 to 1e-2"
        )
    atol = atol if atol is not None else experiment.get("atol")
    if atol is None:
        return rtol, None
    atol = _number(atol, "atol")
    if not 0.0 <= float(atol) < math.inf:
        raise UsageError(
            f"atol = {float(atol):g} is out of range",
            code="HB-S107",
            where="atol",
            hint="leave it out, or give a positive number in SI",
        )
    return rtol, float(atol)


def _number(value: Any, where: str) -> float:
    if not isinstance(value, Real):
        raise UsageError(
            f"{where} = {value!r} is not a number",
            code="HB-S107",
            where=where,
            hint="1e-12 to 1e-2",
        )
    return float(value)


def impact_of(impact: str | None, experiment: Mapping[str, Any]) -> tuple[str, float]:
    """Return the law of impacts and, for springs, the exponent of their force."""
    name = str(impact if impact is not None else experiment.get("impact", "newton"))
    known = (*IMPACT_LAWS, "lzb_hertz")
    if name not in known:
        raise UsageError(
            f"there is no impact law {name!r}",
            code="HB-J205",
            where="impact",
            hint=did_you_mean(name, known) or ", ".join(known),
        )
    return ("lzb", 1.5) if name == "lzb_hertz" else (name, 1.0)


def sliding_of(
    sliding: Choice | None, hysteresis: float | str | None, experiment: Mapping[str, Any]
) -> tuple[str, float | None]:
    """Return what to do on a switching surface, and the band if there is one."""
    choice = str(sliding if sliding is not None else experiment.get("sliding", "filippov"))
    given = hysteresis if hysteresis is not None else experiment.get("hysteresis")
    if choice not in CHOICES:
        raise UsageError(
            f"sliding = {choice!r}", code="HB-S111", where="sliding", hint=", ".join(CHOICES)
        )
    if choice != "hysteresis":
        if hysteresis is not None:
            raise UsageError(
                f'hysteresis is given, but sliding = "{choice}"',
                code="HB-S111",
                where="hysteresis",
                hint='sliding = "hysteresis"',
            )
        return choice, None
    quantity = try_quantity(str(given)) if given is not None else None
    band = given if isinstance(given, float | int) else quantity.value if quantity else None
    if band is None or not 0.0 < band < math.inf:
        raise UsageError(
            "the switching with hysteresis has no band"
            if given is None
            else f"hysteresis = {given!r}",
            code="HB-S111",
            where="hysteresis",
            hint='half the width of the band, such as hysteresis = 1e-3 or "1 mm"',
        )
    return choice, float(band)


LIMITS = {"max_events": 1_000_000, "max_steps": 4_000_000}
"""What ends a run that gets nowhere, and by default after how many."""


def limit_of(name: str, given: int | None, experiment: Mapping[str, Any]) -> int:
    """Return a limit of a run, as asked for or as the experiment says.

    Raises
    ------
    UsageError
        HB-S120 for what is no number of things.

    Examples
    --------
    >>> limit_of("max_events", None, {"max_events": 50})
    50
    """
    value = given if given is not None else experiment.get(name, LIMITS[name])
    if not isinstance(value, int) or isinstance(value, bool) or value < 1:
        raise UsageError(
            f"{name} = {value!r}", code="HB-S120", where=name, hint="a whole number, one or more"
        )
    return value


def seconds_of(value: Any, where: str) -> float | None:
    """Return a time as it was given, s, if it was; raises as `seconds`."""
    return None if value is None else seconds(value, where)


def seconds(value: Any, where: str) -> float:
    """Return a time as it was given, s.

    Raises
    ------
    UsageError
        HB-S106 for what is none.

    Examples
    --------
    >>> seconds("200 ms", "until")
    0.2
    """
    if isinstance(value, Real):
        return float(value)
    quantity = try_quantity(str(value))
    if quantity is None or quantity.dimension not in (parse_unit("s")[1], parse_unit("1")[1]):
        raise UsageError(
            f"{value!r} is not a time", code="HB-S106", where=where, hint="write 0.2 or '200 ms'"
        )
    return quantity.value


def check_step(name: str, step: float | None) -> None:
    """Refuse a fixed step that is missing or makes no sense, or is given to who chooses his own.

    Raises
    ------
    UsageError
        HB-S102 or HB-S104.
    """
    if name not in FIXED:
        if step is not None:
            raise UsageError(
                f"solver {name!r} chooses its step; a step of {step:g} s was given",
                code="HB-S104",
                where="step",
                hint='give max_step to bound it, or choose a fixed step: "rk4", "euler"',
            )
    elif step is None:
        raise UsageError(
            f"solver {name!r} has a fixed step and none is given",
            code="HB-S102",
            where="step",
            hint='give one, such as step="1 ms", or choose an adaptive solver, such as "auto"',
        )
    elif not 0.0 < step < math.inf:
        raise UsageError(
            f"a step of {step:g} s for solver {name!r}: it must be positive and finite",
            code="HB-S102",
            where="step",
            hint='give a duration, such as step="1 ms"',
        )


def stepping_step(step: float | None) -> float:
    """Return the step of time-stepping.

    Raises
    ------
    UsageError
        HB-S102 if it is missing or not positive.
    """
    if step is None or not 0.0 < step < math.inf:
        raise UsageError(
            "solver 'moreau-jean' has a fixed step and none is given"
            if step is None
            else f"a step of {step:g} s for solver 'moreau-jean': it must be positive and finite",
            code="HB-S102",
            where="step",
            hint='give one, such as step="1 ms"; the run then says how good it was',
        )
    return step


def stepping_theta(theta: object) -> float:
    """Return theta of time-stepping.

    Raises
    ------
    UsageError
        HB-S112 if it is not between 1/2 and 1.
    """
    if not isinstance(theta, float | int) or not 0.5 <= theta <= 1.0:
        raise UsageError(
            f"theta = {theta!r}",
            code="HB-S112",
            where="theta",
            hint="from 0.5 (of second order) to 1 (damps, never creates energy)",
        )
    return float(theta)


def ignored_impact(impact: str | None, experiment: Mapping[str, Any]) -> str | None:
    """Return what time-stepping has to say on a law of impacts that is not its own."""
    name = impact if impact is not None else experiment.get("impact")
    if name is None:
        return None
    # refuse names that are nobody's
    impact_of(str(name), experiment)
    if name == STEPPING_IMPACT:
        return None
    return (
        f"impact = {str(name)!r} has no effect with solver 'moreau-jean': its steps are Newton's "
        f"law for all contacts at once ({STEPPING_IMPACT!r}), and where several contacts meet at "
        "once the result may differ; take a solver that locates events, or leave impact out"
    )
