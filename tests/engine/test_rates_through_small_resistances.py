"""What flows through next to nothing: a difference of two states that are nearly one.

Where the states have eight digits, a current through a nano-ohm between them had none; every value
that a run tells is held, not the states alone. Closed forms.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import pytest

import hybond as hb

OMEGA = 100.0 * math.pi
TIMES = [0.0003 + 0.0013 * k for k in range(38)]
UNTIL = 0.05
LET_IN = 256.0 * 2.0**-52
"""Part of what a rate is a difference of that may be rounding: twice what is asked for at one part
of a step."""


def driven(resistance: float, turned: bool) -> str:
    """A sine behind a resistor and a capacitor of 1 mF."""
    bond = "j -> R" if not turned else "R -> j"
    return f"""
hybond = 1
[elements]
V = {{ Se = "sin({OMEGA!r}*time/(1 [s]))" }}
j = {{ junction = 1 }}
R = {{ R = {resistance!r} }}
C = {{ C = 1e-3 }}
[graph]
bonds = ["V -> j", "{bond}", "j -> C"]
"""


def current(resistance: float, t: float) -> float:
    """From rest: what goes on, and what dies out."""
    late = OMEGA * 1e-3 * resistance
    going_on = math.cos(OMEGA * t) + late * math.sin(OMEGA * t)
    dying = math.exp(-t / (1e-3 * resistance))
    return OMEGA * 1e-3 * (going_on - dying) / (1.0 + late * late)


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("resistance", [1e-2, 1e-6, 1e-9])
def test_a_capacitor_behind_next_to_no_resistance(
    resistance: float, turned: bool, solver: Literal["auto", "radau"]
) -> None:
    run = hb.simulate(hb.loads(driven(resistance, turned)), until=UNTIL, solver=solver)
    flow = run.sample(TIMES, "C.f")["C.f"]
    right = np.array([current(resistance, t) for t in TIMES])
    assert flow == pytest.approx(right, abs=2e-4 * OMEGA * 1e-3)
    assert run.stats["steps"] < 2000
    if solver == "auto":
        assert run.audit().holds()


PULLED = """
hybond = 1
[elements]
v = { Sf = "sin(3*time/(1 [s]))" }
a = { junction = 0 }
d = { R = 1e9 }
m = { I = 2 }
k = { C = 0.5 }
w = { junction = 1 }
[graph]
bonds = ["v -> a", "a -> d", "a -> w", "w -> m", "w -> k"]
"""


@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_a_mass_pulled_along_by_a_stiff_damper(solver: Literal["auto", "radau"]) -> None:
    """It moves as it is pulled; the force is that of its mass and of the spring behind it."""
    run = hb.simulate(hb.loads(PULLED), until=10.0, solver=solver)
    times = [0.1 + 0.17 * k for k in range(58)]
    force = run.sample(times, "v.e")["v.e"]
    right = np.array([6 * math.cos(3 * t) + 2 * (1 - math.cos(3 * t)) / 3 for t in times])
    assert force == pytest.approx(right, abs=2e-4)


def behind_a_filter(small: float) -> str:
    """A sine behind next to no resistance, a small capacitor, and a large one behind 1 ohm."""
    return f"""
