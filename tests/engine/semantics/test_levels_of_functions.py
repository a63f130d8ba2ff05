"""A relay along a level that a function in Python gives, and that jumps unannounced."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

import hybond as hb


def relay(level: Callable[[float], float], *, turned: bool = False) -> hb.Model:
    """A mass of 1 kg that is pushed by 3 N up or down to a speed."""
    m = hb.Model("relay")
    push = "if r.state == 'on' then 3 else -3"
    m.add(j=hb.One(), i=hb.I(1.0), s=hb.Se(f"-({push})" if turned else push))
    m.bond("j -> s" if turned else "s -> j", "j -> i")
    m.input(u=hb.Input(function=level))
    rules = ["on -> off when i.f > u", "off -> on when i.f < u"]
    m.machine("r", states={"on": [], "off": []}, start="on", rules=rules)
    return m


def led(levels: list[tuple[float, float]], t: float) -> float:
    """Return the speed: towards the level of each piece by 3 m/s2, from that of the one before."""
    speed = 0.0
    ends = [begin for begin, _ in levels[1:]] + [math.inf]
    for (begin, level), end in zip(levels, ends, strict=True):
        if t < begin:
            break
        way = 3.0 * (min(t, end) - begin)
        speed += max(-way, min(way, level - speed))
    return speed


STAIRS = [(0.0, 0.0), (0.13, 0.3), (0.26, 0.6), (0.39, 0.9), (0.52, 0.2)]


@pytest.mark.parametrize(
    "levels", [[(0.0, 0.0), (0.4137, 1.0)], STAIRS, [(0.0, 0.0), (0.7, -1e-3)]]
)
@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("turned", [False, True])
def test_a_level_that_jumps_within_a_step_is_left_where_it_jumps(
    levels: list[tuple[float, float]], solver: str, turned: bool
) -> None:
    """One step went to the end; in between what was read was the level, and at the end was zero."""
    begins = [begin for begin, _ in levels]

    def level(t: float) -> float:
        assert 0.0 <= t <= 1.0
        return levels[int(np.searchsorted(begins, t, side="right")) - 1][1]

    run = hb.simulate(relay(level, turned=turned), 1.0, solver=solver)
    for t in np.linspace(0.0, 1.0, 38):
        assert run["i.f"].at(float(t)) == pytest.approx(led(levels, float(t)), abs=1e-10)
    jumps = [event.t for event in run.events if event.cause == "law"]
    assert jumps == pytest.approx(begins[1:], abs=1e-11)


def test_steps_that_find_no_way_over_it_say_what_is_missing() -> None:
    m = hb.Model("pulled")
    m.add(j=hb.One(), i=hb.I(1.0), s=hb.Se("u"))
    m.bond("s -> j -> i")
    m.input(u=hb.Input(function=lambda t: 0.0 if t == 0.5 else 1.0 / abs(t - 0.5)))
    with pytest.raises(hb.NumericsError, match="HB-N201") as told:
        hb.simulate(m, 1.0)
    assert "give `breaks` to u" in str(told.value)


def test_a_level_that_moves_smoothly_is_followed() -> None:
    run = hb.simulate(relay(lambda t: 1e-3 * math.sin(2e3 * t)), 0.01)
    for t in np.linspace(0.0, 0.01, 9):
        assert run["i.f"].at(float(t)) == pytest.approx(1e-3 * math.sin(2e3 * t), abs=1e-9)
        assert run.weight("r", "on", float(t)) == pytest.approx(
            0.5 + math.cos(2e3 * t) / 3.0, abs=1e-6
        )
