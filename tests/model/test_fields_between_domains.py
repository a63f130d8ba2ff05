"""Each port of a field has the domain of what it is bonded to: transducers, heat that is made."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb
from hybond.model.expressions.slots import Slots
from hybond.model.flatten import flatten

EA, GAP, COMPLIANCE, MASS, OHM = 1e-14, 1e-3, 0.1, 1e-6, 1e6


def microphone(domain: str = "electrical") -> hb.Model:
    """Return a condenser with a plate on a spring, behind a resistor."""
    m = hb.Model("microphone", domain=domain, parameters={"eA": f"{EA} F*m", "d": "1 mm"})
    m.add(V=hb.Se("100 V"), i=hb.One(domain="electrical"), R=hb.R(f"{OHM} ohm"))
    m.add(plates=hb.C({"e": ["q1*q2/eA", "q1^2/(2*eA)"]}, q=["100 [V]*eA/d", "d"]))
    m.add(v=hb.One(domain="translational"), mass=hb.I(f"{MASS} kg"))
    m.add(k=hb.C(f"{COMPLIANCE} m/N"), push=hb.Se("1e-6 [N]*sin(1000*time)"))
    m.bond("V -> i -> plates.1", "i -> R", "v -> plates.2", "v -> mass", "v -> k", "push -> v")
    return m


@pytest.mark.parametrize("domain", ["electrical", "translational", "generic"])
def test_a_condenser_with_a_plate_that_moves(domain: str) -> None:
    def rates(t: float, y: np.ndarray) -> list[float]:
        q, x, v, s = y
        push = 1e-6 * np.sin(1000 * t)
        force = push - q * q / (2 * EA) - s / COMPLIANCE
        return [(100 - q * x / EA) / OHM, v, force / MASS, v]

    right = solve_ivp(
        rates, (0, 0.01), [100 * EA / GAP, GAP, 0, 0], "LSODA", rtol=1e-11, atol=1e-22
    ).y[:, -1]
    run = hb.simulate(microphone(domain), until="10 ms", rtol=1e-10)
    for name, value in zip(("plates.1.q", "plates.2.q", "mass.f", "k.q"), right, strict=True):
        assert run[name].at(0.01) == pytest.approx(value, rel=1e-6), name
    assert (run["plates.1.e"].unit, run["plates.2.e"].unit) == ("V", "N")
    assert run.audit().holds()


def test_a_wire_that_grows_warm_keeps_the_books() -> None:
    m = hb.loads("""
