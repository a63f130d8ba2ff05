"""Motions that repeat, and their Floquet multipliers, against closed forms and SciPy."""

import json

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

import hybond as hb

T, D = 20e-6, 0.4
L, C, R, RL, V, N = 100e-6, 10e-6, 10.0, 0.1, 12.0, 0.5


def buck() -> hb.Model:
    m = hb.Model("buck", domain="electrical", parameters={"D": D})
    m.input(u=hb.Input(pwm={"period": "20 us", "duty": "D"}))
    m.add(V=hb.Se("12 V*u"), L=hb.I("100 uH"), rl=hb.R("0.1 ohm"), C=hb.C("10 uF"))
    m.add(r=hb.R("10 ohm"), j=hb.One(), n=hb.Zero())
    m.bond("V -> j -> L", "j -> rl", "j -> n -> C", "n -> r")
    return m


def boost(load: str = "10 ohm") -> hb.Model:
    m = hb.Model("boost", domain="electrical", parameters={"D": D})
    m.input(u=hb.Input(pwm={"period": "20 us", "duty": "D"}))
    m.add(V=hb.Se("12 V"), L=hb.I("100 uH"), rl=hb.R("0.1 ohm"), C=hb.C("10 uF"), r=hb.R(load))
    m.add(j=hb.One(), sw=hb.Zero(), d=hb.One(law="diode"), n=hb.Zero())
    m.bond("V -> j -> L", "j -> rl", "j -> sw -> d -> n -> C", "n -> r")
    rules = ["off -> on when u > 0.5", "on -> off when u < 0.5"]
    m.machine("S", states={"on": [], "off": ["sw"]}, start="off", rules=rules)
    return m


def flyback() -> hb.Model:
    m = hb.Model("flyback", domain="electrical", parameters={"D": D})
    m.input(u=hb.Input(pwm={"period": "20 us", "duty": "D"}))
    m.add(V=hb.Se("12 V"), L=hb.I("100 uH"), C=hb.C("10 uF"), r=hb.R("4 ohm"), t=hb.TF(-1 / N))
    m.add(s=hb.One(), core=hb.Zero(), d=hb.One(law="diode"), n=hb.Zero())
    m.bond("V -> s -> core -> L", "core -> t -> d -> n -> C", "n -> r")
    rules = ["off -> on when u > 0.5", "on -> off when u < 0.5"]
    m.machine("S", states={"on": ["s"], "off": []}, start="off", rules=rules)
    return m


def converters() -> dict[str, tuple[hb.Model, list[np.ndarray]]]:
    """Each with A, b of (flux, charge) while the switch is on, and while it is off."""
    source = np.array([V, 0.0])
    series = np.array([[-RL / L, -1 / C], [1 / L, -1 / (R * C)]])
    apart = np.array([[-RL / L, 0.0], [0.0, -1 / (R * C)]])
    core = np.array([[0.0, 0.0], [0.0, -1 / (4.0 * C)]])
    # N turns per turn: the secondary voltage n.e is -N times that of the core
    back = np.array([[0.0, -1 / (N * C)], [1 / (N * L), -1 / (4.0 * C)]])
    return {
        "buck": (buck(), [series, source, series, 0.0 * source]),
        "boost": (boost(), [apart, source, series, source]),
        "flyback": (flyback(), [core, source, back, 0.0 * source]),
    }


def moved(A: np.ndarray, b: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray]:
    whole = expm(np.block([[A, b[:, None]], [np.zeros((1, len(b) + 1))]]) * t)
    return whole[:-1, :-1], whole[:-1, -1]


def steady(matrices: list[np.ndarray], duty: float) -> tuple[np.ndarray, np.ndarray]:
    on, added = moved(matrices[0], matrices[1], duty * T)
    off, more = moved(matrices[2], matrices[3], (1 - duty) * T)
    M = off @ on
    return M, np.linalg.solve(np.eye(2) - M, off @ added + more)


