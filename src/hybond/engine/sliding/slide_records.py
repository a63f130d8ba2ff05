"""What a run keeps of motion along switching surfaces."""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import Block, make_block
from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, floats, ints, record

MOST: Final = 32
"""Most surfaces that are slid on, or decided on, at once."""


@record
class Slide:
    """The surfaces slid on, and the combination of modes in the present one.

    ``surface[0 .. many - 1]`` are the surfaces slid on, `many` 0 if none. In the mode taken last
    `k` of them, ``side``, have modes on both sides: `part` are these modes by number, all below
    first, then one each with only that machine above. After programs/combined.py, Combined.
    """

    many: int
    surface: Ints
    k: int
    side: Ints
    part: Ints
    # modes with different constraints are held to all of them: programs/common_space.py
    common: bool
    holders: int
    holder: Ints
    held: int
    """Constraints of all holders, one after the other."""
    areas: int
    directions: Block
    moves: Block
    off: Block
    off_size: Block
    slope: Block
    inverse: Block
    # the combination at one point
    known: bool
    at: Floats
    """The time, signals and stored quantities that the rest belongs to."""
    weight: Floats
    coefficient: Floats
    w: Floats
    w_size: Floats
    """The size of the terms that made each bond variable."""
    rate: Floats
    solution: Floats
    """Of each part, a row of bond variables."""
    part_rate: Floats
    plain_speed: Floats
    part_speed: Floats
    """Of each part, a row: how fast each function moves."""
    change: Floats
    """How the weights, columns, move the functions, rows."""
    margin: Floats
    """How far each surface is from being left, below, then above."""
    v: Floats
    state: Ints
    target: Ints
    x: Floats
    rates: Floats
    rates2: Floats
    drift: Floats
    drift_size: Floats
    # what is decided after an event
    met: int
    met_surface: Ints
    sides: Ints
    best: Ints
    best_weight: Floats
    trial_side: Ints
    matrix: Floats
    right: Floats
    pivot: Ints
    number: Ints
    """Of storages: what has been visited; of bonds, on the way from a bond to a storage."""
    seen: Ints
    around: Ints
    """The mode whose neighbours are looked at."""
    settled: Ints
    mark: Ints
    chosen: Ints
    kept_met: Ints
    signal: Floats
    keep: Floats
    y: Floats
    ways: Block
    """Weights of the ways on."""


def make_slide(m: Model) -> Slide:
    """Return room for sliding."""
    s = Slide()
    n = m.storages + m.integrals
    s.surface = ints(MOST)
    s.side = ints(MOST)
    s.part = ints(MOST + 1)
    s.holder = ints(MOST + 1)
    s.directions = make_block(1)
    s.moves = make_block(1)
    s.off = make_block(1)
    s.off_size = make_block(1)
    s.slope = make_block(1)
    s.inverse = make_block(1)
    s.at = floats(n + 1)
    s.weight = floats(MOST)
    s.coefficient = floats(MOST + 1)
    s.w = floats(2 * m.bonds)
    s.w_size = floats(2 * m.bonds)
    s.rate = floats(n)
    s.solution = floats((MOST + 1) * 2 * m.bonds)
    s.part_rate = floats((MOST + 1) * n)
    s.plain_speed = floats((MOST + 1) * MOST)
    s.part_speed = floats((MOST + 1) * MOST)
    s.change = floats(MOST * MOST)
    s.margin = floats(2 * MOST)
    s.v = floats(2 * m.slots)
    s.state = ints(m.machines)
    s.target = ints(m.machines)
    s.x = floats(m.storages)
    s.rates = floats(n)
    s.rates2 = floats(m.storages)
    s.drift = floats((MOST + 1) * (m.storages + 1))
    s.drift_size = floats((MOST + 1) * (m.storages + 1))
    s.met_surface = ints(max(m.surfaces, 1))
    s.sides = ints(MOST)
    s.best = ints(MOST)
    s.best_weight = floats(MOST)
    s.trial_side = ints(MOST)
    s.matrix = floats(MOST * MOST)
    s.right = floats(MOST)
    s.pivot = ints(MOST)
    s.seen = ints(m.bonds)
    s.number = ints(m.bonds)
    s.around = ints(m.machines)
    s.settled = ints(m.machines)
    s.mark = ints(m.machines)
    s.chosen = ints(max(m.surfaces, MOST))
    s.kept_met = ints(max(m.surfaces, 1))
    s.signal = floats(m.integrals)
    s.keep = floats(m.storages)
    s.y = floats(n)
    if m.tells != 0:
        s.ways = make_block(8)
    return s
