"""Kinks of laws, sources and signals end a step: order is kept, and no half wave is passed over."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

SOLVERS = ["rk45", "radau", "exact"]


def filled(source: str, until: float, **options: object) -> hb.Result:
    """Fill a capacitor from a source, and let a signal add up the same."""
    m = hb.Model("filled")
    m.add(c=hb.C(1.0), u=hb.Sf(source), n=hb.Zero())
    m.bond("u -> n -> c")
    m.signal(a=hb.Integral(source))
    return hb.simulate(m, until=until, **options)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    ("per_second", "level"), [(1.0, 0.0), (50.0, 0.9), (1000.0, 0.999), (50.0, -0.5), (3.0, 0.9999)]
)
def test_half_waves_are_counted(per_second: float, level: float, solver: str) -> None:
    """Narrow pulses far apart, at the tolerance that everybody has."""
    w = 2.0 * math.pi * per_second
    for source in (
        f"max(0, sin({w!r}*time) - {level})",
        f"if sin({w!r}*time) > {level} then sin({w!r}*time) - {level} else 0",
        f"0.5*(sin({w!r}*time) - {level} + abs(sin({w!r}*time) - {level}))",
    ):
        run = filled(source, 1.0, solver=solver)
        begin = math.asin(level)
        pulse = (2.0 * math.cos(begin) - level * (math.pi - 2.0 * begin)) / w
        if level < 0.0:
            # the run begins and ends within a pulse
            assert run["c.q"].at(1.0) == pytest.approx(per_second * pulse, rel=1e-7)
        for name in ("c.q", "a"):
            assert run[name].at(1.0) == pytest.approx(per_second * pulse, rel=2e-7)
        assert len(run.events) == 1  # a kink is no event


@pytest.mark.parametrize("solver", ["qss3", "liqss3"])
def test_quantised_states_meet_half_waves(solver: str) -> None:
    """Where nothing moves they have no event of their own. A hundred quanta are their accuracy."""
    w = 2.0 * math.pi * 5.0
    run = filled(f"max(0, sin({w!r}*time) - 0.5)", 1.0, solver=solver, rtol=1e-5)
    begin = math.asin(0.5)
    pulse = (2.0 * math.cos(begin) - 0.5 * (math.pi - 2.0 * begin)) / w
    assert run["c.q"].at(1.0) == pytest.approx(5.0 * pulse, rel=100 * 1e-5)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_square_wave_of_signs_is_integrated_exactly(solver: str) -> None:
    """A triangle; at a quarter of a period behind the last corner it is a quarter high."""
    run = filled(f"sign(sin({2.0 * math.pi * 7.0!r}*time))", 3.0 + 0.25 / 7.0, solver=solver)
    assert run["c.q"].at(run.t_end) == pytest.approx(0.25 / 7.0, abs=1e-9)


@pytest.mark.parametrize("solver", SOLVERS)
def test_saw_teeth_and_stairs(solver: str) -> None:
    assert filled("mod(time, 0.3)", 2.95, solver=solver)["c.q"].at(2.95) == pytest.approx(
        9 * 0.045 + 0.5 * 0.25**2, rel=1e-8
    )
    assert filled("floor(3*time)", 2.5, solver=solver)["c.q"].at(2.5) == pytest.approx(
        sum(range(7)) / 3.0 + 7.0 * (2.5 - 7.0 / 3.0), rel=1e-8
    )


FORCES = {
    "abs": "-(2.5*x - 1.5*abs(x))",
    "if": "if x < 0 then -4*x else -x",
    "max": "-(max(x, 0) + 4*min(x, 0))",
}


def bent_spring(force: str) -> hb.Model:
    """Stiffness 1 on one side, 4 on the other: half a period of pi, half a period of pi/2."""
    m = hb.Model("bent")
    m.add(m=hb.I(1.0, p=1.0), v=hb.One())
    if force == "table":
        m.add(s=hb.C({"e": {"table": [[-9, 0, 9], [-36, 0, 9]]}}))
        m.bond("v -> m", "v -> s")
        m.signal(x="s.q")
    else:
        m.add(f=hb.Se(FORCES[force]))
        m.bond("f -> v -> m")
        m.signal(x=hb.Integral("v.f"))
    return m


@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize("force", ["abs", "if", "max", "table"])
def test_a_spring_with_two_stiffnesses(force: str, solver: str) -> None:
    """After whole periods it is where it was; between, half a sine on either side."""
    period = 1.5 * math.pi
    run = hb.simulate(bent_spring(force), until=10.0 * period, solver=solver)
    assert run["x"].at(10.0 * period) == pytest.approx(0.0, abs=1e-6)
    assert run["m.p"].at(10.0 * period) == pytest.approx(1.0, abs=1e-6)
    for t in (0.3, 1.9, 3.0):
        assert run["x"].at(period + t) == pytest.approx(math.sin(t), abs=1e-6)
    for t in (0.2, 0.8, 1.5):
        x = -0.5 * math.sin(2.0 * t)
        assert run["x"].at(4.0 * period + math.pi + t) == pytest.approx(x, abs=1e-6)


def test_the_order_of_a_method_is_kept_across_kinks() -> None:
    """Where the tolerance shrinks by 1e6, so does the error, and steps grow as without kinks."""
    period = 1.5 * math.pi
    errors, steps = [], []
    for rtol in (1e-4, 1e-7, 1e-10):
        run = hb.simulate(bent_spring("abs"), until=5.0 * period, rtol=rtol, solver="rk45")
        errors.append(abs(run["x"].at(5.0 * period)) + abs(run["m.p"].at(5.0 * period) - 1.0))
        steps.append(run.stats["steps"])
    assert errors[2] < 1e-4 * errors[1] ** 0.5 < 1e-2 * errors[0] ** 0.25
    assert errors[0] < 1e-2
    assert errors[2] < 1e-8
    # order 5: a thousandth of the tolerance takes 10^(3/5) = 4 times the steps
    assert steps[2] / steps[1] < 5.0


@pytest.mark.parametrize("solver", ["rk45", "radau"])
def test_corners_of_a_table_in_a_resistor(solver: str) -> None:
    """A dead zone of 1 V on either side, under a sine of 2 V: its charge in closed form."""
    m = hb.Model("dead zone")
    table = {"table": [[-5, -1, 1, 5], [-4, 0, 0, 4]]}
    m.add(u=hb.Se("2*sin(time/(1 [s]))"), j=hb.One(), r=hb.G({"f": table}))
    m.bond("u -> j -> r")
    m.signal(q=hb.Integral("r.f"))
    begin = math.asin(0.5)
    pulse = 4.0 * math.cos(begin) - (math.pi - 2.0 * begin)
    run = hb.simulate(m, until=6.0 * math.pi, solver=solver)
    assert run["q"].at(math.pi) == pytest.approx(pulse, rel=1e-8)
    assert run["q"].at(4.0 * math.pi) == pytest.approx(0.0, abs=1e-8)
    assert run["q"].at(5.0 * math.pi) == pytest.approx(pulse, rel=1e-8)


@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize(
    ("source", "read"),
    [
        ("-sign(x + v.f)", "u"),
        ("if x + v.f > 0 then -1 else 1", "u"),
        ("-2*abs(sign(x + v.f))*sign(x + v.f)", "u"),
    ],
)
def test_a_jump_that_would_switch_back_at_once_is_refused_early(
    source: str, read: str, solver: str
) -> None:
    """With the recipe: it would slide, and a source does not."""
    m = hb.Model("chatter")
    m.add(m=hb.I(1.0), v=hb.One(), u=hb.Se(source))
    m.bond("u -> v -> m")
    m.signal(x=hb.Integral("v.f", start=1.0))
    run = hb.simulate(m, until=5.0, solver=solver, on_error="return")
    assert run.error is not None
    assert run.error.code == "HB-N410"
    assert read in str(run.error)
    assert "relay" in str(run.error)
    assert run.stats["steps"] < 10_000


def test_the_recipe_slides() -> None:
    """From where the motion reaches x + v = 0 on, x' = -x."""
    m = hb.Model("slides")
    m.add(m=hb.I(1.0), v=hb.One(), u=hb.Se("-rel.e"), y=hb.Sf("x + v.f"))
    m.add(rel=hb.One(law="relay", limit=1.0))
    m.bond("u -> v -> m", "y -> rel")
    m.signal(x=hb.Integral("v.f", start=1.0))
    run = hb.simulate(m, until=5.0)
    # x = 1 - t^2/2, v = -t
    begin = math.sqrt(3.0) - 1.0
    (sliding,) = run.sliding
    assert sliding.t0 == pytest.approx(begin, rel=1e-9)
    x = (1.0 - 0.5 * begin**2) * math.exp(begin - 5.0)
    assert run["x"].at(5.0) == pytest.approx(x, rel=1e-6)


