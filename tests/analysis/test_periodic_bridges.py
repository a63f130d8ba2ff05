"""Bridges whose diodes take over where no current may flow: such instants do nothing."""

from __future__ import annotations

import pytest

import hybond as hb

C = 1e-3


def half_controlled(start: float, firing: float, turned: bool) -> hb.Model:
    """Return a bridge of two switched diodes above and two plain ones below, with R and C."""
    m = hb.Model("bridge", domain="electrical")
    m.add(V=hb.Se("100*sin(100*pi*time)"), i=hb.One(), a=hb.Zero(), b=hb.Zero())
    m.add(p=hb.Zero(), r=hb.One(), R=hb.R(5.0), c=hb.C(C, e=start), load=hb.R(20.0), o=hb.Zero())
    m.bond("V -> i -> a", "b -> i", "p -> r -> o", "r -> R", "o -> load")
    m.bond("c -> o" if turned else "o -> c")
    for k, (node, shift) in enumerate((("a", 0.0), ("b", 10e-3)), 1):
        on = f"mod(time + {20e-3 - shift}, 0.02) >= {firing}"
        off = f"mod(time + {20e-3 - shift}, 0.02) >= 8e-3"
        m.add(**{f"s{k}": hb.One(), f"d{k}": hb.One(law="diode"), f"x{k}": hb.Zero()})
        m.add(**{f"e{k}": hb.One(law="diode"), f"q{k}": hb.R(1e-2), f"u{k}": hb.R(1e-2)})
        m.bond(f"{node} -> s{k} -> x{k} -> d{k} -> p", f"s{k} -> q{k}", f"e{k} -> {node}")
        m.bond(f"e{k} -> u{k}")
        closed = f"{on} and not ({off})"
        rules = [f"open -> closed when {closed}", f"closed -> open when not ({closed})"]
        states = {"open": [], "closed": [f"s{k}"]}
        m.machine(f"g{k}", states=states, start="open", rules=rules)
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("firing", "turned"), [(2e-3, False), (4e-3, True)])
def test_diodes_that_take_over_without_a_current_leave_an_orbit_its_multiplier(
    firing: float, turned: bool
) -> None:
    orbit = hb.periodic(half_controlled(50.0, firing, turned), period="20 ms")
    run = hb.simulate(half_controlled(50.0, firing, turned), "200 ms")
    here, h = float(run["c.e"].at(0.2)), 1e-3
    ends = []
    for start in (here - h, here + h):
        after = hb.simulate(half_controlled(start, firing, turned), "20 ms", rtol=1e-12)
        ends.append(float(after["c.e"].at(0.02)))
    assert here == pytest.approx(0.5 * sum(ends), rel=1e-6)
    assert float(orbit.values[0].real) == pytest.approx((ends[1] - ends[0]) / (2 * h), rel=1e-5)
