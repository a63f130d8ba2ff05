"""What a run by quantised states keeps: polynomials of states, their quanta, what depends on what.

A state `x` is a polynomial of the time since ``t``, of the order of the method; the others see it
through its quantised state `q`, a polynomial one degree lower. In a linear mode the generators of
its sources stand behind the states as if they were quantised states more.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import (
    Block,
    Places,
    Rows,
    fit,
    make_block,
    make_places,
    make_rows,
)
from hybond.engine.method_numbers import LIQSS1, QSS1
from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, floats, ints, record

X: Final = 4
"""Coefficients that there is room for of each state, ..."""
Q: Final = 3
"""... and of each quantised state."""


@record
class Quantised:
    """The motion between two quantum events, and when the next ones come.

    Coefficient k of state i is ``x[X * i + k]``, that of its quantised state ``q.at[Q * i + k]``.
    """

    order: int
    implicit: bool
    linear: bool
    """Whether the mode is ``x' = rows q``; else rates are fitted along the quantised states."""
    states: int
    size: int
    """Quantised states, generators included."""
    t: float
    """The origin of the polynomials: where the last step began."""
    h: float
    """How long that step is."""
    bound: float
    until: float
    """The time up to which rates are good, or generators."""
    stale: bool
    """Whether rates have to be fitted before the next step."""
    x: Floats
    q: Block
    quantum: Floats
    floor: Floats
    """The least quantum of each state until the next start."""
    leaves: Floats
    """When each state leaves its band, or touches its quantised state."""
    touches: Floats
    marked: Ints
    """States whose next event has to be found."""
    due: Ints
    change: Block
    """What quantised states change by, in the places that they have in `q`."""
    crowded: int

    rows: Rows
    """The matrix of a linear mode, the rates of generators behind those of states; ..."""
    columns: Rows
    """... rates of states by what they depend on."""
    driven: Places
    """Where the entries of generators begin in each row of a state."""
    added: int
    """Events since all rates were computed anew."""
    moving: bool
    """Whether any generator is no constant."""
    diagonal: Floats
    """Derivative of each rate by its own state, or an estimate."""
    term: Block
    power: Block

    reach: float
    """How long the next fit may be."""
    rates: Floats
    """Rates at the nodes of a fit."""
    y: Floats
    rate: Floats
    last: Floats
    """The rates at the end of the step before, at `last_t`, just before an event."""
    last_t: float
    moved: int
    """The one state whose quantised state jumped there, or -1, and by how much."""
    moved_by: float
    wanted: Floats
    placed: Floats
    ahead: Floats


def make_quantised(m: Model) -> Quantised:
    """Return room for a run by quantised states."""
    a = Quantised()
    n = m.storages + m.integrals
    a.implicit = m.method >= LIQSS1
    a.order = m.method - (LIQSS1 if a.implicit else QSS1) + 1
    a.states = n
    a.x = floats(X * n)
    a.q = make_block(Q * n)
    a.quantum = floats(n)
    a.floor = floats(n)
    a.leaves = floats(n)
    a.touches = floats(n)
    a.marked = ints(n)
    a.due = ints(n)
    a.change = make_block(Q * n)
    a.rows = make_rows()
    a.columns = make_rows()
    a.driven = make_places(1)
    a.diagonal = floats(n)
    a.term = make_block(n)
    a.power = make_block(n)
    a.rates = floats(Q * n)
    a.y = floats(n)
    a.rate = floats(n)
    a.last = floats(n)
    a.wanted = floats(Q)
    a.placed = floats(Q)
    a.ahead = floats(Q)
    return a


def take_size(a: Quantised, size: int) -> None:
    """Make room for so many quantised states."""
    a.size = size
    fit(a.q, Q * size)
    fit(a.change, Q * size)
    fit(a.term, size)
    fit(a.power, size)


def time_ahead(a: Quantised, t: float) -> float:
    """Return how long the motion from `t` on may be, 1 s if nobody says."""
    span = a.bound - t
    return span if span > 0.0 and span < math.inf else 1.0


def move_origin(a: Quantised, s: float) -> None:
    """Move the origin of all polynomials by `s`."""
    for i in range(a.states):
        shift_polynomial(a.x, X * i, a.order, s)
    for j in range(a.size):
        shift_polynomial(a.q.at, Q * j, a.order - 1, s)
    a.t += s


def shift_polynomial(c: Floats, at: int, degree: int, s: float) -> None:
    """Move the origin of the polynomial that stands there by `s`."""
    for low in range(degree):
        for k in range(degree - 1, low - 1, -1):
            c[at + k] += s * c[at + k + 1]


def value_at(c: Floats, at: int, degree: int, s: float) -> float:
    """Return the value of the polynomial that stands there."""
    total = c[at + degree]
    for k in range(degree - 1, -1, -1):
        total = total * s + c[at + k]
    return total


def see_quantised(a: Quantised, s: float, y: Floats) -> None:
    """Put the quantised states there, `s` after the origin."""
    for i in range(a.states):
        y[i] = value_at(a.q.at, Q * i, a.order - 1, s)
