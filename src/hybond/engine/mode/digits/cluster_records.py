"""Storages that settle together within a moment of the run."""

from __future__ import annotations

from hybond.engine.algebra.blocks import Block, Places, make_block, make_places
from hybond.engine.words import record


@record
class Cluster:
    """Storages that settle together, `many` of them, and the factors of what they settle by."""

    many: int
    member: Places
    place: Places
    """Of each storage, where it is among them."""
    after: Places
    """Of each storage, the next one that settles with it, and of the first of them the last."""
    last: Places
    matrix: Block
    rest: Block
    row: Places
    solved: Block
    solved_rest: Block
    bound: Block


def make_cluster(storages: int) -> Cluster:
    """Return room for none."""
    c = Cluster()
    c.member = make_places(1)
    c.place = make_places(storages)
    c.after = make_places(storages)
    c.last = make_places(storages)
    c.matrix = make_block(1)
    c.rest = make_block(1)
    c.row = make_places(1)
    c.solved = make_block(1)
    c.solved_rest = make_block(1)
    c.bound = make_block(1)
    return c
