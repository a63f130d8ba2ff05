"""What a controller holds at its place is not driven back by the rounding of it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

BULK, DEAD = 1.4e9, 2e-5


@pytest.fixture(scope="module")
def followed() -> dict[float, float]:
    """Where the servo is at 0.15 s, by SciPy, of each gain."""
    found = {}
    for gain in (20.0, 50.0):
        y = [0.1, 0.0, DEAD + 1e-4, DEAD + 1.2e-4, 0.0]
        scale = [1e-9, 1e-7, 1e-13, 1e-13, 1e-8]
        made = solve_ivp(
            servo_rates, (0.05, 0.15), y, args=(gain,), method="LSODA", rtol=1e-8, atol=scale
        )
        found[gain] = float(made.y[0, -1])
    return found


def servo_rates(_t: float, y: np.ndarray, gain: float) -> list[float]:
    """Rates of place, speed, what both chambers hold, and spool, on the way to 0.2 m."""
    x, v, a, b, spool = y
    rooms = DEAD + 1e-3 * x, DEAD + 6e-4 * (0.3 - x)
    pa, pb = (BULK * (q - room) / room for q, room in zip((a, b), rooms, strict=True))
    force = 1e-3 * pa * (1 + pa / (2 * BULK)) - 6e-4 * pb * (1 + pb / (2 * BULK))

    def flow(dp: float) -> float:
        return 0.7e-5 * abs(spool) * (2 / 870) ** 0.5 * dp / (dp * dp + 1e6) ** 0.25

    into_a = flow(1e7 - pa) if spool > 0 else -flow(pa)
    into_b = -flow(pb) if spool > 0 else flow(1e7 - pb)
    command = min(max(gain * (0.2 - x), -1), 1)
    return [v, (force - 2000 * v) / 40, into_a, into_b, (command - spool) / 5e-3]


@pytest.mark.parametrize(
    ("solver", "gain", "turned"),
    [("auto", 20.0, False), ("auto", 20.0, True), ("rk45", 50.0, False), ("radau", 20.0, True)],
)
def test_a_servo_that_holds_its_place_is_not_driven_back_by_rounding(
    solver, gain, turned, followed
) -> None:
    """Where nothing moves, the error of a position has the steps of its last place."""
    m = hb.Model("servo", domain="hydraulic")
    m.add(ps=hb.Submodel("hydraulic.pressure_source", p="100 bar"), t=hb.Se(0), tank=hb.Zero())
    command = {"command": f"{gain}*(to - c.position)"}
    m.add(sv=hb.Submodel("hydraulic.servo_valve", inputs=command))
    m.add(c=hb.Submodel("hydraulic.cylinder", x_0="0.1 m"), v=hb.One(domain="translational"))
    m.add(M=hb.I(40, domain="translational"), d=hb.R(2000, domain="translational"))
    for bond in ("ps.port -> sv.p", "sv.t -> tank", "t -> tank", "sv.a -> c.a", "sv.b -> c.b"):
        one, other = bond.split(" -> ")
        m.bond(f"{other} -> {one}" if turned and one != "t" else bond)
    m.bond("M -> v -> c.rod" if turned else "c.rod -> v -> M", "v -> d")
    m.input(to=hb.Input(table=[[0, 0.1], [0.05, 0.2]]))
    run = hb.simulate(m, until=0.15, solver=solver)
    places = run["c.position"].at([0.05, 0.15])
    assert places == pytest.approx([0.1, followed[gain]], rel=1e-6)
