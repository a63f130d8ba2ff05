"""Values with a prefix and no unit behind --set and --vary: 1k, as circuits have them.

Oracle: the charge of a capacitor behind a resistor, in closed form.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb
from hybond.cli.lists import scaled
from hybond.cli.settings import flatten_with
from hybond.cli.vary import values_of
from hybond.simulation import simulate


@pytest.mark.parametrize(
    ("text", "means"),
    [("1k", 1e3), ("-2.2 k", -2.2e3), ("4.7u", 4.7e-6), ("10n", 1e-8), ("3 p", 3e-12)],
)
def test_a_prefix_alone_is_a_power_of_ten(text: str, means: float) -> None:
    assert float(scaled(text)) == pytest.approx(means, rel=1e-15)


@pytest.mark.parametrize("text", ["1 m", "1M", "2 kohm", "1K", "k", "2*k", "1e3", "5 V"])
def test_what_is_a_unit_or_means_two_things_stays(text: str) -> None:
    assert scaled(text) == text


def test_ranges_and_lists() -> None:
    assert values_of("R=1k..2k:3") == ("R", [1000.0, 1500.0, 2000.0])
    assert values_of("R=1k, 2.2kohm") == ("R", ["1e3", "2.2kohm"])
    # 3 was in m/s, 5 in mph, and nothing told it
    with pytest.raises(hb.UsageError, match="HB-X103"):
        values_of("v=3,5 mph")


def test_a_resistance_that_is_set_so() -> None:
    m = hb.Model("rc", domain="electrical", parameters={"R0": "1 ohm"})
    m.add(V=hb.Se("5 V"), j=hb.One(), r=hb.R("R0"), c=hb.C("1 uF"))
    m.bond("V -> j -> r", "j -> c")
    run = simulate(flatten_with(m, ["R0=2.2k"]), 1e-3)
    wanted = 5.0 * (1.0 - math.exp(-1.0 / 2.2))
    assert float(run["c.e"].at(1e-3)) == pytest.approx(wanted, rel=1e-7)
