"""Pipes with losses, valves with their faults, cushions, against closed forms and SciPy."""

import math

import numpy as np
import pytest
from library.bench import every_way
from scipy.optimize import brentq

import hybond as hb


def part(name: str, inputs: dict[str, object] | None = None, **parameters: object) -> hb.Submodel:
    return hb.Submodel(f"hydraulic.{name}", inputs=inputs, **parameters)


def line(*joints: str, **parts: object) -> list[hb.Model]:
    m = hb.Model("line", domain="hydraulic")
    m.add(**parts)
    return every_way(m, *joints)


D, LENGTH, RHO, ETA = 0.02, 10.0, 1000.0, 1e-3


def darcy(flow: float, rough: float, zeta: float = 0.0) -> float:
    """The drop of pressure by lambda(Re), as it is written down."""
    v = flow / (math.pi * D**2 / 4)
    re = RHO * abs(v) * D / ETA
    if re == 0:
        return 0.0
    smooth = 64 / re
    rooted = -1.8 * math.log10((rough / D / 3.7) ** 1.11 + 6.9 / max(re, 2000))
    x = min(max((re - 2000) / 2000, 0), 1)
    part = x * x * (3 - 2 * x)
    factor = (1 - part) * smooth + part / rooted**2
    return (factor * LENGTH / D + zeta) * RHO * v * abs(v) / 2


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("rough", "zeta"), [(0.0, 0.0), (1e-4, 3.0)])
@pytest.mark.slow
def test_a_pipe_loses_by_darcy_and_weisbach(rough: float, zeta: float) -> None:
    """``"hydraulic.pipe_loss"``, by a flow that grows through zero to Re = 60000."""
    most = 60000 * math.pi * D * ETA / 4 / RHO
    pump = part("flow_source", {"flow": f"{most} [m^3/s^2]*(time - 0.2 [s])"})
    pipe = part("pipe_loss", length=LENGTH, d=D, rough=rough, zeta=zeta)
    for m in line(
        "air.port - pump.inlet",
        "pump.outlet - pipe.inlet",
        "pipe.outlet - air.port",
        air=part("atmosphere"),
        pump=pump,
        pipe=pipe,
    ):
        run = hb.simulate(m, until=1.2)
        t = np.array([0, 0.15, 0.19, 0.2, 0.22, 0.2333, 0.24, 0.25, 0.26, 0.3, 0.7, 1.2])
        flow = most * (t - 0.2)
        assert run["pipe.flow"].at(t) == pytest.approx(flow)
        drops = [darcy(float(q), rough, zeta) for q in flow]
        assert run["pipe.pressure"].at(t) == pytest.approx(drops, rel=1e-9, abs=1e-9)
        assert run["pipe.reynolds"].at(1.2) == pytest.approx(60000)
        assert run["pipe.velocity"].at(1.2) == pytest.approx(3.0)
        grid = run["pipe.pressure"].at(np.linspace(0, 1.2, 2001))
        assert (np.diff(grid) > 0).all(), "more flow for less pressure"


def test_the_curve_of_a_pipe_meets_what_is_tabulated() -> None:
    """Colebrook and White, which Haaland's formula follows within 2 percent."""
    for re, rough in ((1e5, 1e-3), (1e6, 1e-4), (2e4, 0.01)):

        def colebrook(x: float, re: float = re, rough: float = rough) -> float:
            return x + 2 * math.log10(rough / 3.7 + 2.51 * x / re)

        flow = re * math.pi * D * ETA / 4 / RHO
        v = flow / (math.pi * D**2 / 4)
        known = LENGTH / D * RHO * v**2 / 2 / brentq(colebrook, 0.1, 100) ** 2
        (m,) = line(
            air=part("atmosphere"),
            pump=part("flow_source", Q=flow),
            pipe=part("pipe_loss", length=LENGTH, d=D, rough=rough * D),
        )
        m.bond("air.port -> pump.inlet", "pump.outlet -> pipe.inlet", "pipe.outlet -> air.port")
        found = hb.simulate(m, until=1e-3)["pipe.pressure"].at(0)
        assert found == pytest.approx(known, rel=0.02)


@pytest.mark.parametrize("pressure", [3e5, 60.0, -2e4, 0.0])
def test_a_pipe_between_two_pressures_finds_its_flow(pressure: float) -> None:
    flow = brentq(lambda q: darcy(q, 5e-5) - pressure, -0.01, 0.01, xtol=1e-16)
    for m in line(
        "high.port - pipe.inlet",
        "pipe.outlet - air.port",
        high=part("pressure_source", p=pressure),
        pipe=part("pipe_loss", length=LENGTH, d=D),
        air=part("atmosphere"),
    )[::3]:
        run = hb.simulate(m, until=0.1)
        assert run["pipe.flow"].at(0.1) == pytest.approx(flow, rel=1e-6, abs=1e-12)


