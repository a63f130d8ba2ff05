"""A small circuit is the same beside a huge energy, where nothing connects the two.

Rounding was measured by the energy of the whole run: beside a flywheel a diode of nanovolts did not
conduct, a guard did not fire, and a charge did not jump, status ok. So it was later where a diode
that blocks, or an open switch, stood between the two.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

import hybond as hb
from hybond.engine.tables.islands import islands

W = 2.0 * math.pi
UNTIL = 1.2
LAST = {"coil": 0.6, "friction": 0.7}
"""Until when the closed forms hold."""


def coil(m: hb.Model, s: float) -> Callable[[float], float]:
    """A diode feeds a coil with a resistance from a sine: to the first zero of the current."""
    m.add(u=hb.Se(f"{s!r}*sin({W!r}*time)"), d=hb.One(law="diode"), l=hb.I(0.1), r=hb.R(0.5))
    m.bond("u -> d", "l -> d", "d -> r")
    z, phase = math.hypot(0.5, 0.1 * W), math.atan(0.2 * W)
    return lambda t: -0.1 * s / z * (math.sin(W * t - phase) + math.sin(phase) * math.exp(-5 * t))


def friction(m: hb.Model, s: float) -> Callable[[float], float]:
    """A mass on a spring, with dry friction: about its limit, then about the other side's."""
    m.add(l=hb.I(1.0, p=s), d=hb.One(law="coulomb", limit=0.3 * s), k=hb.C(1.0 / 36.0))
    m.bond("d -> l", "d -> k")
    x, phase = 0.3 / 36.0, math.atan2(0.3, 6.0)
    turn = (0.5 * math.pi - phase) / 6.0
    top = math.hypot(x, 1.0 / 6.0) - x

    def momentum(t: float) -> float:
        if t < turn:
            return s * math.cos(6.0 * t + phase) / math.cos(phase)
        return -6.0 * s * (top - x) * math.sin(6.0 * (t - turn))

    return momentum


def jump(m: hb.Model, s: float) -> Callable[[float], float]:
    """A source that jumps up charges a capacitor through a diode at once, and lets go later."""
    m.add(u=hb.Se(f"if time >= 0.4 and time < 0.6 then {s!r} else {0.1 * s!r}"), z=hb.Zero())
    m.add(d=hb.One(law="diode"), l=hb.C(1.0), r=hb.R(2.0))
    m.bond("u -> d -> z", "z -> l", "z -> r")
    return lambda t: s * (0.1 if t < 0.4 else 1.0 if t < 0.6 else math.exp(-0.5 * (t - 0.6)))


def guarded(m: hb.Model, s: float) -> Callable[[float], float]:
    """A relay with two thresholds; and a diode, beside which every guard counts rounding."""
    m.add(u=hb.Se(s), j=hb.One(), l=hb.C(1.0), r=hb.R(0.5), z=hb.Zero(), i=hb.One(), o=hb.R(0.1))
    m.bond("u -> j -> r", "j -> z -> l", "z -> i -> o")
    rules = [f"off -> on when l.e > {0.7 * s!r}", f"on -> off when l.e <= {0.3 * s!r}"]
    m.machine("M", states={"off": [], "on": ["i"]}, start="off", rules=rules)
    m.add(e=hb.Se(s), d=hb.One(law="diode"), c=hb.C(1.0), p=hb.R(0.5))
    m.bond("e -> d", "d -> p", "d -> c")

    def q(t: float) -> float:
        up, down = -0.5 * math.log(0.3), math.log((0.7 - 1 / 6) / (0.3 - 1 / 6)) / 12.0
        again = 0.5 * math.log(0.7 / 0.3)
        if t < up:
            return s * (1.0 - math.exp(-2.0 * t))
        t = (t - up) % (down + again)
        if t < down:
            return s * (1 / 6 + (0.7 - 1 / 6) * math.exp(-12.0 * t))
        return s * (1.0 - 0.7 * math.exp(-2.0 * (t - down)))

    return q


def sampled(m: hb.Model, s: float) -> Callable[[float], float]:
    """A capacitor follows a source that a clock moves; a diode hangs on it."""
    m.signal(u=hb.Sampled(f"{s!r}*sin(1*time)", every=0.25))
    m.add(v=hb.Se("u"), j=hb.Zero(), l=hb.C(1.0), d=hb.One(law="diode"), r=hb.R(1.0), c=hb.C(1.0))
    m.bond("v -> j -> l", "j -> d", "d -> r", "d -> c")
    return lambda t: s * math.sin(0.25 * math.floor(t / 0.25))


