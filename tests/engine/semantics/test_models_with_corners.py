"""Ordinary models whose laws have corners or jump, against SciPy's integrator with events.

Each model is written twice: as a bond graph, and as rates of change by hand, a function for each
side of what jumps. The two share nothing but numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import hybond as hb

State = NDArray[np.float64]
Rate = Callable[[float, State], list[float]]
Way = tuple[Callable[[float, State], float], int, str]
"""What crosses zero, in which direction, and the side that it leads to."""


@dataclass(frozen=True)
class Case:
    text: str
    until: float
    read: tuple[str, ...]
    sides: dict[str, tuple[Rate, list[Way]]]
    side: str
    start: tuple[float, ...]
    tiny: float = 1e-14
    breaks: tuple[float, ...] = ()

    def reference(self, times: State) -> State:
        """Return the states at some times, by rates written by hand."""
        found = np.full((len(times), len(self.start)), np.nan)
        y, t, side = np.array(self.start), 0.0, self.side
        stops = [*self.breaks, self.until]
        while t < self.until:
            end = next(s for s in stops if s > t)
            rate, ways = self.sides[side]
            events = []
            for watched, direction, _ in ways:

                def event(t: float, y: State, watched: object = watched) -> float:
                    return watched(t, y)  # type: ignore[operator]

                event.terminal, event.direction = True, direction  # type: ignore[attr-defined]
                events.append(event)
            s = solve_ivp(
                rate,
                (t, end),
                y,
                "DOP853",
                rtol=1e-10,
                atol=self.tiny,
                events=events,
                dense_output=True,
                max_step=self.until / 100,
            )
            inside = (times >= t) & (times <= s.t[-1])
            if inside.any():
                found[inside] = s.sol(times[inside]).T
            if s.status == 1:
                side = next(w[2] for w, hit in zip(ways, s.t_events, strict=True) if len(hit))
            y, t = s.y[:, -1], s.t[-1] if s.t[-1] > t else np.nextafter(t, np.inf)
        return found


def backlash() -> Case:
    text = """
hybond = 1
domain = "rotational"
[elements]
torque  = { Se = "2 [N*m]*sin(3 [rad/s]*time)" }
motor   = { I = "0.01 kg*m^2" }
load    = { I = "0.05 kg*m^2" }
teeth   = { C = { e = "if q > 0.02 then 300*(q-0.02) else if q < -0.02 then 300*(q+0.02) else 0" } }
oil     = { R = { e = "if abs(teeth.q) > 0.02 then 0.5*f else 0" } }
bearing = { R = "0.1 N*m*s" }
wm   = { junction = 1 }
wl   = { junction = 1 }
gap  = { junction = 0 }
wrel = { junction = 1 }
[graph]
bonds = ["torque -> wm -> motor", "wm -> gap -> wl -> load", "gap -> wrel -> teeth",
         "wrel -> oil", "wl -> bearing"]
"""

    def on(flank: int) -> Rate:
        def rate(t: float, y: State) -> list[float]:
            fast, slow = y[0] / 0.01, y[1] / 0.05
            push = 300.0 * (y[2] - 0.02 * flank) + 0.5 * (fast - slow) if flank else 0.0
            return [2.0 * np.sin(3.0 * t) - push, push - 0.1 * slow, fast - slow]

        return rate

    sides: dict[str, tuple[Rate, list[Way]]] = {
        "play": (
            on(0),
            [(lambda t, y: y[2] - 0.02, 1, "up"), (lambda t, y: y[2] + 0.02, -1, "down")],
        ),
        "up": (on(1), [(lambda t, y: y[2] - 0.02, -1, "play")]),
        "down": (on(-1), [(lambda t, y: y[2] + 0.02, 1, "play")]),
    }
    return Case(text, 0.9, ("motor.p", "load.p", "teeth.q"), sides, "play", (0.0, 0.0, 0.0))


def check_valves() -> Case:
    """A pump with four check valves, tables that are flat on one side, as a rectifier."""
    table = "{ R = { f = { table = [[-1e9, 0, 1e5, 1e9], [0, 0, 1e-4, 1]] } } }"
    text = f"""
hybond = 1
domain = "hydraulic"
[elements]
cylinder = {{ Sf = "1e-4 [m^3/s]*sin(10 [rad/s]*time)" }}
v1 = {table}
v2 = {table}
v3 = {table}
v4 = {table}
ca = {{ C = "1e-11 m^3/Pa" }}
cb = {{ C = "1e-11 m^3/Pa" }}
cp = {{ C = "1e-10 m^3/Pa" }}
cr = {{ C = "1e-9 m^3/Pa" }}
load = {{ R = "1e10 Pa*s/m^3" }}
a = {{ junction = 0 }}
b = {{ junction = 0 }}
p = {{ junction = 0 }}
r = {{ junction = 0 }}
j1 = {{ junction = 1 }}
j2 = {{ junction = 1 }}
j3 = {{ junction = 1 }}
j4 = {{ junction = 1 }}
jl = {{ junction = 1 }}
jc = {{ junction = 1 }}
[graph]
bonds = ["b -> jc -> a", "cylinder -> jc", "a -> ca", "b -> cb", "p -> cp", "r -> cr",
         "a -> j1 -> p", "j1 -> v1", "b -> j2 -> p", "j2 -> v2", "r -> j3 -> a", "j3 -> v3",
         "r -> j4 -> b", "j4 -> v4", "p -> jl -> r", "jl -> load"]
