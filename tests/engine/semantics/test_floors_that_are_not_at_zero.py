"""A ball comes to rest on a floor wherever that is.

Where it is compared with 5.3 m it is known to 1e-15 m: rebounds had to become less high than that
beside the first one, which none did. Impacts went on, a million of them.
"""

import math
from typing import Literal

import pytest

import hybond as hb

PUSH, SPEED = 0.55, 0.2
GUARDS = [
    "x > {at}",
    "x >= {at}",
    "{at} < x",
    "2*x > 2*{at}",
    "x^3 > {at}^3",
    "exp(x/50) > exp({at}/50)",
]


def ball(at: float, restitution: float, guard: str, *, turned: bool) -> hb.Model:
    """Return a ball that a force drives against a wall 1 m ahead; without a guard it has a gap."""
    m = hb.Model("ball")
    m.add(v=hb.One(), i=hb.I(0.5, p=0.5 * SPEED), F=hb.Se(0.5 * PUSH))
    m.bond("F -> v", "v -> i")
    m.signal(x=hb.Integral("v.f", start=at - 1.0))
    if not guard:
        m.add(w=hb.Zero(law="unilateral", gap=f"{at} - x", restitution=restitution), s=hb.Sf(0.0))
        m.bond("v -> w", "w -> s" if turned else "s -> w")
        return m
    law = f"{restitution}*pre(v.f)"
    m.add(w=hb.Zero(), s=hb.Sf(f"-{law}" if turned else law))
    m.bond("v -> w", "w -> s" if turned else "s -> w")
    m.machine(
        "contact",
        states={"free": [], "hit": ["w"]},
        start="free",
        rules=[
            f"free -> hit when {guard.format(at=at)} and v.f > 0",
            "hit -> free when pre(contact.state == 'hit')",
        ],
    )
    return m


@pytest.mark.sampled(6)
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45", "exact"])
@pytest.mark.parametrize("guard", [*GUARDS, ""], ids=[*"abcdef", "gap"])
@pytest.mark.parametrize("restitution", [0.5, 0.8, 0.95])
@pytest.mark.parametrize("turned", [False, True], ids=["on", "turned"])
@pytest.mark.parametrize("at", [5.3, -1000.1, 31.7, 0.0])
def test_it_comes_to_rest_there(
    at: float,
    turned: bool,
    restitution: float,
    guard: str,
    solver: Literal["auto", "radau", "rk45", "exact"],
) -> None:
    struck = math.sqrt(SPEED**2 + 2.0 * PUSH)
    end = (struck - SPEED) / PUSH + 2.0 * struck * restitution / (1.0 - restitution) / PUSH
    run = hb.simulate(ball(at, restitution, guard, turned=turned), 1.2 * end, solver=solver)
    assert run.status == "ok"
    assert len(run.events) < 500
    # each impact is off by what its guard cannot tell: 1e-13 of where it is
    assert run.events[-1].t == pytest.approx(end, rel=2e-6 + 1e-8 * abs(at))
    assert run["v.f"].at(1.2 * end) == pytest.approx(0.0, abs=1e-12)
    assert run["x"].at(1.2 * end) == pytest.approx(at, abs=1e-9 + 1e-12 * abs(at))
