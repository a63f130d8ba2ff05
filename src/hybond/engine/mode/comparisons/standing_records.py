"""What a run knows of storages that stand while a motion lasts."""

from __future__ import annotations

from hybond.engine.algebra.blocks import Block, make_block
from hybond.engine.mode.comparisons.sum_records import Sums, make_sums
from hybond.engine.words import Floats, Ints, floats, ints, record


@record
class Standing:
    """The storages that stand, and room to find them."""

    some: bool
    """Whether there are any."""
    goes_on: bool
    """Whether they are those of the run that goes on here: nothing begins, and none is sought."""
    stands: Ints
    """Of each storage: whether nothing moves it in the present motion."""
    sums: Sums
    rate: Floats
    size: Floats
    """The rates of storages at the beginning of the motion, and what their terms add up to."""
    root: Ints
    """Of each storage the first of those that read each other, with it, ..."""
    behind: Ints
    """... and the one behind it, -1 after the last."""
    place: Ints
    """Where it stands among them."""
    row: Ints
    """The storages that have an equation in `matrix`, ..."""
    taken: Ints
    """... and whether one is solved for what a storage holds."""
    matrix: Block


@record
class Stood:
    """What was found of storages that may stand in a mode, the last time that it was asked.

    Where events elsewhere follow each other fast, each begins a motion: of what holds the same, has
    the same rates and is read by the same, the same is found.
    """

    members: Ints
    """How many read each other, with each storage; 0 where nothing was found, ..."""
    in_flow: Ints
    """... whether by the rows of a flow, ..."""
    stands: Ints
    """... and what."""
    y: Floats
    rate: Floats


def make_standing(storages: int) -> Standing:
    """Return room for so many storages, none of which stands."""
    s = Standing()
    s.stands = ints(storages)
    s.sums = make_sums()
    s.sums.bent = True
    s.rate = floats(storages)
    s.size = floats(storages)
    s.root = ints(storages)
    s.behind = ints(storages)
    s.place = ints(storages)
    s.row = ints(storages)
    s.taken = ints(storages)
    s.matrix = make_block(1)
    return s


def make_stood(storages: int) -> Stood:
    """Return room for so many storages, of which nothing was found."""
    s = Stood()
    s.members = ints(storages)
    s.in_flow = ints(storages)
    s.stands = ints(storages)
    s.y = floats(storages)
    s.rate = floats(storages)
    return s
