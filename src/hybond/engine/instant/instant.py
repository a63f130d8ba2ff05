"""What is written down of an instant: the modes visited, and the transitions that led there."""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import (
    Block,
    Places,
    grow_block,
    grow_places,
    make_block,
    make_places,
)
from hybond.engine.instant.told import BY_LAW, Told, add_row, forget_told, make_told
from hybond.engine.words import record

MYTHICAL: Final = 0
PINNACLE: Final = 1
CONTINUOUS: Final = 2
START: Final = 0
GUARD: Final = 1
TIME: Final = 2
INPUT: Final = 3
ACCUMULATION: Final = 4
SAMPLE: Final = 6
CHANGE: Final = 7
"""Parameters or inputs of a run that goes on were set."""
LAW: Final = 10
"""A source, or what modulates one, jumps onto what is stored."""


@record
class Instant:
    """The steps of an instant, each with the transitions that entered its mode."""

    t: float
    since: float
    """When the step began within which it happened; -1: it was located."""
    cause: int
    by_dust: bool
    """Whether machines crossed surfaces and were led back by next to nothing: back_by_dust.py."""
    steps: int
    kind: Places
    hits: int
    hit_first: Places
    """Of each step: the impulses that passed, in `hit_bond` and `hit_area`."""
    hit_bond: Places
    hit_area: Block
    hit_floor: Block
    """Below what size an impulse of that kind counts as none."""
    energies: Places
    """Whether the energy of each step is known: before, after, and what sources gave."""
    energy: Block
    opens: int
    open_first: Places
    open: Places
    """Of each step: bond variables that its equations leave open."""
    first: Places
    """Of each step: its transitions."""
    fired: int
    machine: Places
    source: Places
    target: Places
    reason: Places
    """Of each transition: its row in `told`."""
    told: Told
    # what fired last, on its way to a step
    waiting: int
    wait_machine: Places
    wait_source: Places
    wait_target: Places
    wait_reason: Places


def make_instant() -> Instant:
    """Return an instant at which nothing happened."""
    i = Instant()
    i.kind = make_places(16)
    i.hit_first = make_places(16)
    i.hit_bond = make_places(16)
    i.hit_area = make_block(16)
    i.hit_floor = make_block(16)
    i.energies = make_places(16)
    i.energy = make_block(16)
    i.open_first = make_places(16)
    i.open = make_places(16)
    i.first = make_places(16)
    i.machine = make_places(16)
    i.source = make_places(16)
    i.target = make_places(16)
    i.reason = make_places(16)
    i.told = make_told()
    i.wait_machine = make_places(16)
    i.wait_source = make_places(16)
    i.wait_target = make_places(16)
    i.wait_reason = make_places(16)
    return i


def begin_instant(i: Instant, t: float, cause: int) -> None:
    """Forget what was written down."""
    i.t = t
    i.since = -1.0
    i.cause = cause
    i.by_dust = False
    i.steps = 0
    i.hits = 0
    i.fired = 0
    i.waiting = 0
    i.opens = 0
    forget_told(i.told)


def room_for_waiting(i: Instant, n: int) -> None:
    """Make room for so many transitions on their way: their columns are of one length."""
    if n > i.wait_machine.size:
        grow_places(i.wait_machine, n)
        grow_places(i.wait_source, n)
        grow_places(i.wait_target, n)
        grow_places(i.wait_reason, n)


def room_for_fired(i: Instant, n: int) -> None:
    """Make room for so many transitions of steps."""
    if n > i.machine.size:
        grow_places(i.machine, n)
        grow_places(i.source, n)
        grow_places(i.target, n)
        grow_places(i.reason, n)


def room_for_visits(i: Instant, n: int) -> None:
    """Make room for so many steps, and for where what belongs to each begins, and ends."""
    if n >= i.kind.size:
        grow_places(i.kind, n + 1)
        grow_places(i.energies, n + 1)
        grow_places(i.first, n + 1)
        grow_places(i.hit_first, n + 1)
        grow_places(i.open_first, n + 1)


def note_fired(i: Instant, machine: int, source: int, target: int) -> None:
    """Note a transition into the mode that is tried next; why may be told behind it."""
    room_for_waiting(i, i.waiting + 1)
    i.wait_machine.at[i.waiting] = machine
    i.wait_source.at[i.waiting] = source
    i.wait_target.at[i.waiting] = target
    row = add_row(i.told, BY_LAW)
    i.wait_reason.at[i.waiting] = row
    i.waiting += 1


def drop_fired(i: Instant) -> None:
    """Forget the transitions into the mode that was tried."""
    i.waiting = 0


def note_hit(i: Instant, bond: int, area: float, floor: float) -> None:
    """Note an impulse of the step that is noted next, and what would be none."""
    grow_places(i.hit_bond, i.hits + 1)
    grow_block(i.hit_area, i.hits + 1)
    grow_block(i.hit_floor, i.hits + 1)
    i.hit_bond.at[i.hits] = bond
    i.hit_area.at[i.hits] = area
    i.hit_floor.at[i.hits] = floor
    i.hits += 1


def is_struck(i: Instant, step: int) -> bool:
    """Whether impulses passed in a step."""
    return i.hit_first.at[step] < i.hit_first.at[step + 1]


def note_step(i: Instant, kind: int) -> int:
    """Note a mode visited, entered by what fired last; return its number."""
    room_for_visits(i, i.steps + 1)
    i.kind.at[i.steps] = kind
    i.hit_first.at[0] = 0
    i.hit_first.at[i.steps + 1] = i.hits
    i.first.at[i.steps] = i.fired
    i.energies.at[i.steps] = 0
    i.open_first.at[i.steps] = i.opens
    i.open_first.at[i.steps + 1] = i.opens
    i.steps += 1
    append_fired(i)
    return i.steps - 1


def add_energy(i: Instant, before: float, after: float, given: float) -> None:
    """Note the energy of the last step: stored before and after, and what sources gave."""
    at = 3 * (i.steps - 1)
    grow_block(i.energy, at + 3)
    i.energies.at[i.steps - 1] = 1
    i.energy.at[at] = before
    i.energy.at[at + 1] = after
    i.energy.at[at + 2] = given


def add_open(i: Instant, bond: int) -> None:
    """Note a bond variable that the equations of the last step leave open."""
    grow_places(i.open, i.opens + 1)
    i.open.at[i.opens] = bond
    i.opens += 1
    i.open_first.at[i.steps] = i.opens


def append_fired(i: Instant) -> None:
    """Add what fired last to the transitions of the last step."""
    room_for_fired(i, i.fired + i.waiting)
    for k in range(i.waiting):
        i.machine.at[i.fired] = i.wait_machine.at[k]
        i.source.at[i.fired] = i.wait_source.at[k]
        i.target.at[i.fired] = i.wait_target.at[k]
        i.reason.at[i.fired] = i.wait_reason.at[k]
        i.fired += 1
    i.waiting = 0
    i.first.at[i.steps] = i.fired


def is_new(i: Instant) -> bool:
    """Whether nothing led up to the instant: no motion ended there."""
    return i.cause == START or i.cause == CHANGE
