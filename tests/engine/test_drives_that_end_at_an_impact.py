"""What drives a body onto a contact ends at the instant of the impact: it rebounds by what is left.

Newton's law is of the approach before the instant. A part of that which is gone with its drive is
in no momentum: ``eps`` times it would come from nowhere. A body of mass 1 kg that goes on at 1 m/s
leaves at ``eps`` m/s, with ``eps^2/2`` J, however fast it was driven in addition.
"""

from __future__ import annotations

import pytest

import hybond as hb


@pytest.mark.parametrize("eps", [0.5, 1.0])
@pytest.mark.parametrize("charge", [4.0, -0.3])
@pytest.mark.parametrize("turned", [False, True])
def test_a_drive_that_a_switch_cuts_at_the_impact_is_not_thrown_back(
    turned: bool, charge: float, eps: float
) -> None:
    """A charged capacitor drives the contact through a gyrator until the switch opens."""
    m = hb.Model("cut")
    m.add(contact=hb.Zero(law="unilateral", restitution=eps), body=hb.I(1.0, p=-1.0))
    m.add(c=hb.C(1.0, q=charge), n=hb.Zero(), gy=hb.GY(0.5))
    m.bond("n -> gy.1", "gy.2 -> contact", "n -> c")
    m.bond("body -> contact" if turned else "contact -> body")
    m.machine("cut", states={"on": ["n"], "off": []}, start="on", rules=["on -> off when time < 1"])
    run = hb.simulate(m, 0.1)
    before = 1.0 + 2.0 * charge  # as pre() reads it
    speed = eps * min(max(before, 0.0), 1.0)
    assert run.final["body.p"] == pytest.approx(speed, rel=1e-12)
    assert not run.warnings


@pytest.mark.parametrize("eps", [0.5, 1.0])
@pytest.mark.parametrize("table", [8.0, 0.5])
def test_a_body_that_meets_a_table_as_it_stops_rebounds_by_its_own_speed(
    table: float, eps: float
) -> None:
    """The table comes at 8 m/s, and stands still from the instant on at which the two meet."""
    m = hb.Model("table", domain="translational")
    m.add(table=hb.Sf(f"if time < 0.1 [s] then {table} [m/s] else 0 [m/s]"), s=hb.One())
    m.add(contact=hb.Zero(law="unilateral", restitution=eps, gap="g"), v=hb.One())
    m.add(body=hb.I("1 kg", p="-1 N*s"))
    m.bond("table -> s", "s -> contact -> v", "v -> body")
    m.signal(g=hb.Integral("v.f - s.f", start=f"{0.1 * (1.0 + table)} m"))
    run = hb.simulate(m, 0.15)
    assert run.final["body.p"] == pytest.approx(eps, rel=1e-9)
    assert not any("creates" in note for note in run.warnings)
