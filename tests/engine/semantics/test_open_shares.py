"""Shares that nothing decides: impulses along rings of bonds, guards that read what is open.

Least leakage gives closed forms: the sum of squares of what is shared is least.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb


def events(m: hb.Model, until: float = 1.0) -> list:
    return list(hb.simulate(m, until=until).trace.events)


# -- impulses --------------------------------------------------------------------------------------


def test_a_ring_of_bonds_keeps_its_impulses() -> None:
    m = hb.Model("ring")
    m.add(a=hb.Zero(), b=hb.Zero(), x=hb.C(1.0, q=0.7))
    m.bond("x -> a", "a -> b", "a -> b")
    m.machine("m", states={"off": [], "on": ["b"]}, start="off")
    (step,) = events(m)[0].steps
    assert all(abs(v) <= 0.7 + 1e-9 for v in step.exchanged.values())
    # the rate of what jumps has the jump as its impulse: x.f points out of the storage
    assert step.impulses.get("x.f") == pytest.approx(0.7, abs=1e-12)


@pytest.mark.parametrize("many", [2, 3, 5])
def test_parallel_bonds_share_an_impulse_equally(many: int) -> None:
    m = hb.Model("parallel")
    m.add(a=hb.Zero(), b=hb.Zero(), x=hb.C(1.0, q=0.7))
    m.bond("x -> a", *(f"b{k}: a -> b" for k in range(many)))
    m.machine("m", states={"off": [], "on": ["b"]}, start="off")
    (step,) = events(m)[0].steps
    assert step.exchanged == pytest.approx(
        {f'"b{k}: a -> b".f': 0.7 / many for k in range(many)}, rel=1e-12
    )
    assert step.impulses == pytest.approx({"x.f": 0.7, "b.f": 0.7}, rel=1e-12)


def test_two_ways_share_an_impulse_by_their_lengths() -> None:
    """u^2 + 2 v^2 is least at u = 2/3 where u + v = 1."""
    m = hb.Model("triangle")
    m.add(a=hb.Zero(), b=hb.Zero(), d=hb.Zero(), x=hb.C(1.0, q=0.6))
    m.bond("x -> a", "u: a -> b", "a -> d", "v: d -> b")
    m.machine("m", states={"off": [], "on": ["b"]}, start="off")
    (step,) = events(m)[0].steps
    assert step.exchanged == pytest.approx({'"u: a -> b".f': 0.4, '"v: d -> b".f': 0.2}, rel=1e-12)


def test_open_impulses_have_the_size_of_the_jump() -> None:
    m = hb.Model("ring")
    m.add(**{f"j{k}": hb.Zero() for k in (0, 2, 3, 4, 5)}, j1=hb.One(), c0=hb.C(1.0, q=0.725))
    m.bond("c0 -> j3", "j2 -> j5", "j4 -> j3", "j2 -> j1", "j3 -> j2", "j4 -> j0", "j1 -> j0")
    m.machine("m", states={"s0": [], "s1": ["j5"]}, start="s0")
    (step,) = events(m)[0].steps
    # j5 is OFF and takes all; the bonds of the ring share what is left to them
    assert step.impulses == pytest.approx({"c0.f": 0.725, "j5.f": 0.725, "j1.f": -0.145}, rel=1e-12)


# -- guards ----------------------------------------------------------------------------------------


def beside_a_blocked_coil(guard: str) -> hb.Model:
    """Return a coil at a junction that is OFF, and a node n whose effort is open there."""
    m = hb.Model("cut")
    m.add(n=hb.Zero(), j=hb.One(), i=hb.I(1.0, p=-0.376))
    m.bond("i -> j", "n -> j")
    rules = [f"off -> on when {guard}"]
    m.machine("m", states={"on": ["j"], "off": []}, start="off", rules=rules)
    return m


def test_a_guard_on_an_open_impulse_is_refused() -> None:
    with pytest.raises(hb.HybondError, match=r"HB-J102.*reads n\.e"):
        hb.simulate(beside_a_blocked_coil("n.e < -0.224"), until=1.0)


def test_a_guard_on_an_open_impulse_is_decided_where_the_model_asks() -> None:
    """The net effort that j blocks is least, i.e. zero, where n takes all of the coil's impulse."""
    m = beside_a_blocked_coil("n.e < -0.224")
    m.indeterminate = "least leakage"
    run = hb.simulate(m, until=1.0)
    assert any("reads n.e" in w for w in run.warnings)
    assert run.trace.events[0].steps[0].impulses["n.e"] == pytest.approx(-0.376, rel=1e-12)
    assert run.mode["m"] == "on"


def test_a_guard_on_a_given_impulse_beside_an_open_one_is_decided() -> None:
    assert hb.simulate(beside_a_blocked_coil("i.e > 0.2"), until=1.0).mode["m"] == "on"
    assert hb.simulate(beside_a_blocked_coil("i.e < 0"), until=1.0).mode["m"] == "off"


