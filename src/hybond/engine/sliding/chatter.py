"""Machines that follow those that slide, where fast switching has led them.

A switch behind a comparator is closed in one of the modes combined and open in the other. A latch
is set by the first of them that sets it, and stays so in all; a counter counts to its end. Then one
turn of the switching changes nothing any more, and that motion is the one that is combined: what
leads there takes no time. What is another after each turn, as a toggle, has no limit.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.products import copy_places
from hybond.engine.engine import Engine, say_fault
from hybond.engine.laws.branches import follow
from hybond.engine.reasons.facts import add_fact
from hybond.engine.sliding.filippov import ABOVE, SLIDES
from hybond.engine.sliding.ways_on import A_WAY, NO_WAY, STOPS, decide
from hybond.engine.sliding.what_happened import is_held
from hybond.engine.surfaces.corners import count_corners, put_corner, put_side
from hybond.engine.words import Ints

MOST: Final = 4096
"""Turns after which what follows has not come to an end."""
RETURNS: Final = -1
"""Each machine is as it was after each turn."""


def decide_led(e: Engine) -> int:
    """Decide how the state goes on from the surfaces met, as `decide` does.

    Machines that follow others are where switching has led them, in ``around``.
    """
    m = e.model
    s = e.slide
    met = s.met
    if m.followers == 0:
        return decide(e)
    s.restless = RETURNS
    follow(e, e.state, s.around)
    other = RETURNS
    for turn in range(MOST):
        decided = decide(e)
        if s.restless != RETURNS:
            return refuse_restless(e, s.restless)
        if decided != A_WAY:
            if decided != STOPS:
                copy_places(m.machines, s.settled, 0, s.around, 0)
            return decided
        other = other_after_turns(e)
        if s.restless != RETURNS:
            return refuse_restless(e, s.restless)
        if other == RETURNS:
            return go_where_led(e)
        # a state that comes again does so for ever: it is held against that of 1, 2, 4, ... turns
        same = turn > 0
        for k in range(m.machines):
            same = same and s.around[k] == s.turned[k]
        if same:
            return refuse_restless(e, other)
        if turn & (turn - 1) == 0:
            copy_places(m.machines, s.around, 0, s.turned, 0)
        s.met = met
        copy_places(met, s.first_met, 0, s.met_surface, 0)
    return refuse_restless(e, other)


def go_where_led(e: Engine) -> int:
    """Return A_WAY where turns change nothing any more, and an event in any mode leads there."""
    swaying = moves_surface(e)
    if swaying != RETURNS:
        say_fault(e, "HB-N415", "what follows a switch that slides moves another surface", "")
        return tell_of_surfaces(e, swaying)
    other = other_by_phase(e)
    if e.slide.restless != RETURNS:
        return refuse_restless(e, e.slide.restless)
    return A_WAY if other == RETURNS else refuse_restless(e, other)


def moves_surface(e: Engine) -> int:
    """Return a machine that switching leads elsewhere, and the surface of another by that.

    Or RETURNS. In which of the modes combined that surface is crossed is for none of them to say.
    """
    m = e.model
    s = e.slide
    k = 0
    for j in range(s.k if m.swayers > 0 else 0):
        if s.best[j] == SLIDES:
            s.chosen[k] = s.side[j]
            k += 1
    for part in range(count_corners(k, s.best_product) if k > 0 else 0):
        put_corner(m, s.base, part, k, s.best_product, s.chosen, s.origin)
        follow(e, s.base, s.origin)
        for i in range(m.swayers):
            machine = m.swaying[i]
            if s.apart[machine] == 0 and s.origin[machine] != s.settled[machine]:
                return machine
    return RETURNS


def refuse_restless(e: Engine, machine: int) -> int:
    """Refuse a machine that is another after each turn; one with a contact is struck by each.

    Impacts are instants of their own, and end where they accumulate: what has just been met is not
    slid on, and no machine has been led anywhere.
    """
    m = e.model
    s = e.slide
    for state in range(m.state_first[machine], m.state_first[machine + 1]):
        if m.contact_at[state] >= 0 and is_any_new(e):
            copy_places(m.machines, s.settled, 0, s.around, 0)
            s.strikes = True
            return NO_WAY
    say_fault(e, "HB-N415", "what follows a switch that slides has no limit", "")
    return tell_of_surfaces(e, machine)


def is_any_new(e: Engine) -> bool:
    """Whether any of the surfaces first met was not slid on before."""
    s = e.slide
    for j in range(s.first_many):
        if not is_held(e, s.first_met[j]):
            return True
    return False


def tell_of_surfaces(e: Engine, machine: int) -> int:
    """Add to a refusal the machine that it is about, and the surfaces slid on."""
    if e.model.tells != 0:
        add_fact(e.fault, float(machine))
        for j in range(e.slide.k):
            add_fact(e.fault, float(e.slide.side[j]))
    return STOPS


def other_after_turns(e: Engine) -> int:
    """Return a machine that is another where switching has come back to a mode, or RETURNS.

    Those that follow are led on in ``around`` then. Surfaces that are crossed are so for all.
    """
    m = e.model
    s = e.slide
    k = 0
    copy_places(m.machines, s.around, 0, s.base, 0)
    for j in range(s.k):
        if s.best[j] == SLIDES:
            s.chosen[k] = s.side[j]
            k += 1
        else:
            put_side(m, s.side[j], s.best[j] == ABOVE, s.base)
    if k == 0:
        return RETURNS
    follow(e, s.around, s.base)
    for part in range(count_corners(k, s.best_product)):
        for j in range(k):
            put_corner(m, s.base, part, k, s.best_product, s.chosen, s.origin)
            follow(e, s.base, s.origin)
            turn_over(e, s.chosen[j], s.origin, s.corner)
            if s.best_product or count_above(e, k, s.corner) < 2:
                take_as_combined(e, k, s.corner, s.origin)
            else:
                # no mode of the combination: it has come from one, and goes back there
                copy_places(m.machines, s.corner, 0, s.state, 0)
                turn_over(e, s.chosen[j], s.state, s.corner)
            machine = first_other(e, s.origin, s.corner)
            if machine != RETURNS:
                lead_on(e, k)
                return machine
    return RETURNS


def turn_over(e: Engine, surface: int, origin: Ints, out: Ints) -> None:
    """Put the mode there that is entered from another where a machine crosses its surface."""
    m = e.model
    above = origin[m.surface_machine[surface]] == m.surface_above[surface]
    copy_places(m.machines, origin, 0, out, 0)
    put_side(m, surface, not above, out)
    follow(e, origin, out)


def count_above(e: Engine, k: int, state: Ints) -> int:
    """Return how many of the machines that slide are above their surfaces."""
    m = e.model
    s = e.slide
    many = 0
    for j in range(k):
        many += 1 if state[m.surface_machine[s.chosen[j]]] == m.surface_above[s.chosen[j]] else 0
    return many


def take_as_combined(e: Engine, k: int, state: Ints, out: Ints) -> None:
    """Put the mode there that is combined with these machines on the sides of `state`."""
    m = e.model
    s = e.slide
    copy_places(m.machines, s.base, 0, out, 0)
    for j in range(k):
        above = state[m.surface_machine[s.chosen[j]]] == m.surface_above[s.chosen[j]]
        put_side(m, s.chosen[j], above, out)
    follow(e, s.base, out)


def first_other(e: Engine, one: Ints, other: Ints) -> int:
    """Return the first machine whose state is not the same in two modes, or RETURNS."""
    for machine in range(e.model.machines):
        if one[machine] != other[machine]:
            return machine
    return RETURNS


def lead_on(e: Engine, k: int) -> None:
    """Lead those that follow from the mode in ``corner`` to that which switching has begun with."""
    m = e.model
    s = e.slide
    lead_back(e, k)
    for machine in range(m.machines):
        if m.machine_follows[machine] != 0 and s.apart[machine] == 0:
            s.around[machine] = s.corner[machine]


def other_by_phase(e: Engine) -> int:
    """Return a machine that is led elsewhere if an event comes in another mode, or RETURNS.

    What has slid before and goes on is in any of the modes combined when an event comes.
    """
    m = e.model
    s = e.slide
    if s.phases == 0 or s.k != s.many:
        return RETURNS
    for j in range(s.k):
        if s.best[j] != SLIDES or not is_held(e, s.side[j]):
            return RETURNS
    for part in range(s.phases):
        for machine in range(m.machines):
            s.origin[machine] = s.phase.at[part * m.machines + machine]
            s.corner[machine] = s.origin[machine]
            follows = m.is_law[machine] != 0 or m.machine_follows[machine] != 0
            if not follows and s.apart[machine] == 0 and s.corner[machine] != s.base[machine]:
                return RETURNS  # another one has crossed meanwhile
        follow(e, s.origin, s.corner)
        lead_round(e)
        for machine in range(m.machines):
            followed = m.machine_follows[machine] != 0 and s.apart[machine] == 0
            if followed and s.corner[machine] != s.around[machine]:
                return machine
    return RETURNS


def lead_round(e: Engine) -> None:
    """Let those that slide switch from the mode in ``corner`` until turns change nothing.

    It ends on the sides on which switching has begun.
    """
    m = e.model
    s = e.slide
    for _ in range(MOST):
        copy_places(m.machines, s.corner, 0, s.origin, 0)
        for j in range(2 * s.k):
            copy_places(m.machines, s.corner, 0, s.state, 0)
            turn_over(e, s.chosen[j // 2], s.state, s.corner)
        if first_other(e, s.origin, s.corner) == RETURNS:
            lead_back(e, s.k)
            return
    s.restless = first_other(e, s.origin, s.corner)


def lead_back(e: Engine, k: int) -> None:
    """Let those that slide cross from the mode in ``corner`` to the sides of that in ``base``."""
    m = e.model
    s = e.slide
    for j in range(k):
        machine = m.surface_machine[s.chosen[j]]
        if s.corner[machine] != s.base[machine]:
            copy_places(m.machines, s.corner, 0, s.state, 0)
            turn_over(e, s.chosen[j], s.state, s.corner)
