"""Arms of point masses that start from rest: rounding of their constraints is no jump."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb


def arm(a: float, b: float, *, back: bool) -> hb.Model:
    """Two links with a point mass at the end of each, and a damper at the elbow's angle."""
    m = hb.Model("arm", domain="translational", parameters={"l1": 0.8, "l2": 0.6, "g": 9.81})
    m.add(x1=hb.One(), y1=hb.One(), x2=hb.One(), y2=hb.One(), xs=hb.Zero(), ys=hb.Zero())
    m.add(ax=hb.TF("-l1*sin(a)"), ay=hb.TF("l1*cos(a)"))
    m.add(bx=hb.TF("-l2*sin(b)"), by=hb.TF("l2*cos(b)"))
    m.add(w1=hb.One(domain="rotational"), w2=hb.One(domain="rotational"), d=hb.R(0.2))
    m.add(mx1=hb.I(2.0), my1=hb.I(2.0), mx2=hb.I(1.0), my2=hb.I(1.0))
    m.add(W1=hb.Se("-2*g"), W2=hb.Se("-g"))
    m.signal(a=hb.Integral("w1.f", start=a), b=hb.Integral("w2.f", start=b))
    m.bond("w1 -> ax -> x1", "w1 -> ay -> y1", "x1 -> xs -> x2", "y1 -> ys -> y2")
    m.bond("w2 -> bx -> xs", "w2 -> by -> ys", "W1 -> y1", "W2 -> y2")
    ends = [("x1", "mx1"), ("y1", "my1"), ("x2", "mx2"), ("y2", "my2"), ("w2", "d")]
    m.bond(*(f"{j} -> {i}" if back else f"{i} -> {j}" for i, j in ends))
    return m


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize(("a", "b"), [(0.3, -0.5), (np.pi / 2, 0.0), (-1.2, 2.1)])
def test_an_arm_at_rest_makes_no_jump_of_rounding(a: float, b: float, back: bool) -> None:
    """A null vector had the last digit of a weight in it: HB-N411 for 5e-32 J."""
    run = hb.simulate(arm(a, b, back=back), until=0.3, rtol=1e-8, atol=1e-10)
    assert not run.warnings
    assert run.events[0].steps[-1].energy.after == 0.0

    def rates(_t: float, y: np.ndarray) -> list[float]:
        p, q, u, w = y
        c, s = 0.48 * np.cos(p - q), 0.48 * np.sin(p - q)
        inertia = np.array([[3 * 0.64, c], [c, 0.36]])
        given = [
            -s * w * w - 3 * 9.81 * 0.8 * np.cos(p),
            s * u * u - 9.81 * 0.6 * np.cos(q) - 0.2 * w,
        ]
        return [u, w, *np.linalg.solve(inertia, given)]

    own = solve_ivp(rates, (0, 0.3), [a, b, 0, 0], rtol=1e-10, atol=1e-12)
    assert [run["a"].at(0.3), run["b"].at(0.3)] == pytest.approx(own.y[:2, -1], rel=1e-6, abs=1e-6)
