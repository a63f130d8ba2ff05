"""Machines as a stranger writes them, against closed forms; each as written and turned round.

Turned round, every bond to a one-port points the other way, sources and starts have the other sign
where that makes them the same machine, and what is declared last is declared first.
"""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

import hybond as hb

G = 9.81

TRAIN = """
domain = "translational"
[elements]
"m[1..4]" = { I = ["20 kg", "10 kg", "15 kg", "5 kg"], f = ["3 m/s", 0, 0, "-1 m/s"] }
"v[1..4]" = { junction = 1 }
"c[1..3]" = { junction = 0 }
[graph]
bonds = ["v[1..4] -> m[1..4]", "v[1..3] -> c[1..3] -> v[2..4]"]
[signals]
"x[1..4]" = { integral = "v[i].f", start = "(if i < 4 then i - 1 else 6) [m]" }
[machines."hook[1..3]"]
states = { free = [], joined = ["c[i]"] }
start = "free"
rules = ["free -> joined when x[i+1] - x[i] <= 0"]
"""


def train() -> tuple[list[float], dict[tuple[str, float], float]]:
    third = 5 / 6 + (6 - 5 / 6 - 2) / (60 / 45 + 1)
    return [1 / 3, 5 / 6, third], {("v[1].f", 1.0): 60 / 45, ("v[4].f", 6.0): 55 / 50}


GEARBOX = """
domain = "rotational"
[elements]
M  = { Se = "12 N*m" }
Jm = { I = "0.02 kg*m^2" }
wm = { junction = 1 }
g1 = { TF = 4 }
g2 = { TF = 2 }
s1 = { junction = 0 }
s2 = { junction = 0 }
wo = { junction = 1 }
Jo = { I = "1.5 kg*m^2" }
[graph]
bonds = ["M -> wm -> Jm", "wm -> g1.2", "g1.1 -> s1", "g2.2 -> wm", "s2 -> g2.1", "s1 -> wo", "wo -> s2", "wo -> Jo"]
[machines.box]
states = { first = ["s1"], neutral = [], second = ["s2"] }
start = "first"
rules = ["first -> neutral when wm.f > 60 [rad/s]", "neutral -> second when time >= 2 [s]"]
"""  # noqa: E501


def gearbox() -> tuple[list[float], dict[tuple[str, float], float]]:
    first = 60 / 4 * (0.02 * 16 + 1.5) / (12 * 4)
    speed = 60 + 12 / 0.02 * (2 - first)
    joined = (0.02 * 2 * speed + 1.5 * 15) / (0.02 * 4 + 1.5)
    ends = joined + 12 * 2 / (1.5 + 0.08)
    return [first, 2.0], {("wo.f", 2.0): joined, ("wo.f", 3.0): ends, ("wm.f", 3.0): 2 * ends}


DISCS = """
domain = "rotational"
[elements]
"J[1..3]" = { I = ["1 kg*m^2", "0.5 kg*m^2", "2 kg*m^2"], f = ["50 rad/s", 0, "-20 rad/s"] }
"w[1..3]" = { junction = 1 }
"d[1..2]" = { junction = 0 }
s12 = { junction = 1, law = "coulomb", limit = "10 N*m" }
s23 = { junction = 1, law = "coulomb", limit = "6 N*m" }
[graph]
bonds = ["w[1..3] -> J[1..3]", "w[1..2] -> d[1..2] -> w[2..3]", "d[1] -> s12", "d[2] -> s23"]
"""


def discs() -> tuple[list[float], dict[tuple[str, float], float]]:
    first = 50 / 18
    second = first + (8 * first - (3 * first - 20)) / 7
    return [first, second], {("w[2].f", first): 8 * first, ("w[2].f", 20.0): 10 / 3.5}


CVT = """
domain = "rotational"
[elements]
J1 = { I = "2 kg*m^2", f = "30 rad/s" }
J2 = { I = "1 kg*m^2" }
w1 = { junction = 1 }
w2 = { junction = 1 }
cvt = { TF = "0.5 + 0.4*time/(1 [s])" }
cl = { junction = 0 }
[graph]
bonds = ["w1 -> J1", "w2 -> J2", "w1 -> cvt.1", "cvt.2 -> cl", "cl -> w2"]
[machines.c]
states = { off = [], on = ["cl"] }
start = "off"
rules = ["off -> on when time >= 1 [s]"]
"""


def cvt() -> tuple[list[float], dict[tuple[str, float], float]]:
    # the torque between them turns one by m, the other by 1: w1^2 (J1 + m^2 J2) is kept
    joined = 60 / (2 + 0.81)
    return [1.0], {
        ("w1.f", 1.0): joined,
        ("w2.f", 3.0): 1.7 * joined * math.sqrt((2 + 0.81) / (2 + 1.7**2)),
    }


