"""The cushions of a cylinder, against its differential equations in SciPy."""

import pytest
from library.bench import every_way
from scipy.integrate import solve_ivp

import hybond as hb

BULK, RHO, CD, LAM = 1.4e9, 870.0, 0.7, 1e3
STROKE, CUSHION, WIDE, LEAST, DEAD = 0.3, 0.02, 5e-5, 2e-6, 2e-5
MASS, V = 50.0, 0.4


def orifice(dp: float, area: float) -> float:
    return CD * area * (2 / RHO) ** 0.5 * dp / (dp**2 + LAM**2) ** 0.25


def narrowed(left: float) -> float:
    return LEAST + (WIDE - LEAST) * min(max(left / CUSHION, 0), 1)


def rates(t: float, y: list[float], area_a: float, area_b: float) -> list[float]:
    """Of position, speed and the fluid in both chambers; both ports are open to the air."""
    x, v, in_a, in_b = y
    V_a, V_b = DEAD + area_a * x, DEAD + area_b * (STROKE - x)
    p_a, p_b = BULK * (in_a - V_a) / V_a, BULK * (in_b - V_b) / V_b
    force = area_a * p_a * (1 + p_a / (2 * BULK)) - area_b * p_b * (1 + p_b / (2 * BULK))
    flow_a = orifice(-p_a, WIDE if p_a < 0 else narrowed(x))
    flow_b = orifice(-p_b, WIDE if p_b < 0 else narrowed(STROKE - x))
    return [v, force / MASS, flow_a, flow_b]


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("x", "v"), [(0.04, -V), (STROKE - 0.04, V)])
def test_a_cushion_brakes_a_cylinder_before_its_end(x: float, v: float) -> None:
    """``"hydraulic.cushioned_cylinder"``: what a chamber gives off passes less and less."""
    area_a, area_b = 1e-3, 6e-4
    m = hb.Model("press", domain="hydraulic")
    m.add(
        c=hb.Submodel("hydraulic.cushioned_cylinder", x_0=x, throttle=LEAST),
        air=hb.Submodel("hydraulic.atmosphere"),
        body=hb.Submodel("translational.mass", m=MASS, v=v),
    )
    start = [x, v, DEAD + area_a * x, DEAD + area_b * (STROKE - x)]
    known = solve_ivp(
        rates, (0, 0.12), start, "Radau", args=(area_a, area_b), rtol=1e-8, atol=1e-14
    ).y[:, -1]
    ways = every_way(m, "c.a - air.port", "air.port - c.b", "c.rod - body.flange")
    for way in ways[::7]:
        run = hb.simulate(way, until=0.12, solver="radau", rtol=1e-6)
        assert run["c.position"].at(0.12) == pytest.approx(known[0], abs=2e-6)
        assert run["c.speed"].at(0.12) == pytest.approx(known[1], rel=1e-3)
        assert abs(known[1]) < V / 2, "it does not brake"
    free = hb.simulate(way, until=0.12, solver="radau", parameters={"c.throttle": WIDE})
    assert abs(free["c.speed"].at(0.09)) > 0.75 * V, "it brakes without a cushion"
