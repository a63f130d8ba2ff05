"""Contacts and stops that push and never pull, gas springs, against closed forms."""

import math

import numpy as np
import pytest
from library.trials import kelvin_voigt, trials
from scipy.optimize import brentq

import hybond as hb

FRAME = hb.Submodel("translational.frame")


def mass(m: float, v: float = 0.0) -> hb.Submodel:
    return hb.Submodel("translational.mass", m=m, v=v)


def push(newtons: object) -> hb.Submodel:
    return hb.Submodel("translational.force", inputs={"force": newtons})


def hunt_crossley(a: float, v: float) -> float:
    """Return the speed after an impact: the integral of v*dv/(1 + a*v) is the same to and fro."""

    def work(v: float) -> float:
        return v / a - math.log1p(a * v) / a**2

    return brentq(lambda back: work(-back) - work(v), 0, min(v, 1 / a) - 1e-12)


LAWS = [("elastic", 0.0), ("elastic", 20.0), ("hunt", 0.2), ("hunt", 2.0)]


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("law", "d"), LAWS)
@pytest.mark.parametrize("stop", [False, True])
def test_a_mass_comes_back_with_what_the_damping_leaves(law: str, d: float, stop: bool) -> None:
    """``"translational.elastic_contact"``, ``"translational.hunt_crossley_contact"``,
    ``"translational.bump_stop"`` and ``"translational.hunt_crossley_stop"``.
    """
    m, v, k = 2.0, 1.5, 1000.0
    if law == "elastic":
        given: dict[str, object] = {"k": k, "d": d}
        back = v * kelvin_voigt(m, k, d)[0]
    else:
        given = {"k": 1e5, "a": d}
        back = hunt_crossley(d, v)
    if stop:
        part = hb.Submodel(
            f"translational.{'bump' if law == 'elastic' else 'hunt_crossley'}_stop", **given
        )
        joints = "m.flange - c.flange, c.case - wall.flange"
    else:
        part = hb.Submodel(f"translational.{law.replace('hunt', 'hunt_crossley')}_contact", **given)
        joints = "m.flange - c.left, c.right - wall.flange"
    for start in (v, -v) if stop else (v,):  # the lower stop, too
        for run in trials(joints, 0.25, m=mass(m, start), c=part, wall=FRAME):
            t = np.linspace(0, 0.25, 101)
            force = run["c.force"].at(t) * (1 if start > 0 else -1)
            assert force.min() >= 0 and force.max() > 1
            assert (force[run["c.depth"].at(t) == 0] == 0).all()
            assert run["m.speed"].at(0.25) == pytest.approx(-math.copysign(back, start), rel=1e-7)
            assert run["c.touches"].at([0.0, 0.09, 0.25]) == pytest.approx([0, 1, 0])
            deep = math.sqrt(m / k) * v
            if d == 0:
                assert run["c.depth"].at(t).max() == pytest.approx(deep, rel=1e-2)


def test_pressed_together_it_rests_at_the_depth_that_bears_the_load() -> None:
    """Kelvin and Voigt creep there, Hunt and Crossley swing in; a pull lets them part."""
    for name, given, depth in (
        ("elastic_contact", {"k": 1e3, "d": 300}, 0.02),
        ("hunt_crossley_contact", {"k": 1e5, "a": 50}, (20 / 1e5) ** (1 / 1.5)),
    ):
        parts = {
            "m": mass(2.0),
            "c": hb.Submodel(f"translational.{name}", distance=f"{-depth / 2} m", **given),
            "wall": FRAME,
            "f": push("if time < 6 then 20 else -20"),
        }
        joints = "f.flange -> m.flange, m.flange - c.left, c.right - wall.flange"
        for run in trials(joints, 6.5, rtol=1e-8, **parts):
            assert run["c.depth"].at(0) == pytest.approx(depth / 2)
            assert run["c.depth"].at(6, side="left") == pytest.approx(depth, rel=1e-5)
            assert run["c.force"].at(6, side="left") == pytest.approx(20, rel=1e-5)
            assert run["wall.force"].at(6, side="left") == pytest.approx(-20, rel=1e-5)
            assert (run["c.force"].at(6.5), run["c.touches"].at(6.5)) == (0, 0)
            assert run["c.gap"].at(6.5) > 0.5
            assert run["c.force"].at(np.linspace(0, 6.5, 200)).min() >= 0


def test_momentum_passes_from_one_body_to_the_other() -> None:
    m_a, m_b, v = 2.0, 3.0, 4.0
    part = hb.Submodel("translational.elastic_contact", k=1e5, d=40, distance="5 mm")
    e = kelvin_voigt(m_a * m_b / (m_a + m_b), 1e5, 40)[0]
    for run in trials(
        "a.flange - c.left, c.right - b.flange", 0.05, a=mass(m_a, v), c=part, b=mass(m_b)
    ):
        mean = m_a * v / (m_a + m_b)
        assert run["a.speed"].at(0.05) == pytest.approx(mean - e * (v - mean), rel=1e-7)
        assert run["b.speed"].at(0.05) == pytest.approx(mean * (1 + e), rel=1e-7)


@pytest.mark.parametrize("n", [1, 1.4])
def test_a_gas_spring_stores_the_work_of_its_gas(n: float) -> None:
    """``"translational.gas_spring"``: speed over way by the work of compression."""
    area, length, p, atm, m, v = 2e-4, 0.2, 2e6, 101325.0, 10.0, -1.5
    parts = {
        "wall": FRAME,
        "s": hb.Submodel("translational.gas_spring", area=area, n=n, x_0="0.02 m"),
        "m": mass(m, v),
    }

    def work(x: float) -> float:
        left = 1 - x / length
        gas = -math.log(left) if n == 1 else (left ** (1 - n) - 1) / (n - 1)
        return area * ((p + atm) * length * gas - atm * x)

    for run in trials("wall.flange - s.left, s.right - m.flange", 0.03, **parts):
        t = np.linspace(0, 0.03, 7)
        way, speed = run["s.way"].at(t), run["m.speed"].at(t)
        assert way[0] == pytest.approx(0.02) and way[-1] > 0.04
        gained = [work(x) - work(0.02) for x in way]
        assert m * (v**2 - speed**2) / 2 == pytest.approx(gained, abs=1e-7)
        pressure = (p + atm) * (length / (length - way)) ** n - atm
        assert run["s.pressure"].at(t) == pytest.approx(pressure)
        assert run["s.force"].at(t) == pytest.approx(-area * pressure)
