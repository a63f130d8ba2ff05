"""Hydraulic parts against closed forms, with the bonds at their ports drawn in both directions."""

import math

import numpy as np
import pytest
from library.bench import every_way
from scipy.linalg import expm

import hybond as hb

RHO, G, ATM = 1000.0, 9.81, 101325.0


def part(name: str, inputs: dict[str, object] | None = None, **parameters: object) -> hb.Submodel:
    return hb.Submodel(f"hydraulic.{name}", inputs=inputs, **parameters)


def line(*joints: str, **parts: object) -> list[hb.Model]:
    """Parts in a line of pipes, drawn in every way."""
    m = hb.Model("line", domain="hydraulic")
    m.add(**parts)
    return every_way(m, *joints)


def smooth(dp: float, k: float, p_lam: float) -> float:
    """The law of an orifice, k times a root that is laminar around rest."""
    return k * dp / (dp**2 + p_lam**2) ** 0.25


@pytest.mark.parametrize(("level", "area"), [(1.0, 1.0), (0.4, 0.02)])
def test_a_tank_empties_as_torricelli_says(level, area):
    """``"hydraulic.tank"``, ``"hydraulic.orifice"``, ``"hydraulic.atmosphere"``."""
    cd, hole = 0.6, 4e-4
    end = area / (cd * hole) * math.sqrt(2 * level / G)
    for m in line(
        "tank.port - hole.inlet",
        "hole.outlet - air.port",
        tank=part("tank", area=area, level_0=level),
        hole=part("orifice", area=hole, Cd=cd, rho=RHO, p_lam="0.01 Pa"),
        air=part("atmosphere"),
    ):
        run = hb.simulate(m, until=0.9 * end, rtol=1e-9)
        t = np.linspace(0, 0.9 * end, 7)
        assert run["tank.level"].at(t) == pytest.approx(level * (1 - t / end) ** 2, rel=1e-6)
        assert run["hole.flow"].at(t) == pytest.approx(-run["tank.flow"].at(t))
        assert run["air.flow"].at(0) == pytest.approx(-run["hole.flow"].at(0))
        assert run["tank.level"].unit == "m"
        assert run["hole.flow"].unit == "m^3/s"


@pytest.mark.sampled(2)
@pytest.mark.parametrize("dp", [2e5, 300.0, -4e4, 0.0])
def test_an_orifice_is_turbulent_far_from_rest_and_laminar_at_rest(dp):
    """``"hydraulic.orifice"``, ``"hydraulic.variable_orifice"``: the law as it is written down."""
    k = 0.7 * 10e-6 * math.sqrt(2 / 870)
    for opening in (0.25, 1.0, 7.0, -1.0):
        for m in line(
            "high.port - hole.inlet",
            "hole.outlet - air.port",
            high=part("pressure_source", {"pressure": dp + 5e4}),
            hole=part("variable_orifice", {"opening": opening}),
            air=part("atmosphere", p="0.5 bar"),
        ):
            run = hb.simulate(m, until=1.0)
            expected = min(max(opening, 0.0), 1.0) * smooth(dp, k, 1e3)
            assert run["hole.flow"].at(0.5) == pytest.approx(expected, abs=1e-15)
            assert run["hole.pressure"].at(0.5) == pytest.approx(dp, abs=1e-9)
    if abs(dp) > 1e5:
        pure = math.copysign(k * math.sqrt(abs(dp)), dp)
        assert smooth(dp, k, 1e3) == pytest.approx(pure * (1 - (1e3 / dp) ** 2 / 4), rel=1e-9)


@pytest.mark.parametrize("d", [4e-3, 1e-2])
def test_laminar_flow_follows_hagen_and_poiseuille(d):
    """``"hydraulic.laminar_resistance"``, ``"hydraulic.pressure_source"``."""
    for m in line(
        "high.port - pipe.inlet",
        "pipe.outlet - air.port",
        high=part("pressure_source", p="0.1 bar"),
        pipe=part("laminar_resistance", d=d, length=2.0),
        air=part("atmosphere"),
    ):
        run = hb.simulate(m, until=1.0)
        flow = math.pi * d**4 * 1e4 / (128 * 0.04 * 2.0)
        assert run["pipe.flow"].at(1) == pytest.approx(flow)
        assert run["high.power"].at(1) == pytest.approx(1e4 * flow)
        mean = flow / (math.pi * d**2 / 4)
        assert run["pipe.reynolds"].at(1) == pytest.approx(870 * mean * d / 0.04)


