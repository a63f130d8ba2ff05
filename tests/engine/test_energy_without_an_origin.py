"""Energy of storage whose law has no value where it stores nothing, as a gas without volume.

Oracles: integrals in closed form, and what the source and the mass beside it gave and took.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

import hybond as hb

LAWS: dict[str, tuple[str, float, Callable[[float], float]]] = {
    "gas": ("-1 [N*m]/q", 1.0, lambda q: -math.log(q)),
    "gas, other side": ("-1 [N*m]/q", -1.0, lambda q: -math.log(-q)),
    "adiabatic": ("-2 [N]/(q/(1 m))^1.4", 0.8, lambda q: 2 / 0.4 * q**-0.4),
    "logarithm": ("log(q/(1 m))*1 [N]", 2.0, lambda q: q * math.log(q) - q),
    "charge": ("-1 [N*m^2]/q^2 + 3 [N/m]*q", 1.5, lambda q: 1 / q + 1.5 * q**2),
}


def sprung(law: str, start: float) -> hb.Model:
    m = hb.Model("sprung", domain="translational")
    m.add(k=hb.C({"e": law}, q=f"{start} m"), m=hb.I("1 kg"), v=hb.One(), w=hb.Se("-0.5 N"))
    m.bond("v -> k", "v -> m", "w -> v")
    return m


@pytest.mark.parametrize("engine", [None, "python"])
@pytest.mark.parametrize("name", LAWS)
def test_what_is_stored_is_the_integral_of_the_law(name: str, engine: str | None) -> None:
    law, start, energy = LAWS[name]
    until = 0.3 if engine is None else 0.02
    run = hb.simulate(sprung(law, start), until, engine=engine)
    found = run.losses()
    end = float(run["k.q"].at(until))
    assert found["k"].stored == pytest.approx(energy(end) - energy(start), rel=1e-7)
    assert found["w"].supplied == pytest.approx(-0.5 * (end - start), rel=1e-9)
    assert found.holds() and run.audit().holds()


def test_a_gas_that_strikes_a_mass_loses_what_the_mass_had() -> None:
    m = hb.Model("stopped", domain="translational")
    m.add(k=hb.C({"e": "-1 [N*m]/q"}, q="1 m"), m=hb.I("1 kg", f="-1 m/s"), v=hb.One())
    m.bond("v -> k", "v -> m")
    m.machine("stop", states={"free": ["v"], "held": []}, start="free", rules=[
        "free -> held when k.q < 0.95 m"
    ])  # fmt: skip
    run = hb.simulate(m, "0.2 s")
    (energy,) = (s.energy for e in run.events[1:] for s in e.steps if s.energy and s.impulses)
    kinetic = 0.5 + math.log(0.95)  # what the gas took as it was pressed together is not there
    assert energy.lost == pytest.approx(kinetic, rel=1e-7)
