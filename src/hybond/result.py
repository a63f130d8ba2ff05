"""`Result`: what a run gives back, made for discontinuities, read by name."""

from __future__ import annotations

import bisect
from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from hybond.engine.outcome.audit import Audit, audit
from hybond.engine.outcome.signals import Signals
from hybond.engine.outcome.states_at import at_ends, state_at
from hybond.errors import HybondError, UsageError
from hybond.measures.measuring import Measuring
from hybond.measures.naming import names_of, read_name
from hybond.measures.overlaps import told_of_overlaps
from hybond.measures.signal import Signal
from hybond.measures.undefined import told_of_undefined
from hybond.measures.window import instant_near
from hybond.model.expressions import Expr
from hybond.model.graph import FlatGraph
from hybond.model.unit_words import unit_of
from hybond.names import html_lines, html_table, plural
from hybond.options import seconds
from hybond.report import EventTable
from hybond.runs.states import State
from hybond.runs.trace import Accumulation, Segment, Sliding, Trace, Turn
from hybond.tabled import Tabled
from hybond.units import format_quantity

Vector = NDArray[np.float64]
Status = Literal["ok", "interrupted", "accumulation", "unsound", "error", "running"]
Side = Literal["left", "right"]

ROWS = 20
"""Values that a notebook shows of the end of a run."""
POINTS = 200
"""Points per run that flat views add between accepted steps, spread over its segments."""
FEW = 64
"""Times that are looked for one by one: an array to look for them in takes longer."""


def _times(t: object) -> Vector:
    """Return times as they were given, s; HB-S110 for what is none."""
    given = t if isinstance(t, np.ndarray) else np.asarray(t, dtype=object).reshape(-1)
    try:
        if given.dtype == object:
            given = np.array([seconds(x, "t") if isinstance(x, str) else x for x in given])
        return np.asarray(given, dtype=float).reshape(-1)
    except (TypeError, ValueError, UsageError):
        raise UsageError(
            f"{t!r} are no times",
            code="HB-S110",
            where="t",
            hint='write 0.5, "500 ms" or [0.0, 0.5]',
        ) from None


def _segments_of(starts: Sequence[float], t: Vector, side: Side) -> NDArray[np.intp]:
    """Return in which segments times lie, by the times these begin at."""
    if len(t) > FEW:
        return np.maximum(np.searchsorted(np.asarray(starts), t, side) - 1, 0)
    before = bisect.bisect_right if side == "right" else bisect.bisect_left
    return np.array([max(before(starts, a) - 1, 0) for a in t.tolist()], dtype=np.intp)


