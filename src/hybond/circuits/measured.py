"""Measurements of a run: means, extremes and instants that ``.meas`` asks for."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hybond.circuits.formulas import evaluate
from hybond.measures.averages import integral_of, mean_of, rms_of
from hybond.measures.crossings import Edge, crossings_of
from hybond.measures.extremes import extreme_of, range_of
from hybond.measures.window import Window
from hybond.model.expressions import Expr
from hybond.result import Result

Time = float | Expr
"""A time, s; an expression of parameters where it follows them."""


@dataclass(frozen=True, slots=True)
class Moment:
    """A time, or a crossing of zero of a signal."""

    signal: str
    edge: str
    count: int
    after: Time
    at: Time
    since: Time = -math.inf
    """Crossings before this time do not count, either."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """A measurement in terms of a model.

    Parameters
    ----------
    name, kind : str
        As written.
    signal : str
        Of the model, without a unit; empty if none is measured.
    begin, end : float or Expr
        The stretch of time, s; infinite ends are those of the run.
    when, until : Moment or None
    formula : Expr or None
        Of measurements before it and of `constants`.
    constants : tuple
        Parameters of the netlist: how it calls them, how the model does, what they are there.
    """

    name: str
    kind: str
    signal: str = ""
    begin: Time = -math.inf
    end: Time = math.inf
    when: Moment | None = None
    until: Moment | None = None
    formula: Expr | None = None
    constants: tuple[tuple[str, str, float], ...] = ()

    @property
    def signals(self) -> tuple[str, ...]:
        """The signals of the model that it reads."""
        read = (self.signal, *(i.signal for i in (self.when, self.until) if i is not None))
        return tuple(name for name in read if name)

    def known(self, run: Result) -> dict[str, float]:
        """Return what parameters of the netlist are in a run."""
        here = run.graph.parameters
        return {name: here.get(path, value) for name, path, value in self.constants}


def measure(run: Result, wanted: Sequence[Wanted]) -> dict[str, float | None]:
    r"""Return measurements of a run; None where there is nothing to measure.

    Parameters
    ----------
    run : Result
        Of the model of a conversion.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import hybond as hb
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "rc.cir")
    ...     _ = path.write_text(
    ...         "RC\nV1 a 0 1\nR1 a b 1k\nC1 b 0 1u IC=0\n.tran 1u 5m uic\n"
    ...         ".meas tran t50 WHEN v(b)=0.5\n.end\n")
    ...     rc = hb.read_circuit(path)
    >>> round(measure(hb.simulate(rc.model), rc.measures)["t50"], 9)
    0.000693147
    """
    found: dict[str, float | None] = {}
    for one in wanted:
        found[one.name] = _one(run, one, found)
    return found


def _one(run: Result, one: Wanted, known: Mapping[str, float | None]) -> float | None:
    own = one.known(run)
    if one.formula is not None:
        values = {**own, **{k: v for k, v in known.items() if v is not None}}
        try:
            return evaluate(one.formula, values)
        except (KeyError, ArithmeticError, ValueError):
            return None
    if one.when is not None:
        first = _instant(run, one.when, own)
        if one.kind == "when" or first is None:
            return first
        if one.until is not None:
            second = _instant(run, one.until, own)
            return None if second is None else second - first
        if not run.t_begin <= first <= run.t_end:
            return None
        return (
            _slope(run, one.signal, first) if one.kind == "deriv" else _at(run, one.signal, first)
        )
    begin = max(_time(one.begin, own), run.t_begin)
    end = min(_time(one.end, own), run.t_end)
    if end <= begin:
        return None
    return _over(run, one, Window(begin, end, begin == run.t_begin))


def _over(run: Result, one: Wanted, window: Window) -> float | None:
    """Return a measurement over a window.

    Integrals have the areas of impulses; where an impulse has no measurement, as a netlist has no
    impulses, what is beside it is measured.
    """
    match one.kind:
        case "avg":
            return float(mean_of(run, one.signal, window))
        case "integ":
            return float(integral_of(run, one.signal, window))
        case "rms":
            return float(rms_of(run, one.signal, window, impulses="leave out"))
        case "pp":
            return float(range_of(run, one.signal, window, impulses="leave out"))
    sign = -1.0 if one.kind.startswith("min") else 1.0
    found = extreme_of(run, one.signal, window, sign, impulses="leave out")
    return found.t if one.kind.endswith("_at") else float(found)


def _at(run: Result, signal: str, t: float) -> float:
    return float(run[signal].at(t))


def _time(given: Time, known: Mapping[str, float]) -> float:
    return given if isinstance(given, float) else evaluate(given, known)


def _instant(run: Result, instant: Moment, known: Mapping[str, float]) -> float | None:
    """Return the time of an instant, None if the run has no such one."""
    if not instant.signal:
        return _time(instant.at, known)
    begin = max(_time(instant.after, known), _time(instant.since, known), run.t_begin)
    if not begin < run.t_end:
        return None
    # what happens at its begin belongs to it
    window = Window(begin, run.t_end, True)
    edge: Edge = "rise" if instant.edge == "rise" else "fall" if instant.edge == "fall" else "both"
    found = crossings_of(run, instant.signal, 0.0, window, edge=edge)
    if len(found) < max(instant.count, 1):
        return None
    return found[int(instant.count - 1)].t


def _slope(run: Result, signal: str, t: float) -> float:
    """Return the slope by central differences within the run."""
    h = 1e-5 * (run.t_end - run.t_begin)
    low, high = max(run.t_begin, t - h), min(run.t_end, t + h)
    return (_at(run, signal, high) - _at(run, signal, low)) / (high - low)
