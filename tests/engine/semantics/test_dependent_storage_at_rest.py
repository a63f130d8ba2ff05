"""Many dependent capacitors, far from the source: what they hold is smaller than normal numbers."""

import numpy as np
import pytest
from scipy.linalg import expm

import hybond as hb

CELLS, UNTIL = 60, 1e-3


def line():
    """Cells of two capacitors in parallel, 3 F in all, with 1 ohm between them and at both ends."""
    m = hb.Model("line", domain="electrical")
    m.add(V=hb.Se("1 V"), i=hb.One(), r=hb.R("1 ohm"))
    m.bond("V -> i -> r")
    last = "i"
    for k in range(CELLS):
        parts = {f"z{k}": hb.Zero(), f"i{k}": hb.One(), f"r{k}": hb.R("1 ohm")}
        m.add(**parts, **{f"c{k}": hb.C("1 F"), f"d{k}": hb.C("2 F")})
        m.bond(f"{last} -> z{k} -> c{k}", f"z{k} -> i{k} -> r{k}", f"z{k} -> d{k}")
        last = f"i{k}"
    return m


def test_the_far_end_fills_by_denormal_numbers():
    """The last bit of one is no small part of it, and no contradiction."""
    run = hb.simulate(line(), UNTIL)
    a = (np.eye(CELLS, k=1) + np.eye(CELLS, k=-1) - 2.0 * np.eye(CELLS)) / 3.0
    rest = np.linalg.solve(a, -np.eye(CELLS)[0] / 3.0)
    want = rest - expm(a * UNTIL) @ rest
    for j in range(6):
        assert run[f"c{j}.e"].at(UNTIL) == pytest.approx(want[j], rel=1e-6, abs=1e-13)
    assert run["d0.q"].at(UNTIL) == pytest.approx(2.0 * run["c0.q"].at(UNTIL), rel=1e-12)