"""

    def valve(d: float) -> float:
        return float(np.interp(d, [-1e9, 0.0, 1e5, 1e9], [0.0, 0.0, 1e-4, 1.0]))

    def rate(t: float, y: State) -> list[float]:
        a, b, p, r = y / [1e-11, 1e-11, 1e-10, 1e-9]
        pushed, leaks = 1e-4 * np.sin(10.0 * t), (p - r) / 1e10
        f1, f2, f3, f4 = valve(a - p), valve(b - p), valve(r - a), valve(r - b)
        return [pushed - f1 + f3, -pushed - f2 + f4, f1 + f2 - leaks, leaks - f3 - f4]

    names = ("ca.q", "cb.q", "cp.q", "cr.q")
    return Case(text, 0.35, names, {"": (rate, [])}, "", (0.0,) * 4, tiny=1e-16)


def anti_windup() -> Case:
    """A drive at its limit whose integrator is led back by what the limit takes away."""
    text = """
hybond = 1
domain = "rotational"
[elements]
drive = { Se = "given*1 [N*m]" }
wheel = { I = "0.2 kg*m^2" }
rub   = { R = "0.05 N*m*s" }
load  = { Se = "-torque" }
w     = { junction = 1 }
[graph]
bonds = ["drive -> w -> wheel", "w -> rub", "load -> w"]
[signals]
error = "wanted - w.f/(1 [rad/s])"
asked = "2*error + sum"
given = "max(-3, min(3, asked))"
sum   = { integral = "10*error + 5*(given - asked)" }
[inputs]
wanted = { table = [[0, 10], [6, -5]] }
torque = { table = [[0, 0], [3, 2], [9, 0]] }
"""

    def rate(t: float, y: State) -> list[float]:
        wanted, torque = 10.0 if t < 6.0 else -5.0, 2.0 if 3.0 <= t < 9.0 else 0.0
        speed = y[0] / 0.2
        error = wanted - speed
        asked = 2.0 * error + y[1]
        given = max(-3.0, min(3.0, asked))
        return [given - 0.05 * speed - torque, 10.0 * error + 5.0 * (given - asked)]

    names = ("wheel.p", "sum")
    return Case(text, 12.0, names, {"": (rate, [])}, "", (0.0, 0.0), breaks=(3.0, 6.0, 9.0))


def servo() -> Case:
    """A cylinder behind a spool that overlaps, saturates, and flows by a root."""
    text = """
hybond = 1
domain = "hydraulic"
[elements]
spool = { Sf = "flow" }
oil   = { C = "1e-12 m^3/Pa" }
leak  = { R = "1e12 Pa*s/m^3" }
ram   = { TF = "1/(1e-3 [m^2])" }
mass  = { I = "50 kg", domain = "translational" }
rub   = { R = "800 N*s/m", domain = "translational" }
p     = { junction = 0 }
v     = { junction = 1, domain = "translational" }
[graph]
bonds = ["spool -> p -> oil", "p -> leak", "p -> ram -> v -> mass", "v -> rub"]
[signals]
x     = { integral = "v.f" }
s     = "max(-1, min(1, 30*(0.1*sin(2*time) - x)))"
o     = "if s > 0.05 then s - 0.05 else if s < -0.05 then s + 0.05 else 0"
flow  = "4e-4*o*sqrt(max(0, 1 - sign(o)*p.e/1e7))"
"""

    def rate(t: float, y: State) -> list[float]:
        p, v = y[0] / 1e-12, y[1] / 50.0
        s = max(-1.0, min(1.0, 30.0 * (0.1 * np.sin(2.0 * t) - y[2])))
        o = s - 0.05 if s > 0.05 else s + 0.05 if s < -0.05 else 0.0
        flow = 4e-4 * o * np.sqrt(max(0.0, 1.0 - np.sign(o) * p / 1e7))
        return [flow - p / 1e12 - 1e-3 * v, 1e-3 * p - 800.0 * v, v]

    names = ("oil.q", "mass.p", "x")
    return Case(text, 0.4, names, {"": (rate, [])}, "", (0.0, 0.0, 0.0), tiny=1e-17)


def amplifier() -> Case:
    """An amplifier with limits in a loop without storage: what it gives decides what it reads."""
    text = """
