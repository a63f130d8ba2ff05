"""Laws like a root, whose effort and flow pass through zero together, in units of any size.

The largest of the unknowns says how small a step of Newton's method is. Where all of them pass
through zero at once none does, and laws that held to the last digit had "no common solution".
"""

from __future__ import annotations

import functools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import hybond as hb

TIMES = np.linspace(0.1, 2.0, 9)
ROOTS = {
    "square": "0.847*sign(E)*sqrt(abs(E))",
    "cube": "0.9*sign(E)*abs(E)^(1/3)",
    "power": "0.8*sign(E)*abs(E)^0.4",
}


def network(name: str, s: float, turned: bool) -> np.ndarray:
    """Return charge, momentum and way of a run whose efforts are `s` times as large."""
    law, bend = ROOTS[name].replace("E", f"(e/{s})"), f"1.935*(e/{s})/((e/{s})^2 + 1e-4)^0.25"
    m = hb.Model("network")
    m.add(c=hb.C(1.394 / s, e=1.044 * s), n0=hb.Zero(), n1=hb.Zero(), n2=hb.Zero())
    m.add(q2=hb.One(), r2=hb.R(0.624 * s), r4=hb.R(0.47 * s), q5=hb.One(), r5=hb.R({"f": law}))
    m.add(q6=hb.One(), r6=hb.R({"f": bend}), A=hb.TF(0.656), v=hb.One())
    m.add(M=hb.I(0.342 * s), k=hb.C(0.962 / s))
    m.bond("n2 -> c", "n0 -> q2 -> n2", "q2 -> r2", "n1 -> r4", "n0 -> A -> v -> M", "v -> k")
    if turned:
        m.bond("n1 -> q5 -> n2", "r5 -> q5", "n0 -> q6 -> n1", "r6 -> q6")
    else:
        m.bond("n2 -> q5 -> n1", "q5 -> r5", "n1 -> q6 -> n0", "q6 -> r6")
    run = hb.simulate(m, 2.0)
    assert run.audit().holds() and not run.warnings
    return np.array([run["c.q"].at(TIMES), run["M.p"].at(TIMES) / s, run["k.q"].at(TIMES)])


@functools.cache
def large(name: str) -> np.ndarray:
    """Return the run in units in which efforts are about one."""
    return network(name, 1.0, False)


def test_a_root_passes_zero_beside_an_orifice() -> None:
    """By two bisections, one in the other, and a general solver."""

    def efforts(e: float, v: float) -> tuple[float, float]:
        def root(x: float) -> float:
            return math.copysign(0.847 * math.sqrt(abs(x)), x)

        def orifice(x: float) -> float:
            return 1.935 * x / (x * x + 1e-4) ** 0.25

        def beside(e0: float) -> float:
            return brentq(lambda x: root(e - x) - x / 0.47 - orifice(x - e0), -5, 5, xtol=1e-10)

        def misses(e0: float) -> float:
            return orifice(beside(e0) - e0) - (e0 - e) / 0.624 - v / 0.656

        e0 = brentq(misses, -5, 5, xtol=1e-9)
        return e0, (e0 - e) / 0.624 - root(e - beside(e0))

    def rates(t: float, y: np.ndarray) -> list[float]:
        v = y[1] / 0.342
        e0, flow = efforts(y[0] / 1.394, v)
        return [flow, e0 / 0.656 - y[2] / 0.962, v]

    start = [1.394 * 1.044, 0.0, 0.0]
    found = solve_ivp(rates, (0, 2), start, t_eval=TIMES, rtol=1e-4, atol=1e-5)
    np.testing.assert_allclose(large("square"), found.y, atol=1e-3)


@pytest.mark.parametrize(
    ("name", "size", "turned"),
    [
        ("square", 1e-5, False),
        ("square", 1e-7, True),
        ("cube", 1e-7, False),
        ("cube", 1e-2, True),
        ("power", 1e6, False),
        ("power", 1e-5, True),
    ],
)
def test_it_does_so_in_units_of_any_size(name: str, size: float, turned: bool) -> None:
    np.testing.assert_allclose(network(name, size, turned), large(name), atol=1e-7)


@pytest.mark.parametrize("bridge", [False, True])
@pytest.mark.parametrize(
    ("power", "size", "solver", "turned"),
    [(0.5, 1e-6, "auto", False), (0.5, 1e-15, "auto", True), (0.6, 1e-9, "radau", False)],
)
def test_an_orifice_carries_nothing_beside_others_in_units_of_any_size(
    power: float, size: float, solver: str, turned: bool, bridge: bool
) -> None:
    """Three alike meet in a node, or four are a bridge about one: one has no pressure over it."""
    m = hb.Model("node")
    m.add(V=hb.Se("sin(2*pi*time)"), G=hb.Se(0.0), n=hb.Zero())
    for k in "abcd" if bridge else "abc":
        m.add(**{k: hb.One(), f"r{k}": hb.R({"f": f"{size}*sign(e)*abs(e)^{power}"})})
        m.bond(f"r{k} -> {k}" if turned else f"{k} -> r{k}")
    if bridge:
        m.add(v=hb.Zero(), g=hb.Zero(), q=hb.Zero(), x=hb.One(), rx=hb.R({"f": f"{size}*e"}))
        m.bond("V -> v", "g -> G", "v -> a -> n", "n -> b -> g", "v -> c -> q", "q -> d -> g")
        m.bond("n -> x -> q", "rx -> x" if turned else "x -> rx")
    else:
        m.add(H=hb.Se("0.5*sin(2*pi*time)"))
        m.bond("V -> a -> n", "n -> b -> G", "n -> c -> H")
    run = hb.simulate(m, 0.5, solver=solver)
    times = 0.013 + 0.0251 * np.arange(19)
    halves = 0.5 * np.sin(2.0 * math.pi * times)
    np.testing.assert_allclose(run["n.e"].at(times), halves, atol=1e-12)
    np.testing.assert_allclose(run["b.f"].at(times), size * halves**power, rtol=1e-9)
