"""Motion on switching surfaces: a combination of the modes between which it slides.

On the surfaces the modes around give the fields ``f_c``, and the motion is ``f_0 + sum_j weight_j
(f_j - f_0)``, f_j having only machine j above its surface, with weights such that no switching
function moves. Every bond variable is the same combination. After programs/combined.py.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.lu import SINGULAR, lu_factor, lu_solve
from hybond.engine.engine import (
    NOT_FINITE,
    OK,
    REFUSED,
    Engine,
    Mode,
    say_fault,
)
from hybond.engine.inputs.interval import set_time
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.newton import freedom_at, solve
from hybond.engine.mode.newton_system import write_bonds
from hybond.engine.mode.sizes import seen_of, sizes_of
from hybond.engine.model import value
from hybond.engine.reasons.facts import add_fact
from hybond.engine.sliding.common_space import NEVER, find_common, keep_to_all, onto_all
from hybond.engine.sliding.surface import (
    is_of_state,
    part_mode,
    put_read,
    surface_rate,
    surface_value,
)
from hybond.engine.words import Floats, Ints

ROUNDING: Final = 1e-14
"""An average below this part of what it is made of is zero."""
OFTEN: Final = 3
"""Times that a state is put back on its surfaces."""


def take_parts(e: Engine, state: Ints) -> int:
    """Take the modes around the surfaces ``side[0 .. k - 1]`` of a mode, and what they hold."""
    m = e.model
    s = e.slide
    s.known = False
    for part in range(s.k + 1):
        for machine in range(m.machines):
            s.target[machine] = state[machine]
        for j in range(s.k):
            surface = s.side[j]
            above = part == j + 1
            s.target[m.surface_machine[surface]] = (
                m.surface_above[surface] if above else m.surface_below[surface]
            )
        if mode_of(e, s.target) != OK:
            return REFUSED
        s.part[part] = e.mode_at
    if mode_of(e, state) != OK:
        return REFUSED
    return OK


def combine_here(e: Engine, state: Ints) -> int:
    """Take what a mode is combined of while some machines slide; nothing if none does."""
    m = e.model
    s = e.slide
    s.k = 0
    if s.many == 0:
        return OK
    for i in range(s.many):
        surface = s.surface[i]
        now = state[m.surface_machine[surface]]
        if now == m.surface_below[surface] or now == m.surface_above[surface]:
            s.side[s.k] = surface
            s.k += 1
    if s.k == 0:
        return OK
    if take_parts(e, state) != OK:
        return REFUSED
    if find_common(e) == NEVER:
        why = "sliding between modes with these constraints is not part of an export"
        return say_fault(e, "HB-E635", why, "")
    for j in range(s.k):
        if not is_of_state(e, s.side[j]):
            why = "sliding on a surface that reads what can jump is not part of an export"
            return say_fault(e, "HB-E635", why, "")
    return OK


def solve_part(e: Engine, part: int, v: Floats, rates: Floats, at: int, kept: bool) -> int:
    """Put the rates of the state in a part there, from `at` on; bond variables into `e.work.w`.

    Parts with constraints of their own are `kept` to those of all, by vanishing impulses.
    """
    m = e.model
    s = e.slide
    mode = part_mode(e, part)
    for k in range(m.switches + m.state_first[m.machines]):
        v[m.on_slot + k] = mode.flags[k]
    if solve(e, mode, v) != OK:
        return NOT_FINITE
    for k in range(m.storages):
        bond = m.storage_bond[k] + (m.bonds if m.storage_kind[k] == 0 else 0)
        negative = m.storage_kind[k] == 0 and m.storage_sign[k] < 0
        s.rates[k] = -e.work.w[bond] if negative else e.work.w[bond]
    if s.common and kept:
        for k in range(2 * m.bonds):
            s.w[k] = e.work.w[k]
        keep_to_all(e, v, s.w, s.rates)
        for k in range(2 * m.bonds):
            e.work.w[k] = s.w[k]
        write_bonds(e, v, s.w)
    for k in range(m.storages):
        rates[at + k] = s.rates[k]
    for k in range(m.integrals):
        rates[at + m.storages + k] = value(m, m.integral_rate[k], v)
    return OK


def find_speeds(e: Engine, kept: bool) -> int:
    """Find how fast each switching function moves in each part, into `part_speed`."""
    m = e.model
    s = e.slide
    n = e.states
    for part in range(s.k + 1):
        if solve_part(e, part, s.v, s.part_rate, part * n, kept) != OK:
            return NOT_FINITE
        for k in range(2 * m.bonds):
            s.solution[part * 2 * m.bonds + k] = e.work.w[k]
    for j in range(s.k):
        put_read(e, s.side[j], s.v)
        for part in range(s.k + 1):
            s.part_speed[part * s.k + j] = surface_rate(
                e, s.side[j], s.v, s.part_rate, part * n, True
            )
    return OK


def blend(e: Engine, v: Floats) -> int:
    """Find the combination at the time, state and inputs in `v`, into `e.slide`."""
    m = e.model
    s = e.slide
    n = e.states
    if s.known and is_here(e, v):
        return OK
    for k in range(2 * m.slots):
        s.v[k] = v[k]
    s.known = False
    if s.common and find_pushes(e) != OK:
        return NOT_FINITE
    if find_speeds(e, True) != OK:
        return NOT_FINITE
    if find_weights(e) != OK:
        return NOT_FINITE
    s.coefficient[0] = 1.0
    for j in range(s.k):
        s.coefficient[0] -= s.weight[j]
        s.coefficient[j + 1] = s.weight[j]
    average(e, 2 * m.bonds, s.solution, s.w)
    average(e, n, s.part_rate, s.rate)
    find_margins(e)
    s.at[0] = v[0]
    for k in range(m.storages):
        s.at[1 + k] = v[m.stored_slot + k]
    for k in range(m.integrals):
        s.at[1 + m.storages + k] = v[m.signal_slot + k]
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
        for p in range(s.k):
            s.change[j * s.k + p] = s.part_speed[(p + 1) * s.k + j] - s.part_speed[j]
            s.matrix[j * s.k + p] = s.change[j * s.k + p]
        s.weight[j] = -s.part_speed[j]
    return solve_weights(e, s.weight)


def solve_weights(e: Engine, right: Floats) -> int:
    """Solve with the matrix in `e.slide`, in place; NOT_FINITE with a fault if it is singular."""
    s = e.slide
    regular = lu_factor(s.k, s.matrix, s.pivot) != SINGULAR
    if regular:
        lu_solve(s.k, s.matrix, s.pivot, 1, right)
    for j in range(s.k):
        regular = regular and math.isfinite(right[j])
    if regular:
        return OK
    say_fault(e, "HB-N405", "no combination of the modes stays on the surfaces", "")
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
        for part in range(s.k + 1):
            total += s.coefficient[part] * rows[part * n + k]
            size += math.fabs(s.coefficient[part]) * math.fabs(rows[part * n + k])
        out[k] = 0.0 if math.fabs(total) <= ROUNDING * size else total


def find_pushes(e: Engine) -> int:
    """Keep how fast the functions move before a jump, to tell how surfaces are approached."""
    s = e.slide
    if find_speeds(e, False) != OK:
        return NOT_FINITE
    for i in range((s.k + 1) * s.k):
        s.plain_speed[i] = s.part_speed[i]
    return OK


def find_margins(e: Engine) -> None:
    """Find how far the motion is from leaving each surface, below and above."""
    s = e.slide
    for j in range(s.k):
        s.margin[2 * j] = s.weight[j]
        s.margin[2 * j + 1] = 1.0 - s.weight[j]
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
    total = 0.0
    rest = 1.0
    for p in range(s.k):
        weight = side if p == j else s.weight[p]
        rest -= weight
        total += weight * s.plain_speed[(p + 1) * s.k + j]
    return total + rest * s.plain_speed[j]


# -- what asks for one mode asks for these


def solve_here(e: Engine, mode: Mode, v: Floats) -> int:
    """Put the bond variables of a mode, or of a combination, into `e.work.w` and `v`."""
    if e.slide.k == 0:
        return solve(e, mode, v)
    if blend(e, v) != OK:
        return NOT_FINITE
    for k in range(2 * e.model.bonds):
        e.work.w[k] = e.slide.w[k]
    write_bonds(e, v, e.slide.w)
    return OK


def sizes_here(e: Engine, mode: Mode, v: Floats) -> None:
    """Put the sizes of the terms of bond variables into `e.work.sizes`, after `solve_here`."""
    m = e.model
    s = e.slide
    if s.k == 0:
        sizes_of(e, mode, v)
        return
    n = 2 * m.bonds
    for k in range(n):
        s.w_size[k] = math.fabs(s.w[k])
    for part in range(s.k + 1):
        for k in range(2 * m.slots):
            s.v[k] = v[k]
        own = part_mode(e, part)
        for k in range(m.switches + m.state_first[m.machines]):
            s.v[m.on_slot + k] = own.flags[k]
        if solve(e, own, s.v) == OK:
            sizes_of(e, own, s.v)
            for k in range(n):
                size = math.fabs(s.coefficient[part]) * e.work.sizes[k]
                s.w_size[k] = max(s.w_size[k], size)
    for k in range(n):
        e.work.sizes[k] = s.w_size[k]
        e.work.w[k] = s.w[k]


def begin_sizes(e: Engine, mode: Mode, v: Floats, x: Floats, terms: Floats) -> None:
    """Prepare for guards to be measured at the values `v`, `x` being stored, after `solve_here`.

    What bond variables of a combination are measured by is found at once, into `terms`; what was
    seen of them between junction laws does not count there: sliding beside such laws is refused.
    """
    m = e.model
    if e.slide.k == 0:
        if m.laws > 0:
            seen_of(e, mode, x)
        return
    sizes_here(e, mode, v)
    for b in range(2 * m.bonds):
        terms[m.bond_slot + b] = e.work.sizes[b]


def freedom_here(e: Engine, mode: Mode, v: Floats) -> int:
    """Return in how many directions bond variables are free, those into `e.work.freedom`.

    What a combination leaves open is what its first part does.
    """
    if e.slide.k == 0:
        return freedom_at(e, mode, v)
    return 0


def blended_field(e: Engine, t: float, y: Floats, rate: Floats) -> int:
    """Put ``y'`` of the combination into `rate`."""
    m = e.model
    set_time(e, e.v, t)
    for k in range(m.storages):
        e.v[m.stored_slot + k] = y[k]
    for k in range(m.integrals):
        e.v[m.signal_slot + k] = y[m.storages + k]
    if blend(e, e.v) != OK:
        return NOT_FINITE
    for k in range(e.states):
        rate[k] = e.slide.rate[k]
    return OK


