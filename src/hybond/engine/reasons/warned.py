"""What a run warns of: numbers, in rows, for whoever puts them into words.

Only where somebody will read it: `tells` of the model.
"""

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
from hybond.engine.words import record

NOT_UNIQUE: Final = 1
"""Several ways lead on from surfaces. Numbers: how many, then each surface with its side."""
NO_WAY_ON: Final = 2
"""None does. Numbers: the surfaces."""
TWIN_SURFACES: Final = 3
"""Two machines switch on one surface. Numbers: that which slides, that which does not."""
LOST_BETWEEN: Final = 4
"""Between the ends of steps laws brought what was not stored. Numbers: the energy that this is, J,
and what there was; said at the end."""
THROWS_BACK: Final = 5
"""The jump on crossing a surface throws back by more than was gained. Its number."""
SECOND_ANSWER: Final = 6
"""Laws of junctions have more than one answer. Numbers: why one is taken, how many answers, whether
there are more, then each port with its branches, those that are taken first."""
IMPULSIVE: Final = 7
"""Laws declared impulsive enter a jump. Numbers: their elements."""
LEFT_OPEN: Final = 8
"""A guard reads what the equations leave open. Numbers: the rule, 1 at the instant or 2
before it, the states, bond variables."""
FAR_APART: Final = 9
"""Elements lie far apart. Numbers: the least part that counts, the most that does not, states."""
UNREST: Final = 10
"""Why a contact cannot rest at which impacts accumulate. Numbers: see `unrest`."""

WITHOUT_END: Final = 11
"""Crossings of a surface make stored quantities jump without an end. Its number; said once."""
SHARES_OPEN: Final = 12
"""Laws leave open over a step who carries what. Numbers: their ports."""
FIRES_ALWAYS: Final = 13
"""A machine fires at the end of every step. Its number."""
NEXT_DECIDES: Final = 14
"""Laws cannot decide at an instant: the next step does. No numbers."""
UNSOUND: Final = 15
"""A law does not hold. Numbers: what it belongs to (an element, a storage, a junction), its number
there, what is left of it, the size of its terms, then the states of the mode."""

HELD_AT_REST: Final = 16
"""Friction that slides by its branch is held at rest by others. Its port; said once."""
MODULUS_JUMPS: Final = 17
"""What moduli read jumps. Numbers: their two-ports."""
IMPULSE_LEFT_OUT: Final = 18
"""A source reads an impulse and does not give what it says of it. Numbers: the source, and how."""
COURSE_UNSEEN: Final = 19
"""What time or a phase does is not seen. Numbers: who says it, as `course_place` of the model; why
not, 0: it has no bound there, 1: fixed steps are too long, 2: a phase is not foreseen."""
MADE_BY_STEPS: Final = 20
"""Steps of a fixed length have made energy, or lost it. Numbers: how much, of how much, J."""
SWINGS: Final = 21
"""Implicit steps swing about a law that is steep without bound. Numbers: the storage whose rate
does, by how much, the largest of that kind; said once."""
GUARD_AT_REST: Final = 22
"""A threshold is where the motion comes to rest. Numbers: the rule; 0: it would hold by rounding
and does not fire, then what its comparison has and the size of the terms of that; 1: it fires, but
the run cannot tell when, then what it has in the limit and what the run can tell; said once."""
UNRESOLVED: Final = 23
"""Rounding of what a law carries, or blocks, is not small beside it. Numbers: the rule, how much
that was at the most, and its rounding; said once."""

ROOT: Final = 24
"""No warning: of laws with several solutions, a point of the one that is followed, for who looks
into the motion. Numbers: all bond variables."""

ANOTHER: Final = 25
"""Laws have another solution than the one taken. Numbers: why it is said, an element, a bond
variable, what that is and what it might be; said once of each kind of why."""

RATES_APART: Final = 26
"""The rate of a storage is not what it moved by. Numbers: the storage, for how long, the most that
it was apart, what it moved by then, and when; said once, at the end."""


@record
class Warned:
    """Rows of warnings: `kind`, `time`, and ``number[first[k]]`` to ``number[first[k + 1] - 1]``.

    `far_apart` is whether elements were found to lie far apart, `swings` whether steps swing: that
    is said once.
    """

    rows: int
    kind: Places
    first: Places
    time: Block
    numbers: int
    number: Block
    far_apart: bool
    swings: bool


def make_warned() -> Warned:
    """Return no warnings."""
    w = Warned()
    w.kind = make_places(4)
    w.first = make_places(4)
    w.time = make_block(4)
    w.number = make_block(16)
    return w


def begin_warning(w: Warned, kind: int, t: float) -> None:
    """Begin a row; its numbers are added to it."""
    grow_places(w.kind, w.rows + 1)
    grow_places(w.first, w.rows + 2)
    grow_block(w.time, w.rows + 1)
    w.kind.at[w.rows] = kind
    w.time.at[w.rows] = t
    w.first.at[w.rows] = w.numbers
    w.rows += 1
    w.first.at[w.rows] = w.numbers


def add_about(w: Warned, number: float) -> None:
    """Add a number to the last row."""
    grow_block(w.number, w.numbers + 1)
    w.number.at[w.numbers] = number
    w.numbers += 1
    w.first.at[w.rows] = w.numbers


def take_back_warning(w: Warned, row: int) -> None:
    """Take back one row."""
    first = w.first.at[row]
    many = w.first.at[row + 1] - first
    for k in range(first, w.numbers - many):
        w.number.at[k] = w.number.at[k + many]
    for k in range(row, w.rows - 1):
        w.kind.at[k] = w.kind.at[k + 1]
        w.time.at[k] = w.time.at[k + 1]
        w.first.at[k] = w.first.at[k + 1] - many
    w.numbers -= many
    w.rows -= 1
    w.first.at[w.rows] = w.numbers


def forget_warned(w: Warned) -> None:
    """Forget the rows that were read."""
    w.rows = 0
    w.numbers = 0
