"""Motions in which nothing moves but what constraints lead along with sources of time.

Ideal diodes that conduct tie capacitors to a voltage, drives that are given tie masses. What is
stored is what it was, and by how much the sources have changed since then: it is known at any
instant, however large the errors of steps are.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, fit_places
from hybond.engine.constraints.sparse_ways import sparse_shares
from hybond.engine.engine import Engine
from hybond.engine.inputs.interval import set_time
from hybond.engine.jumps.jump import CANCELLED, is_fixed
from hybond.engine.mode.mode_records import FREE, NOT_KNOWN, TIED, Mode, Ways
from hybond.engine.mode.rows.sources_of_time import value_of_source
from hybond.engine.mode.rows.storage_bonds import way_of_rate
from hybond.engine.words import Floats

ALONG: Final = 1e-13
"""Part of its terms up to which what constraints leave of a rate is rounding."""


def begin_tied(e: Engine, t: float, y: Floats) -> bool:
    """Whether the motion that begins is tied; then what sources leave of its state is kept."""
    ties = e.mode.ties
    if not is_tied(e):
        return False
    put_leaders(e, t)
    for k in range(e.model.storages):
        rest = y[k]
        size = math.fabs(rest)
        for j in range(ties.leaders):
            share = ties.factor.at[k * ties.leaders + j] * ties.level.at[j]
            rest -= share
            size += math.fabs(share)
        given = ties.given.at[k] != 0 or math.fabs(rest) <= CANCELLED * size
        ties.rest.at[k] = 0.0 if given else rest
    return True


def put_tied(e: Engine, t: float, y: Floats) -> None:
    """Put the state of a tied motion at an instant into `y`; what cancels to rounding is zero."""
    ties = e.mode.ties
    put_leaders(e, t)
    for k in range(e.model.storages):
        total = ties.rest.at[k]
        size = math.fabs(total)
        for j in range(ties.leaders):
            share = ties.factor.at[k * ties.leaders + j] * ties.level.at[j]
            total += share
            size += math.fabs(share)
        y[k] = 0.0 if math.fabs(total) <= CANCELLED * size else total


def put_leaders(e: Engine, t: float) -> None:
    """Put the values of the sources that lead at an instant there."""
    ties = e.mode.ties
    set_time(e, e.shown, t)
    for j in range(ties.leaders):
        level = value_of_source(e, ties.leader.at[j], e.shown)
        ties.level.at[j] = level


def is_tied(e: Engine) -> bool:
    """Whether all that moves in the present mode is led by its constraints."""
    m = e.model
    mode = e.mode
    if mode.ties.known == FREE or e.states > m.storages or e.slide.k > 0 or e.landings.any_landed:
        return False
    if m.kinks > 0 or m.edges > 0 or m.disks > 0 or m.called > 0 or m.groups > 0:
        return False
    if mode.constraints.rows == 0 or not is_fixed(mode):
        return False
    if mode.ties.known == NOT_KNOWN:
        mode.ties.known = TIED if take_ties(e, mode) else FREE
    return mode.ties.known == TIED


def take_ties(e: Engine, mode: Mode) -> bool:
    """Take what leads constraints of a mode, and what that moves; False if more than that moves."""
    m = e.model
    ties = mode.ties
    if mode.rates.stores > 0 or not take_leaders(e, mode):
        return False
    for k in range(m.storages):
        take_factors(e, mode, k)
    for k in range(mode.sources):
        led = ties.place.at[k] >= 0
        if mode.rates.valued[k] != 0 or (mode.rates.rated[k] != 0 and not led):
            return False
        if led and not leads(e, mode, k):
            return False
    return True


def take_leaders(e: Engine, mode: Mode) -> bool:
    """Take the sources that constraints read; False if these read what is more than they give."""
    m = e.model
    ties = mode.ties
    fit_places(ties.place, mode.sources)
    fit_places(ties.leader, mode.sources)
    for k in range(mode.sources):
        ties.place.at[k] = -1
    ties.leaders = 0
    for i in range(mode.bounds):
        k = mode.bound[i] - m.storages
        if k < 0 and mode.bound_alone[i] == 0:
            return False
        if k < 0:
            continue
        source = mode.source[k]
        if source < 0 or m.source_value[source] < 0:
            continue  # a constant
        if m.source_timed[source] == 0:
            return False
        ties.place.at[k] = ties.leaders
        ties.leader.at[ties.leaders] = source
        ties.leaders += 1
    fit_places(ties.given, m.storages)
    fit(ties.rest, m.storages)
    fit(ties.level, ties.leaders)
    fit(ties.factor, m.storages * ties.leaders)
    fit(ties.size, m.storages * ties.leaders)
    return True


def take_factors(e: Engine, mode: Mode, k: int) -> None:
    """Take what a unit of each leader moves of storage k, and whether that is all that is in it."""
    m = e.model
    w = e.work
    ways = mode.ways
    ties = mode.ties
    rows = mode.constraints
    for j in range(ties.leaders):
        ties.factor.at[k * ties.leaders + j] = 0.0
        ties.size.at[k * ties.leaders + j] = 0.0
    for s in range(m.storages):
        # what is left of a unit in each storage, and what that is rounding of
        w.here[s] = 1.0 if s == k else 0.0
        w.reach[s] = w.here[s]
    ties.given.at[k] = 1
    if ways.sparse:
        sparse_shares(e, ways, k, rows.rows)
    for i in range(rows.rows):
        share = w.row_size.at[i] if ways.sparse else dense_share(ways, k, i, rows.rows)
        if share == 0.0:
            continue
        for p in range(rows.first.at[i], rows.first.at[i + 1]):
            known = rows.column.at[p]
            change = share * rows.value.at[p]
            if known < m.storages:
                change *= m.stiff_constant[m.stiff_first[known]]
                w.here[known] -= change
                w.reach[known] += math.fabs(change)
            elif ties.place.at[known - m.storages] < 0:
                ties.given.at[k] = 0
            else:
                at = k * ties.leaders + ties.place.at[known - m.storages]
                ties.factor.at[at] -= change
                ties.size.at[at] += math.fabs(change)
    for s in range(m.storages):
        if math.fabs(w.here[s]) > ALONG * w.reach[s]:
            ties.given.at[k] = 0


def dense_share(ways: Ways, k: int, i: int, count: int) -> float:
    """Return by how much a unit of gap i of `count` moves storage k."""
    share = 0.0
    for p in range(ways.moves_first.at[k], ways.moves_first.at[k + 1]):
        share += ways.moves_by.at[p] * ways.inverse.at[ways.moves.at[p] * count + i]
    return share


def leads(e: Engine, mode: Mode, k: int) -> bool:
    """Whether the rate of source k of a mode moves just what its value does."""
    m = e.model
    ties = mode.ties
    rate_of = m.storages + mode.sources + k
    for s in range(m.storages):
        rate = 0.0
        row = mode.rate_row[s]
        for p in range(mode.direct.first.at[row], mode.direct.first.at[row + 1]):
            if mode.direct.column.at[p] == rate_of:
                rate = mode.direct.value.at[p]
        rate *= way_of_rate(m, s)
        at = s * ties.leaders + ties.place.at[k]
        if math.fabs(ties.factor.at[at] - rate) > ALONG * max(ties.size.at[at], math.fabs(rate)):
            return False
    return True
