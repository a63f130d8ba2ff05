"""What a run is asked for, as given or as its experiment says, and as numbers in tables."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from hybond.engine.impacts.impact_records import LZB, NEWTON, NEWTON_SIMULTANEOUS, POISSON
from hybond.engine.method_numbers import AUTO, EULER, EXACT, LIQSS1, MOREAU, QSS1, RADAU, RK4, RK45
from hybond.engine.tables.bands import banded
from hybond.errors import UsageError
from hybond.model.expressions import Expr, Name
from hybond.model.graph import FlatGraph
from hybond.model.inputs import Called
from hybond.options import ALIASES, OPTIONS, STEPPING, STEPPING_IMPACT
from hybond.records import dataclass
from hybond.runs.asked import chosen, ignored_impact, opened
from hybond.runs.ends import ends_of
from hybond.runs.times import end_of, span_of

POINTS = 500
"""Rows of the table beside those of events, unless the experiment says otherwise."""
METHODS = {
    **{"rk45": RK45, "radau": RADAU, "exact": EXACT, "auto": AUTO},
    **{"rk4": RK4, "euler": EULER, "moreau-jean": MOREAU},
    **{f"qss{order}": QSS1 + order - 1 for order in (1, 2, 3)},
    **{f"liqss{order}": LIQSS1 + order - 1 for order in (1, 2, 3)},
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
    """What thresholds of time are parts of, s: see `runs.times.span_of`."""
    solver: str
    """One of `METHODS`."""
    step: float | None
    """Of fixed steps, s."""
    event_tol: float
    max_events: int
    max_writes: int
    rtol: float
    atol: float | None
    max_step: float
    slides: bool
    impact: tuple[str, float]
    """Law of impacts, and the exponent of springs."""
    max_steps: int
    theta: float
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
    **asked: Any,
) -> tuple[Settings, float | None]:
    """Return what a run is asked for, and the band of its switching surfaces if they have one.

    The options are those of `hybond.runs.asked.RunOptions`; what is not given is as the experiment
    says.

    Raises
    ------
    UsageError
        For what is wrong with them.
    """
    end = end_of(until, experiment)
    found = chosen(asked, experiment)
    impact = found["impact"]
    settings = Settings(
        until=end,
        span=span_of(experiment, end),
        solver=found["solver"],
        step=found["step"],
        rtol=found["rtol"],
        atol=found["atol"],
        max_step=math.inf if found["max_step"] is None else found["max_step"],
        event_tol=found["event_tol"],
        slides=found["sliding"] == "filippov",
        impact=("lzb", 1.5) if impact == "lzb_hertz" else (impact, 1.0),
        max_events=found["max_events"],
        max_steps=found["max_steps"],
        max_writes=found["max_writes"],
        theta=OPTIONS["theta"].default if found["theta"] is None else found["theta"],
    )
    return settings, found["hysteresis"]


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
    own = opened({name: value for name, value in given.items() if name != "points"})
    name = str(own.get("solver") or experiment.get("solver", OPTIONS["solver"].default))
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
    return [text for text in (said, _unknown_inputs(settings, graph)) if text is not None]


def _unknown_inputs(settings: Settings, graph: FlatGraph) -> str | None:
    """Return what is to be said of inputs of which nothing is known between steps."""
    names = [
        i.path for i in graph.inputs if isinstance(i.waveform, Called) and not i.waveform.breaks
    ]
    if not names or settings.max_step < math.inf or settings.step is not None:
        return None
    return (
        f"nothing is known beforehand of {', '.join(names)}, given by functions: what is shorter "
        "than a step may be passed over; max_step bounds steps, breaks end them"
    )


def _friction_left_out(impact: str, graph: FlatGraph) -> str | None:
    """Return what is to be said where a law of impacts has no friction, and the model has some."""
    names = [m.path for m in graph.machines if m.law for law in m.law.junctions if law.impulsive]
    if not names or impact in ("newton", STEPPING_IMPACT):
        return None
    return (
        f"impact = {impact!r} has no friction: the impulses of {', '.join(names)} are left out; "
        f"'newton' and {STEPPING_IMPACT!r} have them"
    )
