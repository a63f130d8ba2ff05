"""Dead zones written with `abs`: where they are flat, what is left of them is rounding.

``(2*e - abs(e + d) + abs(e - d))/2`` is zero between -d and d, but for the last digits of d; beside
a flow that is next to nothing no step of Newton makes that less, and laws had no solution.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

D, A = 0.1, 0.3
LAWS = {
    "abs": f"0.5*(2*e - abs(e + {D}) + abs(e - {D}))",
    "abs, in series of sums": f"e - 0.5*abs(e + {D}) + 0.5*abs(e - {D})",
    "max": f"max(e - {D}, 0) + min(e + {D}, 0)",
}


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("arrow", ["i -> zone", "zone -> i"])
@pytest.mark.parametrize("law", LAWS)
def test_capacitor_behind_a_dead_zone_and_a_resistor(law: str, arrow: str, solver: str) -> None:
    m = hb.Model("dead zone")
    m.add(S=hb.Sf(f"{A}*time"), n=hb.Zero(), C=hb.C(1), i=hb.One())
    m.add(zone=hb.R({"f": LAWS[law]}), load=hb.R(1))
    m.bond("S -> n -> C", "n -> i -> load", arrow)
    run = hb.simulate(m, until=2, solver=solver)
    opens = math.sqrt(2 * D / A)  # up to there all charge stays; then v' = A*t - (v - D)/2
    for t in (0.0, 0.4, 0.8):
        assert run["n.e"].at(t) == pytest.approx(A * t * t / 2, rel=1e-7, abs=1e-12)
        assert abs(run["i.f"].at(t)) < 1e-12
    # v - D = 2*A*(t - 2) + c*exp(-t/2)
    c = -2 * A * (opens - 2) * math.exp(opens / 2)
    for t in (0.9, 1.5, 2.0):
        assert run["n.e"].at(t) == pytest.approx(
            D + 2 * A * (t - 2) + c * math.exp(-t / 2), rel=1e-6
        )
