"""Energies of storage whose laws go to and fro for ever, against closed forms."""

from __future__ import annotations

import math

import pytest

import hybond as hb
from hybond.engine.engine import make_engine
from hybond.engine.mode.rows.storage import energy_of
from hybond.engine.tables import answered, tables_of

LAWS = {
    "detent": ("a*sin(2*b*q)", lambda q: 1.7 / 3.0 * math.sin(1.5 * q) ** 2 * 2.0),
    "shifted": (
        "3*q - a*cos(1 - q/2) + 4*q^2",
        lambda q: 1.5 * q * q + 3.4 * (math.sin(1.0 - 0.5 * q) - math.sin(1.0)) + 4.0 / 3.0 * q**3,
    ),
    "not a wave of a line": ("a*sin(b*q^2)*q", lambda q: 1.7 / 3.0 * (1 - math.cos(1.5 * q * q))),
}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("q", [1e-9, 0.3, -2.0, 7.0])
def test_energy_of_a_law_with_waves(law: str, q: float) -> None:
    text, energy = LAWS[law]
    m = hb.Model("spring", parameters={"a": 1.7, "b": 1.5})
    m.add(spring=hb.C({"e": text}), mass=hb.I(1.0), v=hb.One())
    m.bond("v -> spring", "v -> mass")
    found = energy_of(make_engine(answered(tables_of(m.flatten(), until=1.0))), [q, 0.0])
    if abs(q) > 1e-6:
        assert found == pytest.approx(energy(q), rel=1e-12)
    else:
        assert found == pytest.approx(0.5 * q * q * _slope(law) + q * _level(law), rel=1e-9)


def _slope(law: str) -> float:
    return {"detent": 5.1, "shifted": 3.0 - 0.85 * math.sin(1.0)}.get(law, 0.0)


def _level(law: str) -> float:
    return -1.7 * math.cos(1.0) if law == "shifted" else 0.0


@pytest.mark.parametrize("bond", ["w -> magnets", "magnets -> w"])
def test_what_a_rotor_stores_after_hundreds_of_teeth(bond: str) -> None:
    """A rotor spins on through the detent of its magnets: 1200 rad were too many for points.

    What was stored was off by some tenths of a joule, and the audit did not hold.
    """
    sign = 1.0 if bond.startswith("w") else -1.0
    m = hb.Model("rotor", domain="rotational")
    m.add(w=hb.One(), magnets=hb.C({"e": "2*sin(3*q)"}, q=sign * 400.0), J=hb.I(1.0, f=30.0))
    m.bond("w -> J", bond)
    run = hb.simulate(m, until="0.2 s")
    begun = 450.0 + 2.0 / 3.0 * (1.0 - math.cos(1200.0))
    assert run.events[0].steps[-1].energy.after == pytest.approx(begun, rel=1e-12)
    q = float(run["magnets.q"].at(0.2))
    stored = 2.0 / 3.0 * (math.cos(1200.0) - math.cos(3.0 * q))
    assert run.losses()["magnets"].stored == pytest.approx(stored, rel=1e-9)
    assert run.audit().holds()