hybond = 1
domain = "electrical"
[elements]
V   = { Se = "2 [V]*sin(100 [rad/s]*time)" }
R1  = { R = "1 kohm" }
R2  = { R = "10 kohm" }
amp = { Se = "max(-15 [V], min(15 [V], -1e5*n.e))" }
L   = { I = "1 H" }
RL  = { R = "100 ohm" }
i1  = { junction = 1 }
n   = { junction = 0 }
i2  = { junction = 1 }
o   = { junction = 0 }
il  = { junction = 1 }
[graph]
bonds = ["V -> i1 -> R1", "i1 -> n -> i2 -> R2", "amp -> o", "i2 -> o -> il -> L", "il -> RL"]
"""

    def rate(t: float, y: State) -> list[float]:
        # n = (10*V + vo)/11, and vo = -1e5*n unless that is beyond 15 V
        free = -1e6 * 2.0 * np.sin(100.0 * t) / (11.0 + 1e5)
        return [max(-15.0, min(15.0, free)) - 100.0 * y[0]]

    return Case(text, 0.1, ("L.p",), {"": (rate, [])}, "", (0.0,))


def battery() -> Case:
    """A cell whose table is flat in the middle, with a load that is a current above 3.5 V."""
    text = """
hybond = 1
domain = "electrical"
[elements]
cell  = { C = { e = { table = [[0, 360, 3240, 3600], [3.0, 3.6, 3.6, 4.2]] } }, q = 3600 }
inner = { R = "50 mohm" }
load  = { R = { f = "if e > 3.5 then 2 else e/1.75" } }
slow  = { C = "1000 F" }
beside = { R = "20 mohm" }
i     = { junction = 1 }
par   = { junction = 0 }
[graph]
bonds = ["cell -> i -> inner", "i -> par -> slow", "par -> beside", "i -> load"]
"""

    def volts(y: State) -> float:
        return float(np.interp(y[0], [0.0, 360.0, 3240.0, 3600.0], [3.0, 3.6, 3.6, 4.2]))

    def above(t: float, y: State) -> list[float]:
        return [-2.0, 2.0 - y[1] / 20.0]

    def below(t: float, y: State) -> list[float]:
        current = (volts(y) - y[1] / 1000.0) / 1.8
        return [-current, current - y[1] / 20.0]

    leaves = (lambda t, y: volts(y) - y[1] / 1000.0 - 0.1 - 3.5, -1, "below")
    sides: dict[str, tuple[Rate, list[Way]]] = {"above": (above, [leaves]), "below": (below, [])}
    return Case(text, 1790.0, ("cell.q", "slow.q"), sides, "above", (3600.0, 0.0))


def belt() -> Case:
    """Stick and slip of a mass on a belt, with friction that falls with speed."""
    text = """
hybond = 1
domain = "translational"
[elements]
belt   = { Sf = "0.2 m/s" }
mass   = { I = "1 kg" }
spring = { C = "0.02 m/N" }
damp   = { R = "0.2 N*s/m" }
v      = { junction = 1 }
link   = { junction = 0 }
slip   = { junction = 1, law = "coulomb", limit = "2 + 2*exp(-(slip.f/(0.1 [m/s]))^2)" }
[graph]
bonds = ["belt -> link -> v -> mass", "v -> spring", "v -> damp", "link -> slip"]
"""

    def slips(t: float, y: State) -> list[float]:
        friction = 2.0 + 2.0 * np.exp(-(((0.2 - y[0]) / 0.1) ** 2))
        return [friction - 50.0 * y[1] - 0.2 * y[0], y[0]]

    def sticks(t: float, y: State) -> list[float]:
        return [0.0, 0.2]

    sides: dict[str, tuple[Rate, list[Way]]] = {
        "slips": (slips, [(lambda t, y: 0.2 - y[0], -1, "sticks")]),
        "sticks": (sticks, [(lambda t, y: 4.0 - 50.0 * y[1] - 0.04, -1, "slips")]),
    }
    return Case(text, 3.0, ("mass.p", "spring.q"), sides, "slips", (0.0, 0.0))


CASES = [backlash, check_valves, anti_windup, servo, amplifier, battery, belt]


@pytest.mark.parametrize("case", CASES, ids=lambda c: c.__name__)
def test_an_ordinary_model_with_corners_agrees_with_rates_written_by_hand(
    case: Callable[[], Case],
) -> None:
    c = case()
    times = np.linspace(0.0, c.until, 41)
    wanted = c.reference(times)
    run = hb.simulate(hb.loads(c.text), c.until)
    assert run.audit().holds()
    for k, name in enumerate(c.read):
        size = np.max(np.abs(wanted[:, k]))
        found = np.array([run[name].at(t) for t in times])
        assert np.max(np.abs(found - wanted[:, k])) <= 1e-6 * size, name
