"""Contacts that could rebound, but at which nothing arrives: their law is that of any contact."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import hybond as hb


def held(options: dict[str, Any], way: float = 1.0) -> tuple[hb.Model, str]:
    """Return a spring held by a stuck clutch that shares its stop's freedom."""
    m = hb.Model("held")
    m.add(rub=hb.Zero(law="coulomb", limit=1.46, breakaway=2.19), v=hb.One(), g=hb.G(1.156))
    m.add(stop=hb.Zero(law="unilateral", **options), gy=hb.GY(0.767 * way))
    m.add(c=hb.C({"e": "1.01*sinh(q/1.39)"}, q=-0.478 * way))
    m.bond("stop -> rub", "gy.1 -> rub", "g -> v", "c -> v", "v -> gy.2")
    return m, "c.q"


def turned_round(options: dict[str, Any]) -> tuple[hb.Model, str]:
    return held(options, -1.0)


def dual(options: dict[str, Any]) -> tuple[hb.Model, str]:
    """Return `held` with efforts and flows exchanged."""
    m = hb.Model("dual")
    m.add(rub=hb.One(law="coulomb", limit=1.46, breakaway=2.19), v=hb.Zero(), g=hb.R(1.156))
    m.add(stop=hb.One(law="unilateral", **options), gy=hb.GY(1 / 0.767))
    m.add(c=hb.I({"f": "1.01*sinh(p/1.39)"}, p=-0.478))
    m.bond("stop -> rub", "gy.1 -> rub", "g -> v", "c -> v", "v -> gy.2")
    return m, "c.p"


def driven(options: dict[str, Any]) -> tuple[hb.Model, str]:
    """Return a spring charged through a clutch and a stop, beside a gyrator and a diode."""
    m = hb.Model("driven")
    m.add(stop=hb.Zero(law="unilateral", **options), d=hb.Zero(law="diode"), n=hb.Zero())
    m.add(rub=hb.Zero(law="coulomb", limit=28.5, breakaway=42.75), a=hb.One(), b=hb.One())
    m.add(gy=hb.GY(-62.7), c=hb.C(0.521, q=0.0138), r=hb.R(2.71))
    m.add(s=hb.Sf("-639*sin(6.16*time)"))
    m.bond("a -> d", "n -> d", "b -> d", "gy.2 -> d", "gy.1 -> stop", "c -> stop", "b -> r")
    m.bond("rub -> s", "rub -> stop")
    return m, "c.q"


@pytest.mark.parametrize("make", [held, turned_round, dual, driven])
@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_a_contact_closes_where_its_effort_is_stored(
    make: Callable[[dict[str, Any]], tuple[hb.Model, str]], restitution: float
) -> None:
    # no impact, so that its restitution says nothing
    plain, name = make({})
    model, _ = make({"restitution": restitution})
    run, other = hb.simulate(model, until=0.3), hb.simulate(plain, until=0.3)
    times = [0.0, 0.004, 0.05, 0.11, 0.2, 0.3]
    values = [other[name].at(t) for t in times]
    assert [run[name].at(t) for t in times] == pytest.approx(values, rel=1e-9)
    assert run.audit().holds()
