"""Laws put back into themselves, with the values that are read from outside.

Bond variables come from an elimination, Newton's method and least leakage. None of that is used
here: each law as it was declared is given all values, and what is left is held against the sizes
of its own terms. So a law that any of these lost on the way is found.

It is looked at after each settled instant (of a mode whose laws are all linear after the first
OFTEN, then after each SELDOM-th), and between at each SPARSE-th evaluation of the rates, sooner at
the beginning: what is rounding is known by how large variables have been.
Motion along a surface is left out, where no law of one mode holds, and so is time-stepping, whose
laws hold over a step.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.rounding import EPSILON, UNDERFLOW
from hybond.engine.answers import value
from hybond.engine.checks.another import look_for_another
from hybond.engine.checks.bounds_held import MOST
from hybond.engine.checks.shown import clear_prior, show_at
from hybond.engine.engine import Engine
from hybond.engine.method_numbers import MOREAU
from hybond.engine.mode.digits.reach import reach_of
from hybond.engine.mode.digits.sizes import size_of
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.storage import co_energy_of, own_stiffness, stiff
from hybond.engine.mode.rows.storage_bonds import co_energy_bond
from hybond.engine.mode.rows.tableau import part_of
from hybond.engine.reasons.noting import ELEMENT, JUNCTION, STORAGE, note_violation

PART: Final = 1e-9
"""What a law may be off by, as a part of its terms."""
ROUNDING: Final = 1e-11
"""Likewise, as a part of what the largest variable of each kind has brought it in the run."""
SOLVED: Final = 1e-12
"""Likewise, of the largest variable of any kind: where Newton ends."""
BLIND: Final = 1e-3
"""The part of its terms by which a law may be off where digits were lost: what is off by more is no
solution, however it came about. Likewise of a variable, whose digits are known if less is lost."""
LOST_DIGITS: Final = 1e-13
"""Likewise, of the terms that made a variable, as where a guard is asked."""
SOLVED_FROM: Final = 4
"""Roundings of what a field stores where it is held to what other ports store: an entry divided by
another, a product, what is stored itself, and a product in the law."""
LASTS: Final = 1e-6
"""Part of the run from which on a step ends at what was not there for a moment alone."""
SPARSE: Final = 512
SOON: Final = 8
"""Evaluations from one look to the next at the least; then as many as there were."""
OFTEN: Final = 16
"""Times that time begins to pass in a linear mode before it is looked at less often."""
SELDOM: Final = 16


def look_now_and_then(e: Engine) -> None:
    """Look at the laws if that is due again."""
    if e.evaluations >= e.checks.due:
        look_at_laws(e)
        e.checks.looked = e.t


def look_at_entry(e: Engine) -> None:
    """Look at the laws of the mode in which time begins to pass.

    Where all of them are linear, what holds at many points holds at all: from then on it is done
    every few times, so that an event costs no more than its share.
    """
    mode = e.mode
    mode.looks += 1
    if mode.looks <= OFTEN or mode.looks % SELDOM == 0 or bends(e, mode):
        look_at_laws(e)


def bends(e: Engine, mode: Mode) -> bool:
    """Whether any law of a mode is not linear."""
    m = e.model
    found = mode.dynamics > 0
    for k in range(m.storages):
        found = found or m.co_energy[k] >= 0
    return found


def look_at_laws(e: Engine) -> None:
    """Put the present values into all laws of the mode, and note those that do not hold."""
    m = e.model
    c = e.checks
    c.due = e.evaluations + min(max(e.evaluations, SOON), SPARSE)
    if e.slide.k > 0 or m.method == MOREAU:
        return
    mode = e.mode
    if not show_at(e, mode, e.t, e.y):
        # nothing can be read here; a step that needs it is refused
        return
    clear_prior(e)
    c.looks += 1
    c.shown_at = e.t
    hold_laws(e, mode)
    if mode.dynamics > 0 and not mode.affine:
        look_for_another(e, mode)


def hold_laws(e: Engine, mode: Mode) -> None:
    """Hold the values in `e.checks.v` against all laws of a mode.

    First as if elimination and jumps had lost nothing, since nearly always all laws hold then.
    """
    c = e.checks
    c.first_look = True
    c.suspects = 0
    measure_bonds(e, mode)
    hold_all(e, mode)
    if c.suspects > 0:
        c.first_look = False
        measure_bonds(e, mode)
        # what a jump leaves is as exact as what was stored before it was large
        reach_of(e, mode, e.y, e.work.reach)
        hold_all(e, mode)


def hold_all(e: Engine, mode: Mode) -> None:
    """Hold the values against each law."""
    m = e.model
    for element in range(m.elements):
        hold_element(e, mode, element)
    for k in range(m.storages):
        hold_storage(e, k)
    for j in range(m.junctions):
        switch = m.junction_switch[j]
        if switch >= 0 and mode.on[switch] == 0:
            hold_off(e, j)
        else:
            hold_junction(e, j)


def measure_bonds(e: Engine, mode: Mode) -> None:
    """Find what each bond variable may be off by.

    Where elimination lost digits, as between milliohms and megohms, those are missing here too.
    What is beyond all bounds is told by `bounds_held`.
    """
    m = e.model
    c = e.checks
    most = 0.0
    step = e.step.t1 - e.step.t0
    lasts = step >= LASTS * e.span
    for k in range(2 * m.bonds):
        size = math.fabs(c.v[m.bond_slot + k])
        c.magnitude[k] = size
        kind = m.bond_class[k]
        c.largest[kind] = max(c.largest[kind], size)
        c.lasting[kind] = max(c.lasting[kind], size) if lasts else c.lasting[kind]
        most = max(most, size)
        if not size <= MOST:
            c.unbounded = k
    for k in range(2 * m.bonds):
        c.tolerance[k] = PART * c.magnitude[k] + ROUNDING * c.largest[m.bond_class[k]]
        c.lost[k] = SOLVED * most if m.dynamics > 0 else 0.0
        if not c.first_look:
            size = size_of(e, mode, k, e.work.xi, c.v)
            c.lost[k] += LOST_DIGITS * size


def hold_element(e: Engine, mode: Mode, element: int) -> None:
    """Put the values into the rows of an element."""
    m = e.model
    c = e.checks
    part = part_of(m, mode, element)
    source = m.part_source[part]
    given = 0.0
    if source >= 0:
        law = m.source_value[source]
        given = m.source_constant[source] if law < 0 else value(m, law, c.v)
    for row in range(m.part_power[part], m.part_power[part + 1]):
        level = given if row < m.part_law[part] else 0.0
        total = -level
        size = math.fabs(level)
        may = PART * size
        lost = 0.0
        known = 0.0
        for i in range(m.row_first[row], m.row_first[row + 1]):
            k = m.row_column[i]
            factor = m.row_value[i]
            total += factor * c.v[m.bond_slot + k]
            size += math.fabs(factor) * c.magnitude[k]
            may += math.fabs(factor) * c.tolerance[k]
            lost += math.fabs(factor) * c.lost[k]
            if c.lost[k] <= BLIND * c.magnitude[k]:
                known += math.fabs(factor) * c.magnitude[k]
        lost = excused(lost, size, known, may)
        judge(e, ELEMENT, element, total, size, may + lost)
    for d in range(m.part_dynamic[part], m.part_dynamic[part + 1]):
        total = value(m, m.dynamic_value[d], c.v)
        size = 0.0
        may = 0.0
        lost = 0.0
        known = 0.0
        for i in range(m.slope_first[d], m.slope_first[d + 1]):
            law = m.slope_value[i]
            slope = math.fabs(m.slope_constant[i] if law < 0 else value(m, law, c.v))
            k = m.slope_column[i]
            if math.isfinite(slope):
                size += slope * c.magnitude[k]
                may += slope * c.tolerance[k]
                lost += slope * c.lost[k]
                if c.lost[k] <= BLIND * c.magnitude[k]:
                    known += slope * c.magnitude[k]
            else:
                may += moved_by(e, d, k, total)
        if not c.first_look:
            size = max(size, value(m, m.dynamic_rounding[d], c.v))
        judge(e, ELEMENT, element, total, size, may + excused(lost, size, known, may))


def excused(lost: float, size: float, known: float, may: float) -> float:
    """Return by how much more a law may be off that reads variables which lost digits.

    All that is lost, where nothing else is known: a current that is zero among others. A term whose
    digits are known says what the others have to be.
    """
    return min(lost, BLIND * size) if known > may else lost


def moved_by(e: Engine, d: int, k: int, total: float) -> float:
    """Return how far a law moves as one variable moves by what it may be off.

    Where it has no slope, as a root has none at zero.
    """
    m = e.model
    c = e.checks
    at = m.bond_slot + k
    kept = c.v[at]
    most = 0.0
    for side in range(2):
        way = c.tolerance[k] + c.lost[k]
        c.v[at] = kept + way if side == 0 else kept - way
        off = math.fabs(value(m, m.dynamic_value[d], c.v) - total)
        if math.isfinite(off):
            most = max(most, off)
    c.v[at] = kept
    return most


def hold_storage(e: Engine, k: int) -> None:
    """Hold what a storage puts on its bond against what it stores."""
    m = e.model
    c = e.checks
    at = co_energy_bond(m, k)
    own = co_energy_of(m, k, c.v)
    shown = c.v[m.bond_slot + at]
    if m.storage_kind[k] == 1:
        shown *= float(m.storage_sign[k])
    may = PART * math.fabs(own) + c.tolerance[at]
    if not c.first_look:
        held = SOLVED * e.work.reach[k] * math.fabs(own_stiffness(m, k, c.v))
        may += held if math.isfinite(held) else 0.0
        may += rounding_of_field(e, k)
    judge(e, STORAGE, k, shown - own, math.fabs(own), may + c.lost[at])


def rounding_of_field(e: Engine, k: int) -> float:
    """Return what rounding may leave of what the ports of a field put on port k together.

    Their terms cancel where coils are coupled well. Each is a product of what is stored, which was
    solved from what others store, and they are added up: half a last place at each turn.
    """
    m = e.model
    v = e.checks.v
    terms = 0.0
    many = m.stiff_first[k + 1] - m.stiff_first[k]
    for i in range(m.stiff_first[k], m.stiff_first[k + 1]):
        terms += math.fabs(stiff(m, i, v) * v[m.stored_slot + m.stiff_other[i]])
    may = 0.5 * EPSILON * float(many + SOLVED_FROM) * terms
    return may if math.isfinite(may) else 0.0


def hold_junction(e: Engine, j: int) -> None:
    """Hold a junction that is ON: its common variable is one, the others' sum is zero."""
    m = e.model
    c = e.checks
    common = 0 if m.junction_kind[j] == 0 else m.bonds
    other = m.bonds - common
    total = 0.0
    size = 0.0
    may = 0.0
    first = common + m.end_bond[m.end_first[j]] if m.end_first[j] < m.end_first[j + 1] else 0
    for i in range(m.end_first[j], m.end_first[j + 1]):
        k = common + m.end_bond[i]
        apart = c.v[m.bond_slot + k] - c.v[m.bond_slot + first]
        both = c.tolerance[k] + c.lost[k] + c.tolerance[first] + c.lost[first]
        judge(e, JUNCTION, j, apart, c.magnitude[k], both)
        k = other + m.end_bond[i]
        total += float(m.end_sign[i]) * c.v[m.bond_slot + k]
        size += c.magnitude[k]
        may += c.tolerance[k] + c.lost[k]
    judge(e, JUNCTION, j, total, size, may)


def hold_off(e: Engine, j: int) -> None:
    """Hold a junction that is OFF: it gives zero to each of its bonds."""
    m = e.model
    c = e.checks
    common = 0 if m.junction_kind[j] == 0 else m.bonds
    for i in range(m.end_first[j], m.end_first[j + 1]):
        k = common + m.end_bond[i]
        may = c.tolerance[k] - PART * c.magnitude[k] + c.lost[k]
        judge(e, JUNCTION, j, c.v[m.bond_slot + k], c.magnitude[k], may)


def judge(e: Engine, what: int, index: int, off: float, size: float, may: float) -> None:
    """Note a law of which more is left than it may be; the first of each element is told."""
    if math.fabs(off) <= may + UNDERFLOW or may == math.inf:
        return
    if e.checks.first_look:
        e.checks.suspects += 1
        return
    note_violation(e, e.mode, e.t, what, index, math.fabs(off), size)
