"""Every port of every part bonds to a part of the library, whichever way the bonds point.

At each port stands a part that loses power, with what its other end refers to: whatever a part says
of its port, the effort or the flow, the mate can answer with the other. So a port that cannot be
joined, has another domain than its page says, or leaves its start without a solution is found here.
"""

import math
from functools import cache

import pytest
from listed import listed
from part_sheets import sheet_of

import hybond as hb

MATES = {
    "electrical": ("electrical.resistor", "plus", "minus", "electrical.ground", "pin"),
    "translational": ("translational.damper", "left", "right", "translational.frame", "flange"),
    "rotational": ("rotational.damper", "left", "right", "rotational.frame", "shaft"),
    "hydraulic": (
        "hydraulic.laminar_resistance",
        "inlet",
        "outlet",
        "hydraulic.atmosphere",
        "port",
    ),
    "magnetic": ("magnetic.loss", "north", "south", "magnetic.ground", "port"),
    "thermal_pseudo": ("thermal.conductor", "hot", "cold", "thermal.ambient", "port"),
}
"""By domain: what is bonded to a port, its two ends, and what the other end is bonded to."""

OHMS = {
    "electrical": 1.0,
    "translational": 1.0,
    "rotational": 1.0,
    "hydraulic": 128 * 0.04 / (math.pi * 0.01**4),
    "magnetic": 10.0,
    "thermal_pseudo": 1.0,
}
"""Effort over flow of the mates with the values that they have by themselves."""

AMBIENT = {"thermal_pseudo": 293.15}
GAPS = {"planar.floor": "height", "planar.wheel": "height - 0.3 [m]"}
"""Parts with an input that has to be what their ports close: how far that is from its start."""


@cache
def parts() -> list[str]:
    """Return the names of the parts that have ports."""
    return [name for name in hb.library.names() if sheet_of(name).ports]


def joined(name: str, *, backward: bool) -> hb.Model:
    """Return a part with a mate at each of its ports; the bonds at the ports point in or out."""
    m = hb.Model("mated")
    given = {"height": "way"} if name in GAPS else {}
    m.add(part=hb.Submodel(name, inputs=given))
    if given:
        m.signal(way=hb.Integral("part.vy.f", start="0.3 m" if name == "planar.wheel" else "0 m"))
    for port in sheet_of(name).ports:
        mate = f"{port.name}_mate"
        if port.domain == "thermal":  # a law of entropy has no value where no temperature is given
            m.add(**{mate: hb.Submodel("thermal.entropy_capacity")})
            near = "port"
        else:
            kind, near, far, end, pin = MATES[port.domain]
            rest = f"{port.name}_rest"
            m.add(**{mate: hb.Submodel(kind), rest: hb.Submodel(end)})
            m.bond(f"{mate}.{far} -> {rest}.{pin}")
        here, there = f"part.{port.name}", f"{mate}.{near}"
        m.bond(f"{port.name}: {there} -> {here}" if backward else f"{port.name}: {here} -> {there}")
    return m


def test_every_domain_of_a_port_has_a_mate() -> None:
    assert {p.domain for name in parts() for p in sheet_of(name).ports} == {*MATES, "thermal"}
    assert set(OHMS) == set(MATES)


@pytest.mark.slow
@listed("name", hb.library.names())
def test_every_port_of_a_part_bonds_to_a_mate(name: str) -> None:
    """What passes is what the mate's law says, in the domain of the page.

    And what it was, with all bonds drawn the other way; of every fourth part, for what turning a
    bond does is said of elements and junctions, not of parts.
    """
    if name not in parts():
        return
    found = []
    ways = (False, True) if parts().index(name) % 4 == 0 else (False,)
    for backward in ways:
        run = hb.simulate(joined(name, backward=backward), until=1e-9)
        assert run.status == "ok"
        bonds = {bond.name.partition(":")[0]: bond for bond in run.graph.bonds}
        for port in sheet_of(name).ports:
            assert bonds[port.name].domain.name == port.domain, port.name
            effort, flow = (float(run[f'"{port.name}".{x}'].at(1e-9)) for x in "ef")
            if backward:  # what the port shares stays, the other counts the other way
                effort, flow = (effort, -flow) if port.shares == "effort" else (-effort, flow)
            found.append((backward, port.name, effort, flow))
            if port.domain in OHMS:
                expected = AMBIENT.get(port.domain, 0.0) + OHMS[port.domain] * flow
                assert effort == pytest.approx(expected, rel=1e-9, abs=1e-9), port.name
    if len(ways) == 1:
        return
    half = len(found) // 2
    for there, back in zip(found[:half], found[half:], strict=True):
        assert there[2:] == pytest.approx(back[2:], rel=1e-6, abs=1e-9), there[1]


@pytest.mark.parametrize("domain", [*MATES, "thermal"])
def test_a_port_refuses_a_mate_of_another_domain(domain: str) -> None:
    other = "electrical.ground" if domain != "electrical" else "hydraulic.atmosphere"
    pin = "pin" if domain != "electrical" else "port"
    name, port = next((n, p.name) for n in parts() for p in sheet_of(n).ports if p.domain == domain)
    m = hb.Model("mismatched")
    m.add(part=hb.Submodel(name), other=hb.Submodel(other))
    m.bond(f"part.{port} -> other.{pin}")
    with pytest.raises(hb.ModelError) as refused:
        m.flatten()
    assert refused.value.code == "HB-M134"
