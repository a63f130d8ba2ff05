"""A lobe that a law cuts off outside: nothing else moves there, and steps would grow over it.

What is compared is flat where a long step begins, in its middle and where it ends.
"""

import math

import pytest

import hybond as hb

LOBE = "1 A*max(0, 1/(1 + ((A.q/(1 C) - {at})/{width})^2) - 0.5)"


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("at", [2.5, 4.5585, 8.2])
@pytest.mark.parametrize("width", [0.3, 0.1])
def test_a_lobe_of_what_rises_evenly_is_stored(width: float, at: float, solver: str) -> None:
    """Between its half values it brings ``width (pi/2 - 1)``."""
    m = hb.Model("lobe", domain="electrical")
    m.add(SA=hb.Sf("1 A"), nA=hb.Zero(), A=hb.C("1 F"), nB=hb.Zero(), B=hb.C("1 F"))
    m.add(SB=hb.Sf(LOBE.format(at=at, width=width)))
    m.bond("SA -> nA -> A", "SB -> nB -> B")
    run = hb.simulate(m, until=10.0, solver=solver)
    assert run.final["B.q"] == pytest.approx(width * (math.pi / 2.0 - 1.0), rel=1e-5)
