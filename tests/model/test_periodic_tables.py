"""Tables of time that repeat, against the same table written out for every round."""

import math

import numpy as np
import pytest
from timed import next_break

import hybond as hb
from hybond.model.inputs import Timetable

TRAPEZE = ((1.0, 0.0), (1.5, 2.0), (2.5, 2.0), (2.75, 0.0))


def written_out(rows: tuple[tuple[float, float], ...], period: float, rounds: int) -> Timetable:
    times = [t + k * period for k in range(rounds) for t, _ in rows]
    return Timetable(tuple(times), tuple(v for _ in range(rounds) for _, v in rows), linear=True)


def test_a_round_is_that_of_the_table_written_out() -> None:
    short = Timetable(*map(tuple, zip(*TRAPEZE, strict=True)), linear=True, period=3.0)
    long = written_out(TRAPEZE, 3.0, 40)
    for t in np.linspace(0.0, 100.0, 1201):
        k = short.piece(t)
        assert k == long.piece(t)
        assert short.value(t, k) == pytest.approx(long.value(t, k), abs=1e-12)
        assert short.rate(t, k) == pytest.approx(long.rate(t, k), abs=1e-11)
        assert next_break(short, t) == pytest.approx(next_break(long, t), abs=1e-12)


def test_a_row_at_the_end_of_the_period_is_a_jump_to_the_first() -> None:
    saw = Timetable((0.0, 2.0), (0.0, 5.0), linear=True, period=2.0)
    assert [saw.piece(t) for t in (0.0, 1.9, 2.0, 4.1)] == [1, 1, 2, 3]
    assert saw.value(3.0, saw.piece(3.0)) == 2.5
    assert saw.value(2.0, 1) == 5.0  # from the left
    assert saw.value(2.0, 2) == 0.0
    assert next_break(saw, 2.0) == 4.0


def test_a_held_table_repeats() -> None:
    steps = Timetable((0.0, 1.0), (3.0, -3.0), period=1.5)
    assert [steps.value(t, steps.piece(t)) for t in (-1.0, 0.5, 1.25, 1.5, 2.6)] == [
        3,
        3,
        -3,
        3,
        -3,
    ]
    assert steps.rate(0.5, 1) == 0.0


def test_rounds_do_not_drift() -> None:
    table = Timetable((0.0, 0.3), (0.0, 1.0), linear=True, period=0.7)
    t = 0.0
    for _ in range(2 * 10_000):
        t = next_break(table, t)
    assert t == 10_000 * 0.7


@pytest.mark.parametrize("solver", ["rk45", "exact"])
def test_a_run_over_many_rounds_integrates_what_it_should(solver: str) -> None:
    text = """
hybond = 1
domain = "electrical"
[elements]
I = { Sf = "u" }
c = { C = "1 F" }
n = { junction = 0 }
[graph]
bonds = ["I -> n -> c"]
[inputs]
u = { table = [["1 s", "0 A"], [1.5, 2], [2.5, 2], [2.75, 0]], linear = true, period = "3 s" }
"""
    run = hb.simulate(hb.loads(text), until=31.0, solver=solver)
    area = 0.5 * 0.5 * 2 + 2.0 + 0.5 * 0.25 * 2
    assert run["c.q"].at(31.0) == pytest.approx(10 * area, rel=1e-9)
    assert hb.loads(hb.dumps(hb.loads(text))).inputs["u"].period == "3 s"


def test_a_sum_that_rounds_to_the_period_makes_no_sliver() -> None:
    model = hb.Model("saw", domain="electrical", parameters={"a": 0.1, "b": 0.2})
    model.add(v=hb.Se("u"), r=hb.R(1.0), i=hb.One())
    model.bond("v -> i -> r")
    model.input(u=hb.Input(table=[[0, 0], ["a + b", 1]], linear=True, period=0.3))
    waveform = model.flatten().inputs[0].waveform
    assert next_break(waveform, 0.0) == 0.3
    assert next_break(waveform, 0.3) == 0.6


@pytest.mark.parametrize(
    "given",
    [
        {"table": [[0, 0], [2, 1]], "period": 1.5},
        {"table": [[0, 0], [2, 1]], "period": 0},
        {"table": [[0, 0], [2, 1]], "period": -3},
        {"constant": 1, "period": 1},
    ],
)
def test_a_period_that_cannot_be_is_refused(given: dict[str, object]) -> None:
    model = hb.Model("wrong")
    model.add(v=hb.Se("u"), r=hb.R(1.0), i=hb.One())
    model.bond("v -> i -> r")
    model.input(u=hb.Input(**given))
    with pytest.raises(hb.ModelError, match="period") as caught:
        model.flatten()
    assert caught.value.code == "HB-M150"


def test_before_the_first_time_nothing_repeats() -> None:
    table = Timetable((1.0, 2.0), (4.0, 6.0), linear=True, period=2.0)
    assert table.piece(0.5) == 0
    assert table.value(0.5, 0) == 4.0
    assert next_break(table, -5.0) == 1.0
    assert math.isinf(table.begin(0))
