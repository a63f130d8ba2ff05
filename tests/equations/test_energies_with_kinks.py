"""Energies of storage whose laws have kinks, against closed forms."""

from __future__ import annotations

import math

import pytest

import hybond as hb
from hybond.engine.engine import make_engine
from hybond.engine.mode.rows.storage import energy_of
from hybond.engine.tables import answered, tables_of

LAWS = {
    "play": ("10 [N/m]*(max(q - 0.3 [m], 0) + min(q + 0.3 [m], 0))", lambda q: play(q)),
    "bilinear": ("if q > 0 [m] then q*1 [N/m] else 100 [N/m]*q", lambda q: bilinear(q)),
    "sawtooth": ("1 [N/m]*mod(q, 0.25 [m])", lambda q: sawtooth(q)),
    "preload": ("2 [N]*sign(q) + q*3 [N/m]", lambda q: 2.0 * abs(q) + 1.5 * q * q),
}


def play(q: float) -> float:
    return 5.0 * max(abs(q) - 0.3, 0.0) ** 2


def bilinear(q: float) -> float:
    return (0.5 if q > 0.0 else 50.0) * q * q


def sawtooth(q: float) -> float:
    teeth = math.floor(q / 0.25)
    return teeth * 0.5 * 0.25**2 + 0.5 * (q - 0.25 * teeth) ** 2


def stored(m: hb.Model, q: float) -> float:
    """Return the energy with `q` stored, and a mass at rest."""
    return energy_of(make_engine(answered(tables_of(m.flatten(), until=1.0))), [q, 0.0])


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("q", [0.2999, 0.3001, 0.305, 0.31, 1.0, 1.01, -0.3001, -0.9])
def test_energy_of_a_law_with_kinks(law: str, q: float) -> None:
    """Just beyond a kink a rule that samples the way there sees nothing of what follows."""
    text, energy = LAWS[law]
    m = hb.Model("spring", domain="translational")
    m.add(spring=hb.C({"e": text}), mass=hb.I("1 kg"), v=hb.One())
    m.bond("v -> spring", "v -> mass")
    assert stored(m, q) == pytest.approx(energy(q), rel=1e-12, abs=1e-18)


def test_energy_of_a_table() -> None:
    m = hb.Model("spring", domain="translational")
    m.add(spring=hb.C({"e": {"table": [[0, 1, 1.01, 2], [0, 0, 5, 6]]}}), mass=hb.I("1 kg"))
    m.add(v=hb.One())
    m.bond("v -> spring", "v -> mass")
    assert stored(m, 1.001) == pytest.approx(0.5 * 0.001 * 0.5, rel=1e-9)


def test_the_energy_of_an_impact_knows_the_kink() -> None:
    """A mass of 1 m/s catches another, while a spring with play is stretched just beyond it."""
    m = hb.Model("caught", domain="translational")
    m.add(spring=hb.C({"e": LAWS["play"][0]}, q=0.301), v=hb.One(), w=hb.One(), joint=hb.Zero())
    m.add(one=hb.I("1 kg", f=1.0), other=hb.I("1 kg"))
    m.bond("v -> spring", "v -> one", "v -> joint -> w", "w -> other")
    rules = ["apart -> joined when time >= 0"]
    m.machine("M", states={"apart": [], "joined": ["joint"]}, start="apart", rules=rules)
    (event,) = hb.simulate(m, until=1e-3).events
    energy = event.steps[-1].energy
    assert (energy.before, energy.lost) == pytest.approx((0.5 + play(0.301), 0.25), rel=1e-12)


def test_the_audit_of_a_spring_with_play_holds() -> None:
    """With the energy wrong, nothing that the steps do would make it."""
    m = hb.Model("play", domain="translational")
    m.add(spring=hb.C({"e": LAWS["play"][0]}), mass=hb.I("1 kg", f=1.0), v=hb.One())
    m.bond("v -> spring", "v -> mass")
    run = hb.simulate(m, until=10.0, rtol=1e-10, solver="radau")
    assert run.audit().energy < 1e-8
