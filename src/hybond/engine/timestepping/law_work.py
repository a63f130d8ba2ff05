"""What laws of junctions carry and give in a step."""

from __future__ import annotations

from hybond.engine.engine import Engine
from hybond.engine.laws.law_records import Ports
from hybond.engine.laws.ports import times_partner
from hybond.engine.model import Model
from hybond.engine.timestepping.step_records import Stepping


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
