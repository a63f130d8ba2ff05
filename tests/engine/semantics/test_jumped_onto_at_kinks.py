"""Tables that jump by a state, or at a kink of time, under bodies that touch them.

A source that jumps stands for one that is fast: on its way what touches stays in touch, so a body
that lay there has the table's speed, whatever its restitution is. What arrives rebounds.
"""

from __future__ import annotations

import pytest
from scipy.integrate import solve_ivp

import hybond as hb

AFTER_ONE = {
    "state": "if clock.q > 0 then 2 else 0",
    "sign of a state": "1 + sign(clock.q)",
    "time": "1 + sign(time - 1)",
    "timed event": "if time > 1 then 2 else 0",
}


def table(speed: str, way: float = 1.0, press: float = 0.0, height: float = 0.0) -> hb.Model:
    """Return a body on a table, or at a height above it; under it, with `way` -1."""
    m = hb.Model("table", domain="translational")
    m.add(clock=hb.C(1.0, q=-1.0), ticks=hb.Sf(1.0), w=hb.Se(-way * press))
    m.add(b=hb.I(1.0), v=hb.One(), u=hb.Sf(f"{way}*({speed})"), tab=hb.One())
    m.add(c=hb.Zero(law="unilateral", restitution=0.5, gap="h"))
    m.bond("ticks -> clock", "v -> b", "w -> v", "u -> tab")
    m.bond(*(("c -> v", "tab -> c") if way > 0.0 else ("v -> c", "c -> tab")))
    m.signal(h=hb.Integral(f"{way}*(v.f - tab.f)", start=height))
    return m


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("press", [0.0, 0.1, 5.0])
@pytest.mark.parametrize("speed", AFTER_ONE.values(), ids=AFTER_ONE)
def test_a_body_that_touched_rebounded_from_a_table_that_jumped_by_a_state(
    speed: str, press: float, way: float
) -> None:
    run = hb.simulate(table(speed, way, press), until=2.0)
    assert run["v.f"].at(1.5) == pytest.approx(2.0 * way, rel=1e-12)
    assert run["v.f"].at(2.0) == pytest.approx(2.0 * way, rel=1e-12)
    # m v of the body, and nothing is lost to a table that moves as a whole: m v^2/2 of work is
    assert run["b.p"].at(2.0) == pytest.approx(2.0 * way, rel=1e-12)


def test_it_is_the_limit_of_tables_that_are_fast() -> None:
    """A stiff pad in place of the contact, under a ramp that takes long beside the pad's period."""

    def rates(t: float, y: list[float]) -> list[float]:
        speed = 2.0 * min(max((t - 1.0) / 0.05, 0.0), 1.0)
        force = max(0.0, -1e9 * y[0] - 2e4 * (y[1] - speed))
        return [y[1] - speed, force - 0.1]

    led = solve_ivp(rates, (0.9, 1.2), [-1e-10, 0.0], "Radau", rtol=1e-8, atol=1e-12, max_step=1e-2)
    # the pad gives back no more than the acceleration over its frequency
    assert led.y[1, -1] == pytest.approx(2.0, abs=40.0 / 1e9**0.5)
    run = hb.simulate(table(AFTER_ONE["state"], press=0.1), until=1.2)
    assert run["v.f"].at(1.2) == pytest.approx(2.0, rel=1e-12)


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("speed", AFTER_ONE.values(), ids=AFTER_ONE)
def test_what_arrives_at_a_table_that_has_jumped_rebounds(speed: str, way: float) -> None:
    """It is 0.5 m above, and the table comes at 2 m/s from 1 s on: v+ = 2 + 2/2 from 1.25 s on."""
    run = hb.simulate(table(speed, way, height=0.5), until=1.5)
    assert [e.t for e in run.trace.events][-1] == pytest.approx(1.25, abs=1e-9)
    assert run["v.f"].at(1.5) == pytest.approx(3.0 * way, rel=1e-9)


@pytest.mark.parametrize("speed", AFTER_ONE.values(), ids=AFTER_ONE)
def test_bodies_in_a_row_on_a_table_that_jumps_by_a_state(speed: str) -> None:
    m = table(speed)
    m.add(b2=hb.I(3.0), v2=hb.One(), c2=hb.Zero(law="unilateral", restitution=0.5, gap="h2"))
    m.bond("v2 -> b2", "c2 -> v2", "v -> c2")
    m.signal(h2=hb.Integral("v2.f - v.f", start=0.0))
    run = hb.simulate(m, until=2.0)
    assert run["v.f"].at(2.0) == pytest.approx(2.0, rel=1e-12)
    assert run["v2.f"].at(2.0) == pytest.approx(2.0, rel=1e-12)
