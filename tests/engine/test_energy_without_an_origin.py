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


@pytest.mark.parametrize("turned", [False, True])
def test_oil_at_rest_in_a_cylinder_has_no_energy(turned: bool) -> None:
    """It had minus 28 kJ, beside which the audit of a run saw nothing of what moves."""
    bulk, area, dead, volume = 1.4e9, 1e-3, 2e-5, 1.7e-4
    pressure = f"{bulk}*(q1 - q2 - {dead})/({dead} + q2)"
    force = f"-{bulk}*(q1 - q2 - {dead})*(q1 + q2 + {dead})/(2*({dead} + q2)^2)"
    m = hb.Model("cylinder", domain="hydraulic")
    m.add(oil=hb.C({"e": [pressure, force]}, q=[volume, volume - dead]))
    m.add(pump=hb.Sf("1e-7*sin(9*time/(1 [s]))"), a=hb.Zero(), piston=hb.TF(area))
    m.add(v=hb.One(domain="translational"), mass=hb.I(2.0), spring=hb.C("1e-5 m/N"))
    m.bond("pump -> a -> oil.1", "v -> piston -> oil.2")
    m.bond(*("mass -> v", "spring -> v") if turned else ("v -> mass", "v -> spring"))
    m.machine("watch", states={"a": [], "b": []}, start="a", rules=["a -> b when time >= 0.3 [s]"])
    run = hb.simulate(m, 0.4)
    start, later = (e.steps[-1].energy.before for e in run.events)
    q, chamber = (run[f"oil.{k}.q"].at(0.3) for k in (1, 2))
    oil = bulk * (q - chamber - dead) ** 2 / (2 * (chamber + dead))
    rest = run["mass.p"].at(0.3) ** 2 / 4 + run["spring.q"].at(0.3) ** 2 / 2e-5
    assert start == 0.0 and later == pytest.approx(oil + rest, rel=1e-6)
    assert run.audit().holds()
