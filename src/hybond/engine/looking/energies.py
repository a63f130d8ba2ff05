"""Power that enters and leaves a model at points of a known motion, and its energy over a step.

Supplied is what sources give, dissipated what resistors take; while machines slide, both are the
combination of what they are in each mode.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.looking.asked import prepare
from hybond.engine.looking.look import Look, take_point
from hybond.engine.mode.storage import GAUSS, KRONROD, NODE, energy_of
from hybond.engine.sliding.blend import ROUNDING
from hybond.engine.words import Floats, floats, record

ENOUGH: Final = 1e-11
"""A piece of a step is done if its two formulas differ by less than this part of all the energy
that passes in the step, ..."""
NOTHING: Final = 1e-13
"""... or by less than this part of what is stored where the step begins: power that hangs on the
last digits of that is a staircase, however short the piece."""
TRIES: Final = 200
"""Pieces of a step that are tried; the last one is all that is left."""
LEAST: Final = 1e-9
"""The shortest piece, as a part of the step: a jump of power may stand in it."""
POINTS: Final = 21
MIDDLE: Final = 10


@record
class Meter:
    """Power supplied, power dissipated, and the size of all terms of both.

    `power` at one point; `kronrod` and `gauss` the means of a piece by the two formulas.
    """

    power: Floats
    kronrod: Floats
    gauss: Floats


def make_meter() -> Meter:
    """Return a meter."""
    q = Meter()
    q.power = floats(3)
    q.kronrod = floats(3)
    q.gauss = floats(3)
    return q


def look_powers(e: Engine, l: Look, q: Meter, out: Floats) -> int:
    """Put power supplied and power dissipated there, a row for each point."""
    prepare(e, l.meters, l.corrects)
    for i in range(l.points.many):
        if take_power(e, l, q, i, l.points.t[i]) != OK:
            return REFUSED
        out[2 * i] = q.power[0]
        out[2 * i + 1] = q.power[1]
    return OK


def take_power(e: Engine, l: Look, q: Meter, i: int, t: float) -> int:
    """Put the powers at a time there, which is that of point i or in its step."""
    s = e.slide
    if take_point(e, l, l.meters, i, t) != OK:
        return REFUSED
    if s.k == 0:
        read_meters(e, e.v, e.model.bond_slot, q.power)
        return OK
    supplied = 0.0
    dissipated = 0.0
    size = 0.0
    supplied_size = 0.0
    dissipated_size = 0.0
    for part in range(s.parts):
        read_meters(e, s.solution, part * 2 * e.model.bonds, q.power)
        c = s.coefficient[part]
        supplied += c * q.power[0]
        supplied_size += math.fabs(c * q.power[0])
        dissipated += c * q.power[1]
        dissipated_size += math.fabs(c * q.power[1])
        size += math.fabs(c) * q.power[2]
    # what cancels but for rounding is zero, as in every combination
    q.power[0] = 0.0 if math.fabs(supplied) <= ROUNDING * supplied_size else supplied
    q.power[1] = 0.0 if math.fabs(dissipated) <= ROUNDING * dissipated_size else dissipated
    q.power[2] = size
    return OK


def read_meters(e: Engine, w: Floats, at: int, power: Floats) -> None:
    """Put the powers there that bond variables make, which stand in `w` from `at` on."""
    m = e.model
    power[0] = 0.0
    power[1] = 0.0
    power[2] = 0.0
    for k in range(m.suppliers):
        b = at + m.supplier_bond[k]
        through = w[b] * w[b + m.bonds]
        power[0] += float(m.supplier_sign[k]) * through
        power[2] += math.fabs(through)
    for k in range(m.dissipators):
        b = at + m.dissipator_bond[k]
        through = w[b] * w[b + m.bonds]
        power[1] += float(m.dissipator_sign[k]) * through
        power[2] += math.fabs(through)


def look_energies(e: Engine, l: Look, q: Meter, end: Floats, out: Floats) -> int:
    """Put energy supplied, energy dissipated, and what both may be wrong by there.

    A row for each point, from its time to that in `end`, in the same step.
    """
    prepare(e, l.meters, l.corrects)
    for i in range(l.points.many):
        if take_energy(e, l, q, i, end[i], out) != OK:
            return REFUSED
    return OK


def take_energy(e: Engine, l: Look, q: Meter, i: int, end: float, out: Floats) -> int:
    """Integrate powers from point i on within its step, on pieces as short as it takes.

    A kink of a law makes the two formulas differ, wherever in a piece it is.
    """
    begin = l.points.t[i]
    span = end - begin
    supplied = 0.0
    dissipated = 0.0
    wrong = 0.0
    passes = 0.0
    nothing = -1.0
    low = 0.0
    width = 1.0
    for turn in range(TRIES):
        if low >= 1.0 or span <= 0.0:
            break
        if turn == TRIES - 1:
            width = 1.0 - low
        if take_piece(e, l, q, i, span, low, width) != OK:
            return REFUSED
        h = span * width
        off = h * math.fabs(q.kronrod[0] - q.gauss[0])
        off = max(off, h * math.fabs(q.kronrod[1] - q.gauss[1]))
        passes = max(passes, h * q.kronrod[2])
        if off > ENOUGH * passes and nothing < 0.0:
            nothing = NOTHING * stored_at(e, l, i)
        if off <= max(ENOUGH * passes, nothing) or width <= LEAST or turn == TRIES - 1:
            supplied += h * q.kronrod[0]
            dissipated += h * q.kronrod[1]
            wrong += off
            low += width
            width = min(2.0 * width, 1.0 - low)
        else:
            width = 0.5 * width
    out[3 * i] = supplied
    out[3 * i + 1] = dissipated
    out[3 * i + 2] = wrong
    return OK


def stored_at(e: Engine, l: Look, i: int) -> float:
    """Return the energy stored where the step of point i begins, J; 0 where it has no value."""
    at = 3 * e.states * l.points.step[i]
    for k in range(e.states):
        l.y[k] = l.points.step_state[at + k]
    stored = math.fabs(energy_of(e, l.y))
    return stored if math.isfinite(stored) else 0.0


def take_piece(e: Engine, l: Look, q: Meter, i: int, span: float, low: float, width: float) -> int:
    """Put the means of the powers over a part of the step of point i there, by both formulas.

    Points lie where the formulas have them: of a step of nanoseconds, hours after the start, the
    times that there are would be some way beside.
    """
    for p in range(3):
        q.kronrod[p] = 0.0
        q.gauss[p] = 0.0
    begin = l.points.t[i]
    status = OK
    for k in range(POINTS):
        j = k if k <= MIDDLE else POINTS - 1 - k
        node = -NODE[j] if k <= MIDDLE else NODE[j]
        since = span * min(low + 0.5 * width * (1.0 + node), 1.0)
        t = begin + since
        l.past = since - (t - begin)
        status = take_power(e, l, q, i, t)
        if status != OK:
            break
        for p in range(3):
            q.kronrod[p] += 0.5 * KRONROD[j] * q.power[p]
            q.gauss[p] += 0.5 * GAUSS[j] * q.power[p]
    l.past = 0.0
    return status
