"""Differences that are short beside how far what laws take the root of is from nothing.

An orifice between two volumes of oil lets pass what comes with a part in 1e8 of either pressure
between them. By the usual difference, the root of a unit in the last place of a pressure, that is
shifted far beyond nothing: its slope is that of a chord, by which no stages converge, and steps
would be as short as the settling.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, row_times
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.methods.explicit.one_instant import show_motion
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.mode.digits.sizes import sizes_of
from hybond.engine.mode.nonlinear.newton import knowns_of
from hybond.engine.mode.nonlinear.newton_system import is_given
from hybond.engine.surfaces.values import set_motion
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
    known = note_acting(e, r)
    for j in range(n):
        r.next_one.at[j] = 1.0
        if r.delta[j] == 0.0 or r.together[j] == 0:
            continue
        r.shifted[j] = r.y0[j] + r.delta[j]
        if show_near(e, r, known):
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


def show_near(e: Engine, r: Radau, known: bool) -> bool:
    """Show what is under roots that are near at ``r.shifted``, where it is `known` that alone."""
    if not known:
        return show_motion(e, r.t0, r.shifted)
    m = e.model
    set_motion(e, e.v, r.t0, r.shifted)
    knowns_of(e, e.mode, e.v, False)
    for k in range(m.begins):
        if is_near(r.roots.at, m.begins, k):
            b = m.begin_bond[k]
            e.v[m.bond_slot + b] = row_times(e.mode.finite, e.mode.same[b], e.work.xi)
    return True


def note_acting(e: Engine, r: Radau) -> bool:
    """Note which states what is under a root that is near hangs on, into ``r.together``.

    False if that is not what is stored alone: then all may.
    """
    m = e.model
    for j in range(r.n):
        r.together[j] = 0
    known = True
    for k in range(m.begins):
        if known and is_near(r.roots.at, m.begins, k):
            known = m.begin_bond[k] >= 0 and note_stored(e, r, m.begin_bond[k])
    for j in range(r.n if not known else 0):
        r.together[j] = 1
    return known


def note_stored(e: Engine, r: Radau, bond: int) -> bool:
    """Note what a bond variable hangs on; False if that is not what is stored alone."""
    m = e.model
    mode = e.mode
    if not is_given(mode, bond):
        return False
    rows = mode.finite
    same = mode.same[bond]
    for p in range(rows.first.at[same], rows.first.at[same + 1]):
        known = rows.column.at[p]
        if known < m.storages:
            for q in range(m.stiff_first[known], m.stiff_first[known + 1]):
                r.together[m.stiff_other[q]] = 1
        elif known >= m.storages + mode.sources:
            return False
        else:
            source = mode.source[known - m.storages]
            if source >= 0 and m.source_value[source] >= 0:
                return False
    return True


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