def test_a_column_of_fluid_is_set_going_against_a_turbulent_resistance():
    """``"hydraulic.inertance"``, ``"hydraulic.turbulent_resistance"``: a hyperbolic tangent."""
    p, K, L = 2e5, 1e12, 870 * 3.0 / 1e-4
    for m in line(
        "high.port - column.inlet",
        "column.outlet - bend.inlet",
        "bend.outlet - air.port",
        high=part("pressure_source", p=p),
        column=part("inertance", length="3 m"),
        bend=part("turbulent_resistance", K=K),
        air=part("atmosphere"),
    ):
        run = hb.simulate(m, until=0.1, rtol=1e-9)
        t = np.linspace(0, 0.1, 6)
        expected = math.sqrt(p / K) * np.tanh(t * math.sqrt(p * K) / L)
        assert run["bend.flow"].at(t) == pytest.approx(expected, rel=1e-7, abs=1e-12)


@pytest.mark.slow
def test_a_compressible_volume_fills_until_a_relief_valve_opens():
    """``"hydraulic.volume"``, ``"hydraulic.flow_source"``, ``"hydraulic.relief_valve"``."""
    flow, C, p_set = 1e-4, 1e-3 / 1.4e9, 5e6
    opens = p_set * C / flow
    for R in (0.0, 2e10):
        for m in line(
            "air.port - pump.inlet",
            "pump.outlet - hose.port",
            "hose.port - relief.inlet",
            "relief.outlet - air.port",
            air=part("atmosphere"),
            pump=part("flow_source", Q=flow),
            hose=part("volume"),
            relief=part("relief_valve", p_set=p_set, R=R),
        ):
            run = hb.simulate(m, until=3 * opens, rtol=1e-9)
            (event,) = [e for e in run.events if e.cause != "start"]
            assert event.t == pytest.approx(opens, rel=1e-9)
            assert run["hose.pressure"].at(opens / 2) == pytest.approx(p_set / 2)
            after = 2 * opens
            rise = R * flow * (1 - math.exp(-after / (R * C))) if R else 0.0
            assert run["hose.pressure"].at(3 * opens) == pytest.approx(p_set + rise, rel=1e-7)
            assert run["relief.flow"].at(2.9 * opens) == pytest.approx(
                run["pump.power"].at(2.9 * opens) / run["hose.pressure"].at(2.9 * opens)
                - run["hose.flow"].at(2.9 * opens)
            )


@pytest.mark.parametrize(("cracking", "R"), [(0.0, 1e9), (5e4, 1e9)])
def test_a_check_valve_lets_one_half_of_a_wave_pass(cracking, R):
    """``"hydraulic.check_valve"``"""
    for m in line(
        "wave.port - valve.inlet",
        "valve.outlet - air.port",
        wave=part("pressure_source", {"pressure": "1e5 [Pa]*sin(10*time/(1 [s]))"}),
        valve=part("check_valve", cracking=cracking, R=R),
        air=part("atmosphere"),
    ):
        run = hb.simulate(m, until=1.0)
        t = np.linspace(0.01, 0.99, 50)
        expected = np.maximum(1e5 * np.sin(10 * t) - cracking, 0) / R
        assert run["valve.flow"].at(t) == pytest.approx(expected, abs=1e-12)
        first = math.asin(cracking / 1e5) / 10
        times = [e.t for e in run.events if e.cause != "start" and e.t > 0]
        expected = [
            first,
            math.pi / 10 - first,
            (2 * math.pi) / 10 + first,
            3 * math.pi / 10 - first,
        ]
        assert times == pytest.approx([t for t in expected if t > 0], abs=1e-9)


def test_an_ideal_check_valve_without_resistance_keeps_a_tank_full():
    """Two tanks: the water passes at once, and does not come back."""
    for m in line(
        "low.port - valve.outlet",
        "valve.inlet - pipe.outlet",
        "pipe.inlet - high.port",
        low=part("tank", level_0="1 m"),
        valve=part("check_valve"),
        pipe=part("inertance", L="1e6 kg/m^4"),
        high=part("tank", level_0="3 m"),
    ):
        run = hb.simulate(m, until=60.0, rtol=1e-9)
        # half a swing of the column between the tanks: the levels change places
        C = 1 / (RHO * G)
        half = math.pi * math.sqrt(1e6 * C / 2)
        (closing,) = [e for e in run.events if e.cause == "guard"]
        assert closing.t == pytest.approx(half, rel=1e-8)
        assert run["low.level"].at(60) == pytest.approx(3.0)
        assert run["high.level"].at(60) == pytest.approx(1.0)


