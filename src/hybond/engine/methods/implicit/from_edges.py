"""Steps that leave an edge of a law: Newton's iteration with the slopes of each stage.

A tank that is empty is filled, and its outlet runs by a root: the level is where the outlet gives
what flows in, and the slope that holds it there falls from without bound as it rises. One matrix
for all stages, made where the step begins, serves none of them. Here each has its own, and
corrections are shortened where they lead beyond the edge, so that a law is asked only where it has
values.

Between the stages what is held so is led from end to end without a turn: a polynomial through
stages a thousand times as large as each other would fall below the edge.

Sources: E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, IV.8, for the stages;
F. N. Fritsch, R. E. Carlson, SIAM J. Numer. Anal. 17(2), 1980, for what does not turn.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.method_numbers import AUTO, EXACT
from hybond.engine.methods.explicit.one_instant import room_of_instant
from hybond.engine.methods.implicit.near_roots import takes_no_root
from hybond.engine.methods.implicit.radau_room import Radau
from hybond.engine.methods.implicit.radau_slopes import held_by_law
from hybond.engine.methods.implicit.radau_stages import (
    ENOUGH,
    FRESH_MATRIX,
    STAGE_1,
    STAGE_2,
    foresee,
    mean_size,
    place_stages,
    rate_at,
    stage_rates,
)
from hybond.engine.methods.implicit.whole_factors import solve_by_whole
from hybond.engine.methods.implicit.whole_stages import fit_whole, put_left, solve_whole, take_all
from hybond.engine.methods.tolerances.scale import tolerance
from hybond.engine.mode.digits.sizes import sizes_of
from hybond.engine.surfaces.values import evaluate
from hybond.engine.words import Floats

EXPLICIT: Final = 0
"""The method ``rk45``."""
FEW: Final = 400
"""States up to which all stages are solved for at once."""
FILLS: Final = 16
"""Times that what flows in is led on to the next one that is empty."""
CORRECTIONS: Final = 200
FEW_CORRECTIONS: Final = 12
"""As many where a smooth motion is followed: slopes of its own halve what is left of a root."""
STALLS: Final = 2.0**-5
"""Part of a correction that laws have values for, at the most, where a motion runs into an edge:
there is no way on. Where one runs beside it, there is one for a quarter and more."""
LOST: Final = 2.0**-20
"""Part of a correction from which on the next ones are no larger where there is no way on: along a
diode that saturates there is one after several parts of a hundredth."""
STALLED: Final = 4
"""Such parts in a row, none more than the one before: they lead into the edge for ever. A first
guess may be far beyond an edge, but parts become larger then."""
LESS: Final = 0.5
"""Part of the least correction so far that another one is at most, if that leads anywhere: stages
are found by a dozen of them, ..."""
IN_VAIN: Final = 24
"""... and not where so many in a row are none: they go round in circles, from one side of a kink
to the other."""
SHORTEST: Final = 2.0**-60
"""The smallest part of a correction that is tried, where laws have no values."""
LEAST_PART: Final = 2.0**-12
"""The smallest part of that, where the next one is longer."""
DIGITS: Final = 1.4901161193847656e-08
"""Part of a state that it is shifted by for a slope: the root of a unit in the last place."""
LEVEL: Final = 64.0 * 2.220446049250313e-16
"""What is no farther off an edge, as a part of its terms, is on it."""
SHUT: Final = 1e-6
"""Part of its terms by which what is under a root is below zero where a valve is shut: where a
difference of two is written, far more than steps are off by."""
STEEP: Final = 2.0
"""Slope times step beyond which a state is held where it is, and does not follow its rate."""
CALM: Final = 30
"""Steps in a row beside an edge that stay within it, and are looked at no more."""
LOOKS: Final = 16
"""Parts of a step at whose ends its dense output is looked at."""
TURNS: Final = 3.0
"""Times its mean slope that an end of a cubic may have without a turn."""


def may_turn(e: Engine) -> bool:
    """Whether steps may go over to ``radau``, or back: at an edge no explicit ones are stable."""
    method = e.model.method
    if method == AUTO:
        return True
    return (e.model.begins > 0 or e.model.bends > 0.0) and (method == EXPLICIT or method == EXACT)


def see_edges(e: Engine, t: float, y: Floats) -> None:
    """See whether a motion begins on an edge, and how far it is from each.

    A valve ``sqrt(max(0, e))`` that is shut is as far as from where it opens, and not on its edge.
    """
    m = e.model
    s = e.step
    s.on_edge = False
    if m.begins == 0 or e.states > FEW or e.slide.k > 0 or evaluate(e, e.mode, e.v, t, y) != OK:
        return
    for k in range(m.begins):
        s.edge[k] = value(m, m.edge_value[k], e.v)
        if s.edge[k] == 0.0:
            shut = value(m, m.edge_value[m.begins + k], e.v)
            if shut < 0.0:
                s.edge[k] = shut if -shut > SHUT * value(m, m.edge_size[k], e.v) else 0.0
        if takes_no_root(e, k):
            s.edge[k] = math.inf
        s.on_edge = s.on_edge or s.edge[k] == 0.0


def leaves_edge(e: Engine, t: float, y: Floats, f: Floats, h: float) -> bool:
    """Whether a step of size `h` leaves an edge, by the rates at its end.

    What flows in may begin at zero, and may come from what is filled first.
    """
    s = e.step
    if not s.on_edge:
        return False
    refusal = e.refusal
    see_edges(e, t, y)
    leaves = False
    moves = -1
    copy_floats(e.states, y, s.trial)
    for _ in range(FILLS if s.on_edge else 0):
        if rate_at(e, e.states, t + h, s.trial, s.rate) != OK:
            break
        more = 0
        for i in range(e.states):
            s.trial[i] = y[i] + h * (s.rate[i] if s.rate[i] != 0.0 else f[i])
            more += 1 if s.trial[i] != y[i] else 0
        leaves = more > moves and is_off_edge(e, t + h, s.trial)
        if leaves or more <= moves:
            break
        moves = more
    e.refusal = refusal
    return leaves


def is_off_edge(e: Engine, t: float, y: Floats) -> bool:
    """Whether a state is not on an edge any more on which the last one seen was."""
    m = e.model
    if evaluate(e, e.mode, e.v, t, y) != OK:
        return False
    s = e.step
    for k in range(m.begins):
        s.edge_there[k] = value(m, m.edge_value[k], e.v)
    # two tanks that are level are so but for rounding of what they hold
    sizes_of(e, e.mode, e.v)
    for i in range(m.edge_bonds):
        e.v[m.bond_slot + m.edge_bond[i]] = e.work.sizes[m.edge_bond[i]]
    off = False
    for k in range(m.begins):
        rounding = LEVEL * value(m, m.edge_size[k], e.v)
        there = s.edge_there[k] if k < m.edges else math.fabs(s.edge_there[k])
        off = off or (s.edge[k] == 0.0 and there > rounding)
    return off


def stages_from_edge(e: Engine, r: Radau, rtol: float, least: float, shift: float) -> bool:
    """Find the stages of a step, and a Jacobian at its end; False where there are none.

    No part of a correction that is less than `least` is taken for progress. What was tried beyond
    an edge on the way refuses no step that is found.
    """
    n = r.n
    refusal = e.refusal
    if n == 0 or n > FEW or not fill_stages(e, r):
        return False
    return find_stages(e, r, rtol, least, shift, refusal)


def stages_by_foreseen(e: Engine, r: Radau, rtol: float, least: float, shift: float) -> bool:
    """Find the stages of a step as from an edge, from where the step before says they are."""
    n = r.n
    refusal = e.refusal
    if n == 0 or n > FEW or not r.known:
        return False
    foresee(r)
    place_stages(r)
    if stage_rates(e, r) != OK:
        e.refusal = refusal
        return False
    fit(r.kept, 3 * n)
    return find_stages(e, r, rtol, least, shift, refusal)


def find_stages(
    e: Engine, r: Radau, rtol: float, least: float, shift: float, refusal: bool
) -> bool:
    """Find stages, and a Jacobian at the end, by corrections with slopes of their own."""
    n = r.n
    take_all(r)
    fit_whole(r)
    enough = max(ENOUGH, 10.0 * 2.220446049250313e-16 / rtol)
    seen = enough if shift < DIGITS else 0.0
    corrections = FEW_CORRECTIONS if shift < DIGITS else CORRECTIONS
    stalled = 0
    vain = 0
    best = math.inf
    before = 1.0
    r.size = 0.0
    for _ in range(corrections):
        if not solve_whole(e, r, rtol, shift):
            return False
        part = correct_within(e, r, seen)
        stalled = stalled + 1 if part <= min(before, LOST) else 0
        before = part
        if part <= least or stalled >= STALLED:
            return False
        copy_part(n, r.y, 2 * n, r.stage, 0)
        tolerance(e, r.y0, r.stage, r.other)
        if e.model.bends > 0.0:
            held_by_law(e, r, r.other)
        last = r.size
        r.size = mean_size(n, 3, r.left_over.at, r.other)
        # from where a slope is all but without bound corrections are next to nothing, and grow
        if part == 1.0 and r.size <= enough and r.size <= LESS * last:
            end_stages(r)
            e.refusal = refusal
            return True
        vain = vain + 1
        if r.size < LESS * best:
            best = r.size
            vain = 0
        if vain >= IN_VAIN:
            return False
    return False


def widen(e: Engine, r: Radau, unit: Floats) -> None:
    """Let a tolerance be no less than what a step from an edge moves by in one instant.

    Nobody knows better when it began. Near an edge all is in proportion to the time since then.
    """
    part = room_of_instant(e, r.t0) / r.h
    for i in range(r.n):
        unit[i] = max(unit[i], part * math.fabs(r.z[2 * r.n + i]))


def end_stages(r: Radau) -> None:
    """Let the Jacobian at the end be that of the step."""
    n = r.n
    r.matrix = FRESH_MATRIX
    r.served = 0.0
    r.made += 1
    for i in range(n):
        r.made_for[i] = math.fabs(r.y[2 * n + i])
    r.iterations = 1
    r.rate = 0.0
    r.now_left = 1.0
    r.swings = False


def fill_stages(e: Engine, r: Radau) -> bool:
    """Begin with what flows in by the rates where the step begins, and from there to the next."""
    n = r.n
    for k in range(3 * n):
        r.z[k] = 0.0
    place_stages(r)
    if stage_rates(e, r) != OK:
        return False
    fit(r.kept, 3 * n)
    for _ in range(FILLS):
        copy_floats(3 * n, r.z, r.kept.at)
        more = False
        for s in range(3):
            h = (STAGE_1 if s == 0 else STAGE_2 if s == 1 else 1.0) * r.h
            for i in range(n):
                k = s * n + i
                r.last[k] = h * r.f[k] if r.z[k] == 0.0 else 0.0
                more = more or r.last[k] != 0.0
        if not more or move_stages(e, r, 1.0) == 0.0:
            break
    return stage_rates(e, r) == OK


def correct_within(e: Engine, r: Radau, seen: float) -> float:
    """Correct the stages by what is solved for; return the part of it that was taken.

    As much of it as laws have values for, and after which the next correction, by the same slopes,
    is no longer: a root on both sides of rest would throw it to and fro.
    """
    many = 3 * r.n
    fit(r.next_one, many)
    copy_floats(many, r.z, r.kept.at)
    copy_floats(many, r.left_over.at, r.last)
    part = move_stages(e, r, 1.0)
    first = part
    while part > first * LEAST_PART and throws_back(r, seen):
        part = move_stages(e, r, 0.5 * part)
    if part > 0.0 and throws_back(r, seen):
        part = move_stages(e, r, first)
    return part


def throws_back(r: Radau, seen: float) -> bool:
    """Whether the next correction, by the same slopes, is longer than the last one.

    Of what is more than a part `seen` of the tolerance, and than rounding of the state: a level
    that moves by less stays where it is.
    """
    n = r.n
    put_left(r, r.next_one.at)
    solve_by_whole(r, r.next_one.at)
    last = 0.0
    most = 0.0
    for k in range(3 * n):
        unit = max(math.fabs(r.kept.at[k]), math.fabs(r.last[k]))
        least = max(seen * r.tolerance[k % n], EPSILON * math.fabs(r.y0[k % n]))
        if unit > 0.0 and math.fabs(r.next_one.at[k]) > least:
            last = max(last, math.fabs(r.last[k]) / unit)
            most = max(most, math.fabs(r.next_one.at[k]) / unit)
    return most > last


def move_stages(e: Engine, r: Radau, part: float) -> float:
    """Move the stages by a part of ``r.last``, or as much of it as laws have values for; return it.

    The rates there are those of ``r.f``; where there are none, nothing has moved.
    """
    n = r.n
    while part >= SHORTEST:
        for k in range(3 * n):
            r.z[k] = r.kept.at[k] + part * r.last[k]
        place_stages(r)
        if stage_rates(e, r) == OK:
            return part
        part *= 0.5
    copy_floats(3 * n, r.kept.at, r.z)
    place_stages(r)
    return 0.0


def falls_beyond(e: Engine, r: Radau) -> bool:
    """Whether the dense output of a step leads beyond an edge between the stages."""
    n = r.n
    refusal = e.refusal
    beyond = False
    for k in range(1, LOOKS):
        x = float(k) / float(LOOKS)
        for i in range(n):
            r.shifted[i] = r.y0[i] + x * (
                r.coefficients[i] + x * (r.coefficients[n + i] + x * r.coefficients[2 * n + i])
            )
        beyond = beyond or rate_at(e, n, r.t0 + x * r.h, r.shifted, r.end) != OK
    e.refusal = refusal
    return beyond


def lead_without_turn(r: Radau, all_of_it: bool) -> None:
    """Let the dense output rise or fall without a turn: of what is held, or of all states."""
    n = r.n
    for i in range(n):
        if not (all_of_it or (is_held(r, i) and goes_one_way(r, i))):
            continue
        way = r.z[2 * n + i]
        begin = within_turn(r.h * r.f0[i], way)
        end = within_turn(r.h * r.f[2 * n + i], way)
        r.coefficients[i] = begin
        r.coefficients[n + i] = 3.0 * way - 2.0 * begin - end
        r.coefficients[2 * n + i] = begin + end - 2.0 * way


def goes_one_way(r: Radau, i: int) -> bool:
    """Whether a state moves one way from end to end, by its rates: else it does turn between."""
    n = r.n
    way = r.z[2 * n + i]
    one = r.f0[i] * way >= 0.0
    for s in range(3):
        one = one and r.f[s * n + i] * way >= 0.0
    return one


def keep_within(e: Engine, r: Radau) -> None:
    """Keep the dense output of a step beside an edge where laws have values.

    What is beyond by more than the error of a step is not accepted by the one who asks.
    """
    s = e.step
    if not s.left_edge or s.calm >= CALM:
        return
    if r.from_edge or turns_over(r):
        lead_without_turn(r, False)
    beyond = falls_beyond(e, r)
    if beyond:
        lead_without_turn(r, True)
    s.calm = 0 if beyond or r.from_edge else s.calm + 1


def turns_over(r: Radau) -> bool:
    """Whether the dense output leads what is held beyond zero and back, on its way between."""
    n = r.n
    for i in range(n):
        ends = r.y0[i] + r.y[2 * n + i]
        if r.y0[i] * r.y[2 * n + i] < 0.0 or not is_held(r, i):
            continue
        for k in range(1, LOOKS):
            x = float(k) / float(LOOKS)
            way = x * (
                r.coefficients[i] + x * (r.coefficients[n + i] + x * r.coefficients[2 * n + i])
            )
            if (r.y0[i] + way) * ends < 0.0:
                return True
    return False


def is_held(r: Radau, i: int) -> bool:
    """Whether a state is held where it is, or begins at zero."""
    return r.y0[i] == 0.0 or r.h * math.fabs(r.jacobian[i * r.n + i]) > STEEP


def within_turn(slope: float, way: float) -> float:
    """Return the slope at an end of a cubic that goes so far, at most as large as does not turn."""
    if slope * way <= 0.0:
        return 0.0
    return math.copysign(min(math.fabs(slope), TURNS * math.fabs(way)), way)