hybond = 1
domain = "electrical"
[parameters]
T0 = "300 K"
R0 = "5 ohm"
a  = "0.004 1/K"
[elements]
V    = { Se = "10 V" }
i    = { junction = 1 }
wire = { R = { f = ["e1/(R0*(1 + a*(e2 - T0)))", "-e1^2/(R0*(1 + a*(e2 - T0)))/e2"] } }
heat = { junction = 0, domain = "thermal" }
body = { C = { e = "T0*exp(q/(2 [J/K]))" } }
[graph]
bonds = ["V -> i -> wire.1", "heat -> wire.2", "heat -> body"]
""")
    run = hb.simulate(m, until=5)
    # 2 T' = 100/(5 (1 + 0.004 (T - 300))): a square of the warming
    warmed = (-1 + np.sqrt(1 + 2 * 0.004 * 50)) / 0.004
    assert run["body.e"].at(5.0) == pytest.approx(300 + warmed, rel=1e-8)
    assert warmed == pytest.approx(float(run["V.e*V.f"].mean()) * 5 / 2, rel=1e-7)
    assert run.audit().holds()
    assert hb.dumps(hb.loads(hb.dumps(m))) == hb.dumps(m)


@pytest.mark.parametrize(
    ("law", "wrong", "wants"),
    [
        (["q1*q2/eA", "q1*q2/eA"], "q1*q2/eA", "N"),
        (["q1^2/eA", "q1^2/(2*eA)"], "q1^2/eA", "V"),
    ],
)
def test_the_law_of_each_port_is_in_its_own_unit(law: list[str], wrong: str, wants: str) -> None:
    m = microphone()
    m.elements["plates"] = hb.C({"e": law}, q=["100 [V]*eA/d", "d"])
    with pytest.raises(hb.UnitError, match="HB-U103") as caught:
        m.flatten()
    assert wrong in str(caught.value) and f"wants {wants}" in str(caught.value)


def test_a_start_is_in_the_unit_of_its_port() -> None:
    m = microphone()
    m.elements["plates"] = hb.C({"e": ["q1*q2/eA", "q1^2/(2*eA)"]}, q=["d", "d"])
    with pytest.raises(hb.UnitError, match="the start q is given in m; it is in C"):
        m.flatten()


def test_a_domain_that_a_field_says_is_that_of_all_its_ports() -> None:
    m = microphone("generic")
    m.elements["plates"] = hb.C([[1, 0.5], [0.5, 2]], domain="electrical")
    with pytest.raises(hb.ModelError, match="HB-M134"):
        m.flatten()


ENERGIES = {
    "twice the force": (["q1*q2/eA", "q1^2/eA"], [(0.0, 0.0), (1e-6, 1e-3), (0.0, 1e-3)]),
    "turned round": (["q1*q2/eA", "-q1^2/(2*eA)"], [(0.0, 0.0), (1e-6, 1e-3)]),
    "one way": (["q1*q2/eA", "0"], [(1e-6, 1e-3)]),
}


@pytest.mark.parametrize("name", ENERGIES)
def test_a_bent_field_that_would_make_energy_is_refused(name: str) -> None:
    """In a cycle around, what one port gives is not what the other takes."""
    laws, starts = ENERGIES[name]
    for start in starts:
        m = microphone()
        m.elements["plates"] = hb.C({"e": laws}, q=list(start))
        with pytest.raises(hb.ModelError, match="no one energy") as caught:
            m.flatten()
        assert caught.value.code == "HB-M163" and caught.value.where == "elements.plates.C"


def test_fields_with_an_energy_in_pieces_are_not() -> None:
    for laws in (
        ["q1*max(q2, 0)/eA", "if q2 > 0 then q1^2/(2*eA) else 0"],
        ["q1*(1 [mm] + q2)/eA", "q1^2/(2*eA) + 5 [N/m]*q2"],
        ["1 [V/m]*q2*log(q1/(1 [C]))", "1 [V/m]*q1*(log(q1/(1 [C])) - 1)"],
    ):
        m = microphone()
        m.elements["plates"] = hb.C({"e": laws}, q=[1e-6, 1e-3])
        m.flatten()


FOLLOWED = {
    "a condenser": (["q1*q2/eA", "q1^2/(2*eA)"], set()),
    "another gap": (["q1*(q2 + w*d)/eA", "q1^2/(2*eA)"], set()),
    "in pieces": (["q1*max(q2, w*d)/eA", "if q2 > w*d then q1^2/(2*eA) else 0"], set()),
    "a function": (["q1*exp(q2/d)/w/(1 [F])", "q1^2*exp(q2/d)/(2*w*d)/(1 [F])"], set()),
    "one energy by chance": (["q1*q2/eA", "w*q1^2/(2*eA)"], {"eA", "w"}),
}


@pytest.mark.parametrize("name", FOLLOWED)
def test_parameters_of_a_field_are_followed_where_any_value_has_one_energy(name: str) -> None:
    """Where only some have, they are the numbers that they are: of others it was not asked."""
    laws, fixed = FOLLOWED[name]
    m = microphone()
    m.parameter(w=1)
    m.elements["plates"] = hb.C({"e": laws}, q=[1e-6, 1e-3])
    slots = Slots({"eA", "d", "w"})
    flatten(m, {}, slots)
    assert set(slots.fixed) == fixed


@pytest.mark.slow
def test_a_run_is_differentiated_by_what_a_condenser_is_made_of() -> None:
    """Against two integrations of the equations as they are written on paper."""

    def charge(ea: float) -> float:
        def rates(t: float, y: np.ndarray) -> list[float]:
            q, x, v, s = y
            force = 1e-6 * np.sin(1000 * t) - q * q / (2 * ea) - s / COMPLIANCE
            return [(100 - q * x / ea) / OHM, v, force / MASS, v]

        start = [100 * ea / GAP, GAP, 0, 0]
        return solve_ivp(rates, (0, 0.01), start, "LSODA", rtol=1e-12, atol=1e-24).y[0, -1]

    slope = (charge(EA * (1 + 1e-4)) - charge(EA * (1 - 1e-4))) / (2e-4 * EA)
    found = hb.sensitivities(microphone(), "10 ms", wrt=["eA"], rtol=1e-10)
    assert found.final("plates.1.q", "eA") == pytest.approx(slope, rel=1e-5)