@pytest.mark.parametrize("name", ["buck", "boost", "flyback"])
def test_converters_settle_in_under_ten_periods_of_work_with_multipliers_of_expm(name: str) -> None:
    model, matrices = converters()[name]
    orbit = hb.periodic(model, wrt=["D"])
    M, x = steady(matrices, D)
    assert orbit.periods < 10 and orbit.stable and not orbit.autonomous and orbit.lost == 0
    assert orbit.period == T and orbit.states == ("L.p", "C.q")
    assert list(orbit.state.stored.values()) == pytest.approx(x, rel=1e-9)
    assert orbit.monodromy == pytest.approx(M, rel=1e-8, abs=1e-9 * np.abs(M).max())
    own = np.linalg.eigvals(M)
    own = own[np.argsort(-own.imag)]
    assert orbit.values == pytest.approx(own, rel=1e-8)
    # the derivative of the steady state by the duty, from closed forms on both sides
    h = 1e-4
    x1, x2, x3, x4 = (steady(matrices, D + k * h)[1] for k in (1, -1, 2, -2))
    by = (8 * (x1 - x2) - (x3 - x4)) / (12 * h)
    assert orbit.by[:, 0] == pytest.approx(by, rel=1e-7)
    assert orbit.derivative("C.q", "D") == orbit.by[1, 0]


def test_the_current_that_ends_within_the_period_loses_a_direction() -> None:
    load = 300.0
    orbit = hb.periodic(boost("300 ohm"))
    assert orbit.periods < 10 and orbit.lost == 1 and orbit.stable
    assert [orbit.run.graph.mode_names(s.mode)["d"] for s in orbit.run.segments] == [
        "blocks",
        "conducts",
        "blocks",
    ]
    decay = np.array([[-RL / L, 0.0], [0.0, -1 / (load * C)]])
    series = np.array([[-RL / L, -1 / C], [1 / L, -1 / (load * C)]])
    source = np.array([V, 0.0])
    on, added = moved(decay, source, D * T)
    rest = np.linalg.solve(series, -source)
    values, vectors = np.linalg.eig(series)

    def period(q: float) -> float:
        x = np.linalg.solve(vectors, on @ np.array([0.0, q]) + added - rest)

        def left(t: float) -> np.ndarray:
            return rest + (vectors @ (np.exp(values * t) * x)).real

        end = brentq(lambda t: left(t)[0], 1e-7, (1 - D) * T, xtol=1e-22, rtol=1e-15)
        return float(left(end)[1] * np.exp(-((1 - D) * T - end) / (load * C)))

    q = brentq(lambda q: period(q) - q, 28 * C, 40 * C, xtol=1e-18, rtol=1e-14)
    assert orbit.state.stored["C.q"] == pytest.approx(q, rel=1e-9)
    h = 1e-3 * q
    p = [period(q + k * h) for k in (1, -1, 2, -2)]
    slope = (8 * (p[0] - p[1]) - (p[2] - p[3])) / (12 * h)
    assert orbit.values[0] == pytest.approx(slope, abs=1e-9)


def bouncer(amplitude: float = 0.028) -> hb.Model:
    values = {"m": "2 kg", "g": "9.81 m/s^2", "A": f"{amplitude} m", "w": "20 rad/s", "e": 0.8}
    m = hb.Model("bouncer", domain="translational", parameters=values)
    m.add(weight=hb.Se("-m*g"), ball=hb.I("m", f="0.5 m/s"), v=hb.One())
    m.add(table=hb.Sf("A*w*cos(w*time)"))
    m.add(floor=hb.Zero(law="unilateral", gap="h - A*sin(w*time)", restitution="e"))
    m.bond("weight -> v -> ball", "table -> floor -> v")
    m.signal(h=hb.Integral("v.f", start="0.1 m"))
    return m


