"""A root on both sides of rest that is written as two roots: it rests as one does.

Orifices are written so more often than by the root of a size. What they level out comes to rest
within a finite time, and nothing flows then.
"""

from __future__ import annotations

import pytest

import hybond as hb

AS_TWO = {
    "its own effort": "1e-3*(if e > 0 then sqrt(e) else -sqrt(-e))",
    "by a density": "if e >= 0 then 0.6*A*sqrt(2*e/rho) else -0.6*A*sqrt(-2*e/rho)",
    "by a power": "if e < 0 then -1e-3*(-e)^0.5 else 1e-3*e^0.5",
    "two levels": "if n0.e > n1.e then 1e-3*sqrt(n0.e - n1.e) else -1e-3*sqrt(n1.e - n0.e)",
    "cut off": "1e-3*(if n0.e > n1.e then sqrt(max(0, n0.e - n1.e))"
    " else -sqrt(max(n1.e - n0.e, 0)))",
}


def vessels(law: str, starts: list[float]) -> hb.Model:
    """Return vessels in a row, with orifices between."""
    m = hb.Model("row", parameters={"rho": "870 [kg/m^3]/1 [kg/m^3]", "A": 0.035})
    for i, start in enumerate(starts):
        m.add({f"C{i}": hb.C(1e-4, e=start), f"n{i}": hb.Zero()})
        m.bond(f"n{i} -> C{i}")
    for i in range(1, len(starts)):
        own = law.replace("n1.e", f"n{i}.e").replace("n0.e", f"n{i - 1}.e")
        m.add({f"j{i}": hb.One(), f"o{i}": hb.R({"f": own})})
        m.bond(f"n{i - 1} -> j{i} -> n{i}", f"j{i} -> o{i}")
    return m


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("law", list(AS_TWO))
def test_vessels_are_level_and_nothing_flows(law: str, solver: str) -> None:
    """Two of them: the root of what differs falls evenly, by k/C in a second."""
    run = hb.simulate(vessels(AS_TWO[law], [4e3, 1e3]), until=60.0, solver=solver)
    if law != "by a density":
        left = run["n0.e"].at(2.0) - run["n1.e"].at(2.0)
        assert left == pytest.approx((3e3**0.5 - 1e-3 / 1e-4 * 2.0) ** 2, rel=1e-5)
    assert run.final["C0.q"] == pytest.approx(0.25, rel=1e-8)
    assert abs(run["C0.f"].at(50.0)) < 1e-12
    assert not run.warnings
    assert run.stats["steps"] < 100


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_a_row_of_them_comes_to_rest(solver: str) -> None:
    """Flows at rest were 1e-6 of what there was, for ever, after 2,500 steps."""
    starts = [float(7 * i % 5) * 1e3 for i in range(13)]
    run = hb.simulate(vessels(AS_TWO["its own effort"], starts), until=100.0, solver=solver)
    for i in range(13):
        assert run[f"C{i}.e"].at(100.0) == pytest.approx(sum(starts) / 13, rel=1e-8)
        assert abs(run[f"C{i}.f"].at(95.0)) < 1e-12
    assert run.stats["steps"] < 400


def test_a_root_on_one_side_still_ends_there() -> None:
    """It is refused where it has no value, as it was."""
    m = hb.Model("one")
    m.add(S=hb.Sf(-1.0), n=hb.Zero(), C=hb.C(1.0, e=1.0), r=hb.R({"f": "0.1*sqrt(e)"}))
    m.bond("S -> n -> C", "n -> r")
    with pytest.raises(hb.HybondError) as refused:
        hb.simulate(m, until=5.0)
    assert refused.value.code == "HB-N302"
