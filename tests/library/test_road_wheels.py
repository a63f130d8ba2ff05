"""Wheels on a road: the slip curve in even motion, and standstill, starts and stops by SciPy."""

import math

import numpy as np
import pytest
from library.bench import every_way
from scipy.integrate import solve_ivp

import hybond as hb

B, C, E, MU, LOAD, RELAX, R = 10.0, 1.65, 0.5, 1.0, 4000.0, 0.1, 0.3


def magic(kappa, load=LOAD, mu_load=0.0):
    x = B * np.asarray(kappa)
    D = load * (MU + mu_load * (load / 4000 - 1))
    return D * np.sin(C * np.arctan(x - E * (x - np.arctan(x))))


def wheel(kind="road_wheel", load: object = LOAD, **given: object) -> hb.Submodel:
    return hb.Submodel(f"rotational.{kind}", inputs={"load": load}, **given)


def held(v: float, rw: float, wheel: hb.Submodel) -> list[hb.Model]:
    """Hub and rim at given speeds, in every way."""
    m = hb.Model("bench", domain="rotational")
    m.add(
        w=wheel,
        turn=hb.Submodel("rotational.speed", inputs={"speed": rw / R}),
        tow=hb.Submodel("translational.speed", inputs={"speed": v}),
    )
    return every_way(m, "turn.shaft - w.shaft", "w.hub - tow.flange")


SPEEDS = [(10.0, 10.3), (0.0, 0.0), (10.0, 9.0), (10.0, 0.0), (5.0, -5.0), (0.0, 6.0), (-8.0, -9.0)]
"""Driven, at rest, braked, locked, against each other, spinning on the spot, backwards."""


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("v", "rw"), SPEEDS)
def test_in_even_motion_the_force_is_that_of_the_slip(v: float, rw: float) -> None:
    kappa = (rw - v) / max(abs(v), abs(rw)) if v or rw else 0.0
    points = ([0, 0.05, 0.12, 0.3, 1], [0, 0.8, 1, 0.9, 0.7])
    table = math.copysign(np.interp(abs(kappa), *points), kappa)
    for load, mu_load in ((4000.0, 0.0), (6000.0, -0.1)) if v < 10 else ((0.0, 0.0), (LOAD, 0.0)):
        cases = (
            ("road_wheel", magic(kappa, load, mu_load)),
            ("road_wheel_table", load * (1 + mu_load * (load / 4000 - 1)) * table),
        )
        for kind, force in cases:
            ways = held(v, rw, wheel(kind, load, mu_load=mu_load))
            for way in ways[::3] if load == LOAD else ways[:1]:
                run = hb.simulate(way, until=0.4)
                assert run["w.kappa"].at(0.4) == pytest.approx(kappa, abs=1e-6)
                assert run["w.force"].at(0.4) == pytest.approx(force, rel=1e-5, abs=1e-3)
                assert run["w.slip"].at(0.4) == pytest.approx(rw - v)


def settles(kappa: float, slip: float, travel: float) -> float:
    return (slip - travel * kappa) * (1 + (B * kappa) ** 2) / RELAX


def test_slip_settles_over_the_relaxation_length() -> None:
    """A small slip exponentially, a large one faster; at rest the tread goes with the hub."""
    t = np.array([0.005, 0.01, 0.05])
    for slip in (1e-4, 0.5, 5.0):
        travel = 10 + slip
        known = solve_ivp(
            lambda t, y, slip=slip, travel=travel: [settles(y[0], slip, travel)],
            (0, 0.05),
            [0],
            t_eval=t,
            rtol=1e-10,
            atol=1e-14,
        ).y[0]
        if slip < 1e-3:
            exponential = slip / travel * (1 - np.exp(-travel * t / RELAX))
            assert known == pytest.approx(exponential, rel=1e-7)
        for way in held(10.0, travel, wheel())[:: 1 if slip == 0.5 else 3]:
            run = hb.simulate(way, until=0.05, rtol=1e-9, atol=1e-13)
            assert run["w.kappa"].at(t) == pytest.approx(known, rel=1e-7)
            assert run["w.force"].at(t) == pytest.approx(magic(known), rel=1e-6)
            gives = RELAX / B * np.arctan(B * known)
            assert run["w.u"].at(t) == pytest.approx(gives, rel=1e-7)


