"""Gas laws written as what a gauge shows: differences of pressures, with the last digits of those.

A piston between two volumes that leak into each other comes to rest where both are at the pressure
of the air. What the leak takes the root of is rounding there, of 1e5 Pa, and sends no flow.
"""

from __future__ import annotations

import math

import pytest
from scipy.integrate import solve_ivp

import hybond as hb

P, V, A, M, B, F, K = 1e5, 1e-3, 1e-3, 2.0, 50.0, 20.0, 1e-7
LAWS = {"in full": f"{P} - {P}*({V}/q)^1.4", "in front": f"{P}*(1 - ({V}/q)^1.4)"}


def gauge(v: float) -> float:
    return P - P * (V / v) ** 1.4


def rates(t: float, y: list[float]) -> list[float]:
    p, g, h = y
    leak = gauge(g) - gauge(h)
    flow = K * math.copysign(math.sqrt(abs(leak)), leak)
    push = (F if t < 1.0 else 0.0) - B * p / M - A * gauge(g) + A * gauge(h)
    return [push, A * p / M - flow, flow - A * p / M]


def cylinder(law: str, *, turned: bool) -> hb.Model:
    m = hb.Model("cylinder")
    m.add(G=hb.C({"e": LAWS[law]}, q=V), H=hb.C({"e": LAWS[law]}, q=V), mass=hb.I(M), v=hb.One())
    m.add(P=hb.TF(A), Q=hb.TF(1 / A), n=hb.Zero(), k=hb.Zero(), damper=hb.R(B), past=hb.One())
    m.add(push=hb.Se(f"if time < 1 then {F} else 0"))
    m.add(leak=hb.R({"f": f"{K}*sign(e)*sqrt(abs(e))"}))
    m.bond("push -> v -> mass", "v -> damper", "v -> P -> n -> G", "k -> Q -> v", "k -> H")
    m.bond("past -> leak", *(["k -> past -> n"] if turned else ["n -> past -> k"]))
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("law", list(LAWS))
def test_a_piston_that_leaks_comes_to_rest_at_no_gauge_pressure(law: str, turned: bool) -> None:
    run = hb.simulate(cylinder(law, turned=turned), until=10.0, max_steps=5000)
    for t in (0.5, 1.1):
        first = solve_ivp(rates, (0, min(t, 1.0)), [0, V, V], "LSODA", rtol=1e-9, atol=1e-13)
        last = first.y[:, -1]
        if t > 1.0:
            last = solve_ivp(rates, (1.0, t), last, "LSODA", rtol=1e-9, atol=1e-13).y[:, -1]
        assert run["mass.p"].at(t) == pytest.approx(last[0], abs=1e-6)
        assert run["G.q"].at(t) == pytest.approx(last[1], rel=1e-7)
    assert run["G.q"].at(10.0) == pytest.approx(V, rel=1e-12)
    assert run["H.q"].at(10.0) == pytest.approx(V, rel=1e-12)
    assert abs(float(run["mass.p"].at(10.0))) < 1e-12
    assert run.audit().holds()
