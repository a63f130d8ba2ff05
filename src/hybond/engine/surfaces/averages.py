"""What is asked of a mode, asked of the combination of modes while machines slide.

Every bond variable is the average of an infinitely fast switching.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.blocks import fit, grow_block
from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.engine import NOT_FINITE, OK, Engine
from hybond.engine.inputs.interval import set_time
from hybond.engine.mode.digits.part_energies import find_energies, reach_of_bond
from hybond.engine.mode.digits.sizes import seen_of, sizes_of
from hybond.engine.mode.left_free.undetermined import freedom_at
from hybond.engine.mode.mode_records import Mode, Reads
from hybond.engine.mode.nonlinear.newton_system import write_bonds
from hybond.engine.mode.solving import solve, solve_read
from hybond.engine.surfaces.blend import blend
from hybond.engine.surfaces.outputs import solve_plain
from hybond.engine.surfaces.surface import part_mode
from hybond.engine.words import Floats


def solve_here(e: Engine, mode: Mode, v: Floats) -> int:
    """Put the bond variables of a mode, or of a combination, into `e.work.w` and `v`."""
    if e.slide.k == 0:
        return solve(e, mode, v)
    if blend(e, v) != OK:
        return NOT_FINITE
    copy_floats(2 * e.model.bonds, e.slide.w, e.work.w)
    write_bonds(e, v, e.slide.w)
    return OK


def solve_read_here(e: Engine, mode: Mode, reads: Reads, v: Floats) -> int:
    """Put those there that are read; of a combination all of them."""
    return solve_read(e, mode, reads, v) if e.slide.k == 0 else solve_here(e, mode, v)


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
    for part in range(s.parts):
        copy_floats(2 * m.slots, v, s.v)
        own = part_mode(e, part)
        if solve_plain(e, part, s.v) == OK:
            sizes_of(e, own, s.v)
            for k in range(n):
                size = math.fabs(s.coefficient[part]) * e.work.sizes[k]
                s.w_size[k] = max(s.w_size[k], size)
    for k in range(n):
        e.work.sizes[k] = s.w_size[k]
        e.work.w[k] = s.w[k]


def begin_sizes(e: Engine, mode: Mode, v: Floats, x: Floats, terms: Floats) -> None:
    """Prepare for guards to be measured at the values `v`, `x` being stored, after `solve_here`.

    What bond variables of a combination are measured by is found at once, into `terms`.
    """
    m = e.model
    if m.laws > 0:
        seen_of(e, mode, v, x)
    if e.slide.k == 0:
        return
    sizes_here(e, mode, v)
    put_terms(e, mode, terms)


def put_terms(e: Engine, mode: Mode, terms: Floats) -> None:
    """Put what bond variables are measured by into `terms`: beside laws by what is stored, too."""
    m = e.model
    find_energies(e, mode)
    for b in range(2 * m.bonds):
        terms[m.bond_slot + b] = e.work.sizes[b]
        if m.laws > 0:
            terms[m.bond_slot + b] = max(e.work.sizes[b], reach_of_bond(e, mode, b, e.work.xi))


def part_sizes(e: Engine, part: int, v: Floats, x: Floats, terms: Floats) -> None:
    """Do the same for one of the modes that are combined, not kept to what others hold."""
    s = e.slide
    own = part_mode(e, part)
    copy_floats(2 * e.model.slots, v, s.v)
    if solve_plain(e, part, s.v) != OK:
        return
    if e.model.laws > 0:
        seen_of(e, own, s.v, x)
    sizes_of(e, own, s.v)
    put_terms(e, own, terms)


def show_part(e: Engine, part: int, v: Floats) -> None:
    """Write the Booleans and bond variables of a part, after `solve_here`; -1: of all together."""
    m = e.model
    s = e.slide
    mode = e.mode if part < 0 else part_mode(e, part)
    copy_part(m.switches + m.state_first[m.machines], mode.flags, 0, v, m.on_slot)
    for b in range(2 * m.bonds):
        at = part * 2 * m.bonds + b
        v[m.bond_slot + b] = (
            s.w[b]
            if part < 0
            else s.plain_solution[at]
            if s.common and m.laws > 0
            else s.solution[at]
        )


def freedom_here(e: Engine, mode: Mode, v: Floats) -> int:
    """Return in how many directions bond variables are free, those into `e.work.freedom`.

    A combination leaves open what any of its parts does.
    """
    s = e.slide
    if s.k == 0:
        return freedom_at(e, mode, v)
    n = 2 * e.model.bonds
    many = 0
    for part in range(s.parts):
        copy_floats(2 * e.model.slots, v, s.v)
        if solve_plain(e, part, s.v) != OK:
            continue
        own = freedom_at(e, part_mode(e, part), s.v)
        grow_block(s.freedom, n * (many + own))
        for j in range(own):
            for k in range(n):
                s.freedom.at[(many + j) * n + k] = e.work.freedom.at[k * own + j]
        many += own
    fit(e.work.freedom, n * max(many, 1))
    for k in range(n):
        e.work.w[k] = s.w[k]
        for j in range(many):
            e.work.freedom.at[k * many + j] = s.freedom.at[j * n + k]
    return many


def blended_field(e: Engine, t: float, y: Floats, rate: Floats) -> int:
    """Put ``y'`` of the combination into `rate`."""
    m = e.model
    set_time(e, e.v, t)
    copy_part(m.storages, y, 0, e.v, m.stored_slot)
    copy_part(m.integrals, y, m.storages, e.v, m.signal_slot)
    if blend(e, e.v) != OK:
        return NOT_FINITE
    copy_floats(e.states, e.slide.rate, rate)
    return OK
