"""`bifurcation`: a model looked at once a period, or at its events, value after value."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any, Literal

from hybond.calls import called
from hybond.model.builder import Model
from hybond.progress import Asked, shown
from hybond.sweep.bifurcation.branch import branch_of
from hybond.sweep.bifurcation.question import question_of, refusal
from hybond.sweep.bifurcation.record import Bifurcation
from hybond.sweep.bifurcation.values import Point, Values
from hybond.sweep.threads import workers_of


@called('hb.bifurcation(model, {"Iref": "0.5..1.5 A:500"}, of="L.f", period="T")')
def bifurcation(
    model: Model,
    parameter: Mapping[str, Any],
    *,
    of: str | Sequence[str],
    period: float | str | None = None,
    at: str | None = None,
    before: bool = False,
    settle: int = 300,
    keep: int = 64,
    direction: Literal["fresh", "up", "down", "both"] = "fresh",
    tolerance: float = 1e-6,
    longest: int | None = None,
    limit: float | str | None = None,
    parameters: Mapping[str, Any] | None = None,
    workers: int | None = None,
    progress: Asked = None,
    **options: Any,
) -> Bifurcation:
    """Return the bifurcation diagram of a model: signals, looked at once a period or at events.

    Each value of the parameter is run until it has settled, and then looked at `keep` times. Of
    these samples the period is told, and of the modes between them which events make it.

    Parameters
    ----------
    model : Model
    parameter : mapping of path to values
        What varies, as in `hybond.Plan`: ``{"Iref": "0.5..1.5 A:500"}``, or a sequence in order.
        A parameter, the value of an element or a start.
    of : str or sequence of str
        Signals, or expressions of them.
    period : float or str
        The period of what drives the model, s, a quantity, or an expression of parameters
        (``"2*pi/w"``). Samples are taken at whole periods since t = 0, after what happens there.
    at : str
        Instead: ``"M.s"``, each time that machine M enters its state s. A contact with restitution
        has the state ``impact``.
    before : bool
        Whether signals are looked at before what happens at a sample, and not after it.
    settle : int
        Periods, or events, that pass before samples are kept.
    keep : int
        Samples of each value.
    direction : {"fresh", "up", "down", "both"}
        Where a value begins: as the model does; or where the next smaller (``up``) or greater one
        (``down``) has come, as on a test rig, so that what coexists is seen from both sides. What
        is carried on is the whole state, with the phase of the period; time goes on. A value after
        one that has stopped begins as the model does.
    tolerance : float
        By which samples of one orbit may differ, as a part of the largest value of the signal.
    longest : int
        Periods up to this one are told. Default, and at most, half of `keep`.
    limit : float or str
        Of `at`: how long a value may take, s. Default: for each event the time of the experiment.
    parameters : mapping
        Values by dotted path that replace the model's own.
    workers : int
        Threads, of ``fresh``. Default: one for each core. What comes out does not depend on it.
    progress : bool, bar of tqdm or callable
        As for `hybond.ensemble`. Ctrl-C keeps what there is.
    **options
        Of `hybond.simulate`, for all values: ``solver``, ``rtol``, ``engine``, ...

    Returns
    -------
    Bifurcation

    Raises
    ------
    UsageError
        HB-P131 for what makes no sense, HB-P132 for a period or an event that is none, HB-P101 for
        values, HB-S109 for signals.
    ModelError
        HB-M107 for a parameter that the model does not have.

    References
    ----------
    M. di Bernardo, C. J. Budd, A. R. Champneys, P. Kowalczyk, *Piecewise-smooth Dynamical
    Systems*, Springer 2008.

    Examples
    --------
    A switch that a clock closes every second, and that opens at a threshold. It opens once in each
    period, or where the current is slow enough once in two.

    >>> import hybond as hb
    >>> m = hb.Model("clocked", domain="electrical", parameters={"top": "0.5 A"})
    >>> m.input(clock=hb.Input(pwm={"period": "1 s", "duty": 0.5}))
    >>> m.add(U=hb.Se("1 V"), s=hb.One(), n=hb.Zero(), i=hb.One(), L=hb.I("1 H"), R=hb.R("1 ohm"))
    >>> m.add(free=hb.One(), zero=hb.Se("0 V"))
    >>> m.bond("U -> s -> n -> i -> L", "i -> R", "zero -> free -> n")
    >>> m.machine("M", states={"off": ["free"], "on": ["s"]}, start="on",
    ...           rules=["off -> on when clock > 0.5 and pre(clock) < 0.5",
    ...                  "on -> off when L.f >= top"])
    >>> found = hb.bifurcation(m, {"top": "0.4..0.75 A:8"}, of="L.f", period="1 s", settle=60)
    >>> found.branches[0].period.tolist()
    [1, 1, 1, 1, 1, 1, 1, 2]
    """
    began = time.perf_counter()
    question = question_of(
        model,
        parameter,
        of=of,
        period=period,
        at=at,
        before=before,
        settle=settle,
        keep=keep,
        direction=direction,
        tolerance=tolerance,
        longest=longest,
        limit=limit,
        parameters=parameters,
        options=options,
    )
    if model.experiment.get("start") is not None:
        raise refusal(
            "values begin as the model says", "experiment.start", "leave start out of the model"
        )
    threads = workers_of(workers)
    values = Values(question)
    many = len(question.values)
    total = many * len(question.directions)
    branches, done, interrupted = [], 0, False
    with shown(progress, total, members=True) as looked:
        for way in question.directions:
            points: list[Point | None] = [None] * many
            order = range(many) if way != "down" else range(many - 1, -1, -1)

            def keep_points(first: int, found: list[Point], order: range = order) -> None:
                nonlocal done
                for k, point in enumerate(found):
                    points[order[first + k]] = point  # noqa: B023
                done += len(found)
                if looked is not None:
                    looked(done, total)

            try:
                if interrupted:
                    pass
                elif way == "fresh":
                    values.fresh(question.values, min(threads, many), keep_points)
                else:
                    values.carried(question.values[list(order)], keep_points)
            except KeyboardInterrupt:
                interrupted = True
            branches.append(branch_of(values, way, points))
    how = f"{done} of {total} values" if interrupted else f"{total} values"
    if values.ordinary:
        how += f", {values.ordinary} as ordinary runs"
    return Bifurcation(
        title=model.title or model.name,
        branches=tuple(branches),
        values=question.values.copy(),
        how=how,
        interrupted=interrupted,
        seconds=time.perf_counter() - began,
        runner=values,
    )
