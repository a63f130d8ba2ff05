"""A resistor whose law is a multiple of another bond's effort or flow carries no impulse.

Oracles: momentum, or charge, is conserved by the two storages that a switch joins, as if the law
were not there; so the energy that is lost is that of a perfectly plastic impact, and never less.
"""

from __future__ import annotations

import pytest

import hybond as hb

FACTORS = ("-0.5", "-1.5", "0.7", "-0.5*(1 + 0*time/(1 s))", "k")


def joined(factor: str, kind: str, turned: bool) -> hb.Model:
    """Two bodies that a dog clutch joins, or two capacitors and a switch; what passes is read."""
    m = hb.Model("joined", domain="rotational" if kind == "R" else "electrical")
    m.parameter(k=-0.5)
    if kind == "R":
        m.add(A=hb.I("1 kg*m^2", f="3 rad/s"), B=hb.I("2 kg*m^2"), a=hb.One(), x=hb.Zero())
        m.add(dog=hb.Zero(), lean=hb.R({"e": f"({factor})*x.e"}))
        m.bond("a -> A", "a -> x -> dog -> B", "lean -> a" if turned else "a -> lean")
    else:
        m.add(A=hb.C("1 F", e="3 V"), B=hb.C("2 F"), a=hb.Zero(), x=hb.One())
        m.add(dog=hb.One(), lean=hb.G({"f": f"({factor})*x.f"}))
        m.bond("a -> A", "a -> x -> dog -> B", "lean -> a" if turned else "a -> lean")
    m.machine(
        "S",
        states={"open": [], "shut": ["dog"]},
        start="open",
        rules=["open -> shut when time >= 0.5 s"],
    )
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("kind", ["R", "G"])
@pytest.mark.parametrize("factor", FACTORS)
def test_it_has_no_part_in_a_jump(factor: str, kind: str, turned: bool) -> None:
    run = hb.simulate(joined(factor, kind, turned), "0.6 s")
    step = run.events[-1].steps[-1]
    assert step.energy is not None
    of_law = "lean.e" if kind == "R" else "lean.f"
    assert step.impulses.get(of_law, 0.0) == 0.0
    stored = ("A.p", "B.p") if kind == "R" else ("A.q", "B.q")
    after = [float(run[name].at(run.events[-1].t)) for name in stored]
    assert after == pytest.approx([1.0, 2.0], rel=1e-9)
    assert step.energy.lost == pytest.approx(4.5 - 1.5, rel=1e-9)
    assert not any("creates" in w for w in run.warnings)


def test_a_source_that_carries_no_impulse_agrees_with_a_resistor_of_its_law() -> None:
    jumps = []
    for lean in (hb.R({"e": "-0.5*x.e"}), hb.Se("-0.5*x.e", impulsive=False)):
        own = hb.Model("own", domain="rotational")
        own.add(A=hb.I("1 kg*m^2", f="3 rad/s"), B=hb.I("2 kg*m^2"), a=hb.One(), x=hb.Zero())
        own.add(dog=hb.Zero(), lean=lean)
        own.bond("a -> A", "a -> x -> dog -> B", "a -> lean")
        own.machine(
            "S",
            states={"open": [], "shut": ["dog"]},
            start="open",
            rules=["open -> shut when time >= 0.5 s"],
        )
        jumps.append(dict(hb.simulate(own, "0.6 s").events[-1].steps[-1].impulses))
    assert jumps[0] == pytest.approx(jumps[1])


def test_what_is_declared_impulsive_is() -> None:
    m = hb.Model("declared", domain="rotational")
    m.add(A=hb.I("1 kg*m^2", f="3 rad/s"), B=hb.I("2 kg*m^2"), a=hb.One(), x=hb.Zero())
    m.add(dog=hb.Zero(), lean=hb.R({"e": "0.5*x.e"}, impulsive=True))
    m.bond("a -> A", "a -> x -> dog -> B", "a -> lean")
    m.machine(
        "S",
        states={"open": [], "shut": ["dog"]},
        start="open",
        rules=["open -> shut when time >= 0.5 s"],
    )
    run = hb.simulate(m, "0.6 s")
    # A gives 1.5 of what B takes: 3 - 1.5*P = P/2
    assert run.events[-1].steps[-1].impulses["lean.e"] == pytest.approx(0.5 * 1.5, rel=1e-9)