ROOTS = {
    "effort": {"e": "2*sign(f)*sqrt(abs(f)/0.6)"},
    "power": {"e": "1.5*sign(f)*abs(f)^0.5"},
    "flow": {"f": "0.7*sign(e)*sqrt(abs(e))"},
}


@pytest.mark.parametrize("law", ROOTS)
@pytest.mark.parametrize("solver", ["rk45", "exact", "auto"])
def test_an_orifice_through_which_nothing_flows_does_not_end_steps(law: str, solver: str) -> None:
    """In the diagonal of a balanced bridge its flow is rounding of the flows beside it."""
    m = hb.Model("bridge")
    m.add(u=hb.Se("sin(3*time)"), top=hb.Zero(), left=hb.Zero(), right=hb.Zero())
    m.add(c1=hb.C(0.3), c2=hb.C(0.3), d=hb.R(ROOTS[law]))
    m.bond("u -> top", "left -> c1", "right -> c2")
    for a, b, name in (("top", "left", "r1"), ("top", "right", "r2"), ("left", "right", "d")):
        m.add(**{f"j_{name}": hb.One()} | ({} if name == "d" else {name: hb.R(0.7)}))
        m.bond(f"{a} -> j_{name} -> {b}", f"j_{name} -> {name}")
    run = hb.simulate(m, until=5.0, solver=solver)
    assert run.status == "ok"
    assert abs(run["d.f"].at([0.3, 1.0, 4.0])).max() < 1e-12
    w, tau = 3.0, 0.7 * 0.3
    q = [
        0.3
        / (1 + (w * tau) ** 2)
        * (math.sin(w * t) - w * tau * math.cos(w * t) + w * tau * math.exp(-t / tau))
        for t in (0.3, 1.0, 4.0)
    ]
    assert run["c1.q"].at([0.3, 1.0, 4.0]) == pytest.approx(q, rel=1e-6)
    assert run.stats["steps"] < 400


