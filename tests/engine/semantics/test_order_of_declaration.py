"""Which element is declared first decides nothing: not what holds, nor whether there is an answer.

Oracles: closed forms, the matrix exponential, a root by bracketing; the same outcome in all orders.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

import hybond as hb

Parts = dict[str, object]


def orders(parts: Parts, bonds: list[str]) -> list[hb.Model]:
    """The model begun with each of its elements, forwards and backwards in turn."""
    names = list(parts)
    made = []
    for k in range(len(names)):
        way = 1 if k % 2 == 0 else -1
        m = hb.Model("ordered")
        for name in (names[k:] + names[:k])[::way]:
            m.add(**{name: parts[name]})
        for bond in bonds[::way]:
            m.bond(bond)
        made.append(m)
    return made


HOLDS = {"limit": 1.79, "breakaway": 2.685}
HELD = {
    "node": (hb.Zero, hb.Sf, hb.C, ["s -> n -> b", "n -> c"], "c.q"),
    "turned": (hb.Zero, hb.Sf, hb.C, ["s -> n", "b -> n", "n -> c"], "c.q"),
    "body": (hb.One, hb.Se, hb.I, ["s -> n -> b", "n -> c"], "c.p"),
    "chain": (hb.One, hb.Se, hb.I, ["s -> n -> o -> b", "n -> c"], "c.p"),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("load", [2.159, 2.8])
@pytest.mark.parametrize("shape", HELD)
def test_friction_at_rest_is_not_brought_to_its_limit_by_a_law_that_need_not_carry(
    shape: str, load: float
) -> None:
    """It holds up to its breakaway; beyond, what is left of the load by the limit of sliding."""
    junction, source, storage, bonds, stored = HELD[shape]
    parts: Parts = {
        "n": junction(law="diode"),
        "b": junction(law="coulomb", **HOLDS),
        "c": storage(1.0),
        "s": source(load),
    }
    if shape == "chain":
        parts["o"] = junction(law="diode")
    moved = 0.0 if load < 2.685 else load - 1.79
    for m in orders(parts, bonds):
        assert hb.simulate(m, 1.0)[stored].at(1.0) == pytest.approx(moved, rel=1e-9, abs=1e-15)


FLAT = {"table": [[-2.0, -1.0, 0.0, 1.0, 2.0], [-0.5, -0.5, 0.0, 0.5, 0.5]]}
LIMITED = {"f": FLAT | {"extrapolate": "linear"}}


def test_a_flow_that_a_contact_and_a_mass_both_give_meets_the_end_of_a_law() -> None:
    """A mass runs against a contact that lets nothing through: it stops."""
    parts: Parts = {"j": hb.One(law="unilateral"), "i": hb.I(1.0, p=-814.0), "g": hb.R(LIMITED)}
    for m in orders(parts, ["j -> i", "g -> j"]):
        assert hb.simulate(m, 1.0)["i.p"].at(0.5) == 0.0


@pytest.mark.parametrize("dual", [False, True])
def test_storage_bonded_to_a_law_that_ends_in_flat_pieces_is_let_down_to_it(dual: bool) -> None:
    """What it holds falls to 0.5 at once, and then as ``0.5*exp(-2 t)``."""
    law = {"e": LIMITED["f"]} if dual else LIMITED
    parts: Parts = {"x": hb.C(1.0, q=3.0) if dual else hb.I(1.0, p=3.0), "g": hb.R(law)}
    for m in orders(parts, ["x -> g"]):
        x = hb.simulate(m, 1.0)["x.q" if dual else "x.p"]
        assert x.at(0.0, side="right") == pytest.approx(0.5, rel=1e-12)
        assert x.at(1.0) == pytest.approx(0.5 * math.exp(-2.0), rel=1e-7)


def test_a_junction_that_is_off_gives_a_flow_beside_a_mass() -> None:
    """It holds the mass, whatever a law that ends in flat pieces would let through."""
    parts: Parts = {"i": hb.I(1.0, p=3.0), "v": hb.One(), "g": hb.R(LIMITED)}
    for m in orders(parts, ["i -> v", "v -> g"]):
        m.machine("m", states={"off": [], "on": ["v"]}, start="off")
        assert hb.simulate(m, 1.0)["i.p"].at(0.5) == 0.0


@pytest.mark.parametrize("flow", [0.791, -1.3])
@pytest.mark.parametrize("extra", ["sqrt", "square", "both"])
def test_a_flow_past_the_jump_of_a_law_finds_its_effort(extra: str, flow: float) -> None:
    """Beside laws that are steep or flat at zero; one effort carries the flow."""
    parts: Parts = {
        "n": hb.Zero(),
        "k": hb.Zero(),
        "s": hb.Sf(flow),
        "g": hb.R({"f": "0.73*sign(e)"}),
    }
    bonds = ["s -> n -> k", "n -> g"]
    if extra != "square":
        parts["r"] = hb.R({"f": "1.45*sign(e)*sqrt(abs(e)/1.72)"})
        bonds.append("n -> r")
    if extra != "sqrt":
        parts["q"] = hb.R({"e": "1.77*(f/0.676)*abs(f/0.676)"})
        bonds.append("k -> q")

    def left(e: float) -> float:
        root = 1.45 * math.sqrt(e / 1.72) if extra != "square" else 0.0
        square = 0.676 * math.sqrt(e / 1.77) if extra != "sqrt" else 0.0
        return 0.73 + root + square - abs(flow)

    e = math.copysign(brentq(left, 0.0, 100.0, xtol=1e-300, rtol=1e-14), flow)
    for m in orders(parts, bonds):
        assert hb.simulate(m, 1.0)["n.e"].at(0.5) == pytest.approx(e, rel=1e-9)


@pytest.mark.parametrize("root", [False, True])
def test_what_two_laws_do_to_each_other_by_rounding_is_nothing(root: bool) -> None:
    """A contact whose two ways to a node cancel, beside one that follows what is stored there."""
    parts: Parts = {
        "j0": hb.One(law="unilateral", restitution=0.0),
        "j1": hb.Zero(law="unilateral", restitution=0.5),
        "j2": hb.One(),
        "j3": hb.One(),
        "r": hb.R(0.12130325814536341),
        "c": hb.C(1.0),
        "g": hb.G(1.0),
        "k": hb.C(1.0, q=-0.144),
    }
    bonds = ["j3 -> j0", "k -> j2", "g -> j2", "j1 -> c", "j3 -> j1", "r -> j1", "j1 -> j0"]
    if root:
        # in parallel to r, and no linear graph any more
        parts["h"] = hb.R({"f": "if e > 0 then 0*e else e"})
        bonds.append("j1 -> h")
    a = np.array([[-1.0 / 0.12130325814536341 - 1.0, -1.0], [-1.0, -1.0]])
    c, k = expm(0.4 * a) @ [0.0, -0.144]
    for m in orders(parts, [*bonds, "j1 -> j2"]):
        run = hb.simulate(m, 0.5)
        assert run["c.q"].at(0.4) == pytest.approx(c, rel=1e-6)
        assert run["k.q"].at(0.4) == pytest.approx(k, rel=1e-6)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("modulus", [8.06, 5.0, 3.0])
def test_a_valve_that_shuts_at_a_last_place_shuts_in_every_order(modulus: float) -> None:
    """Settled, its guard misses by a last place what the motion has seen: that is gone past."""
    stiff = {
        "table": [[-0.0798, -0.0399, 0.0, 0.0399, 0.1197], [-768.0, -256.0, 0.0, 256.0, 384.0]]
    }
    parts: Parts = {
        "r0": hb.R({"e": "if f > 0 then 23.2*(f/53.7) else 0"}),
        "c3": hb.C({"e": "0.0352*((q/3.72) + (q/3.72)^3)"}, q=1.82),
        "j3": hb.Zero(),
        "j4": hb.Zero(),
        "s0": hb.Se("31.4*(1 - 0.5*tanh(c2.q))"),
        "c1": hb.C(1.0, q=14.5),
        "j0": hb.One(),
        "t4": hb.GY(modulus),
        "c2": hb.C({"e": stiff | {"extrapolate": "linear"}}),
        "j2": hb.Zero(),
        "c4": hb.C(1.0),
    }
    bonds = ["j2 -> r0", "j3 -> c3", "j3 -> c1", "j4 -> t4.2", "j3 -> j0", "j0 -> j2", "c4 -> j4",
             "t4.1 -> j3", "j4 -> s0", "c2 -> j0"]  # fmt: skip
    ends = []
    for m in orders(parts, bonds):
        run = hb.simulate(m, 0.01)
        ends.append([run[name].at(0.01) for name in ("c1.q", "c2.q", "c3.q")])
    for end in ends[1:]:
        assert end == pytest.approx(ends[0], rel=1e-6, abs=1e-9)
