"""P12: Newton's cradle of five balls, elastic impacts one after the other."""

from __future__ import annotations

import math

from measuring.ours import in_hybond
from measuring.problem import C, Outcome, Problem, points
from measuring.programs import in_c

import hybond as hb

BALLS, MASS, STIFF, OUT, RTOL = 5, 0.1, 0.981, 0.05, 1e-8
OMEGA = math.sqrt(STIFF / MASS)
LENGTHS, FULL = (20.0, 100.0), (200.0, 1000.0)


def model() -> hb.Model:
    """Return the cradle; the balls just touch where they hang still, the first is lifted."""
    m = hb.Model("cradle", domain="translational")
    for k in range(1, BALLS + 1):
        swing = hb.C(1.0 / STIFF, q=-OUT) if k == 1 else hb.C(1.0 / STIFF)
        m.add(**{f"v{k}": hb.One(), f"ball{k}": hb.I(MASS), f"swing{k}": swing})
        m.bond(f"v{k} -> ball{k}", f"v{k} -> swing{k}")
    for k in range(1, BALLS):
        gap = f"swing{k + 1}.q - swing{k}.q"
        m.add(**{f"hit{k}": hb.Zero(law="unilateral", gap=gap, restitution=1.0)})
        m.bond(f"v{k} -> hit{k} -> v{k + 1}")
    return m


def until(swings: float) -> float:
    """Return a time 0.3 of a swing from one side to the other behind the last impact."""
    return (swings + 0.8) * math.pi / OMEGA


def true(swings: float) -> tuple[float, ...]:
    """Return where the first and the last ball are: what moves goes on as if it were alone."""
    place = -OUT * math.cos(OMEGA * until(swings))
    return min(place, 0.0), max(place, 0.0)


def problem(full: bool) -> Problem:
    """Return the problem."""
    longest = (FULL if full else LENGTHS)[1]

    def limit(n: float) -> Outcome | None:
        run = in_c("cradle", BALLS, until(n), RTOL, points(n, longest))
        return run and Outcome(run.seconds, run.found[1:], int(run.found[0]))

    def ours(n: float, solver: str = "rk45") -> Outcome:
        first, last = "swing1.q", f"swing{BALLS}.q"
        return in_hybond(
            model(),
            until(n),
            points(n, longest),
            [first, last],
            lambda run: (run.final[first], run.final[last]),
            rtol=RTOL,
            solver=solver,
            impact="newton",
        )

    return Problem(
        "P12",
        f"cradle of {BALLS} balls",
        "impact",
        LENGTHS,
        FULL,
        {C: limit, "hybond": ours, "hybond exact": lambda n: ours(n, "exact")},
        true,
    )
