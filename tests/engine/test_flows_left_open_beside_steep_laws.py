"""Flows in a loop of 0-junctions, which nothing decides, beside laws that grow without bound.

Whether a root brings something to rest is seen along a straight line, at states that no motion
comes to. What laws left open was as large there as they, and the solution of the motion that came
next had no digits beside it.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import hybond as hb

TURNED = {
    "as written": (),
    "loop turned": ("n -> k", "k -> m", "m -> n"),
    "storages turned": ("n -> c", "line -> heavy", "drive -> light"),
}


def way(turned: tuple[str, ...]) -> float:
    """Return the sign of momenta that flow along `line`."""
    return -1.0 if "line -> heavy" in turned else 1.0


def fed(turned: tuple[str, ...]) -> hb.Model:
    m = hb.Model("fed through two branches")
    m.add(n=hb.Zero(), k=hb.Zero(), m=hb.Zero(), line=hb.One(), drive=hb.One(), end=hb.One())
    m.add(rub=hb.Zero(law="coulomb", limit=1.19))
    m.add(c=hb.C({"e": "3.32*sinh(q/624)"}, q=-149.0), g=hb.G(731.5), r=hb.R(1.0))
    m.add(heavy=hb.I({"f": "0.00351*sinh(p/0.00461)"}, p=-0.000825 * way(turned)))
    m.add(light=hb.I({"f": "351*((p/0.0203) + (p/0.0203)^3)"}))
    m.add(orifice=hb.R({"e": "0.184*(f/0.0243)*abs(f/0.0243)"}), s=hb.Se("-10.4*sin(0.883*time)"))
    bonds = ["n -> c", "g -> n", "n -> m", "m -> n", "n -> k", "k -> m", "m -> orifice"]
    bonds += ["m -> line", "k -> line", "line -> rub", "line -> drive", "line -> heavy"]
    bonds += ["drive -> light", "drive -> end", "end -> s", "end -> r"]
    for bond in bonds:
        tail, head = bond.split(" -> ")
        # of the two bonds between n and m one is turned: both go round then
        m.bond(f"{head} -> {tail}" if bond in turned else bond)
    return m


def speed(p: float) -> float:
    """Return the flow of both inertances, whose momenta add up to `p`."""

    def apart(own: float) -> float:
        rest = (p - own) / 0.0203
        return float(0.00351 * np.sinh(own / 0.00461) - 351.0 * (rest + rest**3))

    own = brentq(apart, min(0.0, p) - 1e-3, max(0.0, p) + 1e-3, xtol=1e-18)
    return float(0.00351 * np.sinh(own / 0.00461))


def rates(t: float, y: np.ndarray) -> list[float]:
    q, p = y
    e, f = 3.32 * np.sinh(q / 624.0), speed(p)
    through = 0.0243 * np.sign(e) * np.sqrt(abs(e) / 0.184)
    return [-731.5 * e - through - 2.0 * f, 2.0 * e + 10.4 * np.sin(0.883 * t) - f]


@pytest.mark.parametrize("turned", TURNED.values(), ids=TURNED.keys())
def test_what_was_left_open_in_no_state_of_the_motion_takes_no_digits(
    turned: tuple[str, ...],
) -> None:
    run = hb.simulate(fed(turned), until=0.08)
    own = solve_ivp(rates, (0.0, 0.08), [-149.0, -0.000825], "DOP853", rtol=1e-10, atol=1e-12)
    q, p = own.y[:, -1]
    # it was off by 1e-5
    assert run["c.q"].at(0.08) == pytest.approx(q, rel=1e-8)
    both = run["heavy.p"].at(0.08) + run["light.p"].at(0.08)
    assert both == pytest.approx(p * way(turned), rel=1e-6)