@pytest.mark.parametrize("law", ["effort", "power"])
@pytest.mark.parametrize("coupling", ["GY", "TF"])
def test_a_root_held_at_rest_beside_flows_is_solved(law: str, coupling: str) -> None:
    """What is behind a two-port leaves the resistor no effort: its flow is all rounding."""
    m = hb.Model("held")
    m.add(i=hb.I(1.0, p=0.4), c=hb.C(0.5), r=hb.R(ROOTS[law]), j=hb.Zero(), one=hb.One())
    m.add(x=hb.Zero())
    m.add(t=getattr(hb, coupling)(1.8))
    m.bond("one -> i", "one -> c", "one -> j", "j -> r")
    m.bond("j -> t.1", "t.2 -> x")
    if coupling == "TF":
        m.add(s=hb.Se(0.0))
        m.bond("s -> x")  # an effort of zero behind a transformer; a gyrator's port is open
    run = hb.simulate(m, until=4.0)
    assert run.status == "ok"
    w = math.sqrt(2.0)
    assert run["i.p"].at(4.0) == pytest.approx(0.4 * math.cos(4.0 * w), rel=1e-6)
    assert abs(run["r.f"].at([0.5, 2.2])).max() < 1e-12
    assert run.stats["steps"] < 400


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
def test_kink_at_the_start_of_a_motion_that_is_carried_over(solver):
    # a step of 1e-33 s was taken for one of 1e-12 s: its polynomial, of a momentum that decays
    # beside it, was rounding times 1e21 squared, and between both ends there was 1e54 J
    m = hb.Model("beside")
    m.add(s=hb.Sf("sin(3*time)"), j=hb.One(law="coulomb", limit=0.1), r=hb.R(1.0), c=hb.C(0.1))
    m.add(g=hb.R({"f": "if e > 0 then 2*e else 0"}))
    m.add(beside=hb.One(), mass=hb.I(1.0, p=0.25), drag=hb.R(0.3))
    m.bond("s -> j", "j -> r", "j -> g", "j -> c", "beside -> mass", "beside -> drag")
    run = hb.simulate(m, 0.5, solver=solver)
    assert run.audit().holds()
    times = np.concatenate([np.geomspace(1e-36, 0.5, 200), np.linspace(0.0, 0.5, 20)])
    values = run.sample(times.tolist(), ["mass.p", "c.q"])
    assert values["mass.p"] == pytest.approx(0.25 * np.exp(-0.3 * times), rel=1e-7)
    assert values["c.q"] == pytest.approx((1.0 - np.cos(3.0 * times)) / 3.0, abs=1e-8)


