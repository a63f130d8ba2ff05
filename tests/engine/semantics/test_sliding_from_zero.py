"""Sliding that begins where a diode's current is zero: coils that are led up from nothing.

What is stored says that the diode blocks, and a blocking diode holds the coil at zero. Along the
reference it conducts from then on.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

TIGHT: dict[str, Any] = {"rtol": 1e-11, "atol": 1e-13, "dense_output": True}
SOLVERS = ["auto", "radau", "rk45"]
V, L, C = 12.0, 0.05, 0.2
LOAD = {"boost": 20.0, "buck": 1.0, "inverting": 20.0}
OUT = {"boost": 20.0, "buck": 5.0, "inverting": 8.0}
BONDS = {
    "boost": ["src -> coil", "coil -> node", "node -> sw", "node -> D", "D -> out"],
    "buck": ["src -> sw", "sw -> node", "D -> node", "node -> coil", "coil -> out"],
    "inverting": ["src -> sw", "sw -> node", "node -> coil", "D -> node", "D -> out"],
}


def pulses(t: float) -> tuple[float, float]:
    """Return half a sine, nothing, half a sine, and its slope."""
    s = math.sin(3 * t)
    return (4 * s, 12 * math.cos(3 * t)) if s > 0 else (0.0, 0.0)


def late(t: float) -> tuple[float, float]:
    return (5 * (t - 0.3), 5.0) if t > 0.3 else (0.0, 0.0)


def humps(t: float) -> tuple[float, float]:
    """Return what comes to zero and rises again at once."""
    s = math.sin(3 * (t - 0.3))
    way = 1.0 if s > 0 else -1.0
    return (4 * way * s, 12 * way * math.cos(3 * (t - 0.3))) if t > 0.3 else (0.0, 0.0)


REFERENCES: dict[str, tuple[str, Callable[[float], tuple[float, float]], list[float]]] = {
    "pulses": ("max(0, 4*sin(3*time))", pulses, [k * math.pi / 3 for k in range(1, 3)]),
    "late": ("if time < 0.3 then 0 else 5*(time - 0.3)", late, [0.3]),
    "humps": (
        "if time < 0.3 then 0 else 4*abs(sin(3*(time - 0.3)))",
        humps,
        [0.3, 0.3 + math.pi / 3, 0.3 + 2 * math.pi / 3],
    ),
    "ramp": ("3*time", lambda t: (3 * t, 3.0), []),
}
UNTIL = 2.5


def model(
    kind: str, reference: str, law: bool = True, dual: bool = False, turned: bool = False
) -> hb.Model:
    """Return a converter, or its dual: a spring driven by a speed in place of a coil."""
    m = hb.Model("converter")
    one, zero = (hb.Zero, hb.One) if dual else (hb.One, hb.Zero)
    flow, effort = ("e", "f") if dual else ("f", "e")
    held: dict[str, Any] = {
        "src": hb.Sf(V) if dual else hb.Se(V),
        "L": hb.C(L) if dual else hb.I(L),
        "Co": hb.I(C, p=C * OUT[kind]) if dual else hb.C(C, q=C * OUT[kind]),
        "Ro": hb.G(LOAD[kind]) if dual else hb.R(LOAD[kind]),
        "coil": one(),
        "sw": one(),
        "node": zero(),
        "out": zero(),
        "D": one(law="diode") if law else one(),
    }
    bonds = [*BONDS[kind], "L -> coil" if turned else "coil -> L", "out -> Co", "out -> Ro"]
    m.add(**dict(reversed(held.items())) if turned else held)
    m.bond(*(reversed(bonds) if turned else bonds))
    m.signal(ref=reference)
    read = f"coil.{flow}" if law else f"pre(coil.{flow})"
    m.machine(
        "drive",
        states={"off": [], "on": ["sw"]},
        start="off",
        rules=[f"off -> on when {read} < ref", f"on -> off when {read} > ref"],
    )
    if not law:
        m.machine(
            "lets",
            states={"blocks": [], "conducts": ["D"]},
            start="blocks",
            rules=[
                f"blocks -> conducts when D.{effort} > 0",
                f"conducts -> blocks when D.{flow} < 0",
            ],
        )
    return m


def moves(kind: str, i: float, slope: float, v: float) -> float:
    """Return how the output moves where the current of the coil is `i` and has this slope."""
    on, off = {"boost": (V, V - v), "buck": (V - v, -v), "inverting": (V, -v)}[kind]
    share = (L * slope - off) / (on - off) if i > 0 else 1.0
    assert 0 <= share <= 1
    through = i if kind == "buck" else (1 - share) * i
    return (through - v / LOAD[kind]) / C


def expected(kind: str, name: str) -> Callable[[np.ndarray], np.ndarray]:
    _, led, kinks = REFERENCES[name]
    parts = []
    v = OUT[kind]
    for a, b in itertools.pairwise([0.0, *kinks, UNTIL]):
        middle = (a + b) / 2

        def rate(t: float, y: Any, a: float = a, b: float = b) -> list[float]:
            i, slope = led(min(max(t, a + 1e-12), b - 1e-12))
            return [moves(kind, i, slope, y[0])]

        s = solve_ivp(rate, (a, b), [v], method="DOP853", max_step=0.02, **TIGHT)
        v = s.y[0][-1]
        parts.append((a, b, s.sol))
        assert led(middle)[0] >= 0

    def at(t: np.ndarray) -> np.ndarray:
        found = [next(f(x)[0] for a, b, f in parts if a <= x <= b) for x in t]
        return np.array(found)

    return at


def agrees(run: hb.Result, kind: str, name: str, dual: bool) -> None:
    flow, effort = ("e", "f") if dual else ("f", "e")
    assert run.status == "ok"
    assert run.audit().holds()
    assert run.warnings == ()
    t = np.linspace(0.01, UNTIL - 0.01, 173)
    i = np.array([REFERENCES[name][1](x)[0] for x in t])
    assert run[f"coil.{flow}"].at(t) == pytest.approx(i, abs=1e-8)
    assert run[f"out.{effort}"].at(t) == pytest.approx(expected(kind, name)(t), rel=1e-6)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize("name", REFERENCES)
@pytest.mark.parametrize("kind", BONDS)
@pytest.mark.sampled(3)
def test_a_coil_without_current_is_led_up_along_its_reference(
    kind: str, name: str, dual: bool, turned: bool, solver: str
) -> None:
    m = model(kind, REFERENCES[name][0], dual=dual, turned=turned)
    agrees(hb.simulate(m, until=UNTIL, solver=solver), kind, name, dual)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("name", ["late", "humps", "ramp"])
@pytest.mark.parametrize("kind", ["boost", "inverting"])
def test_a_diode_written_as_a_machine_follows_the_switch_that_slides(
    kind: str, name: str, turned: bool, solver: str
) -> None:
    # entering a mode in which it blocks the coil is an impulse, by which it conducts
    m = model(kind, REFERENCES[name][0], law=False, turned=turned)
    agrees(hb.simulate(m, until=UNTIL, solver=solver), kind, name, False)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("battery", [20.0, 400.0])
def test_rest_at_a_reference_of_zero_stays_rest(battery: float, solver: str) -> None:
    m = hb.Model("boost")
    m.add(src=hb.Se(V), coil=hb.One(), L=hb.I(L), node=hb.Zero(), sw=hb.One())
    m.add(D=hb.One(law="diode"), out=hb.Zero(), bat=hb.Se(battery))
    m.bond(*BONDS["boost"], "coil -> L", "out -> bat")
    m.signal(ref="max(0, 1 - abs(4*(time - 1)))")
    m.machine(
        "drive",
        states={"off": [], "on": ["sw"]},
        start="off",
        rules=["off -> on when coil.f < ref", "on -> off when coil.f > ref"],
    )
    run = hb.simulate(m, until=2.0, solver=solver)
    assert run.status == "ok"
    assert run.audit().holds()
    t = np.array([0.3, 0.7, 0.8, 0.99, 1.1, 1.2, 1.3, 1.9])
    assert run["coil.f"].at(t) == pytest.approx(np.maximum(0, 1 - 4 * np.abs(t - 1)), abs=1e-10)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("lamp_first", [False, True])
@pytest.mark.parametrize(("I", "R", "C"), [(1.0, 10.0, 0.3), (0.7, 3.0, 0.1)])
def test_what_stood_before_moves_in_the_modes_that_are_looked_at(
    I: float, R: float, C: float, lamp_first: bool, solver: str
) -> None:
    # the bus stands at its voltage; a lamp that moves nothing crosses the same surface as the sink
    v0 = I * R
    m = hb.Model("bus")
    m.add(feed=hb.Sf(I), n=hb.Zero(), R=hb.R(R), C=hb.C(C, q=C * v0))
    m.add(sink=hb.Sf('if sinks.state == "on" then 5 else 0'))
    m.bond("feed -> n", "n -> R", "n -> C", "n -> sink")
    m.signal(ref=f"{v0!r} + 1 - time")
    for name in ("lamp", "sinks") if lamp_first else ("sinks", "lamp"):
        more = " and time < 5" if name == "sinks" else ""
        m.machine(
            name,
            states={"off": [], "on": []},
            start="off",
            rules=[f"off -> on when n.e > ref{more}", "on -> off when n.e < ref"],
        )
    run = hb.simulate(m, until=2.0, solver=solver)
    assert run.status == "ok"
    assert len(run.events) == 2  # the start, and the instant from which it slides
    assert run["n.e"].at(np.array([0.5, 1.5])) == pytest.approx([v0, v0 - 0.5], rel=1e-12)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("kind", BONDS)
def test_a_reference_that_begins_all_but_at_zero_is_followed(
    kind: str, turned: bool, dual: bool, solver: str
) -> None:
    # so little current counts for none: the diode blocked, the switch closed, and opened again
    for begin in ("1e-15", "1e-14", "1e-13", "1e-12", "1e-11", "1e-10", "1e-9"):
        m = model(kind, f"3*time + {begin}", dual=dual, turned=turned)
        agrees(hb.simulate(m, until=UNTIL, solver=solver), kind, "ramp", dual)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", ["late", "humps", "ramp"])
@pytest.mark.parametrize("kind", BONDS)
def test_a_run_cut_where_it_begins_to_slide_goes_on_sliding(
    kind: str, name: str, solver: str
) -> None:
    m = model(kind, REFERENCES[name][0])
    begins = hb.simulate(m, until=UNTIL, solver=solver).sliding[0].t0
    for late in (0.0, 1e-13, 1e-9, 1e-6):
        if begins + late == 0.0:
            continue
        state = hb.simulate(m, until=UNTIL, solver=solver).state(begins + late)
        run = hb.simulate(m, until=UNTIL, start=state, solver=solver)
        assert run.status == "ok" and run.audit().holds()
        t = np.linspace(0.5, UNTIL - 0.01, 50)
        i = np.array([REFERENCES[name][1](x)[0] for x in t])
        assert run["coil.f"].at(t) == pytest.approx(i, abs=1e-8)
        assert run["out.e"].at(t) == pytest.approx(expected(kind, name)(t), rel=1e-6)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("turned", [False, True])
def test_nothing_is_warned_of_where_a_rectified_voltage_begins_at_zero(
    turned: bool, solver: str
) -> None:
    # at zero nothing pushes from either side; the coil catches up with its reference a little later
    m = model("boost", "abs(sin(3*time))", turned=turned)
    m.elements["src"] = hb.Se(f"{V}*abs(sin(3*time))")
    run = hb.simulate(m, until=0.95, solver=solver)
    assert run.status == "ok" and run.audit().holds()
    assert run.warnings == ()
    most = V / (3 * L)
    caught = 2 / 3 * math.atan(1 / most)
    t = np.linspace(1e-3, 0.94, 200)
    right = np.where(t < caught, most * (1 - np.cos(3 * t)), np.sin(3 * t))
    assert run["coil.f"].at(t) == pytest.approx(right, abs=1e-7)
