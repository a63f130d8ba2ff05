"""What comes near the edge of what a law gives at its jump is not on it.

A mass that a friction brakes is held by a cap as soon as it is as slow as the cap: then both are
asked for what they have between their limits, where `sign()` has no value. A step that ended within
1e-10 of that was taken for one that ends on the edge, where the mass stays, and values shown were
those beside it: 0.01 J were gone.
"""

from __future__ import annotations

import pytest

import hybond as hb


def braked(beside: bool) -> hb.Model:
    m = hb.Model("braked")
    m.add(j=hb.One(), node=hb.Zero(), mass=hb.I(0.122, p=-0.10021854293377502), still=hb.Sf("0"))
    m.add(cap=hb.R({"f": "0.403*sign(e)"}), rub=hb.R({"e": "0.121*sign(f)"}))
    m.bond("mass -> node", "node -> j", "cap -> node", "rub -> node", "j -> still")
    if beside:
        table = [[-0.498, -0.249, 0.0, 0.249, 0.747], [-1.44, -1.44, 0.0, 1.44, 1.44]]
        m.add(w=hb.Zero(law="relay", limit=2.13), drive=hb.Se("-0.44"))
        m.add(shakes=hb.Sf("-0.125*sin(10.2*time)"))
        m.add(bends=hb.R({"f": {"table": table, "extrapolate": "linear"}}))
        m.bond("bends -> w", "w -> drive", "w -> shakes", "j -> w")
    return m


@pytest.mark.parametrize("beside", [False, True])
@pytest.mark.parametrize("until", [0.59, 1.0])
def test_friction_that_is_to_hold_between_its_limits_is_refused(beside: bool, until: float) -> None:
    with pytest.raises(hb.NumericsError) as refused:
        hb.simulate(braked(beside), until)
    assert refused.value.code == "HB-N301"
    assert "law = 'coulomb'" in str(refused.value)
    assert refused.value.partial.t_end == pytest.approx(
        (0.10021854293377502 - 0.122 * 0.403) / 0.121, rel=1e-8
    )


def test_before_that_it_is_braked() -> None:
    run = hb.simulate(braked(True), 0.4)
    assert run["mass.p"].at(0.4) == pytest.approx(-0.10021854293377502 + 0.121 * 0.4, rel=1e-12)
    assert run.audit().holds()
