"""What repeats among samples, held against linear maps whose orbits are known."""

import cmath

import numpy as np
import pytest

import hybond as hb
from hybond.sweep.bifurcation.orbits import orbit_of


@pytest.mark.parametrize("turns", [5, 6, 7, 8, 5.1, 7.9, 3.02])
@pytest.mark.parametrize("size", [0.95, 0.97])
def test_a_spiral_into_a_point_is_no_longer_orbit(turns: float, size: float) -> None:
    """z -> size exp(2 pi i/turns) z ends in a fixed point, though it is near itself each turn."""
    z = 1e-3 * (size * cmath.exp(2j * cmath.pi / turns)) ** np.arange(48)
    samples = np.stack([1.0 + z.real, 2.0 + z.imag])
    found = orbit_of(samples, [(0,)] * 48, np.array([1.0, 2.0]), 1e-9, 16)
    assert found.period in (0, 1) and not found.settled


@pytest.mark.parametrize("period", [2, 3, 5])
def test_an_orbit_that_is_approached_keeps_its_period(period: int) -> None:
    """Points of the orbit stay apart while what is added to them goes."""
    k = np.arange(60)
    samples = 1.0 + 0.1 * np.cos(2 * np.pi * k / period)[None, :] + 1e-3 * 0.9**k
    found = orbit_of(samples, [(0,)] * 60, np.array([1.0]), 1e-9, 16)
    assert (found.period, found.settled) == (period, False)


def chopper() -> hb.Model:
    m = hb.Model("chopper", domain="electrical", parameters={"R": "1 ohm", "T": "1 ms"})
    m.input(u=hb.Input(pwm={"period": "T", "duty": 0.5, "high": "1 V", "low": 0}))
    m.add(V=hb.Se("u"), L=hb.I("10 mH"), load=hb.R("R"), i=hb.One())
    m.bond("V -> i -> L", "i -> load")
    return m


def test_what_has_not_settled_is_said() -> None:
    slow = hb.bifurcation(chopper(), {"R": [1.0, 2.0]}, of=["L.f"], period="T", settle=2)
    assert any("settle" in note for note in slow.notes) and "note: " in str(slow)
    assert hb.bifurcation(chopper(), {"R": [1.0, 2.0]}, of=["L.f"], period="T").notes == ()


def boost() -> hb.Model:
    m = hb.Model("boost", domain="electrical", parameters={"D": 0.4, "T": "20 us"})
    m.input(g=hb.Input(pwm={"period": "T", "duty": "D"}))
    m.add(V=hb.Se(12.0), il=hb.One(), L=hb.I(1e-4), x=hb.Zero(), gnd=hb.Se(0.0), low=hb.One())
    m.add(d=hb.One(law="diode"), out=hb.Zero(), C=hb.C(4.7e-5), load=hb.R(24.0))
    m.bond("V -> il -> x", "il -> L", "x -> low -> gnd", "x -> d -> out", "out -> C", "out -> load")
    m.machine("gate", states={"off": [], "on": ["low"]}, start="off",
              rules=["off -> on when g > 0.5", "on -> off when g < 0.5"])  # fmt: skip
    return m


def test_what_comes_to_no_period_may_not_have_settled_which_is_said() -> None:
    """A filter that forgets a hundredth a period, 300 of them."""
    found = hb.bifurcation(boost(), {"D": [0.3, 0.6]}, of=["L.f"], period="T")
    assert "2 of all values came to no period" in found.notes[0] and "settle" in found.notes[0]
    settled = hb.bifurcation(boost(), {"D": [0.3, 0.6]}, of=["L.f"], period="T", settle=3000)
    assert settled.notes == () and settled.branches[0].period.tolist() == [1, 1]


def test_a_period_and_bounds_have_the_unit_of_what_they_are_of() -> None:
    with pytest.raises(hb.UsageError) as caught:
        hb.bifurcation(chopper(), {"R": [1.0, 2.0]}, of=["L.f"], period="3 V")
    assert caught.value.code == "HB-P132"
    with pytest.raises(hb.UsageError) as caught:
        hb.continuation(chopper(), "R", ("1 ohm", "5 V"))
    assert caught.value.code == "HB-A543"
    data = {"time": [0.001, 0.002, 0.003], "L.f": [0.0, 0.01, 0.02]}
    with pytest.raises(hb.UsageError) as caught:
        hb.fit(chopper(), data, free=["R"], bounds={"R": ("0.1 ohm", "9 V")})
    assert caught.value.code == "HB-A532"
