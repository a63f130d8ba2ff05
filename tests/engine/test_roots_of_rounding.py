"""Laws that read a zero: whichever is declared first, what they read has not the sign of rounding.

Each model is run with its bonds in several orders; the oracle is a closed form.
"""

from __future__ import annotations

import itertools
import math

import pytest
from in_orders import in_orders

import hybond as hb


@pytest.mark.parametrize("law", ["0.85*sign(f)", "0.85*sign(f)*sqrt(abs(f))", "0.85*f*abs(f)"])
def test_a_law_at_a_node_that_gears_hold_at_zero_is_at_rest(law: str) -> None:
    """Two gears of different ratios between two nodes: no effort, so no flow of any resistor."""
    parts = {
        "a": hb.Zero(),
        "b": hb.Zero(),
        "t": hb.TF(-1.19),
        "u": hb.TF(0.779),
        "r": hb.R({"e": law}),
        "g": hb.R({"f": "1.4*max(-1, min(1, e/1.08))"}),
        "i": hb.I(0.937, p=-0.42),
        "k": hb.I(1.44, p=-0.777),
    }
    bonds = ["a -> t -> b", "a -> u -> b", "a -> r", "g -> b", "i -> a", "k -> b"]
    for m in in_orders(parts, bonds):
        run = hb.simulate(m, "1 s")
        assert run["i.p"].at(1.0) == -0.42 and run["k.p"].at(1.0) == -0.777
        assert run["r.f"].at(0.5) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("height", [8.85, 1e3, 1e-3])
def test_a_source_that_begins_at_zero_charges_beside_a_one_sided_law(height: float) -> None:
    """``C e' + e (1/R + 1/S) = a t`` from zero, both resistors conducting."""
    parts = {
        "n": hb.Zero(),
        "c": hb.C(0.5),
        "g": hb.R({"f": "3.0*tanh(e/1e6)"}),
        "r": hb.R({"e": f"if f > 0 then {height}*f else 0"}),
        "s": hb.Sf("0.79*time"),
    }
    bonds = ["n -> c", "n -> g", "n -> r", "s -> n"]
    tau = 0.5 / (1.0 / height + 3e-6)
    exact = 0.79 * tau / 0.5 * (1.0 - tau * (1.0 - math.exp(-1.0 / tau)))
    for m in in_orders(parts, bonds):
        assert hb.simulate(m, 1.0)["c.e"].at(1.0) == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("effort", [1e-44, -1e-30, 1e-10, 1.0])
def test_a_root_and_a_square_beside_each_other_give_what_a_small_effort_asks(
    effort: float, turned: bool
) -> None:
    """``e = 1.27 (f/1.19)^2`` and ``e = 0.756 sqrt(f/1.68)``, each solved for its flow."""
    square, root = "1.27*(f/1.19)*abs(f/1.19)", "0.756*sign(f)*sqrt(abs(f)/1.68)"
    for first, last in itertools.permutations([("a", square), ("b", root)]):
        m = hb.Model("beside")
        m.add(s=hb.Se(effort), n=hb.Zero())
        m.add(**{name: hb.R({"e": law}) for name, law in (first, last)})
        m.bond("s -> n -> a", "b -> n" if turned else "n -> b")
        run = hb.simulate(m, 1.0)
        way = 1.0 if effort > 0.0 else -1.0
        of_square = way * 1.19 * (abs(effort) / 1.27) ** 0.5
        of_root = way * 1.68 * (effort / 0.756) ** 2 * (-1.0 if turned else 1.0)
        assert run["a.f"].at(0.5) == pytest.approx(of_square, rel=1e-9, abs=0.0)
        assert run["b.f"].at(0.5) == pytest.approx(of_root, rel=1e-9, abs=0.0)


@pytest.mark.parametrize("ratio", [1.0, 1e3, 1e7])
def test_tied_capacitors_at_a_source_that_has_saturated_stay_where_it_holds_them(
    ratio: float,
) -> None:
    """``e = -0.615`` for ever: all that a coil brings goes into the source."""
    parts = {
        "n": hb.Zero(),
        "a": hb.C(2.0, q=-1.23),
        "b": hb.C(7e-4, q=-0.615 * 7e-4),
        "c": hb.C(7e-4 * ratio, q=-0.615 * 7e-4 * ratio),
        "s": hb.Se("-0.41*(1 - 0.5*tanh(a.q/0.0144))"),
        "i": hb.I(0.33, p=-27.0),
    }
    for m in in_orders(parts, ["n -> a", "n -> b", "n -> c", "n -> s", "i -> n"]):
        run = hb.simulate(m, "0.5 s")
        assert run["i.p"].at(0.5) == pytest.approx(-27.0 - 0.5 * 0.615, rel=1e-9)
        assert run["c.q"].at(0.5) == pytest.approx(-0.615 * 7e-4 * ratio, rel=1e-9)