@pytest.mark.slow
def test_a_valve_that_closes_stops_the_column_with_an_impulse():
    """``"hydraulic.valve"``: the momentum of the column is the impulse of pressure."""
    for m in line(
        "high.port - column.inlet",
        "column.outlet - valve.inlet",
        "valve.outlet - air.port",
        high=part("pressure_source", p="1 bar"),
        column=part("inertance"),
        valve=part("valve", {"gate": "time < 20 [ms]"}, p_lam="1 Pa"),
        air=part("atmosphere"),
    ):
        run = hb.simulate(m, until=0.03, rtol=1e-9)
        k, L = 0.7e-5 * math.sqrt(2 / 870), 870 / 1e-4
        flow = k * math.sqrt(1e5) * math.tanh(0.02 * math.sqrt(1e5 / k**2) / L)
        assert run["valve.flow"].at(0.02, side="left") == pytest.approx(flow, rel=1e-5)
        assert run["valve.flow"].at(0.025) == 0.0
        (closing,) = [e for e in run.events if e.cause == "time"]
        energy = closing.steps[-1].energy
        assert energy.lost == pytest.approx(L * flow**2 / 2 + 1e5 * 0, rel=1e-4)


def test_a_pipe_swings_between_its_ends_and_carries_a_steady_flow():
    """``"hydraulic.pipe"``: half the inertance on each side of the compliance."""
    L, C = 4 * 870 / (math.pi * 1e-4), math.pi * 1e-4 / 4 / 1.4e9
    for m in line(
        "left.port - pipe.inlet",
        "pipe.outlet - right.port",
        left=part("atmosphere"),
        pipe=part("pipe", R=0, p_0="2 bar"),
        right=part("atmosphere"),
    ):
        run = hb.simulate(m, until=2e-3, rtol=1e-9)
        t = np.linspace(0, 2e-3, 9)
        w = 2 / math.sqrt(L * C)
        assert run["pipe.middle.e"].at(t) == pytest.approx(2e5 * np.cos(w * t), abs=2e5 * 1e-6)
        assert run["pipe.outflow"].at(t) == pytest.approx(-run["pipe.inflow"].at(t))
    for m in line(
        "left.port - pipe.inlet",
        "pipe.outlet - right.port",
        left=part("pressure_source", p="1 bar"),
        pipe=part("pipe", length="10 m", d="6 mm"),
        right=part("atmosphere"),
    ):
        run = hb.simulate(m, until=2.0, solver="radau")
        flow = 1e5 * math.pi * 0.006**4 / (128 * 0.04 * 10)
        assert run["pipe.outflow"].at(2) == pytest.approx(flow, rel=1e-5)
        assert run["pipe.inflow"].at(2) == pytest.approx(flow, rel=1e-5)


@pytest.mark.parametrize("n", [1.0, 1.4])
def test_the_gas_of_an_accumulator_is_compressed_by_its_law(n):
    """``"hydraulic.accumulator"``, filled at a constant flow from its precharge on."""
    for m in line(
        "air.port - pump.inlet",
        "pump.outlet - store.port",
        air=part("atmosphere"),
        pump=part("flow_source", Q="0.1 L/s"),
        store=part("accumulator", n=n),
    ):
        run = hb.simulate(m, until=6.0, rtol=1e-10)
        t = np.linspace(0, 6, 7)
        gas = (5e6 + ATM) * (1e-3 / (1e-3 - 1e-4 * t)) ** n - ATM
        assert run["store.pressure"].at(t) == pytest.approx(gas, rel=1e-9)
        assert run["store.volume"].at(t) == pytest.approx(1e-4 * t)
        # the work of compression, and that against the atmosphere
        p0, v0, v1 = 5e6 + ATM, 1e-3, 4e-4
        work = p0 * v0 * (math.log(v0 / v1) if n == 1 else ((v0 / v1) ** (n - 1) - 1) / (n - 1))
        t = np.linspace(0, 6, 4001)
        done = np.trapezoid(run["pump.power"].at(t), t)
        assert done == pytest.approx(work - ATM * (v0 - v1), rel=1e-6)


