"""A port has the domain that its own node says, not that of the model around it."""

from __future__ import annotations

import pytest

import hybond as hb


def drive(domain: str, own: str) -> hb.Model:
    """Return a part of one domain with a port of another, which it says of one node only."""
    m = hb.Model("drive", domain=domain)
    m.add(node=hb.Zero(), store=hb.C(1.0), couple=hb.GY(0.5))
    m.add(shaft=hb.One(domain=own), rub=hb.R(1.0), rotor=hb.I(1.0))
    m.bond("node -> store", "node -> couple -> shaft", "shaft -> rub", "shaft -> rotor")
    m.ports["port"] = "shaft"
    m.ports["feed"] = "node"
    return m


PARTS = {
    "cylinder": ("hydraulic.cylinder", "rod", "translational.mass", "flange", "translational"),
    "motor": (
        drive("electrical", "rotational"),
        "port",
        "rotational.inertia",
        "shaft",
        "rotational",
    ),
    "voice coil": (
        drive("electrical", "translational"),
        "port",
        "translational.mass",
        "flange",
        "translational",
    ),
    "pump": (drive("rotational", "hydraulic"), "port", "hydraulic.volume", "port", "hydraulic"),
    "heater": (
        drive("electrical", "thermal"),
        "port",
        "thermal.entropy_capacity",
        "port",
        "thermal",
    ),
}


@pytest.mark.parametrize("way", ["a.{} -> b.{}", "b.{1} -> a.{0}"])
@pytest.mark.parametrize("case", PARTS)
def test_a_port_of_another_domain_joins_its_like(case: str, way: str) -> None:
    one, own, other, port, domain = PARTS[case]
    m = hb.Model("joined")
    m.add(a=hb.Submodel(one), b=hb.Submodel(other))
    m.bond(way.format(own, port))
    joined = [
        b
        for b in m.flatten().bonds
        if {"a", "b"} <= {e.split(".")[0] for e in b.name.split(" -> ")}
    ]
    assert [bond.domain.name for bond in joined] == [domain]


@pytest.mark.parametrize("case", [name for name in PARTS if name != "cylinder"])
def test_it_does_not_join_the_domain_of_its_model(case: str) -> None:
    one, own, *_ = PARTS[case]
    m = hb.Model("wrong")
    m.add(a=hb.Submodel(one), b=hb.Submodel(one))
    m.bond(f"a.{own} -> b.feed")
    with pytest.raises(hb.ModelError) as caught:
        m.flatten()
    assert caught.value.code == "HB-M134"
