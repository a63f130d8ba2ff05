"""Unknowns that no given value reaches are zero.

Where a source reads what is elsewhere, one part acts on another that does not act back: the matrix
has blocks, one above the other. A factorisation of all of it leaves rounding of the one in the
other, and that is all there is where nothing is given: it stays zero bit for bit.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.algebra.blocks import Places, fit_places, make_places
from hybond.engine.words import Floats, record

NONE: Final = -1


@record
class Reached:
    """Room to find them.

    The equation that each unknown stands for, and the unknown of each equation; the equation from
    which each unknown was come to, and those still to be looked at; whether an unknown is reached.
    """

    equation: Places
    unknown: Places
    come_from: Places
    to_see: Places
    is_reached: Places


def make_reached() -> Reached:
    """Return room for no equations."""
    r = Reached()
    r.equation = make_places(1)
    r.unknown = make_places(1)
    r.come_from = make_places(1)
    r.to_see = make_places(1)
    r.is_reached = make_places(1)
    return r


def put_zeros(r: Reached, n: int, a: Floats, b: Floats, x: Floats) -> None:
    """Put zero into what of `x` no value of `b` reaches, where ``a x = b`` is regular, n by n.

    Which equation stands for which unknown does not matter: the blocks are the same for all.
    """
    given = True
    for i in range(n):
        given = given and b[i] != 0.0
    if given or not match(r, n, a):
        return
    fit_places(r.is_reached, n)
    for j in range(n):
        r.is_reached.at[j] = 0
    more = True
    while more:
        more = False
        for j in range(n):
            if r.is_reached.at[j] == 0 and is_led_to(r, n, a, b, r.equation.at[j]):
                r.is_reached.at[j] = 1
                more = True
    for j in range(n):
        if r.is_reached.at[j] == 0:
            x[j] = 0.0


def is_led_to(r: Reached, n: int, a: Floats, b: Floats, i: int) -> bool:
    """Whether equation i has a value that is given, or an unknown that is reached."""
    if b[i] != 0.0:
        return True
    for k in range(n):
        if a[i * n + k] != 0.0 and r.is_reached.at[k] == 1:
            return True
    return False


def match(r: Reached, n: int, a: Floats) -> bool:
    """Give each equation an unknown of its own; False if that cannot be."""
    fit_places(r.equation, n)
    fit_places(r.unknown, n)
    fit_places(r.come_from, n)
    fit_places(r.to_see, n)
    for j in range(n):
        r.equation.at[j] = NONE
        r.unknown.at[j] = NONE
    for i in range(n):
        free = find_free(r, n, a, i)
        if free == NONE:
            return False
        # each unknown on the way goes over to the equation that it was come to from
        j = free
        while j != NONE:
            here = r.come_from.at[j]
            before = r.unknown.at[here]
            r.unknown.at[here] = j
            r.equation.at[j] = here
            j = before if here != i else NONE
    return True


def find_free(r: Reached, n: int, a: Floats, i: int) -> int:
    """Return the nearest unknown that is free, on a way from equation i; NONE if there is none."""
    for j in range(n):
        r.come_from.at[j] = NONE
    r.to_see.at[0] = i
    many = 1
    at = 0
    while at < many:
        here = r.to_see.at[at]
        at += 1
        for j in range(n):
            if a[here * n + j] == 0.0 or r.come_from.at[j] != NONE:
                continue
            r.come_from.at[j] = here
            if r.equation.at[j] == NONE:
                return j
            r.to_see.at[many] = r.equation.at[j]
            many += 1
    return NONE
