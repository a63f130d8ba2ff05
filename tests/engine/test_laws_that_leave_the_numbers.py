"""A storage that is filled until its law gives no finite number, with rates that stay finite.

Oracle: a constant flow into a storage gives q = f t, and sinh overflows beyond asinh(largest).
"""

import math
import sys

import pytest

import hybond as hb

END = math.asinh(sys.float_info.max)
"""The charge in C, and the time in s, at which sinh leaves the numbers: about 710.5."""


def filled(kind: str, turned: bool) -> hb.Model:
    electrical = kind == "C"
    m = hb.Model("filled", domain="electrical" if electrical else "translational")
    if electrical:
        m.add(s=hb.Sf("1 A"), store=hb.C({"e": "1 [V]*sinh(q/(1 C))"}), node=hb.Zero())
    else:
        m.add(s=hb.Se("1 N"), store=hb.I({"f": "1 [m/s]*sinh(p/(1 [N*s]))"}), node=hb.One())
    m.bond("s -> node", "store -> node" if turned else "node -> store")
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("kind", ["C", "I"])
@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_it_is_refused_and_named(kind: str, turned: bool, solver: str) -> None:
    m = filled(kind, turned)
    stored = "store.q" if kind == "C" else "store.p"
    run = hb.simulate(m, END - 1.0, solver=solver)
    assert run.status == "ok"
    assert abs(float(run[stored].at(run.t_end))) == pytest.approx(END - 1.0, rel=1e-9)
    with pytest.raises(hb.NumericsError) as caught:
        hb.simulate(m, END + 1.0, solver=solver)
    assert caught.value.code == "HB-N203"
