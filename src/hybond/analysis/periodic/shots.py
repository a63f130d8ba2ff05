"""A shot: one period run from a state, where it ends, and how the end follows the start.

What does not change from shot to shot is made once: the graph with slots for what is varied, the
equations of variation of each mode, the tables that the engine reads. Another value of a parameter
is a number written into them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.linear.periods import WHOLE, repeats_from, trees
from hybond.analysis.periodic.lost import lost_directions
from hybond.analysis.periodic.multipliers import CIRCLE, Multiplier, multipliers, spanned
from hybond.analysis.periodic.resting import resting, shut
from hybond.analysis.periodic.still import takes_nothing
from hybond.analysis.sensitivity.along import chain_of
from hybond.analysis.sensitivity.chain import Chain
from hybond.analysis.sensitivity.fields import Field, Fields
from hybond.analysis.sensitivity.opened import Opened
from hybond.analysis.sensitivity.sensitivities import check_followed
from hybond.analysis.sensitivity.tangent import Undetermined
from hybond.analysis.sensitivity.values import Values
from hybond.analysis.sensitivity.wanted import Wanted, slotted
from hybond.errors import HybondError, NumericsError
from hybond.model.expressions import names
from hybond.model.graph import FlatGraph, Mode
from hybond.model.kept import kept_graph
from hybond.result import Result
from hybond.runs.states import State
from hybond.simulation import simulate

Vector = NDArray[np.float64]

NEAR = 0.01
"""Part of a period within which a switch is near its end."""


Shown: TypeAlias = Callable[[int, float, int], object]
"""What is called with how far a run is: its number, the part of it that is done, its events."""


@dataclass(frozen=True, slots=True, eq=False)
class Shot:
    """One period, run from a state.

    Parameters
    ----------
    x, mode
        Where it begins: what is stored and integrated, and the mode that is settled there.
    T : float
        How long it is, s.
    run : Result
    end : array, shape (n,)
    end_mode : Mode
    M : array, shape (n, n), or None
        How the end follows the start; None where it has no derivative.
    by : array, shape (n, wrt)
        How the end follows parameters, also by the length of the period.
    first, last : array, shape (n,)
        Rates at both ends.
    why : str
        Why there is no derivative.
    chain : Chain or None
    """

    x: Vector
    mode: Mode
    T: float
    run: Result = field(repr=False)
    end: Vector
    end_mode: Mode
    M: Vector | None = None
    by: Vector | None = None
    first: Vector | None = None
    last: Vector | None = None
    why: str = ""
    chain: Chain | None = field(default=None, repr=False)

    @property
    def path(self) -> tuple[tuple[str, tuple[Mode, ...]], ...]:
        """The switches of the period, in order: cause, and the modes from before to after."""
        segments = self.run.segments
        begin = tuple(segments[0].mode) if len(segments) else self.mode
        found = []
        for event in self.run.events:
            if event.cause == "start":
                continue
            written = [tuple(step.mode) for step in event.steps if step.kind != "mythical"]
            found.append((str(event.cause), (begin, *written)))
            begin = written[-1]
        return tuple(found)


class Shots:
    """What all shots have in common.

    Parameters
    ----------
    opened : Opened
        The model; what is varied are parameters of it.
    options : mapping
        Of `simulate`: its method.
    progress : callable, optional
        ``progress(run, part, events)``, as for `hybond.periodic`.

    Attributes
    ----------
    read : list of int
        States that something reads.
    done : int
        Runs so far.
    time : float
        Time that was run, all together, s.
    t0 : float
        When periods begin, s: the phase of what drives the motion.
    settled : float
        Before this time nobody says that anything repeats, s.
    """

    def __init__(
        self, opened: Opened, options: Mapping[str, Any], progress: Shown | None = None
    ) -> None:
        self.opened, self.options = opened, dict(options)
        self.progress = progress
        self.wanted = slotted(opened, {}) if opened.paths else _nothing(opened)
        check_followed(self.wanted.graph)
        self.graph: FlatGraph = self.wanted.plain
        self.values = self.wanted.values
        self.states = [s.path for s in self.graph.storages]
        self.names = [*self.states, *(i.path for i in self.graph.integrals)]
        self.read = read_states(self.graph)
        self.done, self.time, self.t0, self.settled = 0, 0.0, 0.0, 0.0
        self._fields: Fields | None = None

    def at(self, values: Sequence[float]) -> None:
        """Go over to other values of what is varied."""
        row = np.asarray(values, dtype=float)
        if np.array_equal(row, self.values):
            return
        given = dict(zip(self.opened.paths, row.tolist(), strict=True))
        self.graph = kept_graph(self.opened.model, {**self.opened.given, **given})
        self.values = row

    def first(self, T: float) -> float:
        """Return when the first whole period begins from which on all repeats, s."""
        return T * math.ceil(max(self.settled, repeats_from(self.graph)) / T - WHOLE)

    def state(self, x: Vector, mode: Mode) -> State:
        """Return a state as a run begins with it."""
        stored = len(self.states)
        return State(
            self.graph.name,
            self.t0,
            dict(zip(self.states, x[:stored].tolist(), strict=True)),
            dict(zip(self.names[stored:], x[stored:].tolist(), strict=True)),
            self.graph.mode_names(mode),
        )

    def run(self, until: float, start: State | None = None) -> Result:
        """Return a run without its derivatives.

        Raises
        ------
        HybondError
            As `simulate`; HB-A540 for one that stops early.
        KeyboardInterrupt
            If it is interrupted.
        """
        self.done += 1
        number, begin = self.done, self.t0 if isinstance(start, State) else 0.0

        def shows(t: float, events: int) -> None:
            assert self.progress is not None
            self.progress(number, min((t - begin) / (until - begin), 1.0), events)

        progress = None if self.progress is None else shows
        run = simulate(self.graph, until, start=start, progress=progress, **self.options)
        if run.status == "interrupted":
            raise KeyboardInterrupt
        self.time += run.t_end - run.trace.begin
        if run.status != "ok":
            error = NumericsError(
                f"a run stops at {run.t_end:.9g} s: {run.status}",
                code="HB-A540",
                where=f"t = {run.t_end:.9g} s",
                hint="look at the run: error.partial",
            )
            error.partial = run
            raise error
        return run

    def shot(
        self, x: Vector, mode: Mode, T: float, T_by: Vector | None = None, *, varied: bool = True
    ) -> Shot:
        """Return a period, run from a state.

        Parameters
        ----------
        T_by : array, shape (wrt,), optional
            How its length follows what is varied.
        varied : bool
            Whether derivatives are wanted.
        """
        run = self.run(self.t0 + T, self.state(x, mode))
        if len(run.events) and run.events[0].steps[-1].mode != mode:
            closed = shut(run, x, mode)
            if closed is not None:
                x, run = closed, self.run(self.t0 + T, self.state(closed, mode))
        end, end_mode = end_of(run)
        begin = run.events[0].steps[-1].mode if len(run.events) else mode
        if not varied:
            return Shot(x, begin, T, run, end, end_mode)
        return self._varied(Shot(x, begin, T, run, end, end_mode), T_by)

    def _varied(self, shot: Shot, T_by: Vector | None) -> Shot:
        run, n, many = shot.run, len(shot.x), len(self.wanted.names)
        begins = np.zeros(many) if T_by is None else self.first(shot.T) / shot.T * T_by
        if self._fields is None:
            self._fields = Fields(Values(run, self.wanted), [])
        fields = self._fields
        fields.values = fields.values.of(run, self.values)
        ends = np.zeros(many) if T_by is None else begins + T_by
        try:
            chain = chain_of(run, fields, resting(run, fields), [], [], ends)
        except (HybondError, Undetermined) as error:
            return replace(shot, why=getattr(error, "why", str(error)))
        shot = replace(shot, chain=chain)
        if chain.ends is not None:
            return replace(shot, why=f"at {chain.ends:.9g} s {chain.why}")
        try:
            whole = chain.forward()[-1]
            first = _rates(fields.within(run.segments[0], run.segments[0].t[:1]))
            last = _rates(_last_field(run, fields))
        except HybondError as error:
            return replace(shot, why=error.why)
        moved = np.outer(last, ends) - whole[:, :n] @ np.outer(first, begins)
        by = (whole[:, n:] + moved) @ self.wanted.follows
        return replace(shot, M=whole[:, :n], by=by, first=first, last=last)

    def multipliers(
        self, shot: Shot, sizes: Vector, kept: list[int], *, own: bool, conserved: int
    ) -> tuple[Multiplier, ...]:
        """Return the multipliers of a period, what each of them is told of the way through it.

        Parameters
        ----------
        sizes : array, shape (n,)
        kept : list of int
            States that come back.
        own : bool
            Whether nothing drives the motion.
        conserved : int
        """
        assert shot.M is not None and shot.chain is not None and self._fields is not None
        fields = self._fields
        fields.values = fields.values.of(shot.run, self.values)
        lost = lost_directions(shot.run, shot.chain, fields, sizes, kept)
        M, unit = shot.M[np.ix_(kept, kept)], sizes[kept]
        found = multipliers(M, unit, phase=own, conserved=conserved, lost=lost)
        on = [k for k, m in enumerate(found) if m.kind in CIRCLE]
        if len(on) < 2:
            return found
        basis = np.zeros((len(shot.x), len(on)))
        basis[kept] = spanned(M, unit, [found[k].value for k in on])
        if takes_nothing(shot.run, shot.chain, fields, basis):
            found = tuple(replace(m, kind="neutral") if m.kind in CIRCLE else m for m in found)
        return found


def near_ends(run: Result, T: float) -> bool:
    """Whether a switch that is not of time alone is near an end of the last period of a run."""
    begin, end = run.t_end - T, run.t_end
    return any(
        event.cause not in ("start", "time", "input")
        and (abs(event.t - begin) < NEAR * T or abs(event.t - end) < NEAR * T)
        for event in run.events
    )


def calm(run: Result, T: float) -> tuple[float, Vector, Mode] | None:
    """Return the middle of the longest motion in the last period of a run: time, state and mode."""
    begin = run.t_end - T
    n = len(run.graph.storages) + len(run.graph.integrals)
    own = [s for s in run.segments if s.sliding is None and not s.landed and s.t[-1] > begin]
    if not own:
        return None
    longest = max(own, key=lambda s: float(s.t[-1] - max(s.t[0], begin)))
    t = 0.5 * float(max(longest.t[0], begin) + longest.t[-1])
    return t, longest.at(t)[:n].copy(), tuple(longest.mode)


def read_states(graph: FlatGraph) -> list[int]:
    """Return the states that something reads: not integrals of which only people want to know."""
    read = frozenset().union(*(names(e) for e, _ in trees(graph)))
    stored = len(graph.storages)
    others = (stored + i.index for i in graph.integrals if f"s:{i.index}" in read)
    return [*range(stored), *others]


def _nothing(opened: Opened) -> Wanted:
    """Return what is varied where nothing is."""
    graph = kept_graph(opened.model, dict(opened.given))
    none = np.zeros(0)
    return Wanted((), (), opened.model, graph, graph, none, (), np.zeros((0, 0)))


def _rates(found: Field) -> Vector:
    return np.asarray(found.f[0])


def _last_field(run: Result, fields: Fields) -> Field:
    """Return the field at the end of a run, after what happens there.

    A law that jumps with time there, as ``mod`` does, has not yet: no event tells of it, and the
    derivatives at the end are those before it (`last_kink`).
    """
    segment, events = run.segments[-1], run.trace.events
    if len(events) and events.times[-1] == segment.t[-1] and segment.t[-1] > segment.t[0]:
        event = events[-1]
        return fields.entered(event.t, np.asarray(event.after), event.steps[-1].mode)
    return fields.ending(segment, None)


def end_of(run: Result) -> tuple[Vector, Mode]:
    """Return the state and the mode at the end of a run, after what happens there."""
    graph = run.graph
    n, many = len(graph.storages) + len(graph.integrals), len(graph.machines)
    if run.trace.carried is not None:
        number, place = run.trace.carried
        return np.array(number[1 : 1 + n]), tuple(int(k) for k in place[:many].tolist())
    state = run.state()
    x = [*state.stored.values(), *state.signals.values()]
    return np.array(x, dtype=float), graph.mode_of(dict(state.machines))
