"""The largest energy that each island has held in the run: what rounding there is measured by.

What stands beside, connected by nothing, has no part in it: a circuit of nanojoules keeps its own
digits beside a flywheel.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.storage import constant_energies, constant_energy, energy_of
from hybond.engine.mode.sum_records import Sums
from hybond.engine.model import Model
from hybond.engine.words import Floats

STORED: Final = 10.0
"""Rounding of a bond variable is measured by this multiple of what the energy of its island would
make of it."""


def see_energy(e: Engine, x: Floats) -> None:
    """Learn how large the energy of a state is."""
    m = e.model
    total = math.fabs(energy_of(e, x))
    e.energy = max(e.energy, total)
    if m.islands == 1:
        e.island_energy[0] = max(e.island_energy[0], total)
        return
    for i in range(m.islands):
        e.island_energy[i] = max(e.island_energy[i], math.fabs(e.work.counted_island[i]))


def energy_there(e: Engine, x: Floats, island: int) -> float:
    """Return the magnitude of the energy of a state on an island."""
    total = energy_of(e, x)
    return math.fabs(total if e.model.islands == 1 else e.work.counted_island[island])


def see_constant_energy(e: Engine, x: Floats) -> None:
    """Learn how large that of storages whose laws are linear is."""
    m = e.model
    total = math.fabs(constant_energy(m, x))
    e.energy = max(e.energy, total)
    if m.islands == 1:
        e.island_energy[0] = max(e.island_energy[0], total)
        return
    own = e.work.island_here
    constant_energies(m, x, own)
    for i in range(m.islands):
        e.island_energy[i] = max(e.island_energy[i], math.fabs(own[i]))


def find_reaches(e: Engine) -> None:
    """Put what ``mode.seen`` is a factor of on each island there; nothing where there are no laws.

    It is asked for before `reach_of_bond` and `reach_of_sum`, once for all of them.
    """
    m = e.model
    for i in range(m.islands):
        e.work.island_reach[i] = STORED * math.sqrt(e.island_energy[i]) if m.laws > 0 else 0.0


def reach_of_bond(e: Engine, mode: Mode, b: int) -> float:
    """Return how far bond variable `b` of a mode may reach, by what is stored on its island."""
    return e.work.island_reach[island_of(e.model, b)] * mode.seen[b]


def reach_of_sum(e: Engine, s: Sums, a: int) -> float:
    """Return how far sum `a` may reach likewise."""
    total = 0.0
    for i in range(s.islands):
        total += e.work.island_reach[i] * s.seen.at[a * s.islands + i]
    return total


def island_of(m: Model, b: int) -> int:
    """Return the island of bond variable `b`."""
    return m.bond_island[b if b < m.bonds else b - m.bonds]
