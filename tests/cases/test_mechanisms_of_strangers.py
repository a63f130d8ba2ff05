"""Seesaws, winches, spinning balls and gears that lock, each against what it comes to by hand."""

import math

import numpy as np
import pytest

import hybond as hb

G = 9.81
Told = tuple[hb.Model, float, list[float], dict[tuple[str, float], float]]


def capstan() -> Told:
    """A load on a rope with two turns about a bollard: by Euler and Eytelwein."""
    m = hb.Model("capstan", domain="translational", parameters={"mu": 0.25, "turns": 2})
    m.add(load=hb.I("50 kg"), v=hb.One(), weight=hb.Se(50 * G), hand=hb.Se("-hold"))
    m.add(rub=hb.One(law="coulomb", limit="hold*(exp(mu*2*pi*turns) - 1)"))
    m.bond("weight -> v -> load", "hand -> v", "v -> rub")
    m.input(hold=hb.Input(table=[[0, "15 N"], ["1 s", "40 N"]]))
    m.signal(y=hb.Integral("v.f"))
    taut = math.exp(0.25 * 4 * math.pi)
    fast, slows = G - 15 * taut / 50, 40 * taut / 50 - G
    ends = 1 + fast / slows
    way = fast / 2 + fast * (ends - 1) / 2
    return m, 2.0, [ends], {("v.f", 1.0): fast, ("y", 2.0): way, ("rub.e", 2.0): 50 * G - 40}


def seesaw() -> Told:
    """80 kg fall 2 m onto one end, plastically; 40 kg on the other one are thrown."""
    m = hb.Model("seesaw", domain="translational")
    m.add(A=hb.I("80 kg"), B=hb.I("40 kg"), a=hb.One(), b=hb.One())
    m.add(wa=hb.Se(-80 * G), wb=hb.Se(-40 * G))
    m.add(J=hb.I("30 kg*m^2", domain="rotational"), w=hb.One(domain="rotational"))
    m.add(arm_a=hb.TF("1.5 m/rad"), arm_b=hb.TF("2 m/rad"))
    m.add(end_a=hb.Zero(law="unilateral", gap="y_a - 1.5*phi"))
    m.add(end_b=hb.Zero(law="unilateral", gap="y_b + 2*phi"))
    m.add(floor_a=hb.Zero(law="unilateral", gap="0.3 + phi", domain="rotational"))
    m.add(floor_b=hb.Zero(law="unilateral", gap="0.3 - phi", domain="rotational"))
    m.bond("wa -> a -> A", "wb -> b -> B", "w -> J", "floor_a -> w -> floor_b")
    m.bond("w -> arm_a.1", "arm_a.2 -> end_a -> a", "end_b -> b", "end_b -> arm_b.2")
    m.bond("arm_b.1 -> w")
    m.signal(y_a=hb.Integral("a.f", 2.45), y_b=hb.Integral("b.f", -0.6))
    m.signal(phi=hb.Integral("w.f", 0.3))
    lands = 2 / math.sqrt(G)
    inertia = 30 + 80 * 1.5**2 + 40 * 2**2
    turns = 80 * 1.5 * 2 * math.sqrt(G) / inertia
    gains = (80 * 1.5 - 40 * 2) * G / inertia
    stops = lands + (math.sqrt(turns**2 + 2 * gains * 0.6) - turns) / gains
    thrown = 2 * math.sqrt(turns**2 + 2 * gains * 0.6)
    there = {("b.f", stops): thrown, ("phi", stops + 0.2): -0.3, ("end_a.e", stops + 0.2): 80 * G}
    return m, stops + 0.3, [lands, stops], there


def superball() -> Told:
    """A ball with spin lands: it slides through the impact, with friction as an impulse."""
    m = hb.Model("ball", domain="translational")
    m.add(mx=hb.I("0.1 kg", f=1.0), my=hb.I("0.1 kg", f=-3.0), x=hb.One(), y=hb.One())
    m.add(J=hb.I("1e-4 kg*m^2", f=200.0, domain="rotational"), w=hb.One(domain="rotational"))
    m.add(r=hb.TF("-40 mm/rad"), n=hb.Zero(), weight=hb.Se(-0.1 * G))
    m.add(slip=hb.One(law="coulomb", limit="0.2*floor.e", impulsive=True))
    m.add(floor=hb.Zero(law="unilateral", gap="h", restitution=0.8))
    m.bond("x -> mx", "y -> my", "w -> J", "w -> r -> n", "x -> n -> slip", "floor -> y")
    m.bond("weight -> y")
    m.signal(h=hb.Integral("y.f", 0.5))
    down = math.sqrt(9 + G)
    given = 0.2 * 0.1 * 1.8 * down
    lands = (down - 3) / G
    there = {("x.f", lands): 1 + given / 0.1, ("w.f", lands): 200 - 0.04 * given / 1e-4}
    return m, lands + 0.2, [lands], there


