"""What comes to rest close to a kink of a law, and is held there by the slope on its own side."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

BULK, DEAD = 1.4e9, 2e-5


def cylinder(start: float, inwards: bool) -> hb.Model:
    """A cushioned cylinder that is driven into one of its ends through an orifice."""
    m = hb.Model("cylinder", domain="hydraulic")
    m.add(ps=hb.Submodel("hydraulic.pressure_source", p="60 bar"))
    m.add(o=hb.Submodel("hydraulic.orifice", area="6 mm^2"))
    m.add(t=hb.Submodel("hydraulic.atmosphere"), M=hb.I("40 kg", domain="translational"))
    m.add(c=hb.Submodel("hydraulic.cushioned_cylinder", x_0=start))
    driven, open_one = ("c.b", "c.a") if inwards else ("c.a", "c.b")
    m.bond("ps.port -> o.inlet", f"o.outlet -> {driven}", f"{open_one} -> t.port", "c.rod -> M")
    return m


@pytest.mark.parametrize(
    ("solver", "start", "inwards", "until"),
    [("auto", 0.15, False, 0.4), ("auto", 0.05, True, 0.3), ("radau", 0.03, True, 0.2)],
)
def test_a_cushioned_cylinder_at_its_end_comes_to_rest(solver, start, inwards, until) -> None:
    """Its last pressure runs out through the throttle, beside which the check valve is steeper."""
    m = cylinder(start, inwards)
    run = hb.simulate(m, until=until, solver=solver, max_steps=2000)
    rests = run["c.pressure_a" if inwards else "c.pressure_b"].at(until)
    holds = run["c.pressure_b" if inwards else "c.pressure_a"].at(until)
    # tolerances are parts of what is stored, and a part of 1e-8 of a chamber is 14 Pa
    assert abs(rests) < 30.0
    assert holds == pytest.approx(60e5, rel=1e-5)
    assert run["c.position"].at(until) == pytest.approx(0.0 if inwards else 0.3, abs=1e-9)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("rooms", "narrow", "wide", "bars", "until"),
    [
        ((1.2e-4, 2.8e-4, 1.1e-5), 1.4e-8, 5.2e-7, (19, 2, 19), 9.6),
        ((1.2e-4, 8.7e-6, 2.3e-6), 9.3e-8, 6.2e-6, (3, 15, 14), 0.28),
    ],
)
def test_vessels_level_out_through_throttles_that_are_wider_one_way(
    rooms, narrow, wide, bars, until, turned
) -> None:
    """Both throttles come to rest at their kinks; the mean of what the vessels hold stays."""
    m = hb.Model("vessels", domain="hydraulic", parameters={"k1": narrow, "k2": wide})
    law = "0.0336*(k1*max(e, 0) + k2*min(e, 0))/(e^2 + 1e6)^(1/4)"
    for k, (room, bar) in enumerate(zip(rooms, bars, strict=True)):
        m.add({f"n{k}": hb.Zero(), f"c{k}": hb.C(room / BULK, e=1e5 * bar)})
        m.bond(f"c{k} -> n{k}" if turned else f"n{k} -> c{k}")
        if k:
            m.add({f"d{k}": hb.One(), f"r{k}": hb.R({"f": law})})
            m.bond(f"n{k - 1} -> d{k} -> n{k}", f"d{k} -> r{k}")
    run = hb.simulate(m, until=until, max_steps=2000)
    mean = 1e5 * float(np.dot(rooms, bars)) / sum(rooms)
    assert [run[f"c{k}.e"].at(until) for k in range(3)] == pytest.approx([mean] * 3, rel=1e-8)


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
