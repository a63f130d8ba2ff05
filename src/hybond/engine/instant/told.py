"""What is told of a transition: why it fired, what its guard read, which rules it went before."""

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

BY_LAW: Final = -1
"""Why a transition fired if no rule did: complementarity."""
LANDS: Final = -2
"""Impacts accumulate. Read are how many, their limit, and the ratio of intervals (nan: unknown)."""
SLIDES_ON: Final = -3
"""Both sides push into a surface, of which the number is read."""
SLIDES_OFF: Final = -4
"""They do no longer."""
PUSHED_BACK: Final = -5
"""The other surfaces push the machine back."""
THROWN_BACK: Final = -6
"""Its own jump does."""
FOLLOWS: Final = -9
"""It goes along with a machine that slides, or did."""
PARTS: Final = -10
"""A surface has jumped away from what slid on it; its number is read."""
OVER_A_STEP: Final = -7
"""Complementarity over a step. Read are common and net variable of each junction of the law."""
STEP_ENDS: Final = -8
"""What ends the run holds where a step ends, at which nothing could be settled."""


@record
class Told:
    """Rows, one for each transition noted at an instant.

    `why` is the number of the rule, or one of those above. ``first[k]`` is the first of the values
    that were read, each with its impulse and whether it has one, ``over_first[k]`` the first of the
    rules of the same state that held as well, later in the list.
    """

    rows: int
    why: Places
    first: Places
    over_first: Places
    reads: int
    finite: Block
    impulse: Block
    strikes: Places
    overs: int
    over: Places


def make_told() -> Told:
    """Return no rows."""
    t = Told()
    t.why = make_places(16)
    t.first = make_places(16)
    t.over_first = make_places(16)
    t.finite = make_block(16)
    t.impulse = make_block(16)
    t.strikes = make_places(16)
    t.over = make_places(16)
    return t


def forget_told(t: Told) -> None:
    """Forget all rows."""
    t.rows = 0
    t.reads = 0
    t.overs = 0


def add_row(t: Told, why: int) -> int:
    """Add a row; return its number. What is read and passed over is added to the last row."""
    if t.rows + 2 > t.why.size:
        grow_places(t.why, t.rows + 2)
        grow_places(t.first, t.rows + 2)
        grow_places(t.over_first, t.rows + 2)
    t.why.at[t.rows] = why
    t.first.at[t.rows] = t.reads
    t.over_first.at[t.rows] = t.overs
    t.rows += 1
    t.first.at[t.rows] = t.reads
    t.over_first.at[t.rows] = t.overs
    return t.rows - 1


def say_why(t: Told, why: int) -> None:
    """Change why the transition of the last row fired."""
    t.why.at[t.rows - 1] = why


def add_read(t: Told, finite: float, impulse: float, strikes: bool) -> None:
    """Add a value that was read to the last row."""
    if t.reads >= t.finite.size:
        grow_block(t.finite, t.reads + 1)
        grow_block(t.impulse, t.reads + 1)
        grow_places(t.strikes, t.reads + 1)
    t.finite.at[t.reads] = finite
    t.impulse.at[t.reads] = impulse
    t.strikes.at[t.reads] = 1 if strikes else 0
    t.reads += 1
    t.first.at[t.rows] = t.reads


def add_over(t: Told, rule: int) -> None:
    """Add a rule that held as well to the last row."""
    grow_places(t.over, t.overs + 1)
    t.over.at[t.overs] = rule
    t.overs += 1
    t.over_first.at[t.rows] = t.overs
