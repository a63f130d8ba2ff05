"""Diodes beside a switch that slides: each of the modes combined has its own branches.

What holds of a diode while the switch is closed, and while it is open, is not what holds of the
averages of both: where the motion leaves the surface, an average is zero.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import hybond as hb

TIGHT: dict[str, Any] = {"rtol": 1e-11, "atol": 1e-13, "dense_output": True}


def coil(m: hb.Model, L: float, start: float, turned: bool) -> None:
    m.add(L=hb.I(L, f=-start if turned else start))
    m.bond("L -> j" if turned else "j -> L")


def held_to(m: hb.Model, reference: str, start: str) -> None:
    """Let the switch keep the current of the coil at a reference, without a band."""
    m.signal(asked=reference)
    m.machine(
        "Q",
        states={"on": ["hi"], "off": []},
        start=start,
        rules=["on -> off when j.f > asked", "off -> on when j.f < asked"],
    )


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("start", "i0"), [("off", 4.0), ("on", 0.5)])
@pytest.mark.parametrize(("R", "L", "w"), [(3.0, 1e-4, 1e3), (3.0, 1e-4, 2e4), (20.0, 0.1, 30.0)])
def test_current_of_a_chopper_that_falls_behind_its_reference(
    R: float, L: float, w: float, start: str, i0: float, turned: bool, solver: str
) -> None:
    m = hb.Model("chopper", domain="electrical")
    m.add(V=hb.Se(150.0), hi=hb.One(), n=hb.Zero(), j=hb.One(), R=hb.R(R), d=hb.One(law="diode"))
    m.bond("d -> n", "V -> hi -> n", "n -> j -> R")
    coil(m, L, i0, turned)
    held_to(m, f"2*cos({w!r}*time)", start)
    until = 2.5 / w
    run = hb.simulate(m, until=until, solver=solver)
    assert run.status == "ok"
    assert run.audit().holds()
    # up, or down, to the reference; along it until that falls faster than the current can
    level = 150.0 / R if start == "on" else 0.0

    def free(t: float, i: float, to: float) -> float:
        return float(to + (i - to) * np.exp(-R * t / L))

    met = brentq(lambda t: free(t, i0, level) - 2 * np.cos(w * t), 0, 1.2 / w, xtol=1e-18)
    left = brentq(lambda t: -2 * w * np.sin(w * t) + R / L * 2 * np.cos(w * t), met, 1.57 / w)
    held = 2 * np.cos(w * left)
    for t in np.linspace(0, until, 200):
        if t < met:
            expected = free(t, i0, level)
        else:
            expected = 2 * np.cos(w * t) if t < left else free(t - left, held, 0.0)
        assert run["j.f"].at(t) == pytest.approx(expected, abs=2e-7)
    # the current that is left comes to rounding of zero at last, which may be an event of the diode
    assert len(run.events) in (3, 4)
    assert run.events[2].t == pytest.approx(left, rel=1e-6)


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("start", ["off", "on"])
@pytest.mark.parametrize(("L", "C", "T"), [(1e-4, 2e-4, 1e-3), (5e-3, 5e-4, 1e-2)])
def test_boost_whose_reference_falls_too_fast(
    L: float, C: float, T: float, start: str, turned: bool, solver: str
) -> None:
    V, R = 24.0, 10.0
    i0 = 12.0 if start == "off" else 7.0
    drop = (26 * T / L) ** 2 / 6
    m = hb.Model("boost", domain="electrical")
    m.add(V=hb.Se(V), j=hb.One(), n=hb.Zero(), hi=hb.One(), d=hb.One(law="diode"), o=hb.Zero())
    m.add(C=hb.C(C, e=50.0), R=hb.R(R))
    m.bond("n -> d -> o", "V -> j -> n", "n -> hi", "o -> R", "C -> o" if turned else "o -> C")
    coil(m, L, i0, turned)
    # parabola: from 10 A with a fall that begins at rest
    held_to(m, f"10 - {drop!r}/2*(time/{T!r})^2", start)

    def asked(t: float) -> float:
        return 10 - drop / 2 * (t / T) ** 2

    def off(_: float, x: Any) -> list[float]:
        return [(V - x[1]) / L, (x[0] - x[1] / R) / C]

    def on(_: float, x: Any) -> list[float]:
        return [V / L, -x[1] / R / C]

    def along(t: float, x: Any) -> list[float]:
        # what the coil is given beside V is the part of the time in which the diode conducts
        part = (V + L * drop * t / T**2) / x[1]
        return [-drop * t / T**2, (part * x[0] - x[1] / R) / C]

    def meets(t: float, x: Any) -> float:
        return float(x[0] - asked(t))

    def leaves(t: float, x: Any) -> float:
        return float(V + L * drop * t / T**2 - x[1])

    def empty(_: float, x: Any) -> float:
        return float(x[0])

    for f in (meets, leaves, empty):
        setattr(f, "terminal", True)  # noqa: B010
    how = {**TIGHT, "max_step": T / 1000}
    first = solve_ivp(
        on if start == "on" else off, (0, T), [i0, 50.0], "DOP853", events=meets, **how
    )
    second = solve_ivp(along, (first.t[-1], T), first.y[:, -1], "DOP853", events=leaves, **how)
    third = solve_ivp(off, (second.t[-1], T), second.y[:, -1], "DOP853", events=empty, **how)
    assert first.status == second.status == third.status == 1
    until = third.t[-1] * (1 - 1e-9)
    run = hb.simulate(m, until=until, solver=solver)
    assert run.status == "ok"
    assert run.audit().holds()
    for s in (first, second, third):
        t = np.linspace(s.t[0], s.t[-1], 42)[1:-1]
        expected = s.sol(t)
        assert np.allclose(run["j.f"].at(list(t)), expected[0], rtol=0, atol=1e-6)
        assert np.allclose(run["o.e"].at(list(t)), expected[1], rtol=0, atol=5e-6)
    assert run.events[-1].t == pytest.approx(second.t[-1], rel=1e-6)
