"""Junction laws at an instant: which is declared or named first must not decide anything."""

from __future__ import annotations

import itertools
import math

import pytest
from scipy.optimize import brentq

import hybond as hb


def both(parts: dict[str, object], bonds: list[str]) -> list[hb.Model]:
    """The same graph declared forwards and backwards, with names in either order."""
    made = []
    for turned, mark in itertools.product((False, True), ("a", "z")):
        m = hb.Model("orders")
        names = {name: f"{mark}_{name}" if name[0] == "x" else name for name in parts}
        for name in sorted(parts, reverse=turned):
            m.add(**{names[name]: parts[name]})
        for chain in sorted(bonds, reverse=turned):
            m.bond(" -> ".join(names.get(n, n) for n in chain.split(" -> ")))
        made.append(m)
    return made


@pytest.mark.parametrize("ratio", [-1.71, -1.0, -0.3])
@pytest.mark.parametrize("restitution", [None, 0.0, 0.5])
def test_a_contact_and_a_diode_that_bar_both_signs_empty_what_they_hold(
    ratio: float, restitution: float | None
) -> None:
    """An effort may not be below zero, nor above by a gear: it is zero, and no speed rebounds."""
    more = {} if restitution is None else {"restitution": restitution}
    parts = {
        "node": hb.Zero(),
        "xd": hb.Zero(law="diode"),
        "xc": hb.Zero(law="unilateral", **more),
        "t": hb.TF(ratio),
        "c": hb.C(1.8, q=0.438),
        "k": hb.C(0.96, q=-1.18),
        "g": hb.G(1.96),
    }
    for m in both(parts, ["node -> k", "xc -> node", "node -> t -> xd", "xd -> c", "g -> xd"]):
        run = hb.simulate(m, "0.5 s")
        for t in (0.0, 0.3):
            for name in ("c.q", "k.q"):
                assert run[name].at(t, side="right") == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("push", [20.0, 11.0, 5.0])
@pytest.mark.parametrize("law", ["relay", "coulomb"])
def test_friction_behind_a_diode_lets_a_stored_effort_jump_to_its_limit(
    law: str, push: float
) -> None:
    """Two capacitors push more than friction bears: charge flows until they push as much."""
    parts = {
        "xf": hb.One(law=law, limit=4.25),
        "xd": hb.One(law="diode"),
        "c": hb.C(0.002, q=0.002 * push),
        "k": hb.C(0.004),
        "s": hb.Se(1.0),
    }
    for m in both(parts, ["c -> xd -> xf", "xd -> k", "xd -> s"]):
        # of q that flows: push - q/0.002 - q/0.004 - 1 = 4.25, if that is above zero
        q = max(0.0, (push - 5.25) / 750.0)
        run = hb.simulate(m, "1 s")
        assert run["k.q"].at(0.5) == pytest.approx(q, rel=1e-9, abs=1e-15)
        assert run["c.q"].at(0.5) == pytest.approx(0.002 * push - q, rel=1e-9)


@pytest.mark.parametrize("light", [4e-5, 1e-9, 1.0])
def test_a_light_capacitor_beside_a_heavy_one_makes_no_large_rounding(light: float) -> None:
    """A node that a current empties is held at zero by a diode, at ``t = C e / i``."""
    parts = {
        "xn": hb.Zero(law="diode"),
        "a_light": hb.C(light, q=light),
        "b_heavy": hb.C(178.0, q=178.0),
        "c_light": hb.C(light, q=light),
        "s": hb.Sf(100.0),
    }
    for m in both(parts, ["xn -> a_light", "xn -> b_heavy", "xn -> c_light", "xn -> s"]):
        run = hb.simulate(m, "4 s")
        empty = (178.0 + 2.0 * light) / 100.0
        assert run.events[-1].t == pytest.approx(empty, rel=1e-9)
        assert run["b_heavy.q"].at(3.9) == 0.0


@pytest.mark.parametrize("before", [0.0, "plain"])
@pytest.mark.parametrize(("limit", "rebound"), [(1.13, 0.5), (0.5, 0.5), (0.5, None)])
@pytest.mark.parametrize("dual", [False, True])
def test_friction_that_holds_a_load_is_not_moved_by_the_rebound_of_a_contact(
    dual: bool, limit: float, rebound: float | None, before: float | str
) -> None:
    """A contact in line with it might rebound, and feels nothing of what friction bears.

    Springs push with 0.762. What friction does not hold moves them until it does, in an impulse.
    """
    junction, store = (hb.Zero, hb.I) if dual else (hb.One, hb.C)
    x, y = ("p", "f") if dual else ("q", "e")
    way = -1.0 if dual else 1.0
    parts = {
        "xa": junction(law="coulomb", limit=limit),
        "xb": junction() if before == "plain" else junction(law="unilateral", restitution=before),
        "xc": junction(law="unilateral", **({} if rebound is None else {"restitution": rebound})),
        "c": store({y: f"1.4*sinh({x}/1.22)"}, **{x: 1.2 * way}),
        "k": store(1.0, **{x: -0.85 * way}),
    }
    moved = 0.0
    if limit < 1.0:
        moved = brentq(lambda d: 1.4 * math.sinh((1.2 - d) / 1.22) - 0.85 - d - limit, 0.0, 1.0)
    for order in itertools.permutations(("xa", "xb", "xc")):
        names = dict(zip(("xa", "xb", "xc"), order, strict=True))
        m = hb.Model("orders")
        m.add(**{names.get(name, name): part for name, part in parts.items()})
        for chain in ("xa -> xb", "xa -> xc", "k -> xb", "c -> xa"):
            m.bond(" -> ".join(names.get(n, n) for n in chain.split(" -> ")))
        run = hb.simulate(m, 1.0)
        assert run[f"c.{x}"].at(0.5) == pytest.approx((1.2 - moved) * way, rel=1e-9)
        assert run[f"k.{x}"].at(0.5) == pytest.approx((-0.85 - moved) * way, rel=1e-9)
