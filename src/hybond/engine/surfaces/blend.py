"""Motion on switching surfaces: a combination of the modes between which it slides.

On the surfaces the modes around give the fields ``f_c``, and the motion is their combination with
coefficients such that no switching function moves: ``f_0 + sum_j weight_j (f_j - f_0)``, f_j having
only machine j above its surface, where the switches act independently of each other; else that of
all corners, with products of weights, by Newton's method.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.lu import SINGULAR, lu_factor, lu_solve
from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.answers import value
from hybond.engine.engine import NOT_FINITE, OK, Engine, say_fault
from hybond.engine.mode.nonlinear.newton_system import write_bonds
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.mode.solving import solve
from hybond.engine.reasons.facts import add_fact
from hybond.engine.surfaces.common_space import keep_to_all
from hybond.engine.surfaces.corners import put_coefficients, put_slopes, speed_at
from hybond.engine.surfaces.law_means import begin_impulses, put_law_margins
from hybond.engine.surfaces.outputs import output_rate
from hybond.engine.surfaces.surface import part_mode, put_read, surface_rate
from hybond.engine.words import Floats

ROUNDING: Final = 1e-14
"""An average below this part of what it is made of is zero."""
ROUNDS: Final = 30
STILL: Final = 1e-14
"""Weights are of order one: a step of Newton's method below this is rounding, and the last."""
SOLVED: Final = 1e-9
"""Weights are taken if the last of all steps was below this: it need not come to rounding."""
ASTRAY: Final = 2.0
"""Weights further than this from the middle are no answer."""


def solve_part(e: Engine, part: int, v: Floats, rates: Floats, at: int, kept: bool) -> int:
    """Put the rates of the state in a part there, from `at` on; bond variables into `e.work.w`.

    Parts with constraints of their own are `kept` to those of all, by vanishing impulses.
    """
    m = e.model
    s = e.slide
    mode = part_mode(e, part)
    copy_part(m.switches + m.state_first[m.machines], mode.flags, 0, v, m.on_slot)
    if solve(e, mode, v) != OK:
        return NOT_FINITE
    for k in range(m.storages):
        bond = rate_bond(m, k)
        s.rates[k] = way_of_rate(m, k) * e.work.w[bond]
    if s.common and kept:
        copy_floats(2 * m.bonds, e.work.w, s.w)
        keep_to_all(e, v, s.w, s.rates)
        copy_floats(2 * m.bonds, s.w, e.work.w)
        write_bonds(e, v, s.w)
    copy_part(m.storages, s.rates, 0, rates, at)
    for k in range(m.integrals):
        rates[at + m.storages + k] = value(m, m.integral_rate[k], v)
    return OK


def find_speeds(e: Engine, kept: bool) -> int:
    """Find how fast each switching function moves in each part, into `part_speed`."""
    m = e.model
    s = e.slide
    n = e.states
    if s.common and kept:
        begin_impulses(e)
    for part in range(s.parts):
        if solve_part(e, part, s.v, s.part_rate, part * n, kept) != OK:
            return NOT_FINITE
        copy_part(2 * m.bonds, e.work.w, 0, s.solution, part * 2 * m.bonds)
    for j in range(s.k):
        surface = s.side[j]
        if s.of_state[j] != 0:
            put_read(e, surface, s.v)
        for part in range(s.parts):
            s.part_speed[part * s.k + j] = (
                surface_rate(e, surface, s.v, s.part_rate, part * n, True)
                if s.of_state[j] != 0
                else output_rate(e, surface, s.v, s.part_rate, part * n)
            )
    return OK


def blend(e: Engine, v: Floats) -> int:
    """Find the combination at the time, state and inputs in `v`, into `e.slide`."""
    m = e.model
    s = e.slide
    n = e.states
    if s.known and is_here(e, v):
        return OK
    copy_floats(2 * m.slots, v, s.v)
    s.known = False
    if s.common and find_pushes(e) != OK:
        return NOT_FINITE
    if find_speeds(e, True) != OK:
        return NOT_FINITE
    if find_weights(e) != OK:
        return NOT_FINITE
    put_coefficients(s, s.weight, s.coefficient)
    average(e, 2 * m.bonds, s.solution, s.w)
    average(e, n, s.part_rate, s.rate)
    find_margins(e)
    put_law_margins(e)
    s.at[0] = v[0]
    copy_part(m.storages, v, m.stored_slot, s.at, 1)
    copy_part(m.integrals, v, m.signal_slot, s.at, 1 + m.storages)
    s.known = True
    return OK


def is_here(e: Engine, v: Floats) -> bool:
    """Whether the combination known is that at the values `v`."""
    m = e.model
    same = e.slide.at[0] == v[0]
    for k in range(m.storages):
        same = same and e.slide.at[1 + k] == v[m.stored_slot + k]
    for k in range(m.integrals):
        same = same and e.slide.at[1 + m.storages + k] == v[m.signal_slot + k]
    return same


def find_weights(e: Engine) -> int:
    """Find the weights with which no switching function moves."""
    s = e.slide
    for j in range(s.k):
        s.gone[j] = 0
    if s.product and s.k > 1:
        return find_product(e)
    for j in range(s.k):
        for p in range(s.k):
            s.change[j * s.k + p] = s.part_speed[(p + 1) * s.k + j] - s.part_speed[j]
            s.matrix[j * s.k + p] = s.change[j * s.k + p]
        s.weight[j] = -s.part_speed[j]
        leave_alone(e, j)
    return solve_weights(e, s.weight)


