"""P4: a chain of 100 masses with an end stop."""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np
from measuring.ours import in_hybond
from measuring.problem import C, Outcome, Problem, points
from measuring.programs import in_c
from measuring.restarts import Mode, Vector, in_scipy

import hybond as hb
from problems.chain import DAMPED, PULL, STIFF, chain, links

MASSES, GAP, RESTITUTION, SMALL, RTOL = 100, 5.0, 0.5, 1e-6, 1e-8
LENGTHS = FULL = (4.0, 20.0)


def model() -> hb.Model:
    """Return the chain with a contact that has Newton's restitution."""
    m = chain(MASSES)
    m.signal(room=hb.Integral(f"-v{MASSES}.f", start=GAP))
    m.add(stop=hb.Zero(law="unilateral", gap="room", restitution=RESTITUTION))
    m.bond(f"v{MASSES} -> stop")
    return m


def mode_of(mode: Hashable) -> Mode:
    """Return the chain in flight, or with its last mass at rest on the stop."""
    n = MASSES

    def pulled(t: float, y: Vector) -> Vector:
        dq, dv = links(y[:n], y[n : 2 * n])
        if mode == "rests":
            dv[-1] = 0.0
        return np.concatenate((dq, dv, [-y[2 * n - 1]]))

    def impact(t: float, y: Vector) -> tuple[str, Vector]:
        rests = RESTITUTION * y[2 * n - 1] < SMALL
        y[2 * n - 1] *= 0.0 if rests else -RESTITUTION
        y[2 * n] = 0.0
        return "rests" if rests else "flies", y

    if mode == "rests":
        return pulled, [
            (
                lambda t, y: PULL - STIFF * y[n - 1] + DAMPED * y[2 * n - 2],
                lambda t, y: ("flies", y),
            )
        ]
    return pulled, [(lambda t, y: y[2 * n] if y[2 * n - 1] > 0.0 else 1.0, impact)]


def problem(full: bool) -> Problem:
    """Return the problem: what it finds are the first and the last stretch."""
    longest = LENGTHS[1]

    def limit(end: float, rtol: float = RTOL) -> Outcome | None:
        run = in_c("stop", MASSES, end, GAP, rtol, points(end, longest))
        return run and Outcome(run.seconds, run.found[1:])

    def true(end: float) -> tuple[float, ...]:
        run = limit(end, 1e-13)
        return run.found if run else (float("nan"),) * 2

    def ours(end: float) -> Outcome:
        return in_hybond(
            model(),
            end,
            points(end, longest),
            [f"k{MASSES}.q", f"v{MASSES}.f"],
            lambda run: (run.final[f"k{MASSES}.q"], run.final["k1.q"]),
            rtol=RTOL,
        )

    def scipy(end: float) -> Outcome:
        return in_scipy(
            mode_of,
            "flies",
            [0.0] * (2 * MASSES) + [GAP],
            end,
            points(end, longest),
            lambda t, y, times: (float(y[MASSES - 1]), float(y[0])),
            rtol=RTOL,
        )

    return Problem(
        "P4",
        f"chain of {MASSES} masses with an end stop",
        "second",
        LENGTHS,
        FULL,
        {C: limit, "hybond": ours, "SciPy": scipy},
        true,
    )
