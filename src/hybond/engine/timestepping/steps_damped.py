"""Which steps are made again with ``theta = 1``: where less would ring, or laws would give or lag.

``theta < 1`` averages the rates that the graph has without what its laws do. Where that is of the
size of all that moves in a step it is the better formula, and where it is not, the worse:

* a law that takes hold gives energy, with what stood before it while it did not yet;
* a law of which a resistor makes more within a step (the diode in which a coil's current goes on,
  beside the megohms of an open switch) lags by half a step: the rates without it change by far more
  than those with it, and a coil hardly moves;
* what relaxes within a step turns its sign at each one, and hardly dies out, from whatever break it
  began at. Backward Euler, as of circuit simulators after a break, has it die out.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.laws.ports import open_mode, times_partner
from hybond.engine.mode.digits.part_energies import find_energies
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.storage import co_energy
from hybond.engine.model import Model
from hybond.engine.timestepping.step_records import Stepping

GIVES_PART: Final = 0.05
"""Share of the largest energy of its part so far that a law may give in a step. What conducts more
and more gives what the resistor beside it takes: of second order in the step."""
GIVES_STIFF: Final = 1e-12
"""The same where a step is so long that something in it would ring: rounding. There what laws give
adds up, step after step."""
LAGS: Final = 2.0
"""How many times what ``theta = 1`` would damp a law's lag may be worth: the better of the two, and
that with ``theta`` where they are much the same."""
DAMPED: Final = 2
"""Steps after a break that do not ring: what relaxes in a part of 1/a of a step is left as 1/a^2,
and two steps of first order cost no order."""


def is_barred(s: Stepping) -> bool:
    """Whether no step with ``theta < 1`` is to be made, whatever its laws would do."""
    return s.now.lost or (s.now.rings and s.since < DAMPED)


def is_damped(e: Engine, s: Stepping) -> bool:
    """Whether the step that was just made with ``theta < 1`` is to be made with ``theta = 1``."""
    m = e.model
    if s.now.rings and laws_turn(e, s):
        return True
    acts = False
    for k in range(m.ports):
        acts = acts or s.l[k] != 0.0
    if not acts:
        return False
    mode = open_mode(e, e.laws.now)
    find_energies(e, mode)
    return laws_give(e, s, mode) or laws_lag(e, s, mode)


def laws_turn(e: Engine, s: Stepping) -> bool:
    """Whether any law has changed its branch in the step."""
    m = e.model
    for k in range(m.ports):
        if state_of(m, s, k) != e.state[m.port_machine[k]]:
            return True
    return False


def state_of(m: Model, s: Stepping, k: int) -> int:
    """Return the state of the law of port k, by the branch at which a step ended."""
    if m.port_two_sided[k] != 0 and m.port_planar[k] == 0:
        return 2 if s.branch[k] < 0 else s.branch[k]
    return 1 if s.branch[k] != 0 else 0


def energy_at(e: Engine, mode: Mode, k: int) -> float:
    """Return the largest energy so far of the part that the law of port k acts on."""
    m = e.model
    first = m.end_first[m.port_junction[k]]
    if first == m.end_first[m.port_junction[k] + 1]:
        return e.energy
    return mode.part_energy[mode.bond_part[m.end_bond[first]]]


def laws_give(e: Engine, s: Stepping, mode: Mode) -> bool:
    """Whether any law gave much in a step, but one that rebounds, whose velocity is averaged."""
    m = e.model
    most = GIVES_STIFF if s.now.rings else GIVES_PART
    for k in range(m.ports):
        if m.port_pseudo[k] == 0 and s.restitution[k] == 0.0:
            if s.now.h * s.l[k] * s.wl[k] > most * energy_at(e, mode, k):
                return True
    return False


def laws_lag(e: Engine, s: Stepping, mode: Mode) -> bool:
    """Whether laws lag by more than ``theta = 1`` would damp, on any part.

    The work by which a law lags is ``(1 - theta) h l`` times what it has made of its own `w` since
    the step began, what ``theta = 1`` would damp more ``(1 - theta) dx' K dx``.
    """
    m = e.model
    p = e.laws.now
    for b in range(2 * m.bonds):
        made = s.begin_w[b] - s.w0[b]
        s.base[b] = (e.work.w[b] - s.without[b]) - made
    times_partner(m, p, s.base, s.free)
    lag = e.work.part_here
    some = False
    for i in range(mode.parts + 1):
        lag[i] = 0.0
    for k in range(m.ports):
        first = m.end_first[m.port_junction[k]]
        joined = first < m.end_first[m.port_junction[k] + 1]
        if m.port_pseudo[k] == 0 and joined and s.restitution[k] == 0.0:
            work = s.now.h * math.fabs(s.l[k] * s.free[k])
            if work > GIVES_STIFF * energy_at(e, mode, k):
                lag[mode.bond_part[m.end_bond[first]]] += work
                some = True
    if not some:
        return False
    co_energy(m, s.v0, s.x)
    co_energy(m, s.v1, s.move)
    for k in range(m.storages):
        if m.storage_pseudo[k] == 0:
            moved = (s.y[k] - s.begin_y[k]) * (s.move[k] - s.x[k])
            lag[mode.bond_part[m.storage_bond[k]]] -= LAGS * math.fabs(moved)
    for i in range(mode.parts + 1):
        if lag[i] > 0.0:
            return True
    return False
