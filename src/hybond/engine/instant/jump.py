"""Entering a mode: the jump that conserves state.

    x+ = x + D nu,   nu such that   G z(x+) = c

`D` spans the rates that impulses allowed by the power structure can make. `G z = c` are the
constraints of the power structure and the sources at the right limit. The areas `nu` sent through
the junction structure are the impulses of every bond.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places, row_size, row_times
from hybond.engine.algebra.products import largest, times_matrix
from hybond.engine.algebra.qr import complement
from hybond.engine.algebra.svd import (
    least_squares,
    null_space,
    pseudo_inverse,
    rank_above,
    svd,
)
from hybond.engine.engine import (
    OK,
    REFUSED,
    Engine,
    Mode,
    Ways,
    say_fault,
    svd_room,
)
from hybond.engine.mode.dynamic_rows import frozen_at
from hybond.engine.mode.leakage import least_leakage, project
from hybond.engine.mode.newton import knowns_of
from hybond.engine.mode.newton_system import split
from hybond.engine.mode.storage import coupled, own_stiffness, reach_of, stiff, with_stored
from hybond.engine.model import node_name, value
from hybond.engine.reasons.facts import disagree, refuse_jump
from hybond.engine.words import Floats

TINY: Final = 2.2250738585072014e-296
"""A term is not smaller than this: the last bit of what is denormal is no small part of it."""
CONSISTENT: Final = 1e-12
"""A constraint is met if its residual is below this part of its terms."""
BEST: Final = 1e-14
AGREE: Final = 1e-9
"""Contradicting sources agree if they differ by less than this part of their values."""
STEPS: Final = 60
NOTICED: Final = 1e-9
"""Part of the largest share that a storage has in a way below which it does not count."""
CANCELLED: Final = 1e-15
"""A sum of two terms below this part of their sizes is zero."""
NOTHING: Final = 1e-20
"""A stored quantity that a constraint moves is zero below this part of what it may be."""

STAYS: Final = 0
SWEPT: Final = 1
JUMPS: Final = 2
"""What entering a mode does: nothing, takes rounding away, moves what is stored by impulses."""


def enter_mode(e: Engine, mode: Mode, v: Floats, x: Floats, after: Floats) -> int:
    """Put the state on entering a mode from `x` into `after`, the impulses into `e.impulses`.

    `v` are time and inputs at the right limit, bond variables and the second copy a priori; what is
    stored in it is changed, and bond variables are kept. The result says what happened:
    `e.moved`, one of STAYS, SWEPT, JUMPS.
    """
    m = e.model
    n = 2 * m.bonds
    e.moved = STAYS
    for k in range(m.storages):
        after[k] = x[k]
    for k in range(n):
        e.impulses[k] = 0.0
    if mode.agreements.rows > 0 and check_agreement(e, mode, v) != OK:
        return REFUSED
    if mode.constraints.rows == 0 and mode.structures == 0:
        return OK
    begin_constraints(e, mode, v, x)
    count = e.work.constraints
    if count == 0:
        return OK
    residual(e, mode, v, x)
    exact = True
    rounding = True
    for i in range(count):
        r = math.fabs(e.work.gap.at[i])
        exact = exact and r == 0.0
        rounding = rounding and r <= CONSISTENT * e.work.gap_size.at[i]
    if exact:
        restore_bonds(e, v)
        return OK
    ways = mode.ways
    restore_bonds(e, v)
    find_ways(e, mode, v, x)
    status = newton_jump(e, mode, v, x, ways)
    restore_bonds(e, v)
    if status != OK:
        return status
    moved_by(m.storages, x, ways, e.work.nu.at, after)
    if rounding:
        # rounding, not a jump: dust is swept up without an impulse
        e.moved = SWEPT
        return OK
    e.moved = JUMPS
    put_impulses(e, mode, ways)
    return OK


def put_impulses(e: Engine, mode: Mode, ways: Ways) -> None:
    """Send the areas through the junction structure; shares are chosen by least leakage."""
    n = 2 * e.model.bonds
    w = e.work
    for k in range(ways.many):
        total = 0.0
        for a in range(ways.areas):
            total += ways.moving.at[k * ways.areas + a] * w.nu.at[a]
        w.combined.at[k] = total
    for k in range(n):
        total = 0.0
        for i in range(ways.many):
            total += ways.directions.at[k * ways.many + i] * w.combined.at[i]
        e.impulses[k] = total
    if ways.shares > 0:
        least_leakage(e, mode, ways.shares, ways.share.at, w.leakage)
        project(w.leakage, n, e.impulses)


def moved_by(n: int, x: Floats, ways: Ways, nu: Floats, after: Floats) -> None:
    """Put ``x + d nu`` into `after`, what cancels to rounding being zero."""
    for k in range(n):
        change = 0.0
        for a in range(ways.areas):
            change += ways.d.at[k * ways.areas + a] * nu[a]
        total = x[k] + change
        size = math.fabs(x[k]) + math.fabs(change)
        after[k] = 0.0 if math.fabs(total) <= CANCELLED * size else total


def check_agreement(e: Engine, mode: Mode, v: Floats) -> int:
    """Refuse sources that prescribe one variable differently."""
    m = e.model
    knowns_of(e, mode, v, False)
    for r in range(mode.agreements.rows):
        total = 0.0
        size = 0.0
        place = -1
        for i in range(mode.agreements.first.at[r], mode.agreements.first.at[r + 1]):
            at = mode.agreements.column.at[i]
            term = mode.agreements.value.at[i] * e.work.xi[at]
            total += term
            size += math.fabs(term)
            source = mode.source[at - m.storages]
            if source >= 0:
                place = m.source_node[source]
        if math.fabs(total) <= AGREE * size:
            continue
        why = "sources prescribe the same variable and differ"
        if m.tells != 0:
            return disagree(e, mode, r, total, why)
        return say_fault(e, "HB-C101", why, node_name(m, place) if place >= 0 else "")
    return OK


def begin_constraints(e: Engine, mode: Mode, v: Floats, x: Floats) -> None:
    """Make ready ``G z(x) - c``, the constraints as a function of the state, at a priori values."""
    m = e.model
    w = e.work
    n = 2 * m.bonds
    w.lefts = 0
    for k in range(n):
        w.kept[k] = v[m.bond_slot + k]
    if mode.structures > 0:
        # frozen rows stay in `frozen`, left null vectors in `left`
        frozen_at(e, mode, v, w.frozen)
        split(e, mode, v)
        w.lefts = mode.structures - mode.rank
    w.constraints = mode.constraints.rows + w.lefts
    fit(w.gap, w.constraints)
    fit(w.gap_size, w.constraints)
    fit(w.base_gap, w.constraints)
    fit(w.two_port, 2 * mode.structures + 1)
    reach_of(e, x, e.energy, w.reach)
    values = w.values
    for k in range(m.storages):
        w.reach[k] *= math.fabs(own_stiffness(m, k, values))


def restore_bonds(e: Engine, v: Floats) -> None:
    """Write the a priori bond variables back."""
    m = e.model
    for k in range(2 * m.bonds):
        v[m.bond_slot + k] = e.work.kept[k]


def residual(e: Engine, mode: Mode, v: Floats, x: Floats) -> None:
    """Put the residuals at the state `x` and the sizes of their terms into `e.work`."""
    m = e.model
    w = e.work
    n = 2 * m.bonds
    for k in range(m.storages):
        v[m.stored_slot + k] = x[k]
    restore_bonds(e, v)
    knowns_of(e, mode, v, False)
    for k in range(mode.knowns):
        w.known_size[k] = math.fabs(w.xi[k]) + TINY
        if k < m.storages:
            w.known_size[k] += w.reach[k] + coupled(m, k, v)
    rows = mode.constraints.rows
    for i in range(rows):
        w.gap.at[i] = row_times(mode.constraints, i, w.xi)
        w.gap_size.at[i] = row_size(mode.constraints, i, w.known_size)
    if w.lefts == 0:
        return
    for k in range(n):
        same = mode.same[k]
        w.base[k] = w.base[same] if same < k else row_times(mode.power, k, w.xi)
        w.base_size[k] = w.base_size[same] if same < k else row_size(mode.power, k, w.known_size)
    for i in range(mode.structures):
        total = 0.0
        size = 0.0
        row = mode.structure[i] * n
        for k in range(n):
            total += w.frozen.at[row + k] * w.base[k]
            size += math.fabs(w.frozen.at[row + k]) * w.base_size[k]
        w.two_port.at[2 * i] = total
        w.two_port.at[2 * i + 1] = size
    # a controlled source is read at the state tried; two-ports keep their moduli
    for k in range(n):
        v[m.bond_slot + k] = w.base[k]
    for i in range(mode.structures):
        d = mode.dynamic[mode.structure[i]]
        if m.dynamic_source[d] != 0:
            f = value(m, m.dynamic_value[d], v)
            w.two_port.at[2 * i] = f
            w.two_port.at[2 * i + 1] += math.fabs(f)
    for j in range(w.lefts):
        total = 0.0
        size = 0.0
        for i in range(mode.structures):
            share = w.left.at[i * w.lefts + j]
            total += share * w.two_port.at[2 * i]
            size += math.fabs(share) * w.two_port.at[2 * i + 1]
        w.gap.at[rows + j] = total
        w.gap_size.at[rows + j] = size


def impulse_directions(e: Engine, mode: Mode, v: Floats, ways: Ways) -> None:
    """Find all impulses that the power structure allows."""
    m = e.model
    w = e.work
    n = 2 * m.bonds
    frees = mode.power_frees
    rows = 0
    if mode.dynamics > 0:
        frozen_at(e, mode, v, w.frozen)
    most = 0
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d >= 0:
            most += max(1, m.dynamic_free[d + 1] - m.dynamic_free[d])
    fit(w.row, most * frees)
    for i in range(mode.dynamics):
        d = mode.dynamic[i]
        if d < 0:
            continue
        for p in range(m.dynamic_free[d], m.dynamic_free[d + 1]):
            for j in range(frees):
                w.row.at[rows * frees + j] = mode.power_free.at[m.free_column[p] * frees + j]
            rows += 1
        if m.dynamic_free[d] == m.dynamic_free[d + 1]:
            for j in range(frees):
                total = 0.0
                for k in range(n):
                    total += w.frozen.at[i * n + k] * mode.power_free.at[k * frees + j]
                w.row.at[rows * frees + j] = total
            rows += 1
    if rows == 0:
        ways.many = frees
        fit(ways.directions, n * frees)
        for i in range(n * frees):
            ways.directions.at[i] = mode.power_free.at[i]
        return
    room = svd_room(e, max(rows, frees), max(rows, frees))
    fit(w.c, frees * frees)
    ways.many = null_space(room, rows, frees, w.row.at, 1e-10, w.c.at)
    fit(ways.directions, n * ways.many)
    times_matrix(n, frees, ways.many, mode.power_free.at, w.c.at, ways.directions.at)


def find_ways(e: Engine, mode: Mode, v: Floats, x: Floats) -> None:
    """Find the impulses of a mode and what they move; in a linear mode once."""
    m = e.model
    w = e.work
    n = 2 * m.bonds
    ways = mode.ways
    if ways.known:
        return
    impulse_directions(e, mode, v, ways)
    many = ways.many
    fit(w.rate_part, m.storages * many)
    for k in range(m.storages):
        at = m.storage_bond[k] + (m.bonds if m.storage_kind[k] == 0 else 0)
        sign = float(m.storage_sign[k]) if m.storage_kind[k] == 0 else 1.0
        for j in range(many):
            w.rate_part.at[k * many + j] = sign * ways.directions.at[at * many + j]
    # the combinations of impulses that move the state
    ways.areas = 0
    fit(ways.moving, many * many)
    if many > 0:
        d = svd_room(e, max(m.storages, many), max(m.storages, many))
        svd(d, m.storages, many, w.rate_part.at)
        ways.areas = min(rank_above(d, many, 1e-10 * max(d.s[0], 1e-300)), m.storages)
        first_of_v(many, ways.areas, d.v, ways.moving.at)
    fit(ways.d, m.storages * ways.areas)
    times_matrix(m.storages, many, ways.areas, w.rate_part.at, ways.moving.at, ways.d.at)
    find_shares(e, ways, n)
    fit(w.nu, ways.areas)
    fit(w.step, ways.areas)
    fit(w.combined, many)
    if mode.dynamics > 0 or m.groups > 0:
        return
    count = w.constraints
    slope_of(e, mode, v, x, ways)
    fit(ways.inverse, ways.areas * count)
    ways.rank = rank_of(e, count, ways.areas, ways.slope.at)
    invert_slope(e, ways, count)
    ways.known = True


def invert_slope(e: Engine, ways: Ways, count: int) -> None:
    """Put the pseudo-inverse of the slope into `ways.inverse`."""
    w = e.work
    areas = ways.areas
    d = svd_room(e, max(count, areas), max(count, areas))
    if ways.rank < areas and count > 0:
        fit(w.row_size, count)
        for i in range(count):
            most = 0.0
            for a in range(areas):
                most = max(most, math.fabs(ways.slope.at[i * areas + a]))
            w.row_size.at[i] = most if most > 0.0 else 1.0
        if scale_slope(e, ways, count, w.row_size.at) == areas:
            pseudo_inverse(d, count, areas, w.scaled.at, 1e-12, ways.inverse.at)
            for a in range(areas):
                for i in range(count):
                    own = ways.inverse.at[a * count + i]
                    ways.inverse.at[a * count + i] = own / w.column_size.at[a] / w.row_size.at[i]
            ways.rank = areas
            return
    pseudo_inverse(d, count, areas, ways.slope.at, 1e-12, ways.inverse.at)


def scale_slope(e: Engine, ways: Ways, count: int, size: Floats) -> int:
    """Measure rows of the slope by `size` and columns by their largest entries; return its rank.

    It goes into `e.work.scaled`, the sizes of columns into `e.work.column_size`.
    """
    w = e.work
    areas = ways.areas
    fit(w.scaled, count * areas)
    fit(w.column_size, areas)
    for a in range(areas):
        most = 0.0
        for i in range(count):
            here = ways.slope.at[i * areas + a] / (size[i] if size[i] > 0.0 else 1.0)
            w.scaled.at[i * areas + a] = here
            most = max(most, math.fabs(here))
        w.column_size.at[a] = most if most > 0.0 else 1.0
        for i in range(count):
            w.scaled.at[i * areas + a] = w.scaled.at[i * areas + a] / w.column_size.at[a]
    return rank_of(e, count, areas, w.scaled.at)


def find_step(e: Engine, ways: Ways, count: int) -> int:
    """Put Newton's step into `e.work.step`; return the rank of the slope."""
    w = e.work
    areas = ways.areas
    d = svd_room(e, max(count, areas), max(count, areas))
    rank = scale_slope(e, ways, count, w.gap_size.at)
    if areas == 0:
        return rank
    if rank < areas:
        rank = rank_of(e, count, areas, ways.slope.at)
        least_squares(d, count, areas, ways.slope.at, 1e-12, 1, w.gap.at, w.step.at)
        return rank
    fit(w.row_size, count)
    for i in range(count):
        size = w.gap_size.at[i]
        w.row_size.at[i] = w.gap.at[i] / (size if size > 0.0 else 1.0)
    least_squares(d, count, areas, w.scaled.at, 1e-12, 1, w.row_size.at, w.step.at)
    for a in range(areas):
        w.step.at[a] = w.step.at[a] / w.column_size.at[a]
    return rank


