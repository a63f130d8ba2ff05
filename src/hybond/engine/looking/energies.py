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
from hybond.engine.mode.rows.storage import GAUSS, KRONROD, NODE, energy_of
from hybond.engine.surfaces.blend import ROUNDING
from hybond.engine.words import Floats, floats, record

ENOUGH: Final = 1e-11
"""A step is done if its two formulas differ by less than this part of the energy that passes."""
NOTHING: Final = 1e-13
"""Or by less than this part of what is stored where the step begins: power that hangs on the last
digits of that is a staircase, however short the piece."""
PIECES: Final = 100
"""Pieces into which a step is cut at the most."""
LEAST: Final = 1e-9
"""The shortest piece, as a part of the step: a jump of power may stand in it."""
BLURRED: Final = 0.6
"""By less a cut lessens what is off where powers are rounding: a jump leaves half, a root less."""
SETTLED: Final = 1e-5
"""By a smaller part of it the energy of such a piece does not change when it is cut."""
ENDLESS: Final = 4
"""Cuts that find rounding alone, behind which a step is left."""
POINTS: Final = 21
MIDDLE: Final = 10


@record
class Meter:
    """Power supplied, power dissipated, and the size of all terms of both.

    `power` at one point; `kronrod` and `gauss` the means of a piece by the two formulas. Of each
    piece of a step: where it begins and how long it is, as parts of the step; the energies; what
    the formulas differ by, and whether that is to be lessened.
    """

    power: Floats
    kronrod: Floats
    gauss: Floats
    pieces: int
    low: Floats
    width: Floats
    supplied: Floats
    dissipated: Floats
    passed: Floats
    off: Floats


def make_meter() -> Meter:
    """Return a meter."""
    q = Meter()
    q.power = floats(3)
    q.kronrod = floats(3)
    q.gauss = floats(3)
    q.low = floats(PIECES)
    q.width = floats(PIECES)
    q.supplied = floats(PIECES)
    q.dissipated = floats(PIECES)
    q.passed = floats(PIECES)
    q.off = floats(PIECES)
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

    A row for each point, from its time to that in `end`, in the same step. First each of them is
    one piece: what is wrong in a row that is next to nothing beside the others need not be less.
    """
    prepare(e, l.meters, l.corrects)
    passed = 0.0
    for i in range(l.points.many):
        if take_piece(e, l, q, i, end[i] - l.points.t[i], 0, 0.0, 1.0) != OK:
            return REFUSED
        out[3 * i] = q.supplied[0]
        out[3 * i + 1] = q.dissipated[0]
        out[3 * i + 2] = q.off[0]
        passed += q.passed[0]
    enough = ENOUGH * passed / float(max(l.points.many, 1))
    for i in range(l.points.many):
        if out[3 * i + 2] > enough and take_energy(e, l, q, i, end[i], enough, out) != OK:
            return REFUSED
    return OK


def take_energy(
    e: Engine, l: Look, q: Meter, i: int, end: float, enough: float, out: Floats
) -> int:
    """Integrate powers from point i on within its step, on pieces as short as it takes.

    A kink of a law makes the two formulas differ, wherever in a piece it is: the piece where they
    differ most is cut, until all together are near enough. Where powers are what cancels but for
    rounding cuts change nothing, and there is an end to them.
    """
    span = end - l.points.t[i]
    enough = max(enough, NOTHING * stored_at(e, l, i))
    q.pieces = 1
    if take_piece(e, l, q, i, span, 0, 0.0, 1.0) != OK:
        return REFUSED
    blurred = 0
    while q.pieces < PIECES and blurred < ENDLESS:
        off = 0.0
        passed = 0.0
        worst = -1
        most = 0.0
        for k in range(q.pieces):
            off += q.off[k]
            passed += q.passed[k]
            if q.off[k] > most and q.width[k] > LEAST:
                worst = k
                most = q.off[k]
        if off <= max(ENOUGH * passed, enough) or worst < 0:
            break
        status = cut(e, l, q, i, span, worst)
        if status < 0:
            return REFUSED
        blurred += status
    for p in range(3):
        out[3 * i + p] = 0.0
    for k in range(q.pieces):
        out[3 * i] += q.supplied[k]
        out[3 * i + 1] += q.dissipated[k]
        out[3 * i + 2] += q.off[k]
    return OK


def stored_at(e: Engine, l: Look, i: int) -> float:
    """Return the energy stored where the step of point i begins, J; 0 where it has no value."""
    at = 3 * e.states * l.points.step[i]
    for k in range(e.states):
        l.y[k] = l.points.step_state[at + k]
    stored = math.fabs(energy_of(e, l.y))
    return stored if math.isfinite(stored) else 0.0


def cut(e: Engine, l: Look, q: Meter, i: int, span: float, k: int) -> int:
    """Cut piece k of the step in two: 1 if that found nothing but rounding, -1 if refused."""
    off = q.off[k]
    supplied = q.supplied[k]
    dissipated = q.dissipated[k]
    other = q.pieces
    half = 0.5 * q.width[k]
    if take_piece(e, l, q, i, span, k, q.low[k], half) != OK:
        return -1
    if take_piece(e, l, q, i, span, other, q.low[k] + half, half) != OK:
        return -1
    q.pieces += 1
    moved = math.fabs(q.supplied[k] + q.supplied[other] - supplied)
    moved = max(moved, math.fabs(q.dissipated[k] + q.dissipated[other] - dissipated))
    if q.off[k] + q.off[other] < BLURRED * off:
        return 0
    return 1 if moved <= SETTLED * (q.passed[k] + q.passed[other]) else 0


def take_piece(
    e: Engine, l: Look, q: Meter, i: int, span: float, k: int, low: float, width: float
) -> int:
    """Make piece k that part of the step of point i: its energies, and how formulas differ.

    Points lie where the formulas have them: of a step of nanoseconds, hours after the start, the
    times that there are would be some way beside.
    """
    for p in range(3):
        q.kronrod[p] = 0.0
        q.gauss[p] = 0.0
    begin = l.points.t[i]
    status = OK
    for n in range(POINTS):
        j = n if n <= MIDDLE else POINTS - 1 - n
        node = -NODE[j] if n <= MIDDLE else NODE[j]
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
    h = span * width
    q.low[k] = low
    q.width[k] = width
    q.supplied[k] = h * q.kronrod[0]
    q.dissipated[k] = h * q.kronrod[1]
    q.passed[k] = h * q.kronrod[2]
    off = max(math.fabs(q.kronrod[0] - q.gauss[0]), math.fabs(q.kronrod[1] - q.gauss[1]))
    q.off[k] = h * off
    return status
