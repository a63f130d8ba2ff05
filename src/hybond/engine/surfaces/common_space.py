"""What modes with different constraints hold stored quantities to, all together.

Each mode is kept to the constraints of all by vanishing impulses: the mean of infinitely many
jumps.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, row_size, row_times
from hybond.engine.algebra.products import copy_part, times_matrix
from hybond.engine.algebra.svd import pseudo_inverse, rank_above, svd
from hybond.engine.answers import value
from hybond.engine.constraints.impulse_ways import impulse_directions
from hybond.engine.engine import Engine, svd_room
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.newton import knowns_of
from hybond.engine.mode.rows.storage import stiff
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.surfaces.law_means import find_reached
from hybond.engine.surfaces.surface import part_mode
from hybond.engine.words import Floats, some

REPEATS: Final = 1e-10
"""An impulse that moves what is stored by less than this part of the strongest repeats others."""
ROUNDING: Final = 1e-13
"""A constraint that drifts by less than this part of its terms is kept already."""
REPEATED: Final = 1e-12
"""Constraints of several modes may repeat each other."""
KEEPABLE: Final = 1e-9
"""Impulses can keep all constraints if they leave less than this part of the drift's terms."""
ALONE: Final = 0
TOGETHER: Final = 1
NEVER: Final = 2
"""Modes with the same constraints, with others that are kept together, or that cannot be."""


def holds_the_same(e: Engine, a: Mode, b: Mode) -> bool:
    """Whether two modes hold stored quantities to the same constraints."""
    if a.rank - a.structures != b.rank - b.structures or a.constraints.rows != b.constraints.rows:
        return False
    for i in range(a.constraints.rows):
        found = False
        for j in range(b.constraints.rows):
            found = found or is_same_row(e, a, i, b, j)
        if not found:
            return False
    return True


def is_same_row(e: Engine, a: Mode, i: int, b: Mode, j: int) -> bool:
    """Whether two constraints are the same, sources left out."""
    for k in range(e.model.storages):
        if coefficient(a, i, k) != coefficient(b, j, k):
            return False
    return True


def coefficient(a: Mode, i: int, k: int) -> float:
    """Return the coefficient of a co-energy variable in a constraint."""
    for p in range(a.constraints.first.at[i], a.constraints.first.at[i + 1]):
        if a.constraints.column.at[p] == k:
            return a.constraints.value.at[p]
    return 0.0


def find_common(e: Engine) -> int:
    """Find what all parts of the combination hold together: ALONE, TOGETHER or NEVER."""
    m = e.model
    s = e.slide
    n = 2 * m.bonds
    s.common = False
    same = True
    for k in range(1, s.parts):
        same = same and holds_the_same(e, part_mode(e, 0), part_mode(e, k))
    if same:
        return ALONE
    s.holders = 0
    s.held = 0
    for k in range(s.parts):
        mode = part_mode(e, k)
        if not is_plain(e, mode):
            return NEVER
        known = mode.constraints.rows == 0
        for h in range(s.holders):
            known = known or holds_the_same(e, some(e.modes[s.holder[h]]), mode)
        if not known:
            s.holder[s.holders] = s.part[k]
            s.holders += 1
            s.held += mode.constraints.rows
    # the impulses of all holders, side by side
    many = 0
    for h in range(s.holders):
        mode = some(e.modes[s.holder[h]])
        for i in range(2 * m.slots):
            e.work.generic[i] = 0.0
        impulse_directions(e, mode, e.work.generic, mode.ways)
        many += mode.ways.many
    fit(e.work.onto, n * many)
    first = 0
    for h in range(s.holders):
        own = some(e.modes[s.holder[h]]).ways
        for i in range(n):
            copy_part(own.many, own.directions.at, i * own.many, e.work.onto.at, i * many + first)
        first += own.many
    fit(s.moves, m.storages * many)
    put_moves(e, many, e.work.onto.at, s.moves.at)
    d = svd_room(e, max(m.storages, many), max(m.storages, many))
    svd(d, m.storages, many, s.moves.at)
    rank = rank_above(d, many, REPEATS * max(d.s[0] if many > 0 else 0.0, 1e-300))
    s.areas = min(rank, m.storages)
    fit(e.work.c, many * max(s.areas, 1))
    for j in range(s.areas):
        for i in range(many):
            e.work.c.at[i * s.areas + j] = d.v[j * many + i]
    fit(s.directions, n * s.areas)
    times_matrix(n, many, s.areas, e.work.onto.at, e.work.c.at, s.directions.at)
    put_moves(e, s.areas, s.directions.at, s.moves.at)
    fit(s.off, s.held)
    fit(s.off_size, s.held)
    fit(s.slope, s.held * s.areas)
    fit(s.inverse, s.held * s.areas)
    fit(s.area_size, s.areas)
    s.common = True
    find_reached(e)
    return TOGETHER


def is_plain(e: Engine, mode: Mode) -> bool:
    """Whether the constraints of a mode are linear with constant coefficients."""
    m = e.model
    if mode.structures > 0:
        return False
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d >= 0 and m.dynamic_free[d] == m.dynamic_free[d + 1]:
            return False
    return True


def put_moves(e: Engine, many: int, directions: Floats, moves: Floats) -> None:
    """Put what impulses do to stored quantities there."""
    m = e.model
    for k in range(m.storages):
        at = rate_bond(m, k)
        sign = way_of_rate(m, k)
        for j in range(many):
            moves[k * many + j] = sign * directions[at * many + j]


