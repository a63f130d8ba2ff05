"""Hybrid systems of textbooks and papers, each against what it comes to by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipkinc

import hybond as hb

G = 9.81
Told = tuple[hb.Model, float, list[float], dict[tuple[str, float], float]]


def two_relays() -> Told:
    """x1' = -s1 + 2 s2, x2' = -2 s1 - s2 winds into the origin: Acary & Brogliato 2008.

    Each quarter turn takes a third of what the last one took, and it rests after one second.
    """
    m = hb.Model("two relays")
    m.add(a=hb.Sf("-s1 + 2*s2"), b=hb.Sf("-2*s1 - s2"), n1=hb.Zero(), n2=hb.Zero())
    m.add(c1=hb.C(1.0, q=1.0), c2=hb.C(1.0, q=1.0))
    m.bond("a -> n1 -> c1", "b -> n2 -> c2")
    for k in "12":
        rules = [f"up -> down when c{k}.q < 0", f"down -> up when c{k}.q > 0"]
        m.machine(f"k{k}", states={"up": [], "down": []}, start="up", rules=rules)
        m.signal(**{f"s{k}": f'if k{k}.state == "up" then 1 else -1'})
    turns = [1 - 2 / 3 ** (k + 1) for k in range(8)]
    there = {("c1.q", 1 / 3): 4 / 3, ("c2.q", 7 / 9): -4 / 9, ("c1.q", 25 / 27): -4 / 27}
    return m, 2.0, turns, there | {("c1.q", 1.5): 0.0, ("c2.q", 1.5): 0.0}


def impact_pair() -> Told:
    """A ball in a box that is free as well: what is left of the speed is e^n, and so are times."""
    box, ball, e = 3.0, 1.0, 0.8
    m = hb.Model("impact pair", domain="translational")
    m.add(M=hb.I(box), b=hb.I(ball, f=2.0), V=hb.One(), v=hb.One())
    m.add(right=hb.Zero(law="unilateral", gap="0.5 - y", restitution=e))
    m.add(left=hb.Zero(law="unilateral", gap="0.5 + y", restitution=e))
    m.bond("V -> M", "v -> b", "v -> right -> V", "V -> left -> v")
    m.signal(y=hb.Integral("v.f - V.f"))
    hits = [0.25 + sum(1 / (2 * e**j) for j in range(1, k + 1)) for k in range(10)]
    left = 2 * e**10
    end = hits[-1] + 0.01
    return m, end, hits, {("v.f", end): 0.5 + 0.75 * left, ("V.f", end): 0.5 - 0.25 * left}


def commutation() -> Told:
    """Three phases with inductance feed a constant current: Mohan, Undeland, Robbins, ch. 6.

    One diode takes over from another while cos(u) is 1 - 2 w L I / (sqrt(3) V).
    """
    volts, w, coil, amps = 100.0, 314.0, 2e-3, 20.0
    m = hb.Model("half wave", domain="electrical")
    m.add(k=hb.Zero(), load=hb.Sf(amps))
    for j in range(3):
        m.add(**{f"V{j}": hb.Se(f"100*cos(314*time - {j}*2*pi/3)"), f"i{j}": hb.One()})
        m.add(**{f"L{j}": hb.I(coil, f=amps if j == 0 else 0.0), f"d{j}": hb.One(law="diode")})
        m.bond(f"V{j} -> i{j} -> L{j}", f"i{j} -> d{j} -> k")
    m.bond("k -> load")
    most = math.sqrt(3) * volts / (2 * w * coil)
    u = math.acos(1 - amps / most)
    begins = [(math.pi / 3 + j * 2 * math.pi / 3) / w for j in range(4)]
    half = begins[0] + 0.5 * u / w
    there = {("L1.f", half): most * (1 - math.cos(u / 2)), ("L1.f", begins[1] - 1e-4): amps}
    return m, begins[3] + 2e-3, [t for b in begins for t in (b, b + u / w)], there


def three_jenkins() -> Told:
    """Springs behind sliders, side by side, driven 2 sin(t): Iwan 1966, Masing's rules."""
    springs, limits = [10.0, 5.0, 2.0], [2.0, 3.0, 5.0]
    m = hb.Model("Iwan", domain="translational")
    m.add(V=hb.Sf("2*cos(1*time)"), v=hb.One())
    m.bond("V -> v")
    for i, (k, most) in enumerate(zip(springs, limits)):
        m.add(**{f"z{i}": hb.Zero(), f"k{i}": hb.C(1 / k)})
        m.add(**{f"s{i}": hb.One(law="coulomb", limit=most)})
        m.bond(f"v -> z{i} -> k{i}", f"z{i} -> s{i}")
    slips = [math.asin(0.1), math.asin(0.3), math.pi / 2]
    back = [math.pi - math.asin(1 - 0.2), math.pi - math.asin(1 - 0.6), 1.5 * math.pi]
    again = [2 * math.pi + math.asin(-1 + 0.2), 2 * math.pi + math.asin(-1 + 0.6)]
    there: dict[tuple[str, float], float] = {("k2.e", 6.0): 4 * math.sin(6.0)}
    for t, way in ((1.0, 0.0), (3.0, -1.0), (6.0, 1.0)):
        for i in (0, 1):
            k, most = springs[i], limits[i]
            # from where it has turned round, each force follows its spring up to its limit
            force = -way * most + k * (2 * math.sin(t) + 2 * way)
            there[f"k{i}.e", t] = max(-most, min(most, force))
    return m, 6.2, [*slips, *back, *again], there


