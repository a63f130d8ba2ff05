"""Orbits along a parameter: what they pass, against closed forms."""

import json

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

import hybond as hb
from hybond.analysis.periodic.branch import value_of
from hybond.draw.orbit_plots import _curve


def bouncer(amplitude: str) -> hb.Model:
    values = {"m": "2 kg", "g": "9.81 m/s^2", "A": amplitude, "w": "20 rad/s", "e": 0.8}
    m = hb.Model("bouncer", domain="translational", parameters=values)
    m.add(weight=hb.Se("-m*g"), ball=hb.I("m", f="1.2 m/s"), v=hb.One())
    m.add(table=hb.Sf("A*w*cos(w*time)"))
    m.add(floor=hb.Zero(law="unilateral", gap="h - A*sin(w*time)", restitution="e"))
    m.bond("weight -> v -> ball", "table -> floor -> v")
    m.signal(h=hb.Integral("v.f", start="30 mm"))
    return m


@pytest.mark.slow
def test_the_bouncing_ball_is_born_in_a_fold_and_doubles_its_period() -> None:
    e, g, w = 0.8, 9.81, 20.0
    # once a period: the table's speed at impact u, its acceleration a (see test_periodic)
    u = g * np.pi / w * (1 - e) / (1 + e)
    born = u / w
    bent = 2 * g * (1 + e * e) / (1 + e) ** 2
    doubles = np.hypot(u, bent / w) / w
    found = hb.continuation(
        bouncer("26 mm"), "A", ("26 mm", "27 mm"), points=3, doublings=1, settle=2 * np.pi
    )
    first = found.branches[0]
    (double,) = (s for s in first.special if s.kind == "period doubling")
    assert double.value == pytest.approx(doubles, rel=1e-6)
    assert first.stable[0] and not first.stable[-1] and first.ended == "the range ends"
    second = found.branches[1]
    assert second.multiple == 2 and second.stable[1] and second.values[2] > doubles
    # it is drawn from where it begins
    assert second.born is double and first.born is None
    _, x, ys, stable = _curve(second, "ball.f", "begin", value_of)
    assert x[0] == double.value and len(stable) == len(x)
    assert [y[0] for y in ys] == pytest.approx([double.orbit.state["ball.p"] / 2] * 2, rel=1e-6)
    # the other way the branch turns back where it is born
    A, T = 8.7e-3, np.pi / 10
    t = np.arccos(u / (A * w)) / w
    fall = T - t  # from the impact on, till the period begins
    h = A * np.sin(w * t) + g * T / 2 * fall - g * fall**2 / 2
    start = {"ball.p": 2.0 * (g * T / 2 - g * fall), "h": h}
    found = hb.continuation(
        bouncer("8.7 mm"), "A", (A, 8e-3), points=4, max_points=6, start=start, settle=0
    )
    (fold,) = found["fold"]
    assert fold.value == pytest.approx(born, rel=1e-6)
    branch = found.branches[0]
    assert branch.values.min() == pytest.approx(born, rel=1e-6) and branch.stable[0]
    assert not branch.stable[-1] and max(m.value.real for m in branch.points[-1].multipliers) > 1


def peak_current() -> hb.Model:
    values = {"Vo": "4 V", "Iref": "2 A"}
    m = hb.Model("peak_current", domain="electrical", parameters=values)
    m.input(clock=hb.Input(pwm={"period": "20 us", "duty": 0.001}))
    m.add(E=hb.Se("10 V*on"), O=hb.Se("Vo"), L=hb.I("100 uH", f="1.5 A"), j=hb.One())
    m.bond("E -> j -> L", "j -> O")
    m.signal(on='if s.state == "on" then 1 else 0')
    rules = ["off -> on when clock > 0.5", "on -> off when L.f >= Iref and clock < 0.5"]
    m.machine("s", states={"on": [], "off": []}, start="off", rules=rules)
    return m


@pytest.mark.slow
def test_peak_current_control_doubles_its_period_at_a_duty_of_one_half() -> None:
    found = hb.continuation(peak_current(), "Vo", ("4 V", "6.5 V"), points=5)
    (double,) = found.special
    assert double.kind == "period doubling" and double.value == pytest.approx(5.0, rel=1e-9)
    branch = found.branches[0]
    apart = np.abs(branch.values - 5.0) > 1e-6
    assert (branch.stable == (branch.values < 5.0))[apart].all()
    # the multiplier is -m2/m1 all along, the current that with which the reference is reached
    own = [p.multipliers[0].value.real for p in branch.points]
    assert own == pytest.approx(-branch.values / (10 - branch.values), rel=1e-8)
    duty = branch.values / 10
    valley = 2.0 - (10 - branch.values) / 100e-6 * duty * 20e-6
    assert branch.of("L.f") == pytest.approx(valley, rel=1e-9)
    assert branch.of("L.f", "max") == pytest.approx(np.full(len(valley), 2.0), rel=1e-9)