def bowling_ball() -> Told:
    """It slides until it rolls, at 5/7 of its speed, and goes on rolling up a slope."""
    m = hb.Model("ball", domain="translational", parameters={"m": "6 kg", "r": "0.108 m"})
    m.add(ball=hb.I("m", f=8.0), v=hb.One(), foot=hb.Zero(), turn=hb.TF("1 [rad]/r"))
    m.add(spin=hb.I("0.4*m*r^2", domain="rotational"), w=hb.One(domain="rotational"))
    m.add(rub=hb.One(law="coulomb", limit="0.12*m*9.81 [m/s^2]*cos(slope)"))
    m.add(weight=hb.Se("-m*9.81 [m/s^2]*sin(slope)"))
    m.bond("v -> ball", "w -> spin", "v -> foot -> turn -> w", "foot -> rub", "weight -> v")
    m.signal(x=hb.Integral("v.f"), slope="if x > 18 [m] then 0.1 else 0")
    rolls, speed = 16 / (7 * 0.12 * G), 40 / 7
    foot = rolls + (18 - (8 + speed) / 2 * rolls) / speed
    slower = 5 / 7 * G * math.sin(0.1)
    there = {("v.f", rolls): speed, ("v.f", foot + 1): speed - slower}
    return m, foot + 1, [rolls], there | {("rub.e", foot + 0.5): -2 / 7 * 6 * G * math.sin(0.1)}


def differential() -> Told:
    """Two axles on one cage, each with its own drag, are locked and let go."""
    m = hb.Model("differential", domain="rotational")
    m.add(engine=hb.Se("100 N*m"), E=hb.I(0.2), c=hb.One(), cage=hb.Zero(), lock=hb.Zero())
    m.add(L=hb.I(1.5), R=hb.I(1.0), left=hb.One(), right=hb.One())
    m.add(l=hb.TF(0.5), r=hb.TF(0.5), dl=hb.R(20.0), dr=hb.R(2.0))
    m.bond("engine -> c -> E", "left -> L", "right -> R", "left -> dl", "right -> dr")
    m.bond("left -> l -> cage", "right -> r -> cage", "cage -> c", "left -> lock -> right")
    m.machine(
        "k",
        states={"free": [], "locked": ["lock"]},
        start="free",
        rules=["free -> locked when time >= 1 and time < 2", "locked -> free when time >= 2"],
    )
    inertia = np.array([[1.5 + 0.05, 0.05], [0.05, 1.0 + 0.05]])
    values, vectors = np.linalg.eig(np.linalg.solve(inertia, np.diag([20.0, 2.0])))
    steady = np.array([2.5, 25.0])

    def later(speeds: np.ndarray) -> np.ndarray:
        """Return the speeds of free axles a second later."""
        parts = np.linalg.solve(vectors, speeds - steady)
        return steady + vectors @ (np.exp(-values) * parts)

    apart = later(np.zeros(2))
    joined = (inertia @ apart).sum() / 2.7
    ends = 100 / 22 + (joined - 100 / 22) * math.exp(-22 / 2.7)
    last = later(np.array([ends, ends]))
    there = {("left.f", 1.0): joined, ("right.f", 2.0): ends}
    return m, 3.0, [1.0, 2.0], there | {("left.f", 3.0): last[0], ("right.f", 3.0): last[1]}


def docking() -> Told:
    """Two craft are one from where they meet until one brakes both and the latch lets go."""
    m = hb.Model("docking", domain="translational")
    m.add(A=hb.I("300 kg", f=0.2), B=hb.I("0.7 t"), a=hb.One(), b=hb.One(), latch=hb.Zero())
    m.add(jet=hb.Se("if time < 12 [s] then 0 else -4"))
    m.bond("a -> A", "b -> B", "jet -> a -> latch -> b")
    m.signal(gap=hb.Integral("b.f - a.f", "0.4 m"))
    m.machine(
        "dock",
        states={"free": [], "held": ["latch"], "gone": []},
        start="free",
        rules=["free -> held when gap <= 0", "held -> gone when latch.e < 0 and a.f < 0.05"],
    )
    parts = 12 + 0.01 / 0.004
    there = {("a.f", 3.0): 0.06, ("latch.e", 13.0): -2.8, ("b.f", 20.0): 0.05}
    return m, 20.0, [2.0, parts], there | {("gap", 20.0): 2 / 300 * (20 - parts) ** 2}


CASES = [capstan, seesaw, superball, bowling_ball, differential, docking]


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.__name__)
def test_a_mechanism_in_closed_form(case, solver: str) -> None:
    model, until, instants, values = case()
    run = hb.simulate(model, until, solver=solver)
    times = [event.t for event in run.events[1:] if event.t > 1e-9]
    assert times == pytest.approx(instants, rel=1e-8)
    for (signal, t), value in values.items():
        at = next((own for own, told in zip(times, instants) if told == t), t)
        assert run[signal].at(at) == pytest.approx(value, rel=1e-6), signal
    assert run.audit().holds()
