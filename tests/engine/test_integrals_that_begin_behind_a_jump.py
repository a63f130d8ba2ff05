"""An integral that is let go at a jump of its rate begins there: its slopes are no rounding."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

UNTIL = 0.9


def drawn(seed: int) -> dict[str, float]:
    """Return a drive and its controller, which is saturated at first."""
    g = np.random.default_rng(seed)
    names = {"r": (0.5, 1.5), "kp": (20, 60), "ki": (20, 40), "kd": (2, 4), "um": (4, 10)}
    names |= {"b": (0.5, 2), "inertia": (0.5, 2)}
    return {name: float(g.uniform(*ends)) for name, ends in names.items()}


def drive(p: dict[str, float], turned: bool, form: str) -> hb.Model:
    """Return a shaft that a controller leads to a place; its integral waits while it saturates."""
    m = hb.Model("drive", domain="rotational", parameters=p)
    m.add(J=hb.I("inertia"), drag=hb.R("b"), w=hb.One(), M=hb.Se("min(max(u, -um), um)"))
    m.bond("M -> w", *(("J -> w", "drag -> w") if turned else ("w -> J", "w -> drag")))
    m.signal(x=hb.Integral("w.f"), err="r - x", u="kp*err + i - kd*w.f", W=hb.Integral("M.e*M.f"))
    waits = {
        "one side": "if u > um then 0 else ki*err",
        "both": "if (u > um and err > 0) or (u < -um and err < 0) then 0 else ki*err",
        "abs": "if abs(u) > um then 0 else ki*err",
    }
    m.signal(i=hb.Integral(waits[form]))
    return m


def followed(p: dict[str, float]) -> np.ndarray:
    """Return place, speed, integral and work at the end by SciPy."""
    r, kp, ki, kd, um, b, inertia = (p[k] for k in ("r", "kp", "ki", "kd", "um", "b", "inertia"))

    def command(_t: float, y: np.ndarray, _waits: bool = False) -> float:
        return kp * (r - y[0]) + y[2] - kd * y[1] - um

    def rates(t: float, y: np.ndarray, waits: bool) -> list[float]:
        torque = um if waits else command(t, y) + um
        a = (torque - b * y[1]) / inertia
        return [y[1], a, 0.0 if waits else ki * (r - y[0]), torque * y[1]]

    command.terminal = True
    y = np.zeros(4)
    t = 0.0
    for waits in (True, False):
        command.direction = -1 if waits else 1
        s = solve_ivp(rates, (t, UNTIL), y, "DOP853", events=command, args=(waits,), **CLOSELY)
        t, y = s.t[-1], s.y[:, -1]
    assert t == UNTIL
    assert all(-2 * um < command(t, y) < 0 for t, y in zip(s.t[1:], s.y.T[1:], strict=True))
    return y


CLOSELY = {"rtol": 1e-12, "atol": 1e-13}
SEEDS = (11, 22, 43, 65, 86, 117)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("form", ["one side", "both", "abs"])
@pytest.mark.parametrize("seed", SEEDS)
def test_controllers_go_on_by_implicit_steps_where_their_integral_is_let_go(
    seed: int, form: str
) -> None:
    """Steps became too small: over a difference of 1e-158 the last place of a rate was a slope."""
    p = drawn(seed)
    want = followed(p)
    for solver, rtol in (("radau", 1e-8), ("radau", 1e-10), ("auto", 1e-8), ("radau", 1e-6)):
        run = hb.simulate(drive(p, seed % 2 == 1, form), UNTIL, solver=solver, rtol=rtol)
        got = [float(run[name].at(UNTIL)) for name in ("x", "w.f", "i", "W")]
        np.testing.assert_allclose(got, want, rtol=300 * rtol, atol=1e-9)
        assert run.audit().holds()
