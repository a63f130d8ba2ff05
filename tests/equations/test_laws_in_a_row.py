"""Nonlinear resistors that share a flow, with no storage between them."""

from pathlib import Path

import pytest
from export.programs import ask, compile_quickly, needs_c, read_events

import hybond as hb


def orifices() -> hb.Model:
    """Two in a row under 5 Pa, and how much has passed."""
    m = hb.Model("orifices")
    m.add(high=hb.Se(5.0), q=hb.One())
    m.add(a=hb.R({"f": "e/(e^2+1)^0.25"}), b=hb.R({"f": "2*e/(e^2+1)^0.25"}))
    m.bond("high -> q", "q -> a", "q -> b")
    m.signal(passed=hb.Integral("q.f"))
    m.experiment["until"] = 2.0
    return m


def flow() -> float:
    """Bisect for the drop across the first one at which both pass the same."""
    low, high = 0.0, 5.0
    for _ in range(100):
        e = 0.5 * (low + high)
        more = e / (e * e + 1) ** 0.25 > 2 * (5 - e) / ((5 - e) ** 2 + 1) ** 0.25
        low, high = (low, e) if more else (e, high)
    return e / (e * e + 1) ** 0.25


def test_their_equations_keep_the_effort_between_them() -> None:
    eq = hb.state_equations(orifices())
    assert "0 = " in str(eq)
    assert 'kept as variables: "q -> a".e' in str(eq)
    assert not eq.lost


@pytest.mark.slow
@needs_c
def test_they_are_run_and_exported(tmp_path: Path) -> None:
    m = orifices()
    run = hb.simulate(m)
    assert run.final["passed"] == pytest.approx(2.0 * flow(), rel=1e-9)
    said = read_events(ask(compile_quickly(hb.export(m, to="c"), tmp_path, "row"), "--events"))
    assert said.states["passed"] == pytest.approx(2.0 * flow(), rel=1e-9)
