"""How long a period is: what is asked, what a model repeats with, how soon a motion comes back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.linear.periods import period_of, periods_in, time_said, times_of
from hybond.analysis.periodic.shots import Shots, calm, read_states
from hybond.errors import NumericsError, UsageError
from hybond.model.expressions import compile_expression, differentiate, names
from hybond.model.expressions.slots import slot_of
from hybond.model.graph import Mode
from hybond.result import Result

Vector = NDArray[np.float64]

POINTS = 2000
"""At which a run is read to see when it comes back."""
PARTS = (1.0, 1.0 / 16.0, 1.0 / 256.0)
"""Of the run, from its end, that are read so closely, until it is seen to come back close."""
ABOUT = 0.3
"""Part by which a first guess of a period is off at the most."""
CLOSE = 0.01
"""Part of that way within which nobody looks more closely."""
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
    asked = None if period is None else time_said(shots.graph, period)
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
    times = times_of(asked, own)
    if not times:
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
    read = read_states(run.graph)
    last = run.segments[-1].mode
    whole = run.t_end - run.t_begin
    t, x, _ = _points(run, run.t_begin)
    late = x[t >= run.t_begin + 0.5 * whole][:, read]
    spread = np.ptp(late, axis=0)
    size = np.abs(x[:, read]).max(axis=0, initial=0.0)
    moving = spread > 1e-9 * np.where(size > 0.0, size, 1.0)
    if not moving.any():
        raise _no_return(run, "at the end of the run nothing moves")
    T, off = guess, np.inf
    for part in PARTS:
        t, x, which = _points(run, run.t_end - part * whole)
        scaled = x[:, read][:, moving] / spread[moving]
        same = np.array([run.segments[k].mode == last for k in which.tolist()])
        apart = np.where(same, np.abs(scaled - scaled[-1]).max(axis=1), np.inf)
        near, wide = _round(t, apart, guess), _round(t, apart, None)
        if near[1] > BACK and wide[1] <= CLOSE:
            near = wide  # it does come back, and not after what was guessed
        if near[1] < off:
            T, off = near
        if off <= CLOSE:
            break
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


def _points(run: Result, begin: float) -> tuple[Vector, Vector, NDArray[np.intp]]:
    """Return times, states and segments at points all over the end of a run."""
    n = len(run.graph.storages) + len(run.graph.integrals)
    grid = np.linspace(begin, run.t_end, POINTS)
    times, rows, which = [], [], []
    for k, segment in enumerate(run.segments):
        if segment.t[-1] < begin:
            continue
        own = grid[(grid >= segment.t[0]) & (grid < segment.t[-1])]
        if segment.t[0] >= begin:
            own = np.unique(np.concatenate([segment.t[:1], own]))
        times.append(own)
        rows.append(np.array([segment.at(float(a))[:n] for a in own]).reshape(len(own), n))
        which.append(np.full(len(own), k))
    return np.concatenate(times), np.concatenate(rows), np.concatenate(which)


def _round(t: Vector, apart: Vector, guess: float | None) -> tuple[float | None, float]:
    """Return how long ago it was last near where it is at the end, after having been away.

    And how far it was from there. With a guess: when it was nearest, about that long ago.
    """
    ago = t[-1] - t
    if guess is not None:
        about = np.abs(ago / guess - 1.0) <= ABOUT
        k = int(np.argmin(np.where(about, apart, np.inf)))
        return (float(ago[k]), float(apart[k])) if about[k] and apart[k] <= BACK else (None, np.inf)
    away = False
    best: int | None = None
    for k in range(len(t) - 2, 0, -1):
        if apart[k] > BACK:
            if best is not None:
                break
            away = away or apart[k] > 2.0 * BACK
        elif away and (best is None or apart[k] < apart[best]):
            best = k
    return (None, np.inf) if best is None else (float(ago[best]), float(apart[best]))
