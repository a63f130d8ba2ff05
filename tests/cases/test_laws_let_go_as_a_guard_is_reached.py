"""A law that carries nothing is not let go of just before a guard: both are one instant.

Beside junction laws rounding is measured by the largest energy there has been. A guard was located
by that of the beginning of its step, and settled by that of its end: at the rim of rounding it was
none, a diode without current blocked there alone, and the guard fired a femtosecond later (HB-N411,
"fires apart from its own instant").
"""

from __future__ import annotations

import itertools
import math
import random

import pytest
from scipy.integrate import solve_ivp

import hybond as hb
from hybond.model.parts import Part

SEEDS = [9, 13, 44, 63, 111, 128]
"""Of sizes with which they were two instants, with one solver or both."""


def one_way(law: str) -> Part:
    """Return what carries current one way only; a thyristor is fired all the time."""
    return hb.One(law="thyristor", gate="time >= 0") if law == "thyristor" else hb.One(law="diode")


def stop(law: str) -> Part:
    """Return what pushes and does not pull."""
    return hb.Zero(law="unilateral") if law == "unilateral" else hb.Zero(law="diode")


class Drive:
    """A coil held in a band, which turns a shaft, and beside it one whose current has died away."""

    def __init__(self, seed: int, turned: bool, law: str) -> None:
        g = random.Random(seed)
        self.volts, self.coil, self.loss = (
            g.uniform(20, 400),
            10 ** g.uniform(-3, 0),
            g.uniform(0.1, 3),
        )
        dead, leak = 10 ** g.uniform(-3, 0), 10 ** g.uniform(3, 6)
        mean = g.uniform(0.3, 0.9) * self.volts / self.loss
        half = mean * g.uniform(0.02, 0.2)
        self.high, self.low = mean + half, mean - half
        begin = 10 ** g.uniform(-6, 0)
        self.inertia, self.drag = g.uniform(1, 100), g.uniform(0.1, 10)
        self.turns, other = g.uniform(0.01, 0.3), g.uniform(0.01, 0.3)
        leaks = g.random() < 0.5
        self.until = 4.0 * self.coil / self.loss
        self.dead, self.leak, self.begin = dead, leak, begin
        s = -1.0 if turned else 1.0
        m = self.model = hb.Model("drive")
        m.add(V=hb.Se(self.volts), r=hb.Zero(), q=hb.One(), na=hb.Zero(), a=hb.One())
        m.add(La=hb.I(self.coil), Ra=hb.R(self.loss), gr=hb.Zero(), gnd=hb.Se(0.0))
        m.add(da=one_way(law), dc=one_way(law), nc=hb.Zero(), c=hb.One())
        m.add(Lc=hb.I(dead, p=s * dead * begin), Rc=hb.R(leak))
        m.add(s=hb.One(), J=hb.I(self.inertia), B=hb.R(self.drag))
        m.add(ga=hb.GY(f"{self.turns!r}*La.f"), gc=hb.GY(f"{other!r}*Lc.f"))
        bonds = ["V -> r", "r -> q", "q -> na", "na -> a", "a -> La", "a -> Ra", "gr -> gnd"]
        bonds += ["gr -> da", "da -> na", "gr -> dc", "dc -> nc", "nc -> c", "c -> Rc", "a -> ga.1"]
        bonds += ["ga.2 -> s", "c -> gc.1", "gc.2 -> s", "s -> J", "s -> B"]
        bonds += ["Lc -> c" if turned else "c -> Lc"]
        if leaks:
            m.add(ra=hb.R(1e5))
            bonds += ["na -> ra"]
        g.shuffle(bonds)
        m.bond(*bonds)
        rules = [f"on -> off when La.f > {self.high!r}", f"off -> on when La.f < {self.low!r}"]
        m.machine("S", states={"on": ["q"], "off": []}, start="on", rules=rules)


