"""Differences that are short beside how far what laws take the root of is from nothing.

An orifice between two volumes of oil lets pass what comes with a part in 1e8 of either pressure
between them. By the usual difference, the root of a unit in the last place of a pressure, that is
shifted far beyond nothing: its slope is that of a chord, by which no stages converge, and steps
would be as short as the settling.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.methods.explicit.one_instant import show_motion
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.mode.digits.sizes import sizes_of
from hybond.engine.mode.nonlinear.newton_system import is_given
from hybond.engine.words import Floats

NEAR: Final = 2.0**-20
"""Part of its terms that a root's argument is at most where usual differences may be too long."""
PART: Final = 2.0**-6
"""Part of the argument by which a difference shifts it: there a root is straight in 0.4 %, ..."""
ROUNDED: Final = 64.0 * EPSILON
"""... and part of its terms that it is shifted by at least: what rounding says is less."""


def shorten_near_roots(e: Engine, r: Radau) -> None:
    """Let ``r.delta`` be shorter where it shifts the argument of a root by more than a part of it.

    Arguments and what they are rounded to are those where the step begins.
    """
    m = e.model
    n = r.n
    if m.begins == 0 or e.slide.k > 0 or not some_near(e, r):
        return
    fit(r.next_one, n)
    for j in range(n):
        r.next_one.at[j] = 1.0
        if r.delta[j] == 0.0:
            continue
        r.shifted[j] = r.y0[j] + r.delta[j]
        if show_motion(e, r.t0, r.shifted):
            r.next_one.at[j] = part_within(e, r.roots.at)
        r.shifted[j] = r.y0[j]
    for j in range(n):
        # what is next to nothing beside the state itself does not shift it
        least = min(ROUNDED * math.fabs(r.y0[j]), math.fabs(r.delta[j]))
        short = max(r.next_one.at[j] * math.fabs(r.delta[j]), least)
        r.delta[j] = math.copysign(short, r.delta[j])


def some_near(e: Engine, r: Radau) -> bool:
    """See where the arguments of roots are, and whether one is next to nothing but not nothing."""
    m = e.model
    many = m.begins
    if not show_motion(e, r.t0, r.y0):
        return False
    fit(r.roots, 2 * many)
    roots = r.roots.at
    for k in range(many):
        roots[k] = math.inf if takes_no_root(e, k) else value(m, m.edge_value[k], e.v)
    sizes_of(e, e.mode, e.v)
    for i in range(m.edge_bonds):
        e.v[m.bond_slot + m.edge_bond[i]] = e.work.sizes[m.edge_bond[i]]
    some = False
    for k in range(many):
        roots[many + k] = value(m, m.edge_size[k], e.v)
        some = some or is_near(roots, many, k)
    return some


def takes_no_root(e: Engine, k: int) -> bool:
    """Whether what is under root k is a power that no law is solved for."""
    m = e.model
    bond = m.begin_bond[k]
    return k >= m.rooted and bond >= 0 and not is_given(e.mode, bond)


def is_near(roots: Floats, many: int, k: int) -> bool:
    """Whether the argument of a root is next to nothing beside its terms, but not nothing."""
    here = math.fabs(roots[k])
    return here > 0.0 and here < NEAR * roots[many + k]


def part_within(e: Engine, roots: Floats) -> float:
    """Return the part of a difference, just shown, that shifts all arguments by little enough."""
    m = e.model
    many = m.begins
    part = 1.0
    for k in range(many):
        if not is_near(roots, many, k):
            continue
        moved = math.fabs(value(m, m.edge_value[k], e.v) - roots[k])
        most = max(PART * math.fabs(roots[k]), ROUNDED * roots[many + k])
        if moved > most:
            part = min(part, most / moved)
    return part
