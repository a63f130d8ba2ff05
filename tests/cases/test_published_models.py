"""Models with the numbers of their papers, beside an integration of what these print."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb


def bristles(*, turned: bool) -> hb.Model:
    """Friction by bristles before it breaks loose (Canudas de Wit and others, 1995)."""
    m = hb.Model("bristles")
    m.add(hand=hb.Sf(-0.1 if turned else 0.1), n=hb.Zero(), v=hb.One(), mass=hb.I(1.0))
    m.add(spring=hb.C(0.5, q=0.74), rub=hb.Se("F" if turned else "-F"))
    m.signal(
        rate="v.f - 1e5*abs(v.f)/(1 + 0.5*exp(-(v.f/0.001)^2))*z",
        z=hb.Integral("rate", start=-1.48e-5 if turned else 1.48e-5),
        F="1e5*z + sqrt(1e5)*rate + 0.4*v.f",
    )
    m.bond("v -> n -> hand" if turned else "hand -> n -> v", "n -> spring")
    m.bond("v -> rub" if turned else "rub -> v", "v -> mass")
    return m


@pytest.mark.parametrize(("turned", "rtol"), [(False, 1e-6), (False, 1e-8), (True, 1e-7)])
def test_bristles_that_break_loose_are_not_warned_of_as_steps_that_swing(
    turned: bool, rtol: float
) -> None:
    """A mass speeds up: the mean rate of a step is not that at its end, and nothing is off."""

    def rates(t: float, x: np.ndarray) -> list[float]:
        q, v, z = x
        rate = v - 1e5 * abs(v) / (1 + 0.5 * math.exp(-((v / 1e-3) ** 2))) * z
        return [0.1 - v, 2 * q - (1e5 * z + math.sqrt(1e5) * rate + 0.4 * v), rate]

    t = np.linspace(0.05, 0.5, 19)
    start = [0.74, 0.0, 1.48e-5]
    meant = solve_ivp(rates, (0.0, 0.5), start, "Radau", t, rtol=1e-9, atol=1e-12).y
    run = hb.simulate(bristles(turned=turned), 0.5, rtol=rtol, solver="radau")
    # turned, the mass counts its speed the other way, and the spring its length as before
    sign = -1.0 if turned else 1.0
    assert sign * run["mass.f"].at(t) == pytest.approx(meant[1], abs=100 * rtol)
    assert run["spring.q"].at(t) == pytest.approx(meant[0], abs=100 * rtol)
    assert not run.warnings and run.audit().holds()
