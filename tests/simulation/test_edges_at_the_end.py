"""What a clock made of time does at the end of a run belongs to it, whatever time rounds to.

``mod(1 ms, 10 us)`` is 10 us less a last place, and the sawtooth begins anew an ulp later than the
run ends: one instant. Oracles are counts of edges and half C U^2 for each of them.
"""

from typing import Literal

import pytest

import hybond as hb

C, U, T = 1e-9, 100.0, 1e-5


def leg(rules: list[str]) -> hb.Model:
    """A capacitor that is joined to a source and to nothing in turn, with nothing between."""
    m = hb.Model("leg", domain="electrical", parameters={"T": "10 us"})
    m.add(V=hb.Se("100 V"), up=hb.One(), down=hb.Zero(), C=hb.C("1 nF"))
    m.bond("V -> up -> down -> C")
    m.machine("S", states={"low": [], "high": ["up", "down"]}, start="low", rules=rules)
    return m


CLOCKS = {
    "sawtooth": ["low -> high when mod(time, T) < T/2", "high -> low when mod(time, T) > T/2"],
    "count": [
        "low -> high when mod(floor(2*time/T), 2) < 0.5",
        "high -> low when mod(floor(2*time/T), 2) > 0.5",
    ],
    "phase": [
        "low -> high when mod(time - 3*T, T)/T < 0.5",
        "high -> low when mod(time - 3*T, T)/T > 0.5",
    ],
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("clock", list(CLOCKS))
@pytest.mark.parametrize("periods", [2, 3, 7, 35, 100, 700])
def test_the_edge_at_the_end_is_there(clock: str, periods: int) -> None:
    run = hb.simulate(leg(CLOCKS[clock]), periods * T)
    assert run.t_end == periods * T
    edges = [e for e in run.events if len(e.steps[-1].fired)]
    assert len(edges) == 2 * periods + 1
    assert edges[-1].t == pytest.approx(periods * T, rel=1e-12)
    assert run["C.e"].at(run.t_end) == pytest.approx(U)
    lost = sum(row.lost or 0.0 for row in run.losses(period=T).rows)
    assert lost == pytest.approx(C * U**2, rel=1e-9)


@pytest.mark.parametrize("clock", list(CLOCKS))
def test_a_run_that_goes_on_does_not_switch_again(clock: str) -> None:
    model = leg(CLOCKS[clock])
    first = hb.simulate(model, 100 * T)
    second = hb.simulate(model, 200 * T, start=first)
    edges = [e for e in second.events if len(e.steps[-1].fired) and e.t > 100.5 * T]
    assert len(edges) == 200
    assert not [e for e in second.events if 100 * T < e.t < 100.4 * T]
    lost = sum(row.lost or 0.0 for row in second.losses().rows)
    assert lost == pytest.approx(100 * C * U**2, rel=1e-9)


@pytest.mark.parametrize("periods", [3, 35, 100])
@pytest.mark.parametrize("clock", list(CLOCKS))
def test_the_edge_at_the_end_is_there_beside_another_event(clock: str, periods: int) -> None:
    # 1 A into a farad for each second: its voltage reaches 1 V where the run ends
    end = periods * T
    m = leg(CLOCKS[clock])
    m.add(feed=hb.Sf("1 A"), n=hb.Zero(), D=hb.C(end))
    m.bond("feed -> n -> D")
    m.machine(
        "level",
        states={"below": [], "above": []},
        start="below",
        rules=["below -> above when D.e >= 1"],
    )
    run = hb.simulate(m, end)
    assert run.mode == {"S": "high", "level": "above"}
    edges = [e for e in run.events if any(f.machine == "S" for f in e.steps[-1].fired)]
    assert len(edges) == 2 * periods + 1
    again = hb.simulate(m, 2 * end, start=run)
    assert len([e for e in again.events if e.steps[-1].fired]) == 2 * periods


def test_two_clocks_at_the_end() -> None:
    m = leg(CLOCKS["sawtooth"])
    rules = ["low -> high when mod(time, 2*T) < T", "high -> low when mod(time, 2*T) > T"]
    m.machine("slow", states={"low": [], "high": []}, start="low", rules=rules)
    run = hb.simulate(m, 100 * T)
    assert run.mode == {"S": "high", "slow": "high"}
    assert run.t_end == 100 * T


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("beyond", [1e-13, 1e-12, 1e-11])
def test_what_moves_within_a_last_instant_is_no_energy(
    beyond: float, solver: Literal["auto", "radau", "rk45"]
) -> None:
    m = hb.Model("late")
    m.add(s=hb.Se("5*floor(time/1.2)"), j=hb.One(), i=hb.I(2.0), r=hb.R(3.0))
    m.bond("s -> j", "j -> i", "j -> r")
    run = hb.simulate(m, 1.2 + beyond, solver=solver)
    assert run.status == "ok"
    # where it begins is known to an instant, 1e-12 of the run
    assert run["i.f"].at(run.t_end) == pytest.approx(2.5 * beyond, abs=2.5 * 1.2e-12)