def onto_surfaces(e: Engine, t: float, y: Floats) -> int:
    """Put the state back on its surfaces, along the fields that hold it there."""
    s = e.slide
    n = e.states
    v = e.shown
    for _ in range(OFTEN):
        if s.common:
            show_state(e, t, y, v)
            onto_all(e, v, y)
        show_state(e, t, y, v)
        off = False
        for j in range(s.k):
            s.right[j] = surface_value(e, s.side[j], v)
            off = off or s.right[j] != 0.0
        if not off:
            return OK
        if blend(e, v) != OK:
            return NOT_FINITE
        for i in range(s.k * s.k):
            s.matrix[i] = s.change[i]
        if solve_weights(e, s.right) != OK:
            return NOT_FINITE
        still = True
        for k in range(n):
            back = 0.0
            for j in range(s.k):
                back += s.right[j] * (s.part_rate[(j + 1) * n + k] - s.part_rate[k])
            moved = y[k] - back
            still = still and moved == y[k]
            y[k] = moved
        if still:
            return OK
        s.known = False
    return OK


def show_state(e: Engine, t: float, y: Floats, v: Floats) -> None:
    """Write time and state, as the combination asks for."""
    m = e.model
    set_time(e, v, t)
    for k in range(m.slots):
        v[m.slots + k] = 0.0
    for k in range(m.storages):
        v[m.stored_slot + k] = y[k]
    for k in range(m.integrals):
        v[m.signal_slot + k] = y[m.storages + k]
