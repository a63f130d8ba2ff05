"""Reading a run by the library: at rest, at its start, by many at once, of a copy."""

from __future__ import annotations

import copy
import threading

import numpy as np
import pytest
from engine.by_engine import ENGINE

import hybond as hb


def ball() -> hb.Model:
    """Return a ball that loses half its speed at each impact, and comes to rest."""
    m = hb.Model("ball", domain="translational")
    m.add(
        weight=hb.Se("-9.81 N"),
        ball=hb.I("1 kg"),
        v=hb.One(),
        floor=hb.Zero(),
        rebound=hb.Sf("-0.5*pre(v.f)"),
    )
    m.bond("weight -> v -> ball", "rebound -> floor -> v")
    m.signal(height=hb.Integral("v.f", start="1 m"))
    m.machine(
        "M",
        states={"away": [], "impact": ["floor"]},
        start="away",
        rules=[
            "away -> impact when height <= 0 and v.f < 0",
            "impact -> away when pre(ball.p) >= 0",
        ],
    )
    return m


def test_between_the_last_impact_and_its_limit_a_run_has_values() -> None:
    run = hb.simulate(ball(), until=3, engine=ENGINE)
    (rest,) = run.accumulations
    landing = run.events[-1]
    last = run.events[-2].t
    assert last < landing.t == rest.t
    assert run["ball.p"].at(landing.t, side="left") == landing.before[0]
    assert run["ball.p"].at(landing.t) == 0.0
    assert run["floor.e"].at(landing.t) == pytest.approx(9.81)
    between = np.linspace(last, landing.t, 5)[1:-1]
    found = run.sample([*between, 2.0, 0.1], ["ball.p", "height", "floor.e", "time"])
    assert found["time"].tolist() == [*between, 2.0, 0.1]
    assert found["ball.p"].tolist()[:3] == [landing.before[0]] * 3
    assert found["floor.e"].tolist() == pytest.approx([0.0] * 3 + [9.81, 0.0])
    assert found["height"][-1] == pytest.approx(1.0 - 0.5 * 9.81 * 0.01)
    assert run.weight("M", "away", landing.t, side="left") == 1.0
    assert run.weight("M", "impact", landing.t) == 1.0


def test_the_start_knows_what_the_model_gave() -> None:
    m = hb.Model("joined", domain="electrical")
    m.add(a=hb.C("1 F", e="10 V"), b=hb.C("2 F", e="4 V"), r=hb.R("1 ohm"), node=hb.Zero())
    m.bond("node -> a", "node -> b", "node -> r")
    start = hb.simulate(m, until=1).events[0]
    assert start.before.tolist() == [10.0, 8.0]
    assert start.after == pytest.approx([6.0, 12.0])


@pytest.mark.parametrize("name", ["max_events", "max_steps"])
@pytest.mark.parametrize("many", [2**31, 2**32 + 1, 10**12])
def test_a_limit_may_be_as_large_as_one_likes(name: str, many: int) -> None:
    limits = {name: many}
    assert hb.simulate(ball(), until=1, engine=ENGINE, **limits).status == "ok"  # type: ignore[arg-type]


def test_many_threads_read_one_run() -> None:
    run = hb.simulate(ball(), until=1.7, engine=ENGINE)
    times = np.linspace(0.0, run.t_end, 40)
    names = ["floor.e", "height", "ball.f"]
    wanted = {name: run.sample(times.tolist(), [name])[name] for name in names}
    wrong: list[object] = []

    def read(name: str) -> None:
        try:
            for _ in range(10):
                found = run.sample(times.tolist(), [name])[name]
                if not np.array_equal(found, wanted[name]):
                    wrong.append(name)
        except Exception as error:  # of another thread
            wrong.append(error)

    threads = [threading.Thread(target=read, args=(name,)) for name in names]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


def test_a_run_can_be_copied() -> None:
    run = hb.simulate(ball(), until=1, engine=ENGINE)
    other = copy.deepcopy(run)
    times = [0.0, 0.3, 0.7, 1.0]
    names = ["height", "floor.e"]
    assert np.array_equal(
        [*run.sample(times, names).values()], [*other.sample(times, names).values()]
    )
    assert other.audit() == run.audit()


@pytest.mark.parametrize("engine", ["library", "python"])
@pytest.mark.parametrize("side", ["left", "right"])
def test_points_of_many_segments_come_in_the_order_asked_for(engine: str, side: str) -> None:
    """A triangle between 0 and 1, a segment a second, read out of order, twice and at its tips."""
    if engine == "library" and ENGINE != "library":
        pytest.skip("no library")
    m = hb.Model("triangle")
    m.add(c=hb.C(1.0), s=hb.Sf('if k.state == "up" then 1 else -1'), n=hb.Zero())
    m.bond("s -> n -> c")
    rules = ["up -> down when c.q >= 1", "down -> up when c.q <= 0"]
    m.machine("k", states={"up": [], "down": []}, start="up", rules=rules)
    run = hb.simulate(m, until=9.5, engine=engine)  # type: ignore[arg-type]
    top = run.events[3].t
    assert top == pytest.approx(3.0, abs=1e-9)
    t = np.array([7.3, 0.25, 9.5, top, 0.25, 8.9, top, 1.4, 0.0, 5.5])
    found = run.sample(t.tolist(), ["c.q", "s.f", "2*c.q + s.f"], side=side)
    level = 1.0 - np.abs(1.0 - t % 2.0)
    assert found["c.q"] == pytest.approx(level, abs=1e-9)
    inside = (np.abs(t - np.round(t)) > 1e-6) & (t < 9.5)
    way = np.where(t % 2.0 < 1.0, 1.0, -1.0)
    assert found["s.f"][inside] == pytest.approx(way[inside])
    assert found["s.f"][[3, 6]].tolist() == [1.0 if side == "left" else -1.0] * 2
    assert found["2*c.q + s.f"] == pytest.approx(2.0 * found["c.q"] + found["s.f"], abs=1e-12)