SMALL = {f.__name__: f for f in (coil, friction, jump, guarded, sampled)}


def put_wheel(m: hb.Model, energy: float) -> None:
    m.add(W=hb.I(2.0, p=2.0 * math.sqrt(energy)), JW=hb.One(), RW=hb.R(1e-3))
    m.bond("W -> JW -> RW")


def put_bank(m: hb.Model, energy: float) -> None:
    m.add(W=hb.C(1.0, q=math.sqrt(2.0 * energy)), JW=hb.Zero(), RW=hb.R(1e3))
    m.bond("JW -> W", "JW -> RW")


def put_tank(m: hb.Model, energy: float) -> None:
    level = math.sqrt(2.0 * energy)
    m.add(W=hb.C(1.0, q=level), JW=hb.Zero())
    m.add(RW=hb.R({"f": f"{math.sqrt(level)!r}*0.1*sign(e)*sqrt(abs(e))"}))
    m.bond("W -> JW -> RW")


def put_fall(m: hb.Model, energy: float) -> None:
    """What holds nothing yet, and all of it at the end."""
    m.add(W=hb.I(2.0), SW=hb.Se(2.0 * math.sqrt(energy)), JW=hb.One(law="diode"))
    m.bond("SW -> JW -> W")


BESIDE = {f.__name__[4:]: f for f in (put_wheel, put_bank, put_tank, put_fall)}


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("beside", "solver"), list(zip(BESIDE, ["auto", "rk45", "radau", "rk45"], strict=True))
)
@pytest.mark.parametrize("small", SMALL)
def test_a_small_circuit_beside_a_huge_energy(small: str, beside: str, solver: str) -> None:
    for s, energy in ((1e-9, 1e10), (1.0, 1e16)):
        m = hb.Model("beside")
        value = SMALL[small](m, s)
        alone = fired(hb.simulate(m, UNTIL, solver=solver))
        BESIDE[beside](m, energy)
        run = hb.simulate(m, UNTIL, solver=solver)
        name = "l.p" if "l.p" in run.names else "l.q"
        for t in np.linspace(0.03, LAST.get(small, UNTIL), 12):
            assert run[name].at(t) == pytest.approx(value(t), rel=1e-5, abs=1e-6 * s), (s, t)
        there = fired(run)
        assert [what for _, what in there] == [what for _, what in alone]
        assert [t for t, _ in there] == pytest.approx([t for t, _ in alone], rel=1e-5)


def fired(run: hb.Result) -> list[tuple[float, tuple[str, str, str]]]:
    """Return what the machines of the small circuit did, and when."""
    steps = [(e.t, f) for e in run.events for step in e.steps for f in step.fired]
    return [(t, (f.machine, f.source, f.target)) for t, f in steps if not f.machine.endswith("W")]


JOINT = {"coil": "d", "friction": "d", "jump": "z", "guarded": "z", "sampled": "j"}
"""The junction at which each small circuit is joined to something."""


def put_parted(m: hb.Model, at: str, by: str, energy: float, until: float = 9.0) -> None:
    """Put a huge energy beside a junction, parted from it by what is OFF until then, or always."""
    # a diode that leads to the small circuit blocks what is lower than that
    level = math.sqrt(2.0 * energy) * (-1.0 if by.endswith("back") else 1.0)
    law = "diode" if by.startswith("diode") else None
    if at == "d":
        m.add(W=hb.I(1.0, p=level), JW=hb.One(), RW=hb.R(1e-3), X=hb.Zero(law=law))
    else:
        m.add(W=hb.C(1.0, q=level), JW=hb.Zero(), RW=hb.R(1e3), X=hb.One(law=law))
    m.bond("JW -> W", "JW -> RW")
    m.bond(f"JW -> X -> {at}" if by.endswith("back") else f"{at} -> X -> JW")
    if law is None:
        rules = [f"open -> shut when time > {until}"]
        m.machine("XW", states={"open": [], "shut": ["X"]}, start="open", rules=rules)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("by", ["switch", "diode", "diode back"])
