"""The rates of a mode all of which are sums of the state: nothing else is evaluated in a step."""

from __future__ import annotations

from hybond.engine.engine import Engine
from hybond.engine.mode.comparisons.sum_records import Sums, begin_sum, begin_sums, end_sum
from hybond.engine.mode.comparisons.sums import take_bond, take_sum
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.rows.storage_bonds import rate_bond, way_of_rate
from hybond.engine.model import Model
from hybond.engine.words import Floats


def take_rates(e: Engine, mode: Mode) -> None:
    """Take the rates of the motion that begins, into `e.rates`, if all of them are sums.

    Where laws have kinks or edges, or the direction of slip counts, bond variables are looked at
    beside the rates.
    """
    m = e.model
    e.straight = False
    if e.slide.k > 0 or mode.dynamics > 0 or m.groups > 0:
        return
    if m.kinks > 0 or m.edges > 0 or m.disks > 0 or m.called > 0:
        return
    e.rates = mode.summed
    # inputs stand in those of integrated signals only, with what they are in the interval
    lasts = m.integrals == 0 or (m.inputs == 0 and m.watches == 0)
    if not (mode.summed_known and lasts):
        mode.summed_straight = take_all(e, mode.summed)
        mode.summed_known = True
    e.straight = mode.summed_straight


def take_all(e: Engine, s: Sums) -> bool:
    """Take the rates of all states; False if one of them is no sum."""
    m = e.model
    begin_sums(s, e.states)
    for k in range(m.storages):
        if not take_rate(e, m, s, k):
            return False
    first = m.kink_atom + m.kinks + m.slide_kinks
    for k in range(m.integrals):
        take_sum(e, s, m.storages + k, first + k)
        if s.known.at[m.storages + k] == 0:
            return False
    return True


def take_rate(e: Engine, m: Model, s: Sums, k: int) -> bool:
    """Take the rate of storage k; False if it is no sum."""
    at = rate_bond(m, k)
    begin_sum(s, k)
    known = take_bond(e, s, k, at, way_of_rate(m, k))
    end_sum(s, k, known)
    return known


def put_rates(e: Engine, t: float, y: Floats, rate: Floats) -> None:
    """Put the rates there."""
    s = e.rates
    for k in range(e.states):
        total = s.level.at[k] + s.drift.at[k] * t
        for p in range(s.first.at[k], s.first.at[k + 1]):
            total += s.factor.at[p] * y[s.column.at[p]]
        rate[k] = total