def test_the_ball_that_bounces_once_a_period_on_a_shaker() -> None:
    e, g, w, A = 0.8, 9.81, 20.0, 0.028
    orbit = hb.periodic(bouncer())
    # takes off as it lands, upside down: g T (1 - e) / (2 (1 + e)) is the speed of the table
    speed = g * np.pi / w * (1 - e) / (1 + e)
    bend = -A * w * w * np.sqrt(1 - (speed / (A * w)) ** 2)
    trace = 1 + e * e + (1 + e) ** 2 * bend / g
    own = np.roots([1.0, -trace, e * e])
    assert np.sort_complex(orbit.values) == pytest.approx(np.sort_complex(own), rel=1e-7)
    impact = next(s for e_ in orbit.run.events for s in e_.steps if s.impulses)
    assert abs(impact.impulses["floor.e"]) == pytest.approx(2.0 * g * 2 * np.pi / w, rel=1e-8)


def relay() -> tuple[hb.Model, np.ndarray, np.ndarray, np.ndarray]:
    """Relay feedback around 1/(s + 1)^3."""
    m = hb.Model("relay")
    m.add(**{f"x{k}": hb.C(1, q=q) for k, q in ((1, 0.3), (2, 0.5), (3, 0.2))})
    m.add(s1=hb.Sf("x2.q - x1.q"), s2=hb.Sf("x3.q - x2.q"), s3=hb.Sf("u - x3.q"))
    m.add(n1=hb.Zero(), n2=hb.Zero(), n3=hb.Zero())
    m.bond("s1 -> n1 -> x1", "s2 -> n2 -> x2", "s3 -> n3 -> x3")
    m.signal(u='if r.state == "plus" then -1 else 1')
    rules = ["minus -> plus when x1.q > 0", "plus -> minus when x1.q < 0"]
    m.machine("r", states={"plus": [], "minus": []}, start="plus", rules=rules)
    A = np.array([[-1.0, 1.0, 0.0], [0.0, -1.0, 1.0], [0.0, 0.0, -1.0]])
    return m, A, np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])


def test_the_limit_cycle_of_relay_feedback_is_astroms() -> None:
    model, A, b, c = relay()
    orbit = hb.periodic(model, settle="30 s")

    def start(h: float) -> np.ndarray:
        """The state in which the relay begins to push down, -x half a period later."""
        M, added = moved(A, -b, h)
        return np.linalg.solve(np.eye(3) + M, -added)

    h = brentq(lambda h: float(c @ start(h)), 1.0, 3.0, xtol=1e-14)
    assert h == pytest.approx(2 * np.pi / np.sqrt(3) / 2, rel=0.1)  # of its describing function
    assert orbit.autonomous and orbit.period == pytest.approx(2 * h, rel=1e-9)
    M, _ = moved(A, -b, h)
    v = A @ -start(h) - b  # the rate with which it arrives
    W = (np.eye(3) - np.outer(v, c) / (c @ v)) @ M
    own = np.sort(np.abs(np.linalg.eigvals(W @ W)))[::-1][:2]
    assert orbit.multipliers[0].kind == "phase" and orbit.stable
    assert np.abs(orbit.values[1:]) == pytest.approx(own, rel=1e-7)


def van_der_pol() -> hb.Model:
    m = hb.Model("van_der_pol", parameters={"mu": 0.5})
    m.add(a=hb.C(1, q=2.0), b=hb.C(1), sa=hb.Sf("b.q"), na=hb.Zero(), nb=hb.Zero())
    m.add(sb=hb.Sf("mu*(1 - a.q^2)*b.q - a.q"))
    m.bond("sa -> na -> a", "sb -> nb -> b")
    return m


