"""Equations as numbers at a point, which is given in the words of the model."""

from __future__ import annotations

import pytest

import hybond as hb


def leak(*, turned: bool = False) -> hb.Model:
    """A capacitor with a leak that grows with an integrated signal, a parameter and an input."""
    m = hb.Model("leak", parameters={"a": 2.0})
    m.add(c=hb.C("0.5"), g=hb.G("a*(1 + w) + u"), n=hb.Zero())
    m.bond("n -> c", "g -> n" if turned else "n -> g")
    m.signal(w=hb.Integral("c.e"), twice="2*w")
    m.input(u=hb.Input(constant=0.0))
    return m


@pytest.mark.parametrize("turned", [False, True])
def test_a_point_is_given_by_the_names_of_the_model(turned: bool) -> None:
    """They were left unread, without a word; only ``s:0`` was taken."""
    eq = hb.state_equations(leak(turned=turned))
    rate = -(3.0 * (1 + 0.3) + 0.5) / 0.5
    for values in ({"w": 0.3, "a": 3.0, "u": 0.5}, {"s:0": 0.3, "p:a": 3.0, "u:0": 0.5}):
        found = float(eq.at((), values=values).A[0, 0]), float(eq.A.at((), values=values)[0, 0])
        assert found == pytest.approx((rate, rate), rel=1e-14)
    numeric = hb.state_equations(
        leak(turned=turned), symbolic=False, values={"w": 0.3, "p:a": 2.0, "u": 0.0, "p:c.C": 0.5}
    )
    assert float(numeric.at(()).A[0, 0]) == pytest.approx(-2.0 * 1.3 / 0.5, rel=1e-14)


def test_a_point_says_what_is_not_a_name_or_has_no_value() -> None:
    eq = hb.state_equations(leak())
    with pytest.raises(hb.HybondError, match="'v' is not known here"):
        eq.at((), values={"v": 0.3})
    with pytest.raises(hb.HybondError, match="twice is made of other signals"):
        eq.at((), values={"twice": 0.3})
    with pytest.raises(hb.HybondError, match="reads w, which has no value"):
        eq.at((), values={"u": 0.0})
    with pytest.raises(hb.HybondError, match=r"coefficient .*w.* needs a value of .*w"):
        hb.state_equations(leak(), symbolic=False)
