"""Laws of storage: co-energy variables, stiffness, energy.

What is stored is read where it stands in a vector of values.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.model import Model
from hybond.engine.words import Floats, float_table

PARTS: Final = 200
"""Pieces into which the integral of an energy is divided at the most, between two kinks."""
KINK_SAMPLES: Final = 16
"""Parts of the way in each of which a kink is looked for."""
KINK_HALVINGS: Final = 60
NODE: Final = float_table(
    0.995657163025808080735527280689003,
    0.973906528517171720077964012084452,
    0.930157491355708226001207180059508,
    0.865063366688984510732096688423493,
    0.780817726586416897063717578345042,
    0.679409568299024406234327365114874,
    0.562757134668604683339000099272694,
    0.433395394129247190799265943165784,
    0.294392862701460198131126603103866,
    0.14887433898163121088482600112972,
    0.0,
)
"""Of Kronrod's formula with 21 points on [-1, 1]: the upper half."""
KRONROD: Final = float_table(
    0.011694638867371874278064396062192,
    0.03255816230796472747881897245939,
    0.05475589657435199603138130024458,
    0.07503967481091995276704314091619,
    0.093125454583697605535065465083366,
    0.109387158802297641899210590325805,
    0.123491976262065851077958109585166,
    0.134709217311473325928054001771707,
    0.142775938577060080797094273138717,
    0.147739104901338491374841515972068,
    0.149445554002916905664936468389821,
)
GAUSS: Final = float_table(
    0.0,
    0.066671344308688137593568809893332,
    0.0,
    0.149451349150580593145863397657697,
    0.0,
    0.219086362515982043995534934228163,
    0.0,
    0.269266719309996355091226921569469,
    0.0,
    0.295524224714752870173815619188769,
    0.0,
)
"""Of Gauss's with 10 of these points."""


def co_energy(m: Model, v: Floats, z: Floats) -> None:
    """Put the effort of each C and the flow of each I, power inward, into `z`."""
    for k in range(m.storages):
        z[k] = co_energy_of(m, k, v)


def co_energy_of(m: Model, k: int, v: Floats) -> float:
    """Return the co-energy variable of port k, which reads what its storage stores only."""
    law = m.co_energy[k]
    if law >= 0:
        return law_at(m, k, law, v[m.stored_slot + k], v)
    total = 0.0
    for i in range(m.stiff_first[k], m.stiff_first[k + 1]):
        total += m.stiff_constant[i] * v[m.stored_slot + m.stiff_other[i]]
    return total


def stiff(m: Model, i: int, v: Floats) -> float:
    """Return entry i of the stiffness."""
    law = m.stiff_value[i]
    if law < 0:
        return m.stiff_constant[i]
    return law_at(m, m.storages + i, law, v[m.stored_slot + m.stiff_other[i]], v)


def law_at(m: Model, row: int, law: int, x: float, v: Floats) -> float:
    """Return a law, as a sum of powers of x in the order in which it adds them if it is one."""
    first = m.power_first[row]
    stop = m.power_first[row + 1]
    if first == stop:
        return value(m, law, v)
    total = power_term(m, first, x)
    for p in range(first + 1, stop):
        total += power_term(m, p, x)
    return total


def power_term(m: Model, p: int, x: float) -> float:
    """Return one of them with its factor."""
    degree = m.power_degree[p]
    if degree == 1:
        return m.power_factor[p] * x
    if degree == 0:
        return m.power_factor[p]
    return m.power_factor[p] * (x * x if degree == 2 else x * x * x)


def own_stiffness(m: Model, k: int, v: Floats) -> float:
    """Return the derivative of the co-energy variable of port k by what it stores itself."""
    for i in range(m.stiff_first[k], m.stiff_first[k + 1]):
        if m.stiff_other[i] == k:
            return stiff(m, i, v)
    return 0.0


def is_alone(m: Model, k: int) -> bool:
    """Whether known k is the co-energy variable of a storage that has one port and is linear."""
    if k >= m.storages or m.co_energy[k] >= 0:
        return False
    first = m.stiff_first[k]
    return m.stiff_first[k + 1] == first + 1 and m.stiff_other[first] == k


