"""Laws beside two-ports that turn and bent storages: units may make all of it large or small."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

MU, EPS, ANGLE, HEIGHT = 0.3, 0.3, 1.0, 0.2


def rod(mass: float, length: float, while_: float) -> hb.Model:
    """A rod of half length 1 and mass 1 that falls on one end, in these units."""
    g, w = 9.81 * length / while_**2, 0.5 / while_
    m = hb.Model("rod", domain="translational", parameters={"l": length, "mu": MU})
    m.add(X=hb.I(mass, f=length / while_), Y=hb.I(mass, f=length * math.cos(ANGLE) * w))
    m.add(x=hb.One(), y=hb.One(), weight=hb.Se(-mass * g))
    m.add(J=hb.I(mass * length**2 / 3, f=w, domain="rotational"), w=hb.One(domain="rotational"))
    m.add(along=hb.TF("l*sin(angle)"), across=hb.TF("-l*cos(angle)"), sx=hb.Zero(), sy=hb.Zero())
    m.add(rub=hb.One(law="coulomb", limit="mu*floor.e", impulsive=True), tip=hb.One())
    m.add(floor=hb.Zero(law="unilateral", gap="h - l*sin(angle)", restitution=EPS))
    m.bond("x -> X", "y -> Y", "weight -> y", "w -> J", "rub -> sx -> x", "floor -> tip -> sy -> y")
    m.bond("sx -> along.2", "along.1 -> w", "sy -> across.2", "across.1 -> w")
    m.signal(angle=hb.Integral("w.f", start=ANGLE))
    m.signal(h=hb.Integral("y.f", start=(math.sin(ANGLE) + HEIGHT) * length))
    return m


@pytest.mark.parametrize(
    ("mass", "length", "while_"),
    [(1, 1, 1), (1e16, 1, 1), (1, 1, 1e-8), (1e-12, 1e-4, 1e-3), (1e24, 1e7, 1e4)],
)
def test_a_rod_strikes_alike_whatever_its_units(mass, length, while_):
    """The impulses that bring the tip to rest along the floor, and back at 0.3 across it."""
    run = hb.simulate(rod(mass, length, while_), 0.25 * while_, rtol=1e-9)
    t = run.events.t[1]
    angle = run["angle"].at(t)
    inverse = np.diag([1, 1, 3.0])
    to_tip = np.array([[1, 0, math.sin(angle)], [0, 1, -math.cos(angle)]])
    momentum = mass * length / while_
    sizes = np.array([momentum, momentum, momentum * length])
    names = ("X.p", "Y.p", "J.p")
    before = np.array([run[n].at(t, side="left") for n in names]) / sizes
    after = np.array([run[n].at(t) for n in names]) / sizes
    tip = to_tip @ inverse @ before
    areas = np.linalg.solve(to_tip @ inverse @ to_tip.T, np.array([0, -EPS * tip[1]]) - tip)
    assert abs(areas[0]) < MU * areas[1]
    assert after == pytest.approx(before + to_tip.T @ areas, abs=1e-9)


def test_gas_behind_a_check_valve_beside_a_momentum_that_is_far_larger():
    """A mass is caught by gas that a check valve joins to it: SciPy with the valve by hand."""
    area, mass, gas = 1e-2, 1e3, 1e-3
    pressure = f"1e5*(({gas}/({gas} - q))^1.4 - 1)"
    m = hb.Model("catch", domain="hydraulic")
    m.add(stock=hb.C({"e": pressure}, q=4e-4), n=hb.Zero(), valve=hb.One(law="diode"))
    m.add(pad=hb.C(1e-9), r=hb.R(1e8), p=hb.Zero(), piston=hb.TF(area))
    m.add(v=hb.One(domain="translational"), body=hb.I(mass, f="1 m/s", domain="translational"))
    m.bond("v -> piston -> p -> pad", "p -> valve -> n -> stock", "valve -> r", "v -> body")
    run = hb.simulate(m, "0.5 s", rtol=1e-9)

    def rates(_, y):
        q, pad, v = y
        p = pad / 1e-9
        flow = max(0.0, p - 1e5 * ((gas / (gas - q)) ** 1.4 - 1)) / 1e8
        return [flow, area * v - flow, -area * p / mass]

    tight = {"rtol": 1e-10, "atol": [1e-14, 1e-16, 1e-10]}
    end = solve_ivp(rates, (0, 0.5), [4e-4, 0, 1], method="LSODA", max_step=1e-3, **tight).y[:, -1]
    assert run["stock.q"].at(0.5) == pytest.approx(end[0], rel=1e-6)
    assert run["body.f"].at(0.5) == pytest.approx(end[2], rel=1e-5, abs=1e-6)


FRICTION_FROM_NOTHING = """
hybond = 1
[elements]
rub = {{ junction = 1, law = "coulomb", limit = 0.0149 }}
valve = {{ junction = 0, law = "diode" }}
node = {{ junction = 0 }}
near = {{ GY = "{near}" }}
far = {{ GY = "{far}" }}
top = {{ I = {{ f = "0.243*sinh(p/8.57)" }}, p = -0.0 }}
stiff = {{ R = {{ e = "350.0*((f/47.7) + (f/47.7)^3)" }} }}
soft = {{ R = {{ e = "0.101*((f/0.226) + (f/0.226)^3)" }} }}
[graph]
bonds = [
  "node -> far.2", "near.1 -> rub", "valve -> rub", "valve -> far.1", "top -> node",
  "valve -> near.2", "node -> soft", "stiff -> node",
]
"""


@pytest.mark.parametrize(("near", "far"), [(2.43, 441.0), (24.3, 1e4), (0.243, 44.1)])
def test_rates_below_the_smallest_number_are_no_violation(near, far):
    """Nothing moves; a rate of 2.5e-323 was held against one of zero."""
    run = hb.simulate(
        hb.loads(FRICTION_FROM_NOTHING.format(near=near, far=far)), 0.0287, solver="radau"
    )
    assert run.status == "ok"
    assert run["top.p"].at(0.02) == pytest.approx(0.0, abs=1e-300)
