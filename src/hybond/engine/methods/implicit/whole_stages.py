"""All stages of a step as one system, of all states or of a part that is joined.

Each stage has slopes of its own, by differences. What nothing joins to the states in question is
left out: a part among many is solved for as if it were alone.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.algebra.products import copy_part
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.implicit.columns_together import take_together
from hybond.engine.methods.implicit.radau_factors import BUTCHER_INVERSE
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.methods.implicit.radau_stages import rate_at, stage_time
from hybond.engine.methods.implicit.whole_factors import factor_whole, solve_by_whole
from hybond.engine.methods.tolerances.scale import tolerance
from hybond.engine.words import Floats

NEAR: Final = 1e-3
"""Part of what a state has moved by that a slope is a difference over, at most, ..."""
LAST: Final = 64.0 * 2.220446049250313e-16
"""... and part of the state, at least."""


def take_all(r: Radau) -> None:
    """Let the system be that of all states."""
    fit_places(r.part, r.n)
    for i in range(r.n):
        r.part.at[i] = i
    r.parts = r.n


def join(r: Radau) -> None:
    """Add to the part what slopes join to it, in either direction, and to that."""
    n = r.n
    for i in range(n):
        r.taken[i] = 0
    for k in range(r.parts):
        r.taken[r.part.at[k]] = 1
    k = 0
    while k < r.parts:
        i = r.part.at[k]
        for j in range(n):
            if r.taken[j] == 0 and (r.jacobian[i * n + j] != 0.0 or r.jacobian[j * n + i] != 0.0):
                r.taken[j] = 1
                r.part.at[r.parts] = j
                r.parts += 1
        k += 1


def fit_whole(r: Radau) -> None:
    """Make room for the system."""
    many = 3 * r.parts
    fit(r.stage_slopes, many * r.parts)
    fit(r.left_over, many)
    fit_places(r.whole_row, many)
    fit(r.kept, 3 * r.n)


def solve_whole(e: Engine, r: Radau, rtol: float, shift: float) -> bool:
    """Put the correction of all stages into ``r.left_over``; False where slopes are singular.

    Slopes are over a part of each state. Those of the last stage stay as the Jacobian.
    """
    n = r.n
    p = r.parts
    copy_part(n, r.y, 2 * n, r.stage, 0)
    tolerance(e, r.y0, r.stage, r.other)
    for s in range(3):
        slopes_of(e, r, s, rtol, shift)
        for a in range(p):
            row = r.part.at[a] * n
            for b in range(p):
                r.stage_slopes.at[(s * p + a) * p + b] = r.jacobian[row + r.part.at[b]]
    put_left(r, r.left_over.at)
    if not factor_whole(r):
        return False
    solve_by_whole(r, r.left_over.at)
    return True


def put_left(r: Radau, out: Floats) -> None:
    """Put what is left of the equations of all stages there."""
    n = r.n
    for s in range(3):
        for a in range(r.parts):
            i = r.part.at[a]
            total = r.f[s * n + i]
            for j in range(3):
                total -= BUTCHER_INVERSE[3 * s + j] / r.h * r.z[j * n + i]
            out[s * r.parts + a] = total


def slopes_of(e: Engine, r: Radau, s: int, rtol: float, shift: float) -> None:
    """Put the slopes of rates at a stage into the Jacobian, by differences on either side."""
    n = r.n
    r.twofold_from = math.inf
    t = stage_time(r, s)
    copy_part(n, r.y, s * n, r.shifted, 0)
    for j in range(n):
        r.delta[j] = 0.0
    for a in range(r.parts):
        j = r.part.at[a]
        here = r.shifted[j]
        delta = shift * (math.fabs(here) if here != 0.0 else r.other[j] / rtol)
        moved = math.fabs(r.z[s * n + j])
        if moved > 0.0:
            # an edge that is not at zero is as far as the state has moved from there
            delta = min(delta, max(NEAR * moved, LAST * math.fabs(here)))
        r.delta[j] = delta
    take_together(e, r, t, r.y, s * n, r.f, False, False)
    for a in range(r.parts):
        if r.together[r.part.at[a]] == 0:
            take_alone_at(e, r, s, r.part.at[a])


def take_alone_at(e: Engine, r: Radau, s: int, j: int) -> None:
    """Put the slopes by one state at a stage into the Jacobian, with nothing else shifted."""
    n = r.n
    t = stage_time(r, s)
    here = r.shifted[j]
    found = r.delta[j] > 0.0
    if found:
        r.shifted[j] = here + r.delta[j]
        found = rate_at(e, n, t, r.shifted, r.end) == OK
        if not found:
            r.shifted[j] = here - r.delta[j]
            found = rate_at(e, n, t, r.shifted, r.end) == OK
    width = r.shifted[j] - here
    for i in range(n):
        change = r.end[i] - r.f[s * n + i] if found and width != 0.0 else 0.0
        r.jacobian[i * n + j] = change / width if change != 0.0 else 0.0
    r.shifted[j] = here