def coupled(m: Model, k: int, v: Floats) -> float:
    """Return what the other ports of its field add to the co-energy variable of port k.

    The sum of magnitudes.
    """
    total = 0.0
    for i in range(m.stiff_first[k], m.stiff_first[k + 1]):
        j = m.stiff_other[i]
        if j != k:
            total += math.fabs(stiff(m, i, v) * v[m.stored_slot + j])
    return total


def with_stored(e: Engine, x: Floats) -> Floats:
    """Return values to try something with, `x` being stored."""
    m = e.model
    values = e.work.values
    copy_part(m.storages, x, 0, values, m.stored_slot)
    return values


def linear_energy(m: Model, x: Floats, of: Floats) -> float:
    """Return the energy, J, in storages whose laws are linear; what each has goes into `of`."""
    total = 0.0
    for k in range(m.storages):
        of[k] = 0.0
        if m.co_energy[k] >= 0 or m.storage_pseudo[k] != 0:
            continue
        for i in range(m.stiff_first[k], m.stiff_first[k + 1]):
            j = m.stiff_other[i]
            if m.storage_pseudo[j] == 0:
                energy = 0.5 * m.stiff_constant[i] * x[j] * x[k]
                total += energy
                of[k] += energy
    return total


def energy_of(e: Engine, x: Floats) -> float:
    """Return the stored energy, J; that of a nonlinear storage is counted from x = 0.

    Where a law has no value there, as of a gas without volume, or a field has efforts there, as oil
    in a chamber that moves, from what is stored at the start.
    Storage on pseudo bonds has none: effort times flow is no power there.
    It is asked for many times at an instant, in one state: that of the last is kept.
    """
    w = e.work
    if not is_counted(e, x):
        w.counted_energy = count_energy(e, x)
        copy_floats(e.model.storages, x, w.counted_x)
        w.counted = True
    return w.counted_energy


def is_counted(e: Engine, x: Floats) -> bool:
    """Whether the energy of just this was counted last; laws of storage read nothing else."""
    w = e.work
    for k in range(e.model.storages if w.counted else 0):
        if x[k] != w.counted_x[k]:
            return False
    return w.counted


def count_energy(e: Engine, x: Floats) -> float:
    """Return the energy of that state, found anew."""
    m = e.model
    own = e.work.counted_of
    total = linear_energy(m, x, own)
    for g in range(m.groups):
        first = m.group_storage[m.group_first[g]]
        if m.storage_pseudo[first] == 0:
            energy = energy_along(e, g, x)
            total += energy
            own[first] += energy
    return total


def place_along(e: Engine, g: int, x: Floats, part: float) -> None:
    """Put a part of what a storage stores where its laws read it."""
    m = e.model
    for i in range(m.group_first[g], m.group_first[g + 1]):
        k = m.group_storage[i]
        begin = e.work.origin * m.storage_start[k]
        e.work.values[m.stored_slot + k] = begin + part * (x[k] - begin)


def power_at(e: Engine, g: int, x: Floats, part: float) -> float:
    """Return ``z dx`` of a storage at a part of the way from its origin to what it stores."""
    m = e.model
    place_along(e, g, x, part)
    total = 0.0
    for i in range(m.group_first[g], m.group_first[g + 1]):
        k = m.group_storage[i]
        way = x[k] - e.work.origin * m.storage_start[k]
        total += value(m, m.co_energy[k], e.work.values) * way
    return total


def has_origin(e: Engine, g: int, x: Floats) -> bool:
    """Whether a storage has an energy of nothing where it stores nothing.

    Its laws have values there. Of a field they are zero, too: two chambers without any oil in them
    would be torn by its bulk modulus, and no energy is counted from that.
    """
    m = e.model
    place_along(e, g, x, 0.0)
    known = True
    field = m.group_first[g + 1] - m.group_first[g] > 1
    for i in range(m.group_first[g], m.group_first[g + 1]):
        k = m.group_storage[i]
        there = value(m, m.co_energy[k], e.work.values)
        known = known and math.isfinite(there) and not (field and there != 0.0)
    return known