def test_van_der_pol_by_the_variational_equations_of_scipy() -> None:
    mu = 0.5
    orbit = hb.periodic(van_der_pol(), period="6 s", settle="20 s", wrt=["mu"])

    def rates(_: float, y: np.ndarray) -> list[float]:
        a, b = y[:2]
        J = np.array([[0.0, 1.0], [-2 * mu * a * b - 1, mu * (1 - a * a)]])
        return [b, mu * (1 - a * a) * b - a, *(J @ y[2:].reshape(2, 2)).ravel()]

    begin = [*orbit.state.stored.values(), 1.0, 0.0, 0.0, 1.0]
    end = solve_ivp(rates, (0.0, orbit.period), begin, rtol=1e-12, atol=1e-13).y[:, -1]
    assert end[:2] == pytest.approx(begin[:2], abs=1e-8)
    assert orbit.monodromy == pytest.approx(end[2:].reshape(2, 2), abs=1e-7)
    # Liouville: the product of the multipliers is the mean divergence
    assert orbit.multipliers[0].kind == "phase"
    # the period of small mu: 2 pi (1 + mu^2/16 - 5 mu^4/3072)
    assert orbit.period == pytest.approx(2 * np.pi * (1 + mu**2 / 16 - 5 * mu**4 / 3072), abs=1e-4)
    slope = 2 * np.pi * (mu / 8 - 20 * mu**3 / 3072)
    assert orbit.derivative("period", "mu") == pytest.approx(slope, abs=1e-3)


def test_stick_slip_takes_the_period_of_its_closed_form_and_loses_a_direction() -> None:
    orbit = hb.periodic(hb.load("examples/stick_slip.toml"))
    w, v0, low, high = 10.0, 0.2, 0.06, 0.10  # spring.q at rest in sliding, at breakaway
    # it slips from high, v0 around low until it has the belt's speed again
    angle = np.arctan2(v0 / w, high - low)
    slip = (np.pi + 2 * angle) / w
    stick = 2 * (high - low) / v0
    assert orbit.period == pytest.approx(slip + stick, rel=1e-8)
    assert [m.kind for m in orbit.multipliers] == ["phase", "zero"] and orbit.stable


def impact_oscillator(force: str = "1 N", speed: str = "2.6 rad/s", gap: str = "0.1 m") -> hb.Model:
    values = {"F": force, "w": speed, "s": gap, "e": 0.8, "c": "0.1 N*s/m"}
    m = hb.Model("impact_oscillator", domain="translational", parameters=values)
    m.add(mass=hb.I("1 kg"), spring=hb.C("1 m/N"), damper=hb.R("c"), v=hb.One())
    m.add(force=hb.Se("F*cos(w*time)"), wall=hb.Sf("0 m/s"))
    m.add(stop=hb.Zero(law="unilateral", gap="s - x", restitution="e"))
    m.bond("force -> v -> mass", "v -> spring", "v -> damper", "v -> stop -> wall")
    m.signal(x=hb.Integral("v.f"))
    return m


def test_the_multipliers_of_an_impact_have_its_saltation() -> None:
    orbit = hb.periodic(impact_oscillator())
    e, w, c = 0.8, 2.6, 0.1
    event = next(x for x in orbit.run.events if x.cause != "start")
    t = event.t
    # at the wall x = s, v before: the oscillator by its own matrix, the impact by its saltation
    A = np.array([[0.0, 1.0], [-1.0, -c]])
    v = float(event.before[0])
    push = np.cos(w * t) - 0.1
    before, after = push - c * v, push + c * e * v
    S = np.array([[-e, 0.0], [(after + e * before) / v, -e]])
    M = expm(A * (2 * np.pi / w - t)) @ S @ expm(A * t)
    own = np.sort(np.linalg.eigvals(M).real)
    found = [m for m in orbit.multipliers if m.kind != "conserved"]
    assert np.sort([m.value.real for m in found]) == pytest.approx(own, rel=1e-8)
    assert orbit.free == ("spring.q, x",)  # x - spring.q: what the gap is measured from
    assert not orbit.stable and "unstable" in str(orbit)


