"""What follows a source through a law like a root lags behind it: it is put at no rest.

A tank behind an orifice is at rest where its level is that outside. While that rises the flow is
what fills the tank, and the levels are apart by what the orifice asks for it: closed forms.
"""

from __future__ import annotations

import pytest

import hybond as hb

SQUARE = "0.01*f*abs(f)"
ROOT = "10*sign(e)*sqrt(abs(e))"


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("law", [{"e": SQUARE}, {"f": ROOT}])
def test_a_tank_follows_the_level_outside_in_few_steps(law: dict[str, str], turned: bool) -> None:
    """``C s' = f`` for ever, once what it began with has died out."""
    rise, fills, way = 1e-3, 2.0, -1.0 if turned else 1.0
    m = hb.Model("tank")
    m.add(s=hb.Se(f"1 + {rise}*time"), j=hb.One(), r=hb.R(law), c=hb.C(fills, q=way))
    m.bond("s -> j", "j -> r", "c -> j" if turned else "j -> c")
    run = hb.simulate(m, 20.0, max_steps=2000)
    lag = 0.01 * (fills * rise) ** 2
    level = 1.0 + 20.0 * rise - lag
    assert run["c.q"].at(20.0) == pytest.approx(way * fills * level, rel=1e-8)


def test_the_same_with_efforts_and_flows_exchanged() -> None:
    m = hb.Model("mass")
    m.add(
        s=hb.Sf("1 + 0.0001*time"), n=hb.Zero(), r=hb.R({"f": "0.01*e*abs(e)"}), i=hb.I(1.0, p=0.5)
    )
    m.bond("s -> n -> i", "n -> r")
    run = hb.simulate(m, 20.0, max_steps=2000)
    assert run["i.p"].at(20.0) == pytest.approx(1.002 - 1e-10, rel=1e-8)


def test_a_tank_comes_to_rest_where_nothing_moves_on() -> None:
    """``sqrt(h)`` falls evenly: from 0.25 below, ``k sqrt(h) = f`` with ``k = 10``."""
    m = hb.Model("tank")
    m.add(s=hb.Se(1.0), j=hb.One(), r=hb.R({"e": SQUARE}), c=hb.C(1.0, q=0.75))
    m.bond("s -> j -> c", "j -> r")
    run = hb.simulate(m, 20.0, max_steps=2000)
    # h' = -10 sqrt(h)
    assert run["c.q"].at(0.05) == pytest.approx(1.0 - (0.5 - 5.0 * 0.05) ** 2, rel=1e-7)
    assert run["c.q"].at(20.0) == pytest.approx(1.0, abs=1e-8)
