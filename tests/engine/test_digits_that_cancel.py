"""Small currents and forces that come about as differences of large ones keep their digits.

Closed forms and fractions of what is stored are the oracle; and power, which a graph conserves
whatever the numbers are.
"""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from in_orders import in_orders

import hybond as hb
from hybond.testing import random_recipe


@pytest.mark.parametrize("leak", [1.6e-5, 3e-13])
def test_the_current_of_a_leak_behind_a_small_resistance(leak: float) -> None:
    parts = {"V": hb.Se(-350.0), "s": hb.One(), "r": hb.R(1.0), "n": hb.Zero(), "g": hb.G(leak)}
    bonds = ["V -> s -> n", "s -> r", "n -> g"]
    current = float(-350 * Fraction(leak) / (1 + Fraction(leak)))
    for m in in_orders(parts, bonds, 6):
        run = hb.simulate(m, 1.0)
        for name in ("V.f", "r.f", "g.f"):
            assert run[name].at(0.5) == pytest.approx(current, rel=4e-16, abs=0.0)


def test_what_flows_between_levels_that_are_nearly_one() -> None:
    """A capacitor on a source by a gear and half a milliohm: a millionth of the voltage drives."""
    n, c, r, g = -3.47, 0.00246, 0.000497, 0.00437
    parts = {
        **{"V": hb.Se("-0.417*sin(1.34*time)"), "gear": hb.TF(n), "r": hb.R(r), "g": hb.G(g)},
        **{"c": hb.C(c), "a": hb.Zero(), "s": hb.One(), "b": hb.Zero()},
    }
    bonds = ["a -> V", "a -> gear.2", "gear.1 -> s", "b -> s", "s -> r", "c -> b", "g -> b"]
    for m in in_orders(parts, bonds, 4):
        run = hb.simulate(m, 1.9)
        times = [0.31, 0.77, 1.47]
        e, v, f = (run[name].at(times) for name in ("c.e", "V.e", "r.f"))
        assert f * r == pytest.approx(e + n * v, rel=1e-8)
        assert (abs(f * r) < 1e-4 * abs(e)).all()
        # laws and sums hold of what is shown, though each is a difference of its own
        back, force, stored, leaked = (run[name].at(times) for name in ("V.f", "r.e", "c.f", "g.f"))
        assert back == pytest.approx(-n * f, rel=1e-15, abs=0.0)
        assert force == pytest.approx(r * f, rel=1e-15, abs=0.0)
        assert stored + leaked == pytest.approx(f, rel=1e-14, abs=0.0)


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
def test_a_driven_mass_has_its_force_beside_a_far_larger_spring(solver: str) -> None:
    """The spring's 1e29 N go into the source, not into what the mass is accelerated by."""
    run = hb.simulate(driven(), 0.159, solver=solver)
    # the source reads the momentum m v of the mass that it moves: v = -1.76 (1 - tanh(v/s)/2)
    s = 0.08898745652530352 / (0.157 + 0.0185)
    v = -2.6
    for _ in range(100):
        v = -1.76 * (1.0 - 0.5 * math.tanh(v / s))
    assert run["c.q"].at(0.159) == pytest.approx(-v * 0.159, rel=1e-7)
    assert abs(run["c.e"].at(0.159)) > 1e28


def driven() -> hb.Model:
    m = hb.Model("driven")
    m.add(j=hb.One(), c=hb.C({"e": "0.238*sinh(q/0.00595)"}), g=hb.G(0.01715))
    m.add(i=hb.I([[0.157, 0.0185], [0.0185, 0.0163]], p=[-0.08898745652530352, 0.001205]))
    m.add(s=hb.Sf("-1.76*(1 - 0.5*tanh(i.1.p/0.08898745652530352))"))
    m.bond("j -> i.2", "j -> s", "j -> i.1", "j -> g", "c -> j")
    return m


@pytest.mark.parametrize(
    "seed",
    [
        3053760,
        3120253,
        2022233,
    ],
)
def test_power_balances_to_its_last_digits(seed: int) -> None:
    recipe = random_recipe(seed)
    audit = hb.simulate(recipe.model(), recipe.until).audit()
    assert audit.power < 1e-15
    assert audit.holds()


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("leak", [1e7, 1e10, 1e13, 1e15])
def test_capacitors_that_are_joined_leak_however_little(leak: float, turned: bool) -> None:
    """Beside a milliohm, in parallel to what joins them, the leak is down to 1e-18 of the terms."""
    parts = {"C1": hb.C("1 nF", e="1 V"), "C2": hb.C("1 nF", e="1 V"), "R": hb.R(leak)}
    parts |= {"n1": hb.Zero(), "n2": hb.Zero(), "b": hb.One(), "x": hb.One(), "r": hb.R(1e-3)}
    ways = ["n2 -> b -> n1", "n2 -> x -> n1"] if turned else ["n1 -> b -> n2", "n1 -> x -> n2"]
    until = 0.1e-9 * leak
    for m in in_orders(parts, ["n1 -> C1", "n2 -> C2", "n1 -> R", "x -> r", *ways], 3):
        run = hb.simulate(m, until)
        assert run["C1.e"].at(until) == pytest.approx(math.exp(-0.05), rel=1e-14)
        assert run.audit().power < 1e-15