def pumped() -> hb.Model:
    """Charge that is pumped from one capacitor to another, and leaks back."""
    m = hb.Model("pumped", domain="electrical")
    m.input(u=hb.Input(pwm={"period": "1 s", "duty": 0.5}))
    m.add(a=hb.C("1 F", q="3 C"), b=hb.C("2 F"), r=hb.R("1 ohm"), pump=hb.Sf("0.1 A*u"))
    m.add(na=hb.Zero(), nb=hb.Zero(), leak=hb.One(), way=hb.One())
    m.bond("na -> a", "nb -> b", "nb -> leak -> na", "leak -> r", "na -> way -> nb", "pump -> way")
    return m


def test_what_is_conserved_is_kept_and_named() -> None:
    orbit = hb.periodic(pumped())
    a, b = orbit.state.stored.values()
    assert a + b == pytest.approx(3.0, rel=1e-12)
    # difference of voltages d: d' = -1.5 d + 0.15 u
    on = (1 - np.exp(-0.75)) * 0.1
    d = on * np.exp(-0.75) / (1 - np.exp(-1.5))
    assert b / 2 - a == pytest.approx(d, abs=1e-10)
    assert orbit.free == ("a.q, b.q",) and orbit.stable
    assert orbit.values == pytest.approx([1.0, np.exp(-1.5)], abs=1e-9)


def peak_current(mc: float = 0.0) -> hb.Model:
    """A choke between 10 V and Vo; off at the reference less a ramp, on with the clock."""
    values = {"Vo": "4 V", "Iref": "2 A", "mc": f"{mc} A/s", "t_clock": "20 us"}
    m = hb.Model("peak_current", domain="electrical", parameters=values)
    m.input(clock=hb.Input(pwm={"period": "20 us", "duty": 0.001}))
    m.add(E=hb.Se("10 V*on"), O=hb.Se("Vo"), L=hb.I("100 uH", f="1.5 A"), j=hb.One())
    m.bond("E -> j -> L", "j -> O")
    m.signal(on='if s.state == "on" then 1 else 0', ramp="mc*mod(time, t_clock)")
    rules = ["off -> on when clock > 0.5", "on -> off when L.f >= Iref - ramp and clock < 0.5"]
    m.machine("s", states={"on": [], "off": []}, start="off", rules=rules)
    return m


@pytest.mark.parametrize("mc", [0.0, 2e4])
def test_peak_current_control_has_the_published_multiplier(mc: float) -> None:
    up, down = (10 - 4) / L, 4 / L
    orbit = hb.periodic(peak_current(mc))
    assert orbit.values == pytest.approx([-(down - mc) / (up + mc)], rel=1e-9)


def test_records_say_what_they_hold(tmp_path) -> None:  # type: ignore[no-untyped-def]
    orbit = hb.periodic(buck(), multiple=2)
    assert orbit.period == 2 * T and "repeats after 2e-05 s already" in str(orbit)
    data = json.loads(orbit.to_json())
    assert data["stable"] and data["signals"]["C.e"]["mean"] == pytest.approx(
        V * D * R / (R + RL), rel=1e-8
    )
    assert orbit["C.e"].mean() == pytest.approx(data["signals"]["C.e"]["mean"])
    assert orbit._repr_html_().count("<table>") == 3
    orbit.plot("L.f", "C.e", path=tmp_path / "orbit.svg")
    assert (tmp_path / "orbit.svg").stat().st_size > 5000


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({"period": "30 us"}, "HB-A541"),
        ({"period": -1.0}, "HB-A541"),
        ({"multiple": 0}, "HB-A541"),
        ({"settle": "30 us"}, "HB-A541"),
        ({"tol": 2.0}, "HB-A541"),
        ({"max_runs": 1}, "HB-A541"),
        ({"wrt": ["nothing"]}, "HB-A520"),
    ],
)
def test_what_does_not_fit_is_refused(options: dict[str, object], code: str) -> None:
    with pytest.raises(hb.HybondError) as error:
        hb.periodic(buck(), **options)  # type: ignore[arg-type]
    assert error.value.code == code


