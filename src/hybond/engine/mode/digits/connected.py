"""Which parts of the graph hang together in a mode: between them no rounding passes.

The tables join what always is one part, however machines switch (`tables/islands`). Junctions that
are ON join the rest; one that is OFF gives each of its bonds zero, and tells none of the others. A
step of fixed length solves for what its laws do, so that these join there in any case.
"""

from __future__ import annotations

from hybond.engine.algebra.separate import first_of, unite
from hybond.engine.engine import Engine
from hybond.engine.method_numbers import MOREAU
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.tableau import NET
from hybond.engine.model import Model
from hybond.engine.words import Ints


def find_connected(e: Engine, mode: Mode) -> None:
    """Find the part that each bond of a mode is in, unless that is known.

    Those that hold anything are numbered as storages stand; all others have the number behind.
    """
    if mode.connected:
        return
    m = e.model
    mode.connected = True
    mode.floored_at = -1.0
    mode.parts = m.most_parts
    if m.most_parts <= 1:
        return
    root = e.work.base_root
    for i in range(m.bases):
        root[i] = i
    for j in range(m.junctions):
        switch = m.junction_switch[j]
        # one whose law is left open joins its bonds as well if their sum is what is given
        if switch >= 0 and (mode.on[switch] != 0 or mode.given[j] == NET):
            join_ends(m, root, j)
    for k in range(m.ports if m.method == MOREAU else 0):
        join_ends(m, root, m.port_junction[k])
    number = e.work.base_part
    mode.parts = number_parts(m, root, number)
    for b in range(m.bonds):
        mode.bond_part[b] = number[first_of(root, m.bond_base[b])]


def join_ends(m: Model, root: Ints, j: int) -> None:
    """Join the bonds of a junction."""
    first = m.end_first[j]
    for i in range(first + 1, m.end_first[j + 1]):
        unite(root, m.bond_base[m.end_bond[first]], m.bond_base[m.end_bond[i]])


def number_parts(m: Model, root: Ints, number: Ints) -> int:
    """Number what stands for each part, as storages stand; return how many hold anything."""
    for i in range(m.bases):
        number[i] = -1
    parts = 0
    for k in range(m.storages):
        own = first_of(root, m.bond_base[m.storage_bond[k]])
        if number[own] < 0:
            number[own] = parts
            parts += 1
    for i in range(m.bases):
        if number[i] < 0:
            number[i] = parts
    return parts