def first_of_v(n: int, many: int, v: Floats, basis: Floats) -> None:
    """Put the first columns of V into the columns of `basis`."""
    for j in range(many):
        for i in range(n):
            basis[i * many + j] = v[j * n + i]


def find_shares(e: Engine, ways: Ways, n: int) -> None:
    """Find the impulses that move nothing: what is left to least leakage."""
    w = e.work
    many = ways.many
    ways.shares = 0
    if many == ways.areas:
        return
    fit(w.a, many * many)
    fit(w.b, many * many)
    fit(w.c, many)
    fit_columns(e, many)
    for i in range(many * ways.areas):
        w.a.at[i] = ways.moving.at[i]
    ways.shares = complement(many, ways.areas, w.a.at, w.c.at, w.column.at, w.b.at)
    fit(ways.share, n * ways.shares)
    times_matrix(n, many, ways.shares, ways.directions.at, w.b.at, ways.share.at)


def fit_columns(e: Engine, n: int) -> None:
    """Make room for the columns of a factorisation."""
    fit_places(e.work.column, n)


def rank_of(e: Engine, rows: int, columns: int, a: Floats) -> int:
    """Return the rank of a matrix, measured by its largest entry."""
    if rows == 0 or columns == 0:
        return 0
    d = svd_room(e, max(rows, columns), max(rows, columns))
    svd(d, rows, columns, a)
    return min(rank_above(d, columns, 1e-10 * largest(rows * columns, a)), rows)


