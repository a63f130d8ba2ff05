"""Contacts that a source has jumped onto: nothing arrived at them, and nothing rebounds.

A source that jumps stands for one that is fast. On its way contacts that are closed stay closed,
all of them together: what they bring about is what a plastic impact of all brings about, however
many bodies lie in a row. Newton's law, which reads the approach *before* the instant, says so of
the contact that the source acts on; the next one in the row would take what this one passes on for
an approach.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_places
from hybond.engine.laws.law_instant import NO_LAW_VALUE
from hybond.engine.laws.law_records import Laws
from hybond.engine.laws.ports import partner_row, partner_way
from hybond.engine.mode.rows.tableau import COMMON
from hybond.engine.model import Model

ARRIVES: Final = 1e-12
"""Part of its terms from which on an approach before an instant is more than rounding."""


def find_jumped_onto(m: Model, r: Laws) -> None:
    """Find the contacts that a source has jumped onto, or that lie beside these, into `r.pressed`.

    Where anything has arrived in the same row, at the same instant, it has impacts, one after
    another. What ``pre()`` reads is in `r.v`, how contacts approach now in `r.y`.
    """
    n = m.ports
    some = False
    for k in range(n):
        r.pressed[k] = 0
        if closes(m, r, k) and not arrived(m, r, k):
            r.pressed[k] = 1
            some = True
    if not some:
        return
    spread(m, r)
    for k in range(n):
        if r.pressed[k] == 0 or not closes(m, r, k) or not arrived(m, r, k):
            continue
        # all that lies in the row of what has arrived: it is struck
        for j in range(n):
            r.in_row[j] = 0
        r.in_row[k] = 1
        grow(m, r)
        for j in range(n):
            if r.in_row[j] != 0:
                r.pressed[j] = 0


def spread(m: Model, r: Laws) -> None:
    """Let all that lies in a row with what is pressed count as pressed."""
    copy_places(m.ports, r.pressed, 0, r.in_row, 0)
    grow(m, r)
    copy_places(m.ports, r.in_row, 0, r.pressed, 0)


def grow(m: Model, r: Laws) -> None:
    """Add to a row the closed contacts that impulses of those in it move."""
    n = m.ports
    grows = True
    while grows:
        grows = False
        for k in range(n):
            for j in range(n if r.in_row[k] != 0 else 0):
                moves = r.response.ce[j * n + k] != 0.0
                if moves and r.in_row[j] == 0 and is_contact(m, r, j):
                    r.in_row[j] = 1
                    grows = True


def closes(m: Model, r: Laws, k: int) -> bool:
    """Whether port k is a contact with a restitution that is closed and approaches."""
    return is_contact(m, r, k) and m.port_restitution[k] != NO_LAW_VALUE and r.y[k] < 0.0


def is_contact(m: Model, r: Laws, k: int) -> bool:
    """Whether port k is a contact that is closed."""
    return m.port_two_sided[k] == 0 and r.able[k] != 0 and r.now.given[k] == COMMON


def arrived(m: Model, r: Laws, k: int) -> bool:
    """Whether the contact of port k approached before the instant; so, too, where nothing says."""
    row = partner_row(r.now, k)
    total = 0.0
    size = 0.0
    for i in range(m.pair_first[row], m.pair_first[row + 1]):
        term = m.pair_value[i] * r.v[m.slots + m.bond_slot + m.pair_column[i]]
        total += term
        size += math.fabs(term)
    # a value that there is none of is no reason to say that nothing arrived
    return not partner_way(r.now, k) * total >= -ARRIVES * size
