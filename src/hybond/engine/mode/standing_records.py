"""What a run knows of storages that stand while a motion lasts."""

from __future__ import annotations

from hybond.engine.algebra.blocks import Block, make_block
from hybond.engine.mode.sum_records import Sums, make_sums
from hybond.engine.words import Floats, Ints, floats, ints, record


@record
class Standing:
    """The storages that stand, and room to find them."""

    some: bool
    """Whether there are any."""
    stands: Ints
    """Of each storage: whether nothing moves it in the present motion."""
    sums: Sums
    rate: Floats
    size: Floats
    """The rates of storages at the beginning of the motion, and what their terms add up to."""
    row: Ints
    """The storages that have an equation in `matrix`, ..."""
    taken: Ints
    """... and whether one is solved for what a storage holds."""
    matrix: Block


def make_standing(storages: int) -> Standing:
    """Return room for so many storages, none of which stands."""
    s = Standing()
    s.stands = ints(storages)
    s.sums = make_sums()
    s.rate = floats(storages)
    s.size = floats(storages)
    s.row = ints(storages)
    s.taken = ints(storages)
    s.matrix = make_block(1)
    return s