def test_a_check_valve_that_snaps_opens_late_and_closes_early() -> None:
    """``"hydraulic.snap_check_valve"``: pressure up and down along a triangle."""
    k = 0.7 * 1e-5 * math.sqrt(2 / 870)
    for m in line(
        "high.port - valve.inlet",
        "valve.outlet - air.port",
        high=part("pressure_source", {"pressure": "1 [bar] - abs(time - 1 [s])*(2 [bar/s])"}),
        valve=part("snap_check_valve", p_lam="1 Pa"),
        air=part("atmosphere"),
    ):
        run = hb.simulate(m, until=2.0)
        times = [e.t for e in run.events if e.cause == "guard"]
        assert times == pytest.approx([0.75, 1.4], rel=1e-9)
        assert run["valve.open"].at([0.7, 1.0, 1.3, 1.5]) == pytest.approx([0, 1, 1, 0])
        assert run["valve.flow"].at([0.1, 0.7, 1.5]) == pytest.approx([0, 0, 0])
        assert run["valve.flow"].at(1.3) == pytest.approx(k * math.sqrt(0.4e5), rel=1e-6)


def test_a_relief_valve_overrides_until_it_is_wide_open() -> None:
    """``"hydraulic.spring_relief_valve"``, by the pressures and by the flow."""
    p, over, k = 2e7, 2e6, 0.7 * 2e-5 * math.sqrt(2 / 870)

    def flow(dp: float) -> float:
        return k * min(max((dp - p) / over, 0), 1) * math.sqrt(max(dp, 0))

    for dp in (-1e5, 0.0, 1.9e7, 2.05e7, 2.2e7, 2.5e7):
        ways = line(
            "high.port - valve.inlet",
            "valve.outlet - air.port",
            high=part("pressure_source", p=dp),
            valve=part("spring_relief_valve"),
            air=part("atmosphere"),
        )
        for m in ways if dp == 2.05e7 else ways[:1]:
            run = hb.simulate(m, until=0.1)
            assert run["valve.flow"].at(0.1) == pytest.approx(flow(dp), rel=1e-9)
    pump = line(
        "pump.outlet - valve.inlet",
        "valve.outlet - pump.inlet",
        "air.port - valve.outlet",
        pump=part("flow_source", Q=flow(2.1e7)),
        valve=part("spring_relief_valve"),
        air=part("atmosphere"),
        hose=part("volume", p_0="200.5 bar"),
    )
    for m in pump[::7]:
        m.bond("pump.outlet -> hose.port")
        run = hb.simulate(m, until=0.1, solver="radau")
        assert run["valve.pressure"].at(0.1) == pytest.approx(2.1e7, rel=1e-6)
        assert run["valve.opening"].at(0.1) == pytest.approx(1e-5, rel=1e-5)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("command", [0.6, -0.6, 0.08, 5.0])
def test_a_proportional_valve_swings_and_has_a_dead_band(command: float) -> None:
    """``"hydraulic.proportional_valve"``: the step of a second-order lag, then the opening."""
    p, k, w, z = 7e6, 0.7e-5 * math.sqrt(2 / 870), 300.0, 0.6
    ways = line(
        "supply.port - valve.p",
        "valve.t - air.port",
        "valve.a - load.inlet",
        "load.outlet - valve.b",
        supply=part("pressure_source", p=p),
        air=part("atmosphere"),
        valve=part("proportional_valve", {"command": command}, p_lam="1 Pa", zeta=z),
        load=part("laminar_resistance", R="1 Pa*s/m^3"),
    )
    goal, damped = max(min(command, 1), -1), w * math.sqrt(1 - z**2)
    t = np.array([0.002, 0.008, 0.015, 0.04])
    swing = np.cos(damped * t) + z / math.sqrt(1 - z**2) * np.sin(damped * t)
    spool = goal * (1 - np.exp(-z * w * t) * swing)
    opening = np.sign(spool) * np.clip((abs(spool) - 0.1) / 0.9, 0, 1)
    for m in ways[:: 3 if command == 0.6 else 5]:
        run = hb.simulate(m, until=0.04, rtol=1e-8, atol=1e-12)
        assert run["valve.spool"].at(t) == pytest.approx(spool, abs=1e-7)
        flow = opening * k * math.sqrt(p / 2)
        assert run["load.flow"].at(t) == pytest.approx(flow, rel=1e-5, abs=1e-10)
        assert run["valve.flow_p"].at(t) == pytest.approx(abs(flow), rel=1e-5, abs=1e-10)
        assert run["valve.flow_p"].at(t) == pytest.approx(run["valve.flow_t"].at(t))
    assert (command != 0.08) or not flow.any(), "inside the overlap nothing flows"