def stiff_times(e: Engine, v: Floats, rates: Floats, out: Floats) -> None:
    """Put the rates of co-energy variables there."""
    m = e.model
    for k in range(m.storages):
        total = 0.0
        for i in range(m.stiff_first[k], m.stiff_first[k + 1]):
            total += stiff(m, i, v) * rates[m.stiff_other[i]]
        out[k] = total


def find_inverse(e: Engine, v: Floats) -> None:
    """Find the areas that a unit of each residual asks for, into `e.slide.inverse`."""
    m = e.model
    s = e.slide
    for a in range(s.areas):
        for k in range(m.storages):
            s.x[k] = s.moves.at[k * s.areas + a]
        stiff_times(e, v, s.x, s.rates2)
        at = 0
        for h in range(s.holders):
            rows = some(e.modes[s.holder[h]]).constraints
            for i in range(rows.rows):
                total = 0.0
                for p in range(rows.first.at[i], rows.first.at[i + 1]):
                    if rows.column.at[p] < m.storages:
                        total += rows.value.at[p] * s.rates2[rows.column.at[p]]
                s.slope.at[at * s.areas + a] = total
                at += 1
    d = svd_room(e, max(s.held, s.areas), max(s.held, s.areas))
    pseudo_inverse(d, s.held, s.areas, s.slope.at, REPEATED, s.inverse.at)


def find_drift(e: Engine, v: Floats, rates: Floats) -> None:
    """Put the rates of the constraints' residuals into `off`, the size of their terms beside."""
    m = e.model
    s = e.slide
    stiff_times(e, v, rates, s.rates2)
    at = 0
    for h in range(s.holders):
        mode = some(e.modes[s.holder[h]])
        for i in range(mode.constraints.rows):
            total = 0.0
            size = 0.0
            for p in range(mode.constraints.first.at[i], mode.constraints.first.at[i + 1]):
                k = mode.constraints.column.at[p]
                known = 0.0
                if k < m.storages:
                    known = s.rates2[k]
                elif mode.rated[k - m.storages] != 0:
                    known = value(m, m.source_rate[mode.source[k - m.storages]], v)
                total += mode.constraints.value.at[p] * known
                size += math.fabs(mode.constraints.value.at[p]) * math.fabs(known)
            s.off.at[at] = total
            s.off_size.at[at] = size
            at += 1


def keep_to_all(e: Engine, v: Floats, w: Floats, rates: Floats) -> None:
    """Change the bond variables and rates of a mode such that all constraints are kept."""
    m = e.model
    s = e.slide
    find_drift(e, v, rates)
    still = True
    for i in range(s.held):
        if math.fabs(s.off.at[i]) <= ROUNDING * s.off_size.at[i]:
            s.off.at[i] = 0.0
        still = still and s.off.at[i] == 0.0
    if still:
        return
    find_inverse(e, v)
    for a in range(s.areas):
        area = 0.0
        size = 0.0
        for i in range(s.held):
            area -= s.inverse.at[a * s.held + i] * s.off.at[i]
            size += math.fabs(s.inverse.at[a * s.held + i]) * s.off_size.at[i]
        s.area_size.at[a] = max(s.area_size.at[a], size)
        for k in range(2 * m.bonds):
            w[k] += s.directions.at[k * s.areas + a] * area
        for k in range(m.storages):
            rates[k] += s.moves.at[k * s.areas + a] * area


def can_keep(e: Engine, v: Floats, rates: Floats) -> bool:
    """Whether impulses can keep what the field of a mode leads off."""
    s = e.slide
    find_inverse(e, v)
    find_drift(e, v, rates)
    most = 0.0
    for i in range(s.held):
        most = max(most, s.off_size.at[i])
    for i in range(s.held):
        rest = s.off.at[i]
        for a in range(s.areas):
            area = 0.0
            for j in range(s.held):
                area += s.inverse.at[a * s.held + j] * s.off.at[j]
            rest -= s.slope.at[i * s.areas + a] * area
        if not math.fabs(rest) <= KEEPABLE * most:
            return False
    return True


def find_correction(e: Engine, v: Floats) -> None:
    """Find the areas by which the state in `v` is off the constraints, into ``e.slide.area``."""
    s = e.slide
    find_inverse(e, v)
    at = 0
    for h in range(s.holders):
        mode = some(e.modes[s.holder[h]])
        knowns_of(e, mode, v, False)
        for i in range(mode.constraints.rows):
            s.off.at[at] = row_times(mode.constraints, i, e.work.xi)
            s.off_size.at[at] = row_size(mode.constraints, i, e.work.xi)
            at += 1
    fit(s.area, s.areas)
    for a in range(s.areas):
        area = 0.0
        for i in range(s.held):
            area += s.inverse.at[a * s.held + i] * s.off.at[i]
        s.area.at[a] = area


def onto_all(e: Engine, v: Floats, x: Floats) -> None:
    """Put stored quantities, those in `v`, back where all constraints are met, into `x`."""
    s = e.slide
    find_correction(e, v)
    for a in range(s.areas):
        for k in range(e.model.storages):
            x[k] -= s.moves.at[k * s.areas + a] * s.area.at[a]
