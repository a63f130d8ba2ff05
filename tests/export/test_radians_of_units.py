"""The radian in the units of a functional mock-up unit: to the standard rad/s is not 1/s."""

from xml.etree import ElementTree

import pytest

import hybond as hb
from hybond.blocks.description import _unit
from hybond.export.fmu.describing import describe
from hybond.export.fmu.interface import interface_of
from hybond.units import parse_unit


def shaft(domain: str) -> hb.Model:
    m = hb.Model("shaft", domain=domain)
    m.add(T=hb.Se(1.0), J=hb.I(2.0), b=hb.R(0.5), k=hb.C(0.1), w=hb.One())
    m.bond("T -> w -> J", "w -> b", "w -> k")
    m.experiment = {"until": "1 s", "outputs": ["w.f", "b.e", "k.q"]}
    return m


@pytest.mark.parametrize("version", ["2.0", "3.0"])
@pytest.mark.parametrize(
    "domain, expected",
    [
        ("rotational", {"rad/s": {"rad": "1", "s": "-1"}}),
        ("translational", {"m/s": {"m": "1", "s": "-1"}, "m": {"m": "1"}}),
        ("electrical", {"A": {"A": "1"}}),
    ],
)
def test_a_speed_of_rotation_has_a_radian_in_its_base(
    version: str, domain: str, expected: dict[str, dict[str, str]]
) -> None:
    own = interface_of(
        shaft(domain).flatten(), outputs=["w.f", "b.e", "k.q"], text="", indicators=0, until=1.0,
        rtol=1e-6,
    )  # fmt: skip
    text = describe(own, version)
    root = ElementTree.fromstring(text)
    units = {u.get("name"): u for u in root.iter("Unit")}
    for name, powers in expected.items():
        base = units[name].find("BaseUnit")
        assert base is not None and dict(base.attrib) == powers
        # read back it is what it was
        back = _unit(units[name])
        assert back is not None and back.dimension == parse_unit(name)[1]