@pytest.mark.parametrize(
    "text", ["2*pi*f*time", "2*pi*time/P", "2*pi*time/(500 ms)", "2*pi*(2 Hz)*time"]
)
def test_units_within_the_phase_of_a_signal_are_no_matter(text: str) -> None:
    m = hb.Model("lag", parameters={"f": "2 Hz", "P": "0.5 s"})
    m.signal(x=hb.Integral(f"(cos({text}) - x)/(1 s)"))
    orbit = hb.periodic(m)
    w = 4 * np.pi
    assert orbit.period == pytest.approx(0.5, rel=1e-12)
    assert orbit.values == pytest.approx([np.exp(-0.5)], rel=1e-9)
    assert orbit["x"].max() == pytest.approx(1 / np.sqrt(1 + w * w), rel=1e-8)


def test_a_period_that_ends_where_a_sawtooth_jumps_moves_with_it() -> None:
    m = hb.Model("lag", parameters={"P": 0.5})
    m.signal(x=hb.Integral("mod(time, P)/P - x"))
    for P in (0.3, 0.5, 0.7):  # x = t/P - 1/P + exp(-t)/(1 - exp(-P))
        orbit = hb.periodic(m, wrt=["P"], parameters={"P": P})
        assert orbit.state.signals["x"] == pytest.approx(1 / (1 - np.exp(-P)) - 1 / P, rel=1e-8)
        by = 1 / P**2 - np.exp(-P) / (1 - np.exp(-P)) ** 2
        assert orbit.derivative("x", "P") == pytest.approx(by, rel=1e-6)
    found = hb.continuation(m, "P", (0.5, 0.8), points=4)
    assert found.branches[0].ended == "the range ends"


@pytest.mark.sampled(1)
@pytest.mark.parametrize("w", [1.0, 2.0])
def test_a_swing_without_loss_driven_at_its_own_frequency_repeats_never(w: float) -> None:
    m = hb.Model("resonance", domain="electrical", parameters={"w": w})
    m.add(L=hb.I("1 H"), C=hb.C(1 / w**2), j=hb.One(), V=hb.Se("cos(w*time)"))
    m.bond("V -> j -> L", "j -> C")
    with pytest.raises(hb.NumericsError, match="goes on changing") as error:
        hb.periodic(m)
    assert error.value.code == "HB-A540"


@pytest.mark.sampled(2)
@pytest.mark.parametrize("settle", [6.5, 7.0, 7.3, 13.3, 30.0])
def test_a_swing_that_shrinks_to_a_point_has_no_period(settle: float) -> None:
    m = hb.Model("lc", domain="electrical")
    m.add(L=hb.I("1 H"), C=hb.C("0.25 F", e="1 V"), j=hb.One())
    m.bond("j -> L", "j -> C")
    try:
        orbit = hb.periodic(m, settle=settle)
    except hb.NumericsError as error:
        assert error.code == "HB-A540"
    else:
        assert orbit.period == pytest.approx(np.pi, rel=1e-7)


def test_what_has_no_orbit_says_what_was_computed() -> None:
    m = hb.Model("pump", domain="electrical")
    m.input(u=hb.Input(pwm={"period": "1 ms", "duty": 0.5}))
    m.add(I=hb.Sf("1 A*u"), C=hb.C("1 mF"), n=hb.Zero())
    m.bond("I -> n -> C")
    with pytest.raises(hb.NumericsError, match=r"C.q goes on changing, by 0.0005") as error:
        hb.periodic(m)
    assert error.value.code == "HB-A540" and error.value.partial.t_end == pytest.approx(1e-3)
    m = hb.Model("rest")
    m.add(C=hb.C(1, q=1.0), r=hb.R(1), n=hb.Zero())
    m.bond("n -> C", "n -> r")
    for options, code in (({}, "HB-A541"), ({"settle": "50 s"}, "HB-A540")):
        with pytest.raises(hb.HybondError) as refused:
            hb.periodic(m, **options)  # type: ignore[arg-type]
        assert refused.value.code == code