LADDER = """
domain = "translational"
[parameters]
M = "6 kg"
a = "1.5 m"
[elements]
wt = { Se = "-9.81 [m/s^2]*M" }
mx = { I = "M" }
my = { I = "M" }
J = { I = "M*a^2/3", domain = "rotational" }
vx = { junction = 1 }
vy = { junction = 1 }
w = { junction = 1, domain = "rotational" }
foot = { junction = 0, law = "unilateral", gap = "y - a*sin(th)" }
top = { junction = 0, law = "unilateral", gap = "x - a*cos(th)" }
tf = { TF = "-a*cos(th)" }
tt = { TF = "a*sin(th)" }
[graph]
bonds = ["wt -> vy -> my", "vx -> mx", "w -> J", "foot -> vy", "top -> vx", "foot -> tf.2", "tf.1 -> w", "top -> tt.2", "tt.1 -> w"]
[signals]
th = { integral = "w.f", start = 1.2 }
x = { integral = "vx.f", start = "a*cos(1.2)" }
y = { integral = "vy.f", start = "a*sin(1.2)" }
"""  # noqa: E501


def ladder() -> tuple[list[float], dict[tuple[str, float], float]]:
    # it slides down a smooth wall, and leaves it at two thirds of the height
    a, top = 1.5, math.sin(1.2)
    leaves = math.asin(2 / 3 * top)

    def squared(th: float) -> float:
        return 1.5 * G / a * (top - math.sin(th))

    def slowness(u: float) -> float:
        return 2 * u / math.sqrt(squared(1.2 - u * u)) if u else 2 / math.sqrt(squared(1.2 - 1e-9))

    t = quad(slowness, 0, math.sqrt(1.2 - leaves), epsabs=1e-12, epsrel=1e-12)[0]
    w = -math.sqrt(squared(leaves))
    return [t], {("w.f", t): w, ("vx.f", 1.3): -a * math.sin(leaves) * w}


DOME = """
domain = "translational"
[elements]
wt = { Se = "-9.81 N" }
mx = { I = "1 kg", f = "0.05 m/s" }
my = { I = "1 kg" }
vx = { junction = 1 }
vy = { junction = 1 }
n = { junction = 0, law = "unilateral", gap = "sqrt(x^2 + y^2) - 1 [m]" }
tx = { TF = "x/sqrt(x^2 + y^2)" }
ty = { TF = "y/sqrt(x^2 + y^2)" }
[graph]
bonds = ["wt -> vy -> my", "vx -> mx", "n -> tx.2", "tx.1 -> vx", "n -> ty.2", "ty.1 -> vy"]
[signals]
x = { integral = "vx.f" }
y = { integral = "vy.f", start = "1 m" }
"""


def dome() -> tuple[list[float], dict[tuple[str, float], float]]:
    height = 2 / 3 + 0.05**2 / (3 * G)

    def slowness(th: float) -> float:
        return 1 / math.sqrt(0.05**2 + 2 * G * (1 - math.cos(th)))

    t = quad(slowness, 0, math.acos(height), epsabs=1e-12, epsrel=1e-12, limit=500)[0]
    return [t], {("y", t): height, ("vx.f", 1.6): math.sqrt(G * height) * height}


HOIST = """
domain = "translational"
[elements]
wA = { Se = "19.62 N" }
A = { I = "2 kg" }
wB = { Se = "-49.05 N" }
B = { I = "5 kg" }
vA = { junction = 1 }
vB = { junction = 1 }
rope = { junction = 0, law = "unilateral", gap = "0.8 [m] - xA + xB" }
floor = { junction = 0, law = "unilateral", gap = "xB" }
[graph]
bonds = ["wA -> vA -> A", "wB -> vB -> B", "vA -> rope -> vB", "floor -> vB"]
[signals]
xA = { integral = "vA.f" }
xB = { integral = "vB.f" }
"""


def hoist() -> tuple[list[float], dict[tuple[str, float], float]]:
    # A falls, jerks B from the floor; B comes down, the rope is slack again; A comes back
    taut = math.sqrt(1.6 / G)
    speed = 2 * G * taut / 7
    down = taut + 2 * speed / (3 * G / 7)
    again = down + 2 * speed / G
    return [taut, down, again], {("vB.f", taut): speed, ("vB.f", again): 2 * speed / 7}


RELIEF = """
domain = "hydraulic"
[elements]
pump = { Sf = "3e-4 m^3/s" }
cyl = { C = "2e-12 m^3/Pa" }
n = { junction = 0 }
set = { Se = "120 bar" }
rv = { junction = 1, law = "diode" }
load = { junction = 1 }
spool = { R = "6e10 Pa*s/m^3" }
[graph]
bonds = ["pump -> n -> cyl", "n -> rv", "rv -> set", "n -> load", "load -> spool"]
[machines.dcv]
states = { shut = [], open = ["load"] }
start = "shut"
rules = [
  "shut -> open when time >= 0.3 [s] and time < 0.6 [s]",
  "open -> shut when time >= 0.6 [s]",
]
"""


def relief() -> tuple[list[float], dict[tuple[str, float], float]]:
    # the pressure is for the pump to make, and for the valve to keep
    return [0.08, 0.3, 0.6], {("n.e", 0.04): 6e6, ("rv.f", 0.5): 1e-4, ("rv.f", 0.7): 3e-4}


