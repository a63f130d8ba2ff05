"""Steps of time-stepping that Newton's method solves, and did not: HB-N310 where nothing grows.

Oracles: located events; a closed form of what friction holds.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb


def way(one: str, other: str, *, turned: bool) -> str:
    return f"{other} -> {one}" if turned else f"{one} -> {other}"


def levers(spring: str, first: str, second: str, *, turned: bool) -> hb.Model:
    """Three masses: a spring behind an arm pushes the second one, whose own arm moves the third."""
    m = hb.Model("levers", domain="translational")
    friction = {"": {}, "2": {"law": "coulomb", "limit": "2 N"}}
    friction["5"] = {"law": "coulomb", "limit": "5 N", "breakaway": "7.5 N"}
    m.add(F=hb.Se("if time < 0.5 s then 12 N else -3 N"))
    for k, law in enumerate((spring, first, second)):
        m.add(**{f"v{k}": hb.One(**friction[law]), f"m{k}": hb.I((2.0, 0.5, 2.0)[k])})
        m.bond(way(f"v{k}", f"m{k}", turned=turned))
    m.add(t0=hb.TF("sin(2*x0/(1 m))"), t1=hb.TF("sin(2*x1/(1 m))"), z=hb.Zero(), c=hb.C(0.01))
    m.bond("F -> v0", "v0 -> t0 -> z -> v1", "v1 -> t1 -> v2", way("z", "c", turned=turned))
    m.signal(x0=hb.Integral("v0.f"), x1=hb.Integral("v1.f"))
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("theta", [0.5, 1.0])
@pytest.mark.parametrize("laws", [("", "5", "5"), ("5", "", "2"), ("2", "5", "2")])
def test_friction_behind_a_lever_without_an_arm_is_no_reason_to_refuse(
    laws: tuple[str, str, str], theta: float, turned: bool
) -> None:
    """The arm is as good as none: what friction behind it gives was looked for in rounding."""
    model = levers(*laws, turned=turned)
    run = hb.simulate(model, 0.25, solver="moreau-jean", step=0.01, theta=theta)
    right = hb.simulate(model, 0.25)
    t = np.linspace(0.05, 0.25, 5)
    for name in ("x0", "x1"):
        assert run[name].at(t) == pytest.approx(right[name].at(t), abs=0.01)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("arm", "start"), [(1.11, -3.96), (1.2, -3.96), (-1.11, 3.96)])
def test_a_flow_through_a_square_is_found_though_newton_goes_to_and_fro(
    arm: float, start: float, turned: bool
) -> None:
    """Friction takes up what a mass drives against it: nothing moves, and ``p`` is what it was."""
    m = hb.Model("square")
    m.add(a=hb.One(law="coulomb", limit=2.4, breakaway=3.6), b=hb.Zero(law="coulomb", limit=0.202))
    m.add(r=hb.R({"e": "1.26*(f/0.389)*abs(f/0.389)"}), g=hb.G(0.877), s=hb.Se(0.492))
    m.add(i=hb.I({"f": "0.213*sinh(p/9.75)"}, p=start), t=hb.TF(arm), u=hb.TF(2.1))
    m.bond("a -> b", "t.2 -> b", "t.1 -> a", "u.1 -> a", "s -> u.2")
    m.bond(way("b", "i", turned=turned), way("b", "g", turned=turned), way("a", "r", turned=turned))
    run = hb.simulate(m, 0.1, solver="moreau-jean", step=0.01)
    assert run.final["i.p"] == pytest.approx(start, rel=1e-12)
    flow = 0.213 * math.sinh(start / 9.75)
    assert run.final["i.f"] == pytest.approx(-flow if turned else flow, rel=1e-12)
