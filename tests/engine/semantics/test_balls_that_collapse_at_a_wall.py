"""A light ball between a wall and a heavy one comes to rest there with it, by thousands of impacts.

Each takes a little less than the one before, all within one instant: 1,000 were too few, and easy
rows of balls were refused (HB-N402).
"""

from typing import Literal

import pytest

import hybond as hb

WALL, BALLS = 0.00561281, 0.5


def course(heavy: float, gap: float, apart: float, light: float, speed: float) -> tuple[float, int]:
    """Return when they come to rest at the wall, and after how many impacts, one by one."""
    t, x, y, u, v, many = 0.0, gap, gap + apart, light, speed, 0
    while max(abs(u), abs(v)) > 1e-14:
        at_wall = x / -u if u < 0.0 else float("inf")
        at_ball = (y - x) / (u - v) if u > v else float("inf")
        if at_wall == at_ball == float("inf"):
            break
        h = min(at_wall, at_ball)
        t, x, y, many = t + h, x + h * u, y + h * v, many + 1
        if at_wall <= at_ball:
            x, u = 0.0, -WALL * u
        else:
            y = x
            impulse = (1.0 + BALLS) * (u - v) * heavy / (1.0 + heavy)
            u, v = u - impulse, v + impulse / heavy
    return t, many


def row(
    heavy: float, gap: float, apart: float, light: float, speed: float, turned: bool
) -> hb.Model:
    """Return two balls beside a wall."""
    m = hb.Model("row", domain="translational")
    m.add(a=hb.One(), b=hb.One(), A=hb.I(1.0, p=light), B=hb.I(heavy, p=heavy * speed))
    m.add(wall=hb.Zero(law="unilateral", gap="x", restitution=WALL), stands=hb.Sf(0.0))
    m.add(c=hb.Zero(law="unilateral", gap="y - x", restitution=BALLS))
    m.bond("b -> B", "a -> A", "wall -> a", "c -> b", "a -> c")
    m.bond("wall -> stands" if turned else "stands -> wall")
    m.signal(x=hb.Integral("a.f", start=gap), y=hb.Integral("b.f", start=gap + apart))
    return m


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("turned", [False, True], ids=["on", "turned"])
@pytest.mark.parametrize(
    "given",
    [
        (88.67463909, 0.31077767, 0.84632981, 0.22953722, -0.49057881),
        (70.0, 1.0, 0.5, 0.0, -2.0),
        (200.0, 0.01, 0.3, -0.1, -0.7),
    ],
    ids=["met", "at rest", "behind"],
)
def test_they_rest_at_the_wall(
    given: tuple[float, float, float, float, float],
    turned: bool,
    solver: Literal["auto", "rk45", "radau"],
) -> None:
    end, many = course(*given)
    assert many > 1000
    run = hb.simulate(row(*given, turned), 1.5 * end, solver=solver)
    assert run.status == "ok"
    for name in ("a.f", "b.f"):
        # slower than that they no longer approach each other
        assert run[name].at(1.001 * end) == pytest.approx(0.0, abs=1e-9)
    assert run["x"].at(1.5 * end) == pytest.approx(0.0, abs=1e-9)
    assert run["y"].at(1.5 * end) == pytest.approx(0.0, abs=1e-9)
    assert any(abs(e.t - end) < 1e-6 * end for e in run.events)
