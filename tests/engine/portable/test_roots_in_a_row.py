"""Laws bent like a root on both sides of rest, in a row, in the exported runtime."""

import math

import numpy as np
import pytest
from portable_runs import portable

import hybond as hb


@pytest.mark.parametrize("number", [2, 3, 5])
@pytest.mark.parametrize("soft", [1.0, 1e-3])
def test_orifices_in_a_row_stopped_an_exported_run(number, soft, monkeypatch) -> None:
    """Between fixed pressures the volume that has passed is the flow of each time the time."""
    m = hb.Model("row", domain="hydraulic")
    m.add(high=hb.Se("p"), q=hb.One())
    m.bond("high -> q")
    openings = [1e-6 * (k + 1) for k in range(number)]
    for k, opening in enumerate(openings):
        m.add(**{f"r{k}": hb.R({"f": f"{opening}*e/(e^2 + {soft}^2)^0.25"})})
        m.bond(f"q -> r{k}")
    m.domain = "generic"
    m.input(p=hb.Input(table=[(0, 1e7), (1, -2e5), (2, 0)]))
    m.signal(volume=hb.Integral("q.f"))
    found = portable(m, monkeypatch, until=3.0)
    hindrance = sum(o**-2 for o in openings)
    passed = math.sqrt(1e7 / hindrance) - math.sqrt(2e5 / hindrance)
    assert not found.code and found.t == 3.0
    assert found.y == pytest.approx(np.array([passed]), rel=1e-6)
