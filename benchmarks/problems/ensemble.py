"""P7: many balls, each with its own restitution and height."""

from __future__ import annotations

import dataclasses
import math
import time

from measuring.problem import C, Outcome, Problem
from measuring.programs import in_c
from measuring.restarts import in_scipy

import hybond as hb
from problems.ball import DROP, GRAVITY, RTOL, falling, model

END, POINTS = 5.0, 100
LENGTHS, FULL = (100.0, 600.0), (1000.0, 10_000.0)


def spread(low: float, high: float, number: int, stride: float) -> float:
    """Return a value for ball `number`, from 1, evenly spread."""
    return low + (high - low) * math.fmod(number * stride, 1.0)


def ball(number: int) -> tuple[float, float]:
    """Return restitution and height."""
    return (
        spread(0.85, 0.99, number, 0.6180339887498949),
        spread(1.0, DROP, number, 0.41421356237309515),
    )


def last(restitution: float, drop: float) -> float:
    """Return the time of the last bounce before the end."""
    t = fall = math.sqrt(2.0 * drop / GRAVITY)
    flight = 2.0 * fall * restitution
    while t + flight < END:
        t, flight = t + flight, flight * restitution
    return t


def in_hybond(balls: float, workers: int | None = None) -> Outcome:
    """Simulate the same model with all parameters in one call; all events of it are bounces."""
    start = time.perf_counter()
    sets = [ball(k) for k in range(1, int(balls) + 1)]
    many = hb.ensemble(
        model(),
        until=END,
        rtol=RTOL,
        sets=[{"restitution": restitution, "drop": drop} for restitution, drop in sets],
        outputs=["height", "v.f"],
        samples=POINTS,
        events=True,
        workers=workers,
    )
    total = sum(float(times[-1]) for times in many.events)
    return Outcome(time.perf_counter() - start, (total,), int(many.counts.sum()))


def in_restarts(balls: float) -> Outcome:
    """Follow one ball after the other with SciPy."""
    whole = Outcome(0.0, (0.0,))
    for k in range(1, int(balls) + 1):
        restitution, drop = ball(k)
        run = in_scipy(
            lambda mode, e=restitution: falling(e),
            0,
            [drop, 0.0],
            END,
            POINTS,
            lambda t, y, times: (times[-1],),
            rtol=RTOL,
        )
        whole = dataclasses.replace(
            whole,
            seconds=whole.seconds + run.seconds,
            found=(whole.found[0] + run.found[0],),
        )
    return whole


def problem(full: bool) -> Problem:
    """Return the problem: what it finds is the sum of the times of all last bounces."""
    return Problem(
        "P7",
        "balls with different parameters",
        "ball",
        LENGTHS,
        FULL,
        {
            C: lambda n: in_c("ensemble", n, END, RTOL, POINTS),
            "hybond": lambda n: in_hybond(n, 1),
            "hybond, all cores": in_hybond,
            "SciPy": in_restarts,
        },
        lambda n: (sum(last(*ball(k)) for k in range(1, int(n) + 1)),),
    )
