"""Sixty independent switches: 2^60 modes, of which only those visited are built."""

import math
import time

import pytest

import hybond as hb

CELLS = 60
UNTIL = 1.0


def closing(k: int) -> float:
    """When switch k closes: no two at one instant."""
    return (k + 1) * UNTIL / (CELLS + 2)


def cells(guard) -> hb.Model:
    """RC cells; switch k connects its resistor."""
    model = hb.Model("cells", domain="electrical")
    for k in range(CELLS):
        model.add(
            **{
                f"n{k}": hb.Zero(),
                f"C{k}": hb.C("1 mF", e="10 V"),
                f"s{k}": hb.One(),
                f"R{k}": hb.R(f"{100 + k} ohm"),
            }
        )
        model.bond(f"n{k} -> C{k}", f"n{k} -> s{k} -> R{k}")
        model.machine(
            f"M{k}",
            states={"open": [], "closed": [f"s{k}"]},
            start="open",
            rules=[f"open -> closed when {guard(k)}"],
        )
    return model


def check(run: hb.Result, times) -> None:
    assert run.status == "ok"
    assert len(run.events) == CELLS + 1
    assert [e.t for e in run.events[1:]] == pytest.approx(times, rel=1e-6)
    visited = {s.mode for e in run.events for s in e.steps}
    assert len(visited) == CELLS + 1
    assert run.stats["modes"] == len(visited)
    assert run.mode == {f"M{k}": "closed" for k in range(CELLS)}
    for k in (0, 17, CELLS - 1):
        want = 10.0 * math.exp(-(UNTIL - times[k]) / (1e-3 * (100 + k)))
        assert run[f"C{k}.e"].at(UNTIL) == pytest.approx(want, rel=1e-5)


def test_by_time():
    begin = time.perf_counter()
    run = hb.simulate(cells(lambda k: f"time >= {closing(k)!r} s"), until=UNTIL)
    assert time.perf_counter() - begin < 60.0  # a few seconds; growth with 2^60 would not end
    check(run, [closing(k) for k in range(CELLS)])
    assert run.audit().holds()


def test_each_closed_by_the_one_before():
    """A guard on the state: cell k closes when its neighbour has fallen to 9 V."""
    run = hb.simulate(cells(lambda k: f"C{k - 1}.e < 9 V" if k else "time >= 0.01 s"), until=UNTIL)
    times = [0.01]
    for k in range(CELLS - 1):
        times.append(times[-1] + 1e-3 * (100 + k) * math.log(10 / 9))
    assert times[-1] < UNTIL
    check(run, times)