@pytest.mark.parametrize("small", SMALL)
def test_a_small_circuit_parted_from_a_huge_energy(small: str, by: str) -> None:
    """By an open switch, or by a diode that blocks: 130 % off, and laws that did not act."""
    s, energy = 1e-9, 1e10
    m = hb.Model("parted")
    value = SMALL[small](m, s)
    alone = fired(hb.simulate(m, UNTIL))
    put_parted(m, JOINT[small], by, energy)
    run = hb.simulate(m, UNTIL)
    name = "l.p" if "l.p" in run.names else "l.q"
    for t in np.linspace(0.03, LAST.get(small, UNTIL), 12):
        assert run[name].at(t) == pytest.approx(value(t), rel=1e-5, abs=1e-6 * s), t
    there = [(t, what) for t, what in fired(run) if what[0] != "X"]
    assert [what for _, what in there] == [what for _, what in alone]
    assert [t for t, _ in there] == pytest.approx([t for t, _ in alone], rel=1e-5)


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau", "moreau-jean"])
def test_a_small_circuit_that_is_joined_to_a_huge_energy(solver: str) -> None:
    """It is what it is alone up to then, and what both make of it from then on."""
    m = hb.Model("joined")
    m.add(l=hb.C(1.0, q=1e-9), r=hb.R(2.0), z=hb.Zero(), d=hb.One(law="diode"), o=hb.R(8.0))
    m.bond("z -> l", "z -> r", "z -> d -> o")
    put_parted(m, "z", "switch", 1e10, until=1.0)
    steps = solver == "moreau-jean"
    run = hb.simulate(m, 1.2, solver=solver, step="1 ms" if steps else None)
    leak = 0.5 + 1.0 / 8.0
    for t in (0.3, 0.9):
        assert run["l.q"].at(t) == pytest.approx(1e-9 * math.exp(-leak * t), rel=1e-5)
    bank = math.sqrt(2e10) * math.exp(-1e-3)
    both = 0.5 * bank * math.exp(-0.5 * (leak + 1e-3) * 0.2)
    assert run["l.q"].at(1.2) == pytest.approx(both, rel=1e-3 if steps else 1e-5)
    assert run.audit().holds()


def test_what_is_open_joins_what_it_is_asked_of() -> None:
    """A law that is asked for its net effort ties its bonds: no guard fires twice at an instant."""
    run = hb.simulate(hb.load("examples/ratchet.toml"))
    for event in run.events:
        machines = [f.machine for step in event.steps for f in step.fired]
        assert len(machines) == len(set(machines)), event.t


@pytest.mark.parametrize("beside", BESIDE)
def test_fixed_steps_of_a_small_circuit_with_a_bent_law(beside: str) -> None:
    """Each step is solved to a part of what is there: it ended where it began."""
    ends = []
    for energy in (None, 1e16):
        m = hb.Model("bent")
        m.add(u=hb.Se(f"1e-9*sin({W!r}*time)"), d=hb.One(law="diode"), r=hb.R(0.5))
        m.add(l=hb.C({"e": "q + 1e18*q^3"}))
        m.bond("u -> d", "d -> r", "d -> l")
        if energy is not None:
            BESIDE[beside](m, energy)
        ends.append(hb.simulate(m, 0.2, solver="moreau-jean", step="2 ms")["l.q"].at(0.2))
    assert ends[1] == pytest.approx(ends[0], rel=1e-9)
    assert ends[0] == pytest.approx(0.19148e-9, rel=0.02)  # by SciPy


JOINED = {
    "a junction": ([], True),
    "nothing": ([], False),
    "a law that reads an effort": ({"e": "f*(1 + W.e)"}, True),
    "a factor that is stored": ({"e": "f*W.q"}, False),
    "a difference of what is stored": ({"e": "f*(W.q - 1)"}, True),
}


@pytest.mark.parametrize("by", JOINED)
def test_what_rounding_passes_through(by: str) -> None:
    law, together = JOINED[by]
    m = hb.Model("islands")
    m.add(l=hb.C(1.0), z=hb.Zero(), r=hb.R(law or 1.0), W=hb.C(1.0), JW=hb.Zero(), RW=hb.R(1.0))
    m.bond("z -> l", "z -> r", "W -> JW", "JW -> RW")
    if by == "a junction":
        m.add(i=hb.One())
        m.bond("z -> i", "i -> JW")
        m.machine(
            "S",
            states={"open": [], "shut": ["i"]},
            start="open",
            rules=["open -> shut when time > 9"],
        )
    found = islands(m.flatten())
    assert found[:4] == [0, 0, 0 if together else 1, 0 if together else 1]


def test_friction_in_the_plane_is_one_force() -> None:
    """Of a body with a mass for each direction, which nothing else connects."""
    g = hb.load("examples/planar_puck.toml").flatten()
    assert set(islands(g)) == {0}
