"""The modes that a run keeps, found by their configurations; the least recently used goes.

Configurations of one bucket are a chain: `bucket` has its first mode, `Mode.behind` the next one.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.engine import BUCKETS, NO_MODE, Engine
from hybond.engine.mode.mode_records import PACES, Mode, make_mode
from hybond.engine.mode.mode_sizes import numbers_of
from hybond.engine.words import Ints, ints, records, some

ROOM: Final = 16777216.0
"""Numbers that the modes kept may take, 128 MiB: of large modes fewer are kept. Each new one takes
the place of the one that was used least recently then, with what that had of room.

A quarter of what a run of 10,000 elements may take in all; 64 modes of a thousand elements fit."""
OF_EACH: Final = 1000.0
"""Numbers that each takes beside its equations."""
FEWEST: Final = 8
"""Modes kept whatever they take: an instant goes through some, and comes back to the first."""
KEYS: Final = 1048573
"""Configurations are told apart by a number below this prime before they are compared."""
FIRST_KEYS: Final = 127
"""The same for the few sizes of steps that are remembered."""


def find_kept(e: Engine, key: Ints) -> int:
    """Return where the mode of a configuration stands, NO_MODE if it is not kept."""
    n = e.model.machines + e.model.discrete
    # at an instant the same mode is asked for again and again
    if e.modes_made > 0 and is_same(n, some(e.modes[e.mode_at]).state, key):
        return e.mode_at
    at = e.bucket[bucket_of(n, key)]
    while at != NO_MODE and not is_same(n, some(e.modes[at]).state, key):
        at = some(e.modes[at]).behind
    return at


def keep_mode(e: Engine, key: Ints) -> int:
    """Return where there is room for the mode of a configuration, from now on found by it."""
    n = e.model.machines + e.model.discrete
    at = e.modes_made
    if has_room(e):
        if at == e.modes_kept:
            make_places_for(e, 2 * at)
        e.modes[at] = make_mode(e.model)
        e.modes_made += 1
    else:
        at = 0
        for k in range(e.modes_made):
            if e.modes_used[k] < e.modes_used[at]:
                at = k
        forget_mode(e, at)
    mode = some(e.modes[at])
    for k in range(n):
        mode.state[k] = key[k]
    own = bucket_of(n, key)
    mode.behind = e.bucket[own]
    mode.pace = number_of(n, key, FIRST_KEYS) % PACES
    mode.longest = 0.0
    e.bucket[own] = at
    return at


def has_room(e: Engine) -> bool:
    """Whether one more mode may be kept beside those that are.

    What they take is counted again when an eighth more were made: modes grow while they are used.
    """
    if e.modes_made < FEWEST + e.modes_together:
        return True
    if e.modes_built >= e.modes_counted:
        taken = 0.0
        for k in range(e.modes_made):
            taken += OF_EACH + numbers_of(e.model, some(e.modes[k]))
        e.modes_size = taken / float(e.modes_made)
        e.modes_counted = e.modes_built + 1 + e.modes_made // 8
    return e.modes_size * float(e.modes_made) < ROOM


def keep_together(e: Engine, many: int) -> None:
    """Let so many modes be kept besides those that an instant goes through: they are one motion."""
    e.modes_together = max(many, e.modes_together)


def make_places_for(e: Engine, n: int) -> None:
    """Make room for n modes, and keep those that are there."""
    more = records(Mode, n)
    used = ints(n)
    for k in range(e.modes_made):
        more[k] = some(e.modes[k])
        used[k] = e.modes_used[k]
    e.modes = more
    e.modes_used = used
    e.modes_kept = n


def forget_mode(e: Engine, at: int) -> None:
    """Take a mode out of its chain."""
    gone = some(e.modes[at])
    own = bucket_of(e.model.machines + e.model.discrete, gone.state)
    if e.bucket[own] == at:
        e.bucket[own] = gone.behind
        return
    before = before_in_chain(e, own, at)
    before.behind = gone.behind


def before_in_chain(e: Engine, own: int, at: int) -> Mode:
    """Return the mode behind which another one stands in a bucket."""
    k = e.bucket[own]
    while some(e.modes[k]).behind != at:
        k = some(e.modes[k]).behind
    return some(e.modes[k])


def bucket_of(n: int, key: Ints) -> int:
    """Return the bucket of a configuration."""
    return number_of(n, key, KEYS) % BUCKETS


def number_of(n: int, key: Ints, below: int) -> int:
    """Return a number for a configuration, the same for some others."""
    found = 0
    for k in range(n):
        found = (31 * found + key[k]) % below
    return found


def is_same(n: int, a: Ints, b: Ints) -> bool:
    """Whether two configurations are the same."""
    for k in range(n):
        if a[k] != b[k]:
            return False
    return True