def choke() -> hb.Model:
    """A choke fed through a switch, with a diode behind it, into a battery."""
    m = hb.Model("choke", domain="electrical", parameters={"Vo": "3 V"})
    m.input(u=hb.Input(pwm={"period": "20 us", "duty": 0.4}))
    m.add(E=hb.Se("10 V*u"), O=hb.Se("Vo"), L=hb.I("100 uH"), R=hb.R("0.5 ohm"))
    m.add(d=hb.One(law="diode"))
    m.bond("E -> d -> L", "d -> R", "d -> O")
    return m


@pytest.mark.slow
def test_the_current_that_begins_to_end_within_the_period_is_a_border_collision() -> None:
    L, R, T, D = 100e-6, 0.5, 20e-6, 0.4
    a = np.exp(-R / L * T * D), np.exp(-R / L * T * (1 - D))

    def valley(vo: float) -> float:
        """Where the current would be lowest, did the diode always conduct."""
        rise, fall = (10 - vo) / R * (1 - a[0]), -vo / R * (1 - a[1])
        return float((rise * a[1] + fall) / (1 - a[0] * a[1]))

    border = brentq(valley, 1.0, 9.0, xtol=1e-14)
    found = hb.continuation(choke(), "Vo", ("3.5 V", "4.1 V"), points=4)
    (point,) = found.special
    assert point.kind == "border collision" and point.value == pytest.approx(border, rel=1e-6)
    branch = found.branches[0]
    sizes = np.array([abs(p.multipliers[0].value) for p in branch.points])
    apart = np.abs(branch.values - border) > 1e-5
    own = np.where(branch.values < border, a[0] * a[1], 0.0)
    assert sizes[apart] == pytest.approx(own[apart], abs=1e-9) and apart.sum() >= len(apart) - 2
    assert branch.stable.all()


@pytest.mark.slow
def test_an_oscillator_grazes_its_stop_where_its_amplitude_is_the_gap() -> None:
    values = {"F": "0.4 N", "w": "0.7 rad/s", "s": "0.8 m", "e": 0.8, "c": "0.1 N*s/m"}
    m = hb.Model("impact_oscillator", domain="translational", parameters=values)
    m.add(mass=hb.I("1 kg"), spring=hb.C("1 m/N"), damper=hb.R("c"), v=hb.One())
    m.add(force=hb.Se("F*cos(w*time)"), wall=hb.Sf("0 m/s"))
    m.add(stop=hb.Zero(law="unilateral", gap="s - x", restitution="e"))
    m.bond("force -> v -> mass", "v -> spring", "v -> damper", "v -> stop -> wall")
    m.signal(x=hb.Integral("v.f"))
    found = hb.continuation(m, "s", ("0.8 m", "0.762 m"), points=3)
    grazing = found.special[0]
    touches = 0.4 / np.hypot(1 - 0.7**2, 0.1 * 0.7)
    assert grazing.kind == "grazing" and grazing.value == pytest.approx(touches, rel=1e-6)
    assert "stop.f > 0 is only touched" in grazing.text
    # beyond it another branch, on which it strikes once a period: det M = e^2 exp(-c T)
    branch = found.branches[0]
    T = 2 * np.pi / 0.7
    strikes = [p for p in branch.points if len(p.run.events) > 1]
    assert len(strikes) >= 2
    for p in strikes:
        free = [x.value for x in p.multipliers if x.kind != "conserved"]
        assert np.prod(free).real == pytest.approx(0.64 * np.exp(-0.1 * T), rel=1e-6)


def test_the_period_that_follows_the_parameter_is_followed() -> None:
    """A choke at another frequency: its current at the edge in closed form."""
    m = hb.Model("chopper", domain="electrical", parameters={"f": "10 kHz"})
    m.input(u=hb.Input(pwm={"period": "1/f", "duty": 0.4}))
    m.add(V=hb.Se("10 V*u"), L=hb.I("1 mH"), R=hb.R("1 ohm"), j=hb.One())
    m.bond("V -> j -> L", "j -> R")
    found = hb.continuation(m, "f", ("2 kHz", "10 kHz"), points=6)
    branch = found.branches[0]
    on, off = np.exp(-0.4e3 / branch.values), np.exp(-0.6e3 / branch.values)
    assert branch.of("L.f") == pytest.approx(10 * (1 - on) * off / (1 - on * off), rel=1e-8)
    assert [p.period for p in branch.points] == pytest.approx(1 / branch.values, rel=1e-12)
    # two or three periods for each orbit: the slopes by the parameter are right
    assert found.runs <= 4 * len(branch.points) + 8


