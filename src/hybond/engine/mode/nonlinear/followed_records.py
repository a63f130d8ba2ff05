"""The solution that a motion follows, of laws that may have several."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import Block, Places, make_block, make_places
from hybond.engine.words import record

UNKNOWN: Final = 0
NEVER: Final = 1
MAY: Final = 2
"""Whether laws may have several solutions: it was not asked, they have one, they may have more."""


@record
class Branch:
    """The solution of laws that was followed through the last step: its `points`.

    `several` says whether there may be others, and is one to follow; `others` whether there may be,
    followed or not, and ``open_unknown`` which unknowns may have other values there. Where `known`,
    bond variables were ``root`` at the times `when`, a row each; between two points the solution is
    as good as straight. Where `ended` it leads no further than to the last of them. `basis` counts
    how often rows were eliminated.
    """

    several: int
    others: int
    open_unknown: Places
    known: bool
    ended: bool
    points: int
    basis: int
    since: float
    """Which of the solutions kept a mode last began at, so that it begins at the newest."""
    when: Block
    root: Block
    own: Block
    """Bond variables as the step has left them."""


@record
class Following:
    """Room to follow a solution, and to see whether there may be others."""

    sign: Block
    """Of each group of laws: that of the determinant of slopes at the last point; 0 if it has none;
    ..."""
    now: Block
    signs_there: Block
    """... and elsewhere."""
    found: Block
    """Bond variables at the end of a part of the step; ..."""
    y: Block
    """... a state within it; ..."""
    here: Block
    first: Block
    there: Block
    middle: Block
    """... unknowns where a part of it begins, after one step of Newton's, at its end, and half
    way; ..."""
    rated: bool
    rate: Block
    """... the rates at which they went through the last part, if these are known; ..."""
    known_here: Block
    """... and what is known where the step begins, where it ends, and at the last point."""
    square: Block
    parts: Block
    row_size: Block
    part_from: Places
    chosen: Places
    product: Block
    pivot: Places
    values: Block
    """Of those who tell whether laws that hang together have one solution, see `one_root`."""
    root_here: Block
    begun: Block
    another: Block
    """Bond variables as they are; unknowns that begin elsewhere; bond variables as they might be.
    """
    begun_at: int
    """Which unknown begins elsewhere first."""
    patience: int
    """How many more times steps that do not settle are made shorter there."""
    jumped_at: float
    """When what is known jumps in the last step, so that no solution goes on; infinity: it does
    not."""
    spent: float
    """Multiplications that another solution was looked for with."""
    asked: Places
    due: Places
    """How often another solution might have been looked for, of those who choose one and of those
    who follow none, and from when on it is again; NO_MORE: it was told."""


def make_branch() -> Branch:
    """Return none."""
    b = Branch()
    b.several = UNKNOWN
    b.others = UNKNOWN
    b.open_unknown = make_places(1)
    b.when = make_block(1)
    b.root = make_block(1)
    b.own = make_block(1)
    return b


def make_following() -> Following:
    """Return that room."""
    f = Following()
    f.sign = make_block(1)
    f.now = make_block(1)
    f.signs_there = make_block(1)
    f.found = make_block(1)
    f.y = make_block(1)
    f.here = make_block(1)
    f.first = make_block(1)
    f.there = make_block(1)
    f.middle = make_block(1)
    f.rate = make_block(1)
    f.known_here = make_block(1)
    f.square = make_block(1)
    f.parts = make_block(1)
    f.row_size = make_block(1)
    f.part_from = make_places(1)
    f.chosen = make_places(1)
    f.product = make_block(1)
    f.pivot = make_places(1)
    f.values = make_block(1)
    f.root_here = make_block(1)
    f.begun = make_block(1)
    f.another = make_block(1)
    f.jumped_at = math.inf
    f.asked = make_places(2)
    f.due = make_places(2)
    return f