def test_what_does_not_repeat_as_is_said_is_found_out() -> None:
    m = hb.Model("chirp", domain="electrical")
    m.add(V=hb.Se("1 V*sin((time/(1 s))^2)"), C=hb.C("1 F"), r=hb.R("1 ohm"), j=hb.One())
    m.bond("V -> j -> r", "j -> C")
    with pytest.raises(hb.UsageError) as unknown:
        hb.periodic(m)
    assert unknown.value.code == "HB-A511"
    with pytest.raises(hb.NumericsError, match="the next one does not"):
        hb.periodic(m, "1 s")


def test_the_method_is_a_record_as_elsewhere_and_the_period_an_expression() -> None:
    orbit = hb.periodic(buck(), method=hb.Radau(rtol=1e-9))
    assert orbit.run.solver == "radau" and orbit.stable
    with pytest.raises(hb.UsageError) as error:
        hb.periodic(buck(), method="radau", solver="rk45")
    assert error.value.code == "HB-S122"
    m = hb.Model("lag", parameters={"w": "20 rad/s"})
    m.signal(x=hb.Integral("(cos(w*time) - x)/(1 s)"))
    assert hb.periodic(m, "4*pi/w").period == pytest.approx(np.pi / 5, rel=1e-12)


def stateless(kind: str) -> hb.Model:
    """Resistors behind a source, through a switch of a kind; nothing is stored."""
    m = hb.Model("stateless", domain="electrical", parameters={"r": 2.0})
    m.add(V=hb.Se("sin(2*pi*50[1/s]*time)"), d=hb.One(law="diode"), R=hb.R("r"), n=hb.Zero())
    if kind == "diode":
        m.bond("V -> d -> n -> R")
    elif kind == "turned":
        m.bond("n -> d -> V", "R -> n")
    else:
        m.input(u=hb.Input(pwm={"period": "20 ms", "duty": 0.5}))
        m.add(S=hb.Se("3 V*u"), g=hb.One())
        m.bond("V -> d -> n -> R", "S -> g -> n", "g -> x")
        m.add(x=hb.R(1.0))
    return m


@pytest.mark.parametrize("kind", ["diode", "turned", "pulses"])
def test_what_stores_nothing_repeats_as_its_source_does(kind: str) -> None:
    """It ended in a ValueError of NumPy: arrays without a state have no shape of their own."""
    orbit = hb.periodic(stateless(kind))
    assert orbit.period == pytest.approx(0.02) and orbit.stable and not orbit.multipliers


def test_what_stores_nothing_has_gradients() -> None:
    """Of what flows in half waves, through twice and a quarter of them."""
    flow = hb.gradient(stateless("diode"), hb.Final("R.f"), "45 ms", wrt=["r"])
    work = hb.gradient(stateless("diode"), hb.Total("R.f^2"), "45 ms", wrt=["r"])
    assert (flow.value, flow["r"]) == pytest.approx((0.5, -0.25), rel=1e-9)
    assert (work.value, work["r"]) == pytest.approx((0.003125, -0.003125), rel=1e-9)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("guess", "laps"), [(6.5, 1), (13.0, 2)])
def test_a_guess_of_several_periods_is_told_that_the_motion_repeats_sooner(
    guess: float, laps: int
) -> None:
    """Van der Pol's period is 6.66328685932 (Urabe 1960); with a guess of 13 it was twice that."""
    m = hb.Model("valve")
    m.add(L=hb.I(1.0, f=2.0), C=hb.C(1.0), j=hb.One(), R=hb.R({"e": "f^3/3 - f"}))
    m.bond("C -> j" if laps == 2 else "j -> C", "j -> L", "j -> R")
    orbit = hb.periodic(m, guess)
    assert orbit.period == pytest.approx(laps * 6.66328685932, rel=1e-8)
    said = [note for note in orbit.notes if "already" in note]
    assert said == (["it repeats after 6.66328686 s already"] if laps > 1 else [])
