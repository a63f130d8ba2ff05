"""Crank and slider that begin at rest at a dead centre, with dry friction on the slider."""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb

J, M = 0.05, 1.8


def crank(
    r: float, rod: float, torque: float, limit: float, start: float, *, turned: bool = False
) -> hb.Model:
    """Return it; where it points away from the slider sin(pi) is what rounding makes of it."""
    under = f"({rod**2} - {r**2}*sin(a)^2)^0.5"
    arm = f"{r**2}*sin(a)*cos(a)/{under} + {r}*sin(a)"
    m = hb.Model("crank", domain="generic")
    m.add(w=hb.One(), J=hb.I(J), T=hb.Se(torque), v=hb.One(), m=hb.I(M))
    m.add(arm=hb.TF(arm if turned else f"-({arm})"), rub=hb.One(law="coulomb", limit=limit))
    m.add(z=hb.Zero())
    m.bond("T -> w -> J", "v -> m", "v -> z -> rub")
    if turned:
        m.bond("arm.1 -> w", "arm.2 -> v")
    else:
        m.bond("w -> arm.1", "arm.2 -> v")
    m.signal(a=hb.Integral("w.f", start))
    return m


@pytest.mark.sampled(4)
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("torque", [3.0, -1.5])
@pytest.mark.parametrize(
    ("r", "rod", "limit"), [(0.05, 0.21, 0.5), (0.12, 0.36, 4.0), (0.2, 0.3, 1)]
)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("start", [math.pi, 0.0], ids=["away", "towards"])
def test_a_crank_leaves_its_dead_centre(
    start: float, solver: str, torque: float, r: float, rod: float, limit: float, turned: bool
) -> None:
    """It crept by steps of 1e-11 s for ever: each was to show the arm, which was rounding of pi.

    Where it points to the slider the arm is zero, and no force of the friction does anything at the
    start: it held the slider, and with it, a moment later, the crank (HB-N301).

    Work of the torque goes into both masses and the way that the slider has rubbed, whatever the
    time; there is a whole turn, so the slider has been at both ends.
    """
    run = hb.simulate(
        crank(r, rod, torque, limit, start, turned=turned), 1.2, solver=solver, rtol=1e-9
    )
    assert run.stats["steps"] < 5000
    t = np.linspace(0.05, 1.2, 60)
    a, w = run["a"].at(t), run["w.f"].at(t)
    assert abs(a[-1] - start) > 2.0 * math.pi

    def at(q: np.ndarray) -> np.ndarray:
        return r * np.cos(q) + np.sqrt(rod**2 - r**2 * np.sin(q) ** 2)

    slope = -(r**2) * np.sin(a) * np.cos(a) / np.sqrt(rod**2 - r**2 * np.sin(a) ** 2)
    slope -= r * np.sin(a)
    turn = np.abs(a - start)
    halves = np.floor(turn / math.pi)
    here, there = (rod - r, rod + r) if start else (rod + r, rod - r)
    ends = np.where(halves % 2 == 0, here, there)
    rubbed = 2.0 * r * halves + np.abs(at(a) - ends)
    kinetic = 0.5 * (J + M * slope**2) * w**2
    assert np.allclose(kinetic + limit * rubbed, np.abs(torque) * turn, rtol=1e-6, atol=1e-9)
    # and time: it begins as the crank alone does, for the arm grows with its angle
    soon = 0.01
    alone = 0.5 * torque / J * soon**2
    assert run["a"].at(soon) - start == pytest.approx(alone, rel=1e-3)
