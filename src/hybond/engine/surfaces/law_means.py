"""Junction laws on the mean of fast switching: what pushes only, pushes on the mean.

In a mode that holds more than others its law carries what brings the state back, by vanishing
impulses. These push as any other impulse of the law does, and so does the mean of all that it
carries: where that would pull, the law lets go. So friction holds up to its limit on the mean. It
may rest on the mean alone (`meant`): what it would have to carry in one mode is not asked.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_part
from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.surfaces.corners import put_coefficients
from hybond.engine.surfaces.surface import part_mode

PULLS: Final = 1e-13
"""A law pulls by more than this part of what it carries; less is rounding."""
REACHED: Final = 1e-9
"""Impulses reach what a law carries if they add up to more than this part of their terms there."""
NONE_PULLS: Final = -1
HELD: Final = 2
"""Friction rests in all modes combined, whatever it would have to carry in one of them."""
RESTS: Final = 0
FORWARD: Final = 1
BACKWARD: Final = 2
"""States of friction: at rest, and as it slips."""
NO_BREAKAWAY: Final = -2
"""What stands for an option that a law does not have."""


def rests_on_mean(e: Engine, machine: int) -> bool:
    """Whether a machine is friction that is asked for what it carries on the mean alone."""
    m = e.model
    for k in range(m.ports if e.slide.k > 0 else 0):
        if m.port_machine[k] == machine and e.slide.meant[k] != 0:
            return True
    return False


def is_meant(e: Engine, k: int) -> bool:
    """Whether the law of port k is held to what it can carry on the mean."""
    s = e.slide
    return s.meant[k] != 0 or (s.common and s.reached[k] != 0)


def find_reached(e: Engine) -> None:
    """Find which laws carry impulses that hold the modes together, into `reached`."""
    m = e.model
    s = e.slide
    for k in range(m.ports):
        s.reached[k] = 0
        row = carried_row(e, k)
        for a in range(s.areas if m.port_planar[k] == 0 else 0):
            total = 0.0
            size = 0.0
            for i in range(m.pair_first[row], m.pair_first[row + 1]):
                term = m.pair_value[i] * s.directions.at[m.pair_column[i] * s.areas + a]
                total += term
                size += math.fabs(term)
            if math.fabs(total) > REACHED * size:
                s.reached[k] = 1


def carried_row(e: Engine, k: int) -> int:
    """Return the row of what the law of port k carries: the net variable of friction."""
    return 2 * k + (1 if e.model.port_two_sided[k] != 0 else 0)


def begin_impulses(e: Engine) -> None:
    """Forget how large the impulses are that hold the modes together."""
    for a in range(e.slide.areas):
        e.slide.area_size.at[a] = 0.0


def put_law_margins(e: Engine) -> None:
    """Put how far laws are from the end of what they can carry, behind the margins of surfaces."""
    m = e.model
    s = e.slide
    for k in range(m.ports):
        s.margin[2 * s.k + k] = room_of(e, k) if is_meant(e, k) else 1.0


def room_of(e: Engine, k: int) -> float:
    """Return how far a law is from that end at the present coefficients, by its terms.

    What it carries is put into `push`.
    """
    m = e.model
    s = e.slide
    row = carried_row(e, k)
    total = 0.0
    size = 0.0
    for part in range(s.parts):
        carried = 0.0
        for i in range(m.pair_first[row], m.pair_first[row + 1]):
            here = s.solution[part * 2 * m.bonds + m.pair_column[i]]
            carried += m.pair_value[i] * here
        total += s.coefficient[part] * carried
        size += math.fabs(s.coefficient[part] * carried)
    for a in range(s.areas if s.common else 0):
        along = 0.0
        for i in range(m.pair_first[row], m.pair_first[row + 1]):
            along += m.pair_value[i] * s.directions.at[m.pair_column[i] * s.areas + a]
        size += math.fabs(along) * s.area_size.at[a]
    room = total
    if m.port_two_sided[k] != 0:
        most = limit_of(e, k)
        room = most - math.fabs(total)
        size = max(size, most)
    s.push[k] = total
    s.push_size[k] = size
    return room / size if size > 0.0 else 1.0


def limit_of(e: Engine, k: int) -> float:
    """Return up to what friction holds, on the mean of the modes around.

    Where it slips in one of them, it has to be brought back while it slips: what it would take to
    break it loose is not reached.
    """
    m = e.model
    s = e.slide
    number = m.port_limit[k]
    constant = m.port_limit_constant[k]
    if m.port_breakaway[k] != NO_BREAKAWAY and s.meant[k] == 0 and not slips_in_some(e, k):
        number = m.port_breakaway[k]
        constant = m.port_breakaway_constant[k]
    if number < 0:
        return constant
    total = 0.0
    for part in range(s.parts):
        flags = part_mode(e, part).flags
        copy_part(m.switches + m.state_first[m.machines], flags, 0, s.v, m.on_slot)
        copy_part(2 * m.bonds, s.solution, part * 2 * m.bonds, s.v, m.bond_slot)
        total += s.coefficient[part] * value(m, number, s.v)
    return total


def slips_in_some(e: Engine, k: int) -> bool:
    """Whether the friction of port k slips in one of the modes around."""
    for part in range(e.slide.parts):
        state = part_mode(e, part).state[e.model.port_machine[k]]
        if state == FORWARD or state == BACKWARD:
            return True
    return False


def first_to_pull(e: Engine) -> int:
    """Return the first port whose law would carry on the way decided on what it cannot.

    Or NONE_PULLS.
    """
    m = e.model
    s = e.slide
    if m.ports == 0:
        return NONE_PULLS
    put_coefficients(s, s.best_weight, s.coefficient)
    s.known = False
    for k in range(m.ports):
        if is_meant(e, k) and room_of(e, k) < -PULLS:
            return k
    return NONE_PULLS
