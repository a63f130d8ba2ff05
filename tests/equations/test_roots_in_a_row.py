"""Laws bent like a root on both sides of rest, in a row: full steps of Newton do not end there."""

import math

import numpy as np
import pytest

import hybond as hb


@pytest.mark.sampled(3)
@pytest.mark.parametrize("number", [2, 3, 5])
@pytest.mark.parametrize("soft", [1.0, 1e-3, 1e3])
def test_orifices_in_a_row_had_no_solution_near_the_last_one(number, soft):
    """Between fixed pressures each takes its part, by the square of its opening."""
    m = hb.Model("row", domain="hydraulic")
    m.add(high=hb.Se("p"), q=hb.One())
    m.bond("high -> q")
    openings = [1e-6 * (k + 1) for k in range(number)]
    for k, opening in enumerate(openings):
        law = f"{opening}*e/(e^2 + {soft}^2)^0.25"
        m.add(**{f"r{k}": hb.R({"f": law})})
        m.bond(f"q -> r{k}")
    m.domain = "generic"
    m.input(p=hb.Input(table=[(0, 1e7), (1, -2e5), (2, 0)]))
    run = hb.simulate(m, until=3)
    for t, p in ((0.5, 1e7), (1.5, -2e5)):
        drops = np.array([run[f"r{k}.e"].at(t) for k in range(number)])
        assert drops.sum() == pytest.approx(p)
        flow = run["q.f"].at(t)
        law = np.array(openings) * drops / (drops**2 + soft**2) ** 0.25
        assert law == pytest.approx(np.full(number, flow), rel=1e-9)
        if soft < 10:
            pure = math.sqrt(abs(p) / sum(o**-2 for o in openings))
            assert flow == pytest.approx(math.copysign(pure, p), rel=1e-6)
    assert run["q.f"].at(2.5) == pytest.approx(0.0, abs=1e-15)
