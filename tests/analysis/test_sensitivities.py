"""Derivatives of runs through their switches, against closed forms and equations of their own."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import hybond as hb

TINY = 1e-30
"""A step in the imaginary direction: derivatives of closed forms to the last digit."""


def ball(**more: object) -> hb.Model:
    values = {"eps": 0.8, "g": "9.81 m/s^2", "m": "2 kg", "h0": "1 m", **more}
    m = hb.Model("ball", domain="translational", parameters=values)
    m.add(weight=hb.Se("-m*g"), ball=hb.I("m"), v=hb.One())
    m.add(floor=hb.Zero(law="unilateral", gap="height", restitution="eps"))
    m.bond("weight -> v -> ball", "floor -> v")
    m.signal(height=hb.Integral("v.f", start="h0"))
    return m


def test_the_nth_impact_of_a_ball_by_restitution_gravity_and_height() -> None:
    wrt = ["eps", "g", "h0", "m"]
    s = hb.sensitivities(ball(), "2.3 s", wrt=wrt, of=["v.f"])
    assert s.ends is None and len(s.events) == 4
    eps, g, h = 0.8, 9.81, 1.0
    first = np.sqrt(2 * h / g)
    for n, event in enumerate(s.events):
        k = np.arange(1, n + 1)
        total = 1 + 2 * (eps**k).sum()
        assert event.t == pytest.approx(first * total, rel=1e-12)
        by = [first * 2 * (k * eps ** (k - 1)).sum(), -event.t / (2 * g), event.t / (2 * h), 0.0]
        assert event.by == pytest.approx(by, rel=1e-8, abs=1e-12)
        # the velocity behind impact n + 1, seen a moment later: v - g (t - tau)
        v = eps ** (n + 1) * np.sqrt(2 * g * h)
        after = s["v.f"][np.searchsorted(s.t, event.t, side="right") - 1]
        own = np.array([v * (n + 1) / eps, v / (2 * g), v / (2 * h), 0.0]) + g * np.array(by)
        assert after == pytest.approx(own, rel=1e-8, abs=1e-11)


def test_a_start_and_the_value_of_an_element_are_varied_as_a_parameter_is() -> None:
    m = ball()
    s = hb.sensitivities(m, "1 s", wrt=["height.start", "h0", "ball.I", "ball.p0"], of=["height"])
    by = s["height"][-1]
    # by the mass alone the weight stays what it is: g = F/m
    g, T, eps, t = 9.81, np.sqrt(2 / 9.81), 0.8, 1.0
    rebound = eps * g * T * (t - T) - g * (t - T) ** 2 / 2

    def height(h: complex, g: complex) -> complex:
        T = np.sqrt(2 * h / g)
        return eps * g * T * (t - T) - g * (t - T) ** 2 / 2

    assert s.y[-1, 0] == pytest.approx(rebound, rel=1e-10)
    by_h = height(1.0 + 1j * TINY, g).imag / TINY
    by_g = height(1.0, g + 1j * TINY).imag / TINY
    # the start is written as h0: it follows what it is made of
    assert by[:2] == pytest.approx([by_h, by_h], rel=1e-9)
    assert by[2] == pytest.approx(-g / 2 * by_g, rel=1e-9)


def test_extinction_of_a_half_wave_rectifier_by_inductance_and_resistance() -> None:
    m = hb.Model("rectifier", domain="electrical", parameters={"R": "2 ohm", "L": "10 mH"})
    m.add(V=hb.Se("10 V*sin(314*time/(1 s))"), d=hb.One(law="diode"), r=hb.R("R"), l=hb.I("L"))
    m.bond("V -> d -> l", "d -> r")
    s = hb.sensitivities(m, "18 ms", wrt=["R", "L"], of=["l.f"])
    w = 314.0

    def current(t: complex, R: complex, L: complex) -> complex:
        z2 = R * R + (w * L) ** 2
        wave = R * np.sin(w * t) - w * L * np.cos(w * t)
        return 10 / z2 * (wave + w * L * np.exp(-R * t / L))

    end = brentq(lambda t: current(t, 2.0, 0.01).real, 0.011, 0.0199, xtol=1e-15)
    slope = current(end + 1j * TINY, 2.0, 0.01).imag / TINY
    by = [
        current(end, 2.0 + 1j * TINY, 0.01).imag / TINY,
        current(end, 2.0, 0.01 + 1j * TINY).imag / TINY,
    ]
    event = s.events[-1]
    assert event.t == pytest.approx(end, rel=1e-10)
    assert event.by == pytest.approx(-np.array(by) / slope, rel=1e-8)
    assert s["l.f"][-1] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_two_masses_become_one() -> None:
    m = hb.load("examples/bullet_and_wood.toml")
    wrt = ["m1", "m2", "bullet.f", "wood.f", "x1.start"]
    s = hb.sensitivities(m, "0.5 s", wrt=wrt, of=["v2.f", "x2"])

    def joined(m1: complex, m2: complex, u: complex, w: complex, x: complex) -> list[complex]:
        tau = -x / (u - w)
        v = (m1 * u + m2 * w) / (m1 + m2)
        return [v, w * tau + v * (0.5 - tau), tau]

    values = np.array([1.0, 1.0, 1.0, 0.0, -0.2], dtype=complex)
    for k, name in enumerate(wrt):
        values[k] += 1j * TINY
        v, x, tau = (np.imag(a) / TINY for a in joined(*values))
        values[k] = values[k].real
        assert s.final("v2.f", name) == pytest.approx(v, rel=1e-9, abs=1e-12)
        assert s.final("x2", name) == pytest.approx(x, rel=1e-9, abs=1e-12)
        assert s.of_event(1, name) == pytest.approx(tau, rel=1e-9, abs=1e-12)


def test_slipping_begins_where_a_growing_force_breaks_friction() -> None:
    m = hb.Model("sledge", domain="translational", parameters={"k": "2 N/s", "mu": "1 N"})
    m.add(F=hb.Se("k*time"), mass=hb.I("1.5 kg"), v=hb.One(), rub=hb.One(law="coulomb", limit="mu"))
    m.bond("F -> v -> mass", "v -> rub")
    s = hb.sensitivities(m, "2 s", wrt=["k", "mu", "mass.I"], of=["v.f"])
    k, mu, mass, T = 2.0, 1.0, 1.5, 2.0
    assert s.events[0].by == pytest.approx([-mu / k**2, 1 / k, 0.0], rel=1e-9, abs=1e-12)
    free = T - mu / k
    own = [free * (free + 2 * mu / k) / (2 * mass), -free / mass, -k * free**2 / (2 * mass**2)]
    assert s["v.f"][-1] == pytest.approx(own, rel=1e-8)


def test_sliding_on_a_relay_is_entered_and_left() -> None:
    m = hb.Model("relay", parameters={"a": 1.0, "b": 0.3})
    m.add(
        u=hb.Sf('(if r.state == "plus" then a else -a) + b*time'), c=hb.C(1.0, q=1.0), n=hb.Zero()
    )
    m.bond("u -> n -> c")
    rules = ["plus -> minus when c.q > 0", "minus -> plus when c.q < 0"]
    m.machine("r", states={"plus": [], "minus": []}, start="minus", rules=rules)
    s = hb.sensitivities(m, "5 s", wrt=["a", "b", "c.q"], of=["c.q"], times=[2.0])
    a, b = 1.0, 0.3
    # in: q0 - a t + b t^2/2 = 0; out: b t = a
    t = (a - np.sqrt(a * a - 2 * b)) / b
    enters = np.array([t, -t * t / 2, -1.0]) / (b * t - a)
    assert s.events[0].by == pytest.approx(enters, rel=1e-9)
    assert s.events[1].by == pytest.approx([1 / b, -a / b**2, 0.0], rel=1e-9, abs=1e-10)
    assert [s.at(2.0, "c.q", name) for name in s.wrt] == pytest.approx([0, 0, 0], abs=1e-12)
    rest = 5.0 - a / b
    own = [-rest, rest**2 / 2 + rest * a / b, 0.0]
    assert s["c.q"][-1] == pytest.approx(own, rel=1e-8, abs=1e-10)


def test_a_converter_by_its_duty() -> None:
    m = hb.Model("chopper", domain="electrical", parameters={"D": 0.4})
    m.input(u=hb.Input(pwm={"period": "1 ms", "duty": "D"}))
    m.add(V=hb.Se("10 V*u"), L=hb.I("1 mH"), R=hb.R("1 ohm"), j=hb.One())
    m.bond("V -> j -> L", "j -> R")
    s = hb.sensitivities(m, "2.7 ms", wrt=["D", "L.I", "R.R"], of=["L.f"])

    def current(D: complex, L: complex, R: complex) -> complex:
        i = 0.0 + 0.0j
        for span, on in ((D, 1), (1 - D, 0), (D, 1), (1 - D, 0), (D, 1), (0.7 - D, 0)):
            i = 10.0 / R * on + (i - 10.0 / R * on) * np.exp(-R * 1e-3 * span / L)
        return i

    at = [0.4, 1e-3, 1.0]
    for k, name in enumerate(s.wrt):
        steps = [complex(v, TINY * (j == k)) for j, v in enumerate(at)]
        assert s.final("L.f", name) == pytest.approx(current(*steps).imag / TINY, rel=1e-8)


def test_a_switch_that_opens_at_a_time_and_the_diode_that_takes_over() -> None:
    m = hb.Model("off", domain="electrical", parameters={"off": "1 ms"})
    m.add(V=hb.Se("10 V"), L=hb.I("1 mH"), R=hb.R("1 ohm"))
    m.add(j=hb.One(), s=hb.One(), n=hb.Zero(), wheel=hb.One(law="diode"))
    m.bond("V -> s -> n -> j -> L", "j -> R", "wheel -> n")
    rules = ["closed -> open when time >= off"]
    m.machine("Sw", states={"closed": ["s"], "open": []}, start="closed", rules=rules)
    s = hb.sensitivities(m, "2.5 ms", wrt=["off"], of=["L.f"])
    # i = 10 (1 - exp(-off)) exp(-(t - off)), in ms: its derivative by `off` is 10 exp(-(t - off))
    assert s.final("L.f", "off") == pytest.approx(10 * np.exp(-1.5) * 1e3, rel=1e-8)
    assert s.of_event(1, "off") == pytest.approx(1.0, rel=1e-12)


def test_the_end_of_a_slide_of_the_falling_rod_by_friction() -> None:
    """Against the rod's own equations, integrated by SciPy with friction in the complex plane."""
    m = hb.load("examples/falling_rod.toml")
    s = hb.sensitivities(m, "0.75 s", wrt=["mu"], of=["w.f", "vAx"], times=[0.7], rtol=1e-11)
    mass, J, l, g, theta = 1.0, 1.3, -1.0, 9.81, 0.85
    fall = np.sqrt(2 * (1.5 + l * np.sin(theta)) / g)
    arm = l * np.cos(theta)
    P = g * fall / (1 / mass + arm**2 / J)  # without friction, up to a standstill of the tip

    def rates(t: float, y: np.ndarray, mu: complex) -> list[complex]:
        turn, w, vx = y
        sine, cosine = np.sin(turn), np.cos(turn)
        way = np.sign((vx - l * w * sine).real)
        # normal force: vy' + l w' cos - l w^2 sin = 0 with m vy' = N - m g
        friction = -way * mu
        lever = l * cosine - friction * l * sine
        N = (g + l * w * w * sine) / (1 / mass + l * cosine * lever / J)
        return [w, lever * N / J, friction * N / mass]

    mu = 0.265 + 1j * TINY
    start = np.array([theta, P * arm / J, 0.0], dtype=complex)
    run = solve_ivp(
        rates, (fall, 0.73), start, "DOP853", args=(mu,), rtol=1e-12, atol=1e-40, dense_output=True
    )

    def slip(t: float) -> complex:
        turn, w, vx = run.sol(t)
        return vx - l * w * np.sin(turn)

    assert s.events[0].t == pytest.approx(fall, rel=1e-9)
    end = s.events[1].t
    assert abs(slip(end)) < 1e-7
    turn, w, _ = run.sol(end)
    _, dw, dvx = rates(end, run.sol(end - 1e-9), mu)
    speed = (dvx - l * dw * np.sin(turn) - l * w * w * np.cos(turn)).real
    assert s.of_event(2, "mu") == pytest.approx(-slip(end).imag / TINY / speed, rel=1e-8)
    assert s.at(0.7, "vAx", "mu") == pytest.approx(slip(0.7).imag / TINY, rel=1e-8)
    assert s.at(0.7, "w.f", "mu") == pytest.approx(run.sol(0.7)[1].imag / TINY, rel=1e-8)