def slope_of(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways) -> None:
    """Put the derivative of the residuals by the areas into `ways.slope`."""
    m = e.model
    w = e.work
    n = 2 * m.bonds
    count = w.constraints
    areas = ways.areas
    fit(ways.slope, count * areas)
    sourced = False
    for i in range(mode.structures):
        sourced = sourced or m.dynamic_source[mode.dynamic[mode.structure[i]]] != 0
    varies = False
    for k in range(mode.sources):
        varies = varies or (mode.source[k] >= 0 and m.source_value[mode.source[k]] >= 0)
    values = with_stored(e, x)
    if not varies and not (w.lefts > 0 and sourced):
        # rows by co-energy variables, then by what is stored
        fit(w.by_stored, m.storages)
        for i in range(count):
            constraint_by_co_energy(e, mode, i, n)
            for a in range(areas):
                total = 0.0
                for k in range(m.storages):
                    factor = w.by_stored.at[k]
                    if factor == 0.0:
                        continue
                    for p in range(m.stiff_first[k], m.stiff_first[k + 1]):
                        s = m.stiff_other[p]
                        total += factor * stiff(m, p, values) * ways.d.at[s * areas + a]
                ways.slope.at[i * areas + a] = total
        return
    # controlled sources: a difference quotient is a good enough slope, because the residual
    # decides when Newton ends
    residual(e, mode, v, x)
    for i in range(count):
        w.base_gap.at[i] = w.gap.at[i]
    for a in range(areas):
        step = 1e-7 * far(e, x, ways, a)
        for k in range(m.storages):
            w.ahead[k] = x[k] + step * ways.d.at[k * areas + a]
        residual(e, mode, v, w.ahead)
        for i in range(count):
            ways.slope.at[i * areas + a] = (w.gap.at[i] - w.base_gap.at[i]) / step


