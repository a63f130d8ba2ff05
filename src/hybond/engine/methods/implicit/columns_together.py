"""Slopes by differences of many states at once: of those that act on no rate together.

What each rate hangs on is told from the graph (`mode/rows/acting`). A group of states is shifted at
once, and each difference of a rate is put to the one state of them that acts on it. Where there are
no rates then, as where laws end, its states are left to be shifted one by one.
"""

from __future__ import annotations

from hybond.engine.algebra.twofold import product_rest, sum_rest
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.implicit.beside_kinks import is_beyond
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.methods.implicit.radau_stages import rate_at
from hybond.engine.mode.rows.acting import acting_of
from hybond.engine.mode.rows.acting_records import Acting
from hybond.engine.words import Floats


def take_together(
    e: Engine,
    r: Radau,
    t: float,
    base: Floats,
    at: int,
    rates: Floats,
    closely: bool,
    one_side: bool,
) -> None:
    """Put the slopes at a state into the Jacobian that are found so, as `r.together` says then.

    The state stands in `base` from `at` on, and in ``r.shifted``; the rates there in `rates`, from
    `at` on. Each state is shifted by ``r.delta``, or not at all where that is zero. What is shifted
    beyond a kink is left out if slopes are to be those of `one_side`.
    """
    n = r.n
    for j in range(n):
        r.together[j] = 0
    if e.slide.k > 0:
        return
    a = acting_of(e.model, e.mode, r.acting_room)
    for g in range(a.groups):
        some = False
        for j in range(n):
            if a.group.at[j] == g and r.delta[j] != 0.0:
                r.shifted[j] = base[at + j] + r.delta[j]
                some = True
        found = some and rate_at(e, n, t, r.shifted, r.end) == OK
        if found and one_side and is_beyond(e, r):
            found = False
        for j in range(n):
            if a.group.at[j] == g:
                if found and r.delta[j] != 0.0:
                    put_column(e, r, a, j, r.shifted[j] - base[at + j], at, rates, closely)
                    r.together[j] = 1
                r.shifted[j] = base[at + j]


def put_column(
    e: Engine, r: Radau, a: Acting, j: int, width: float, at: int, rates: Floats, closely: bool
) -> None:
    """Put what a state that was shifted by so much has changed of the rates that it acts on."""
    n = r.n
    for i in range(n):
        put_slope(r, i * n + j, 0.0, 0.0, 1.0, closely)
    for p in range(a.first.at[j], a.first.at[j + 1]):
        i = a.rate.at[p]
        change = r.end[i] - rates[at + i]
        rest = 0.0
        if closely:
            rest = sum_rest(r.end[i], -rates[at + i], change) + (e.rate_rest[i] - r.f0_rest[i])
        put_slope(r, i * n + j, change, rest, width, closely)


def put_slope(r: Radau, at: int, change: float, rest: float, width: float, closely: bool) -> None:
    """Put what a rate changes by, over a width, into the Jacobian; `closely` with its rest."""
    r.jacobian[at] = change / width
    if not closely:
        return
    slope = r.jacobian[at]
    product = slope * width
    left = ((change - product) - product_rest(slope, width, product) + rest) / width
    r.jacobian[at] = slope + left
    r.jacobian_rest.at[at] = sum_rest(slope, left, r.jacobian[at])