@pytest.mark.slow
def test_an_accumulator_that_is_empty_gives_nothing_more():
    """The bladder lies at the shell; the flow then comes through a check valve."""
    p_0, n = 1e7, 1.4
    held = 1e-3 * (1 - ((5e6 + ATM) / (p_0 + ATM)) ** (1 / n))
    for m in line(
        "store.port - pump.inlet",
        "pump.outlet - air.port",
        "air.port - feed.inlet",
        "feed.outlet - store.port",
        store=part("accumulator", p_0=p_0),
        pump=part("flow_source", Q="0.1 L/s"),
        air=part("atmosphere"),
        feed=part("check_valve"),
    ):
        run = hb.simulate(m, until=6.0)
        empty = held / 1e-4
        assert [e.t for e in run.events if e.t > 0] == pytest.approx([empty], rel=1e-9)
        assert run["store.volume"].at(0) == pytest.approx(held)
        assert run["store.pressure"].at(6) == pytest.approx(5e6)
        assert run["store.flow"].at(5) == 0.0
        assert run["store.port.e"].at(5) == pytest.approx(0, abs=1e-6)
        assert run["feed.flow"].at(5) == pytest.approx(1e-4)


@pytest.mark.slow
def test_an_accumulator_below_its_precharge_is_empty():
    """The line is filled through a resistance, and takes no notice of it up to the precharge."""
    for m in line(
        "high.port - pipe.inlet",
        "pipe.outlet - store.port",
        "store.port - hose.port",
        high=part("pressure_source", p="80 bar"),
        pipe=part("laminar_resistance", R="1e10 Pa*s/m^3"),
        store=part("accumulator", p_0="20 bar"),
        hose=part("volume", C="1e-11 m^3/Pa", p_0="20 bar"),
    ):
        run = hb.simulate(m, until="0.3 s", rtol=1e-10)
        assert run["store.volume"].at(0) == 0.0
        t = 0.05
        expected = 8e6 - 6e6 * math.exp(-t / 0.1)
        assert run["hose.pressure"].at(t) == pytest.approx(expected, rel=1e-8)
        opens = [e.t for e in run.events if e.t > 0]
        assert opens == pytest.approx([0.1 * math.log(2)], rel=1e-8)
        assert run["store.volume"].at(0.3) > 0


def test_a_cone_fills_by_its_volume():
    """``"hydraulic.conical_tank"``"""

    def volume(h, r=0.1, s=0.5):
        return math.pi / (3 * s) * ((r + s * h) ** 3 - r**3)

    for m in line(
        "air.port - pump.inlet",
        "pump.outlet - cone.port",
        air=part("atmosphere"),
        pump=part("flow_source", Q="1 L/s"),
        cone=part("conical_tank", level_0="0.2 m"),
    ):
        run = hb.simulate(m, until=100.0)
        assert run["cone.level"].at(0) == pytest.approx(0.2)
        for t in (20.0, 100.0):
            assert volume(run["cone.level"].at(t)) == pytest.approx(volume(0.2) + 1e-3 * t)
        assert run["cone.pressure"].at(100) == pytest.approx(RHO * G * run["cone.level"].at(100))


def test_a_weir_passes_by_poleni_what_is_fed():
    """``"hydraulic.overflow_tank"`` over a second tank: no water is lost, it ends at the edge."""
    for m in line(
        "air.port - feed.inlet",
        "feed.outlet - upper.port",
        "upper.spill - lower.port",
        air=part("atmosphere"),
        feed=part("flow_source", {"flow": "if time < 500 [s] then 10 [L/s] else 0 [L/s]"}),
        upper=part("overflow_tank", area="1 m^2"),
        lower=part("tank", level_0=0, area="2 m^2"),
    ):
        run = hb.simulate(m, until=600.0, rtol=1e-9)
        begins = [e.t for e in run.events if e.cause == "guard"]
        assert begins == pytest.approx([50.0])
        head = (0.01 / (2 / 3 * 0.6 * 0.1 * math.sqrt(2 * G))) ** (2 / 3)
        assert run["upper.level"].at(500) == pytest.approx(1 + head, rel=1e-6)
        assert run["upper.overflow"].at(500) == pytest.approx(0.01, rel=1e-5)
        assert run["upper.volume"].at(600) + run["lower.volume"].at(600) == pytest.approx(5.5)