hybond = 1
[elements]
V = {{ Se = "sin({OMEGA!r}*time/(1 [s]))" }}
a = {{ junction = 1 }}
r = {{ R = {small!r} }}
n = {{ junction = 0 }}
c = {{ C = 1e-9 }}
b = {{ junction = 1 }}
R = {{ R = 1.0 }}
C = {{ C = 3e-3 }}
[graph]
bonds = ["V -> a", "a -> r", "a -> n", "n -> c", "n -> b", "b -> R", "b -> C"]
"""


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("small", [1e-9, 1e-6])
def test_where_the_source_passes_zero_steps_are_no_shorter(
    small: float, solver: Literal["auto", "radau"]
) -> None:
    """There what a current is a difference of is zero, and its rounding is that of the sine."""
    run = hb.simulate(hb.loads(behind_a_filter(small)), until=UNTIL, solver=solver)
    assert run.stats["steps"] < 3000
    late = OMEGA * 3e-3
    times = [t for t in TIMES if t > 0.02]
    going_on = [(late * math.sin(OMEGA * t) + math.cos(OMEGA * t)) * late for t in times]
    dying = [late * math.exp(-t / 3e-3) for t in times]
    right = (np.array(going_on) - np.array(dying)) / (1.0 + late**2)
    assert run.sample(times, "C.f")["C.f"] == pytest.approx(right, abs=1e-5)


@pytest.mark.parametrize("small", [1e-4, 1e-6, 1e-9])
def test_beside_a_load_that_bends(small: float) -> None:
    """Steps are solved for there; the source gives what the capacitor takes and what the load."""
    model = hb.Model("loaded", domain="electrical")
    model.add(V=hb.Se(f"sin({OMEGA!r}*time/(1 [s]))"), j=hb.One(), R=hb.R(small), n=hb.Zero())
    model.add(C=hb.C(1e-3), x=hb.R({"f": "0.05[A/V]*e+0.001[A/V^3]*e^3"}))
    model.bond("V -> j -> n -> C", "j -> R", "n -> x")
    run = hb.simulate(model, until=UNTIL)
    late = [t for t in TIMES if t > 20.0 * small * 1e-3]
    wave = np.sin(OMEGA * np.array(late))
    right = OMEGA * 1e-3 * np.cos(OMEGA * np.array(late)) + 0.05 * wave + 0.001 * wave**3
    assert run.sample(late, "j.f")["j.f"] == pytest.approx(right, abs=2e-4 * OMEGA * 1e-3)
    assert run.stats["steps"] < 3000


def turned_by(resistance: float, capacitance: float) -> hb.Model:
    """5 V behind a resistor and a transformer whose modulus swings, and a capacitor."""
    model = hb.Model("swinging", domain="electrical")
    model.add(V=hb.Se("5[V]"), j=hb.One(), r=hb.R(resistance), c=hb.C(capacitance), n=hb.Zero())
    model.add(t=hb.TF("2+sin(40[1/s]*time)"))
    model.bond("V -> j -> t -> n -> c", "j -> r")
    return model


@pytest.mark.parametrize(
    ("resistance", "capacitance", "within"),
    [(1.0, 1e-6, 2e-4), (2.2e-3, 1e-6, 2e-4), (2.2e-3, 3.3e-9, 6e-3)],
)
def test_through_a_transformer_that_swings(
    resistance: float, capacitance: float, within: float
) -> None:
    """The last current is 4e-11 of what it is a difference of: its fourth digit may be rounding."""
    run = hb.simulate(turned_by(resistance, capacitance), until=0.04)
    times = [t for t in TIMES if t < 0.04]
    ratio = 2.0 + np.sin(40.0 * np.array(times))
    right = -capacitance * 5.0 * 40.0 * np.cos(40.0 * np.array(times)) / ratio**3
    off = np.abs(run.sample(times, "j.f")["j.f"] - right)
    assert np.max(off) < within * np.max(np.abs(right))
    assert run.stats["steps"] < 500


def test_an_amplifier_that_differentiates() -> None:
    model = hb.Model("differentiator", domain="electrical")
    model.add(V=hb.Se(f"sin({OMEGA!r}*time/(1 [s]))"), a=hb.One(), C=hb.C(1e-6), n=hb.Zero())
    model.add(b=hb.One(), R=hb.R(1e3), o=hb.Zero(), U=hb.Se("-1e6*n.e"))
    model.bond("V -> a -> C", "a -> n -> b -> R", "b -> o", "U -> o")
    run = hb.simulate(model, until=UNTIL, solver="radau")
    right = [-OMEGA * 1e-3 * math.cos(OMEGA * t) for t in TIMES]
    assert run.sample(TIMES, "o.e")["o.e"] == pytest.approx(right, abs=1e-4)


@pytest.mark.parametrize("damping", [1e6, 1e9])
def test_what_a_great_force_holds_takes_no_shorter_steps(damping: float) -> None:
    """Of the force that holds a mass of next to none nothing is left for the mass."""
    model = hb.Model("held", domain="translational")
    model.add(i=hb.I(1e-3), v=hb.One(), z=hb.Zero(), k=hb.C(0.01, q=0.01), u=hb.One())
    model.add(m=hb.I(1.0), b=hb.R(1.0), d=hb.R(f"{damping}[N*s/m]*(2+sin(3[1/s]*time))^2"))
    model.bond("v -> i", "v -> z -> u -> m", "z -> k", "u -> b", "v -> d")
    run = hb.simulate(model, until=3.0)
    assert run.stats["steps"] < 1000
    held = run["v.f"].at(3.0) * damping * (2.0 + math.sin(9.0)) ** 2
    assert held == pytest.approx(-run["z.e"].at(3.0), rel=1e-6)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("mass", [False, True])
def test_what_next_to_nothing_stores_takes_no_more_than_rounding(mass: bool, turned: bool) -> None:
    """Milliamperes flowed to a picofarad: what a source would leave there in a moment is far more.

    What flows is a difference of 1e8 A. Its rounding may be some of its last digits.
    """
    small = 1e-12
    model = hb.Model("small")
    wave = f"10*sin({OMEGA!r}*time)"
    model.add(V=hb.Sf(wave) if mass else hb.Se(wave), R=hb.R(1e7 if mass else 1e-7))
    model.add(j=hb.Zero() if mass else hb.One(), S=hb.I(small) if mass else hb.C(small))
    model.bond("V -> j", "R -> j" if turned else "j -> R", "j -> S")
    run = hb.simulate(model, until=UNTIL)
    of = "S.e" if mass else "S.f"
    right = [10.0 * OMEGA * small * math.cos(OMEGA * t) for t in TIMES]
    assert run.sample(TIMES, of)[of] == pytest.approx(right, abs=LET_IN * 2e8)
    assert run.stats["steps"] < 2000
    if turned:
        assert run.audit().holds()


@pytest.mark.parametrize("turned", [False, True])
def test_a_clutch_with_next_to_no_inertia_before_it_pulls_one_way(turned: bool) -> None:
    """A wheel that is let go by it runs down; between, 2 N m seemed to pull it back."""
    model = hb.Model("clutch", domain="rotational")
    model.add(V=hb.Sf(f"10*sin({OMEGA!r}*time)"), z=hb.Zero(), b=hb.R(1e7), o=hb.One())
    model.add(l=hb.I(1e-12), k=hb.Zero(law="diode"), w=hb.One(), J=hb.I(1e-3), c=hb.R(0.01))
    model.bond("V -> z -> o", "l -> o" if turned else "o -> l", "z -> b")
    model.bond("o -> k -> w -> J", "w -> c")
    run = hb.simulate(model, until=0.03)
    # J w' = J w0 cos + c w0 sin while it is driven; it is let go where that is nothing
    let_go = (math.pi - math.atan(0.1 * OMEGA)) / OMEGA
    # 1e-4 N m, of which it is a difference 1e12 times as large, is sure to be backwards
    assert run.events[1].t == pytest.approx(let_go, abs=2e-7)
    begin, end = run.events[1].t, run.events[2].t
    later = [begin + (end - begin) * k / 100.0 for k in range(1, 100)]
    wheel = 10.0 * math.sin(OMEGA * let_go) * np.exp(-10.0 * (np.array(later) - let_go))
    assert run.sample(later, "w.f")["w.f"] == pytest.approx(wheel, rel=1e-6)
    assert run.sample(later, "b.e")["b.e"] == pytest.approx(0.0 * wheel, abs=2.0 * LET_IN * 2e8)


TIES = ["two", "three", "two and a signal", "gears"]


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("ratio", [3.0, 0.3, 7.1])
@pytest.mark.parametrize("tie", TIES)
def test_what_is_tied_behind_next_to_no_resistance_follows(
    tie: str, ratio: float, turned: bool
) -> None:
    """What a tie keeps does not drift by rounding of what goes to and fro: 50,000 steps were made.

    That was put right at each step, and each began with a transient.
    """
    model = hb.Model("tied")
    gears = tie == "gears"
    wave = f"10*sin({OMEGA!r}*time)"
    store = hb.I if gears else hb.C
    model.add(V=hb.Sf(wave) if gears else hb.Se(wave), s=hb.Zero() if gears else hb.One())
    model.add(B=hb.R(1e4 if gears else 1e-4), P=store(1e-9), Q=store(1e-9))
    model.add(
        a=hb.One() if gears else hb.Zero(), b=hb.One() if gears else hb.Zero(), T=hb.TF(ratio)
    )
    model.bond("V -> s -> a", "s -> B", "a -> P", "b -> Q")
    model.bond("b -> T -> a" if turned else "a -> T -> b")
    if tie == "three":
        model.add(U=hb.TF(ratio), c=hb.Zero(), X=hb.C(1e-9))
        model.bond("b -> U -> c -> X")
    if tie == "two and a signal":
        model.signal(held=hb.Integral("Q.e"))
    run = hb.simulate(model, until=0.02)
    assert run.method.startswith("1 mode propagated exactly")
    assert run.stats["steps"] < 1000
    # of what there is in all at the source
    at_b = (1.0 / ratio if turned else ratio) ** (2 if gears else -2)
    there = 1e-9 * (1.0 + at_b * (1.0 + (ratio**-2 if tie == "three" else 0.0)))
    times = [t for t in TIMES if t < 0.02]
    of = "V.e" if gears else "V.f"
    right = 10.0 * OMEGA * there * np.cos(OMEGA * np.array(times))
    # a difference of 1e5 A, or N m, some last digits of which are rounding
    assert run.sample(times, of)[of] == pytest.approx(right, abs=LET_IN * 2e5)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("masses", [False, True])
def test_many_small_ones_beside_a_large_one_take_no_shorter_steps(
    masses: bool, turned: bool
) -> None:
    """20,000 steps were too few: rounding of all shares was seen in each rate, and held steps.

    What all hold empties through a resistor, and what flows to each is its part of that.
    """
    many = 40
    model = hb.Model("many")
    node, branch = (hb.One, hb.Zero) if masses else (hb.Zero, hb.One)
    store = hb.I if masses else hb.C
    model.add(z=node(), P=hb.I(1e-4, f=5.0) if masses else hb.C(1e-4, e=5.0))
    model.add(L=hb.R(1e-2 if masses else 100.0))
    model.bond("P -> z" if turned else "z -> P", "z -> L")
    for k in range(many):
        between = 1e-3 + 1e-5 * k
        model.add(**{f"r{k}": hb.R(1.0 / between if masses else between), f"j{k}": branch()})
        model.add(**{f"c{k}": store(1e-12)})
        model.bond(f"c{k} -> j{k} -> z" if turned else f"z -> j{k} -> c{k}", f"j{k} -> r{k}")
    run = hb.simulate(model, until=0.02, max_steps=2000)
    assert run.stats["steps"] < 200
    all_of_it = 1e-4 + many * 1e-12
    times = [1e-3 * k for k in range(1, 21)]
    level = 5e-4 / all_of_it * np.exp(-0.01 / all_of_it * np.array(times))
    of, rate = ("P.f", "e") if masses else ("P.e", "f")
    assert np.abs(run.sample(times, of)[of]) == pytest.approx(level, rel=1e-8)
    # a current of 1e-12 of what it is a difference of is rounding in its last digits
    for name in (f"c0.{rate}", f"c{many - 1}.{rate}"):
        flow = np.abs(run.sample(times, name)[name])
        assert flow == pytest.approx(1e-14 * level / all_of_it, abs=LET_IN * 5e3)


def chain(many: int, capacitance: float, turned: bool) -> str:
    """A sine behind 1 ohm, and capacitors behind a milliohm each."""
    parts = ["V = { Se = " + f'"10*sin({OMEGA!r}*time/(1 [s]))"' + " }", "s = { junction = 1 }"]
    parts.append("B = { R = 1.0 }")
    bonds = ["V -> s -> n0", "s -> B"]
    for k in range(many):
        parts.append(f"n{k} = {{ junction = 0 }}")
        parts.append(f"C{k} = {{ C = {capacitance!r} }}")
        bonds.append(f"C{k} -> n{k}" if turned else f"n{k} -> C{k}")
        if k > 0:
            parts.append(f"j{k} = {{ junction = 1 }}")
            parts.append(f"R{k} = {{ R = 1e-3 }}")
            bonds += [f"n{k - 1} -> j{k} -> n{k}", f"j{k} -> R{k}"]
    listed = ", ".join(f'"{b}"' for b in bonds)
    return "hybond = 1\n[elements]\n" + "\n".join(parts) + f"\n[graph]\nbonds = [{listed}]\n"


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("capacitance", [1e-12, 1e-9])
def test_a_long_chain_of_small_capacitors_does_not_creep(capacitance: float, turned: bool) -> None:
    many = 60
    run = hb.simulate(hb.loads(chain(many, capacitance, turned)), until=0.04, max_steps=3000)
    asked = {k: f"R{k}.f" for k in (1, 30, 59)}
    flows = run.sample(TIMES[1:30], list(asked.values()))
    slope = np.array([10.0 * OMEGA * math.cos(OMEGA * t) for t in TIMES[1:30]])
    if capacitance > 1e-12:  # else rounding of ten kiloamperes tells beside what picofarads store
        assert run.audit().holds()
    for k, name in asked.items():
        # behind 60 nF and 1 ohm the slope is late by 20 microradians
        right = (many - k) * capacitance * slope
        assert flows[name] == pytest.approx(right, abs=1e-12 * 10.0 / 1e-3 + 3e-5 * max(right))