def saw_filtered(t: float, period: float) -> float:
    """What ``x' = max(mod(t, period) - 0.2, 0) - x`` makes of 0.1, part by part."""
    x, left = 0.1, t
    while left > 0.0:
        flat = min(left, 0.2)
        rising = min(left - flat, period - 0.2)
        x = (x * math.exp(-flat) + 1.0) * math.exp(-rising) + rising - 1.0
        left -= flat + rising
    return x


@pytest.mark.parametrize("rtol", [1e-8, 1e-11, 1e-12, 1e-13])
def test_a_saw_that_begins_anew_is_not_held_by_the_corner_that_it_left(rtol: float) -> None:
    """It falls from beyond its corner to before it, and comes back in a while: nothing chatters."""
    period = 0.5001
    m = hb.Model("saw", parameters={"P": period})
    m.signal(x=hb.Integral("max(mod(time, P) - 0.2, 0) - x", start=0.1), c=hb.Integral("1"))
    m.add(s=hb.Se(1.0), r=hb.R(1.0), j=hb.One())
    m.bond("s -> j -> r")
    m.machine("late", states={"a": [], "b": []}, start="a", rules=["a -> b when c > 0.777"])
    run = hb.simulate(m, 1.13, rtol=rtol)
    assert run["x"].at(1.13) == pytest.approx(saw_filtered(1.13, period), abs=1e-9)


def held_twice(law: str, limit: float, jump: float, push: float, *, dual: bool) -> hb.Model:
    """A mass that a spring pushes, on friction by a junction beside one that a law has."""
    m = hb.Model("held twice")
    if dual:
        m.add(b=hb.Zero(law=law, limit=limit), i=hb.C(0.15, q=0.14), c=hb.I(0.5, p=-0.5 * push))
        m.add(r=hb.R({"f": f"{jump}*sign(e)"}), d=hb.G(0.5))
    else:
        m.add(b=hb.One(law=law, limit=limit), i=hb.I(0.15, p=0.14), c=hb.C(0.5, q=-0.5 * push))
        m.add(r=hb.R({"e": f"{jump}*sign(f)"}), d=hb.R(0.5))
    m.bond("b -> i", "b -> c", "b -> r", "b -> d")
    return m