def test_a_law_that_jumps_within_a_motion() -> None:
    """A force that triples where a place is passed, no event of the table: x'' = a, then 3 a."""
    m = hb.Model("jump", parameters={"a": 1.0, "x1": 0.5})
    m.add(F=hb.Se("if x > x1 then 3*a else a"), ball=hb.I(1.0), v=hb.One())
    m.bond("F -> v -> ball")
    m.signal(x=hb.Integral("v.f"))
    s = hb.sensitivities(m, "2 s", wrt=["a", "x1"], of=["v.f", "x"])

    def end(a: complex, x1: complex) -> tuple[complex, complex]:
        tau = np.sqrt(2 * x1 / a)
        rest = 2.0 - tau
        return a * tau + 3 * a * rest, x1 + a * tau * rest + 3 * a * rest**2 / 2

    for name, steps in (("a", (1 + 1j * TINY, 0.5)), ("x1", (1.0, 0.5 + 1j * TINY))):
        v, x = end(*steps)
        assert s.final("v.f", name) == pytest.approx(np.imag(v) / TINY, rel=1e-8)
        assert s.final("x", name) == pytest.approx(np.imag(x) / TINY, rel=1e-8)


@pytest.mark.parametrize("arrow", ["n -> B", "B -> n"])
def test_a_coil_that_empties_through_a_power_by_its_coefficient(arrow: str) -> None:
    """With ``i = k*v^4`` the current follows ``i^(3/4) = i0^(3/4) - 3/4*t/(L*k^(1/4))``."""
    k, t, sign = 2e-3, 0.004, "" if arrow == "n -> B" else "-"
    m = hb.Model("a coil behind a power", domain="electrical", parameters={"k": k})
    law = f"{sign}k*1[A]*(B.e/1[V])*abs(B.e/1[V])^3"
    m.add(S=hb.I(0.1, f=0.5), B=hb.Sf(law), n=hb.Zero())
    m.bond("n -> S", arrow)
    found = hb.sensitivities(m, t, wrt=["k"], of=["S.f"])
    i = (0.5**0.75 - 0.75 * t / (0.1 * k**0.25)) ** (4 / 3)
    by = i**0.25 * t / 0.1 * 0.25 * k**-1.25
    assert found.ends is None
    assert found["S.f"][-1, 0] == pytest.approx(by, rel=1e-5)


