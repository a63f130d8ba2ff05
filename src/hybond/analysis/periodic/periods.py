"""How long a period is: what is asked, what a model repeats with, how soon a motion comes back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.linear.periods import period_of, periods_in
from hybond.analysis.periodic.shots import Shots, calm, read_states
from hybond.errors import NumericsError, UsageError
from hybond.model.expressions import compile_expression, differentiate, names
from hybond.model.expressions.slots import slot_of
from hybond.model.graph import Mode
from hybond.options import seconds
from hybond.result import Result

Vector = NDArray[np.float64]

WHOLE = 1e-9
"""Part by which a period may differ from a whole number of those of the model."""
POINTS = 2000
"""At which a run is read to see when it comes back."""
BACK = 0.1
"""Part of the way it goes within which a motion has come back."""


@dataclass(frozen=True, slots=True)
class Period:
    """How long a period is.

    Parameters
    ----------
    T : float
        s. Of a motion that nothing drives the first guess.
    multiple : int
        How many periods of what drives it that are.
    own : bool
        Whether nothing drives the motion, so that its period is its own.
    known : bool
        Whether the model says itself that it repeats; else only who asks does.
    note : str
        What is to be said of it.
    """

    T: float
    multiple: int
    own: bool
    known: bool = True
    note: str = ""


def period_asked(shots: Shots, period: float | str | None, multiple: int) -> Period | None:
    """Return the period that is asked for, or that of the model; None where a run has to tell.

    Raises
    ------
    UsageError
        HB-A541 for a period that is none, or no whole number of the model's own; HB-A511 where it
        is not given and cannot be told.
    """
    asked = None if period is None else seconds(period, "period")
    if asked is not None and not 0.0 < asked < np.inf:
        raise _no_period(f"a period of {asked:g} s is none", "a time above 0")
    if isinstance(multiple, bool) or not isinstance(multiple, int) or multiple < 1:
        raise UsageError(
            f"multiple = {multiple!r} is no number of periods",
            code="HB-A541",
            where="multiple",
            hint="1, or 2 for a motion that repeats after two periods",
        )
    try:
        own = period_of(shots.graph)
    except UsageError as error:
        if asked is None:
            error.hint = 'say after which time all repeats: hb.periodic(model, period="10 us")'
            raise
        said = f"whether the model repeats every {asked:.9g} s is taken as said: {error.why}"
        return Period(multiple * asked, multiple, own=False, known=False, note=said)
    if own is None:
        return None if asked is None else Period(multiple * asked, multiple, own=True)
    if asked is None:
        note = f"the model repeats every {own:.9g} s"
        return Period(multiple * own, multiple, own=False, note=note)
    times = round(asked / own)
    if times < 1 or abs(asked / own - times) > WHOLE * times:
        raise _no_period(
            f"the model repeats every {own:.9g} s, and {asked:.9g} s is no whole number of that",
            f'period="{own:.9g} s", or leave it out and say multiple=2',
        )
    return Period(multiple * times * own, multiple * times, own=False)


def _no_period(why: str, hint: str) -> UsageError:
    return UsageError(why, code="HB-A541", where="period", hint=hint)


def followed_by(shots: Shots, period: Period) -> Vector:
    """Return how the length of a period follows what is varied, shape (wrt,)."""
    many = len(shots.wanted.names)
    found = np.zeros(many)
    if period.own or not period.known or not many:
        return found
    made = slot_of(periods_in(shots.wanted.graph)[0])
    if made is None:
        return found
    columns = shots.wanted.columns
    index = {name: k for k, name in enumerate(columns)}
    row = shots.values.tolist()
    value = float(compile_expression(made.tree, index, pre_offset=0)(row))
    for name in names(made.tree):
        slope = compile_expression(differentiate(made.tree, name), index, pre_offset=0)
        found[index[name]] = float(slope(row)) * length_now(shots, period) / value
    return found


def length_now(shots: Shots, period: Period) -> float:
    """Return the length of a period with the present values of what is varied."""
    if period.own or not period.known or not shots.wanted.names:
        return period.T
    own = period_of(shots.graph)
    return period.T if own is None else period.multiple * own


@dataclass(frozen=True, slots=True, eq=False)
class Return:
    """Where a run has come back to.

    Parameters
    ----------
    x, mode
        A point of its last round, within a motion.
    T : float
        How long the round was, s.
    """

    x: Vector
    mode: Mode
    T: float


def comes_back(run: Result, multiple: int, guess: float | None) -> Return:
    """Return the last round of a run: when it was last where it is at the end, in the same mode.

    Parameters
    ----------
    guess : float, optional
        How long a round is, s, if that is known.

    Raises
    ------
    NumericsError
        HB-A540 if it never comes back.
    """
    t, x, which = _points(run)
    x = x[:, read_states(run.graph)]
    last = run.segments[-1].mode
    same = np.array([run.segments[k].mode == last for k in which.tolist()])
    late = t >= 0.5 * (t[0] + t[-1])
    spread = np.ptp(x[late], axis=0)
    size = np.abs(x).max(axis=0, initial=0.0)
    moving = spread > 1e-9 * np.where(size > 0.0, size, 1.0)
    if not moving.any():
        raise _no_return(run, "at the end of the run nothing moves")
    T = guess if guess is not None else _round(t, x[:, moving] / spread[moving], same)
    if T is None or T <= 0.0:
        raise _no_return(run, "the run does not come back to where it was")
    point = calm(run, min(T, run.t_end - run.t_begin))
    if point is None:
        raise _no_return(run, "all of it slides, or lies still")
    _, state, mode = point
    return Return(state, mode, multiple * T)


def _no_return(run: Result, why: str) -> NumericsError:
    error = NumericsError(
        f"no period is seen: {why}",
        code="HB-A540",
        where=f"t = {run.t_end:.9g} s",
        hint='let it settle longer (settle="100 s"), start it elsewhere, or say period="2 s"',
    )
    error.partial = run
    return error


def _points(run: Result) -> tuple[Vector, Vector, NDArray[np.intp]]:
    """Return times, states and segments at points all over a run."""
    n = len(run.graph.storages) + len(run.graph.integrals)
    begin, end = run.t_begin, run.t_end
    grid = np.linspace(begin, end, POINTS)
    times, rows, which = [], [], []
    for k, segment in enumerate(run.segments):
        own = grid[(grid >= segment.t[0]) & (grid < segment.t[-1])]
        own = np.unique(np.concatenate([segment.t[:1], own]))
        times.append(own)
        rows.append(np.array([segment.at(float(a))[:n] for a in own]))
        which.append(np.full(len(own), k))
    return np.concatenate(times), np.concatenate(rows), np.concatenate(which)


def _round(t: Vector, x: Vector, same: NDArray[np.bool_]) -> float | None:
    """Return how long ago it was last near where it is at the end, after having been away."""
    off = np.where(same, np.abs(x - x[-1]).max(axis=1), np.inf)
    away = False
    best: int | None = None
    for k in range(len(t) - 2, 0, -1):
        if off[k] > BACK:
            if best is not None:
                break
            away = away or off[k] > 2.0 * BACK
        elif away and (best is None or off[k] < off[best]):
            best = k
    return None if best is None else float(t[-1] - t[best])