@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize(("limit", "jump"), [(2.36, 8.15), (4.0, 3.0)])
@pytest.mark.parametrize("law", ["relay", "coulomb"])
def test_a_law_that_jumps_at_rest_beside_friction_is_refused_as_it_is_alone(
    law: str, limit: float, jump: float, dual: bool
) -> None:
    """Both would hold 5 N, neither does alone: each event lets go what the one before held."""
    run = hb.simulate(held_twice(law, limit, jump, 5.0, dual=dual), 1.0, on_error="return")
    assert run.error is not None
    assert run.error.code == "HB-N410"
    assert "at r" in str(run.error)
    assert len(run.events) < 1000
    # a mass of 0.15 that 5 N push, with all friction against it, and 0.5 N*s/m: it stands at
    assert run.t_end == pytest.approx(stands_at(limit + jump), rel=1e-3)


def stands_at(friction: float) -> float:
    """When the mass comes to rest: ``0.15 v' = 5 - x/0.5 - friction - 0.5 v``."""
    system = solve_ivp(
        lambda t, y: [y[1], (5.0 - 2.0 * y[0] - friction - 0.5 * y[1]) / 0.15],
        (0.0, 1.0),
        [0.0, 0.14 / 0.15],
        events=lambda t, y: y[1],
        rtol=1e-10,
        atol=1e-12,
    )
    return float(system.t_events[0][0])


@pytest.mark.parametrize("fall", [0.5, 1.0])
def test_a_law_that_holds_a_node_where_a_diode_would_is_refused_early(fall: float) -> None:
    """Steps end above zero by what they may err, and behind it the law pushes back."""
    m = hb.Model("clamped")
    m.add(n=hb.Zero(law="diode"), c=hb.C(1.0, q=1.0), s=hb.Sf(fall), i=hb.I(1.0))
    m.add(g=hb.R({"f": "1.74*sign(e)"}), h=hb.R({"f": "0.885*sign(e)"}))
    m.bond("s -> n -> c", "n -> g", "n -> h", "n -> i")
    run = hb.simulate(m, 3.0, on_error="return", max_steps=2000)
    assert run.error is not None
    assert run.error.code == "HB-N410"
    # q'' = -q, q = 1 and q' = fall - 2.625 at the start
    assert run.t_end == pytest.approx(math.atan(1.0 / (2.625 - fall)), rel=1e-4)


@pytest.mark.parametrize(
    ("given", "law", "bent", "start", "dual"),
    [
        (0.7, 1.3, 1.96, 0.2, True),
        (0.7, 1.3, 0.5, 0.2, False),
        (0.2, 3.0, 1.0, 0.0, False),
        (0.2, 3.0, 1.0, 0.0, True),
    ],
)
def test_a_diode_that_opens_in_vain_where_a_law_holds_its_node_is_refused_early(
    given: float, law: float, bent: float, start: float, *, dual: bool
) -> None:
    """Instant after instant, each two of them later, nothing changed: 1e-12 s of a run of 2 s."""
    m = hb.Model("held in vain")
    bow, jump = f"{bent}*sinh({{}}/0.576)", f"{law}*sign({{}})"
    if dual:
        m.add(n=hb.One(law="diode"), c=hb.I(3.34, p=1.21), s=hb.Se(given))
        m.add(i=hb.C({"e": bow.format("q")}, q=start), g=hb.R({"e": jump.format("f")}))
    else:
        m.add(n=hb.Zero(law="diode"), c=hb.C(3.34, q=1.21), s=hb.Sf(given))
        m.add(i=hb.I({"f": bow.format("p")}, p=start), g=hb.R({"f": jump.format("e")}))
    m.bond("n -> c", "g -> n", "i -> n", "s -> n")
    run = hb.simulate(m, 2.0, on_error="return", max_steps=1000)
    assert run.error is not None
    assert run.error.code == "HB-N410"
    assert "at g" in str(run.error)
    falls = solve_ivp(
        lambda t, y: [given - law - bent * math.sinh(y[1] / 0.576), y[0] / 3.34],
        (0.0, 2.0),
        [1.21, -start if dual else start],
        events=lambda t, y: y[0],
        rtol=1e-11,
        atol=1e-13,
    )
    assert run.t_end == pytest.approx(float(falls.t_events[0][0]), rel=1e-4)