def test_records_say_what_they_hold(tmp_path) -> None:  # type: ignore[no-untyped-def]
    found = hb.continuation(peak_current(), "Vo", ("4.5 V", "5.5 V"), points=4)
    assert "period doubling  Vo = 5 V" in str(found) and "<table>" in found._repr_html_()
    data = json.loads(found.to_json())
    assert data["branches"][0]["special"][0]["kind"] == "period doubling"
    found.plot("L.f", what="max", path=tmp_path / "branch.svg")
    assert (tmp_path / "branch.svg").stat().st_size > 5000
    with pytest.raises(hb.UsageError):
        found.plot(what="least")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("values", "options"),
    [((1.0, 1.0), {}), ("3 V", {}), ((1.0, "x"), {}), ((3.0, 4.0), {"points": 1})],
)
def test_no_way_is_refused(values: object, options: dict[str, int]) -> None:
    with pytest.raises(hb.UsageError) as error:
        hb.continuation(peak_current(), "Vo", values, **options)  # type: ignore[arg-type]
    assert error.value.code == "HB-A543"


def test_a_pair_crosses_where_damping_changes_its_sign() -> None:
    m = hb.Model("rlc", domain="electrical", parameters={"R": "0.1 ohm"})
    m.add(V=hb.Se("1 V*cos(2.6*time/(1 s))"), L=hb.I("1 H"), C=hb.C("1 F"), r=hb.R("R"), j=hb.One())
    m.bond("V -> j -> L", "j -> C", "j -> r")
    found = hb.continuation(m, "R", ("0.1 ohm", "-0.08 ohm"), points=4)
    (point,) = found.special
    assert point.kind == "Neimark-Sacker" and point.value == pytest.approx(0.0, abs=1e-7)
    angle = 2 * np.pi / 2.6  # of the free oscillation within a period
    assert f"at an angle of {angle:.6g} rad" in point.text
    T = 2 * np.pi / 2.6
    sizes = [abs(p.multipliers[0].value) for p in found.branches[0].points]
    assert sizes == pytest.approx(np.exp(-found.branches[0].values / 2 * T), rel=1e-8)


@pytest.mark.slow
def test_a_corner_of_the_branch_is_passed_whatever_the_range_is() -> None:
    """A buck converter whose load goes away: its current begins to end within the period."""
    L, C, RL, T, D = 100e-6, 10e-6, 0.1, 20e-6, 0.4
    m = hb.Model("buck", domain="electrical", parameters={"R": "15 ohm"})
    m.input(u=hb.Input(pwm={"period": "20 us", "duty": D}))
    m.add(V=hb.Se("12 V"), L=hb.I("100 uH"), rl=hb.R("0.1 ohm"), C=hb.C("10 uF"), r=hb.R("R"))
    m.add(s=hb.One(), d=hb.One(law="diode"), a=hb.Zero(), j=hb.One(), n=hb.Zero(), g=hb.Se("0 V"))
    m.bond("V -> s -> a -> j -> L", "g -> d -> a", "j -> rl", "j -> n -> C", "n -> r")
    rules = ["off -> on when u > 0.5", "on -> off when u < 0.5"]
    m.machine("S", states={"on": ["s"], "off": []}, start="off", rules=rules)

    def valley(load: float) -> float:
        """The flux with which a period begins, did the diode always conduct."""
        A = np.array([[-RL / L, -1 / C], [1 / L, -1 / (load * C)]])
        on, off, one = expm(A * D * T), expm(A * (1 - D) * T), np.eye(2)
        added = np.linalg.solve(A, (on - one) @ np.array([12.0, 0.0]))
        return float(np.linalg.solve(one - off @ on, off @ added)[0])

    found = hb.continuation(m, "R", ("15 ohm", "500 ohm"), points=4)
    (border,) = found.special
    assert border.kind == "border collision"
    assert border.value == pytest.approx(brentq(valley, 12.0, 30.0, xtol=1e-12), rel=1e-5)
    branch = found.branches[0]
    assert branch.ended == "the range ends" and len(branch.points) < 40
    light = branch.points[-1]
    # without a current at both ends charge balance says the mean output: the load's own
    mean = light.run["L.f"].mean()
    assert mean * branch.values[-1] == pytest.approx(light.run["C.e"].mean(), rel=1e-7)
    assert [x.kind for x in light.multipliers] == ["", "zero"]


def test_what_branches_do_not_have_is_refused_with_what_may_be_meant() -> None:
    found = hb.continuation(choke(), "Vo", ("3 V", "3.1 V"), points=2)
    branch = found.branches[0]
    for call, near in (
        (lambda: branch.of("L.f", "maximum"), "'max'"),  # type: ignore[arg-type]
        (lambda: branch.of("L.f", turn=1), "0 to 0"),
        (lambda: found["period doublings"], "'period doubling'"),
        (lambda: found.plot("L.f", "mea"), "'mean'"),  # type: ignore[arg-type]
    ):
        with pytest.raises(hb.UsageError) as error:
            call()
        assert error.value.code == "HB-A544" and near in error.value.hint
    assert found["fold"] == ()
    with pytest.raises(hb.UsageError) as unknown:
        branch.of("L.g", "max")
    assert unknown.value.code == "HB-S109"
