"""Rests that were taken where something goes on, and springs that are not as long as they are."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import hybond as hb
from hybond.analysis.linear import equilibrium
from hybond.errors import NumericsError


def arm(start: float, torque: float, *, speed: float = 0.0, turned: bool = False) -> hb.Model:
    """Return an arm on whose end, along x, a spring pulls that is slack at the start."""
    m = hb.Model("arm", domain="rotational", parameters={"r": 0.2, "k": 300.0})
    parts = {
        "w": hb.One(),
        "J": hb.I(0.05, f=speed),
        "b": hb.R(0.3),
        "T": hb.Se(torque),
        "x": hb.TF("-r*sin(th)"),
        "v": hb.One(domain="translational"),
        "spring": hb.C("1/k", domain="translational"),
    }
    m.add(**dict(reversed(parts.items()) if turned else parts.items()))
    m.signal(th=hb.Integral("w.f", start=start))
    m.bond("T -> w -> J", "w -> b")
    if turned:
        m.bond("v -> x.2", "x.1 -> w", "spring -> v")
    else:
        m.bond("w -> x -> v -> spring")
    return m


def torque_of_spring(angle: float, start: float) -> float:
    return float(-300.0 * 0.2 * (np.cos(angle) - np.cos(start)) * -0.2 * np.sin(angle))


@pytest.mark.sampled(1)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("start", "torque", "end"), [(1.1, 0.4, 1.3), (1.1, -0.9, 0.95), (2.0, 1.5, 2.3), (-1.2, 1, -1)]
)
def test_spring_on_an_arm_is_as_long_as_the_angle_says(
    start: float, torque: float, end: float, turned: bool
) -> None:
    rest = brentq(lambda a: torque + torque_of_spring(a, start), start, end, xtol=1e-15)
    for speed in (0.0, 3.0):
        m = arm(start, torque, speed=speed, turned=turned)
        lin = hb.linearise(m, inputs=["T"], outputs=["th"], at="equilibrium")
        assert lin.operating["th"] == pytest.approx(rest, abs=1e-9)
        way = -1.0 if turned else 1.0
        length = 0.2 * (np.cos(rest) - np.cos(start))
        assert way * lin.operating["spring.q"] == pytest.approx(length, abs=1e-9)
        h = 1e-5
        stiff = -(torque_of_spring(rest + h, start) - torque_of_spring(rest - h, start)) / (2 * h)
        found = np.sort_complex(lin.poles()[np.abs(lin.poles()) > 1e-6])
        assert found == pytest.approx(np.sort_complex(np.roots([0.05, 0.3, stiff])), rel=1e-6)


@pytest.mark.slow
def test_two_springs_on_a_crank_with_a_piston() -> None:
    m = hb.Model("crank", domain="rotational", parameters={"r": 0.2})
    m.add(w=hb.One(), J=hb.I(0.05), b=hb.R(0.03), T=hb.Se(0.4))
    m.add(x=hb.TF("-r*sin(th)"), y=hb.TF("r*cos(th)"))
    m.add(vx=hb.One(domain="translational"), vy=hb.One(domain="translational"))
    m.add(piston=hb.I(1.3, domain="translational"), d=hb.R(0.9, domain="translational"))
    m.add(sx=hb.C(1 / 50, domain="translational"))
    m.add(sy=hb.C(1 / 20, q=0.05, domain="translational"))
    m.signal(th=hb.Integral("w.f", start=1.1))
    m.bond("T -> w -> J", "w -> b", "w -> x -> vx", "w -> y -> vy")
    m.bond("vx -> piston", "vx -> sx", "vx -> d", "sy -> vy")

    def torque(a: float) -> float:
        along = 0.2 * (np.cos(a) - np.cos(1.1))
        up = 0.2 * (np.sin(a) - np.sin(1.1)) - 0.05
        return float(0.4 + 0.2 * np.sin(a) * 50 * along - 0.2 * np.cos(a) * 20 * up)

    rest = brentq(torque, 1.1, 2.0, xtol=1e-15)
    lin = hb.linearise(m, inputs=["T"], outputs=["th"], at="equilibrium")
    assert lin.operating["th"] == pytest.approx(rest, abs=1e-9)
    inertia = 0.05 + 1.3 * (0.2 * np.sin(rest)) ** 2
    friction = 0.03 + 0.9 * (0.2 * np.sin(rest)) ** 2
    stiff = -(torque(rest + 1e-5) - torque(rest - 1e-5)) / 2e-5
    s = 0.3 + 2.0j
    want = 1.0 / (inertia * s**2 + friction * s + stiff)
    assert np.ravel(lin.transfer(s))[0] == pytest.approx(want, rel=1e-6)


@pytest.mark.parametrize("turned", [False, True])
def test_a_rotor_without_current_at_the_start_feels_no_angle_yet(turned: bool) -> None:
    m = hb.Model("rotor", domain="electrical", parameters={"k": 0.2})
    parts = {
        "Va": hb.Se(3.0), "Vb": hb.Se(-1.0), "a": hb.One(), "b": hb.One(),
        "La": hb.I(0.01), "Lb": hb.I(0.01), "Ra": hb.R(0.5), "Rb": hb.R(0.5),
        "ga": hb.GY("-k*sin(th)"), "gb": hb.GY("k*cos(th)"), "w": hb.One(domain="rotational"),
        "J": hb.I(0.002, domain="rotational"), "d": hb.R(0.01, domain="rotational"),
    }  # fmt: skip
    m.add(**dict(reversed(parts.items()) if turned else parts.items()))
    m.signal(th=hb.Integral("w.f", start=0.7))
    m.bond("Va -> a -> La", "a -> Ra", "Vb -> b -> Lb", "b -> Rb")
    m.bond("a -> ga -> w", "b -> gb -> w", "w -> J", "w -> d")
    lin = hb.linearise(m, inputs=["Va"], outputs=["th"], at="equilibrium")
    # 6 A and -2 A; the torque -6 sin th - 2 cos th is zero and turns back
    assert lin.operating["th"] == pytest.approx(np.arctan2(-2.0, 6.0), abs=1e-9)
    assert (lin.poles().real < 0.0).all()


def pulled(force: str) -> hb.Model:
    m = hb.Model("pulled", domain="translational")
    m.add(F=hb.Se(force), v=hb.One(), M=hb.I(2.0, f=1.0), b=hb.R(2.0))
    m.bond("F -> v -> M", "v -> b")
    m.signal(x=hb.Integral("v.f", start=1.0))
    return m


@pytest.mark.parametrize("force", ["2 - 5*(x-1)^3", "if x > 3 then 2 - 50*(x-3) else 2"])
def test_a_spring_that_is_slack_is_no_rest_of_a_body_that_goes_on(force: str) -> None:
    """At 1 m/s forces balance, and the body goes on to where the spring holds it."""
    with pytest.raises(NumericsError) as refused:
        hb.linearise(pulled(force), inputs=["F"], outputs=["v.f"], at="equilibrium")
    assert refused.value.code == "HB-A510"


def test_a_rest_is_found_where_a_spring_begins_slack() -> None:
    m = hb.Model("pulled", domain="translational")
    m.add(F=hb.Se("2 - 5*(x-1)^3"), v=hb.One(), M=hb.I(2.0), b=hb.R(2.0))
    m.bond("F -> v -> M", "v -> b")
    m.signal(x=hb.Integral("v.f", start=1.3))
    lin = hb.linearise(m, inputs=["F"], outputs=["x"], at="equilibrium")
    assert lin.operating["x"] == pytest.approx(1.0 + 0.4 ** (1 / 3), rel=1e-9)


def test_what_a_guard_waits_for_does_not_go_on_at_a_rest() -> None:
    m = pulled("20")
    m.add(z=hb.Zero(), extra=hb.R(1.0))
    m.bond("v -> z -> extra")
    m.machine("S", states={"go": [], "stop": ["z"]}, start="go", rules=["go -> stop when x >= 7"])
    with pytest.raises(NumericsError, match="S reads it: x >= 7"):
        hb.linearise(m, inputs=["F"], outputs=["v.f"], at="equilibrium")
    ball = hb.Model("ball", domain="translational")
    ball.add(F=hb.Se(-20.0), v=hb.One(), M=hb.I(2.0), b=hb.R(4.0))
    ball.add(floor=hb.Zero(law="unilateral", gap="h", restitution=0.5))
    ball.bond("F -> v -> M", "floor -> v", "v -> b")
    ball.signal(h=hb.Integral("v.f", start=1.0))
    with pytest.raises(NumericsError, match="floor reads it"):
        hb.linearise(ball, inputs=["F"], outputs=["v.f"], at="equilibrium")


def test_the_angle_of_a_motor_may_go_on() -> None:
    lin = hb.linearise(pulled("20"), inputs=["F"], outputs=["v.f"], at="equilibrium")
    assert lin.operating["v.f"] == pytest.approx(10.0)
    assert lin.notes == ("x goes on at 10 a second; nothing reads it",)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("speed", [0.0, 1e-20, 1e-30, 1e-37, 1e-60, 1e-100, 1e-300])
@pytest.mark.parametrize("turned", [False, True])
def test_a_speed_that_has_died_out_is_no_constraint(speed: float, turned: bool) -> None:
    m = arm(1.1, 0.4, turned=turned)
    at = {"J.p": speed, "spring.q": 3.6e-5 if turned else -3.6e-5}
    lin = hb.linearise(m, inputs=["T"], outputs=["th"], at=at)
    # torque r sin(th) k q of a spring that is stretched by -r sin(th) dth
    stiff = (0.2 * np.sin(1.1)) ** 2 * 300 + 0.2 * np.cos(1.1) * 300 * 3.6e-5
    s = 2.0j
    want = 1.0 / (0.05 * s**2 + 0.3 * s + stiff)
    assert np.ravel(lin.transfer(s))[0] == pytest.approx(want, rel=1e-9)


def test_an_arm_whose_inertia_is_joined_to_another_one() -> None:
    """Of two inertias that turn as one either may be the state."""
    m = hb.Model("joined", domain="rotational", parameters={"r": 0.2})
    m.add(T=hb.Se(0.4), w=hb.One(), J=hb.I(0.05), b=hb.R(0.3), c=hb.Zero(), w2=hb.One())
    m.add(J2=hb.I(0.1), x=hb.TF("-r*sin(th)"), v=hb.One(domain="translational"))
    m.add(k=hb.C(1 / 300, domain="translational"))
    m.signal(th=hb.Integral("w2.f", start=1.1))
    m.bond("T -> w -> J", "w -> b", "w -> c -> w2", "w2 -> J2", "w2 -> x -> v -> k")
    rules = ["closed -> open when c.e > 100"]
    m.machine("S", states={"open": [], "closed": ["c"]}, start="closed", rules=rules)
    rest = brentq(lambda a: 0.4 + torque_of_spring(a, 1.1), 1.1, 1.3, xtol=1e-15)
    lin = hb.linearise(m, inputs=["T"], outputs=["th"], at="equilibrium")
    assert lin.operating["th"] == pytest.approx(rest, abs=1e-9)


@pytest.mark.slow
def test_two_arms_on_one_spring() -> None:
    m = hb.Model("two", domain="rotational", parameters={"r": 0.3})
    m.add(w1=hb.One(), J1=hb.I(0.1), b1=hb.R(0.2), T1=hb.Se(0.7), k1=hb.C(1 / 3))
    m.add(w2=hb.One(), J2=hb.I(0.2), b2=hb.R(0.2), T2=hb.Se(-0.5), k2=hb.C(1 / 4))
    m.add(x1=hb.TF("r*cos(a1)"), x2=hb.TF("r*cos(a2)"), z=hb.Zero(domain="translational"))
    m.add(s=hb.C(1 / 80, domain="translational"))
    m.signal(a1=hb.Integral("w1.f", start=0.4), a2=hb.Integral("w2.f", start=-0.3))
    m.bond("T1 -> w1 -> J1", "w1 -> b1", "w1 -> k1", "w1 -> x1 -> z -> s")
    m.bond("T2 -> w2 -> J2", "w2 -> b2", "w2 -> k2", "w2 -> x2 -> z")
    lin = hb.linearise(m, inputs=["T1"], outputs=["a1", "a2"], at="equilibrium")
    a, b = lin.operating["a1"], lin.operating["a2"]
    force = 80 * 0.3 * (np.sin(a) - np.sin(0.4) + np.sin(b) - np.sin(-0.3))
    assert 0.7 - 0.3 * np.cos(a) * force - 3 * (a - 0.4) == pytest.approx(0.0, abs=1e-8)
    assert -0.5 - 0.3 * np.cos(b) * force - 4 * (b + 0.3) == pytest.approx(0.0, abs=1e-8)


def between_stops(left: str, right: str, *, moved: float = 0.0) -> hb.Model:
    """Return a rotor with a torque between two stops, neither of which acts at the start."""
    m = hb.Model("stops", domain="rotational", parameters={"k": 100.0})
    m.add(w=hb.One(), J=hb.I(1.0), b=hb.R(1.0), T=hb.Se(1.0))
    m.add(s1=hb.Se(f"{'-' if left == 's1 -> w' else ''}k*max(0, phi - 1)"))
    m.add(s2=hb.Se(f"{'-' if right == 'w -> s2' else ''}k*max(0, -phi - 1)"))
    m.signal(phi=hb.Integral("w.f", start=moved))
    m.bond("T -> w -> J", "w -> b", left, right)
    return m


@pytest.mark.parametrize("left", ["s1 -> w", "w -> s1"])
@pytest.mark.parametrize("right", ["w -> s2", "s2 -> w"])
def test_two_stops_that_do_not_act_yet_do_not_cancel(left: str, right: str) -> None:
    m = between_stops(left, right)
    with pytest.raises(NumericsError) as refused:
        hb.linearise(m, inputs=["T"], outputs=["phi"], at="equilibrium")
    assert refused.value.code == "HB-A510"
    # the torque of 1 N m presses the stop by 1/k
    near = between_stops(left, right, moved=1.2)
    lin = hb.linearise(near, inputs=["T"], outputs=["phi"], at="equilibrium")
    assert lin.operating["phi"] == pytest.approx(1.01, rel=1e-9)


def motor(*rules: str, torque: float = 1.0) -> hb.Model:
    m = hb.Model("motor", domain="rotational")
    m.add(T=hb.Se(torque), w=hb.One(), J=hb.I(1.0), b=hb.R(1.0), z=hb.Zero(), brake=hb.R(5.0))
    m.bond("T -> w -> J", "w -> b", "w -> z -> brake")
    m.signal(phi=hb.Integral("w.f"))
    m.machine("S", states={"on": [], "off": ["z"]}, start="on", rules=list(rules))
    return m


WAITS = "no law reads it, and S waits for what it does not lead to"


@pytest.mark.parametrize(
    ("rule", "torque", "said"),
    [
        ("on -> off when phi < -5", 1.0, WAITS),
        ("on -> off when phi > 5", -1.0, WAITS),
        ("on -> off when not (phi > -5)", 1.0, WAITS),
        ("on -> off when phi > 100 and w.f < 0", 1.0, WAITS),
        ("on -> off when w.f < 0 or -2*phi > 3", 1.0, WAITS),
        ("off -> on when phi > 5", 1.0, "no law and no rule that leaves this mode reads it"),
        ("off -> on when w.f > 5", 1.0, "nothing reads it"),
    ],
)
def test_a_guard_that_the_angle_is_led_away_from_is_no_reason(
    rule: str, torque: float, said: str
) -> None:
    m = motor(rule, torque=torque)
    lin = hb.linearise(m, inputs=["T"], outputs=["w.f"], at="equilibrium")
    assert lin.operating["w.f"] == pytest.approx(torque)
    (note,) = lin.notes
    assert note.startswith(f"phi goes on at {torque:g} a second; {said}")


@pytest.mark.parametrize(
    ("rule", "torque"),
    [
        ("on -> off when phi > 100", 1.0),
        ("on -> off when phi < -5", -1.0),
        ("on -> off when not (phi < 5)", 1.0),
        ("on -> off when phi > 100 and w.f > 0", 1.0),
        ("on -> off when w.f < 0 or -2*phi < -3", 1.0),
        ("on -> off when sin(phi) < -0.5", 1.0),
        ("on -> off when mod(phi + 1, 6) < 0.5", 1.0),
        ("on -> off when phi > 3 and time > 100", 1.0),
    ],
)
def test_a_guard_that_the_angle_comes_to_is_a_reason(rule: str, torque: float) -> None:
    with pytest.raises(NumericsError, match=r"phi goes on changing, .* and S reads it"):
        hb.linearise(motor(rule, torque=torque), inputs=["T"], outputs=["w.f"], at="equilibrium")


@pytest.mark.slow
@pytest.mark.parametrize(("start", "torque"), [(1.45, -5.11), (2.78, 2.26)])
def test_a_rest_behind_a_dead_centre_is_refused_in_seconds(
    start: float, torque: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    points = 0
    valued = equilibrium.valued

    def counted(*given: Any) -> Any:
        nonlocal points
        points += 1
        return valued(*given)

    monkeypatch.setattr(equilibrium, "valued", counted)
    with pytest.raises(NumericsError) as refused:
        hb.linearise(arm(start, torque), inputs=["T"], outputs=["th"], at="equilibrium")
    assert refused.value.code == "HB-A510"
    assert 0 < points <= equilibrium.WHOLE
