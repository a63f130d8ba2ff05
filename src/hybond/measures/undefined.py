"""Which recorded signals of a run have no value in parts of it: from when on, until when, and why.

An efficiency while nothing flows is 0/0: what is only recorded may lack a value, and the run is as
right as without it. It is said, so that nobody takes the gap for a result; what a guard or a law
reads is refused where it has no value (HB-N302).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hybond.model.expressions import Binary, Call, Expr, Table
from hybond.model.expressions.kinks import is_partial, may_lack_value
from hybond.model.expressions.tree import walk

if TYPE_CHECKING:
    from hybond.result import Result

PARTS, ROUNDS = 32, 8
"""In how many parts a stretch is divided in which a signal ends to have values, and how often."""

Vector = NDArray[np.float64]


def told_of_undefined(run: Result) -> tuple[str, ...]:
    """Return a warning for each named signal of a run that lacks a finite value somewhere.

    Looked at are the points of the steps and those that plots show between them.

    Parameters
    ----------
    run : Result
        Any run; only signals whose expression may lack a value are read.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> m.signal(above="sqrt(c.e - 5 [V])")
    >>> hb.simulate(m, until="1 s").warnings
    ('signal above has no value from t = 0.693147 s on: it is the root of less than zero',)
    """
    found = []
    for name, expression in run.graph.signals.items():
        if may_lack_value(expression):
            text = _told(run, name)
            if text:
                found.append(text)
    return tuple(found)


def _told(run: Result, name: str) -> str:
    """Return the warning of one signal, empty if it has a value wherever it was looked at."""
    gaps: list[tuple[float, float]] = []
    why = ""
    for number, (t, y) in enumerate(run.pieces(name)):
        bad = ~np.isfinite(y)
        if not bad.any():
            continue
        edges = np.flatnonzero(np.diff(np.concatenate([[False], bad, [False]]).astype(np.int8)))
        for first, beyond in edges.reshape(-1, 2).tolist():
            begin, end = float(t[first]), float(t[beyond - 1])
            if first > 0:
                begin = _border(run, name, number, float(t[first - 1]), begin)
            if beyond < len(t):
                end = _border(run, name, number, float(t[beyond]), end)
            why = why or _why(run, name, number, float(t[first]))
            if gaps and gaps[-1][1] >= begin:
                gaps[-1] = (gaps[-1][0], end)
            else:
                gaps.append((begin, end))
    if not gaps:
        return ""
    return f"signal {name} has no value {_when(gaps, run.t_end)}: {why}"


def _when(gaps: Sequence[tuple[float, float]], last: float) -> str:
    begin, end = gaps[0]
    text = f"from t = {begin:.6g} s to {end:.6g} s"
    if begin == end:
        text = f"at t = {begin:.6g} s"
    elif end >= last:
        text = f"from t = {begin:.6g} s on"
    more = len(gaps) - 1
    return f"{text} and {more} {'times' if more > 1 else 'time'} after that" if more else text


def _border(run: Result, name: str, number: int, good: float, bad: float) -> float:
    """Return where a signal ends to have values between two times, or begins to."""
    for _ in range(ROUNDS):
        t = np.linspace(good, bad, PARTS + 1)
        y = run._of([name], np.full(len(t), number), t if bad > good else t[::-1])[0]
        lacks = ~np.isfinite(y if bad > good else y[::-1])
        lacks[-1] = True
        first = int(np.argmax(lacks))
        if first == 0:
            return good
        good, bad = float(t[first - 1]), float(t[first])
    return bad


def _why(run: Result, name: str, number: int, t: float) -> str:
    """Return why a signal has no value at a time: what it is made of there that has one."""

    def at(e: Expr) -> float:
        return float(run._of([e], [number], np.array([t]))[0][0])

    return _reason(run.expression_of(number, name), at) or "it is not a number"


def _reason(e: Expr, at: Callable[[Expr], float]) -> str:
    """Return why an expression has no value where its parts have one; empty if they lack it too."""
    for part, _ in walk(e):
        if not is_partial(part) or np.isfinite(at(part)):
            continue
        below = _parts(part)
        numbers = [at(p) for p in below]
        if not np.isfinite(numbers).all():
            continue
        match part:
            case Call(function="sqrt"):
                return "it is the root of less than zero"
            case Binary("/"):
                return "it is 0/0" if numbers[0] == 0.0 else "it is divided by zero"
            case Binary("^"):
                return f"it is {numbers[0]:.4g} to the power of {numbers[1]:.4g}"
            case Table():
                return f"its table has no value of {numbers[0]:.4g}"
            case Call(function="mod"):
                return "it is what is left of a division by zero"
            case Call():
                return f"it is the {part.function} of {numbers[0]:.4g}"
    return ""


def _parts(e: Expr) -> tuple[Expr, ...]:
    match e:
        case Binary():
            return (e.left, e.right)
        case Call():
            return tuple(e.args)
        case Table():
            return (e.arg,)
        case _:
            return ()
