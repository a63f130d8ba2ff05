"""P14: a thousand machines in ten thousand elements; `benchmarks/size.py` measures its memory."""

from __future__ import annotations

from measuring.ours import in_hybond
from measuring.problem import C, Outcome, Problem, points
from measuring.programs import in_c

import hybond as hb

CELLS, RTOL = 1000, 1e-8
CHARGE, DRAIN, LOAD, TIE, LOW = 1.0, 20.0, 0.1, 0.1, 0.3
"""Conductances, S, and the lower level, V."""
LENGTHS = FULL = (1.2, 1.4)


def high(cell: int, cells: int) -> float:
    """Return the voltage at which a cell, from 1, is discharged."""
    return 0.6 + 0.2 * cell / cells


def model(cells: int) -> hb.Model:
    """Return the row: ten elements and a machine a cell."""
    m = hb.Model("cells", domain="electrical")
    for k in range(1, cells + 1):
        m.add(
            **{
                f"V{k}": hb.Se(1.0),
                f"charge{k}": hb.One(),
                f"r{k}": hb.R(1.0 / CHARGE),
                f"n{k}": hb.Zero(),
                f"c{k}": hb.C(1.0),
                f"load{k}": hb.R(1.0 / LOAD),
                f"drain{k}": hb.One(),
                f"s{k}": hb.R(1.0 / DRAIN),
            }
        )
        m.bond(f"V{k} -> charge{k} -> n{k} -> c{k}", f"charge{k} -> r{k}", f"n{k} -> load{k}")
        m.bond(f"n{k} -> drain{k} -> s{k}")
        if k > 1:
            m.add(**{f"tie{k}": hb.One(), f"t{k}": hb.R(1.0 / TIE)})
            m.bond(f"n{k - 1} -> tie{k} -> n{k}", f"tie{k} -> t{k}")
        m.machine(
            f"S{k}",
            states={"fills": [], "drains": [f"drain{k}"]},
            start="fills",
            rules=[
                f"fills -> drains when n{k}.e >= {high(k, cells)}",
                f"drains -> fills when n{k}.e <= {LOW}",
            ],
        )
    return m


def problem(full: bool) -> Problem:
    """Return the problem: what it finds are the voltages of the first and of the last cell."""
    longest = LENGTHS[1]

    def limit(end: float, rtol: float = RTOL) -> Outcome | None:
        run = in_c("cells", CELLS, end, rtol, points(end, longest))
        return run and Outcome(run.seconds, run.found[1:], int(run.found[0]))

    def true(end: float) -> tuple[float, ...]:
        run = limit(end, 1e-12)
        return run.found if run else (float("nan"),) * 2

    def ours(end: float) -> Outcome:
        return in_hybond(
            model(CELLS),
            end,
            points(end, longest),
            ["n1.e", f"n{CELLS}.e"],
            lambda run: (float(run["n1.e"].at(end)), float(run[f"n{CELLS}.e"].at(end))),
            rtol=RTOL,
        )

    return Problem(
        "P14",
        f"{CELLS:,} machines in {10 * CELLS:,} elements",
        "second",
        LENGTHS,
        FULL,
        {C: limit, "hybond": ours},
        true,
        "from the 1.2nd second on, in which the machines begin to switch.",
    )
