"""Fields of storage of which sources hold ports: these are dependent, and show what is induced.

Oracles: ``e = L di/dt`` and ``M di/dt`` of the currents given, R and L in series.
"""

from __future__ import annotations

import math

import pytest
from portable_runs import assert_the_same

import hybond as hb


def coupled_coils(current: str, field: object, *, open_circuit: bool) -> hb.Model:
    """Coupled coils: one is driven by a current, the other is left open or has a resistor."""
    m = hb.Model("coils", domain="electrical")
    m.add(coils=hb.I(field), drive=hb.Sf(current), first=hb.One(), second=hb.One())
    m.bond("drive -> first -> coils.1", "second -> coils.2")
    m.add(rest=hb.Sf(0) if open_circuit else hb.R("3 ohm"))
    m.bond("rest -> second" if open_circuit else "second -> rest")
    return m


LINEAR = [["4 mH", "1 mH"], ["1 mH", "3 mH"]]
BENT = {
    "f": [
        "300 [1/H]*p1 - 100 [1/H]*p2 + 1e4 [A/Wb^3]*p1^3",
        "400 [1/H]*p2 - 100 [1/H]*p1",
    ]
}


@pytest.mark.parametrize(
    ("current", "at", "slope"),
    [
        ("2 [A]*sin(100 [1/s]*time)", 2.0 * math.sin(5.0), 200.0 * math.cos(5.0)),
        ("2 [A]*cos(100 [1/s]*time)", 2.0 * math.cos(5.0), -200.0 * math.sin(5.0)),
        ("if time < 10 [ms] then 0 else 2 [A]", 2.0, 0.0),
    ],
)
def test_an_open_coil_shows_the_voltage_that_another_induces(
    current: str, at: float, slope: float
) -> None:
    """In a field the current that must be zero is a difference of large terms."""
    run = hb.simulate(coupled_coils(current, LINEAR, open_circuit=True), until=0.05)
    assert run["coils.1.f"].at(0.05) == pytest.approx(at, rel=1e-9)
    assert run["coils.1.e"].at(0.05) == pytest.approx(4e-3 * slope, abs=1e-9)
    assert run["coils.2.e"].at(0.05) == pytest.approx(1e-3 * slope, abs=1e-9)
    assert run["coils.2.p"].at(0.05) == pytest.approx(1e-3 * at, rel=1e-9)
    assert run.audit().holds()


def test_a_coil_beside_one_that_a_source_drives_is_a_state() -> None:
    """``L2 i2' + R i2 + M i1' = 0`` with ``i1 = 1000 t``."""
    run = hb.simulate(coupled_coils("1000 [A/s]*time", LINEAR, open_circuit=False), until=3e-3)
    i2 = -1.0 / 3.0 * (1.0 - math.exp(-3.0))
    assert run["coils.2.f"].at(3e-3) == pytest.approx(i2, rel=1e-6)
    i2_slope = -1.0 / 3.0 * math.exp(-3.0) * 1e3
    assert run["coils.1.e"].at(3e-3) == pytest.approx(4.0 + 1e-3 * i2_slope, rel=1e-6)


def test_an_open_coil_of_a_field_that_is_bent() -> None:
    run = hb.simulate(
        coupled_coils("2 [A]*sin(100 [1/s]*time)", BENT, open_circuit=True), until=0.05
    )
    p1, p2 = (run[f"coils.{k}.p"].at(0.05) for k in (1, 2))
    assert 400.0 * p2 == pytest.approx(100.0 * p1, rel=1e-9)
    assert 300.0 * p1 - 100.0 * p2 + 1e4 * p1**3 == pytest.approx(2.0 * math.sin(5.0), rel=1e-9)


def test_a_plate_beside_two_that_sources_hold() -> None:
    """The dual: a field of capacitors with an effort source on both ports."""
    m = hb.Model("plates", domain="electrical")
    m.add(plates=hb.C([["4 mF", "1 mF"], ["1 mF", "3 mF"]]), a=hb.Se("5 [V]*sin(100 [1/s]*time)"))
    m.add(b=hb.Se(0))
    m.bond("a -> plates.1", "b -> plates.2")
    run = hb.simulate(m, until=0.05)
    assert run["plates.2.f"].at(0.05) == pytest.approx(1e-3 * 500.0 * math.cos(5.0), rel=1e-9)


@pytest.mark.parametrize("field", [LINEAR, BENT])
def test_exported_programs_do_the_same(field: object, monkeypatch: pytest.MonkeyPatch) -> None:
    model = coupled_coils("if time < 10 [ms] then 0 else 2 [A]", field, open_circuit=True)
    assert_the_same(model, monkeypatch, until=0.02)