def test_a_guard_on_an_open_prior_value_is_refused() -> None:
    m = hb.Model("before")
    m.add(j1=hb.Zero(), j3=hb.One(), c=hb.C(1.0, q=1.0), n=hb.Zero(), r=hb.R(1.0))
    m.bond("j1 -> j3", "n -> c", "n -> r")
    m.machine("a", states={"off": [], "on": ["j1"]}, start="off")
    rule = "on -> off when c.q < 0.5 and pre(j3.f) < 0.1"
    m.machine("m", states={"off": [], "on": ["j3"]}, start="on", rules=[rule])
    with pytest.raises(hb.HybondError, match=r"HB-J102.*reads pre\(j3.f\), .* before this instant"):
        hb.simulate(m, until=2.0)


def test_rounding_of_a_share_fires_no_rule() -> None:
    m = hb.Model("net")
    m.indeterminate = "least leakage"
    m.add(**{f"j{k}": hb.Zero() for k in (0, 2, 3, 4)}, j1=hb.One(), t0=hb.GY(1.0))
    m.add(t2=hb.GY(1.877), c0=hb.C(1.0, q=0.817), s5=hb.Sf(-1.179))
    m.bond("s5 -> j3", "t0.1 -> j0", "t2.2 -> j3", "j0 -> j2", "j3 -> c0", "j2 -> j4")
    m.bond("t2.1 -> j1", "t0.2 -> j1", "j3 -> j0")
    m.machine("m0", states={"s0": ["j0"], "s1": []}, start="s1")
    rule = "s0 -> s1 when pre(c0.q) > -0.223"
    m.machine("m1", states={"s0": [], "s1": ["j1", "j2"]}, start="s0", rules=[rule])
    m.machine("m2", states={"s0": ["j3"]}, start="s0")
    rule = "s0 -> s1 when j4.f > 0.0"
    m.machine("m3", states={"s0": [], "s1": ["j4"]}, start="s0", rules=[rule])
    assert hb.simulate(m, until=1.0).mode["m3"] == "s0"


def test_a_sum_that_is_zero_by_the_junction_is_not_open() -> None:
    m = hb.Model("sum")
    m.add(j=hb.One(), k=hb.One(), t=hb.GY(0.51), a=hb.C(1.0, q=-0.614), b=hb.C(1.0, q=-0.605))
    m.bond("b -> k", "k -> j", "t.1 -> j", "t.2 -> a", "k -> j")
    m.machine("m", states={"off": [], "on": ["j"]}, start="on", rules=["on -> off when j.e > 0.0"])
    assert hb.simulate(m, until=1.0).status == "ok"


def test_a_net_flow_that_two_gyrators_decide_is_not_open() -> None:
    """j1 is ON and its other flows are given: the rounding of what is open around it is zero."""
    m = hb.Model("net")
    m.add(j0=hb.One(), j1=hb.Zero(), j3=hb.One(), j4=hb.Zero(), t0=hb.GY(1.0), t2=hb.GY(1.0))
    m.add(c2=hb.C(1.0, q=-0.309), s4=hb.Sf(-1.105))
    m.bond("j3 -> c2", "j3 -> t2.2", "s4 -> j4", "j0 -> t0.1", "j1 -> t0.2", "j4 -> j1")
    m.bond("t2.1 -> j1")
    rules = ["s1 -> s2 when j1.f < 0.0"]
    m.machine("m0", states={"s1": ["j1"], "s2": ["j0", "j1"]}, start="s1", rules=rules)
    m.machine("m2", states={"s0": ["j4"], "s1": []}, start="s1")
    assert hb.simulate(m, until=1.0).mode["m0"] == "s1"


@pytest.mark.parametrize("size", [1e-12, 1.0, 1e9])
def test_a_sum_of_open_impulses_that_is_given_is_decided_at_any_size(size: float) -> None:
    """Two closed switches in parallel discharge a capacitor: each share is open, the sum is not."""

    def parallel(guard: str) -> hb.Model:
        m = hb.Model("parallel")
        m.add(a=hb.Zero(), b=hb.Zero(), s1=hb.One(), s2=hb.One(), x=hb.C(1.0, q=size))
        m.bond("x -> a", "a -> s1 -> b", "a -> s2 -> b")
        m.machine(
            "m", states={"off": [], "on": ["b"]}, start="off", rules=[f"off -> on when {guard}"]
        )
        return m

    assert hb.simulate(parallel("s1.f + s2.f > 0"), until=1.0).mode["m"] == "on"
    assert hb.simulate(parallel("s1.f + s2.f < 0"), until=1.0).mode["m"] == "off"
    with pytest.raises(hb.HybondError, match=r"HB-J102.*reads s1\.f"):
        hb.simulate(parallel("s1.f > 0"), until=1.0)


ONE_WAY = {
    "flow": ({"e": "if f > 0 then 1.2*f else 0"}, "0"),
    "limits": ({"e": "max(0, 0.7*f)"}, "0"),
    "effort": ({"f": "if e > 0 then 0.5*e else 0"}, "1"),
    "table": ({"e": {"table": [[-1.0, 0.0, 1.0], [0.0, 0.0, 2.0]], "extrapolate": "linear"}}, "0"),
}