def peg() -> Told:
    """Galileo's pendulum catches a peg at its lowest point and swings to the same height."""
    short, start = 0.4, 0.8
    m = hb.Model("peg", domain="translational")
    m.add(M=hb.I(2.0), v=hb.One(), w=hb.One(domain="rotational"))
    m.add(rope=hb.TF('1/(if k.state == "long" then 1 else 0.4)'))
    m.add(weight=hb.Se("-2*9.81*sin(th)"))
    m.bond("weight -> v -> M", "v -> rope -> w")
    m.signal(th=hb.Integral("w.f", -start))
    rules = ["long -> short when th > 0", "short -> long when th < 0"]
    m.machine("k", states={"long": [], "short": []}, start="long", rules=rules)
    high = 2 * math.asin(math.sin(start / 2) / math.sqrt(short))
    slow = math.sqrt(1 / G) * ellipkinc(math.pi / 2, math.sin(start / 2) ** 2)
    quick = math.sqrt(short / G) * ellipkinc(math.pi / 2, math.sin(high / 2) ** 2)
    ts = [slow, slow + 2 * quick, 3 * slow + 2 * quick, 3 * slow + 4 * quick]
    fast = 2 * math.sqrt(G) * math.sin(start / 2)
    there = {("v.f", ts[0]): fast, ("th", slow + quick): high, ("v.f", ts[1]): -fast}
    return m, ts[-1] + 0.1, ts, there | {("th", 2 * slow + 2 * quick): -start}


def slack_string() -> Told:
    """A bob on a string goes over its circle by a parabola: Synge & Griffith, ch. 6.

    It leaves where 3 g l cos(a) = v0^2 - 2 g l, and is caught 4 v sin(a)/g later, plastically.
    """
    v0 = 6.5
    m = hb.Model("string", domain="translational")
    m.add(mx=hb.I(1.0, f=v0), my=hb.I(1.0), X=hb.One(), Y=hb.One(), weight=hb.Se(-G))
    m.add(zx=hb.TF("x/hypot(x, y)"), zy=hb.TF("y/hypot(x, y)"), r=hb.One(), sum=hb.Zero())
    m.add(rope=hb.Zero(law="unilateral", gap="1 - hypot(x, y)"), hook=hb.Sf(0.0))
    m.bond("X -> mx", "weight -> Y -> my", "X -> zx -> sum", "Y -> zy -> sum")
    m.bond("sum -> r -> rope -> hook")
    m.signal(x=hb.Integral("X.f"), y=hb.Integral("Y.f", -1.0))
    a = math.acos((v0**2 - 2 * G) / (3 * G))
    v = math.sqrt(G * math.cos(a))

    def slowness(th: float, y: np.ndarray) -> list[float]:
        return [1 / math.sqrt(v0**2 - 2 * G * (1 - math.cos(th)))]

    way = solve_ivp(slowness, (0.0, math.pi - a), [0.0], method="DOP853", rtol=1e-12, atol=1e-14)
    leaves = float(way.y[0, -1])
    flight = 4 * v * math.sin(a) / G
    x = math.sin(a) - v * math.cos(a) * flight
    y = math.cos(a) + v * math.sin(a) * flight - G * flight**2 / 2
    vx, vy = -v * math.cos(a), v * math.sin(a) - G * flight
    along = x * vx + y * vy
    there = {("x", leaves): math.sin(a), ("y", leaves + flight): y, ("x", leaves + flight): x}
    caught = {("X.f", leaves + flight): vx - along * x, ("Y.f", leaves + flight): vy - along * y}
    return m, leaves + flight + 0.01, [leaves, leaves + flight], there | caught


CASES = [two_relays, impact_pair, commutation, three_jenkins, peg, slack_string]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.__name__)
def test_a_hybrid_of_a_textbook_in_closed_form(case, solver: str) -> None:
    model, until, instants, values = case()
    run = hb.simulate(model, until, solver=solver)
    times = [event.t for event in run.events[1:] if event.t > 1e-9]
    assert times[: len(instants)] == pytest.approx(instants, rel=1e-7)
    for (signal, t), value in values.items():
        at = next((own for own, told in zip(times, instants) if told == t), t)
        assert run[signal].at(at) == pytest.approx(value, rel=1e-6, abs=1e-9), signal
    assert run.status == "ok" and run.audit().holds()
