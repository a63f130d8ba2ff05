"""What cannot be looked into is refused before the library reads it."""

from __future__ import annotations

import numpy as np
import pytest
from engine.by_engine import EngineLook, EngineModel
from engine.looked_at import (
    model_of,
)

import hybond as hb
from hybond.engine.compiled.points import Points, Steps, Within
from hybond.engine.tables import tables_of


def test_what_is_out_of_range_is_refused() -> None:
    model = model_of("relay_feedback")
    look = EngineLook(model)
    n = model.record.storages + model.record.integrals
    machines, slots = model.record.machines, model.record.slots
    point = Points([0.0], np.zeros((1, n)))
    with pytest.raises(ValueError, match="nothing is looked into"):
        look.values(point, [0])
    start = model.tables.ints["start"]
    for t in (-1.0, np.nan, np.inf, 1e9):
        with pytest.raises(ValueError, match="run from 0"):
            look.into(t, start)
    for state in ([-1] * machines, [99] * machines, [0] * (machines + 1), [0.5] * machines):
        with pytest.raises(ValueError, match="state"):
            look.into(0.0, state)
    with pytest.raises(ValueError, match="landed"):
        look.into(0.0, start, landed=True)
    for surfaces in ([-1], [model.record.surfaces], [0, 0], [2**40], [[0]]):
        with pytest.raises(ValueError, match="surface"):
            look.into(0.0, start, surfaces=surfaces)
    for energy in (-1.0, np.nan, np.inf):
        with pytest.raises(ValueError, match="energy"):
            look.into(0.0, start, energy=energy)
    look.into(0.0, start)
    for slot in ([-1], [2 * slots], [2**31], [0.5], [[0]]):
        with pytest.raises(ValueError, match="slots"):
            look.values(point, slot)
        with pytest.raises(ValueError, match="slots"):
            look.parts(point, slot)
    other = Points([0.0], np.zeros((1, n + 1)))
    for ask in (look.powers, lambda p: look.values(p, [0])):
        with pytest.raises(ValueError, match="states"):
            ask(other)


def test_points_and_steps_that_are_none_are_refused() -> None:
    time, state, dense = [[0.0, 1.0, 0.9]], np.zeros((1, 3, 2)), np.zeros((1, 4, 2))
    steps = Steps(time, state, dense)
    for wrong in ([[0.0, 1.0]], [[0.0, 1.0, 1.1]], [[1.0, 1.0, 1.0]], [[0.0, np.nan, 1.0]]):
        with pytest.raises(ValueError):
            Steps(wrong, state, dense)
    for y, d in ((state[:, :2], dense), (state, dense[:, :3]), (state, dense[:, :, :1])):
        with pytest.raises(ValueError, match="belong"):
            Steps(time, y, d)
    for t in ([-0.1], [0.95], [np.nan], 0.5):
        with pytest.raises(ValueError):
            Within(steps, t)
    for step in ([1], [-1], [0, 0], [0.0], [2**32]):
        with pytest.raises(ValueError, match="step"):
            Within(steps, [0.5], step)
    for t, y in (([0.0], np.zeros(2)), ([0.0, 1.0], np.zeros((1, 2))), ([0.0], [[np.inf]])):
        with pytest.raises(ValueError):
            Points(t, y)
    with pytest.raises(ValueError, match="broadcast"):
        Points([0.0], [[0.0]], accepted=[True, False])


def test_a_law_without_a_value_is_named() -> None:
    m = hb.Model("root", domain="electrical")
    m.add(l=hb.I(1, f=1), i=hb.One(), r=hb.R({"e": "sqrt(f/1 [A])*1 [V]"}))
    m.bond("i -> l", "i -> r")
    look = EngineLook(EngineModel(tables_of(m.flatten(), until=1.0)))
    look.into(0.0, [])
    assert look.powers(Points([0.0], [[4.0]])).tolist() == [[0.0, 8.0]]
    with pytest.raises(hb.NumericsError) as caught:
        look.powers(Points([0.0, 0.25], [[4.0], [-1.0]]))
    assert (caught.value.code, caught.value.where) == ("HB-N302", "r")
    assert "0.25" in caught.value.why
    # and looking goes on
    assert look.powers(Points([0.0], [[4.0]])).tolist() == [[0.0, 8.0]]
