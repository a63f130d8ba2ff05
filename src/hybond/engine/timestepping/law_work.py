"""What laws of junctions carry and give in a step: they take energy, and give none of their own."""

from __future__ import annotations

from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.laws.law_records import Ports
from hybond.engine.laws.ports import open_mode, times_partner
from hybond.engine.mode.part_energies import find_energies
from hybond.engine.model import Model
from hybond.engine.timestepping.step_records import Coupled, Stepping

GIVES_PART: Final = 0.05
"""Share of the largest energy of its part so far that a law may give in a step. What conducts more
and more gives what the resistor beside it takes: of second order in the step."""
GIVES_STIFF: Final = 1e-12
"""The same where a step is so long that something in it would ring with ``theta = 1/2``: rounding.
There what laws give adds up, step after step."""
RINGS: Final = 0.5
"""Part of a state that is left of it in a step with ``theta = 1/2`` where it begins to ring."""


def none_carries(m: Model, s: Stepping) -> bool:
    """Whether no law carries anything in a step."""
    nothing = True
    for k in range(m.ports):
        nothing = nothing and s.l[k] == 0.0
    return nothing


def work_of_laws(e: Engine, s: Stepping, p: Ports, h: float) -> float:
    """Return what laws give in a step, J: ``h l`` times the mean of their `w`."""
    m = e.model
    times_partner(m, p, s.mean, s.wl)
    worked = 0.0
    for k in range(m.ports):
        if m.port_pseudo[k] == 0:
            worked += h * s.l[k] * s.wl[k]
    return worked


def laws_give(e: Engine, s: Stepping) -> bool:
    """Whether any law gave much in a step, but one that rebounds, whose velocity is averaged."""
    m = e.model
    h = s.now.h
    mode = open_mode(e, e.laws.now)
    find_energies(e, mode)
    most = GIVES_STIFF if rings(s.now) else GIVES_PART
    for k in range(m.ports):
        if m.port_pseudo[k] == 0 and s.restitution[k] == 0.0:
            first = m.end_first[m.port_junction[k]]
            here = e.energy
            if first < m.end_first[m.port_junction[k] + 1]:
                here = mode.part_energy[mode.bond_part[m.end_bond[first]]]
            if h * s.l[k] * s.wl[k] > most * here:
                return True
    return False


def rings(c: Coupled) -> bool:
    """Whether a step is longer than what relaxes in it by itself."""
    for k in range(c.n):
        if c.inverse.at[k * c.n + k] < RINGS:
            return True
    return False
