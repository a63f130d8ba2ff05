"""What is narrow beside a guard is not passed over by the step that finds it.

A body that slows down evenly takes one long step to rest, over all that friction does near there.
Oracle: with ``m w' = -F(w)`` it rests after ``m`` times the integral of ``1/F`` over the speeds.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import pytest
from scipy.integrate import quad

import hybond as hb

WIDTH = 1e-3
LAWS = {
    "gauss": "exp(-(w/(1 [mm/s]))^2)",
    "bent": "exp(-abs(w)/(1 [mm/s]))",
    "well": "1/(1 + (w/(1 [mm/s]))^2)",
}


def rests_after(law: str) -> float:
    """Return how long 1 kg slides from 1 m/s against 1 N and another newton near rest, s."""
    near: Callable[[float], float] = {
        "gauss": lambda u: math.exp(-(u**2)),
        "bent": lambda u: math.exp(-u),
        "well": lambda u: 1.0 / (1.0 + u**2),
    }[law]
    # u = w/WIDTH, and what is missing from sliding against 1 N all the way
    ends = (0.0, 1.0, 10.0, 100.0, 1.0 / WIDTH)
    missing = [quad(lambda u: near(u) / (1.0 + near(u)), *part)[0] for part in pairwise(ends)]
    return 1.0 - WIDTH * math.fsum(missing)


def sliding(law: str, way: float) -> hb.Model:
    """A body on ground that holds it more near rest."""
    m = hb.Model("sliding", domain="translational")
    limit = f"1 [N] + 1 [N]*{LAWS[law].replace('w', 'ground.f')}"
    m.add(body=hb.I("1 kg", f=f"{way} m/s"), v=hb.One(), ground=hb.One(law="coulomb", limit=limit))
    m.bond("v -> body", "v -> ground")
    return m


def stopped(law: str, electrical: bool) -> hb.Model:
    """The same with a rule of a machine in the place of a law of the junction."""
    text = f"-1 - {LAWS[law].replace('w', 'body.f')}"
    m = hb.Model("stopped", domain="electrical" if electrical else "translational")
    if electrical:
        text = text.replace("body.f", "body.e").replace("mm/s", "mV")
        m.add(body=hb.C("1 F", e="1 V"), v=hb.Zero(), drag=hb.Sf(f"({text})*1 [A]"))
    else:
        m.add(body=hb.I("1 kg", f="1 m/s"), v=hb.One(), drag=hb.Se(f"({text})*1 [N]"))
    m.bond("v -> body", "drag -> v")
    rest = "body.e <= 0" if electrical else "body.f <= 0"
    m.machine("M", states={"on": ["drag"], "off": []}, start="on", rules=[f"on -> off when {rest}"])
    return m


@pytest.mark.parametrize("method", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("law", LAWS)
def test_friction_that_is_larger_near_rest_stops_a_body_sooner(
    law: str, way: float, method: str
) -> None:
    run = hb.simulate(sliding(law, way), "1.1 s", solver=method)
    assert run.audit().holds()
    (event,) = run.events[1:]
    assert event.t == pytest.approx(rests_after(law), abs=5e-7)


@pytest.mark.parametrize("method", ["auto", "rk45"])
@pytest.mark.parametrize("electrical", [False, True])
@pytest.mark.parametrize("law", LAWS)
def test_a_rule_that_ends_a_motion_waits_for_what_is_narrow_before_it(
    law: str, electrical: bool, method: str
) -> None:
    run = hb.simulate(stopped(law, electrical), "1.1 s", solver=method)
    assert run.audit().holds()
    assert run.events[1].t == pytest.approx(rests_after(law), abs=5e-7)


def test_stick_slip_that_is_driven_slowly_keeps_its_energy() -> None:
    m = hb.Model("belt", domain="translational")
    limit = "1 [N] + 0.5 [N]*exp(-(ground.f/(1 [cm/s]))^2)"
    m.add(belt=hb.Sf("0.3 m/s"), spring=hb.C("0.2 m/N"), n=hb.Zero(), body=hb.I("10 g"))
    m.add(v=hb.One(), ground=hb.One(law="coulomb", limit=limit, breakaway="1.5 N"))
    m.bond("belt -> n -> spring", "n -> v -> body", "v -> ground")
    run, tight = (hb.simulate(m, "5 s", rtol=rtol) for rtol in (1e-8, 1e-11))
    assert run.audit().energy < 2e-8
    apart = [a.t - b.t for a, b in zip(run.events, tight.events, strict=True)]
    assert max(map(abs, apart)) < 2e-7


@pytest.mark.parametrize("law", LAWS)
def test_a_step_that_would_take_hundreds_to_end_at_its_guard_becomes_shorter(law: str) -> None:
    run = hb.simulate(sliding(law, 1.0), "1.1 s", solver="radau", rtol=1e-11)
    assert run.events[1].t == pytest.approx(rests_after(law), abs=1e-11)
