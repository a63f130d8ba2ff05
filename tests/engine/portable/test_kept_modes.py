"""Modes that a run keeps: found by configuration, the least recently used given up."""

from __future__ import annotations

import random
from collections import OrderedDict

import pytest

import hybond as hb
from hybond.engine.engine import NO_MODE, OK, make_engine
from hybond.engine.mode import kept_modes
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.kept_modes import FEWEST, OF_EACH, find_kept, keep_mode
from hybond.engine.mode.mode_sizes import numbers_of
from hybond.engine.mode.nonlinear.branch import take_points
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


@pytest.mark.parametrize(("room", "most"), [(kept_modes.ROOM, 512), (0.0, FEWEST)])
def test_what_is_kept_is_what_was_used_last(monkeypatch, room, most):
    monkeypatch.setattr(kept_modes, "ROOM", room)
    e = engine(9)
    dice = random.Random(4)
    kept: OrderedDict[tuple[int, ...], int] = OrderedDict()
    found = 0
    for _ in range(6000):
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
            if len(kept) == most:
                assert kept.popitem(last=False)[1] == at
            kept[tuple(key)] = at
        kept.move_to_end(tuple(key))
        e.modes_used[at] = e.clock
        assert some(e.modes[at]).state[:9] == key
    assert 0 < found < 6000
    assert e.modes_made == len(kept) <= most
    assert len(kept) > 300 or len(kept) == most


def test_modes_that_take_much_memory_are_fewer(monkeypatch):
    one = engine(12)
    assert mode_of(one, [0] * 12) == OK
    room = OF_EACH + numbers_of(one.model, one.modes[0])
    monkeypatch.setattr(kept_modes, "ROOM", 20.0 * room)
    e = engine(12)
    for number in range(200):
        assert mode_of(e, [number >> k & 1 for k in range(12)]) == OK
    assert FEWEST < e.modes_made <= 20
    assert e.modes_built == 200


@pytest.mark.slow
def test_modes_are_kept_by_memory_and_not_by_count():
    e = engine(10)
    for number in (*range(1024), *range(1024)):
        assert mode_of(e, [number >> k & 1 for k in range(10)]) == OK
    assert e.modes_made == e.modes_built == 1024


def numbers_in(what: object, seen: set[int]) -> float:
    """Return how many numbers lists of a record hold; two whole ones count as one."""
    if id(what) in seen or what is None:
        return 0.0
    seen.add(id(what))
    if isinstance(what, list):
        return len(what) * (0.5 if what and isinstance(what[0], int) else 1.0)
    return sum(numbers_in(v, seen) for v in vars(what).values()) if hasattr(what, "__dict__") else 0


@pytest.mark.parametrize("example", ["three_tanks", "six_pulse_rectifier", "clutch", "boost"])
def test_what_a_mode_is_counted_as_is_what_its_lists_hold(example):
    e = make_engine(answered(tables_of(hb.load(f"examples/{example}.toml").flatten(), until=1.0)))
    assert mode_of(e, list(e.model.start)[: e.model.machines]) == OK
    counted = numbers_of(e.model, e.mode)
    assert counted == pytest.approx(numbers_in(e.mode, set()), rel=0.25)


def test_points_of_the_solution_that_is_followed_are_counted():
    e = engine(2)
    assert mode_of(e, [0, 0]) == OK
    many = 5000
    take_points(e, e.mode, many, [0.0] * many, [0.0] * (many * 2 * e.model.bonds))
    assert numbers_of(e.model, e.mode) == pytest.approx(numbers_in(e.mode, set()), rel=0.01)
