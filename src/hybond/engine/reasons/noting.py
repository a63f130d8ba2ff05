"""What was found not to hold: each law, rule or contact is noted once, the first of a run kept."""

from __future__ import annotations

from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.reasons.warned import UNSOUND, add_about, begin_warning
from hybond.engine.words import Ints

ELEMENT: Final = 0
STORAGE: Final = 1
JUNCTION: Final = 2
"""What a law belongs to: the number is that of an element, a stored quantity, a junction."""
UNTOUCHED: Final = 3
"""A jump moved what none of its constraints reaches: the number of a stored quantity."""
UNFIRED: Final = 4
"""A guard held at the end of a step and did not fire: the number of its rule."""
APART: Final = 5
"""A guard began to hold within the instant before and fired in one of its own: its rule."""
IMPACT: Final = 6
"""The speeds of a contact are not those that the law of impacts asks for: its port."""
MANY: Final = 7
"""The laws have another solution, too: the number of an element that takes part."""
BALANCE: Final = 8
"""Energy of steps comes from nowhere, or is lost: the storage that moved most of it."""
MOVES: Final = 9
"""What is stored does not move by the rate that is shown: its number."""
CREATED: Final = 10
"""A jump has created energy: the storage that has got most of it."""

ENDS: Final = 11
"""The solution of laws that the motion followed ends: the number of an element that takes part."""
PULLS: Final = 12
"""A law of one side pulls on the mean of fast switching: its port."""


def note_violation(
    e: Engine, mode: Mode, t: float, what: int, index: int, off: float, size: float
) -> None:
    """Note what does not hold, `off` being what is left where its terms add up to `size`."""
    note_in_state(e, mode.state, t, what, index, off, size)


def note_in_state(
    e: Engine, state: Ints, t: float, what: int, index: int, off: float, size: float
) -> None:
    """Note what did not hold at a time when machines were in these states."""
    m = e.model
    c = e.checks
    if c.violated == 0:
        c.what = what
        c.index = index
        c.off = off
        c.t = t
    c.violated += 1
    at = place_of(e, what) + index
    if c.said[at] != 0:
        return
    c.said[at] = 1
    if m.tells == 0:
        return
    begin_warning(e.warned, UNSOUND, t)
    add_about(e.warned, float(what))
    add_about(e.warned, float(index))
    add_about(e.warned, off)
    add_about(e.warned, size)
    for k in range(m.machines):
        add_about(e.warned, float(state[k]))


def place_of(e: Engine, what: int) -> int:
    """Return where what is known of all laws of a kind begins."""
    m = e.model
    rules = m.rule_first[m.machines]
    at = 0
    if what > ELEMENT:
        at += m.elements
    if what > STORAGE:
        at += m.storages
    if what > JUNCTION:
        at += m.junctions
    if what > UNTOUCHED:
        at += m.storages
    if what > UNFIRED:
        at += rules
    if what > APART:
        at += rules
    if what > IMPACT:
        at += m.ports
    if what > MANY:
        at += m.elements
    if what > BALANCE:
        at += m.storages
    if what > MOVES:
        at += m.storages
    if what > CREATED:
        at += m.storages
    if what > ENDS:
        at += m.elements
    return at