def car(torque: str, push: str, **given: object) -> list[hb.Model]:
    m = hb.Model("car", domain="rotational")
    m.add(
        motor=hb.Submodel("rotational.torque", inputs={"torque": torque}),
        rim=hb.Submodel("rotational.inertia", J=1.2),
        w=wheel(**given),
        body=hb.Submodel("translational.mass", m=400),
        slope=hb.Submodel("translational.force", inputs={"force": push}),
    )
    m.bond("motor.shaft -> rim.shaft", "slope.flange -> body.flange")
    return every_way(m, "rim.shaft - w.shaft", "w.hub - body.flange")


@pytest.mark.sampled(1)
@pytest.mark.parametrize("sign", [1, -1])
def test_from_rest_it_drives_off_as_scipy_says(sign: int) -> None:
    """So hard that the wheel spins; the other way it is the mirror image."""

    def rates(t, y):
        rim, v, kappa = y
        force, travel = magic(kappa), max(abs(v), abs(R * rim))
        return [(1500 - R * force) / 1.2, force / 400, settles(kappa, R * rim - v, travel)]

    known = solve_ivp(rates, (0, 0.4), [0, 0, 0], "Radau", rtol=1e-9, atol=1e-11)
    for way in car(str(1500 * sign), "0"):
        run = hb.simulate(way, until=0.4, rtol=1e-8, atol=1e-10)
        found = [float(run[n].at(0.4)) for n in ("rim.speed", "body.speed", "w.kappa")]
        assert found == pytest.approx(sign * known.y[:, -1], rel=1e-6)
        assert run.audit().holds()
        assert found[0] * R * sign > 5 * abs(found[1]), "it does not spin"


def test_on_a_slope_it_stands_on_its_tread() -> None:
    """With the shaft held, it comes to rest where the spring of the tread bears the weight."""
    m = hb.Model("parked", domain="rotational")
    m.add(
        w=wheel(damping=8000),
        lock=hb.Submodel("rotational.frame"),
        body=hb.Submodel("translational.mass", m=400),
        slope=hb.Submodel("translational.force", inputs={"force": "-1000"}),
    )
    m.bond("slope.flange -> body.flange")
    for way in every_way(m, "lock.shaft - w.shaft", "w.hub - body.flange"):
        run = hb.simulate(way, until=2.0, rtol=1e-7)
        assert run["w.force"].at(2) == pytest.approx(1000, rel=1e-6)
        assert abs(run["body.speed"].at(2)) < 1e-6
        assert float(magic(run["w.kappa"].at(2))) == pytest.approx(1000, rel=1e-6)
        assert run["w.u"].at(1.9) == pytest.approx(run["w.u"].at(2.0), abs=1e-7), "it creeps"


def test_a_locked_wheel_slides_to_a_stop_and_rests() -> None:
    """Braked from 5 m/s by a shaft that is held: friction of full slip, then the tread's spring."""
    m = hb.Model("skid", domain="rotational")
    m.add(
        w=wheel("road_wheel_table", damping=8000, slow="1 m/s"),
        lock=hb.Submodel("rotational.frame"),
        body=hb.Submodel("translational.mass", m=400, v=5.0),
    )
    m.bond("lock.shaft -> w.shaft", "w.hub -> body.flange")
    run = hb.simulate(m, until=3.0, rtol=1e-8)
    assert run["w.force"].at(0.5) == pytest.approx(-0.7 * LOAD, rel=1e-6)
    slows = run["body.speed"].at(0.4) - run["body.speed"].at(0.6)
    assert slows == pytest.approx(0.7 * LOAD / 400 * 0.2, rel=1e-6)
    assert abs(run["body.speed"].at(3)) < 1e-6
    assert abs(run["w.force"].at(3)) < 1e-2
