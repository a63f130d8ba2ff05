"""A law that bends beside friction or a relay whose limit is just reached, and left again."""

from __future__ import annotations

import math

import pytest

import hybond as hb


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("law", ["relay", "coulomb"])
@pytest.mark.parametrize("sign", [1, -1])
def test_what_is_at_its_limit_only_as_it_begins_stays_there(
    sign: int, law: str, solver: str
) -> None:
    # 3.62 is the limit and what drives at first; the sine takes some of it off until its zero
    m = hb.Model("limit")
    m.add(j=hb.One(law=law, limit=3.62), a=hb.Se(sign * 3.62))
    m.add(s=hb.Se("-1.93*sin(10.7*time)"), g=hb.R(0.7))
    m.add(r=hb.R({"e": "2.32*(f/8.55)*abs(f/8.55)"}))
    m.bond("a -> j", "s -> j" if sign > 0 else "j -> s", "j -> g", "r -> j")
    run = hb.simulate(m, until=0.39, solver=solver)
    assert run.status == "ok"
    assert len(run.events) == 2
    assert run.events[1].t == pytest.approx(math.pi / 10.7, rel=1e-9)
    drive = -1.93 * math.sin(10.7 * 0.35)
    slope, bend = 0.7, 2.32 / 8.55**2
    flow = (-slope + math.sqrt(slope**2 + 4 * bend * drive)) / (2 * bend)
    assert run["j.f"].at(0.35) == pytest.approx(sign * flow, rel=1e-9)
    assert run["j.f"].at(0.1) == pytest.approx(0.0, abs=1e-12)
