"""P10 and P11: a driven chain of blocks that rub on the ground, with events and in fixed steps."""

from __future__ import annotations

import math
from typing import Any

from measuring.ours import in_hybond
from measuring.problem import C, Outcome, Problem, Tool, points
from measuring.programs import in_c

import hybond as hb
from problems.chain import DAMPED, STIFF

BLOCKS, RUB, PUSH, OMEGA, RTOL, STEP = 100, 0.1, 5.0, 2.0 * math.pi, 1e-8, 1e-3
LENGTHS, FULL = (1.0, 2.0), (2.0, 6.0)


def model(blocks: int) -> hb.Model:
    """Return the chain, on a wall; the velocity of each block is a junction that has the law."""
    m = hb.Model("blocks", domain="translational")
    m.add(drive=hb.Se(f"{PUSH}*sin({OMEGA}*time)"))
    for k in range(1, blocks + 1):
        m.add(
            **{
                f"v{k}": hb.One(law="coulomb", limit=RUB),
                f"m{k}": hb.I(1.0),
                f"d{k}": hb.Zero(),
                f"link{k}": hb.One(),
                f"k{k}": hb.C(1.0 / STIFF),
                f"b{k}": hb.R(DAMPED),
            }
        )
        m.bond(f"v{k} -> m{k}", f"v{k} -> d{k}", f"d{k} -> link{k} -> k{k}", f"link{k} -> b{k}")
        if k > 1:
            m.bond(f"d{k} -> v{k - 1}")
    m.bond(f"drive -> v{blocks}")
    return m


def _problem(
    key: str, title: str, program: str, accuracy: tuple[float, float], full: bool, **options: Any
) -> Problem:
    """Return a problem that a limit program does at an accuracy; the second is that of the truth.

    What it finds are the stretches of the last and of the middle spring.
    """
    longest = (FULL if full else LENGTHS)[1]

    def limit(end: float, fine: float = accuracy[0]) -> Outcome | None:
        run = in_c(program, BLOCKS, end, fine, points(end, longest))
        return run and Outcome(run.seconds, run.found[1:], int(run.found[0]))

    def true(end: float) -> tuple[float, ...]:
        run = limit(end, accuracy[1])
        return run.found if run else (float("nan"),) * 2

    def ours(end: float) -> Outcome:
        return in_hybond(
            model(BLOCKS),
            end,
            points(end, longest),
            [f"k{BLOCKS}.q", f"v{BLOCKS}.f"],
            lambda run: (run.final[f"k{BLOCKS}.q"], run.final[f"k{BLOCKS // 2 + 1}.q"]),
            **options,
        )

    tools: dict[str, Tool] = {C: limit, "hybond": ours}
    return Problem(key, title, "second", LENGTHS, FULL, tools, true)


def located(full: bool) -> Problem:
    """Return the problem with events located."""
    title = f"{BLOCKS} blocks in a row with dry friction"
    return _problem("P10", title, "friction", (RTOL, 1e-11), full, rtol=RTOL)


def stepped(full: bool) -> Problem:
    """Return the problem in the fixed steps of Moreau and Jean; it is true to the same steps."""
    title = f"the same in steps of {STEP * 1e3:g} ms"
    options: dict[str, Any] = {"solver": "moreau-jean", "step": STEP, "theta": 1.0}
    return _problem("P11", title, "stepped", (STEP, STEP), full, **options)
