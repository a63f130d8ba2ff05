"""Machines that follow others: a switch behind a comparator, a gate behind gates.

Their rules read the states of machines, beside time and inputs alone. Where a machine that they
read slides, each of the modes that are combined has them as they are there, and their rules rest;
what these ask for in each mode is watched.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.inputs.interval import set_time
from hybond.engine.model import Model
from hybond.engine.surfaces.corners import cross_as_one
from hybond.engine.surfaces.slide_records import Slide
from hybond.engine.words import Ints

NONE: Final = -1


def let_follow(e: Engine, state: Ints) -> None:
    """Put machines that follow others where the states of these lead them.

    All fire together, as in an instant; chains end, since none of them follows itself.
    """
    m = e.model
    moved = m.followers > 0
    if moved:
        set_time(e, e.slide.led, e.t)
    for _ in range(m.followers):
        if not moved:
            return
        moved = False
        put_states(m, e.slide, state)
        for j in range(m.followers):
            rule = first_holding(e, m.follower[j], state[m.follower[j]])
            if rule != NONE:
                state[m.follower[j]] = m.rule_target[rule]
                moved = True


def put_states(m: Model, s: Slide, state: Ints) -> None:
    """Write the states of machines, for rules that read nothing else."""
    first = m.on_slot + m.switches
    for k in range(m.state_first[m.machines]):
        s.led[first + k] = 0.0
    for machine in range(m.machines):
        s.led[first + m.state_first[machine] + state[machine]] = 1.0


def first_holding(e: Engine, machine: int, state: int) -> int:
    """Return the first rule that leads a machine away from a state, NONE if there is none."""
    m = e.model
    for rule in range(m.rule_first[machine], m.rule_first[machine + 1]):
        # not those by which a machine leaves where it has landed
        asked = m.rule_source[rule] == state and m.rule_landed[rule] == 0
        if asked and value(m, m.rule_value[rule], e.slide.led) != 0.0:
            return rule
    return NONE


def goes_along(m: Model, s: Slide, machine: int) -> bool:
    """Whether a machine follows one that slides, or crosses its surface together with it."""
    for other in range(m.surfaces):
        if m.surface_machine[other] != machine:
            continue
        for i in range(s.many):
            if cross_as_one(m, s.surface[i], other):
                return True
    return is_led(m, s, machine)


def is_led(m: Model, s: Slide, machine: int) -> bool:
    """Whether a machine follows one that slides."""
    for j in range(m.followers):
        if m.follower[j] != machine:
            continue
        for p in range(m.follower_first[j], m.follower_first[j + 1]):
            for i in range(s.many):
                if m.surface_machine[s.surface[i]] == m.follower_reads[p]:
                    return True
    return False
