"""Circuits of power electronics as an engineer writes them, against their closed forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, log, pi, sqrt, tanh

import pytest

import hybond as hb


@dataclass(frozen=True)
class Circuit:
    """A model, how long it runs, when it switches, and what signals are: at times, or as means."""

    text: str
    until: float
    instants: tuple[float, ...]
    values: dict[tuple[str, float], float]
    means: dict[tuple[str, float, float], float]


FORCED = """
[elements]
S    = { Se = "200 V" }
a    = { junction = 0 }
o    = { junction = 0 }
main = { junction = 1, law = "thyristor", gate = "time < 10 [us]" }
aid  = { junction = 1, law = "thyristor", gate = "time > 1 [ms] and time < 1.1 [ms]" }
R    = { R = "10 ohm" }
C    = { C = "20 uF", e = "-200 V" }
[graph]
bonds = ["S -> a", "a -> main -> o", "o -> R", "a -> aid -> o", "aid -> C"]
"""


def forced() -> Circuit:
    # the charge turns the main thyristor off; the load sees twice the source, then R C of it
    tau = 200e-6
    values = {
        ("o.e", 0.5e-3): 200.0,
        ("o.e", 1.2e-3): 400.0 * exp(-1.0),
        ("main.e", 1e-3 + tau * log(2)): 0.0,
        ("C.e", 3e-3): 200.0 - 400.0 * exp(-10.0),
    }
    return Circuit(FORCED, 3e-3, (1e-3,), values, {})


RESONANT = """
[elements]
S = { Se = "100 V" }
T = { junction = 1, law = "thyristor", gate = "mod(time, 1 [ms]) < 0.1 [ms]" }
L = { I = "0.1 mH" }
C = { C = "10 uF" }
[graph]
bonds = ["S -> T", "T -> L", "T -> C"]
"""


def resonant() -> Circuit:
    half = pi * sqrt(1e-9)
    values = {("T.f", half / 2): 100.0 * sqrt(0.1), ("C.e", 4e-3): 200.0, ("T.e", 4e-3): -100.0}
    return Circuit(RESONANT, 5e-3, (half,), values, {})


FED = """
[elements]
I = { Sf = "10 A" }
p = { junction = 0 }
q = { junction = 0 }
a = { junction = 0 }
b = { junction = 0 }
s1 = { junction = 1 }
s2 = { junction = 1 }
s3 = { junction = 1 }
s4 = { junction = 1 }
l = { junction = 1 }
z = { junction = 0 }
g = { Se = "0 V" }
C = { C = "0.1 mF" }
R = { R = "4 ohm" }
[graph]
bonds = [
  "I -> p", "p -> s1 -> a", "p -> s2 -> b", "a -> s4 -> q", "b -> s3 -> q",
  "q -> g", "a -> l -> b", "l -> z", "z -> C", "z -> R",
]
[machines.bridge]
states = { ahead = ["s1", "s3"], back = ["s2", "s4"] }
start = "ahead"
rules = [
  "ahead -> back when mod(time, 2 [ms]) >= 1 [ms]",
  "back -> ahead when mod(time, 2 [ms]) < 1 [ms]",
]
"""


def fed() -> Circuit:
    top = 40.0 * tanh(1e-3 / (2 * 0.4e-3))
    instants = tuple(k * 1e-3 for k in range(1, 19))
    # I R less what the voltage lags by: x is the half period over 2 R C
    mean = 400.0 * (1.0 - tanh(1.25) / 1.25)
    values = {("z.e", 17e-3): top, ("z.e", 18e-3): -top}
    return Circuit(FED, 18.5e-3, instants, values, {("p.e*I.f", 16e-3, 18e-3): mean})


BREAKER = """
[elements]
V = { Se = "600 V" }
R = { R = "0.5 ohm" }
L = { I = "2 mH" }
j = { junction = 1 }
n = { junction = 0 }
contact = { junction = 1 }
arrester = { junction = 1, law = "coulomb", limit = "1000 V" }
slope = { R = "2 ohm" }
[graph]
bonds = ["V -> j -> R", "j -> L", "j -> n -> arrester", "arrester -> slope", "n -> contact"]
[machines.breaker]
states = { closed = ["contact"], open = [] }
start = "closed"
rules = ["closed -> open when time >= 1 [ms]"]
"""


def breaker() -> Circuit:
    # the arrester takes the current down against 400 V, and holds the source from then on
    begin, tau = 1200.0 * (1.0 - exp(-0.25)), 0.8e-3
    ends = 1e-3 + tau * log(begin / 160.0 + 1.0)
    later = (begin + 160.0) * exp(-0.2e-3 / tau) - 160.0
    values = {("L.f", 1.2e-3): later, ("L.f", 3e-3): 0.0, ("n.e", 3e-3): 600.0}
    return Circuit(BREAKER, 3e-3, (1e-3, ends), values, {})


BOUNCING = """
[elements]
V = { Se = "24 V" }
s = { junction = 1 }
n = { junction = 0 }
d = { junction = 1, law = "diode" }
z = { Se = "0 V" }
j = { junction = 1 }
L = { I = "50 mH" }
R = { R = "48 ohm" }
[graph]
bonds = ["V -> s -> n", "z -> d -> n", "n -> j -> L", "j -> R"]
[inputs.c]
table = [[0, 0], [1e-3, 1], [1.4e-3, 0], [1.7e-3, 1], [1.85e-3, 0], [1.95e-3, 1], [10e-3, 0]]
[machines.relay]
states = { open = [], closed = ["s"] }
start = "open"
rules = ["open -> closed when c > 0.5", "closed -> open when c < 0.5"]
"""


def bouncing() -> Circuit:
    edges = (1e-3, 1.4e-3, 1.7e-3, 1.85e-3, 1.95e-3, 10e-3)
    i, taken = 0.0, 0.0
    tau = 0.05 / 48.0
    for k, (a, b) in enumerate(zip(edges, (*edges[1:], 14e-3), strict=True)):
        drive, h = (0.5 if k % 2 == 0 else 0.0), b - a
        if drive:
            taken += 24.0 * (drive * h + (i - drive) * tau * (1.0 - exp(-h / tau)))
        i = drive + (i - drive) * exp(-h / tau)
    means = {("V.e*V.f", 0.0, 14e-3): taken / 14e-3}
    return Circuit(BOUNCING, 14e-3, edges, {("L.f", 14e-3): i}, means)


COMPENSATED = """
[parameters]
T = "10 us"
m = "0.56 MA/s"
[elements]
V = { Se = "12 V" }
s = { junction = 1 }
n = { junction = 0 }
d = { junction = 1, law = "diode" }
z = { Se = "0 V" }
j = { junction = 1 }
L = { I = "10 uH", f = "5.5 A" }
O = { Se = "8 V" }
[graph]
bonds = ["V -> s -> n", "z -> d -> n", "n -> j -> L", "j -> O"]
[inputs]
clock = { pwm = { period = "T", duty = 0.05 } }
[machines.latch]
states = { off = [], on = ["s"] }
start = "off"
rules = ["off -> on when clock > 0.5", "on -> off when L.f >= 12 [A] - m*mod(time, T)"]
"""


def compensated() -> Circuit:
    # peaks are met in an iteration with the factor -(m2 - m)/(m1 + m), m1 and m2 the slopes
    T, m, i = 10e-6, 0.56e6, 5.5
    instants = []
    for k in range(40):
        on = (12.0 - i) / (0.4e6 + m)
        instants += [k * T, k * T + on]
        i = i + 0.4e6 * on - 0.8e6 * (T - on)
    means = {("n.e", 38 * T, 39 * T): 8.0}
    return Circuit(COMPENSATED, 40 * T - 1e-6, tuple(instants[1:]), {}, means)


CHARGER = """
[elements]
I = { Sf = "10 A" }
U = { Se = "13.2 V" }
t = { junction = 0 }
n = { junction = 0 }
bleed = { R = "1 kohm" }
amps = { junction = 1 }
volts = { junction = 1 }
cell = { junction = 1 }
inside = { R = "50 mohm" }
charge = { C = { e = "11 [V] + q/18000 [F]" }, q = "7200 C" }
[graph]
bonds = [
  "I -> t", "t -> bleed", "t -> amps -> n", "U -> volts -> n",
  "n -> cell", "cell -> inside", "cell -> charge",
]
[machines.charger]
states = { amperes = ["amps"], voltage = ["volts"], done = [] }
start = "amperes"
rules = ["amperes -> voltage when n.e >= 13.2 [V]", "voltage -> done when cell.f < 0.5 [A]"]
"""


def charger() -> Circuit:
    # i = (10 A - e/1 kohm)/(1 + 50e-6), C e' = i until e + i/20 is reached; then R C
    k, C = 1.00005, 18000.0
    full = (13.2 - 0.05 * 10.0 / k) / (1.0 - 0.05e-3 / k)
    first = C * k * 1e3 * log((10.0 - 11.4e-3) / (10.0 - full * 1e-3))
    second = first + 0.05 * C * log((13.2 - full) / 0.05 / 0.5)
    return Circuit(CHARGER, second + 60.0, (first, second), {("charge.e", second): 13.175}, {})


CIRCUITS: dict[str, Callable[[], Circuit]] = {
    "forced commutation": forced,
    "resonant pulse": resonant,
    "current-fed bridge": fed,
    "breaker with arrester": breaker,
    "bouncing relay": bouncing,
    "slope compensation": compensated,
    "charger": charger,
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("name", CIRCUITS)
def test_a_circuit_in_closed_form(name: str, solver: str) -> None:
    circuit = CIRCUITS[name]()
    model = hb.loads('hybond = 1\ndomain = "electrical"\n' + circuit.text)
    run = hb.simulate(model, circuit.until, solver=solver)
    assert run.status == "ok" and run.audit().holds()
    found = [e.t for e in run.events if e.cause != "start"]
    assert found == pytest.approx(circuit.instants, rel=1e-7)
    for (signal, t), value in circuit.values.items():
        at = min(found, key=lambda own: abs(own - t))
        t = at if abs(at - t) < 1e-7 * circuit.until else t
        assert run[signal].at(t) == pytest.approx(value, rel=1e-6, abs=1e-5), signal
    for (signal, begin, end), value in circuit.means.items():
        mean = run[signal].mean(start=begin, end=end)
        assert mean == pytest.approx(value, rel=1e-6), signal
