"""Laws bend while a switch slides, too: a pulse that a step passed over was one that never was.

Each system slides on a surface from the start, or beside one that does; what is asked of it is
known in closed form.
"""

import math

import numpy as np
import pytest

import hybond as hb

SOLVERS = ("auto", "radau", "rk45")


def relay(ref="1", drive="5", start=1.0):
    """A mass that a relay holds at `ref`, from the start if that is `start`."""
    m = hb.Model("m")
    m.add(
        d=hb.Se(f'if q.state == "on" then {drive} else -({drive})'), w=hb.One(), i=hb.I(1, f=start)
    )
    m.bond("d -> w", "w -> i")
    m.signal(ref=ref)
    m.machine(
        "q",
        states={"off": [], "on": []},
        start="off",
        rules=["off -> on when w.f < ref", "on -> off when w.f > ref"],
    )
    return m


def slides_all_along(r):
    """Whether the run has slid from its start to its end."""
    return len(r.sliding) == 1 and r.sliding[0].t0 == 0.0 and r.sliding[0].t1 == r.t_end


PULSES = {
    "a spike": ("max(0, 0.001 - abs(time - 2.5))*1e6", 1.0),
    "a hat": ("max(0, 1 - abs(time - 3.3)*1e4)*1e4", 1.0),
    "flat on both sides": ("if max(0, 0.001 - abs(time - 2.5)) > 0 then 500 else 0", 1.0),
    "two": ("1e6*(max(0, 0.001 - abs(time - 1.7)) + max(0, 0.001 - abs(time - 4.1)))", 2.0),
    "the top of a wave": (
        "max(0, sin(pi*time) - 0.9999)*1e6",
        3e6 / math.pi * (2 * math.sin(math.acos(0.9999)) - 2 * 0.9999 * math.acos(0.9999)),
    ),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", PULSES)
@pytest.mark.parametrize("turned", [False, True])
def test_pulse_beside(name, solver, turned):
    law, given = PULSES[name]
    m = relay()
    m.add(s=hb.Se(law), v=hb.One(), k=hb.I(1.0))
    m.bond("v -> s" if turned else "s -> v", "v -> k")
    r = hb.simulate(m, 5.0, solver=solver)
    assert r.status == "ok"
    assert slides_all_along(r)
    assert r["k.f"].at(5.0) == pytest.approx(-given if turned else given, rel=1e-5)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", PULSES)
def test_pulse_through_what_slides(name, solver):
    """The relay carries the pulse: its mean force is less by that."""
    law, given = PULSES[name]
    m = relay(drive="2e4")
    m.add(s=hb.Se(law))
    m.bond("s -> w")
    m.signal(carried=hb.Integral("d.e"))
    r = hb.simulate(m, 5.0, solver=solver)
    assert r.status == "ok"
    assert slides_all_along(r)
    assert r["i.f"].at(5.0) == pytest.approx(1.0, rel=1e-12)
    assert r["carried"].at(5.0) == pytest.approx(-given, rel=1e-5)


BENT = {
    "max(0, e - 11)": lambda e: np.maximum(0, e - 11),
    "max(0, abs(e) - 11)": lambda e: np.maximum(0, np.abs(e) - 11),
    "max(0, -8.5 - e)": lambda e: np.maximum(0, -8.5 - e),
    "max(0, 1e-3 - abs(e - 12))*1e6": lambda e: np.maximum(0, 1e-3 - np.abs(e - 12)) * 1e6,
    "max(0, 1e-3 - abs(e + 8.7))*1e6": lambda e: np.maximum(0, 1e-3 - np.abs(e + 8.7)) * 1e6,
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("law", BENT)
def test_law_that_bends_in_one_of_the_modes(law, solver):
    """What the drive does on one side alone, no mean says: its own resistor bends there."""
    m = hb.Model("m")
    m.add(
        d=hb.Se('if q.state == "on" then 10 + 4*time else -8 - time'),
        node=hb.Zero(),
        r=hb.R({"f": law}),
        w=hb.One(),
        i=hb.I(1.0, f=1.0),
    )
    m.bond("d -> node", "node -> r", "node -> w", "w -> i")
    m.signal(ref="1", drawn=hb.Integral("r.f"))
    m.machine(
        "q",
        states={"off": [], "on": []},
        start="off",
        rules=["off -> on when w.f < ref", "on -> off when w.f > ref"],
    )
    t = np.linspace(0.0, 1.0, 2_000_001)
    on, off = 10 + 4 * t, -8 - t
    w = off / (off - on)
    mean = w * BENT[law](on) + (1 - w) * BENT[law](off)
    r = hb.simulate(m, 1.0, solver=solver)
    assert r.status == "ok"
    assert slides_all_along(r)
    assert r["drawn"].at(1.0) == pytest.approx(np.trapezoid(mean, t), rel=1e-6)


ON_THE_SURFACE = "(1 + 0.5*sin(3*time))"


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    "law",
    [
        f"-0.5*sign(w.f - {ON_THE_SURFACE})",
        f"if w.f > {ON_THE_SURFACE} then -0.5 else 0.5",
        f"abs(w.f - {ON_THE_SURFACE})",
        f"-3*max(0, w.f - {ON_THE_SURFACE})",
    ],
)
def test_law_that_bends_where_the_relay_holds_it(law, solver):
    """What it compares has the sign of rounding: it passes nothing, and ends no step."""
    m = relay(ref=ON_THE_SURFACE)
    m.add(s=hb.Se(law))
    m.bond("s -> w")
    plain = hb.simulate(relay(ref=ON_THE_SURFACE), 10.0, solver=solver)
    r = hb.simulate(m, 10.0, solver=solver, max_steps=20_000)
    assert r.status == "ok"
    assert slides_all_along(r)
    for t in (1.0, 4.3, 10.0):
        assert r["w.f"].at(t) == pytest.approx(1 + 0.5 * math.sin(3 * t), abs=1e-12)
    assert r.stats["steps"] < 2 * plain.stats["steps"]


@pytest.mark.parametrize("solver", SOLVERS)
def test_what_is_flat_at_zero_far_from_where_it_bends_does_not_lie_on_the_surface(solver):
    """A body passes a narrow field far from rest, which pushes it on."""
    m = relay()
    m.add(
        v=hb.One(), k=hb.I(1.0, f=1.0), s=hb.Se("if max(0, 1e-3 - abs(x - 2)) > 0 then 500 else 0")
    )
    m.bond("s -> v -> k")
    m.signal(x=hb.Integral("v.f"))
    r = hb.simulate(m, 5.0, solver=solver)
    assert r.status == "ok"
    assert slides_all_along(r)
    assert r["k.f"].at(5.0) == pytest.approx(math.sqrt(1 + 2 * 500 * 2e-3), rel=1e-6)