@pytest.mark.slow
def test_an_overflow_pipe_overshoots_and_loses_its_momentum():
    """``"hydraulic.overflow_pipe"``: between opening and closing it is a linear system."""
    area, L, R, edge, feed = 0.5, 1e6, 2.5e5, 0.8, 8e-3
    A = np.array([[0, -1 / area, 1 / area], [RHO * G / L, -R / L, 0], [0, 0, 0]])
    for m in line(
        "air.port - feed.inlet",
        "feed.outlet - tank.port",
        "tank.port - over.inlet",
        "over.outlet - air.port",
        air=part("atmosphere"),
        feed=part("flow_source", Q=feed),
        tank=part("tank", area=area, level_0="0.7 m"),
        over=part("overflow_pipe", edge=edge, L=L, R=R),
    ):
        run = hb.simulate(m, until=30.0, rtol=1e-9)
        opens, closes = [e for e in run.events if e.cause == "guard"][:2]
        assert opens.t == pytest.approx(0.1 * area / feed)
        for t in (opens.t + 1.0, closes.t):
            level, flow, _ = expm(A * (t - opens.t)) @ [edge, 0, feed]
            assert run["tank.level"].at(t) == pytest.approx(level, rel=1e-7)
            assert run["over.flow"].at(t, side="left") == pytest.approx(flow, rel=1e-6)
        assert level == pytest.approx(edge, rel=1e-7)
        assert sum(s.energy.lost for s in closes.steps if s.energy) == pytest.approx(
            L * flow**2 / 2, rel=1e-6
        )


@pytest.mark.parametrize("leak", [0.0, 1e-12])
def test_a_pump_drives_a_motor(leak):
    """``"hydraulic.pump"``, ``"hydraulic.motor"``: speeds by displacement, less what leaks."""
    D1, D2, speed, load, rub = 20e-6, 50e-6, 100.0, 3.0, 0.01
    m = hb.Model("drive", domain="hydraulic")
    m.add(
        engine=hb.Sf("100 rad/s", domain="rotational"),
        crank=hb.One(domain="rotational"),
        pump=part("pump", D=D1, leakage=leak, friction=rub),
        motor=part("motor", D=D2, leakage=leak, friction=rub),
        wheel=hb.One(domain="rotational"),
        brake=hb.R(load, domain="rotational"),
        tank=part("atmosphere"),
    )
    m.bond("engine -> crank", "wheel -> brake")
    for way in every_way(
        m,
        "crank - pump.shaft",
        "pump.outlet - motor.inlet",
        "motor.outlet - tank.port",
        "tank.port - pump.inlet",
        "motor.shaft - wheel",
    ):
        run = hb.simulate(way, until=1.0)
        # flow of the pump = D2*w + 2*leak*p with p = (load + rub)*w/D2
        w = D1 * speed / (D2 + 2 * leak * (load + rub) / D2)
        p = (load + rub) * w / D2
        assert run["motor.speed"].at(1) == pytest.approx(w)
        assert run["pump.pressure"].at(1) == pytest.approx(p)
        assert run["motor.pressure"].at(1) == pytest.approx(p)
        assert run["pump.flow"].at(1) == pytest.approx(D1 * speed - leak * p)
        assert run["motor.flow"].at(1) == pytest.approx(D1 * speed - leak * p)
        assert run["pump.torque"].at(1) == pytest.approx(D1 * p + rub * speed)
        assert run["motor.torque"].at(1) == pytest.approx(load * w)
        if leak == 0:
            assert w / speed == pytest.approx(D1 / D2)
        assert run["pump.torque"].unit == "N*m"


def bodied(cylinder: hb.Submodel, mass: float, **parts: object) -> hb.Model:
    """A cylinder whose rod moves a mass."""
    m = hb.Model("press", domain="hydraulic")
    m.add(
        cylinder=cylinder,
        body=hb.One(domain="translational"),
        mass=hb.I(mass, domain="translational"),
        **parts,
    )
    m.bond("body -> mass")
    return m


