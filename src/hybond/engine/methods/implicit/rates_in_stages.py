"""What rates may be off by in a step of Radau IIA that is far longer than what exchanges in it.

Stages are where their equations are left open by a part of the tolerance of states. What exchanges
fast makes as much more of that as the step is longer: so it is measured by the rates that it leaves
open as well. Beside great flows a small one that they leave need not be so right: rates are
measured by what is beside them at a junction, too.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.implicit.radau_factors import BUTCHER_INVERSE
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.methods.linear.rates_off import FROM_ROUNDING
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.mode.rows.storage_bonds import rate_bond
from hybond.engine.mode.solving import solve
from hybond.engine.surfaces.values import set_state

IN_STAGES: Final = 25.0
"""What rates times a step may be off by, in what states may be: over a step that led through the
motion once between its stages the rates that are read bring another sum than the step itself, and
the energy that this makes of a run is to be as right as its states."""
OF_TIME: Final = 4.0 * EPSILON
"""Part of the time that it is rounded by where a source is asked: what follows that moves on."""
LEFT: Final = 0.5
"""Part of what was beside a rate that is left of it a step later: where all pass zero together they
are measured by what they were, and what was let in at first is forgotten soon."""


def ask_rates_too(e: Engine, r: Radau) -> None:
    """Find what rates of storages may be off by over the step that is tried.

    Where slopes have no bound, at edges of laws and where they begin or end, none are asked: what
    an error makes of rates there is not what it is a moment later.
    """
    m = e.model
    n = r.n
    r.rates_asked = False
    for i in range(n):
        r.rate_may[i] = math.inf
        r.bent[i] = 0.0
    if m.edges > 0 or m.begins > 0 or m.bends > 0.0 or e.slide.k > 0:
        return
    for i in range(m.storages):
        if not r.tolerance[i] > 0.0:
            continue
        off = 0.0
        terms = 0.0
        moved = 0.0
        for j in range(n):
            slope = math.fabs(r.jacobian[i * n + j])
            off += slope * r.tolerance[j]
            terms += slope * max(math.fabs(r.y0[j]), e.lately[j])
            moved += slope * math.fabs(r.f0[j])
        if r.h * off > IN_STAGES * r.tolerance[i]:
            rounding = max(FROM_ROUNDING * terms, OF_TIME * math.fabs(r.t0) * moved)
            r.rate_may[i] = max(IN_STAGES * r.tolerance[i], r.h * rounding)
            r.rates_asked = True
    if not r.rates_asked:
        return
    if not r.beside_known:
        see_beside(e, r)
        r.beside_known = True
    for i in range(m.storages):
        if r.rate_may[i] < math.inf:
            at = rate_bond(m, i)
            size = r.beside.at[e.mode.same[at]]
            r.rate_may[i] = max(r.rate_may[i], r.h * IN_STAGES * m.rtol * size)


def see_beside(e: Engine, r: Radau) -> None:
    """Find how large what is beside each bond variable is where the step begins, or lately was."""
    m = e.model
    fit(r.beside, 2 * m.bonds)
    size = r.beside.at
    for k in range(2 * m.bonds):
        size[k] *= LEFT
    refusal = e.refusal
    hold_guess(e, e.mode)
    set_state(e, e.mode, e.v, r.t0, r.y0)
    found = solve(e, e.mode, e.v) == OK
    give_back_guess(e, e.mode)
    e.refusal = refusal
    for j in range(m.junctions if found else 0):
        for kind in range(2):
            most = 0.0
            for i in range(m.end_first[j], m.end_first[j + 1]):
                most = max(most, math.fabs(e.work.w[kind * m.bonds + m.end_bond[i]]))
            for i in range(m.end_first[j], m.end_first[j + 1]):
                at = e.mode.same[kind * m.bonds + m.end_bond[i]]
                size[at] = max(size[at], most)


def rates_left(r: Radau) -> float:
    """Return the largest rate that the stages leave open, in what it may be; 0: none is asked."""
    n = r.n
    most = 0.0
    for i in range(n if r.rates_asked else 0):
        if not r.rate_may[i] < math.inf:
            continue
        for s in range(3):
            moved = 0.0
            for j in range(3):
                moved += BUTCHER_INVERSE[3 * s + j] * r.z[j * n + i]
            most = max(most, math.fabs(r.h * r.f[s * n + i] - moved) / r.rate_may[i])
    return most