def far(e: Engine, x: Floats, ways: Ways, a: int) -> float:
    """Return how far along a way the storage goes that it fills first."""
    m = e.model
    w = e.work
    values = with_stored(e, x)
    most = 0.0
    for k in range(m.storages):
        most = max(most, math.fabs(ways.d.at[k * ways.areas + a]))
    least = math.inf
    for k in range(m.storages):
        share = math.fabs(ways.d.at[k * ways.areas + a])
        own = math.fabs(own_stiffness(m, k, values))
        held = math.fabs(x[k])
        if own > 0.0 and math.isfinite(own):
            held += w.reach[k] / own
        if share > NOTICED * most and held > 0.0:
            least = min(least, held / share)
    return least if least < math.inf else 1e-6 / most


def constraint_by_co_energy(e: Engine, mode: Mode, i: int, n: int) -> None:
    """Put a constraint's coefficients of co-energy variables into `e.work.by_stored`."""
    m = e.model
    w = e.work
    for k in range(m.storages):
        w.by_stored.at[k] = 0.0
    rows = mode.constraints.rows
    if i < rows:
        for p in range(mode.constraints.first.at[i], mode.constraints.first.at[i + 1]):
            k = mode.constraints.column.at[p]
            if k < m.storages:
                w.by_stored.at[k] = mode.constraints.value.at[p]
        return
    j = i - rows
    for s in range(mode.structures):
        share = w.left.at[s * w.lefts + j]
        for k in range(n):
            entry = w.frozen.at[mode.structure[s] * n + k]
            if entry == 0.0:
                continue
            row = mode.same[k]
            for p in range(mode.power.first.at[row], mode.power.first.at[row + 1]):
                column = mode.power.column.at[p]
                if column < m.storages:
                    w.by_stored.at[column] += share * entry * mode.power.value.at[p]