class Band:
    """A shaft held in a band, and a body that comes to rest against what it drives by a stop."""

    def __init__(self, seed: int, turned: bool, law: str) -> None:
        g = random.Random(seed)
        self.volts, self.coil, self.loss = (
            g.uniform(20, 400),
            10 ** g.uniform(-1, 2),
            g.uniform(0.1, 3),
        )
        mean = g.uniform(0.3, 0.9) * self.volts / self.loss
        half = mean * g.uniform(0.02, 0.2)
        self.high, self.low = mean + half, mean - half
        dead = 10 ** g.uniform(-2, 1)
        damper = dead * self.loss / self.coil * 10 ** g.uniform(1, 4)
        begin = (-1.0 if turned else 1.0) * 10 ** g.uniform(-6, 0)
        g.uniform(0.01, 3)  # of no use, but for the sizes that come after it
        self.inertia, self.drag, self.turns = (
            g.uniform(1, 100),
            g.uniform(0.1, 10),
            g.uniform(0.01, 0.3),
        )
        self.until = 4.0 * self.coil / self.loss
        m = self.model = hb.Model("band")
        m.add(F=hb.Se(self.volts), q=hb.One(), na=hb.Zero(), a=hb.One(), Ma=hb.I(self.coil))
        m.add(Ba=hb.R(self.loss), da=hb.One(law="diode"), gnd=hb.Se(0.0))
        m.add(c=hb.One(), Mc=hb.I(dead, p=dead * begin), Rc=hb.R(damper))
        m.add(s=hb.One(), J=hb.I(self.inertia), B=hb.R(self.drag), ga=hb.GY(f"{self.turns!r}*Ma.f"))
        m.add(x=stop(law), v=hb.One(), Mv=hb.I(dead * g.uniform(0.1, 3)))
        m.add(Rv=hb.R(damper * g.uniform(1, 3)), gc=hb.GY(f"{g.uniform(0.01, 0.3)!r}*Mc.f"))
        bonds = ["F -> q", "q -> na", "na -> a", "a -> Ma", "a -> Ba", "gnd -> da", "da -> na"]
        bonds += ["a -> ga.1", "ga.2 -> s", "s -> J", "s -> B", "c -> Mc", "c -> Rc"]
        bonds += ["v -> x", "x -> c"] if turned else ["c -> x", "x -> v"]
        bonds += ["v -> Mv", "v -> Rv", "c -> gc.1", "gc.2 -> s"]
        g.shuffle(bonds)
        m.bond(*bonds)
        rules = [f"on -> off when Ma.f > {self.high!r}", f"off -> on when Ma.f < {self.low!r}"]
        m.machine("S", states={"on": ["q"], "off": []}, start="on", rules=rules)


class Reaches:
    """What ends an integration: the first of what moves is led to a bound, in one direction."""

    terminal = True

    def __init__(self, bound: float, direction: float) -> None:
        self.bound, self.direction = bound, direction

    def __call__(self, _: float, y: list[float]) -> float:
        return y[0] - self.bound


def switched(drive: Drive | Band) -> list[float]:
    """When the switch turns, from the equations of the two that move; all else carries nothing."""
    t, on, x, found = 0.0, True, [0.0, 0.0], []
    while t < drive.until:
        bound = drive.high if on else drive.low
        push = drive.volts if on else 0.0

        def rates(_t: float, y: list[float], push: float = push) -> list[float]:
            by = drive.turns * y[0]
            return [
                (push - drive.loss * y[0] - by * y[1]) / drive.coil,
                (by * y[0] - drive.drag * y[1]) / drive.inertia,
            ]

        span, reached = (t, drive.until), Reaches(bound, 1.0 if on else -1.0)
        run = solve_ivp(rates, span, x, "DOP853", events=reached, rtol=1e-11, atol=1e-12)
        t, x = float(run.t[-1]), [float(y) for y in run.y[:, -1]]
        if run.status != 1:
            break
        found.append(t)
        on = not on
    return found


