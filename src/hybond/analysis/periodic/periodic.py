"""`periodic`: the motion of a model that repeats."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.periodic.newton import Found, Newton, smallest_step
from hybond.analysis.periodic.orbit import PeriodicOrbit
from hybond.analysis.periodic.periods import (
    Period,
    comes_back,
    followed_by,
    length_now,
    period_asked,
)
from hybond.analysis.periodic.shots import Shots, Shown, calm, end_of, near_ends
from hybond.analysis.sensitivity.opened import Opened, opened_model
from hybond.calls import called
from hybond.errors import HybondError, NumericsError, UsageError
from hybond.model.builder import Model
from hybond.model.given import check_model
from hybond.model.graph import Mode
from hybond.model.parts import Value
from hybond.model.paths import with_parts
from hybond.options import seconds
from hybond.result import Result
from hybond.runs.asked import MethodOptions, opened
from hybond.runs.states import State
from hybond.runs.times import time_in

Vector = NDArray[np.float64]

RTOL = 1e-10
"""Of the runs, unless another one is asked for: the end is compared with the beginning."""
TOL = 1e-9
MOST = 60
SETTLE = 2
"""Periods that are run before the first step, where something drives the motion."""
MOST_LAPS = 12
"""So many laps of a motion of its own period are told of, if all of them were taken for one."""


@called('hb.periodic(model, period="20 us")', options=MethodOptions)
def periodic(
    model: Model,
    period: float | str | None = None,
    *,
    multiple: int = 1,
    wrt: Sequence[str] | str = (),
    start: Result | State | Mapping[str, Any] | None = None,
    settle: float | str | None = None,
    parameters: Mapping[str, Value] | None = None,
    tol: float = TOL,
    max_runs: int = MOST,
    progress: Shown | None = None,
    **options: Unpack[MethodOptions],
) -> PeriodicOrbit:
    """Return a motion that repeats, and the Floquet multipliers that say what is near it.

    It is found by shooting: one period is run from a state, and the state is changed by Newton's
    method until the end of the period is its beginning. The derivatives go through all switches, as
    those of `sensitivities`; a converter is in its steady state after a few periods, however slow
    it settles by itself, and motions that are not stable are found, too.

    Parameters
    ----------
    model : Model
    period : float or str
        After which it repeats: s, a quantity or an expression of parameters (``"2*pi/w"``); by
        default what sources and inputs repeat with. Where nothing drives the model, the period is
        found: this is a first guess of it, and by default how long a run took to come back.
    multiple : int
        How many of these periods the motion needs: 2 for one that repeats after two.
    wrt : sequence of str
        What the derivatives of the state at the beginning are wanted by, as for `sensitivities`.
    start : Result, State or mapping
        Where the search begins; by default where the model does.
    settle : float or str
        How long it runs before the first step of Newton's method; default two periods, or, where
        nothing drives the model, the time of the experiment.
    parameters : mapping
        Values by dotted path that replace the model's own.
    tol : float
        Part of each state by which the end of the period may be off its beginning.
    max_runs : int
        Runs after which the search ends.
    progress : callable, optional
        ``progress(run, part, events)``, called about twenty times a second with the number of the
        run that is under way, from 1, the part of it that is done and its events so far.
    **options
        `method`, or what is short for it, as for `simulate`; its `rtol` is 1e-10 by default.

    Returns
    -------
    PeriodicOrbit

    Raises
    ------
    UsageError
        HB-A541 for a period that does not fit, HB-A511 where it cannot be told; HB-A520 for what
        cannot be varied.
    EquationError
        HB-A522 for a model with blocks or friction in the plane.
    NumericsError
        HB-A540 if no such motion is found, with the last run as `partial`; HB-A542 where it has no
        derivatives, because a guard is only touched or two events share an instant.
    HybondError
        As `simulate`.
    KeyboardInterrupt
        Where Ctrl-C is pressed: what was found so far is no orbit.

    Examples
    --------
    A choke behind a chopper. Its current would settle in hundreds of periods; here it takes four
    runs, and its multiplier is ``exp(-R T / L)``:

    >>> import hybond as hb
    >>> m = hb.Model("chopper", domain="electrical")
    >>> m.input(u=hb.Input(pwm={"period": "0.1 ms", "duty": 0.4}))
    >>> m.add(V=hb.Se("10 V*u"), L=hb.I("10 mH"), R=hb.R("1 ohm"), j=hb.One())
    >>> m.bond("V -> j -> L", "j -> R")
    >>> orbit = hb.periodic(m)
    >>> orbit.stable, [round(v, 9) for v in orbit.values.real.tolist()], orbit.periods
    (True, [0.990049834], 4.0)
    >>> round(orbit["R.e"].mean(), 9)
    4.0
    """
    shots = shots_of(model, wrt, parameters, options, progress)
    asked = period_asked(shots, period, multiple)
    begun = begin(shots, asked, multiple, start, settle)
    newton = newton_of(shots, begun, tol, max_runs)
    found = newton.found(begun.x, begun.mode, begun.period.T)
    return orbit_of(shots, begun.period, found)


def shots_of(
    model: Model,
    wrt: Sequence[str] | str,
    parameters: Mapping[str, Value] | None,
    asked: Mapping[str, Any],
    progress: Shown | None = None,
) -> Shots:
    """Return what all shots of a model have in common."""
    check_model(model)
    if progress is not None and not callable(progress):
        raise UsageError(
            f"progress = {progress!r}",
            code="HB-S131",
            where="progress",
            hint="a function progress(run, part, events)",
        )
    options = opened(asked)
    # a step that is given has no tolerance
    if "rtol" not in options and "step" not in options:
        options["rtol"] = RTOL
    names = [wrt] if isinstance(wrt, str) else list(wrt)
    given = dict(parameters or {})
    if names:
        return Shots(opened_model(model, names, given), options, progress)
    model, left = with_parts(model, given)
    return Shots(Opened((), (), model, (), left), options, progress)


@dataclass(frozen=True, slots=True, eq=False)
class Begun:
    """Where a search begins.

    Parameters
    ----------
    x, mode
    period : Period
    sizes : array, shape (n,)
        The largest value of each state so far.
    """

    x: Vector
    mode: Mode
    period: Period
    sizes: Vector


def begin(
    shots: Shots,
    asked: Period | None,
    multiple: int,
    start: Result | State | Mapping[str, Any] | None,
    settle: float | str | None,
) -> Begun:
    """Return where a search begins: after a run in which discrete states settle."""
    n = len(shots.names)
    own = asked is None or asked.own
    if settle is not None:
        length = seconds(settle, "settle")
    elif not own:
        assert asked is not None
        length = SETTLE * asked.T / asked.multiple
        # the phase is that of what drives it
        length = float(np.ceil(length / asked.T - 1e-9)) * asked.T
    else:
        until = time_in(shots.graph.experiment.get("until"))
        if until is None and asked is None:
            raise UsageError(
                "nothing drives the model: how long a period is has to be seen in a run",
                code="HB-A541",
                where="settle",
                hint='settle="10 s", in which it comes to repeat, or a first guess period="2 s"',
            )
        length = seconds(until, "until") if until is not None else 0.0
        if until is None and asked is not None:
            length = 10.0 * asked.T
    if not own:
        assert asked is not None
        return _driven(shots, asked, start, length)
    run = shots.run(length, _begin_state(start))
    back = comes_back(run, multiple, None if asked is None else asked.T / multiple)
    sizes = _sizes(run, n)
    return Begun(back.x, back.mode, Period(back.T, 1, own=True), sizes)


def _driven(shots: Shots, asked: Period, start: Any, length: float) -> Begun:
    """Return where the search of a driven motion begins, at a whole period."""
    n, whole = len(shots.names), length / asked.T
    if abs(whole - round(whole)) > 1e-9 * max(whole, 1.0) or whole < 0.0:
        raise UsageError(
            f"{length:.9g} s are no whole number of periods of {asked.T:.9g} s",
            code="HB-A541",
            where="settle",
            hint=f'settle="{max(round(whole), 1) * asked.T:.9g} s"',
        )
    if not asked.known:
        shots.settled = length
    shots.t0 = shots.first(asked.T)
    if not round(whole) and not shots.t0:
        run = shots.run(asked.T, _begin_state(start))
        first = run.events[0]
        return Begun(np.asarray(first.after[:n]), first.steps[-1].mode, asked, _sizes(run, n))
    run = shots.run(max(length, shots.t0), _begin_state(start))
    x, mode = end_of(run)
    if near_ends(run, asked.T):
        point = calm(run, asked.T)
        if point is not None:
            t, x, mode = point
            shots.t0 += t - (run.t_end - asked.T)
    return Begun(x, mode, asked, _sizes(run, n))


def _begin_state(start: Any) -> Any:
    """Return a start at time zero: the phase of what drives the motion is counted from there."""
    if isinstance(start, Result):
        start = start.state()
    if isinstance(start, State):
        return {**start.stored, **start.signals, **start.machines}
    return start


def _sizes(run: Result, n: int) -> Vector:
    rows = [np.abs(segment.y[:, :n]).max(axis=0, initial=0.0) for segment in run.segments]
    return np.max(rows, axis=0) if rows else np.zeros(n)


def newton_of(shots: Shots, begun: Begun, tol: float, max_runs: int) -> Newton:
    """Return the search that begins somewhere."""
    if not isinstance(tol, int | float) or isinstance(tol, bool) or not 0.0 < tol < 1.0:
        raise UsageError(f"tol = {tol!r}", code="HB-A541", where="tol", hint="such as 1e-9")
    if isinstance(max_runs, bool) or not isinstance(max_runs, int) or max_runs < 2:
        raise UsageError(
            f"max_runs = {max_runs!r}", code="HB-A541", where="max_runs", hint="2 or more"
        )
    T_by = followed_by(shots, begun.period)
    return Newton(shots, begun.period.own, begun.sizes, tol, max_runs, T_by)


def orbit_of(shots: Shots, period: Period, found: Found) -> PeriodicOrbit:
    """Return the record of what was found."""
    shot = found.shot
    assert shot.M is not None and shot.by is not None
    notes = [note for note in (period.note,) if note] + list(found.notes)
    kept = found.kept
    block = shot.M[np.ix_(kept, kept)]
    made = shots.multipliers(shot, found.sizes, kept, own=period.own, conserved=len(found.free))
    by, period_by = _moved(shots, period, found)
    if period.own or period.multiple > 1:
        notes += _shorter(shots, period, found)
    first = shots.first(shot.T)
    if shots.t0 > first:
        notes.append(f"it is counted from t = {shots.t0:.9g} s, away from switches")
    elif first:
        notes.append(f"it is counted from t = {first:.9g} s, from where on all repeats")
    if not period.known:
        notes += _checked(shots, found)
    notes += [] if shot.chain is None else shot.chain.digits()
    state = shot.run.state(shot.run.t_begin)
    once = period.T / period.multiple
    worked = shots.time / (shot.T if period.own else once)
    return PeriodicOrbit(
        shot.T,
        period.multiple,
        period.own,
        state,
        shot.run,
        tuple(shots.names[k] for k in kept),
        block,
        made,
        shots.wanted.names,
        by,
        period_by,
        shots.wanted.units,
        shots.done,
        worked,
        found.residual,
        found.history,
        found.free,
        tuple(notes),
    )


def _moved(shots: Shots, period: Period, found: Found) -> tuple[Vector, Vector]:
    """Return how the beginning and the period follow what is varied."""
    many, shot, kept = len(shots.wanted.names), found.shot, found.kept
    assert shot.by is not None
    period_by = followed_by(shots, period)
    if not many:
        return np.zeros((len(kept), 0)), period_by
    J, _, _ = _newton_system(shots, period, found)
    unit = found.sizes[kept]
    by = np.zeros((len(kept), many))
    for j in range(many):
        right = -shot.by[kept, j] / unit
        step = smallest_step(J, np.append(right, 0.0) if period.own else right)
        by[:, j] = step[: len(kept)] * unit
        if period.own:
            period_by[j] = step[-1] * shot.T
    return by, period_by


def _newton_system(shots: Shots, period: Period, found: Found) -> tuple[Vector, Vector, list[int]]:
    return Newton(shots, period.own, found.sizes, 1.0, 0).system(found.shot)


def _shorter(shots: Shots, period: Period, found: Found) -> list[str]:
    """Return what is to be said of a motion that repeats sooner than it was asked to."""
    shot = found.shot
    most = MOST_LAPS if period.own else period.multiple
    for parts in range(most, 1, -1):
        if not period.own and period.multiple % parts:
            continue
        state = shot.run.state(shots.t0 + shot.T / parts)
        x = np.array([*state.stored.values(), *state.signals.values()])
        near = (np.abs(x - shot.x)[found.kept] <= 1e-6 * found.sizes[found.kept]).all()
        if near and dict(state.machines) == shots.graph.mode_names(shot.mode):
            return [f"it repeats after {shot.T / parts:.9g} s already"]
    return []


def _checked(shots: Shots, found: Found) -> list[str]:
    """Return nothing for a motion that goes on as it was; else refuse it.

    Raises
    ------
    NumericsError
        HB-A540 if the second period differs from the first.
    """
    shot = found.shot
    try:
        run = shots.run(shots.t0 + 2.0 * shot.T, shots.state(shot.x, shot.mode))
    except HybondError as error:
        return [f"a second period cannot be run: {error.why}"]
    x, _ = end_of(run)
    off = float((np.abs(x - shot.x) / found.sizes)[found.kept].max(initial=0.0))
    if off > 1e-4:
        refusal = NumericsError(
            f"the period closes, but the next one does not (by {off:.3g} of a state): the model "
            f"does not repeat every {shot.T:.9g} s",
            code="HB-A540",
            where="period",
            hint="say after which time sources and inputs repeat",
        )
        refusal.partial = run
        raise refusal
    return []


__all__ = ["Begun", "begin", "length_now", "newton_of", "orbit_of", "periodic", "shots_of"]
