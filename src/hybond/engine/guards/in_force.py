"""Which rules are asked: some rest while a machine has landed, or slides."""

from __future__ import annotations

from hybond.engine.contacts.landing_records import in_force
from hybond.engine.engine import Engine
from hybond.engine.surfaces.followers import is_led


def is_asked(e: Engine, machine: int, rule: int, state: int) -> bool:
    """Whether a rule of a machine may lead away from a state."""
    if e.slide.many > 0:
        return is_asked_beside(e, machine, rule, state)
    m = e.model
    return m.rule_source[rule] == state and in_force(m, e.landings, machine, rule)


def is_asked_beside(e: Engine, machine: int, rule: int, state: int) -> bool:
    """Whether it may while surfaces are slid on.

    The rules between the two states of a surface that is slid on rest, those from either to a third
    hold in both; machines that switch on the same surface rest as well, and those that follow.
    """
    m = e.model
    s = e.slide
    if not in_force(m, e.landings, machine, rule):
        return False
    source = m.rule_source[rule]
    target = m.rule_target[rule]
    for j in range(s.many):
        surface = s.surface[j]
        below = m.surface_below[surface]
        above = m.surface_above[surface]
        if m.surface_machine[surface] == machine and (source == below or source == above):
            return target != below and target != above and (state == below or state == above)
    if is_led(m, s, machine):
        return False
    for other in range(m.surfaces):
        if rule != m.surface_up[other] and rule != m.surface_down[other]:
            continue
        for j in range(s.many):
            if m.surface_twin[s.surface[j] * m.surfaces + other] != 0:
                return False
    return source == state