def holds_together(run: hb.Result, drive: Drive | Band) -> None:
    """Assert that no two events are of one instant, and that the switch turns when it should."""
    assert run.status == "ok"
    assert run.audit().holds()
    for before, after in itertools.pairwise([e.t for e in run.events]):
        assert after - before > 1e-11 * drive.until
    turns = [e.t for e in run.events if any(f.machine == "S" for s in e.steps for f in s.fired)]
    assert turns == pytest.approx(switched(drive), rel=1e-6)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("law", ["diode", "thyristor"])
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_diode_that_carries_nothing_is_let_go_at_the_instant_of_the_switch(
    seed: int, turned: bool, solver: str, law: str
) -> None:
    drive = Drive(seed, turned, law)
    run = hb.simulate(drive.model, until=drive.until, rtol=1e-8, solver=solver)
    holds_together(run, drive)
    size = drive.begin * math.exp(-drive.until * drive.leak / drive.dead)
    assert run["Lc.f"].at(drive.until) == pytest.approx(
        -size if turned else size, abs=1e-9 * max(drive.begin, drive.high)
    )


@pytest.mark.sampled(2)
@pytest.mark.parametrize("law", ["diode", "unilateral"])
@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("seed", [1, 15, 44])
def test_a_stop_that_carries_nothing_is_let_go_at_the_instant_of_the_switch(
    seed: int, turned: bool, solver: str, law: str
) -> None:
    """With the last of these sizes that was refused: HB-N411."""
    drive = Band(seed, turned, law)
    holds_together(hb.simulate(drive.model, until=drive.until, rtol=1e-8, solver=solver), drive)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("seed", range(12))
def test_a_timed_switch_and_one_of_its_instant_hand_a_current_on(
    seed: int, turned: bool, solver: str
) -> None:
    """They cut off what flows in between, silently, where a diode loop stood beside them.

    A momentum that rises by a constant force reaches its bound at the time of the other switch.
    """
    g = random.Random(seed)
    force, at, mass = g.uniform(0.5, 3), g.uniform(0.3, 2.0), 10 ** g.uniform(-1, 1)
    m, momentum, dead = hb.Model("handed on"), g.uniform(0.5, 2), 10 ** g.uniform(-2, 0)
    m.add(u=hb.Se(force), n=hb.One(), C=hb.I(mass), L=hb.I(10 ** g.uniform(-2, 1), p=momentum))
    m.add(x=hb.Zero(), a=hb.One(), b=hb.One(), nc=hb.Zero(), c=hb.One(), dc=hb.One(law="diode"))
    m.add(Lc=hb.I(dead, p=dead * 10 ** g.uniform(-8, -6)), Rc=hb.R(10 ** g.uniform(1, 3)))
    m.add(gz=hb.Zero(), gs=hb.Se(0.0), gy=hb.GY("1e-2*Lc.f"))
    bonds = ["u -> n", "n -> C", "L -> x", "x -> a", "x -> b", "gz -> gs", "gz -> dc", "dc -> nc"]
    bonds += ["nc -> c", "c -> Lc", "c -> Rc", "n -> gy.1", "gy.2 -> c"]
    g.shuffle(bonds)
    m.bond(*bonds)
    guards = [f"time >= {at!r}", f"C.f > {force * at / mass!r}"]
    first, second = reversed(guards) if turned else guards
    rules = [f"on -> off when {first}"]
    m.machine("ma", states={"on": ["a"], "off": []}, start="on", rules=rules)
    rules = [f"off -> on when {second}"]
    m.machine("mb", states={"off": [], "on": ["b"]}, start="off", rules=rules)
    run = hb.simulate(m, until=2.0 * at, rtol=1e-8, solver=solver)
    assert run.status == "ok"
    assert run["L.p"].at(2.0 * at) == pytest.approx(momentum, rel=1e-12)
