"""The options of a run that an export takes over from the experiment of a model."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from hybond.engine.impacts.impact_records import LZB, NEWTON, NEWTON_SIMULTANEOUS, POISSON
from hybond.engine.tables.bands import banded
from hybond.errors import UsageError
from hybond.model.expressions import Expr, Name
from hybond.model.graph import FlatGraph
from hybond.run_options import (
    ALIASES,
    FIXED,
    STEPPING,
    STEPPING_IMPACT,
    check_step,
    end_of,
    impact_of,
    seconds_of,
    sliding_of,
    stepping_step,
    stepping_theta,
    tolerances_of,
)

POINTS = 500
"""Rows of the table beside those of events, unless the experiment says otherwise."""
METHODS = {
    **{"rk45": 0, "radau": 1, "exact": 2, "rk4": 3, "euler": 4},
    **{"qss1": 6, "qss2": 7, "qss3": 8, "liqss1": 9, "liqss2": 10, "liqss3": 11},
    "moreau-jean": 5,
}
IMPACTS = {
    "newton": NEWTON,
    "newton_simultaneous": NEWTON_SIMULTANEOUS,
    "poisson": POISSON,
    "lzb": LZB,
}


@dataclass(frozen=True, slots=True)
class Options:
    """The options of a run: the graph that is run, numbers by field, outputs by name."""

    graph: FlatGraph
    numbers: dict[str, float]
    outputs: list[tuple[str, Expr]]


def options_of(graph: FlatGraph, given: Mapping[str, Any]) -> Options:
    """Return the options of a run: those given, else the experiment's, else defaults.

    Raises
    ------
    UsageError
        HB-E632 for a solver that an export does not have; HB-J205 for an unknown law of impacts;
        HB-S102 and HB-S104 for a fixed step that is missing, or is none; HB-S103, HB-S106, HB-S107
        and HB-E607 for numbers that make no sense.
    """
    experiment = graph.experiment
    end = end_of(given.get("until"), experiment)
    name = str(given.get("solver") or experiment.get("solver", "rk45"))
    name = ALIASES.get(name, name)
    if name not in METHODS:
        raise UsageError(
            f"an export has no solver {name!r}",
            code="HB-E632",
            where="solver",
            hint=", ".join(METHODS),
        )
    step = seconds_of(given.get("step", experiment.get("step")), "step")
    # a step written in the experiment for a fixed-step solver may stand there unused
    if name in STEPPING:
        step = stepping_step(step)
    else:
        check_step(name, step if name in FIXED or given.get("step") is not None else None)
    impact, exponent = impact_of(given.get("impact"), experiment)
    choice, band = sliding_of(None, None, experiment)
    if band is not None:
        graph = banded(graph, band)
    longest = seconds_of(given.get("max_step", experiment.get("max_step")), "max_step")
    if longest is not None and not longest > 0.0:
        raise UsageError(
            f"max_step of {longest:g} s: it must be positive",
            code="HB-S103",
            where="max_step",
            hint="leave it out to let the tolerances decide",
        )
    points = int(given.get("points", experiment.get("points", POINTS)))
    if points < 1:
        raise UsageError(
            f"a table of {points} rows",
            code="HB-E607",
            where="points",
            hint="one or more: the rows beside those of events",
        )
    rtol, atol = tolerances_of(given.get("rtol"), given.get("atol"), experiment)
    numbers = {
        "until": end,
        "points": points,
        "rtol": rtol,
        "atol": math.nan if atol is None else atol,
        "max_step": math.inf if longest is None else longest,
        "event_tol": float(experiment.get("event_tol", 1e-12)),
        "max_writes": int(experiment.get("max_writes", 1000)),
        "max_events": int(experiment.get("max_events", 1_000_000)),
        "max_steps": int(experiment.get("max_steps", 4_000_000)),
        "method": METHODS[name],
        "step": step if name in (*FIXED, *STEPPING) and step is not None else 0.0,
        "theta": stepping_theta(given.get("theta", experiment.get("theta", 0.5))),
        "slides": int(choice == "filippov"),
        # time-stepping has a law of its own, and settles instants by it as well
        "impact": IMPACTS[STEPPING_IMPACT if name in STEPPING else impact],
        "impact_exponent": exponent,
    }
    listed = experiment.get("outputs") or experiment.get("plot") or ()
    outputs: list[tuple[str, Expr]] = []
    assert graph.read is not None
    for text in dict.fromkeys(map(str, listed)):
        outputs.append((text, graph.read(text)))
    if not outputs:
        outputs = [(s.path, Name(f"x:{s.index}")) for s in graph.storages]
        outputs += [(i.path, Name(f"s:{i.index}")) for i in graph.integrals]
    return Options(graph, numbers, outputs)