def energy_along(e: Engine, g: int, x: Floats) -> float:
    """Integrate ``z dx`` of a storage from its origin along a ray."""
    m = e.model
    e.work.origin = 0.0
    if m.energy_law[g] >= 0:
        # sines of what is stored: points would follow every turn of it
        place_along(e, g, x, 1.0)
        known = value(m, m.energy_law[g], e.work.values)
        if math.isfinite(known):
            return known
    first = m.point_first[g]
    points = m.point_first[g + 1] - first
    total = 0.0
    if points > 0:
        for i in range(points):
            power = power_at(e, g, x, m.point_at[first + i])
            total += m.point_weight[first + i] * power
        return total
    if not has_origin(e, g, x):
        e.work.origin = 1.0
    # the formulas sample: of a spring with play they may see nothing but the play
    low = 0.0
    while low < 1.0:
        high = next_bend(e, g, x, low)
        total += energy_between(e, g, x, low, high)
        low = high
    e.work.origin = 0.0
    return total


def energy_between(e: Engine, g: int, x: Floats, begin: float, end: float) -> float:
    """Integrate ``z dx`` over a part of the ray without kinks."""
    total = 0.0
    # halves until each piece is as good as it can be, from the left
    low = begin
    width = end - begin
    for _ in range(PARTS):
        if low >= end:
            break
        fine = 0.0
        coarse = 0.0
        size = 0.0
        for i in range(21):
            k = i if i <= 10 else 20 - i
            at = -NODE[k] if i <= 10 else NODE[k]
            f = power_at(e, g, x, low + 0.5 * width * (1.0 + at))
            fine += KRONROD[k] * f
            coarse += GAUSS[k] * f
            size += KRONROD[k] * math.fabs(f)
        good = math.fabs(fine - coarse) <= 1e-7 * size
        if good or width <= 1e-9:
            total += 0.5 * width * fine
            low += width
            width = min(2.0 * width, end - low)
        else:
            width = 0.5 * width
    return total


def next_bend(e: Engine, g: int, x: Floats, low: float) -> float:
    """Return where on its ray a law of a storage next has a kink or a jump; 1: nowhere.

    What changes its sign there is looked at in KINK_SAMPLES parts of the ray, and where another has
    one: about a kink of ``abs(q - a) < b`` there may be two in no time.
    """
    m = e.model
    found = 1.0
    for _ in range(2):
        for i in range(m.bend_first[g], m.bend_first[g + 1]):
            found = bend_within(e, g, x, m.bend_value[i], low, found)
    return found


def bend_within(e: Engine, g: int, x: Floats, bend: int, low: float, high: float) -> float:
    """Return where this one first changes its sign between two parts of the ray, else `high`."""
    before = low
    one = turn_at(e, g, x, bend, low)
    for k in range(1, KINK_SAMPLES + 1):
        after = min(float(k) / float(KINK_SAMPLES), high)
        if after <= before:
            continue
        other = turn_at(e, g, x, bend, after)
        if one * other < 0.0:
            return min(high, root_of_turn(e, g, x, bend, before, after, one))
        if other == 0.0:
            return after
        before = after
        one = other
    return high


def turn_at(e: Engine, g: int, x: Floats, bend: int, part: float) -> float:
    """Return what changes its sign at a kink, at a part of the ray."""
    place_along(e, g, x, part)
    return value(e.model, bend, e.work.values)


def root_of_turn(
    e: Engine, g: int, x: Floats, bend: int, low: float, high: float, one: float
) -> float:
    """Return where it changes its sign, by halves; `one` is its value at `low`."""
    left = low
    right = high
    for _ in range(KINK_HALVINGS):
        middle = 0.5 * (left + right)
        if turn_at(e, g, x, bend, middle) * one > 0.0:
            left = middle
        else:
            right = middle
    return right
