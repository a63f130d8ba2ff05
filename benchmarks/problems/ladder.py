"""P5: Cockcroft-Walton ladders, nothing but ideal diodes and capacitors on a sine."""

from __future__ import annotations

from ladders import PERIOD, ladder
from measuring.ours import in_hybond
from measuring.problem import C, Outcome, Problem, points
from measuring.programs import in_c

LENGTHS, FULL = (2.0, 8.0), (8.0, 32.0)


def problem(diodes: int, full: bool) -> Problem:
    """Return the problem: what it finds is the voltage of the last node.

    All voltages are linear in the source's between events, so the C program takes no steps.
    """
    longest = (FULL if full else LENGTHS)[1]

    def periods(n: float) -> float:
        # away from the zeros of the sine, where nothing is about to switch
        return n + 0.1

    def limit(n: float) -> Outcome | None:
        run = in_c("ladder", diodes, periods(n), points(n, longest))
        return run and Outcome(run.seconds, run.found[2:], int(run.found[0]))

    def true(n: float) -> tuple[float, ...]:
        run = limit(n)
        return run.found if run else (float("nan"),)

    def ours(n: float) -> Outcome:
        end = periods(n) * PERIOD
        node = f"n{diodes}.e"
        return in_hybond(
            graph, end, points(n, longest), [node], lambda run: (float(run[node].at(end)),)
        )

    graph = ladder(diodes)
    return Problem(
        "P5",
        f"ladder of {diodes} ideal diodes",
        "period",
        LENGTHS,
        FULL,
        {C: limit, "hybond": ours},
        true,
        size=diodes,
    )