def newton_jump(e: Engine, mode: Mode, v: Floats, x: Floats, ways: Ways) -> int:
    """Find the areas at which the constraints hold, into `e.work.nu`."""
    m = e.model
    w = e.work
    count = w.constraints
    areas = ways.areas
    best = math.inf
    for a in range(areas):
        w.nu.at[a] = 0.0
    for _ in range(STEPS):
        put_here(m.storages, x, ways, w.nu.at, w.here)
        rank = ways.rank
        if not ways.known:
            slope_of(e, mode, v, w.here, ways)
        residual(e, mode, v, w.here)
        if ways.known:
            for a in range(areas):
                total = 0.0
                for i in range(count):
                    total += ways.inverse.at[a * count + i] * w.gap.at[i]
                w.step.at[a] = total
        else:
            rank = find_step(e, ways, count)
        worst = 0.0
        most = 0.0
        for i in range(count):
            size = w.gap_size.at[i]
            worst = max(worst, math.fabs(w.gap.at[i]) / (size if size > 0.0 else 1.0))
            most = max(most, size)
        met = worst <= BEST or (worst <= CONSISTENT and worst >= 0.5 * best)
        if met and best < math.inf:
            return OK
        if rank < count and unreached(count, areas, w.gap.at, ways.slope.at, w.step.at) > (
            1e-9 * most
        ):
            why = "no redistribution of what is stored meets the constraints of this mode"
            if m.tells != 0:
                return refuse_jump(e, mode, "HB-N303", why)
            return say_fault(e, "HB-N303", why, "")
        best = min(best, worst)
        for a in range(areas):
            w.nu.at[a] -= w.step.at[a]
    put_here(m.storages, x, ways, w.nu.at, w.here)
    residual(e, mode, v, w.here)
    for i in range(count):
        if not math.fabs(w.gap.at[i]) <= 1e-9 * w.gap_size.at[i]:
            if m.tells != 0:
                return refuse_jump(e, mode, "HB-N304", "the jump into this mode does not converge")
            return say_fault(e, "HB-N304", "the jump into this mode does not converge", "")
    return OK


