"""Whether the laws of a mode may have several solutions.

A law that is alone with its unknown has one if what is left of it has slopes of one sign, whatever
it reads. Of laws that hang together that is told by the signs of their slopes (`one_root`), or else
by whether each of them, a law of one bond, resists. Ranges tell a sign, or else
slopes at numbers of all sizes.
Laws that jump, and those that hide constraints, are not asked: they are as if they had one.
"""

from __future__ import annotations

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import copy_part
from hybond.engine.engine import Engine
from hybond.engine.method_numbers import MOREAU, QSS1
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.followed_records import MAY, NEVER, UNKNOWN
from hybond.engine.mode.nonlinear.one_root import (
    has_one_root,
    sign_by_sizes,
    sign_of_slope,
)
from hybond.engine.words import Floats


def may_have_several(e: Engine, mode: Mode) -> bool:
    """Whether the laws of a mode may have several solutions, of which one has to be followed."""
    b = mode.branch
    if b.several == UNKNOWN:
        b.several = NEVER
        if is_followed(e, mode):
            if is_single(e, mode):
                b.others = NEVER
            else:
                b.several = MAY
    return b.several == MAY


def is_followed(e: Engine, mode: Mode) -> bool:
    """Whether solutions of a mode are of the kind that can be followed."""
    m = e.model
    if mode.dynamics == 0 or mode.affine or mode.opened or mode.rank != mode.structures:
        return False
    if m.method == MOREAU or m.method >= QSS1 or mode.dynamics != mode.finite_frees:
        return False
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d < 0 or m.dynamic_breaks[d] != 0:
            return False
    return True


def is_single(e: Engine, mode: Mode) -> bool:
    """Whether laws resist, each for itself, or nothing turns in each that is alone."""
    a = mode.apart
    if a.groups == 0:
        return False
    fit(e.work.following.values, 2 * e.model.slots)
    v = e.work.following.values.at
    copy_part(2 * e.model.slots, e.v, 0, v, 0)
    for g in range(a.groups):
        if not is_group_single(e, mode, g, v):
            return False
    return True


def is_group_single(e: Engine, mode: Mode, g: int, v: Floats) -> bool:
    """Whether that is so in one group of laws, none of which jumps."""
    begin = mode.apart.begins.at[g]
    end = mode.apart.begins.at[g + 1]
    # the first is cheaper by far
    return resist(e, mode, begin, end, v) or has_one_root(e, mode, begin, end, v)


def resist(e: Engine, mode: Mode, begin: int, end: int, v: Floats) -> bool:
    """Whether laws of one group resist, each for itself, or the one alone does not turn."""
    a = mode.apart
    for q in range(begin, end):
        if not keeps_sign(e, mode, a.row.at[q], a.unknown.at[q] if end == begin + 1 else -1, v):
            return False
    return True


def keeps_sign(e: Engine, mode: Mode, i: int, j: int, v: Floats) -> bool:
    """Whether row i, a law of one bond, has slopes of one sign by unknown j; if -1, resists."""
    m = e.model
    d = mode.dynamic[i]
    partner = m.dynamic_partner[d]
    if partner < 0:
        return False
    for p in range(m.slope_first[d], m.slope_first[d + 1]):
        k = m.slope_column[p]
        if k != partner and (m.slope_value[p] >= 0 or k % m.bonds != partner % m.bonds):
            return False
    above = False
    below = False
    told = True
    for p in range(m.slope_first[d], m.slope_first[d + 1]):
        k = m.slope_column[p]
        share = m.dynamic_way[d] if j < 0 else mode.finite_free.at[k * mode.finite_frees + j]
        if share == 0.0 or (j < 0 and k != partner):
            continue
        constant = m.slope_value[p] < 0
        sign = m.slope_constant[p] if constant else sign_of_slope(e, mode, d, p, v)
        told = told and (constant or sign != 0.0)
        above = above or sign * share > 0.0
        below = below or sign * share < 0.0
    if told and (j < 0 or not (above and below)):
        return j >= 0 or not above
    sign = sign_by_sizes(e, mode, d, j, v)
    return sign != 0.0 if j >= 0 else sign < 0.0
