"""Motions that begin at the limit of a law and are faster than an instant of the run.

The end of a step at a kink was carried over it by the rates there for as long as an instant, in
which the motion had gone a part of its way: up to 17 % of the energy were missing.
"""

from __future__ import annotations

import math

import pytest
from scipy.integrate import quad

import hybond as hb

C, FROM, WIDTH = 8.663793103448276e-05, 0.0172, 0.0197


def leaking(kind: str, g: float, limit: float, turned: bool) -> hb.Model:
    """Return a storage that leaks by a cubic law and by one that has an end."""
    m = hb.Model("leak")
    cubic, end = f"{g}*(x/{WIDTH} + (x/{WIDTH})^3)", f"{limit}*tanh(x/222)"
    if kind == "C":
        leak, ends = hb.R({"f": cubic.replace("x", "e")}), hb.R({"e": end.replace("x", "f")})
        m.add(j=hb.Zero(), k=hb.C(C, q=FROM), a=leak, b=ends)
    else:
        leak, ends = hb.R({"e": cubic.replace("x", "f")}), hb.R({"f": end.replace("x", "e")})
        m.add(j=hb.One(), k=hb.I(C, p=FROM), a=leak, b=ends)
    m.bond(*(f"{x} -> j" if turned and x == "k" else f"j -> {x}" for x in "bak"))
    return m


def time_to(x: float, g: float, limit: float) -> float:
    """Return the time from the limit until the storage is at x."""

    def slowness(log: float) -> float:
        z = math.exp(log)
        return z * C / (g * (z / WIDTH + (z / WIDTH) ** 3) + 222 * math.atanh(z / limit))

    return float(quad(slowness, math.log(x), math.log(limit), epsabs=0.0)[0])


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("kind", ["C", "I"])
@pytest.mark.parametrize(("g", "limit"), [(0.231, 116.0), (2.31, 116.0), (2.31, 100.0)])
def test_what_began_at_a_limit_lost_energy_in_its_first_instant(
    kind: str, g: float, limit: float, turned: bool
) -> None:
    run = hb.simulate(leaking(kind, g, limit, turned), 0.017, rtol=1e-8)
    name = "k.e" if kind == "C" else "k.f"
    assert run.status == "ok"
    assert run.audit().energy < 1e-7
    for x in (90.0, 40.0, 5.0):
        assert abs(run[name].at(time_to(x, g, limit))) == pytest.approx(x, rel=1e-6)
