"""`reachable`: the modes that can follow each other, and whether time always goes on.

Source: P. J. Mosterman and G. Biswas, *A hybrid modeling and simulation methodology for dynamic
physical systems*, SIMULATION 78(1), 2002, section 4.1.3: since what is stored does not change while
modes are tried, a model can be verified by the sets of states that its modes leave.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.modes.asked import Asked
from hybond.analysis.modes.exact import Cells
from hybond.analysis.modes.held import Held, held, without_rules
from hybond.analysis.modes.records import Gap, ModeGraph, Verdict
from hybond.analysis.modes.samples import Samples
from hybond.analysis.modes.steps import Met, name_of
from hybond.calls import called
from hybond.causality.reachable import reachable as by_structure
from hybond.errors import DivergenceOfTime, HybondError, UsageError
from hybond.model.builder import Model, graph_of
from hybond.model.expressions import And, Compare, Expr, Not, Or
from hybond.model.graph import FlatGraph, Mode
from hybond.result import Result
from hybond.simulation import simulate

Vector = NDArray[np.float64]

MODES = 200
"""Modes whose states are looked at."""
PROGRAMS = 4000
"""Linear programs solved: about ten seconds."""
SAMPLES = 100
"""States sampled per mode."""
EDGES = 200
"""Edges up to which those are told that are not seen and not excluded."""
EVENTS = 20_000
"""Events of the run."""
POINTS = 5
"""States of one segment of the run that are taken."""
SEGMENTS = 500


@called('hb.reachable(model, where=["c.e < 100"], until="1 s")')
def reachable(
    model: Model | FlatGraph,
    *,
    where: Sequence[str] | str = (),
    until: float | str | None = None,
    samples: int = SAMPLES,
    limit: int = MODES,
    programs: int = PROGRAMS,
) -> ModeGraph:
    """Return the modes that can follow each other, and whether time goes on from all states.

    Where guards and laws are affine in what is stored, all states of each mode are looked at:
    instants are settled as a run settles them, with polyhedra in place of states. Else states are
    sampled, those of a run among them. Time and inputs may have any value.

    Parameters
    ----------
    model : Model or FlatGraph
    where : sequence of str
        Conditions that states are known to meet whenever time goes on, such as ``"pad.q >= 0"``.
        Nobody checks them.
    until : float or str
        How long the run lasts that says what is seen; default: as the experiment says. 0 for none.
    samples : int
        States per mode where these are sampled.
    limit : int
        Modes whose states are looked at.
    programs : int
        Linear programs that are solved at most. What limits leave out is told.

    Returns
    -------
    ModeGraph

    Raises
    ------
    UsageError
        HB-A601 for a `where` that is no condition, or limits that are none.

    Examples
    --------
    A relay whose band is turned inside out: between 1 V and 2 V no state of it holds.

    >>> import hybond as hb
    >>> m = hb.Model("relay")
    >>> m.add(c=hb.C(1), n=hb.Zero(), f=hb.Sf(0), s=hb.One(), r=hb.R(1))
    >>> m.bond("f -> n -> c", "n -> s -> r")
    >>> m.machine("m", states={"off": [], "on": ["s"]}, start="off",
    ...           rules=["off -> on when c.e > 1", "on -> off when c.e < 2"])
    >>> found = hb.reachable(m, until=0)
    >>> found.time, str(found.gaps[0]), found.gaps[0].confirmed
    ('possible', '1 < c.q < 2', True)
    >>> hb.reachable(m, until=0, where="c.q > 2").time
    'proved'
    """
    graph = graph_of(model)
    for name, value in (("samples", samples), ("limit", limit), ("programs", programs)):
        if not isinstance(value, int) or isinstance(value, bool) or value < (name != "samples"):
            raise UsageError(
                f"{name} = {value!r} is no number of them",
                code="HB-A601",
                where=name,
                hint=f"a whole number, {name}=100",
            )
    texts = (where,) if isinstance(where, str) else tuple(where)
    made = held(graph, [_condition(graph, text) for text in texts])
    met = Met(graph)
    met.mode(graph.start_mode, "start")
    run = None if until in (0, "0") else _run(graph, until)
    pool = _pool(graph, made, run)
    scale = _scale(made, pool)
    own = Asked(graph)
    first = _start(own, met, run)
    left_out: list[str] = []
    undecided: list[str] = []
    exact = all(m.law is None for m in graph.machines)
    if exact:
        cells = Cells(made, scale, met, limit, programs)
        cells.explore(first)
        left_out += cells.left_out
        undecided = list(dict.fromkeys(cells.open.values()))
        exact = not undecided and not left_out
    else:
        undecided = ["junctions with laws of their own decide by complementarity"]
    if not exact:
        laws = any(m.law is not None for m in graph.machines)
        sampled = Samples(
            own if laws else Asked(made.graph),
            Asked(without_rules(graph if laws else made.graph).graph),
            _names(graph) if laws else made.names,
            scale[: len(_names(graph))] if laws else scale,
            _pool(graph, None, run) if laws else pool,
            met,
            samples,
            limit,
        )
        sampled.explore([*first, *met.kinds])
        met.not_excluded(EDGES)
        left_out += sampled.left_out
    time, why = _verdict(met.gaps, undecided, exact=exact)
    unreachable = met.unreachable()
    if not exact:
        structure = by_structure(graph, limit=limit)
        unreachable = _never_in(graph, structure.modes) if structure.complete else ()
    return ModeGraph(
        title=graph.title or graph.name,
        start=name_of(graph, graph.start_mode),
        nodes=met.nodes(),
        edges=tuple(met.edges.values()),
        transitions=met.transitions(whole=exact),
        unreachable=unreachable,
        gaps=tuple(met.gaps),
        time=time,
        why=why,
        exact=exact,
        where=texts,
        left_out=tuple(left_out),
    )


def _condition(graph: FlatGraph, text: str) -> Expr:
    assert graph.read is not None
    e = graph.read(text)
    if not isinstance(e, Compare | And | Or | Not):
        raise UsageError(
            f"{text!r} is no condition",
            code="HB-A601",
            where="where",
            hint='compare something, as in where=["ball.p < 10"]',
        )
    return e


def _run(graph: FlatGraph, until: float | str | None) -> Result | None:
    """Run the experiment; None where nothing says how long."""
    if until is None and "until" not in graph.experiment:
        return None
    return simulate(graph, until, on_error="return", max_events=EVENTS)


def _names(graph: FlatGraph) -> tuple[str, ...]:
    return tuple([*(s.path for s in graph.storages), *(i.path for i in graph.integrals)])


def _pool(graph: FlatGraph, made: Held | None, run: Result | None) -> dict[Mode, list[Vector]]:
    """Return states of a run by mode: where it was, and where it was before each event."""
    found: dict[Mode, list[Vector]] = {}
    if run is None:
        return found
    many = len(graph.storages) + len(graph.integrals)

    def put(mode: Mode, y: Vector, t: float) -> None:
        more = made.surroundings(graph, t) if made is not None else []
        found.setdefault(mode, []).append(np.append(y[:many], more))

    for segment in islice(run.trace.segments, SEGMENTS):
        places = np.linspace(0, len(segment.t) - 1, POINTS).astype(int)
        for k in dict.fromkeys([int(places[-1]), *places.tolist()]):
            put(segment.mode, segment.y[k], float(segment.t[k]))
    return found


def _scale(made: Held, pool: dict[Mode, list[Vector]]) -> Vector:
    """Return a usual size of each state: in the run, or of one unit of co-energy."""
    seen = np.zeros(len(made.names))
    for rows in pool.values():
        seen = np.maximum(seen, np.max(np.abs(rows), axis=0))
    unit = np.ones(len(made.names))
    for s in made.graph.storages:
        law = made.graph.nodes[s.node].law
        if law is not None and law.matrix is not None and law.matrix[s.port][s.port] != 0.0:
            unit[s.index] = 1.0 / abs(law.matrix[s.port][s.port])
        seen[s.index] = max(seen[s.index], abs(s.start) if s.start_is == "stored" else 0.0)
    return np.where(seen > 0.0, seen, unit)


def _start(own: Asked, met: Met, run: Result | None) -> list[Mode]:
    """Note the start and what the run saw; return the modes in which time went on."""
    graph = own.graph
    begin = graph.start_mode
    first: list[Mode] = []
    got = own.settled(own.apart.start, begin)
    if not isinstance(got, HybondError):
        first.append(own.note(met, got, begin, "seen"))
    else:
        names = _names(graph)
        text = name_of(graph, begin)
        cycle = isinstance(got, DivergenceOfTime)
        named = {n: float(v) for n, v in zip(names, own.apart.start, strict=True)}
        modes = (text,)
        stops = own.stops(own.apart.start, begin)
        why = got.why if cycle else f"{got.code}: {got.why}"
        met.gaps.append(Gap(text, (), modes, why, cycle, named, stops))
        first.append(begin)
    if run is not None:
        before = begin
        for event in run.trace.events:
            before = own.note(met, event, before, "seen")
            first.append(before)
        for segment in islice(run.trace.segments, SEGMENTS):
            met.mode(segment.mode, "continuous")
            first.append(segment.mode)
    return list(dict.fromkeys(first))


def _verdict(gaps: Sequence[Gap], undecided: Sequence[str], *, exact: bool) -> tuple[Verdict, str]:
    sure = [g for g in gaps if g.confirmed]
    if sure:
        gap = next((g for g in sure if g.cycle), sure[0])
        return "possible", f"from ({gap.begin}) where {gap}"
    if gaps:
        return "not decided", "no run confirms the states from which no mode was found"
    if exact:
        return "proved", ""
    return "not decided", "; ".join(undecided) or "not all was looked at"


def _never_in(graph: FlatGraph, modes: Sequence[Mode]) -> tuple[str, ...]:
    return tuple(
        f"{m.path}.{state}"
        for m in graph.machines
        if m.law is None
        for k, state in enumerate(m.states)
        if not any(mode[m.index] == k for mode in modes)
    )
