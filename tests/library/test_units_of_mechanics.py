"""The units of all signals of mechanical parts, by the names of the signals."""

import pytest

import hybond as hb

LINES = {
    "N": """
        force force_left force_right force_pivot force_x force_y friction normal
        tension tension_left tension_right
    """,
    "N*m": """
        torque torque_carrier torque_input torque_left torque_output torque_right torque_ring
        torque_sun
    """,
    "Pa": "pressure",
    "m": "depth dx dy elongation gap height length position reach slack u way x x_a x_b y y_a y_b",
    "rad": "angle lift twist",
    "m/s": "speed slip travel",
    "rad/s": "overrun",
    "J": "energy heat",
    "W": "power",
    "N*s": "momentum",
    "": "driven holds kappa locked rolls sticks taut touches",
}
UNITS = {name: unit for unit, names in LINES.items() for name in names.split()}
OWN = {
    "translational": {"offset": "m"},
    "rotational": {"offset": "rad", "speed": "rad/s", "slip": "rad/s", "momentum": "N*m*s"},
    "planar": {},
}
ELSEWHERE = {
    ("translational.lever", "speed"): "rad/s",
    ("translational.pulley", "speed"): "rad/s",
    ("rotational.belt", "slip"): "m/s",
    ("rotational.road_wheel", "slip"): "m/s",
    ("rotational.road_wheel_table", "slip"): "m/s",
    ("rotational.cam", "lift"): "m",
    ("rotational.lossy_gear", "friction"): "N*m",
}
"""Of signals that are about another end than most of their name."""
PARTS = [name for name in hb.library.names() if name.partition(".")[0] in OWN]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", PARTS)
def test_signals_have_the_units_of_their_names(name: str) -> None:
    expected = UNITS | OWN[name.partition(".")[0]]
    for line in hb.library.sheet(name).signals:
        unit = ELSEWHERE.get((name, line.name)) or expected[line.name]
        assert line.unit == unit, line.name