@pytest.mark.parametrize("flow", [-0.4, 0.4])
@pytest.mark.parametrize(("law", "kind"), ONE_WAY.values(), ids=ONE_WAY)
def test_a_valve_that_nothing_drives_is_shut_and_holds(law: object, kind: str, flow: float) -> None:
    """What it lets through is open up to where it begins to give: it ends there, not beyond."""
    m = hb.Model("valve")
    junction, free = (hb.Zero, hb.I) if kind == "0" else (hb.One, hb.C)
    source = (hb.Se if kind == "0" else hb.Sf)("0.6*sin(1.9*time)")
    start = {"p": flow} if kind == "0" else {"q": flow}
    m.add(j=junction(), d=hb.R(law), s=source, a=free(1.0, **start), b=free(0.8))
    # what the source holds from the start on is emptied there
    m.add(h=hb.C(0.79, q=0.544) if kind == "0" else hb.I(0.79, p=0.544), n=junction())
    m.bond("s -> j", "j -> d", "j -> a", "j -> b", "j -> n -> h")
    run = hb.simulate(m, until=1.5)
    assert run.status == "ok" and run.audit().holds()
    letter = "f" if kind == "0" else "e"
    assert run[f"d.{letter}"].at(0.0) <= 1e-12


PIECES = {"table": [[-2.6, -1.3, 0.0, 1.3, 3.9], [-2.667, -0.889, 0.0, 0.889, 1.3335]]}
BENT = [
    PIECES | {"extrapolate": "linear"},
    "0.7*sinh(q/0.9)",
    "0.6*((q/0.5) + (q/0.5)^3)",
    "if q > 0 then 2*q else 0.5*q",
]


@pytest.mark.parametrize("law", BENT, ids=["table", "sinh", "cubic", "corner"])
def test_what_least_leakage_leaves_is_zero_and_not_rounding_of_what_it_takes(law: object) -> None:
    """What stands open beside a spring that nothing moves is zero, bit for bit; steps stay long."""
    m = hb.Model("beside")
    closed = {"law": "unilateral", "restitution": 0.0}
    m.add(j0=hb.One(**closed), j1=hb.Zero(), j2=hb.One(), j3=hb.Zero(**closed), j4=hb.One())
    m.add(t1=hb.GY(-1.84), t3=hb.GY(1.21), g0=hb.G(1.19), g2=hb.G(0.82), spring=hb.C({"e": law}))
    mass = {"f": PIECES | {"extrapolate": "linear"}}
    m.add(mass=hb.I(mass, p=-0.231))
    m.bond("t1.2 -> j1", "j0 -> g0", "j3 -> j4", "g2 -> j3", "j1 -> spring", "j0 -> t1.1")
    m.bond("t3.1 -> j1", "j4 -> mass", "j1 -> j2", "t3.2 -> j3")
    run = hb.simulate(m, 1.5, max_steps=500)
    assert run.status == "ok" and run.stats["evaluations"] < 1000
    for t in (0.0, 0.3, 0.7, 1.4):
        for name in ("g0.e", "g0.f", "spring.e", "spring.f", "t1.1.e", "t1.2.f"):
            assert run[name].at(t, side="right") == 0.0
    # p' = -p/(1.3/0.889)/0.82 along the middle pieces of the mass's law
    rate = 0.889 / 1.3 / 0.82
    assert run["mass.p"].at(1.0) == pytest.approx(-0.231 * math.exp(-rate), rel=1e-6)


@pytest.mark.parametrize("law", ["8.47*max(-1, min(1, f/1.55))", "2*f*abs(f)", "3*tanh(f)"])
@pytest.mark.parametrize("turned", [False, True])
def test_what_is_left_of_a_blocked_effort_does_not_open_a_diode(law: str, turned: bool) -> None:
    """A diode beside friction that holds all there is: its effort is the rounding of what is taken.

    Its own value is all that it was measured by, and it seemed to conduct (HB-N411).
    """
    m = hb.Model("held twice")
    m.add(a=hb.Zero(law="relay", limit=0.105), b=hb.One(law="coulomb", limit=1.07), end=hb.One())
    m.add(d=hb.One(law="diode"), f=hb.One(law="coulomb", limit=0.143), r=hb.R({"e": law}))
    m.add(u=hb.One(law="unilateral"), t=hb.TF(-1.74), lever=hb.TF(-1.09), gy=hb.GY(-3.93))
    m.add(c=hb.C(2.1, q=-0.0351), s=hb.Se("-0.42*sin(25.3*time)"))
    m.bond("a -> c", "gy.1 -> a", "a -> lever.1", "lever.2 -> end", "t.1 -> f", "u -> t.2")
    m.bond("u -> s", "f -> b", "b -> gy.2", "b -> d", "b -> r" if turned else "r -> b")
    run = hb.simulate(m, until=0.592)
    assert run.status == "ok" and run.audit().holds()
    for t in (0.0, 0.06, 0.18, 0.3, 0.592):
        assert abs(run["d.e"].at(t)) < 1e-12
        assert run["d.f"].at(t) == 0.0 and run["r.f"].at(t) == 0.0
