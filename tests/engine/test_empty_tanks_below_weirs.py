"""Tanks that stand empty until water comes over a weir above them, with outlets by Torricelli.

Steps that reached over the weir's edge saw the empty tank fill, and fall below its bottom, before
there was any water: they ended at its outlet's corner ever nearer to the edge, until HB-N409. Then
the root of next to nothing was taken for a jump that holds the tank (HB-N410).
"""

import functools
import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import hybond as hb

OUTLETS = {
    "max": "{b}*sqrt(max(e, 0)/{g})",
    "if": "(if e > 0 then {b}*sqrt(e/{g}) else 0)",
    "max of both": "{b}*sqrt(max(0, e))/sqrt({g})",
}


def below_a_weir(
    law: str, power: float, b: float = 0.1, *, g: float = 1.0, turned: bool = False
) -> hb.Model:
    """Water rises in the first tank by 0.5 per second; its edge is at 0.5; the second is empty."""
    m = hb.Model("weir")
    outlet = hb.R({"f": OUTLETS[law].format(b=b, g=g)})
    spill = hb.Sf(f"2*max(0, first.e/{g} - 0.5)^{power}")
    first, second = hb.C(1 / g), hb.C(1 / g)
    if turned:
        m.add(o=outlet, second=second, n2=hb.Zero(), spill=spill)
        m.add(first=first, n1=hb.Zero(), feed=hb.Sf(0.5))
        m.bond("second -> n2", "o -> n2", "spill -> n2", "first -> n1", "feed -> n1")
    else:
        m.add(feed=hb.Sf(0.5), n1=hb.Zero(), first=first)
        m.add(spill=spill, n2=hb.Zero(), second=second, o=outlet)
        m.bond("feed -> n1 -> first", "spill -> n2 -> second", "n2 -> o")
    return m


TIMES = np.linspace(1.1, 3.0, 40)


@functools.cache
def by_scipy(power: float, b: float) -> NDArray[np.float64]:
    """From a moment after 1 s, from the balance of inflow and outlet: it forgets where it began."""
    t0 = 1.0 + 1e-4
    begins = (2 * (0.5e-4) ** power / b) ** 2 if power > 1 else 0.0

    def rate(t: float, q: NDArray[np.float64]) -> list[float]:
        return [2 * (0.5 * (t - 1)) ** power - b * math.sqrt(max(q[0], 0))]

    end = float(TIMES[-1])
    run = solve_ivp(rate, [t0, end], [begins], method="Radau", rtol=1e-11, atol=1e-18, t_eval=TIMES)
    return np.asarray(run.y[0])


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("law", OUTLETS)
@pytest.mark.parametrize(("power", "g", "turned"), [(1.5, 9810.0, True), (2, 1.0, False)])
def test_a_tank_below_a_weir_begins_to_fill(
    solver: str, law: str, power: float, g: float, turned: bool
) -> None:
    m = below_a_weir(law, power, g=g, turned=turned)
    run = hb.simulate(m, 3.0, solver=solver, max_steps=1500)
    want = by_scipy(power, 0.1)
    sign = -1 if turned else 1  # stored is counted into the element, flows along the bond
    assert run.status == "ok"
    assert run.audit().holds()
    assert run["second.q"].at(1.0) == pytest.approx(0.0, abs=1e-12)
    assert run["second.e"].at(TIMES.tolist()) / g == pytest.approx(want, rel=1e-6)
    assert run["second.f"].at(3.0) * sign == pytest.approx(2 - 0.1 * math.sqrt(want[-1]), rel=1e-6)


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("law", OUTLETS)
@pytest.mark.parametrize("b", [0.03, 3.0])
def test_what_fills_in_proportion_to_the_square_of_time(solver: str, law: str, b: float) -> None:
    """Inflow s - outflow b*sqrt(q), s since the edge: q = c*s^2 with 2*c = 1 - b*sqrt(c)."""
    run = hb.simulate(below_a_weir(law, 1.0, b), 3.0, solver=solver, max_steps=500)
    root = (math.sqrt(b * b + 8) - b) / 4
    times = np.linspace(1.02, 3.0, 40)
    assert run.audit().holds()
    assert run["second.q"].at(times.tolist()) == pytest.approx(root**2 * (times - 1) ** 2, rel=1e-7)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("seed", [2, 6])
def test_a_cascade_fills_tank_after_tank(solver: str, seed: int) -> None:
    """Each tank drains to the outside, and spills into the next; water is conserved."""
    rng = np.random.default_rng(seed)
    area, edge = rng.uniform(0.5, 2, 4), rng.uniform(0.3, 1, 4)
    weir, hole = rng.uniform(0.5, 3, 4), rng.uniform(0.02, 0.2, 4)
    m = hb.Model("cascade", domain="hydraulic")
    m.add(feed=hb.Sf(0.4))
    for i in rng.permutation(4):
        law = OUTLETS["if" if i % 2 else "max"].format(b=hole[i], g=9810)
        m.add({f"n{i}": hb.Zero(), f"t{i}": hb.C(area[i] / 9810), f"o{i}": hb.R({"f": law})})
        m.add({f"w{i}": hb.Sf(f"{weir[i]}*max(0, t{i}.e/9810 - {edge[i]})^1.5"), f"j{i}": hb.One()})
        m.bond(f"n{i} -> t{i}", f"n{i} -> o{i}", f"n{i} -> j{i} -> w{i}")
    m.bond("feed -> n0", "j0 -> n1", "j1 -> n2", "j2 -> n3")
    m.signal(lost=hb.Integral("o0.f + o1.f + o2.f + o3.f + w3.f"))
    run = hb.simulate(m, 40.0, solver=solver)

    def rate(t: float, h: NDArray[np.float64]) -> NDArray[np.float64]:
        spilt = weir * np.maximum(0, h - edge) ** 1.5
        into = np.concatenate([[0.4], spilt[:-1]])
        return np.asarray((into - spilt - hole * np.sqrt(np.maximum(h, 0))) / area)

    want = solve_ivp(rate, [0, 40], np.zeros(4), method="LSODA", rtol=1e-10, atol=1e-12)
    held = [run[f"t{i}.q"].at(40.0) for i in range(4)]
    assert held == pytest.approx(want.y[:, -1] * area, rel=1e-6)
    assert sum(held) + run["lost"].at(40.0) == pytest.approx(0.4 * 40, rel=1e-8)
