"""What a run asks from outside: inputs that are functions, blocks, and whether to go on.

Inputs are of several kinds; that one is a function is known where tables are made, too. Only
runs by hybond itself have such; an export is printed without. A call does not come back where what
was asked raises: the run ends there.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.words import Floats, Outside, floats, given, record

CONSTANT: Final = 0
HELD: Final = 1
LINES: Final = 2
PULSES: Final = 3
FREE: Final = 4
"""Set from outside, and so no part of what selects equations."""
CALLED: Final = 5
"""A function, smooth between the breaks that are its numbers."""


@record
class Calls:
    """Who answers the calls of one run, and room for what a block reads, and then sets."""

    values: Floats
    answers: Outside
    outside: Outside
    """Whoever is to be asked now and then whether the run is to go on; None if nobody is."""
    work: int
    """What was done since that was asked, in products of two numbers or so."""


def make_calls(most: int) -> Calls:
    """Return room for blocks that read, and set, at most so many values."""
    c = Calls()
    c.values = floats(most)
    return c


@given
def call_input(c: Calls, i: int, t: float, piece: int) -> float:
    """Return input i at t, from inside a piece."""
    return float(c.answers.value(i, t, piece))


@given
def call_input_rate(c: Calls, i: int, t: float, piece: int) -> float:
    """Return the time derivative of input i at t within a piece."""
    return float(c.answers.rate(i, t, piece))


@given
def call_block(c: Calls, block: int, t: float) -> None:
    """Let a block compute at t from its inputs, in `values`; its outputs are put there."""
    c.answers.block(block, t, c.values)


@given
def call_outside(c: Calls) -> None:
    """Let whoever looks on do so; a call that raises ends the run."""
    if c.outside is not None:
        c.outside.look()
