"""What is asked for at points of a known motion, and what of the equations of a mode that takes.

In a linear mode the bond variables that are asked for are evaluated alone, from the co-energy
variables, sources and states that they read: a model may be large and the question small.
"""

from __future__ import annotations

from hybond.engine.algebra.blocks import Places, fit_places, make_places
from hybond.engine.algebra.twofold import row_closely
from hybond.engine.answers import value
from hybond.engine.engine import Engine
from hybond.engine.inputs.interval import set_time
from hybond.engine.mode.mode_records import Mode, Reads, make_reads
from hybond.engine.mode.reading import read_bond, read_nothing
from hybond.engine.mode.rows.storage import co_energy_of
from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, ints, record


@record
class Ask:
    """Slots that are asked for, and what that takes in the mode looked at.

    Where `sparse`, the bond variables in `reads` are evaluated alone: `part` are the states that
    this takes, `storage` the co-energy variables, `source` and `rated` the sources of which the
    value and the rate are read.
    """

    many: int
    slot: Places
    known: bool
    """Whether what follows is that of the mode looked at."""
    reads: Reads
    sparse: bool
    parts: int
    part: Ints
    storages: int
    storage: Ints
    sources: int
    source: Ints
    rateds: int
    rated: Ints
    needed: Ints


def make_ask(m: Model) -> Ask:
    """Return a question for nothing."""
    a = Ask()
    a.slot = make_places(16)
    a.reads = make_reads(m)
    a.part = ints(m.storages + m.integrals)
    a.storage = ints(m.storages)
    a.source = ints(m.most_sources)
    a.rated = ints(m.most_sources)
    a.needed = ints(m.storages)
    return a


def ask_for_powers(m: Model, a: Ask) -> None:
    """Ask for efforts and flows where power enters and leaves."""
    a.many = 2 * (m.suppliers + m.dissipators)
    fit_places(a.slot, a.many)
    for k in range(m.suppliers + m.dissipators):
        at = k - m.suppliers
        bond = m.supplier_bond[k] if at < 0 else m.dissipator_bond[at]
        a.slot.at[2 * k] = m.bond_slot + bond
        a.slot.at[2 * k + 1] = m.bond_slot + m.bonds + bond


def prepare(e: Engine, a: Ask, corrects: bool) -> None:
    """Find what a question takes in the mode looked at; all states, if that corrects them."""
    m = e.model
    if a.known:
        return
    a.known = True
    a.sparse = e.slide.k == 0 and e.mode.dynamics == 0
    a.parts = 0
    if a.sparse:
        read_nothing(m, a.reads)
        for i in range(a.many):
            b = a.slot.at[i] % m.slots - m.bond_slot
            if b >= 0 and b < 2 * m.bonds:
                read_bond(m, e.mode, a.reads, b)
        find_sources(e.mode, a)
        find_storages(m, e.mode, a)
    if a.sparse and not corrects and reads_time_only(m, e.mode, a):
        find_parts(m, a)
        return
    a.parts = e.states
    for s in range(e.states):
        a.part[s] = s


def find_sources(mode: Mode, a: Ask) -> None:
    """Find the sources whose values and rates are read."""
    a.sources = 0
    a.rateds = 0
    for k in range(mode.sources):
        if a.reads.valued[k] != 0:
            a.source[a.sources] = k
            a.sources += 1
        if a.reads.rated[k] != 0:
            a.rated[a.rateds] = k
            a.rateds += 1


def find_storages(m: Model, mode: Mode, a: Ask) -> None:
    """Find the co-energy variables that are read."""
    for k in range(m.storages):
        a.needed[k] = 0
    a.storages = 0
    for i in range(a.reads.many):
        row = mode.same[a.reads.bond[i]]
        for p in range(mode.direct.first.at[row], mode.direct.first.at[row + 1]):
            k = mode.direct.column.at[p]
            if k < m.storages and a.needed[k] == 0:
                a.needed[k] = 1
                a.storage[a.storages] = k
                a.storages += 1


def reads_time_only(m: Model, mode: Mode, a: Ask) -> bool:
    """Whether no source that is read follows the state."""
    for i in range(a.sources):
        source = mode.source[a.source[i]]
        if source >= 0 and m.source_value[source] >= 0 and m.source_timed[source] == 0:
            return False
    found = True
    for i in range(a.rateds):
        found = found and m.source_timed[mode.source[a.rated[i]]] != 0
    return found


def find_parts(m: Model, a: Ask) -> None:
    """Find the states that co-energy variables read, and those that are asked for themselves."""
    for k in range(m.storages):
        a.needed[k] = 0
    for i in range(a.storages):
        k = a.storage[i]
        for p in range(m.stiff_first[k], m.stiff_first[k + 1]):
            a.needed[m.stiff_other[p]] = 1
    for i in range(a.many):
        k = a.slot.at[i] % m.slots - m.stored_slot
        if k >= 0 and k < m.storages:
            a.needed[k] = 1
    for k in range(m.storages):
        if a.needed[k] != 0:
            a.part[a.parts] = k
            a.parts += 1
    for k in range(m.integrals):
        a.part[a.parts] = m.storages + k
        a.parts += 1


def solve_asked(e: Engine, a: Ask, t: float, y: Floats) -> None:
    """Write time, the states that are read, and the bond variables that are asked for."""
    m = e.model
    mode = e.mode
    v = e.v
    xi = e.work.xi
    set_time(e, v, t)
    for i in range(a.parts):
        k = a.part[i]
        v[m.stored_slot + k if k < m.storages else m.signal_slot + k - m.storages] = y[k]
    for i in range(a.storages):
        xi[a.storage[i]] = co_energy_of(m, a.storage[i], v)
    for i in range(a.sources):
        k = a.source[i]
        law = m.source_value[mode.source[k]] if mode.source[k] >= 0 else -1
        xi[m.storages + k] = mode.source_level[k] if law < 0 else value(m, law, v)
    for i in range(a.rateds):
        k = a.rated[i]
        xi[m.storages + mode.sources + k] = value(m, m.source_rate[mode.source[k]], v)
    for i in range(a.reads.many):
        b = a.reads.bond[i]
        v[m.bond_slot + b] = row_closely(mode.direct, mode.same[b], xi)
