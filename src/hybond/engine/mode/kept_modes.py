"""The modes that a run keeps, found by their configurations; the least recently used goes.

Configurations of one bucket are a chain: `bucket` has its first mode, `Mode.behind` the next one.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.engine import BUCKETS, NO_MODE, Engine
from hybond.engine.mode.mode_records import KEPT, PACES, Mode, make_mode
from hybond.engine.mode.mode_sizes import numbers_of
from hybond.engine.words import Ints, records, some

ROOM: Final = 16777216.0
"""Numbers that the modes kept may take, 128 MiB: of large modes fewer are kept. Each new one takes
the place of the one that was used least recently then, with what that had of room.

A quarter of what a run of 10,000 elements may take in all; 64 modes of a thousand elements fit."""
FEWEST: Final = 8
"""Modes kept whatever they take: an instant goes through some, and comes back to the first."""


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
    if at < e.modes_kept and has_room(e):
        e.modes[at] = make_mode(e.model)
        e.modes_made += 1
    else:
        at = 0
        for k in range(e.modes_made):
            if some(e.modes[k]).used < some(e.modes[at]).used:
                at = k
        forget_mode(e, at)
    mode = some(e.modes[at])
    for k in range(n):
        mode.state[k] = key[k]
    own = bucket_of(n, key)
    mode.behind = e.bucket[own]
    mode.pace = own % PACES
    mode.longest = 0.0
    e.bucket[own] = at
    return at


def has_room(e: Engine) -> bool:
    """Whether one more mode may be kept beside those that are."""
    together = e.modes_kept - KEPT
    if e.modes_made < FEWEST + together:
        return True
    taken = 0.0
    for k in range(e.modes_made):
        taken += numbers_of(e.model, some(e.modes[k]))
    return taken < ROOM


def keep_together(e: Engine, many: int) -> None:
    """Let so many modes more be kept than others need: that many are used together."""
    n = KEPT + many
    if n <= e.modes_kept:
        return
    more = records(Mode, n)
    for k in range(e.modes_made):
        more[k] = some(e.modes[k])
    e.modes = more
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
    found = 0
    for k in range(n):
        found = (31 * found + key[k]) % BUCKETS
    return found


def is_same(n: int, a: Ints, b: Ints) -> bool:
    """Whether two configurations are the same."""
    for k in range(n):
        if a[k] != b[k]:
            return False
    return True