@pytest.mark.slow
def test_a_locked_cylinder_is_a_spring():
    """``"hydraulic.cylinder"``: both ports closed, a small push; the field keeps its energy."""
    E, Aa, Ab, mass = 1.4e9, 1e-3, 6e-4, 50.0
    for x in (0.05, 0.2):
        Va, Vb = 20e-6 + Aa * x, 20e-6 + Ab * (0.3 - x)
        w = math.sqrt(E / mass * (Aa**2 / Va + Ab**2 / Vb))
        m = bodied(part("cylinder", x_0=x), mass)
        m.elements["mass"].options["f"] = "1 mm/s"
        for way in every_way(m, "cylinder.rod - body"):
            run = hb.simulate(way, until=6 * math.pi / w, rtol=1e-10)
            t = np.linspace(0, 6 * math.pi / w, 31)
            assert run["cylinder.speed"].at(t) == pytest.approx(1e-3 * np.cos(w * t), abs=5e-7)
            assert run.audit().holds(1e-8)
            assert run["cylinder.force"].at(t) == pytest.approx(
                Aa * run["cylinder.pressure_a"].at(t) - Ab * run["cylinder.pressure_b"].at(t),
                abs=1e-3,
            )


@pytest.mark.slow
def test_speeds_of_a_cylinder_are_in_the_ratio_of_its_areas_and_end_at_the_stops():
    """A flow drives it out, then in."""
    flow = "if time < 2 [s] then 0.1 [L/s] else -0.1 [L/s]"
    for into, other, area in (("a", "b", 1e-3), ("b", "a", 6e-4)):
        m = bodied(
            part("cylinder", x_0="0.2 m"),
            0.5,
            air=part("atmosphere"),
            pump=part("flow_source", {"flow": flow}),
            rub=hb.R("2000 N*s/m", domain="translational"),
            relief=part("relief_valve", p_set="100 bar"),
            feed=part("check_valve"),
        )
        m.bond("body -> rub", "air.port -> pump.inlet", "air.port -> feed.inlet")
        m.bond("relief.outlet -> air.port", f"feed.outlet -> cylinder.{into}")
        for way in every_way(
            m,
            f"pump.outlet - cylinder.{into}",
            f"cylinder.{into} - relief.inlet",
            f"cylinder.{other} - air.port",
            "cylinder.rod - body",
        )[:: 9 if into == "a" else 15]:
            run = hb.simulate(way, until=2.5, solver="radau")
            sign = 1 if into == "a" else -1
            assert run["cylinder.speed"].at(0.5) == pytest.approx(sign * 0.1e-3 / area, rel=2e-3)
            # at the stop the relief valve takes the flow, and the stop the force
            end = 0.3 if into == "a" else 0.0
            assert run["cylinder.position"].at(2.0) == pytest.approx(end, abs=1e-9)
            assert run["relief.flow"].at(1.99) == pytest.approx(1e-4, rel=1e-6)
            assert run[f"cylinder.pressure_{into}"].at(1.99) == pytest.approx(1e7, rel=1e-9)


@pytest.mark.slow
def test_a_stop_gives_back_what_its_restitution_says():
    for restitution in (0.0, 0.5):
        m = bodied(part("cylinder", x_0="0.29 m", restitution=restitution), 5.0)
        m.add(air=part("atmosphere"))
        m.elements["mass"].options["f"] = "0.5 m/s"
        for way in every_way(
            m, "cylinder.a - air.port", "cylinder.b - air.port", "cylinder.rod - body"
        )[:: 1 if restitution else 3]:
            run = hb.simulate(way, until=0.03)
            hit = next(e for e in run.events if e.t > 0)
            assert hit.t == pytest.approx(0.02)
            assert run["cylinder.speed"].at(0.03) == pytest.approx(-0.5 * restitution, abs=1e-9)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("spool", [1, 0, -1])
@pytest.mark.slow
def test_a_directional_valve_turns_the_flow_round(spool):
    """``"hydraulic.directional_valve"``: two ways and a load in a row, solved by hand."""
    p, R, k = 1e7, 5e10, 0.7e-5 * math.sqrt(2 / 870)
    flow = (-R + math.sqrt(R**2 + 8 * p / k**2)) / (4 / k**2)
    for m in line(
        "supply.port - valve.p",
        "valve.t - air.port",
        "valve.a - load.inlet",
        "load.outlet - valve.b",
        supply=part("pressure_source", p=p),
        air=part("atmosphere"),
        valve=part("directional_valve", {"spool": spool}, p_lam="1 Pa"),
        load=part("laminar_resistance", R=R),
    )[:: 1 if spool > 0 else 5]:
        run = hb.simulate(m, until=1.0)
        for name, sign in (("load.flow", spool), ("valve.flow_a", spool), ("valve.flow_b", -spool)):
            assert run[name].at(1) == pytest.approx(sign * flow, abs=1e-9 * flow)
        assert run["valve.flow_p"].at(1) == pytest.approx(abs(spool) * flow)
        assert run["valve.flow_t"].at(1) == pytest.approx(abs(spool) * flow)
        state = {1: "straight", 0: "closed", -1: "crossed"}[spool]
        assert run.graph.mode_names(run.events[-1].steps[-1].mode)["valve.valve"] == state


