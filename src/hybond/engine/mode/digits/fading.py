"""What each storage held that its rounding is still measured by: it fades as the motion has it do.

Rounding of what is stored is carried on by the motion as what is stored itself. Where all that
brings it back is at least what others push it by, as of a capacitor behind a resistor, it comes to
what these push it to, in its own time, however much energy is elsewhere or has been there: what
has been made before fades. Where nothing brings it back, as of a mass on a spring, all energy of
its part may be in it.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats
from hybond.engine.algebra.separate import first_of, unite
from hybond.engine.engine import Engine
from hybond.engine.method_numbers import MOREAU
from hybond.engine.mode.digits.reach import reach_by
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.newton import source_of
from hybond.engine.mode.rows.storage import is_alone, own_stiffness
from hybond.engine.mode.rows.storage_bonds import co_energy_bond, rate_bond, way_of_rate
from hybond.engine.model import Model
from hybond.engine.words import Floats

TURNS: Final = 2
"""Times that storages are gone through, each no more than others push it to."""
WITHIN: Final = 1.0 + 1e-9
"""Part of what brings a storage back by which others push it, at the most."""
LEAST: Final = 1e-100
"""A size that is none."""
FREE: Final = -1.0
"""The rate of fading of what nothing brings back."""


def find_fading(e: Engine, mode: Mode, v: Floats) -> None:
    """Find how fast what each storage holds is brought back in a mode, 1/s; zero: nothing moves it.

    Which of them hang together is then in `mode.fades_with`.
    """
    m = e.model
    rows = mode.finite
    for k in range(m.storages):
        mode.fades_by[k] = rate_of_fading(m, mode, k, v)
        mode.fades_with[k] = k
    for i in range(mode.constraints.rows):
        for p in range(mode.constraints.first.at[i], mode.constraints.first.at[i + 1]):
            if mode.constraints.column.at[p] < m.storages:
                mode.fades_by[mode.constraints.column.at[p]] = FREE
    for k in range(m.storages):
        at = mode.same[rate_bond(m, k)]
        for i in range(rows.first.at[at], rows.first.at[at + 1]):
            j = rows.column.at[i]
            if j < m.storages and mode.fades_by[k] > 0.0 and mode.fades_by[j] > 0.0:
                unite(mode.fades_with, k, j)
    for k in range(m.storages):
        mode.fades_with[k] = first_of(mode.fades_with, k)
    mode.fading_known = True  # stiffnesses are constant of all that are brought back


def may_fade(m: Model, mode: Mode) -> bool:
    """Whether it is asked what fades: not in fixed steps, nor where laws bend or moduli lead."""
    led = mode.structures > 0 and mode.finite_frees > 0
    return m.groups == 0 and m.method != MOREAU and not led


def rate_of_fading(m: Model, mode: Mode, k: int, v: Floats) -> float:
    """Return how fast what storage k holds is brought back; `FREE` where it may go beyond others.

    What pushes it there are efforts if it is one itself, of the same kind, or flows; and together
    they push by no more than it is brought back by: so it stays between them.
    """
    if not is_alone(m, k):
        return FREE
    rows = mode.finite
    at = mode.same[rate_bond(m, k)]
    kind = m.bond_class[held_at(m, k)]
    back = 0.0
    pushed = 0.0
    for i in range(rows.first.at[at], rows.first.at[at + 1]):
        j = rows.column.at[i]
        size = math.fabs(rows.value.at[i])
        if j == k:
            back -= way_of_rate(m, k) * rows.value.at[i]
        elif size > 0.0:
            by = held_at(m, j) if j < m.storages else given_at(m, mode, j - m.storages)
            if by < 0 or m.bond_class[by] != kind:
                return FREE
            pushed += size
    for j in range(mode.finite_frees):
        if mode.finite_free.at[rate_bond(m, k) * mode.finite_frees + j] != 0.0:
            return FREE
    return back * own_stiffness(m, k, v) if pushed <= WITHIN * back else FREE


def held_at(m: Model, k: int) -> int:
    """Return the bond variable that storage k holds."""
    return co_energy_bond(m, k)


def given_at(m: Model, mode: Mode, s: int) -> int:
    """Return the bond variable that a source of a mode gives, or -1."""
    if s >= mode.sources or mode.source[s] < 0:
        return -1
    return m.source_bond[mode.source[s]]


def bound_fading(e: Engine, mode: Mode, x: Floats, reach: Floats, v: Floats) -> None:
    """Let what is brought back be no more than it was lately, or than others push it to.

    `reach` has how large the effort or flow of each storage may be with a unit of energy. What
    hangs together stays within what any of it was, and what is around it.
    """
    m = e.model
    most = e.work.fading_most
    here = e.work.fading_here
    for k in range(m.storages):
        most[k] = 0.0
        here[k] = reach[k]
    for k in range(m.storages):
        if mode.fades_by[k] >= 0.0:
            first = mode.fades_with[k]
            near = around(e, mode, k, x, reach, v)
            most[first] = max(most[first], near)
    for k in range(m.storages):
        if mode.fades_by[k] >= 0.0:
            here[k] = min(reach[k], most[mode.fades_with[k]])
    for _ in range(TURNS):
        for k in range(m.storages):
            if mode.fades_by[k] > 0.0:
                pushed = pushed_to(e, mode, k, here, v)
                kept = kept_in(e, mode, k, x, v)
                here[k] = min(here[k], max(pushed, kept))
    for k in range(m.storages):
        if mode.fades_by[k] > 0.0:
            root = root_of(mode, m.storage_bond[k])
            pushed = pushed_to(e, mode, k, here, v)
            mode.fades_to[k] = pushed * root / own_stiffness(m, k, v)
    for k in range(m.storages):
        if here[k] < reach[k]:
            reach[k] = min(reach[k], next_power(here[k]))


def kept_in(e: Engine, mode: Mode, k: int, x: Floats, v: Floats) -> float:
    """Return what storage k was lately, in the measure of a unit of energy."""
    root = root_of(mode, e.model.storage_bond[k])
    kept = own_stiffness(e.model, k, v) * max(e.remembered[k], math.fabs(x[k]))
    return kept / root if root > 0.0 else math.inf


def around(e: Engine, mode: Mode, k: int, x: Floats, reach: Floats, v: Floats) -> float:
    """Return the most of what storage k was lately, and what is around it that does not fade."""
    m = e.model
    rows = mode.finite
    root = root_of(mode, m.storage_bond[k])
    most = min(reach[k], kept_in(e, mode, k, x, v))
    at = mode.same[rate_bond(m, k)]
    for i in range(rows.first.at[at], rows.first.at[at + 1]):
        j = rows.column.at[i]
        if rows.value.at[i] == 0.0 or root == 0.0:
            continue
        if j >= m.storages:
            most = max(most, math.fabs(source_of(e, mode, j - m.storages, v)) / root)
        elif mode.fades_by[j] < 0.0:
            most = max(most, reach[j])
    return most


def next_power(size: float) -> float:
    """Return the power of two that is not less: a little more changes nothing."""
    if size < LEAST:
        return LEAST
    return math.pow(2.0, math.ceil(math.log(size) / math.log(2.0)))


def root_of(mode: Mode, b: int) -> float:
    """Return the root of the energy of the part of bond b."""
    return math.sqrt(mode.part_energy[mode.bond_part[b]])


def pushed_to(e: Engine, mode: Mode, k: int, reach: Floats, v: Floats) -> float:
    """Return what others push storage k to, at the most, if they reach so far."""
    m = e.model
    rows = mode.finite
    root = root_of(mode, m.storage_bond[k])
    at = mode.same[rate_bond(m, k)]
    back = 0.0
    most = 0.0
    for i in range(rows.first.at[at], rows.first.at[at + 1]):
        j = rows.column.at[i]
        size = math.fabs(rows.value.at[i])
        if j == k:
            back += size
        elif j < m.storages:
            most += size * reach[j]
        elif size > 0.0 and root > 0.0:
            most += size * math.fabs(source_of(e, mode, j - m.storages, v)) / root
    return most / back if back > 0.0 else 0.0


def remember(e: Engine, mode: Mode, h: float, x: Floats) -> None:
    """Learn from a step of the motion that ends at `x`."""
    m = e.model
    for k in range(m.storages):
        e.remembered_before[k] = e.remembered[k]
        size = math.fabs(x[k])
        rate = mode.fades_by[k] if e.slide.k == 0 else FREE
        if rate > 0.0:
            z = rate * h
            left = 1.0 / (1.0 + z * (1.0 + z * (0.5 + z / 6.0)))
            kept = left * e.remembered[k] + (1.0 - left) * mode.fades_to[k]
            e.remembered[k] = max(size, kept)
        elif rate == 0.0:
            e.remembered[k] = max(size, e.remembered[k])
        else:
            remember_all(e, k, size)


def remember_all(e: Engine, k: int, size: float) -> None:
    """Let all energy of its part have been in storage k, which holds so much."""
    m = e.model
    all_there = 0.0
    if is_alone(m, k):
        own = m.stiff_constant[m.stiff_first[k]]
        all_there = reach_by(math.fabs(own), e.part_energy[e.storage_part[k]])
    e.remembered[k] = max(max(size, all_there), e.remembered[k])


def remember_jump(e: Engine, x: Floats) -> None:
    """Learn that `x` is to be stored: what jumps has the rounding of all that it may be of."""
    for k in range(e.model.storages):
        if x[k] != e.y[k]:
            remember_all(e, k, math.fabs(x[k]))


def remember_now(e: Engine) -> None:
    """Learn what is stored where a motion begins."""
    for k in range(e.model.storages):
        e.remembered[k] = max(e.remembered[k], math.fabs(e.y[k]))


def keep_seen(e: Engine, mode: Mode) -> None:
    """Keep what is seen in the motion that begins, for a run that goes on with it."""
    m = e.model
    copy_floats(2 * m.bonds, mode.seen, e.seen_before)
    copy_floats(m.storages, mode.fades_to, e.fades_before)


def see_as_before(e: Engine, mode: Mode) -> None:
    """Let rounding be measured as in the motion that goes on in another run."""
    m = e.model
    copy_floats(2 * m.bonds, e.seen_before, mode.seen)
    copy_floats(m.storages, e.fades_before, mode.fades_to)
    mode.seen_taken = False
    mode.saw = False
