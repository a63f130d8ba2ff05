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


PASSED = "hit -> free when pre(A.state == 'hit')"


def falling(law: str, start: float, drop: float = 1.0) -> hb.Model:
    """Return a ball above a floor whose impact has a law; its machine is still to come."""
    m = hb.Model("falling")
    m.add(v=hb.One(), i=hb.I(1.0), F=hb.Se(-9.81), floor=hb.Zero(), s=hb.Sf(law))
    m.bond("F -> v", "v -> i", "floor -> v", "s -> floor")
    m.signal(x=hb.Integral("v.f", start=start + drop))
    return m


def untold(at: float, restitution: float, push: float = 9.81) -> float:
    """Return how long the flights last that a guard cannot tell: 1e-13 of both its terms high."""
    speed = math.sqrt(2.0 * push * 1e-13 * 2.0 * abs(at))
    return 2.0 * speed / push / (1.0 - restitution)


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


@pytest.mark.sampled(7)
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
    late = 1e-7 * end + untold(at, restitution, PUSH)
    assert run.events[-1].t == pytest.approx(end, abs=late)
    assert run["v.f"].at(1.2 * end) == pytest.approx(0.0, abs=1e-12)
    assert run["x"].at(1.2 * end) == pytest.approx(at, abs=1e-9 + 1e-12 * abs(at))


def test_a_law_that_is_struck_with_it_lands_as_it_does_alone() -> None:
    """What rounding hides of the one was what counted for the other."""
    alone, both = hb.Model("alone"), falling("-1e-9*pre(v.f)", 5.3)
    for m in (alone, both):
        m.add(w=hb.One(), j=hb.I(1.0), G=hb.Se(-9.81), o=hb.Sf(0.0))
        m.add(c=hb.Zero(law="unilateral", gap="y", restitution=4e-4))
        m.bond("G -> w", "w -> j", "c -> w", "o -> c")
        m.signal(y=hb.Integral("w.f", start=1.0))
    rules = ["free -> hit when x <= 5.3 and v.f < 0", PASSED]
    both.machine("A", states={"free": [], "hit": ["floor"]}, start="free", rules=rules)
    heights = [hb.simulate(m, 1.0)["y"].at(0.4518) for m in (alone, both)]
    struck = math.sqrt(2.0 / 9.81)
    speed, later = 4e-4 * 9.81 * struck, 0.4518 - struck
    assert heights == pytest.approx([speed * later - 4.905 * later**2] * 2, rel=1e-6)


@pytest.mark.parametrize("drift", [3e-11, 1e-9])
def test_what_creeps_past_its_own_bound_hides_no_flight(drift: float) -> None:
    push, drop, restitution = 9.81, 0.05, 0.9
    struck = math.sqrt(2.0 * drop / push)
    end = struck * (1.0 + 2.0 * restitution / (1.0 - restitution))
    runs = []
    for more in ("", " and (w > 5.3 or w < 5.4)"):
        m = falling(f"-{restitution}*pre(v.f)", 0.0, drop)
        m.signal(w=hb.Integral(f"{drift}", start=5.3 - drift * 0.99 * end))
        rules = [f"free -> hit when x <= 0 and v.f < 0{more}", PASSED]
        m.machine("A", states={"free": [], "hit": ["floor"]}, start="free", rules=rules)
        runs.append(hb.simulate(m, 1.2 * end))
    # other guards are found at other last places
    assert len(runs[0].events) == pytest.approx(len(runs[1].events), abs=2)
    assert runs[1].events[-1].t == pytest.approx(end, rel=1e-7)


@pytest.mark.sampled(4)
@pytest.mark.parametrize("more", [1.2, 1.4, 2.0])
@pytest.mark.parametrize("guard", ["x <= {at} + {speed}*time", "x - {speed}*time <= {at}"])
@pytest.mark.parametrize("restitution", [0.5, 0.9, 0.95])
@pytest.mark.parametrize(("at", "speed"), [(0, 0.3), (1, -0.3), (5.3, 2.0), (0, 1e-3)])
def test_on_a_table_that_goes_up_or_down_it_lands_as_on_one_that_stands(
    at: float, speed: float, restitution: float, guard: str, more: float
) -> None:
    m = falling(f"{speed} - {restitution}*(pre(v.f) - ({speed}))", at)
    rules = [f"free -> hit when {guard.format(at=at, speed=speed)} and v.f < {speed}", PASSED]
    m.machine("A", states={"free": [], "hit": ["floor"]}, start="free", rules=rules)
    struck = math.sqrt(speed**2 + 2.0 * 9.81)
    end = (struck - speed + 2.0 * struck * restitution / (1.0 - restitution)) / 9.81
    run = hb.simulate(m, more * end)
    assert run.status == "ok"
    late = 1e-7 * end + untold(at + speed * end, restitution)
    assert run.events[-1].t == pytest.approx(end, abs=late)
    assert run["v.f"].at(more * end) == pytest.approx(speed, abs=1e-9)


@pytest.mark.parametrize("later", [1.0007, 1.5])
@pytest.mark.parametrize("restitution", [0.3, 0.9])
@pytest.mark.parametrize("at", [5.3, 31.7])
@pytest.mark.parametrize(
    ("solver", "beside"),
    [("auto", False), ("radau", False), ("auto", True), ("rk45", True), ("radau", True)],
)
def test_where_the_next_number_is_farther_than_a_step_goes_the_guard_is_met_all_the_same(
    beside: bool,
    at: float,
    restitution: float,
    later: float,
    solver: Literal["auto", "radau", "rk45"],
) -> None:
    """Each step ended before it, and moved what is compared by less than its last place."""
    m = falling(f"-{restitution}*pre(v.f)", at)
    if beside:  # what is large, moves as well, and is not connected
        m.add(n=hb.One(), I=hb.I(1e6, p=1e9), R=hb.R(0.1))
        m.bond("n -> I", "n -> R")
    m.machine(
        "A",
        states={"free": [], "near": [], "hit": ["floor"]},
        start="free",
        rules=[
            f"free -> near when x <= {at}",
            "near -> hit when v.f < 0",
            f"near -> free when v.f > 0 and x > {at}",
            PASSED,
        ],
    )
    struck = math.sqrt(2.0 * 9.81)
    end = struck * (1.0 + 2.0 * restitution / (1.0 - restitution)) / 9.81
    run = hb.simulate(m, later * end, solver=solver, max_steps=100_000)
    assert run.status == "ok"
    assert run["v.f"].at(later * end) == pytest.approx(0.0, abs=1e-9)
    late = 1e-7 * end + untold(at, restitution)
    assert run.events[-1].t == pytest.approx(end, abs=late)