COILS = """
domain = "electrical"
[elements]
V = { Se = "12 V" }
R = { R = "4 ohm" }
L1 = { I = "0.1 H" }
L2 = { I = "0.3 H" }
i = { junction = 1 }
i2 = { junction = 1 }
n = { junction = 0 }
short = { junction = 1 }
[graph]
bonds = ["V -> i", "i -> R", "i -> L1", "i -> n", "n -> short", "n -> i2", "i2 -> L2"]
[machines.s]
states = { closed = ["short"], open = [] }
start = "closed"
rules = ["closed -> open when time >= 50 [ms]"]
"""


def coils() -> tuple[list[float], dict[tuple[str, float], float]]:
    before = 3 * (1 - math.exp(-2))
    joined = 0.1 * before / 0.4
    return [0.05], {("i.f", 0.05): joined, ("i2.f", 0.1): 3 + (joined - 3) * math.exp(-0.5)}


PICKED = """
domain = "translational"
[elements]
F = { Se = "30 N" }
A = { I = "4 kg" }
B = { I = "1 kg" }
wB = { Se = "-9.81 N" }
va = { junction = 1 }
vb = { junction = 1 }
lever = { TF = 2 }
grip = { junction = 0 }
[graph]
bonds = ["F -> va -> A", "va -> lever.1", "lever.2 -> grip -> vb", "vb -> B", "wB -> vb"]
[signals]
x = { integral = "va.f" }
[machines.hand]
states = { open = [], held = ["grip"] }
start = "open"
rules = ["open -> held when x > 1 [m] and not (x > 3 [m])", "held -> open when x > 3 [m]"]
"""


def picked() -> tuple[list[float], dict[tuple[str, float], float]]:
    grips = math.sqrt(8 / 30)
    v = (4 * 7.5 * grips - 2 * G * grips) / 8
    a = (30 - 2 * G) / 8
    opens = grips + (math.sqrt(v * v + 4 * a) - v) / a
    return [grips, opens], {
        ("va.f", grips): v,
        ("vb.f", 2.0): 2 * (v + a * (opens - grips)) - G * (2 - opens),
    }


CASES = {
    "train": (TRAIN, train, 6.0),
    "gearbox": (GEARBOX, gearbox, 3.0),
    "discs": (DISCS, discs, 20.0),
    "cvt": (CVT, cvt, 3.0),
    "ladder": (LADDER, ladder, 1.3),
    "dome": (DOME, dome, 1.7),
    "hoist": (HOIST, hoist, 1.3),
    "relief": (RELIEF, relief, 0.8),
    "coils": (COILS, coils, 0.1),
    "picked": (PICKED, picked, 2.0),
}
ONE_PORTS = {"C", "I", "R", "G", "Se", "Sf"}


def minus(value: Any) -> Any:
    """Return a value, a quantity or a product, or a list of them, with the other sign."""
    if isinstance(value, list):
        return [minus(v) for v in value]
    if isinstance(value, str):
        return value.removeprefix("-") if value.startswith("-") else f"-{value}"
    return -value


def turned(text: str) -> str:
    """Return a model with the bonds of its one-ports turned round, as JSON, last part first."""
    data = tomllib.loads(text)
    elements = data["elements"]
    arrays = {name.partition("[")[0]: name for name in elements}

    def part(end: str) -> dict[str, Any]:
        return elements[arrays[end.partition("[")[0].partition(".")[0]]]

    def bonds() -> Iterator[str]:
        for chain in data["graph"]["bonds"]:
            ends = [end.strip() for end in chain.split("->")]
            for tail, head in pairwise(ends):
                one, junction = (head, tail) if "junction" in part(tail) else (tail, head)
                kinds = ONE_PORTS & set(part(one))
                if not kinds:
                    yield f"{tail} -> {head}"
                    continue
                yield f"{head} -> {tail}"
                (kind,) = kinds
                # at a 1-junction efforts change their signs, at a 0-junction flows do
                at_one = part(junction)["junction"] == 1
                if kind == ("Se" if at_one else "Sf"):
                    part(one)[kind] = minus(part(one)[kind])
                if at_one and "f" in part(one):
                    part(one)["f"] = minus(part(one)["f"])

    data["graph"]["bonds"] = list(bonds())[::-1]
    data["elements"] = dict(reversed(elements.items()))
    return json.dumps(data)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("way", ["as written", "turned round", "implicit"])
@pytest.mark.parametrize("name", CASES)
def test_a_machine_in_closed_form(name: str, way: str) -> None:
    text, closed_form, until = CASES[name]
    text = "hybond = 1\n" + text
    model = hb.loads(turned(text), format="json") if way == "turned round" else hb.loads(text)
    run = hb.simulate(model, until, solver="radau" if way == "implicit" else None)
    instants, values = closed_form()
    times = run.events.t[1 : len(instants) + 1]
    np.testing.assert_allclose(times, instants, rtol=2e-8)
    for (signal, t), value in values.items():
        at = next((own for own, told in zip(times, instants) if told == t), t)
        assert run[signal].at(at) == pytest.approx(value, rel=2e-7), signal
    assert not run.warnings and run.audit().holds()
    if name != "hoist":  # the rope jerks again and again
        assert len(run.events) == len(instants) + 1