def unreached(count: int, areas: int, gap: Floats, slope: Floats, step: Floats) -> float:
    """Return the largest residual that a step leaves."""
    most = 0.0
    for i in range(count):
        total = gap[i]
        for a in range(areas):
            total -= slope[i * areas + a] * step[a]
        most = max(most, math.fabs(total))
    return most


def put_here(n: int, x: Floats, ways: Ways, nu: Floats, here: Floats) -> None:
    """Put ``x + d nu`` into `here`."""
    for k in range(n):
        here[k] = x[k]
        for a in range(ways.areas):
            here[k] += ways.d.at[k * ways.areas + a] * nu[a]


def is_constrained(mode: Mode) -> bool:
    """Whether a mode has constraints on what is stored, off which a motion may drift."""
    return mode.constraints.rows > 0 or mode.structures > 0 or mode.agreements.rows > 0


def on_constraints(e: Engine, mode: Mode, v: Floats, y: Floats) -> int:
    """Put the state back on its mode's constraints, off which integration drifts.

    The same projection as a jump, but within a mode; `v` are the values of the motion at `y`.
    """
    m = e.model
    status = enter_mode(e, mode, v, y, e.work.landed)
    if status != OK or e.moved == STAYS:
        return status
    reach_of(e, y, e.energy, e.work.reach)
    for k in range(m.storages):
        # what a constraint holds at zero is zero, not ever smaller numbers
        held = math.fabs(e.work.landed[k]) <= NOTHING * e.work.reach[k]
        y[k] = 0.0 if held else e.work.landed[k]
    return OK
