"""Slow motions beside fast ones keep their digits where a linear mode is propagated.

Two capacitors joined by a nanoohm empty together by a megohm. Each rate is a difference of terms
1e15 times as large as the leak: of that, which is their sum, nothing was left.
"""

from __future__ import annotations

import math

import pytest
from engine.slow_models import LINEAR, NETWORKS, held, moved, pair, pair_rates, switched
from portable_runs import assert_the_same, portable

import hybond as hb


@pytest.mark.parametrize("name", LINEAR)
def test_slow_motions_have_their_digits(name: str) -> None:
    m, until, ends = LINEAR[name]()
    run = hb.simulate(m, until)
    assert run.method.startswith("1 mode propagated exactly")
    # of three scales the middle one is told from the slowest only where `rtol` asks for it
    held(run, until, ends, 2e-11 if name == "bodies" else 1e-14)


@pytest.mark.parametrize("name", NETWORKS)
def test_a_network(name: str) -> None:
    """Several of its rows are fast, and of what is left of them another one is fast as well."""
    m, until, ends = NETWORKS[name]()
    run = hb.simulate(m, until, max_steps=2000)
    assert run.method.startswith("1 mode propagated exactly")
    held(run, until, ends, 2e-9)


@pytest.mark.parametrize("r", [1e-9, 1e-7, 1e-5, 1e-3])
def test_between_steps_and_at_all_resistances(r: float) -> None:
    run = hb.simulate(pair(r=r), 3.0)
    for t in (1e-3, 0.31, 1.77, 2.999):
        a, b = moved(pair_rates(r=r), [5e-6, 0.0], t)
        assert run["a.q"].at(t) == pytest.approx(float(a), rel=1e-8)
        assert run["b.q"].at(t) == pytest.approx(float(b), rel=1e-8)


def test_joined_by_a_switch() -> None:
    m, until, ends = switched()
    held(hb.simulate(m, until), until, ends, 1e-14)


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("r", [1e-12, 1e-9, 1e-8])
@pytest.mark.parametrize("beside", ["", "switch", "diode"])
def test_what_begins_level_raises_no_alarm(r: float, back: bool, beside: str) -> None:
    """Nothing flows between the two but the leak's half; what each term is rounded by is more."""
    m = hb.Model("level")
    m.add(a=hb.C(1.0, e=3.0), b=hb.C(1.0, e=3.0), na=hb.Zero(), nb=hb.Zero(), s=hb.One())
    m.add(r=hb.R(r), l=hb.R(1e6))
    m.bond("s -> r", *(["nb -> s -> na", "a -> na", "nb -> l", "b -> nb"] if back else
                       ["na -> s -> nb", "na -> a", "nb -> l", "nb -> b"]))  # fmt: skip
    if beside == "diode":
        m.add(
            v=hb.Se("sin(time/1e5)"), d=hb.One(law="diode"), o=hb.Zero(), x=hb.R(1.0), y=hb.C(1.0)
        )
        m.bond("v -> d -> o -> y", "d -> x")
    if beside == "switch":
        m.machine("S", start="closed", states={"open": [], "closed": ["s"]}, rules=[])
    run = hb.simulate(m, 1e6)
    assert run.status == "ok"
    for name in ("a.e", "b.e"):
        assert run[name].at(1e6) == pytest.approx(3.0 * math.exp(-0.5), rel=1e-14)


def test_without_a_leak_their_sum_stays() -> None:
    run = hb.simulate(pair(leak=hb.Sf(0.0)), 1e6)
    a, b = run["a.q"].at(1e6), run["b.q"].at(1e6)
    assert a + b == pytest.approx(5e-6, rel=1e-15)
    assert b == pytest.approx(2.0 * a, rel=1e-14)


def test_the_engine_as_python_does_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    assert_the_same(pair(), monkeypatch, rel=1e-15, until=3.0)


def test_others_are_propagated_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    """A fast storage by itself, and storages that exchange no faster than is seen."""
    m = hb.Model("others")
    m.add(V=hb.Se(1.0), s=hb.One(), r=hb.R(1e-9), n=hb.Zero(), c=hb.C(1e-6), t=hb.One())
    m.add(g=hb.R(1e3), k=hb.Zero(), d=hb.C(1e-3))
    m.bond("V -> s -> n", "s -> r", "n -> c", "n -> t -> k", "t -> g", "k -> d")
    for model in (m, pair(r=10.0)):
        flow = portable(model, monkeypatch, until=3.0).engine.exact.flow
        assert flow.own is flow.rows
    flow = portable(pair(), monkeypatch, until=3.0).engine.exact.flow
    assert flow.own is not flow.rows
    assert flow.shares == 1
