"""How much each storage would hold if all of an energy were there: what rounding is measured by.

Of a linear law that follows from its slope. Of one that bends the slope at hand says nothing of
that far away: a spring that hardens holds a hundredth of what its slope at rest would have it hold.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.mode.digits.part_energies import find_energies
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.storage import co_energy_of, is_alone, own_stiffness, with_stored
from hybond.engine.words import Floats

LEAST: Final = 1e-150
"""Part of what the slope at hand says that is looked at, at the least."""
TURNS: Final = 60
"""Steps in which it is looked for: halves on a scale of powers, until they are as good as none."""
GOOD: Final = 1.1
"""It is found within this factor."""


def reach_of(e: Engine, mode: Mode, x: Floats, reach: Floats) -> None:
    """Put what each storage would hold with the largest energy that its part of a mode has had."""
    m = e.model
    find_energies(e, mode)
    for k in range(m.storages):
        reach[k] = reach_at(e, k, x, mode.part_energy[mode.bond_part[m.storage_bond[k]]])


def reach_at(e: Engine, k: int, x: Floats, energy: float) -> float:
    """Return what storage k would hold with all of `energy` there.

    By the slope of its law at `x`, and no more than what has that energy by the law itself.
    """
    m = e.model
    if is_alone(m, k):
        return reach_by(math.fabs(m.stiff_constant[m.stiff_first[k]]), energy)
    v = with_stored(e, x)
    most = reach_by(math.fabs(own_stiffness(m, k, v)), energy)
    if m.co_energy[k] < 0 or most == 0.0:
        return most
    held = most if holds(e, k, v, most, energy) else most_held(e, k, v, most, energy)
    v[m.stored_slot + k] = x[k]
    return held


def most_held(e: Engine, k: int, v: Floats, most: float, energy: float) -> float:
    """Return how much of `most`, which is too much, storage k may hold with an energy."""
    low = LEAST * most
    high = most
    for _ in range(TURNS):
        if high <= GOOD * low:
            break
        middle = math.sqrt(low) * math.sqrt(high)
        if holds(e, k, v, middle, energy):
            low = middle
        else:
            high = middle
    return high


def holds(e: Engine, k: int, v: Floats, most: float, energy: float) -> bool:
    """Whether storage k may hold `most`, on one side of zero, with no more than an energy.

    A law that rises has on the second half of the way at least the co-energy of its middle.
    """
    m = e.model
    half = 0.5 * most
    found = False
    for way in range(2):
        x = half if way == 0 else -half
        v[m.stored_slot + k] = x
        found = found or x * co_energy_of(m, k, v) <= energy
    return found


def reach_by(own: float, energy: float) -> float:
    """Return what a storage of that stiffness would hold with all of `energy` there."""
    if not (own > 0.0 and math.isfinite(own) and math.isfinite(energy)):
        return 0.0
    most = math.sqrt(2.0 * energy / own)
    return most if math.isfinite(most) else 0.0