@pytest.mark.sampled(1)
@pytest.mark.parametrize("command", [0.5, -0.25, 3.0])
@pytest.mark.slow
def test_a_servo_valve_opens_in_proportion(command):
    """``"hydraulic.servo_valve"``: the spool is a lag, the flow that of two orifices in a row."""
    p, k = 7e6, 0.7e-5 * math.sqrt(2 / 870)
    for m in line(
        "supply.port - valve.p",
        "valve.t - air.port",
        "valve.a - load.inlet",
        "load.outlet - valve.b",
        supply=part("pressure_source", p=p),
        air=part("atmosphere"),
        valve=part("servo_valve", {"command": command}, p_lam="1 Pa"),
        load=part("laminar_resistance", R="1 Pa*s/m^3"),
    )[:: 1 if command == 0.5 else 5]:
        run = hb.simulate(m, until=0.02, rtol=1e-9)
        goal = min(command, 1.0)
        t = np.array([0.002, 0.01, 0.02])
        spool = goal * (1 - np.exp(-t / 0.005))
        assert run["valve.spool"].at(t) == pytest.approx(spool, rel=1e-6)
        assert run["load.flow"].at(t) == pytest.approx(spool * k * math.sqrt(p / 2), rel=1e-6)
        assert run["valve.flow_p"].at(t) == pytest.approx(run["valve.flow_t"].at(t))


@pytest.mark.slow
def test_a_press_of_many_parts_moves_at_the_speed_of_its_pump_and_ends_on_its_relief_valve():
    """Pump, check valve, accumulator line, directional valve, cylinder: joined as on a machine."""
    D, speed, leak, p_set, R, load = 10e-6 / (2 * math.pi), 150.0, 2e-13, 15e6, 1e9, 5e3
    m = bodied(
        part("cylinder", x_0="0.27 m"),
        20.0,
        engine=hb.Sf("150 rad/s", domain="rotational"),
        crank=hb.One(domain="rotational"),
        tank=part("atmosphere"),
        pump=part("pump", D=D, leakage=leak),
        back=part("check_valve"),
        rail=part("volume", volume="0.1 L"),
        relief=part("relief_valve", p_set=p_set, R=R),
        valve=part("directional_valve", {"spool": "if time < 10 [ms] then 0 else 1"}),
        rub=hb.R("500 N*s/m", domain="translational"),
        push=hb.Se(-load, domain="translational"),
    )
    m.bond("engine -> crank -> pump.shaft", "tank.port -> pump.inlet", "pump.outlet -> back.inlet")
    m.bond("back.outlet -> rail.port", "rail.port -> relief.inlet", "relief.outlet -> tank.port")
    m.bond("rail.port -> valve.p", "valve.t -> tank.port", "valve.a -> cylinder.a")
    m.bond("cylinder.b -> valve.b", "cylinder.rod -> body -> rub", "push -> body")
    run = hb.simulate(m, until=0.19, solver="radau")
    assert run.status == "ok"
    assert run["cylinder.position"].at(0.19) == pytest.approx(0.3, abs=1e-9)
    # at the stop the pump's flow goes over the relief valve: p = p_set + R*(D*w - leak*p)
    p = (p_set + R * D * speed) / (1 + R * leak)
    assert run["rail.pressure"].at(0.19) == pytest.approx(p, rel=1e-6)
    assert run["relief.flow"].at(0.19) == pytest.approx(D * speed - leak * p, rel=1e-5)
    assert run["pump.torque"].at(0.19) == pytest.approx(D * p, rel=1e-6)
    # on its way: what the pump gives is what chamber a takes
    t = np.linspace(0.1, 0.13, 31)
    flow = run["pump.flow"].at(t).mean()
    assert run["cylinder.speed"].at(t).mean() == pytest.approx(flow / 1e-3, rel=0.03)
