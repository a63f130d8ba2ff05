"""Modes that a run keeps: found by configuration, the least recently used given up."""

from __future__ import annotations

import random
from collections import OrderedDict

import hybond as hb
from hybond.engine.engine import NO_MODE, make_engine
from hybond.engine.mode.kept_modes import find_kept, keep_mode
from hybond.engine.mode.mode_records import KEPT
from hybond.engine.tables import answered, tables_of
from hybond.engine.words import some


def engine(machines: int):
    """Return a run of a model of so many switches."""
    m = hb.Model("switches", domain="electrical")
    m.add(C=hb.C(1, e=1), n=hb.Zero())
    m.bond("C -> n")
    for k in range(machines):
        m.add(**{f"s{k}": hb.One(), f"r{k}": hb.R(1)})
        m.bond(f"n -> s{k} -> r{k}")
        m.machine(f"m{k}", states={"open": [], "closed": [f"s{k}"]}, start="open")
    return make_engine(answered(tables_of(m.flatten(), until=1.0)))


def test_what_is_kept_is_what_was_used_last():
    e = engine(9)
    dice = random.Random(4)
    kept: OrderedDict[tuple[int, ...], int] = OrderedDict()
    found = 0
    for _ in range(3000):
        # some configurations come back soon, others hardly ever
        number = min(int(dice.expovariate(1 / 60)), 511)
        key = [number >> k & 1 for k in range(9)]
        e.clock += 1
        at = find_kept(e, key)
        assert (at != NO_MODE) == (tuple(key) in kept)
        if at != NO_MODE:
            found += 1
            assert kept[tuple(key)] == at
        else:
            at = keep_mode(e, key)
            if len(kept) == KEPT:
                assert kept.popitem(last=False)[1] == at
            kept[tuple(key)] = at
        kept.move_to_end(tuple(key))
        some(e.modes[at]).used = e.clock
        assert some(e.modes[at]).state[:9] == key
    assert 0 < found < 3000
    assert len(kept) == KEPT
