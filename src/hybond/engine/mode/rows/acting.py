"""Which states act on which rates: what slopes by differences can be found together.

A rate hangs on what its row reads: on what is stored through the laws of storage, on sources and
laws through what these read, and so on. In a row of a thousand tanks each level acts on three
rates: differences of a third of all levels are found at once. It is told from what laws read,
whether their slopes are zero or not.

Source: A. R. Curtis, M. J. D. Powell, J. K. Reid, "On the estimation of sparse Jacobian matrices",
J. Inst. Math. Appl. 13 (1974).
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import Places, Rows, fit_places
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.acting_records import Acting
from hybond.engine.mode.rows.storage_bonds import rate_bond
from hybond.engine.model import Model
from hybond.engine.words import Ints

FEWEST: Final = 12
"""States below which it is not worth it."""
MOST_ROOM: Final = 8000000
"""Truths that there is room for at the most."""
WORTH: Final = 2
"""States for each group, in the mean, at the least."""


def acting_of(m: Model, mode: Mode, room: Places) -> Acting:
    """Return which states act on which rates in a mode; found once, in `room`.

    There stands what each source hangs on, then each group of laws, then each rate: a truth for
    each state.
    """
    a = mode.acting
    if a.known:
        return a
    a.known = True
    a.groups = 0
    n = m.storages + m.integrals
    sets = mode.sources + max(mode.apart.groups, 1) + 1
    if n < FEWEST or m.laws > 0 or m.disks > 0 or mode.constraints.rows > 0:
        return a
    if mode.dynamics > 0 and (mode.rank != mode.structures or mode.loose > 0):
        return a
    for i in range(mode.dynamics):
        if mode.dynamic[i] < 0:
            return a
    if (sets + n) * n > MOST_ROOM:
        return a
    fit_places(room, (sets + n) * n)
    for k in range((sets + n) * n):
        room.at[k] = 0
    grows = True
    while grows:
        grows = spread(m, mode, room.at, n)
    for k in range(n):
        put_rate(m, mode, room.at, n, k, sets + k)
    list_rates(a, room.at, n, sets)
    group_states(a, room.at, n, sets)
    return a


def spread(m: Model, mode: Mode, room: Ints, n: int) -> bool:
    """Let sources and groups of laws hang on what they read hangs on; whether any is more now."""
    grows = False
    for k in range(mode.sources):
        if mode.source[k] >= 0:
            grows = take_law(m, mode, room, n, mode.source[k], k) or grows
    groups = mode.apart.groups
    for i in range(mode.dynamics):
        g = mode.apart.row_group.at[i] if groups > 0 else 0
        law = m.sources + mode.dynamic[i]
        grows = take_law(m, mode, room, n, law, mode.sources + g) or grows
    return grows


def take_law(m: Model, mode: Mode, room: Ints, n: int, law: int, to: int) -> bool:
    """Let set `to` hang on what a law of the model reads; whether it is more now."""
    grows = False
    for p in range(m.hang_first[law], m.hang_first[law + 1]):
        slot = m.hang_slot[p]
        stored = slot - m.stored_slot
        signal = slot - m.signal_slot
        bond = slot - m.bond_slot
        if stored >= 0 and stored < m.storages:
            grows = add_state(room, n, stored, to) or grows
        elif signal >= 0 and signal < m.integrals:
            grows = add_state(room, n, m.storages + signal, to) or grows
        elif bond >= 0 and bond < 2 * m.bonds:
            grows = take_bond(m, mode, room, n, bond, to) or grows
    return grows


def take_bond(m: Model, mode: Mode, room: Ints, n: int, b: int, to: int) -> bool:
    """Let set `to` hang on what a bond variable is made of; whether it is more now."""
    if mode.dynamics > 0:
        grows = take_knowns(m, mode, mode.finite, room, n, mode.same[b], to)
    else:
        grows = take_knowns(m, mode, mode.direct, room, n, mode.same[b], to)
    frees = mode.finite_frees
    for p in range(
        mode.share_first.at[b] if frees > 0 else 0, mode.share_first.at[b + 1] if frees > 0 else 0
    ):
        g = mode.apart.group_of.at[mode.share_of.at[p]] if mode.apart.groups > 0 else 0
        grows = add_set(room, n, mode.sources + g, to) or grows
    return grows


def take_knowns(m: Model, mode: Mode, rows: Rows, room: Ints, n: int, row: int, to: int) -> bool:
    """Let set `to` hang on the knowns in a row; whether it is more now."""
    grows = False
    for i in range(rows.first.at[row], rows.first.at[row + 1]):
        known = rows.column.at[i]
        if known < m.storages:
            grows = take_storage(m, mode, room, n, known, to) or grows
        else:
            source = (known - m.storages) % max(mode.sources, 1)
            grows = add_set(room, n, source, to) or grows
    return grows


def take_storage(m: Model, mode: Mode, room: Ints, n: int, k: int, to: int) -> bool:
    """Let set `to` hang on what the co-energy of a storage reads; whether it is more now."""
    grows = take_law(m, mode, room, n, m.sources + m.dynamics + k, to)
    for p in range(m.stiff_first[k], m.stiff_first[k + 1]):
        grows = add_state(room, n, m.stiff_other[p], to) or grows
    return grows


def put_rate(m: Model, mode: Mode, room: Ints, n: int, k: int, to: int) -> None:
    """Let set `to` hang on what the rate of state k reads."""
    if k < m.storages:
        take_bond(m, mode, room, n, rate_bond(m, k), to)
    else:
        take_law(m, mode, room, n, m.sources + m.dynamics + k, to)


def add_state(room: Ints, n: int, state: int, to: int) -> bool:
    """Let a set hang on a state; whether it did not."""
    new = room[to * n + state] == 0
    room[to * n + state] = 1
    return new


def add_set(room: Ints, n: int, of: int, to: int) -> bool:
    """Let a set hang on all that another one does; whether it is more now."""
    grows = False
    for k in range(n):
        if room[of * n + k] != 0 and room[to * n + k] == 0:
            room[to * n + k] = 1
            grows = True
    return grows


def list_rates(a: Acting, room: Ints, n: int, sets: int) -> None:
    """List the rates that each state acts on."""
    many = 0
    for k in range(n * n):
        many += room[sets * n + k]
    fit_places(a.first, n + 1)
    fit_places(a.rate, many)
    many = 0
    for j in range(n):
        a.first.at[j] = many
        for k in range(n):
            if room[(sets + k) * n + j] != 0:
                a.rate.at[many] = k
                many += 1
    a.first.at[n] = many


def group_states(a: Acting, room: Ints, n: int, sets: int) -> None:
    """Put each state into the first group of which no other one acts on a rate that it acts on."""
    fit_places(a.group, n)
    taken = sets * n
    for k in range(n * n):
        room[taken + k] = 0
    for j in range(n):
        g = 0
        while g < a.groups and is_taken(a, room, n, taken + g * n, j):
            g += 1
        a.group.at[j] = g
        a.groups = max(a.groups, g + 1)
        for p in range(a.first.at[j], a.first.at[j + 1]):
            room[taken + g * n + a.rate.at[p]] = 1
    if WORTH * a.groups > n:
        a.groups = 0


def is_taken(a: Acting, room: Ints, n: int, begin: int, j: int) -> bool:
    """Whether a group acts on a rate that state j acts on."""
    for p in range(a.first.at[j], a.first.at[j + 1]):
        if room[begin + a.rate.at[p]] != 0:
            return True
    return False