@pytest.mark.parametrize(
    ("start", "law", "of"),
    [
        (90.0, "cos(al)", "TF"),
        (180.0, "sin(al)", "TF"),
        (60.0, "cos(al) - 0.5", "TF"),
        (90.0, "cos(al)", "GY"),
        (90.0, "cos(al)*f", "R"),
        (90.0, "cos(al)*f^3", "R"),
        (180.0, "sin(al)*time", "Se"),
        (0.0, "al", "TF"),
        (0.0, "al*f", "R"),
    ],
)
def test_derivatives_by_what_makes_a_factor_zero(start: float, law: str, of: str) -> None:
    """At a right angle the factor is exactly zero, and its term was left out: so was its slope."""
    al = math.radians(start)
    m = hb.Model("lever", domain="translational", parameters={"al": al})
    m.add(a=hb.I(1.0, p=1.0), k=hb.C(0.5), v=hb.One(), w=hb.One(), h=hb.C(0.25))
    m.add(b=hb.R({"e": law}) if of == "R" else hb.R("1 [N*s/m]"))
    m.add(t={"TF": hb.TF, "GY": hb.GY}[of](law) if of in ("TF", "GY") else hb.TF(1.0))
    m.add(s=hb.Se(law if of == "Se" else 0.0))
    m.bond("v -> a", "v -> k", "v -> t -> w", "w -> b", "w -> h", "s -> v")
    found = hb.sensitivities(m, 1.0, wrt=["al"], of=["h.q"])

    def ends(value: float) -> float:
        run = hb.simulate(m, 1.0, parameters={"al": value}, rtol=1e-11, atol=1e-14)
        return float(run["h.q"].at(1.0))

    step = 1e-4
    assert found.ends is None
    by_runs = (ends(al + step) - ends(al - step)) / (2.0 * step)
    assert found.final("h.q", "al") == pytest.approx(by_runs, rel=1e-6)
    assert abs(by_runs) > 0.05
