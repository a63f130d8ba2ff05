"""Sliding where laws of one side hold what others would move, and have to push on the mean.

The mean of fast switching moves as if all modes were one: by the mean of what drives them, held by
laws that push or let go. So of the laws that would pull some let go in all modes combined, and it
is decided again, until none pulls, and none that lets go is driven into what it holds. Friction
that slips one way in one mode and the other way in another, and so off its rest on the mean, rests
in all of them first, and is held to its limit on the mean.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine, say_fault
from hybond.engine.laws.branches import choose_anew
from hybond.engine.reasons.facts import add_fact
from hybond.engine.sliding.chatter import decide_led
from hybond.engine.sliding.from_edge import slides_on_some, take_first_met
from hybond.engine.sliding.ways_on import A_WAY, CHOSEN, NONE_HOLDS, STOPS
from hybond.engine.surfaces.blend import average
from hybond.engine.surfaces.corners import put_coefficients
from hybond.engine.surfaces.law_means import (
    BACKWARD,
    FORWARD,
    HELD,
    NONE_PULLS,
    first_to_pull,
)
from hybond.engine.surfaces.outputs import put_ahead, show_state, stride
from hybond.engine.surfaces.reads import BY_BONDS
from hybond.engine.surfaces.surface import part_mode

MOST: Final = 32
"""Changes of what lets go, at the most: no law lets go and takes hold so often."""
DRIVEN: Final = 1e-12
"""A law that lets go is driven by more than this part of what moves there; less is rounding."""


def decide_by_means(e: Engine, met: int) -> int:
    """Decide how to slide on the surfaces first met with laws that push on the mean, or let go.

    CHOSEN, or what is decided where they do not slide then, or NONE_HOLDS.
    """
    decided = A_WAY
    rests = -1
    leads = 0.0
    for _ in range(MOST):
        if decided == A_WAY and slides_on_some(e):
            wrong = first_wrong(e)
            if wrong == NONE_PULLS:
                end_bars(e)
                if not is_read_where_held(e):
                    return CHOSEN
                choose_anew(e)
                return NONE_HOLDS
            rests = wrong if is_torn(e, wrong) else -1
            leads = slip_ahead(e, wrong) if rests >= 0 else 0.0
            change_bar(e, wrong)
        elif decided != STOPS and rests >= 0:
            # nothing slides if it rests: it slips the way it is led off
            e.slide.barred[rests] = 1 if leads > 0.0 else -1
            rests = -1
        else:
            break
        choose_anew(e)
        decided = decide_led(e) if take_first_met(e, met) == OK else STOPS
    leaves = decided == A_WAY and not slides_on_some(e) and not some_held(e)
    end_bars(e)
    choose_anew(e)
    return decided if decided == STOPS or leaves else NONE_HOLDS


def some_held(e: Engine) -> bool:
    """Whether friction rests in all modes combined only because that was tried."""
    for k in range(e.model.ports):
        if e.slide.barred[k] == HELD:
            return True
    return False


def is_read_where_held(e: Engine) -> bool:
    """Whether what follows reads bond variables of modes in which friction rests on the mean alone.

    What it would have to carry in each of them it never does.
    """
    m = e.model
    some = False
    for k in range(m.ports):
        some = some or e.slide.meant[k] != 0
    for j in range(m.followers if some else 0):
        if m.follower_asks[j] == BY_BONDS and e.slide.apart[m.follower[j]] == 0:
            return True
    return False


def refuse_pull(e: Engine, pulls: int) -> int:
    """Refuse a law that would carry what it cannot, whatever others do."""
    say_fault(e, "HB-N417", "a law would carry on the mean of fast switching what it cannot", "")
    if e.model.tells != 0:
        add_fact(e.fault, float(pulls))
        for j in range(e.slide.k):
            add_fact(e.fault, float(e.slide.side[j]))
    return STOPS


def change_bar(e: Engine, k: int) -> None:
    """Let the law of port k do something else in all modes combined."""
    s = e.slide
    if is_torn(e, k):
        s.barred[k] = HELD
    elif s.barred[k] == 1 or s.barred[k] == -1:
        s.barred[k] = 0
    else:
        s.barred[k] = -1 if s.push[k] < 0.0 else 1


def is_torn(e: Engine, k: int) -> bool:
    """Whether friction slips one way in a mode combined, and the other way in another.

    It does so from rest, so that each brings it back from where the other leads: it rests within
    what the switching moves, and carries what holds it there on the mean.
    """
    m = e.model
    if m.port_two_sided[k] == 0 or m.port_planar[k] != 0:
        return False
    forward = False
    backward = False
    for part in range(e.slide.parts):
        state = part_mode(e, part).state[m.port_machine[k]]
        forward = forward or state == FORWARD
        backward = backward or state == BACKWARD
    return forward and backward


def first_unheld(e: Engine) -> int:
    """Return the first port whose law cannot do what the way decided on asks for, or NONE_PULLS.

    Friction that is torn can where the mean of its modes keeps it at rest.
    """
    pulls = first_to_pull(e)
    if pulls != NONE_PULLS:
        return pulls
    known = False
    for k in range(e.model.ports):
        if not is_torn(e, k):
            continue
        if not known:
            put_mean_rates(e)
            known = True
        if slip_ahead(e, k) != 0.0:
            return k
    return NONE_PULLS


def put_mean_rates(e: Engine) -> None:
    """Put the rates of the way decided on into ``e.slide.rate``."""
    s = e.slide
    put_coefficients(s, s.best_weight, s.coefficient)
    s.known = False
    average(e, e.states, s.part_rate, s.rate)


def end_bars(e: Engine) -> None:
    """Let laws take their branches again where they are chosen anew."""
    for k in range(e.model.ports):
        e.slide.barred[k] = 0


def first_wrong(e: Engine) -> int:
    """Return the first port whose law pulls, or lets go where it has to push; or NONE_PULLS."""
    m = e.model
    s = e.slide
    pulls = first_unheld(e)
    put_mean_rates(e)
    for k in range(m.ports):
        if (s.barred[k] == 1 or s.barred[k] == -1) and is_driven(e, k):
            return k
    return pulls


def is_driven(e: Engine, k: int) -> bool:
    """Whether the mean motion leads into what the law of port k holds where it lets go."""
    moved = slip_ahead(e, k)
    if e.model.port_two_sided[k] != 0:
        moved *= -float(e.slide.barred[k])
    return not moved <= 0.0


def slip_ahead(e: Engine, k: int) -> float:
    """Return by how much the mean motion leads the law of port k off what it holds.

    None that is rounding of what moves there; not a number where there are no values ahead.
    """
    s = e.slide
    show_state(e, e.t, e.y, s.v)
    step = stride(e, s.v, s.rate, 0)
    if put_ahead(e, s.v, s.rate, 0, step) != OK:
        return math.nan
    moved = motion_of(e, k, False)
    size = motion_of(e, k, True)
    if put_ahead(e, s.v, s.rate, 0, 0.0) != OK:
        return math.nan
    moved -= motion_of(e, k, False)
    return 0.0 if math.fabs(moved) <= DRIVEN * size else moved


def motion_of(e: Engine, k: int, sized: bool) -> float:
    """Return what the law of port k does not carry, at the values ahead: how fast friction slips.

    Or what the magnitudes of its terms add up to.
    """
    m = e.model
    row = 2 * k + 1 if m.port_two_sided[k] == 0 else 2 * k
    total = 0.0
    for i in range(m.pair_first[row], m.pair_first[row + 1]):
        term = m.pair_value[i] * e.slide.ahead[m.bond_slot + m.pair_column[i]]
        total += math.fabs(term) if sized else term
    return total
