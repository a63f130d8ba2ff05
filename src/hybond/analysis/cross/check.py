"""The same answer twice: one model run by two engines that have little in common.

Located events and time-stepping decide differently what a diode, a contact or friction does: one
finds the instant and settles the mode there, the other solves all laws over a step of fixed length.
What both say is not an artefact of either. The step is halved to see the difference shrink.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from hybond.analysis.cross.reasons import Reason, reasons, uniqueness
from hybond.analysis.cross.runs import (
    Difference,
    Events,
    compared,
    compared_events,
    quantities,
    watched,
)
from hybond.analysis.cross.verdict import Level, Verdict, agreed, hopeful, level_of, verdict_of
from hybond.calls import called
from hybond.causality.orientation import base_mode
from hybond.errors import UsageError
from hybond.model.builder import Model
from hybond.model.given import check_model
from hybond.model.graph import FlatGraph, Mode
from hybond.model.parts import Value
from hybond.names import did_you_mean
from hybond.options import ALIASES, RTOL, SOLVERS, STEPPING, seconds
from hybond.result import Result
from hybond.runs.times import end_of
from hybond.simulation import simulate

FIXED = ("moreau-jean", "rk4", "euler")
"""Engines with a step of fixed length."""
STEPS = 1000
"""Steps of a run if none is given."""
TOLERANCE = {"step": 1e-2, "rtol": 1e-4}
"""Mean difference up to which two runs agree, by what is refined."""
MORE = 3
"""Times that the step is halved beyond what was asked for, while the runs do not agree."""


@dataclass(frozen=True, slots=True)
class CrossCheck:
    """What two engines say of one model; made by `cross_check`.

    Parameters
    ----------
    model : str
    until : float
        s.
    engines : tuple of str
        The second is compared with the first.
    chosen : str
        Why these.
    refined : {"step", "rtol"}
    levels : tuple of Level
        From coarse to fine.
    tolerance : float
    differences : tuple of Difference
        At the finest level, the worst first.
    shares : tuple of Difference
        Of variables of laws that need not be unique, as the currents of two diodes in parallel;
        they do not count.
    events : Events
    reasons : tuple of Reason
        Why the runs may differ legitimately, the earliest first, whether they do or not.
    verdict : {"agree", "differ legitimately", "undecided", "differ"}
    why : str
        The verdict in words.
    """

    model: str
    until: float
    engines: tuple[str, str]
    chosen: str
    refined: Literal["step", "rtol"]
    levels: tuple[Level, ...]
    tolerance: float
    differences: tuple[Difference, ...]
    shares: tuple[Difference, ...]
    events: Events
    reasons: tuple[Reason, ...]
    verdict: Verdict
    why: str

    @property
    def agrees(self) -> bool:
        """Whether nothing is wrong: the runs agree, or differ where they may."""
        return self.verdict in ("agree", "differ legitimately")

    def to_data(self) -> dict[str, Any]:
        """Return everything as plain data in SI."""
        e = self.events
        return {
            "model": self.model,
            "until": self.until,
            "engines": list(self.engines),
            "chosen": self.chosen,
            "refined": self.refined,
            "levels": [
                {
                    self.refined: v.value,
                    "mean": v.mean,
                    "name": v.name,
                    "order": v.order,
                    "since": v.since,
                }
                for v in self.levels
            ],
            "tolerance": self.tolerance,
            "differences": [d.to_data() for d in self.differences],
            "shares": [d.to_data() for d in self.shares],
            "events": {
                "first": e.first,
                "second": e.second,
                "paired": e.paired,
                "apart": e.apart,
                "at": e.at,
                "parted": e.parted,
                "machine": e.machine,
                "states": list(e.states),
            },
            "reasons": [{"name": r.name, "text": r.text, "since": r.since} for r in self.reasons],
            "verdict": self.verdict,
            "why": self.why,
        }

    def text(self) -> str:
        """Return the check in words."""
        from hybond.analysis.cross.text import cross_text

        return cross_text(self)

    def __str__(self) -> str:
        return self.text()


@called('hb.cross_check(model, "1 s")')
def cross_check(
    model: Model | FlatGraph,
    until: float | str | None = None,
    *,
    parameters: Mapping[str, Value] | None = None,
    engines: Sequence[str] | None = None,
    step: float | str | None = None,
    levels: int = 3,
    rtol: float | None = None,
    tolerance: float | None = None,
    progress: Callable[[float, int], None] | None = None,
) -> CrossCheck:
    """Run a model with two engines, compare, and say which differences are legitimate.

    Parameters
    ----------
    model : Model or FlatGraph
    until : float or str
        End time; default the experiment's.
    parameters : mapping
        Values by dotted path that replace the model's own.
    engines : pair of str
        Solvers. Default: the experiment's own, or ``auto``, and ``moreau-jean`` if junctions have
        laws, else ``radau``; if that is its own already, ``rk45``.
    step : float or str
        The longest step of an engine with fixed steps. Default: the experiment's, or a thousandth
        of the run.
    levels : int
        How often the runs are made, 2 or more, each time with half the step; without fixed steps,
        with a hundredth of the relative tolerance. A few more are made while they do not agree.
    rtol : float
        The last relative tolerance, or that of the engine without a fixed step.
    tolerance : float
        Mean difference up to which the runs agree. Default 1e-2 with fixed steps, else 1e-4.
    progress : callable
        See `simulate`.

    Returns
    -------
    CrossCheck

    Raises
    ------
    UsageError
        HB-A401 for engines or levels that cannot be compared.
    HybondError
        If a run stops before anything can be compared.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rlcd", domain="electrical")
    >>> m.add(c=hb.C("1 uF", e="10 V"), l=hb.I("10 mH"), r=hb.R("1 kohm"))
    >>> m.add(n=hb.Zero(), d=hb.One(law="diode"))
    >>> m.bond("n -> c", "n -> l", "n -> d -> r")
    >>> found = hb.cross_check(m, "2 ms", step="5 us")
    >>> found.engines, found.verdict
    (('auto', 'moreau-jean'), 'agree')
    """
    check_model(model)
    graph = model.flatten(parameters=parameters) if isinstance(model, Model) else model
    if levels < 2:
        raise UsageError(
            f"levels = {levels}: one run with each engine does not show whether they converge",
            code="HB-A401",
            where="levels",
            hint="2 or 3",
        )
    # two engines are compared over one time, whatever else would end a run
    until = end_of(until, graph.experiment)
    pair, chosen = _engines(graph, engines)
    wide = watched(graph)
    own = simulator(wide, until, rtol, progress)
    refined: Literal["step", "rtol"] = "step" if set(pair) & set(FIXED) else "rtol"
    limit = TOLERANCE[refined] if tolerance is None else tolerance
    first: list[Result | None] = [None, None]
    found: list[Level] = []
    seen: frozenset[Mode] = frozenset()
    for value in _values(refined, graph, until, step, rtol, levels):
        if len(found) >= levels and (agreed(found, limit) or not hopeful(found, limit)):
            break
        runs = [
            last
            if last is not None and refined == "step" and name not in FIXED
            else own(name, value if refined == "step" and name in FIXED else None,
                     value if refined == "rtol" else None)
            for name, last in zip(pair, first, strict=True)
        ]  # fmt: skip
        first = list(runs)
        a, b = runs
        if a.error is not None and b.error is not None:
            raise a.error  # both say that there is no answer
        if not found:
            names = quantities(graph, a)
        modes = frozenset(base_mode(graph, s.mode) for run in runs for s in run.segments)
        if modes != seen:
            unique, seen = uniqueness(graph, sorted(modes)), modes
        h = value if refined == "step" else None
        every = compared(names, a, b, tolerance=limit, step=h)
        kept = [d for d in every if (d.quantity.machine, d.quantity.kind) not in unique.shares]
        kept.sort(key=lambda d: -d.mean)
        found.append(level_of(value, kept, found))
    if pair == ("auto", "radau") and a.turns:
        chosen += f"; auto went over to radau, too, at t = {a.turns[0].t:.6g} s"
    events = compared_events(graph, a, b)
    known = reasons(graph, a, b, step=h, unique=unique, compared=events)
    return CrossCheck(
        graph.title or graph.name,
        min(a.until, b.until),
        pair,
        chosen,
        refined,
        tuple(found),
        limit,
        tuple(kept),
        tuple(d for d in every if (d.quantity.machine, d.quantity.kind) in unique.shares),
        events,
        known,
        *verdict_of(found, limit, kept, known, (a, b), refined),
    )


def simulator(
    graph: FlatGraph,
    until: float | str | None,
    rtol: float | None,
    progress: Callable[[float, int], None] | None,
) -> Callable[[str, float | None, float | None], Result]:
    """Return ``run(engine, step, rtol)``.

    A run that stops late is compared as far as it got; one that stops at once is an error.
    """

    def run(name: str, step: float | None, tight: float | None) -> Result:
        result = simulate(
            graph,
            until,
            solver=name,
            step=step,
            rtol=tight if tight is not None else rtol,
            progress=progress,
            on_error="return",
        )
        if result.status == "interrupted":
            raise KeyboardInterrupt
        if result.error is not None and result.t_end <= 0.0:
            raise result.error
        return result

    return run


def _engines(graph: FlatGraph, engines: Sequence[str] | None) -> tuple[tuple[str, str], str]:
    """Return the engines, and why these."""
    known = (*SOLVERS, *STEPPING, *ALIASES)
    if engines is not None:
        given = [str(e) for e in engines]
        for name in given:
            if name not in known:
                raise UsageError(
                    f"there is no engine {name!r}",
                    code="HB-A401",
                    where="engines",
                    hint=did_you_mean(name, known) or ", ".join(known),
                )
        if len(given) != 2 or given[0] == given[1]:
            raise UsageError(
                f"engines = {', '.join(given) or 'none'}: a cross-check needs two different ones",
                code="HB-A401",
                where="engines",
                hint='such as "rk45,moreau-jean"',
            )
        return (given[0], given[1]), "as given"
    own = str(graph.experiment.get("solver", "auto"))
    laws = any(m.law is not None for m in graph.machines)
    other = "moreau-jean" if laws else "radau"
    if own == other:
        return (own, "rk45"), f"{own} is the model's own, so that rk45 is the other"
    if laws:
        return (own, other), "junctions have laws, which time-stepping solves in another way"
    return (own, other), "no junction has a law; radau is implicit, and takes other steps"


def _values(
    refined: str,
    graph: FlatGraph,
    until: float | str | None,
    step: float | str | None,
    rtol: float | None,
    levels: int,
) -> list[float]:
    """Return the steps or tolerances, from coarse to fine, a few more than `levels`."""
    if refined == "rtol":
        last = float(rtol if rtol is not None else graph.experiment.get("rtol", RTOL))
        values = [last * 100.0**k for k in range(levels - 1, -1, -1)]
        return [min(v, 1e-2) for v in values]
    given = step if step is not None else graph.experiment.get("step")
    if given is None:
        h = end_of(until, graph.experiment) / STEPS
    else:
        h = seconds(given, "step")
    return [h / 2.0**k for k in range(levels + MORE)]