def leave_alone(e: Engine, j: int) -> None:
    """Ask for the side that function j moves to, if no switch changes how fast it moves.

    Then there is nothing to slide on any more: an event, or a kink, has made the parts alike.
    """
    s = e.slide
    for p in range(s.k):
        size = math.fabs(s.part_speed[(p + 1) * s.k + j]) + math.fabs(s.part_speed[j])
        if not math.fabs(s.change[j * s.k + p]) <= ROUNDING * size:
            return
    up = s.part_speed[j] > 0.0
    if s.part_speed[j] == 0.0:
        up = e.mode.state[e.model.surface_machine[s.side[j]]] == e.model.surface_above[s.side[j]]
    s.gone[j] = 1 if up else -1
    for p in range(s.k):
        s.matrix[j * s.k + p] = 1.0 if p == j else 0.0
    s.weight[j] = 1.0 if up else 0.0


def find_product(e: Engine) -> int:
    """Find those of a product combination, from the last ones, else from the middle."""
    s = e.slide
    for attempt in range(2):
        for j in range(s.k):
            s.weight[j] = s.last[j] if s.has_last and attempt == 0 else 0.5
        step = math.inf
        for _ in range(ROUNDS):
            find_change(e)
            for j in range(s.k):
                s.right[j] = speed_at(s, s.part_speed, s.coefficient, j)
            copy_floats(s.k * s.k, s.change, s.matrix)
            if solve_weights(e, s.right) != OK:
                return NOT_FINITE
            step = 0.0
            for j in range(s.k):
                s.weight[j] -= s.right[j]
                step = max(step, math.fabs(s.right[j]))
            if step <= STILL:
                break
        taken = step <= SOLVED
        for j in range(s.k):
            taken = taken and math.fabs(s.weight[j] - 0.5) <= ASTRAY
        if taken:
            find_change(e)
            copy_floats(s.k, s.weight, s.last)
            s.has_last = True
            return OK
    return no_combination(e)


def find_change(e: Engine) -> None:
    """Find the coefficients of a product, and how the weights move the functions."""
    s = e.slide
    put_coefficients(s, s.weight, s.coefficient)
    put_slopes(s)
    for j in range(s.k):
        for p in range(s.k):
            total = 0.0
            for part in range(s.parts):
                total += s.part_speed[part * s.k + j] * s.by[part * s.k + p]
            s.change[j * s.k + p] = total


def solve_weights(e: Engine, right: Floats) -> int:
    """Solve with the matrix in `e.slide`, in place; NOT_FINITE with a fault if it is singular."""
    s = e.slide
    regular = lu_factor(s.k, s.matrix, s.pivot) != SINGULAR
    if regular:
        lu_solve(s.k, s.matrix, s.pivot, 1, right)
    for j in range(s.k):
        regular = regular and math.isfinite(right[j])
    return OK if regular else no_combination(e)


def no_combination(e: Engine) -> int:
    """Note that the surfaces touch, or the switches cancel."""
    say_fault(e, "HB-N405", "no combination of the modes stays on the surfaces", "")
    s = e.slide
    if e.model.tells != 0:
        for j in range(s.k):
            add_fact(e.fault, float(s.side[j]))
    e.fault.t = s.v[0]
    return NOT_FINITE


def average(e: Engine, n: int, rows: Floats, out: Floats) -> None:
    """Put the combination of rows there; what cancels but for rounding is zero."""
    s = e.slide
    for k in range(n):
        total = 0.0
        size = 0.0
        for part in range(s.parts):
            total += s.coefficient[part] * rows[part * n + k]
            size += math.fabs(s.coefficient[part]) * math.fabs(rows[part * n + k])
        out[k] = 0.0 if math.fabs(total) <= ROUNDING * size else total


def find_pushes(e: Engine) -> int:
    """Keep how fast the functions move before a jump, to tell how surfaces are approached."""
    m = e.model
    s = e.slide
    if find_speeds(e, False) != OK:
        return NOT_FINITE
    copy_floats(s.parts * s.k, s.part_speed, s.plain_speed)
    for i in range(s.parts * 2 * m.bonds if m.laws > 0 else 0):
        s.plain_solution[i] = s.solution[i]
    return OK


def find_margins(e: Engine) -> None:
    """Find how far the motion is from leaving each surface, below and above."""
    s = e.slide
    for j in range(s.k):
        s.margin[2 * j] = s.weight[j]
        s.margin[2 * j + 1] = 1.0 - s.weight[j]
        if s.gone[j] != 0:
            s.margin[2 * j + (1 if s.gone[j] > 0 else 0)] = -1.0
            continue
        if not s.common:
            continue
        low = side_speed(e, j, 0.0)
        high = side_speed(e, j, 1.0)
        size = math.fabs(low) + math.fabs(high)
        if size > 0.0:
            s.margin[2 * j] = min(s.margin[2 * j], low / size)
            s.margin[2 * j + 1] = min(s.margin[2 * j + 1], -high / size)
        else:
            s.margin[2 * j] = min(s.margin[2 * j], 1.0)
            s.margin[2 * j + 1] = min(s.margin[2 * j + 1], 1.0)


def side_speed(e: Engine, j: int, side: float) -> float:
    """Return how fast function j moves, jumps left out, with its own machine on one side."""
    s = e.slide
    for p in range(s.k):
        s.tilted[p] = side if p == j else s.weight[p]
    put_coefficients(s, s.tilted, s.tilted_coefficient)
    return speed_at(s, s.plain_speed, s.tilted_coefficient, j)
