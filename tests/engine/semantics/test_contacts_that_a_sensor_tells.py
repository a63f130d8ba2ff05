"""A contact that another machine tells lands as one that looks for itself.

What the sensor compares is met again at once behind each impact, as a comparator's that slides. The
machine behind it is struck each time: that is no fast switching, and was refused as one (HB-N415).
"""

import math
from typing import Literal

import pytest

import hybond as hb

DROP, PUSH = 1.0, 9.81
SENSORS = {
    "both": ["far -> at when x <= {at} and v.f < 0", "at -> far when v.f >= 0 or x > {at}"],
    "struck": ["far -> at when x <= {at} and v.f < 0", "at -> far when A.state == 'hit'"],
    "place": ["far -> at when x <= {at}", "at -> far when x > {at}"],
    "back": ["far -> at when x <= {at} and v.f < 0", "at -> far when pre(S.state == 'at')"],
}


def ball(at: float, restitution: float, sensor: str, *, turned: bool, first: bool) -> hb.Model:
    """Return a ball above a floor that a sensor sees; a force takes it up again at 20 s."""
    m = hb.Model("ball")
    law = f"{restitution}*pre(v.f)"
    m.add(v=hb.One(), i=hb.I(1.0), F=hb.Se("u"), floor=hb.Zero())
    m.add(s=hb.Sf(law if turned else f"-{law}"))
    m.bond("F -> v", "v -> i", "floor -> v", "floor -> s" if turned else "s -> floor")
    m.input(u=hb.Input(table=[(0.0, -PUSH), (20.0, 2.0)]))
    m.signal(x=hb.Integral("v.f", start=at + DROP))
    told = "S.state == 'at' and v.f < 0" if sensor == "place" else "S.state == 'at'"
    rules = {
        "S": [rule.format(at=at) for rule in SENSORS[sensor]],
        "A": [f"free -> hit when {told}", "hit -> free when pre(A.state == 'hit')"],
    }
    states: dict[str, dict[str, list[str]]] = {
        "S": {"far": [], "at": []},
        "A": {"free": [], "hit": ["floor"]},
    }
    for name in ("S", "A") if first else ("A", "S"):
        m.machine(name, states=states[name], start=next(iter(states[name])), rules=rules[name])
    return m


@pytest.mark.sampled(6)
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("first", [False, True], ids=["after", "before"])
@pytest.mark.parametrize("turned", [False, True], ids=["on", "turned"])
@pytest.mark.parametrize("sensor", list(SENSORS))
@pytest.mark.parametrize("restitution", [0.0, 0.5, 0.9])
@pytest.mark.parametrize("at", [0.0, 5.3, -1000.1])
def test_it_lands_and_leaves(
    at: float,
    restitution: float,
    sensor: str,
    turned: bool,
    first: bool,
    solver: Literal["auto", "radau", "rk45"],
) -> None:
    struck = math.sqrt(2.0 * DROP / PUSH)
    end = struck * (1.0 + 2.0 * restitution / (1.0 - restitution))
    run = hb.simulate(
        ball(at, restitution, sensor, turned=turned, first=first), 21.0, solver=solver
    )
    assert run.status == "ok"
    # flights that the sensor cannot tell are none
    hidden = 4.0 * math.sqrt(2e-13 * 2.0 * abs(at) / PUSH) / (1.0 - restitution)
    assert run["v.f"].at(1.05 * end + 2.0 * hidden) == pytest.approx(0.0, abs=1e-12)
    assert run["x"].at(15.0) == pytest.approx(at, abs=1e-9 + 1e-12 * abs(at))
    assert run["v.f"].at(21.0) == pytest.approx(2.0, rel=1e-9)
    assert run["x"].at(21.0) == pytest.approx(at + 1.0, abs=1e-9 + 1e-11 * abs(at))
    assert len(run.events) < 400


@pytest.mark.parametrize("sensor", list(SENSORS))
@pytest.mark.parametrize("restitution", [0.0, 0.5, 0.9])
@pytest.mark.parametrize("at", [0.0, 5.3, -31.7, 1e4])
def test_so_it_does_beside_a_relay_that_slides(at: float, restitution: float, sensor: str) -> None:
    """The sensor was taken to slide with it, and the contact to follow the relay (HB-N415)."""
    m = ball(at, restitution, sensor, turned=False, first=False)
    m.add(n=hb.Zero(), c=hb.C(1.0, q=0.2), f=hb.Sf("if K.state == 'on' then -1 else 1.5"))
    m.bond("f -> n", "n -> c")
    rules = ["off -> on when c.q > 0", "on -> off when c.q < 0"]
    m.machine("K", states={"off": [], "on": []}, start="on", rules=rules)
    struck = math.sqrt(2.0 * DROP / PUSH)
    end = struck * (1.0 + 2.0 * restitution / (1.0 - restitution))
    run = hb.simulate(m, 21.0)
    assert run.status == "ok"
    hidden = 4.0 * math.sqrt(4e-13 * 2.0 * abs(at) / PUSH) / (1.0 - restitution)
    assert run["v.f"].at(1.05 * end + 2.0 * hidden) == pytest.approx(0.0, abs=1e-12)
    assert run["x"].at(15.0) == pytest.approx(at, abs=1e-9 + 1e-12 * abs(at))
    assert run["v.f"].at(21.0) == pytest.approx(2.0, rel=1e-9)
    assert run["c.q"].at(20.0) == pytest.approx(0.0, abs=1e-9)
    assert run.audit().holds()
