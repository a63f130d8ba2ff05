"""What a run is asked for: options as given, else as the experiment of the model says."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from hybond.errors import UsageError
from hybond.modes.impacts.laws import IMPACT_LAWS
from hybond.modes.sliding.bands import CHOICES, Choice
from hybond.names import did_you_mean
from hybond.units import parse_unit, try_quantity

RTOL = 1e-8
"""Default relative tolerance."""

STEPPING_IMPACT = "newton_simultaneous"
"""The law of impacts that time-stepping has built in."""


def end_of(until: float | str | None, experiment: Mapping[str, Any]) -> float:
    """Return when a run ends, s: as asked for, or as the experiment says.

    Raises
    ------
    UsageError
        HB-S106 if neither says so, or it is no time after 0.

    Examples
    --------
    >>> end_of(None, {"until": "50 ms"})
    0.05
    """
    end = seconds_of(until if until is not None else experiment.get("until"), "until")
    if end is None or not 0.0 < end < math.inf:
        raise UsageError(
            "the run has no end time" if end is None else f"until = {end:g} s",
            code="HB-S106",
            where="until",
            hint='give until="1 s", or [experiment] until in the file',
        )
    return end


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
    rtol = float(rtol if rtol is not None else experiment.get("rtol", RTOL))
    if not 1e-14 <= rtol < 1.0:
        raise UsageError(
            f"rtol = {rtol:g} is out of range", code="HB-S107", where="rtol", hint="1e-12 to 1e-2"
        )
    atol = atol if atol is not None else experiment.get("atol")
    if atol is None:
        return rtol, None
    if not 0.0 <= float(atol) < math.inf:
        raise UsageError(
            f"atol = {float(atol):g} is out of range",
            code="HB-S107",
            where="atol",
            hint="leave it out, or give a positive number in SI",
        )
    return rtol, float(atol)


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


def seconds_of(value: Any, where: str) -> float | None:
    """Return a time as it was given, s.

    Raises
    ------
    UsageError
        HB-S106 for what is none.

    Examples
    --------
    >>> seconds_of("200 ms", "until"), seconds_of(None, "step")
    (0.2, None)
    """
    if value is None or isinstance(value, float | int):
        return None if value is None else float(value)
    quantity = try_quantity(str(value))
    if quantity is None or quantity.dimension not in (parse_unit("s")[1], parse_unit("1")[1]):
        raise UsageError(
            f"{value!r} is not a time", code="HB-S106", where=where, hint='write 0.2 or "200 ms"'
        )
    return quantity.value


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
