"""The unit of a signal that reads itself."""

import pytest

import hybond as hb


def test_a_filter_has_the_unit_that_its_rate_says() -> None:
    m = hb.Model("filter", domain="electrical")
    m.add(a=hb.C("1 F", e="2 V"), r=hb.R("1 ohm"), n=hb.Zero())
    m.bond("n -> a", "n -> r")
    m.signal(x=hb.Integral("(a.e - x)/(1 [s])", start="0 V"))
    run = hb.simulate(m, until=1.0)
    # x' = 2 exp(-t) - x from 0
    assert run["x"].at(1.0) == pytest.approx(2.0 * 0.36787944117144233, rel=1e-7)
    assert run["x"].unit in ("V", "")
