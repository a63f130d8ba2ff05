"""Laws that rest within their jump, beside laws that are flat: in any order of declaration.

What drives is less than the jump holds, so nothing flows, or no effort is left; closed forms.
"""

from __future__ import annotations

import math

import pytest
from in_orders import in_orders

import hybond as hb
from hybond.errors import HybondError


@pytest.mark.parametrize("drive", [0.7, 1.3])
def test_a_valve_that_is_shut_takes_what_friction_leaves(drive: float) -> None:
    """In one loop: the valve lets no flow through, and `sign(0)` is zero."""
    parts = {
        **{"V": hb.Se(-drive), "j": hb.One(), "r": hb.R(2.0)},
        **{"valve": hb.R({"f": "if e > 0 then 0.75*e else 0"}), "k": hb.R({"f": "1.5*sign(e)"})},
    }
    bonds = ["V -> j", "j -> r", "j -> valve", "j -> k"]
    for m in in_orders(parts, bonds):
        run = hb.simulate(m, 1.0)
        assert run["valve.f"].at(0.5) == 0.0
        assert run["k.e"].at(0.5) == 0.0
        assert run["valve.e"].at(0.5) == pytest.approx(-drive, rel=1e-12)


def test_the_same_with_efforts_and_flows_exchanged() -> None:
    parts = {
        **{"F": hb.Sf(-0.8), "n": hb.Zero(), "g": hb.G(2.0)},
        **{"valve": hb.R({"e": "if f > 0 then 0.75*f else 0"}), "k": hb.R({"e": "1.5*sign(f)"})},
    }
    for m in in_orders(parts, ["F -> n", "n -> g", "n -> valve", "n -> k"]):
        run = hb.simulate(m, 1.0)
        assert run["k.f"].at(0.5) == 0.0
        assert run["valve.f"].at(0.5) == pytest.approx(-0.8, rel=1e-12)


def test_two_chains_between_the_same_nodes() -> None:
    """Two bonds between two junctions leave open which of them carries the effort."""
    parts = {
        **{"V": hb.Se(-0.7), "a": hb.One(), "b": hb.One(), "r": hb.R(2.0)},
        **{"valve": hb.R({"f": "if e > 0 then 0.75*e else 0"}), "k": hb.R({"f": "1.5*sign(e)"})},
    }
    for m in in_orders(parts, ["V -> b", "b -> r", "a -> valve", "a -> k", "b -> a", "b -> a"]):
        run = hb.simulate(m, 1.0)
        assert run["k.e"].at(0.5) == 0.0
        assert run["valve.e"].at(0.5) == pytest.approx(-0.7, rel=1e-12)


@pytest.mark.slow
def test_sources_that_part_are_said_to_whatever_friction_does_there() -> None:
    """Flows of a gear's two sides that agree at the start alone."""
    parts = {
        **{"a": hb.One(), "b": hb.One(), "gear": hb.TF(1.71), "k": hb.R({"f": "0.7*sign(e)"})},
        **{"d": hb.R({"e": "1.3*sign(f)"}), "m": hb.I(1.17), "c": hb.C(1.95), "l": hb.C(1.07)},
        **{"F": hb.Sf("0.67*sin(1.76*time)"), "G": hb.Sf("-0.93*sin(2.08*time)")},
    }
    bonds = ["b -> m", "b -> d", "k -> a", "b -> c", "F -> b", "a -> b", "a -> G"]
    bonds += ["a -> gear.2", "l -> a", "b -> gear.1"]
    for m in in_orders(parts, bonds, 4):
        with pytest.raises(HybondError) as found:
            hb.simulate(m, 1.5)
        assert found.value.code == "HB-C101"


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_a_flow_that_a_source_is_part_of_is_held_in_any_order(solver: str) -> None:
    """The valve takes all that the source gives: what is left for friction is nothing.

    That is the difference of two flows, of which one is known.
    """
    parts = {
        **{"F": hb.Sf("0.951*sin(0.791*time)"), "n": hb.Zero(), "j": hb.One()},
        **{"valve": hb.R({"e": "if f > 0 then 46.6*f else 0"}), "k": hb.R({"e": "1.01*sign(f)"})},
        **{"g": hb.G(192.2), "i": hb.I(0.0023)},
    }
    bonds = ["n -> j", "n -> F", "i -> n", "g -> j", "j -> k", "valve -> n"]
    for m in in_orders(parts, bonds):
        run = hb.simulate(m, 0.031, solver=solver)
        assert run["k.f"].at(0.03) == 0.0
        assert run["i.p"].at(0.03) == 0.0
        valve = math.fabs(run["valve.f"].at(0.03))
        assert valve == pytest.approx(0.951 * math.sin(0.791 * 0.03), rel=1e-12)
