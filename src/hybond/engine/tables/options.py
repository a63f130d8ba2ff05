"""What a run is asked for, as given or as its experiment says, and as numbers in tables."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from hybond.engine.impacts.impact_records import LZB, NEWTON, NEWTON_SIMULTANEOUS, POISSON
from hybond.engine.tables.bands import banded
from hybond.errors import UsageError
from hybond.model.expressions import Expr, Name
from hybond.model.graph import FlatGraph
from hybond.records import dataclass
from hybond.runs.ends import ends_of
from hybond.runs.options import (
    ALIASES,
    DEFAULT,
    FIXED,
    STEPPING,
    STEPPING_IMPACT,
    Choice,
    check_step,
    end_of,
    ignored_impact,
    impact_of,
    limit_of,
    seconds_of,
    sliding_of,
    solver_of,
    span_of,
    stepping_step,
    stepping_theta,
    tolerances_of,
)

POINTS = 500
"""Rows of the table beside those of events, unless the experiment says otherwise."""
METHODS = {
    **{"rk45": 0, "radau": 1, "exact": 2, "auto": 3, "rk4": 4, "euler": 5, "moreau-jean": 6},
    **{"qss1": 7, "qss2": 8, "qss3": 9, "liqss1": 10, "liqss2": 11, "liqss3": 12},
}
IMPACTS = {
    "newton": NEWTON,
    "newton_simultaneous": NEWTON_SIMULTANEOUS,
    "poisson": POISSON,
    "lzb": LZB,
}


LARGEST = 2**31 - 1
"""Beyond it there is no whole number in the library."""


@dataclass(frozen=True, slots=True)
class Settings:
    """What a run is asked for."""

    until: float
    span: float
    """What thresholds of time are parts of, s: see `runs.options.span_of`."""
    solver: str
    """One of `METHODS`."""
    step: float | None
    """Of fixed steps, s."""
    event_tol: float
    max_events: int
    max_writes: int
    rtol: float = 1e-8
    atol: float | None = None
    max_step: float = math.inf
    slides: bool = False
    impact: tuple[str, float] = ("newton", 1.0)
    """Law of impacts, and the exponent of springs."""
    max_steps: int = LARGEST
    theta: float = 0.5
    """Of time-stepping."""

    @property
    def numbers(self) -> dict[str, float]:
        """The same by the fields of `hybond.engine.model.Model`."""
        # time-stepping has a law of its own, and settles instants by it as well
        impact, exponent = (STEPPING_IMPACT, 1.0) if self.solver in STEPPING else self.impact
        return {
            "until": self.until,
            "span": self.span,
            "points": 1,
            "rtol": self.rtol,
            "atol": math.nan if self.atol is None else self.atol,
            "max_step": self.max_step,
            "event_tol": self.event_tol,
            # the library counts no further
            "max_writes": min(self.max_writes, LARGEST),
            "max_events": min(self.max_events, LARGEST),
            "max_steps": min(self.max_steps, LARGEST),
            "method": METHODS[self.solver],
            "step": self.step or 0.0,
            "theta": self.theta,
            "slides": int(self.slides),
            "impact": IMPACTS[impact],
            "impact_exponent": exponent,
        }


def settings_of(
    experiment: Mapping[str, Any],
    until: float | str | Sequence[float | str] | None = None,
    *,
    solver: str | None = None,
    rtol: float | None = None,
    atol: float | None = None,
    step: float | str | None = None,
    max_step: float | str | None = None,
    theta: float | None = None,
    sliding: Choice | None = None,
    hysteresis: float | str | None = None,
    impact: str | None = None,
    max_events: int | None = None,
    max_steps: int | None = None,
) -> tuple[Settings, float | None]:
    """Return what a run is asked for, and the band of its switching surfaces if they have one.

    The parameters are those of `hybond.simulate`; what is not given is as the experiment says.

    Raises
    ------
    UsageError
        For what is wrong with them.
    """
    end = end_of(until, experiment)
    rtol, atol = tolerances_of(rtol, atol, experiment)
    name = solver_of(solver, experiment)
    given_step = seconds_of(step if step is not None else experiment.get("step"), "step")
    longest = seconds_of(
        max_step if max_step is not None else experiment.get("max_step"), "max_step"
    )
    if longest is not None and not longest > 0.0:
        raise UsageError(
            f"max_step of {longest:g} s: it must be positive",
            code="HB-S103",
            where="max_step",
            hint="leave it out to let the tolerances decide",
        )
    choice, band = sliding_of(sliding, hysteresis, experiment)
    settings = Settings(
        until=end,
        span=span_of(experiment, end),
        solver=name,
        step=None,
        rtol=rtol,
        atol=atol,
        max_step=math.inf if longest is None else longest,
        event_tol=float(experiment.get("event_tol", 1e-12)),
        slides=choice == "filippov",
        max_events=limit_of("max_events", max_events, experiment),
        max_steps=limit_of("max_steps", max_steps, experiment),
        max_writes=int(experiment.get("max_writes", 1000)),
    )
    if name in STEPPING:
        theta = theta if theta is not None else experiment.get("theta", 0.5)
        own = replace(settings, step=stepping_step(given_step), theta=stepping_theta(theta))
        return own, band
    if theta is not None:
        raise UsageError(
            f"theta is given, but solver {name!r} has none",
            code="HB-S112",
            where="theta",
            hint='solver = "moreau-jean"',
        )
    # a step written in the experiment for a fixed-step solver may stand there unused
    own_step = given_step if name in FIXED or step is not None else None
    check_step(name, own_step)
    return replace(settings, impact=impact_of(impact, experiment), step=own_step), band


@dataclass(frozen=True, slots=True)
class Options:
    """The options of an export: the graph that is run, numbers by field, outputs by name."""

    graph: FlatGraph
    numbers: dict[str, float]
    outputs: list[tuple[str, Expr]]


def options_of(graph: FlatGraph, given: Mapping[str, Any]) -> Options:
    """Return the options of an export: those given, else the experiment's, else defaults.

    Raises
    ------
    UsageError
        HB-E632 for a solver that an export does not have; HB-E607 for a table of no rows; those of
        `settings_of`.
    """
    experiment = graph.experiment
    name = str(given.get("solver") or experiment.get("solver", DEFAULT))
    if ALIASES.get(name, name) not in METHODS:
        raise UsageError(
            f"an export has no solver {name!r}",
            code="HB-E632",
            where="solver",
            hint=", ".join(METHODS),
        )
    points = int(given.get("points", experiment.get("points", POINTS)))
    if points < 1:
        raise UsageError(
            f"a table of {points} rows",
            code="HB-E607",
            where="points",
            hint="one or more: the rows beside those of events",
        )
    own = {name: value for name, value in given.items() if name != "points"}
    conditions = ends_of(own.get("until"), experiment).conditions
    if conditions or experiment.get("start") is not None:
        said = f"end where {conditions[0]!r} holds" if conditions else "begin with another start"
        raise UsageError(
            f"an export does not {said}",
            code="HB-E641",
            where="until" if conditions else "experiment.start",
            hint='give a time alone: until="10 s"' if conditions else "write it into the elements",
        )
    settings, band = settings_of(experiment, **own)
    if band is not None:
        graph = banded(graph, band)
    listed = experiment.get("outputs") or experiment.get("plot") or ()
    outputs: list[tuple[str, Expr]] = []
    assert graph.read is not None
    for text in dict.fromkeys(map(str, listed)):
        outputs.append((text, graph.read(text)))
    if not outputs:
        outputs = [(s.path, Name(f"x:{s.index}")) for s in graph.storages]
        outputs += [(i.path, Name(f"s:{i.index}")) for i in graph.integrals]
    return Options(graph, {**settings.numbers, "points": points}, outputs)


def notices(graph: FlatGraph, settings: Settings, impact: str | None) -> list[str]:
    """Return what is to be said of what a run is asked for, before it begins."""
    if settings.solver in STEPPING:
        said = ignored_impact(impact, graph.experiment)
    else:
        said = _friction_left_out(settings.impact[0], graph)
    return [] if said is None else [said]


def _friction_left_out(impact: str, graph: FlatGraph) -> str | None:
    """Return what is to be said where a law of impacts has no friction, and the model has some."""
    names = [m.path for m in graph.machines if m.law for law in m.law.junctions if law.impulsive]
    if not names or impact in ("newton", STEPPING_IMPACT):
        return None
    return (
        f"impact = {impact!r} has no friction: the impulses of {', '.join(names)} are left out; "
        f"'newton' and {STEPPING_IMPACT!r} have them"
    )
