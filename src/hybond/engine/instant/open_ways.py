"""The ways in which integrals and samples are free: what was left open once is in them since.

As time passes where the equations leave something open, an integral of it has any value, and so has
what samples it. They keep that when the mode that left it open has ended, until they are sampled
anew. Each way moves signals together, the farthest by 1, and none is a sum of others.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import grow_block, grow_places
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.inputs.interval import is_due
from hybond.engine.inputs.sampling import value_at_instant
from hybond.engine.instant.indeterminate import FAR
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.surfaces.averages import solve_here
from hybond.engine.words import Floats, Ints

STEADY: Final = 1e-9
"""Part of its terms by which a value may change along a way that does not move it, and part of a
way by which it differs from sums of others if it is one of them."""

NEAR: Final = 1e-6
"""How far ways may be from each other that are one."""

UNLIKE: Final = 0.037
"""By what signals are moved farther, one after another: what is read of them does not cancel."""


def end_interval(e: Engine) -> None:
    """Keep how signals are free now that time has passed since the last instant."""
    trial = e.trial
    if e.t <= trial.settled_at:
        return
    hold_ways(e, trial.open_ways)


def hold_ways(e: Engine, ways: int) -> None:
    """Keep the ways that have been found until another instant."""
    trial = e.trial
    n = e.model.integrals * ways
    grow_block(trial.kept_ways, n)
    grow_places(trial.kept_sides, ways)
    for i in range(n):
        trial.kept_ways.at[i] = trial.ways.at[i]
    for i in range(ways):
        trial.kept_sides.at[i] = trial.two_sided.at[i]
    trial.kept_many = ways


def take_kept_ways(e: Engine) -> int:
    """Begin the ways with those that are kept; return how many."""
    trial = e.trial
    m = e.model
    ways = 0
    for i in range(trial.kept_many):
        grow_block(trial.ways, (ways + 1) * m.integrals)
        for k in range(m.integrals):
            trial.ways.at[ways * m.integrals + k] = trial.kept_ways.at[i * m.integrals + k]
        ways += add_way(e, ways)
        trial.two_sided.at[ways - 1] = trial.kept_sides.at[i]
    return ways


def note_open(e: Engine) -> None:
    """Note which signals are free, for a run that goes on: there each is so by itself."""
    trial = e.trial
    n = e.model.integrals
    for k in range(n):
        trial.open_signal[k] = 0
        trial.kept_signal[k] = 0
        for i in range(trial.open_ways):
            if trial.ways.at[i * n + k] != 0.0:
                trial.open_signal[k] = 1
        for i in range(trial.kept_many):
            if trial.kept_ways.at[i * n + k] != 0.0:
                trial.kept_signal[k] = 1


def begin_open(e: Engine) -> None:
    """Begin with the signals that were noted to be free."""
    trial = e.trial
    trial.kept_many = 0
    hold_ways(e, put_open(e, trial.kept_signal))
    trial.open_ways = put_open(e, trial.open_signal)


def put_open(e: Engine, free: Ints) -> int:
    """Put a way for each signal that is free; return how many."""
    trial = e.trial
    n = e.model.integrals
    ways = 0
    for k in range(n):
        if free[k] != 0:
            grow_block(trial.ways, (ways + 1) * n)
            for i in range(n):
                trial.ways.at[ways * n + i] = 1.0 if i == k else 0.0
            ways += add_way(e, ways)
            trial.two_sided.at[ways - 1] = 1
    return ways


def add_way(e: Engine, ways: int) -> int:
    """Count what stands behind `ways` ways as the next one, if it is one and new: 1, else 0.

    It is made as long as the others.
    """
    trial = e.trial
    n = e.model.integrals
    at = ways * n
    most = 0.0
    for k in range(n):
        most = max(most, math.fabs(trial.ways.at[at + k]))
    if not (most > 0.0 and math.isfinite(most)):
        return 0
    grow_block(trial.upright, at + n)
    whole = 0.0
    for k in range(n):
        trial.ways.at[at + k] /= most
        trial.upright.at[at + k] = trial.ways.at[at + k]
        whole = math.hypot(whole, trial.ways.at[at + k])
    for j in range(2 * ways):
        other = (j % ways) * n
        along = 0.0
        for k in range(n):
            along += trial.upright.at[other + k] * trial.upright.at[at + k]
        for k in range(n):
            trial.upright.at[at + k] -= along * trial.upright.at[other + k]
    size = 0.0
    for k in range(n):
        size = math.hypot(size, trial.upright.at[at + k])
    grow_places(trial.two_sided, ways + 1)
    trial.two_sided.at[ways] = 0
    if size <= STEADY * whole:
        turn_ways(e, ways)
        return 0
    for k in range(n):
        trial.upright.at[at + k] /= size
    return 1


def turn_ways(e: Engine, ways: int) -> None:
    """Let signals move to both sides on the way to whose other side one leads that is not new.

    If it is a sum of others, on all of them.
    """
    trial = e.trial
    n = e.model.integrals
    at = ways * n
    for j in range(ways):
        off = 0.0
        same = 0.0
        for k in range(n):
            off = max(off, math.fabs(trial.ways.at[j * n + k] + trial.ways.at[at + k]))
            same = max(same, math.fabs(trial.ways.at[j * n + k] - trial.ways.at[at + k]))
        if off <= NEAR:
            trial.two_sided.at[j] = 1
        if min(off, same) <= NEAR:
            return
    for j in range(ways):
        trial.two_sided.at[j] = 1


def moved_by(here: float, before: float, size: float) -> float:
    """Return by how much a value has moved, its terms being of a size; zero if that is rounding."""
    most = max(size if math.isfinite(size) else 0.0, math.fabs(here))
    moved = here - before
    return moved if math.isfinite(moved) and math.fabs(moved) > STEADY * most else 0.0


# -- signals moved, and what follows


def keep_signals(e: Engine) -> None:
    """Keep what integrals are, now and a priori, with what their rounding is measured by."""
    m = e.model
    kept = e.trial.kept_signals
    for k in range(m.integrals):
        kept[3 * k] = e.v[m.signal_slot + k]
        kept[3 * k + 1] = e.pre[m.signal_slot + k]
        kept[3 * k + 2] = e.trial.terms[m.signal_slot + k]
    if e.trial.bonds_follow:
        for k in range(2 * m.bonds):
            e.trial.kept_bonds[k] = e.v[m.bond_slot + k]
            e.trial.kept_bonds[2 * m.bonds + k] = e.work.w[k]
        for k in range(e.mode.knowns):
            e.trial.kept_knowns[k] = e.work.xi[k]
        hold_guess(e, e.mode)


def put_signals(e: Engine) -> None:
    """Put that back."""
    m = e.model
    kept = e.trial.kept_signals
    for k in range(m.integrals):
        e.v[m.signal_slot + k] = kept[3 * k]
        e.pre[m.signal_slot + k] = kept[3 * k + 1]
        e.trial.terms[m.signal_slot + k] = kept[3 * k + 2]
    if e.trial.bonds_follow:
        give_back_guess(e, e.mode)
        for k in range(2 * m.bonds):
            e.v[m.bond_slot + k] = e.trial.kept_bonds[k]
            e.work.w[k] = e.trial.kept_bonds[2 * m.bonds + k]
        for k in range(e.mode.knowns):
            e.work.xi[k] = e.trial.kept_knowns[k]


def move_signals(e: Engine, way: int, far: float, most: float) -> None:
    """Move integrals along a way from where they were kept: as time passes, a priori as well.

    What is moved by up to `most` is known no better than that, wherever it is. Bond variables
    follow, where laws and sources read them.
    """
    m = e.model
    kept = e.trial.kept_signals
    for k in range(m.integrals):
        along = e.trial.ways.at[way * m.integrals + k]
        moved = far * along
        e.v[m.signal_slot + k] = kept[3 * k] + moved
        e.pre[m.signal_slot + k] = kept[3 * k + 1] + moved
        e.trial.terms[m.signal_slot + k] = kept[3 * k + 2] + math.fabs(most * along)
    if e.trial.bonds_follow:
        follow(e)


def follow(e: Engine) -> bool:
    """Let bond variables be those of the signals as they are; as they were where there are none.

    Returns whether there are.
    """
    m = e.model
    refused = e.refusal
    asked = e.evaluations
    known = solve_here(e, e.mode, e.v) == OK
    for k in range(2 * m.bonds if not known else 0):
        e.v[m.bond_slot + k] = e.trial.kept_bonds[k]
    e.refusal = refused
    e.evaluations = asked
    return known


def bond_moved(e: Engine, k: int) -> float:
    """Return by how much a bond variable has followed signals that are moved."""
    return moved_by(e.v[e.model.bond_slot + k], e.trial.kept_bonds[k], 0.0)


def follow_signals(e: Engine) -> bool:
    """Whether bond variables follow integrals and samples at all: all are moved, none alike."""
    m = e.model
    e.trial.bonds_follow = True
    keep_signals(e)
    found = False
    for side in range(4):
        for k in range(m.integrals):
            way = 1.0 if side % 2 == 0 else -1.0
            kept = e.trial.kept_signals[3 * k]
            far = max(1.0, math.fabs(kept)) * (1.0 + UNLIKE * float(k % 97))
            e.v[m.signal_slot + k] = kept + way * far * (1.0 if side < 2 else FAR)
        found = not follow(e) or found
        for k in range(2 * m.bonds if not found else 0):
            found = found or bond_moved(e, k) != 0.0
        put_signals(e)
    return found


# -- what samples them


def see_open_samples(e: Engine, s: Floats) -> None:
    """Find how signals are free after some have been sampled, which stand in `s`.

    In `e.v` there are the values a priori.
    """
    m = e.model
    trial = e.trial
    if (trial.kept_many == 0 and trial.was_loose == 0) or (m.decided != 0 and m.tells == 0):
        return
    trial.bonds_follow = True
    keep_signals(e)
    most = 1.0
    for k in range(m.integrals):
        most = max(most, math.fabs(e.v[m.signal_slot + k]))
    for k in range(2 * m.bonds):
        most = max(most, math.fabs(e.v[m.bond_slot + k]))
    far = FAR * most
    ways = 0
    for i in range(2 * trial.kept_many):
        if i % 2 == 1 and trial.kept_sides.at[i // 2] == 0:
            continue
        grow_block(trial.ways, (ways + 1) * m.integrals)
        for k in range(m.integrals):
            way = far if i % 2 == 0 else -far
            along = trial.kept_ways.at[i // 2 * m.integrals + k]
            trial.ways.at[ways * m.integrals + k] = along if way > 0.0 else -along
            e.v[m.signal_slot + k] = trial.kept_signals[3 * k] + way * along
        follow(e)
        ways += keep_samples(e, s, ways, far)
        ways = keep_outputs(e, ways)
        put_signals(e)
    for j in range(trial.was_loose):
        for side in range(2):
            grow_block(trial.ways, (ways + 1) * m.integrals)
            for k in range(m.integrals):
                trial.ways.at[ways * m.integrals + k] = 0.0
            way = far if side > 0 else -far
            for k in range(2 * m.bonds):
                along = trial.was_freedom.at[k * trial.was_loose + j]
                e.v[m.bond_slot + k] = trial.kept_bonds[k] + way * along
            ways += keep_samples(e, s, ways, far)
            ways = keep_outputs(e, ways)
            put_signals(e)
    for k in range(m.slots):
        e.v[m.slots + k] = 0.0
    hold_ways(e, ways)


def keep_samples(e: Engine, s: Floats, ways: int, far: float) -> int:
    """Let what is sampled now be free as it is in `e.v`, on a way that begins behind `ways` others.

    Returns 1 if it is a way then, and new.
    """
    m = e.model
    for k in range(m.slots):
        e.v[m.slots + k] = e.v[k]
    for k in range(m.samples):
        if not is_due(m, k, e.t):
            continue
        if m.blocks > 0 and m.sample_block[k] >= 0:
            put_outputs(e, ways, m.sample_block[k], 0.0, -1)
        else:
            i = m.sample_signal[k]
            here = value_at_instant(m, m.sample_value[k], e.v)
            moved = moved_by(here, s[i], value(m, m.sample_size[k], e.v))
            e.trial.ways.at[ways * m.integrals + i] = moved / far
    return add_way(e, ways)


def keep_outputs(e: Engine, ways: int) -> int:
    """Let each output of a block be free whose inputs are other ones in `e.v`.

    Nobody asks a block twice. Returns how many ways there are then.
    """
    m = e.model
    for k in range(m.samples if m.blocks > 0 else 0):
        if m.sample_block[k] < 0 or not is_due(m, k, e.t):
            continue
        block = m.sample_block[k]
        moved = False
        for i in range(m.block_first[block], m.block_first[block + 1]):
            here = value(m, m.block_value[i], e.v)
            moved = moved or moved_by(here, value(m, m.block_value[i], e.pre), 0.0) != 0.0
        if not moved:
            continue
        for i in range(m.block_set[block], m.block_set[block + 1]):
            grow_block(e.trial.ways, (ways + 1) * m.integrals)
            for j in range(m.integrals):
                e.trial.ways.at[ways * m.integrals + j] = 0.0
            put_outputs(e, ways, block, 1.0, i)
            ways += add_way(e, ways)
    return ways


def put_outputs(e: Engine, way: int, block: int, along: float, which: int) -> None:
    """Let a way move one output of a block so far, or all of them with -1."""
    m = e.model
    for i in range(m.block_set[block], m.block_set[block + 1]):
        if which < 0 or i == which:
            e.trial.ways.at[way * m.integrals + m.block_signal[i]] = along