class Result(Measuring, Tabled):
    """A run: segments of motion, events between them, signals by name.

    Attributes
    ----------
    status : {"ok", "interrupted", "accumulation", "unsound", "error", "running"}
    error : HybondError or None
    events : EventTable
        Prints as the table of what happened and why.
    segments : sequence of Segment
    stats : dict
        Steps, events, evaluations, modes built (``propagated``: those that were propagated
        exactly).
    engine : str
        What made the run: the library, or the engine as Python and why.
    method : str
        With solver ``"auto"`` or ``"exact"``: how many modes were propagated exactly, why not more,
        and from when on others were left to ``"radau"``.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> run = hb.simulate(m, until="1 s")
    >>> run["c.q"].unit, run.status
    ('C', 'ok')
    >>> sorted(run.final)
    ['c.e', 'c.q']
    """

    marks: tuple[tuple[float, str], ...] = ()
    """When steps of a script begin, s, and their labels."""

    def __init__(
        self,
        graph: FlatGraph,
        trace: Trace,
        status: Status,
        until: float,
        solver: str,
        error: HybondError | None,
    ) -> None:
        self.graph = graph
        self.trace = trace
        self.status: Status = status
        self.until = until
        self.solver = solver
        self.error = error
        self.segments: Sequence[Segment] = trace.segments
        self.events = EventTable(self.graph, trace.events)
        self.stats: dict[str, float] = dict(trace.stats)
        self.engine = trace.engine
        self.method = trace.method
        self._expressions: dict[str, Expr] = {}
        self._end: tuple[tuple[int, float, int], dict[str, float]] | None = None

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What was noted, which contacts begin overlapping, which signals lack values at times."""
        try:
            more = (*told_of_overlaps(self), *told_of_undefined(self))
        except HybondError:  # a run that stopped may have no values to tell
            more = ()
        return (*self.trace.warnings, *more)

    # -- names

    @property
    def title(self) -> str:
        """The model's title, or its name."""
        return self.graph.title or self.graph.name

    @property
    def t_begin(self) -> float:
        """From when on the run was kept, s: its start unless it was told to keep less."""
        return self.trace.segments.times[0] if self.segments else self.trace.begin

    @property
    def t_end(self) -> float:
        """The time reached, s."""
        return float(self.segments[-1].t[-1]) if self.segments else self.trace.begin

    @property
    def ended_by(self) -> str:
        """What ended the run: a condition as written, ``"time"``, or its status if it stopped."""
        return self.trace.ended_by or ("time" if self.status == "ok" else self.status)

    def state(self, t: float | str | None = None) -> State:
        """Return the state at a time, s or a quantity, or at the end: a run can start from it.

        A time that is one instant with an event is the event's: what happened there is over.

        Raises
        ------
        UsageError
            HB-S110 for a time outside the run.

        Examples
        --------
        >>> import hybond as hb
        >>> run = hb.simulate(hb.load("examples/bouncing_ball.toml"))
        >>> print(run.state("0.5 s"))
        bouncing_ball at t = 0.5 s
          ball.p  -4.905 N·s
          pad.q   0 m
          height  1.77375 m
          floor   away
        """
        asked = None if t is None else seconds(t, "t")
        if asked is not None and self.t_begin <= asked <= self.t_end:
            asked = instant_near(self, asked)
        return state_at(self.graph, self.trace, self.signals, asked)

    @property
    def accumulations(self) -> tuple[Accumulation, ...]:
        """Where impacts accumulated and came to rest, or events accumulated and the run stopped."""
        return tuple(self.trace.accumulations)

    @property
    def sliding(self) -> tuple[Sliding, ...]:
        """Intervals of motion along switching surfaces, in order."""
        return tuple(self.trace.slidings)

    @property
    def turns(self) -> tuple[Turn, ...]:
        """With solver ``"auto"``: when it went over to ``"radau"``, or back, in order."""
        return tuple(self.trace.turns)

    def weight(self, machine: str, state: str, t: float, *, side: Side = "right") -> float:
        """Return the part of the time that a machine spends in a state at `t`.

        0 or 1; while it slides something between.

        Raises
        ------
        UsageError
            HB-S110 for a time outside the run.
        ModelError
            HB-M144 for a machine or state that does not exist.
        """
        wanted = self.graph.mode_of({machine: state})
        self.sample([t], [], side=side)
        segment = self.segments[self._segment_at(t, side)]
        index = next(m.index for m in self.graph.machines if m.path == machine)
        if segment.bonds is not None:
            return float(segment.mode[index] == wanted[index])
        return self.signals.weight(segment, t, index, wanted[index])

    @property
    def names(self) -> list[str]:
        """Stored quantities, co-energy variables, signals and listed outputs."""
        return names_of(self.graph)

    def expression(self, name: str) -> Expr:
        """Return a name, or any expression of names, in canonical names.

        Raises
        ------
        UsageError
            HB-S109 with the nearest names.
        """
        if name not in self._expressions:
            self._expressions[name] = read_name(self.graph, name)
        return self._expressions[name]

    def unit(self, name: str) -> str:
        """Return the SI unit of a signal, empty if it has none or is not known."""
        return unit_of(self.expression(name), self.graph)

    def __getitem__(self, name: str) -> Signal:
        """Return a signal by name, or an expression of names; HB-S109 if there is none."""
        return Signal(name, self.unit(name), self)

    # -- values

    def pieces(
        self, name: str, *, points_per_segment: int | None = None
    ) -> list[tuple[Vector, Vector]]:
        """Return (t, y) of each segment: its accepted points and evenly spaced ones between."""
        span = max(self.t_end - self.t_begin, 1e-300)
        asked = []
        for segment in self.segments:
            count = points_per_segment
            if count is None:
                count = int(POINTS * (segment.t[-1] - segment.t[0]) / span)
            if count == 0 and len(segment.t) == 2 and segment.t[1] > segment.t[0]:
                asked.append(segment.t)  # the common case of fast switching
                continue
            even = np.linspace(segment.t[0], segment.t[-1], count + 2)
            t = np.sort(np.concatenate([segment.t, even]))
            t = t[np.append(True, t[1:] > t[:-1])]
            asked.append(t)
        return [(t, read[0]) for t, read in zip(asked, self._of_all([name], asked), strict=True)]

    @cached_property
    def signals(self) -> Signals:
        """What tells the signals of the run at times of its segments."""
        assert isinstance(self.trace.signals, Signals)
        return self.trace.signals

    def signals_of(self, number: int) -> Signals:
        """Return what tells the signals of a segment, by its number."""
        return self.signals

    def expression_of(self, number: int, name: str) -> Expr:
        """Return an expression of names as it is in a segment, by its number."""
        return self.expression(name)

    def changes(self) -> list[tuple[float, Signals, Signals, Vector]]:
        """Return when parameters were set, what tells signals before and after, and the state."""
        return []

    def _of(
        self, names: Iterable[str | Expr], which: Sequence[int] | NDArray[np.intp], t: Vector
    ) -> list[Vector]:
        """Return signals, by name or expression, at points of segments in order of their numbers.

        Expressions are in canonical names.
        """
        expressions = [self.expression(n) if isinstance(n, str) else n for n in names]
        if not len(t):
            return [np.zeros(0) for _ in expressions]
        segments = np.asarray(which, dtype=np.intp)
        return self.signals.of_points(self.trace.segments, segments, t, expressions)

    def _of_all(self, names: Iterable[str], times: Sequence[Vector]) -> list[list[Vector]]:
        """Return signals by name at times of each segment."""
        if not times:
            return []
        many = [len(t) for t in times]
        which = np.repeat(np.arange(len(times)), many)
        found = self._of(names, which, np.concatenate(times) if times else np.zeros(0))
        cuts = np.cumsum(many)[:-1]
        return [list(read) for read in zip(*(np.split(v, cuts) for v in found), strict=True)]

    def sample(
        self,
        t: float | str | Sequence[float | str],
        names: Sequence[str],
        *,
        side: Side = "right",
    ) -> dict[str, Vector]:
        """Return ``{name: values}`` at the times `t`; at events the limit of that `side`.

        Times are numbers, s, or quantities; one name may stand for a list of one.

        Raises
        ------
        UsageError
            HB-S110 for a time outside the run, or a side that is none.
        """
        if side not in ("left", "right"):
            raise UsageError(f"side = {side!r}", code="HB-S110", where="side", hint="left or right")
        begin, end = self.t_begin, self.t_end
        at = at_ends(_times(t), begin, end)
        names = (names,) if isinstance(names, str) else names
        found = {name: np.full(len(at), np.nan) for name in names}
        starts = self.trace.segments.times
        cut = side == "left" and bool(self.trace.segments.forgotten)
        if not starts and self.trace.events and len(at) and (at == begin).all():
            # a condition that held at the start: nothing moved
            for name, value in zip(names, self._after_last_event(names), strict=True):
                found[name][:] = value
            return found
        outside = ~((begin <= at) & (at <= end)) | (cut & (at == begin))
        if len(at) and (outside.any() or not starts):
            if not starts and begin == end:
                why = f"the run was refused at {begin:.9g} s, before it had values"
                raise UsageError(why, code="HB-S110", where="t", hint="see why it was refused")
            raise UsageError(
                f"the run goes from {begin:.9g} to {end:.9g} s, not to {at[outside.argmax()]:g} s",
                code="HB-S110",
                where="t",
                hint="ask for a time within it",
            )
        which = _segments_of(starts, at, side)
        places = np.lexsort((at, which))
        read = self._of(names, which[places], at[places])
        for name, values in zip(names, read, strict=True):
            found[name][places] = values
        last = self.segments[-1] if self.segments else None
        at_end = np.flatnonzero(at == end)
        if side == "right" and last is not None and len(at_end) and self._settled_at_end:
            # an event at the very end: its right limit starts no segment
            for name, value in zip(names, self._after_last_event(names), strict=True):
                found[name][at_end] = value
        return found

    def at_one_model(self, t: float) -> Result:
        """Return the run of one model in which a time lies, after all that happened there."""
        return self

    def _segment_at(self, t: float, side: Side) -> int:
        return int(_segments_of(self.trace.segments.times, np.array([t]), side)[0])

    @property
    def _settled_at_end(self) -> bool:
        events = self.trace.events
        # the time first: the record of the event may have to be made
        if not events or events.times[-1] != self.t_end or not self.t_end > self.trace.begin:
            return False
        return events[-1].cause != "step"

    @property
    def _jumps_at_end(self) -> bool:
        """Whether at the last instant a machine changes its state, or an impulse acts."""
        if not self.segments or not self._settled_at_end:
            return False
        return any(step.fired or step.impulses for step in self.trace.events[-1].steps)

    def _after_last_event(self, names: Sequence[str | Expr]) -> list[float]:
        event = self.trace.events[-1]
        expressions = [self.expression(n) if isinstance(n, str) else n for n in names]
        found = self.signals.after(event.t, event.after, event.steps[-1].mode, expressions)
        return [float(value) for value in found]

    @property
    def mode(self) -> dict[str, str]:
        """The state of each machine at the end."""
        if self.trace.events:
            return self.graph.mode_names(self.trace.events[-1].steps[-1].mode)
        return self.graph.mode_names(self.graph.start_mode)

    @property
    def final(self) -> dict[str, float]:
        """Stored quantities, co-energy variables, signals and listed outputs at the end."""
        # asked for name by name in loops: read once, and once more if the run went on meanwhile
        at = (len(self.segments), self.t_end, len(self.events))
        if self._end is None or self._end[0] != at:
            self._end = (at, self._read_end())
        return dict(self._end[1])

    def _read_end(self) -> dict[str, float]:
        if not self.segments:
            names = self.names if self.trace.events else []
            return dict(zip(names, self._after_last_event(names), strict=True)) if names else {}
        values = self.sample([self.t_end], self.names)
        return {name: float(v[0]) for name, v in values.items()}

    def explain(self, t: float | None = None) -> str:
        """Return why the modes changed: the events, or the one nearest to `t`."""
        if t is None or not len(self.events):
            return str(self.events)
        times = self.trace.events.times
        nearest = min(range(len(times)), key=lambda k: abs(times[k] - t))
        return str(EventTable(self.graph, (self.events[nearest],)))

    def energies(self, segment: Segment) -> Vector:
        """Return energy supplied by sources and dissipated by resistors within a segment.

        Parameters
        ----------
        segment : Segment

        Returns
        -------
        array, shape (points, 2)
            J, from where the segment begins up to each of its accepted points.

        Examples
        --------
        >>> import hybond as hb
        >>> m = hb.Model("rc", domain="electrical")
        >>> m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
        >>> m.bond("node -> c", "node -> r")
        >>> run = hb.simulate(m, until="20 s")
        >>> run.energies(run.segments[0])[-1].round(9).tolist()
        [0.0, 0.05]
        """
        return self.signals.energies(segment)

    def audit(self) -> Audit:
        """Return the worst imbalance of power and energy over the run."""
        return audit(self.graph, self.trace, self.signals)

    def plot(self, *names: str, path: str | None = None) -> Any:
        """Plot signals over time with a strip of modes; jumps as jumps, impulses as arrows."""
        from hybond.draw.plots import plot_run

        for name in names:
            if not isinstance(name, str):
                raise UsageError(
                    f"{name!r} is no signal",
                    code="HB-S109",
                    where="signals",
                    hint="write names one after another: run.plot('a.e', 'b.f')",
                )
        chosen = names or tuple(self.graph.experiment.get("plot", ())) or tuple(self.names[:3])
        return plot_run(self, chosen, path=path)

    def _repr_html_(self) -> str:
        rows = [
            (name, format_quantity(value, self.unit(name) or "1"))
            for name, value in self._at_end().items()
        ]
        said = [repr(self)[1:-1], *(f"warning: {w}" for w in self.warnings)]
        said += [str(self.error)] if self.error is not None else []
        return html_lines(said) + html_table(rows, ("at the end", ""))

    def _at_end(self) -> dict[str, float]:
        try:
            return dict(list(self.final.items())[:ROWS])
        except HybondError:
            return {}

    def __repr__(self) -> str:
        return (
            f"<Result {self.title!r}: {self.status}, t = {self.t_end:g} s, "
            f"{len(self.events)} {plural('event', len(self.events))}>"
        )
