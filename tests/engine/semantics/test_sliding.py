"""Sliding along switching surfaces, against closed forms and integrations written here."""

from __future__ import annotations

import time

import numpy as np
import pytest
from portable_runs import portable
from scipy.integrate import solve_ivp

import hybond as hb
from hybond.engine.tables import tables_of


def signum(machine: str) -> str:
    """Return +1 in the state ``above``, -1 below."""
    return f'(if {machine}.state == "above" then 1 else -1)'


def add_relay(model: hb.Model, name: str, function: str, start: str = "below", also: str = ""):
    model.machine(
        name,
        states={"above": [], "below": []},
        start=start,
        rules=[
            f"above -> below when {function} < 0{also}",
            f"below -> above when {function} > 0{also}",
        ],
    )


def system(rates: list[str], start: list[float], name: str = "system") -> hb.Model:
    """Return ``x_k' = rates[k]`` as a bond graph: a C fed by a modulated source per state."""
    m = hb.Model(name)
    for k, (rate, x0) in enumerate(zip(rates, start, strict=True), 1):
        m.add(**{f"x{k}": hb.C(1.0, q=x0), f"s{k}": hb.Sf(rate), f"n{k}": hb.Zero()})
        m.bond(f"s{k} -> n{k} -> x{k}")
    return m


def constant_drift(d: str = "0.5", x0: float = -1.0) -> hb.Model:
    m = system([f"-{signum('r')} + {d}"], [x0])
    add_relay(m, "r", "x1.q", "below" if x0 < 0 else "above")
    return m


# -- one surface


@pytest.mark.parametrize("solver", ["rk45", "radau", "rk4"])
def test_a_state_that_both_sides_push_back_reaches_the_surface_and_stays(solver: str) -> None:
    run = hb.simulate(
        constant_drift(), until=2.0, solver=solver, step=0.1 if solver == "rk4" else None
    )
    assert run.status == "ok"
    (sliding,) = run.sliding
    assert sliding.t0 == pytest.approx(2.0 / 3.0, abs=1e-12)
    assert sliding.t1 == 2.0
    assert sliding.machines == ("r",)
    assert sliding.surfaces == ("x1.q = 0",)
    assert set(sliding.modes) == {(0,), (1,)}
    for t in np.linspace(0.67, 2.0, 50):
        assert abs(run["x1.q"].at(float(t))) < 1e-15
    assert run["x1.q"].at(0.5) == pytest.approx(-0.25, abs=1e-14)
    # the average of the switching is what keeps it there: -sgn + 0.5 = 0
    assert run["s1.f"].at(1.0) == pytest.approx(0.0, abs=1e-14)
    assert run.weight("r", "above", 1.0) == pytest.approx(0.75, abs=1e-14)
    assert run.weight("r", "below", 1.0) == pytest.approx(0.25, abs=1e-14)
    assert run.weight("r", "below", 0.1) == 1.0
    assert len(run.events) == 2


def test_the_first_event_is_enough() -> None:
    """Nothing is counted: after the one event in which the relay is met nothing happens."""
    run = hb.simulate(constant_drift(), until=2.0)
    fired = [(f.source, f.target) for e in run.events for s in e.steps for f in s.fired]
    assert fired == [("below", "above"), ("above", "sliding")]
    assert "pushed into from both sides" in str(run.events)


def test_a_switch_that_helps_itself_is_crossed() -> None:
    run = hb.simulate(constant_drift("2", -1.0), until=2.0)
    # x' = 3 below, 1 above
    assert run.sliding == ()
    assert run["x1.q"].at(2.0) == pytest.approx(2.0 - 1.0 / 3.0, abs=1e-12)


def test_the_motion_leaves_when_the_disturbance_wins() -> None:
    """x' = -sgn(x) + t slides until t = 1, then x = (t - 1)^2 / 2."""
    run = hb.simulate(constant_drift("time"), until=2.0)
    (sliding,) = run.sliding
    # x = -1 + t + t^2/2 reaches zero at sqrt(3) - 1
    assert sliding.t0 == pytest.approx(np.sqrt(3.0) - 1.0, abs=1e-11)
    assert sliding.t1 == pytest.approx(1.0, abs=1e-11)
    assert run["x1.q"].at(2.0) == pytest.approx(0.5, abs=1e-11)
    assert run.weight("r", "above", 0.9) == pytest.approx(0.95, abs=1e-12)
    assert run.mode == {"r": "above"}
    last = run.events[-1].steps[-1].fired[-1]
    assert (last.source, last.target) == ("sliding", "above")


def test_it_leaves_to_the_other_side_and_comes_back() -> None:
    """d = 1.5 cos t: slides where |d| < 1, else x' = d -+ 1 exactly."""
    run = hb.simulate(constant_drift("1.5*cos(time/(1 s))", 0.0), until=6.0, rtol=1e-12)
    off = np.arccos(2.0 / 3.0)
    # starts above (d = 1.5 > 1) until x = 1.5 sin t - t is back at zero
    back = solve_for(lambda t: 1.5 * np.sin(t) - t, 1.0, 2.0)
    first, *rest = run.sliding
    assert first.t0 == pytest.approx(back, abs=1e-10)
    # below -1 from pi - off on
    assert first.t1 == pytest.approx(np.pi - off, abs=1e-10)
    leave = np.pi - off
    again = solve_for(
        lambda t: 1.5 * (np.sin(t) - np.sin(leave)) + (t - leave), leave + 0.5, leave + 3.0
    )
    assert rest[0].t0 == pytest.approx(again, abs=1e-10)
    assert len(run.sliding) == 2
    t = leave + 0.7
    x = 1.5 * (np.sin(t) - np.sin(leave)) + (t - leave)
    assert run["x1.q"].at(t) == pytest.approx(x, abs=1e-10)


def solve_for(f, low: float, high: float) -> float:
    from scipy.optimize import brentq

    return float(brentq(f, low, high, xtol=1e-14, rtol=1e-14))


def test_energy_and_power_balance_while_sliding() -> None:
    """Friction: what the average force takes out of the mass is what the source absorbs."""
    m = constant_drift("0.5*cos(3*time/(1 s))", -1.0)
    run = hb.simulate(m, until=2.0)
    assert run.audit().holds()


# -- sliding mode control


def controller(disturbance: str, *, x: float = 1.0, v: float = 0.0) -> hb.Model:
    """x'' = u + d with u = -2 sgn(s), s = v + 1.5 x, as mass, position and force."""
    m = hb.Model("control", domain="translational", parameters={"c": "1.5 1/s", "u_max": "2 N"})
    m.add(
        mass=hb.I("1 kg", f=v),
        force=hb.Se(f"-u_max*{signum('switch')}"),
        d=hb.Se(disturbance),
        v=hb.One(),
    )
    m.bond("force -> v -> mass", "d -> v")
    m.signal(x=hb.Integral("v.f", start=f"{x} m"))
    m.machine(
        "switch",
        states={"above": [], "below": []},
        start="above",
        rules=[
            "above -> below when v.f + c*x < 0",
            "below -> above when v.f > -c*x",
        ],
    )
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", ["rk45", "radau"])
def test_sliding_mode_control_of_a_double_integrator(solver: str) -> None:
    """On the surface v = -c x: x decays as exp(-c t), and s stays at rounding."""
    run = hb.simulate(controller("0"), until=4.0, rtol=1e-11, solver=solver)
    (sliding,) = run.sliding
    # before: x = 1 - t^2, v = -2 t; s = 0 at 1.5 t^2 + 2 t - 1.5 = 0
    t0 = (-2.0 + np.sqrt(4.0 + 9.0)) / 3.0
    assert sliding.t0 == pytest.approx(t0, abs=1e-10)
    x0 = 1.0 - t0**2
    t = np.linspace(t0, 4.0, 77)[1:]
    x = run["x"].at(t)
    assert x == pytest.approx(x0 * np.exp(-1.5 * (t - t0)), rel=1e-9)
    v = run["v.f"].at(t)
    assert np.abs(v + 1.5 * x).max() < 1e-15
    # the equivalent force is that of v' = -c v
    assert run["force.e"].at(t) == pytest.approx(-1.5 * v, rel=1e-8)
    assert run.audit().holds(1e-11)


def test_the_controller_loses_where_the_disturbance_outgrows_it() -> None:
    """The equivalent control is u = -c v - d: it leaves where that reaches -u_max."""
    run = hb.simulate(controller("0.5 [N/s]*time"), until=6.0, rtol=1e-11)
    (sliding,) = run.sliding
    t0, t1 = sliding.t0, sliding.t1
    # the way to the surface: x = 1 - t^2 + t^3/12, v = -2 t + t^2/4
    s0 = solve_for(lambda t: -2 * t + t**2 / 4 + 1.5 * (1 - t**2 + t**3 / 12), 0.2, 1.0)
    assert t0 == pytest.approx(s0, abs=1e-10)
    x0 = 1.0 - t0**2 + t0**3 / 12.0
    v = lambda t: -1.5 * x0 * np.exp(-1.5 * (t - t0))  # noqa: E731
    assert t1 == pytest.approx(solve_for(lambda t: 0.5 * t + 1.5 * v(t) - 2.0, 2.0, 6.0), abs=1e-9)
    # afterwards full force, still too little
    dt = 6.0 - t1
    after = v(t1) + 0.25 * (36.0 - t1**2) - 2.0 * dt
    assert run["v.f"].at(6.0) == pytest.approx(after, abs=1e-9)
    assert run.mode == {"switch": "above"}


# -- relay feedback


def relay_system(a: np.ndarray, b: np.ndarray, x0: list[float]) -> hb.Model:
    rates = []
    for row, gain in zip(a, b, strict=True):
        terms = [f"{c}*x{k}.q" for k, c in enumerate(row, 1) if c]
        rates.append(" + ".join([*terms, f"{-gain}*{signum('relay')}"]))
    m = system(rates, x0)
    add_relay(m, "relay", "x1.q", "above" if x0[0] > 0 else "below")
    return m


def filippov(a: np.ndarray, b: np.ndarray, x0: list[float], until: float):
    """Integrate x' = A x - B sgn(x1) event by event, sliding included; return (pieces, x)."""
    c = np.zeros(len(b))
    c[0] = 1.0
    t, x = 0.0, np.array(x0)
    u = -np.sign(x[0])
    pieces = []
    for _ in range(500):
        if u is not None:
            crossing = lambda s, z: z[0]  # noqa: E731
            crossing.terminal, crossing.direction = True, u
            events = [crossing]
            force = u
            f = lambda s, z: a @ z + b * force  # noqa: E731, B023
        else:
            f = lambda s, z: a @ z - b * (c @ a @ z) / (c @ b)  # noqa: E731
            leave = [lambda s, z, k=k: -(c @ a @ z) / (c @ b) - k for k in (-1.0, 1.0)]
            for e, way in zip(leave, (-1.0, 1.0), strict=True):
                e.terminal, e.direction = True, way
            events = leave
        done = solve_ivp(f, (t, until), x, method="DOP853", rtol=1e-11, atol=1e-13, events=events)
        pieces.append((t, done.t[-1], u))
        t, x = done.t[-1], done.y[:, -1]
        if done.status == 0:
            return pieces, x
        x[0] = 0.0
        if u is None:
            u = -1.0 if len(done.t_events[0]) else 1.0
        else:
            low, high = c @ a @ x + c @ b, c @ a @ x - c @ b
            # y' with u = +1 (below) and u = -1 (above)
            u = None if low > 0 > high else -u
    raise AssertionError("too many events")


def test_the_fourth_order_relay_of_pole_excess_two_switches_fast_but_does_not_slide() -> None:
    """Its input enters y'' first: a surface is crossed, however often."""
    a = np.array([[0, 1, 0, 0], [-6, 0, 1, 0], [-4, 0, 0, 1], [-1, 0, 0, 0]], dtype=float)
    b = np.array([0.0, 1.0, -0.4, 0.04])
    x0 = [-0.01, -0.02, -1.0, 0.5]
    pieces, x = filippov(a, b, x0, 5.0)
    run = hb.simulate(relay_system(a, b, x0), until=5.0, rtol=1e-11)
    assert run.sliding == ()
    times = [e.t for e in run.events][1:]
    assert len(times) == len(pieces) - 1 == 23
    assert times == pytest.approx([p[0] for p in pieces[1:]], abs=1e-8)
    assert [run.final[f"x{k}.q"] for k in range(1, 5)] == pytest.approx(x, abs=1e-8)


@pytest.mark.slow
def test_a_relay_oscillation_with_sliding_parts() -> None:
    """Third order, pole excess one (Di Bernardo, Johansson & Vasca 2001): slides in each half."""
    zeta, omega, lam, sigma, rho = 0.05, 10.0, 1.0, -1.0, 1.0
    a = np.array(
        [
            [-(2 * zeta * omega + lam), 1, 0],
            [-(2 * zeta * omega * lam + omega**2), 0, 1],
            [-lam * omega**2, 0, 0],
        ],
        dtype=float,
    )
    b = np.array([1.0, 2 * sigma * rho, rho**2])
    x0 = [0.05, -0.01, 0.1]
    pieces, x = filippov(a, b, x0, 12.0)
    expected = [(t0, t1) for t0, t1, u in pieces if u is None]
    assert len(expected) >= 4
    run = hb.simulate(relay_system(a, b, x0), until=12.0, rtol=1e-11)
    found = [(s.t0, s.t1) for s in run.sliding]
    assert np.array(found) == pytest.approx(np.array(expected), abs=1e-8)
    assert [run.final[f"x{k}.q"] for k in range(1, 4)] == pytest.approx(x, abs=1e-8)
    middle = [0.5 * (t0 + t1) for t0, t1 in found]
    assert np.abs(run["x1.q"].at(middle)).max() < 1e-16


# -- several surfaces


def two_relays(x0: list[float], coupling: float = 0.3) -> hb.Model:
    one, two = signum("r1"), signum("r2")
    m = system([f"-2*{one} + 0.5 - {coupling}*{two}", f"-1.5*{two} - 0.25 + 0.2*{one}"], x0)
    for k in (1, 2):
        add_relay(m, f"r{k}", f"x{k}.q", "above" if x0[k - 1] > 0 else "below")
    return m


def test_two_surfaces_at_once_the_second_met_while_sliding_on_the_first() -> None:
    run = hb.simulate(two_relays([-0.5, 2.0]), until=4.0)
    # on both: 2 s1 + 0.3 s2 = 0.5, -0.2 s1 + 1.5 s2 = -0.25
    s1, s2 = np.linalg.solve([[2.0, 0.3], [-0.2, 1.5]], [0.5, -0.25])
    first, second = run.sliding
    # x1' = 2 + 0.5 - 0.3 = 2.2 to the first surface; x2' = -1.95 meanwhile
    t0 = 0.5 / 2.2
    assert first.t0 == pytest.approx(t0, abs=1e-12)
    # then s1 = 0.1 with s2 = 1: x2' = -1.5 - 0.25 + 0.02
    t1 = t0 + (2.0 - 1.95 * t0) / 1.73
    assert first.t1 == second.t0 == pytest.approx(t1, abs=1e-11)
    assert run.weight("r1", "above", 0.5 * (t0 + t1)) == pytest.approx(0.55, abs=1e-13)
    assert second.machines == ("r1", "r2")
    assert second.kind == "additive"
    assert len(second.modes) == 3
    assert run.weight("r1", "above", 3.0) == pytest.approx(0.5 * (1 + s1), abs=1e-13)
    assert run.weight("r2", "above", 3.0) == pytest.approx(0.5 * (1 + s2), abs=1e-13)
    for t in (t1 + 1e-3, 2.5, 4.0):
        assert abs(run["x1.q"].at(t)) < 1e-15
        assert abs(run["x2.q"].at(t)) < 1e-15


def test_surfaces_are_left_one_by_one() -> None:
    """x1' = -sgn x1 + t/2 - 0.2 sgn x2, x2' = -sgn x2 + t: the second goes first."""
    one, two = signum("r1"), signum("r2")
    m = system([f"-{one} + time/2 - 0.2*{two}", f"-{two} + time"], [0.0, 0.0])
    add_relay(m, "r1", "x1.q")
    add_relay(m, "r2", "x2.q")
    run = hb.simulate(m, until=3.0)
    both, first = run.sliding
    assert both.t0 == 0.0
    assert both.machines == ("r1", "r2")
    assert both.t1 == pytest.approx(1.0, abs=1e-11)
    assert first.machines == ("r1",)
    # s2 = 1 now: s1 = t/2 - 0.2 reaches 1 at 2.4
    assert first.t1 == pytest.approx(2.4, abs=1e-11)
    assert run["x2.q"].at(3.0) == pytest.approx(2.0, abs=1e-10)
    assert run["x1.q"].at(3.0) == pytest.approx((9.0 - 2.4**2) / 4 - 1.2 * 0.6, abs=1e-10)


def test_fields_that_are_not_additive_take_the_product_combination() -> None:
    """x1' = -sgn x1 + 0.5 + 0.4 sgn x1 sgn x2, x2' = -sgn x2 + 0.2: s1 (1 - 0.4 s2) = 0.5."""
    one, two = signum("r1"), signum("r2")
    m = system([f"-{one} + 0.5 + 0.4*{one}*{two}", f"-{two} + 0.2"], [-0.1, -1.0])
    add_relay(m, "r1", "x1.q")
    add_relay(m, "r2", "x2.q")
    run = hb.simulate(m, until=3.0)
    last = run.sliding[-1]
    assert last.kind == "product"
    assert len(last.modes) == 4
    assert run.weight("r2", "above", 2.5) == pytest.approx(0.6, abs=1e-12)
    s1 = 0.5 / (1.0 - 0.4 * 0.2)
    assert run.weight("r1", "above", 2.5) == pytest.approx(0.5 * (1 + s1), abs=1e-12)
    assert abs(run["x1.q"].at(2.5)) < 1e-14


@pytest.mark.slow
def test_twenty_relays_slide_at_once_within_seconds() -> None:
    n = 20
    drift = np.linspace(-0.8, 0.8, n)
    start = np.linspace(1.0, 2.0, n) * np.where(np.arange(n) % 2, 1.0, -1.0)
    m = system([f"-{signum(f'r{k}')} + {d}" for k, d in enumerate(drift, 1)], list(start))
    for k in range(1, n + 1):
        add_relay(m, f"r{k}", f"x{k}.q", "above" if start[k - 1] > 0 else "below")
    began = time.perf_counter()
    run = hb.simulate(m, until=12.0)
    assert time.perf_counter() - began < 15.0
    assert run.status == "ok"
    assert len(run.sliding) == n
    assert run.sliding[-1].kind == "additive"
    assert len(run.sliding[-1].modes) == n + 1
    arrival = np.abs(start) / (1.0 + np.sign(-start) * drift)
    assert [s.t0 for s in run.sliding] == pytest.approx(sorted(arrival), abs=1e-10)
    for k, d in enumerate(drift, 1):
        assert run.weight(f"r{k}", "above", 12.0) == pytest.approx(0.5 * (1 + d), abs=1e-12)
        assert abs(run.final[f"x{k}.q"]) < 1e-14


# -- what is watched while sliding


def test_other_machines_are_watched_on_the_averages() -> None:
    """A second machine opens when the averaged force has been there long enough."""
    m = system([f"-{signum('r')} + 0.5", f"s1.f + {signum('r')}"], [-1.0, 0.0])
    add_relay(m, "r", "x1.q")
    m.machine(
        "alarm",
        states={"calm": [], "loud": []},
        start="calm",
        rules=["calm -> loud when x2.q > 1"],
    )
    run = hb.simulate(m, until=4.0)
    # s1.f + sgn = 0.5 before and while sliding: average of the switching is 0.5, s1.f 0
    loud = next(e.t for e in run.events for s in e.steps for f in s.fired if f.machine == "alarm")
    assert loud == pytest.approx(2.0, abs=1e-11)
    assert len(run.sliding) == 1
    assert run.sliding[0].t1 == 4.0


def test_timed_events_are_hit_while_sliding_and_may_end_it() -> None:
    m = system([f"-{signum('r')} + d"], [-1.0])
    m.input(d=hb.Input(table=[[0, 0.5], [1.0, -0.25], [2.0, 3.0], [3.0, -3.0], [4.0, 0.0]]))
    add_relay(m, "r", "x1.q")
    run = hb.simulate(m, until=6.0)
    first, second = run.sliding
    assert (first.t0, first.t1) == pytest.approx((2.0 / 3.0, 2.0), abs=1e-12)
    assert run.weight("r", "above", 0.8) == pytest.approx(0.75, abs=1e-13)
    assert run.weight("r", "above", 1.5) == pytest.approx(0.375, abs=1e-13)
    left = next(e for e in run.events if e.t == 2.0)
    assert left.cause == "input"
    # out at speed 2 for a second, back at speed 4, through at 3.5, at speed 2 to -1, back at 1
    assert run["x1.q"].at([3.0, 3.5, 4.0]) == pytest.approx([2.0, 0.0, -1.0], abs=1e-12)
    assert (second.t0, second.t1) == pytest.approx((5.0, 6.0), abs=1e-12)


def test_a_rule_to_a_third_state_is_watched_in_both() -> None:
    m = system([f"-{signum('r')} + 0.5", "1"], [-1.0, 0.0])
    m.machine(
        "r",
        states={"above": [], "below": [], "off": []},
        start="below",
        rules=[
            "above -> below when x1.q < 0",
            "below -> above when x1.q > 0",
            "above -> off when x2.q > 2",
            "below -> off when x2.q > 2",
        ],
    )
    run = hb.simulate(m, until=3.0)
    (sliding,) = run.sliding
    assert sliding.t1 == pytest.approx(2.0, abs=1e-11)
    assert run.mode == {"r": "off"}
    # off is not above: the force is +1
    assert run["x1.q"].at(3.0) == pytest.approx(1.5, abs=1e-11)


def test_what_else_a_rule_asks_for_allows_the_sliding_and_ends_it() -> None:
    """The relay may go up only while x2 < 2: then it stays below, and x grows through zero."""
    m = system([f"-{signum('r')} + 0.5", "1"], [-1.0, 0.0])
    m.machine(
        "r",
        states={"above": [], "below": []},
        start="below",
        rules=["above -> below when x1.q < 0", "below -> above when x1.q > 0 and x2.q < 2"],
    )
    run = hb.simulate(m, until=3.0)
    (sliding,) = run.sliding
    assert (sliding.t0, sliding.t1) == pytest.approx((2.0 / 3.0, 2.0), abs=1e-11)
    assert run["x1.q"].at(3.0) == pytest.approx(1.5, abs=1e-11)
    assert run.mode == {"r": "below"}


# -- what is no sliding


def test_a_hysteresis_in_the_guards_gives_a_relaxation_cycle() -> None:
    m = system([f"-{signum('r')} + 0.5"], [-1.0])
    m.machine(
        "r",
        states={"above": [], "below": []},
        start="below",
        rules=["above -> below when x1.q < -0.01", "below -> above when x1.q > 0.01"],
    )
    run = hb.simulate(m, until=2.0)
    assert run.sliding == ()
    gaps = np.diff([e.t for e in run.events][1:])
    assert gaps[::2] == pytest.approx(0.02 / 0.5, rel=1e-9)
    assert gaps[1::2] == pytest.approx(0.02 / 1.5, rel=1e-9)


def test_the_same_cycle_by_the_option_around_the_surface() -> None:
    run = hb.simulate(constant_drift(), until=2.0, sliding="hysteresis", hysteresis=0.01)
    assert run.sliding == ()
    gaps = np.diff([e.t for e in run.events][1:])
    assert gaps[::2] == pytest.approx(0.02 / 0.5, rel=1e-9)
    assert gaps[1::2] == pytest.approx(0.02 / 1.5, rel=1e-9)
    assert np.abs(run["x1.q"].at([1.0, 1.5, 2.0])).max() <= 0.01 + 1e-12


def test_the_cycle_shrinks_onto_the_sliding_motion() -> None:
    """Filippov's motion is the limit of switching in a band: the error is of the band's order."""
    slid = hb.simulate(controller("0"), until=1.2)
    errors = []
    for band in (1e-2, 1e-3):
        run = hb.simulate(controller("0"), until=1.2, sliding="hysteresis", hysteresis=band)
        errors.append(abs(run["x"].at(1.2) - slid["x"].at(1.2)))
        assert errors[-1] < 2.0 * band
    assert errors[1] < 0.2 * errors[0]


def test_refusing_to_slide_stops_where_the_events_accumulate() -> None:
    run = hb.simulate(constant_drift(), until=2.0, sliding="refuse")
    assert run.status == "accumulation"
    assert run.t_end == pytest.approx(2.0 / 3.0, abs=1e-6)
    assert run.sliding == ()


@pytest.mark.parametrize(
    "options",
    [{"sliding": "slow"}, {"sliding": "hysteresis"}, {"hysteresis": 0.1}],
)
def test_options_that_do_not_belong_are_refused(options: dict) -> None:
    with pytest.raises(hb.UsageError, match="HB-S111"):
        hb.simulate(constant_drift(), until=1.0, **options)


def test_the_experiment_says_the_same_as_the_option() -> None:
    text = hb.dumps(constant_drift())
    more = '[experiment]\nuntil = 2\nsliding = "hysteresis"\nhysteresis = 0.01\n'
    assert "[experiment]" not in text
    run = hb.simulate(hb.loads(text + "\n" + more))
    other = hb.simulate(constant_drift(), until=2.0, sliding="hysteresis", hysteresis=0.01)
    assert [e.t for e in run.events] == [e.t for e in other.events]


def test_two_futures_are_told_where_both_sides_push_away() -> None:
    """x' = sgn(x) from zero: up, down, or resting unstably. The start state decides, aloud."""
    for state, end in (("above", 1.0), ("below", -1.0)):
        m = system([signum("r")], [0.0])
        add_relay(m, "r", "x1.q", state)
        run = hb.simulate(m, until=1.0)
        assert run.sliding == ()
        assert run["x1.q"].at(1.0) == pytest.approx(end, abs=1e-12)
        assert any("not unique" in w for w in run.warnings)


def test_a_start_on_the_surface_slides_at_once_whatever_the_start_state() -> None:
    for state in ("above", "below"):
        m = constant_drift("0.25", 0.0)
        m.machines["r"] = type(m.machines["r"])(
            m.machines["r"].states, state, m.machines["r"].rules
        )
        run = hb.simulate(m, until=1.0)
        (sliding,) = run.sliding
        assert (sliding.t0, sliding.t1) == (0.0, 1.0)
        assert np.abs(run["x1.q"].y).max() == 0.0
        assert not any("not unique" in w for w in run.warnings)


def test_a_switching_function_that_the_switch_makes_jump_is_no_surface() -> None:
    """y = x + 0.1 sgn' jumps the way of a hysteresis: a cycle between x = -0.1 and 0.1."""
    m = system([f"-{signum('r')}"], [-1.0])
    add_relay(m, "r", 'x1.q + 0.1*(if r.state == "above" then 1 else -1)')
    run = hb.simulate(m, until=2.0)
    assert run.sliding == ()
    times = [e.t for e in run.events][1:]
    assert times[:3] == pytest.approx([1.1, 1.3, 1.5], abs=1e-10)


# -- physical models


def tank(inflow: str = "8 l/s") -> hb.Model:
    m = hb.Model("tank", domain="hydraulic")
    m.parameter(L="0.8 m", A="0.5 m^2", rho_g="9810 Pa/m", k="4e-5 [m^3/(s*Pa^(1/2))]")
    m.add(
        inflow=hb.Sf(inflow),
        tank=hb.C("A/rho_g", q="0.2 m^3"),
        outlet=hb.R({"f": "k*e/sqrt(abs(e))"}),
        spill=hb.R("1e5 Pa*s/m^3"),
        bottom=hb.Zero(),
        weir=hb.One(),
    )
    m.bond("inflow -> bottom -> tank", "bottom -> outlet", "bottom -> weir -> spill")
    m.signal(level="tank.q/A")
    m.machine(
        "gate",
        states={"dry": [], "over": ["weir"]},
        start="dry",
        rules=["dry -> over when level > L", "over -> dry when level <= L"],
    )
    return m


def test_a_tank_with_an_overflow_without_inertia_stays_at_its_edge() -> None:
    run = hb.simulate(tank(), until=300.0)
    assert run.status == "ok"
    (sliding,) = run.sliding
    assert sliding.t1 == 300.0
    # filling: A L' = q - k sqrt(rho g L), exactly integrable in w = sqrt(L)
    q, k = 8e-3, 4e-5 * np.sqrt(9810.0)
    fill = lambda w: -2 * 0.5 * (w / k + q / k**2 * np.log(q - k * w))  # noqa: E731
    assert sliding.t0 == pytest.approx(fill(np.sqrt(0.8)) - fill(np.sqrt(0.4)), rel=1e-8)
    t = np.linspace(sliding.t0, 300.0, 40)[1:]
    assert np.abs(run["level"].at(t) - 0.8).max() < 1e-15
    # the overflow takes on average what the outlet leaves
    assert run["spill.f"].at(200.0) == pytest.approx(q - k * np.sqrt(0.8), rel=1e-12)
    assert run.weight("gate", "over", 200.0) == pytest.approx(
        (q - k * np.sqrt(0.8)) / (0.8 * 9810.0 / 1e5), rel=1e-12
    )
    assert run.audit().holds()


def test_dry_friction_of_two_states_sticks_and_breaks_away() -> None:
    """A block on a floor, pulled by a spring whose end moves: it sticks while |k u| < F."""
    m = hb.Model("block", domain="translational", parameters={"F": "2 N", "k": "4 N/m"})
    m.add(
        block=hb.I("1 kg", f=-0.5),
        spring=hb.C("1/k"),
        rub=hb.Se('if slip.state == "forward" then -F else F'),
        v=hb.One(),
        hand=hb.Sf("1 m/s"),
        node=hb.Zero(),
    )
    m.bond("hand -> node -> spring", "node -> v -> block", "rub -> v")
    m.machine(
        "slip",
        states={"forward": [], "backward": []},
        start="backward",
        rules=["forward -> backward when v.f < 0", "backward -> forward when v.f > 0"],
    )
    run = hb.simulate(m, until=3.0, rtol=1e-11)
    # v' = F + k u, u' = 1 - v, from v = -1/2, u = 0: about u = -F/k with w = 2
    # u = -1/2 + a cos 2t + b sin 2t with a = 1/2, b = 3/4 (u' = 3/2)
    stop = solve_for(lambda t: 1.0 + np.sin(2 * t) - 1.5 * np.cos(2 * t), 0.0, 0.5)
    first, *_ = run.sliding
    assert first.t0 == pytest.approx(stop, abs=1e-10)
    u0 = -0.5 + 0.5 * np.cos(2 * stop) + 0.75 * np.sin(2 * stop)
    assert abs(4.0 * u0) < 2.0
    # sticks until k u = F: u grows by 1 m/s
    assert first.t1 == pytest.approx(stop + 0.5 - u0, abs=1e-9)
    t = 0.5 * (first.t0 + first.t1)
    assert abs(run["v.f"].at(t)) < 1e-15
    # the average of the friction force balances the spring
    assert run["rub.e"].at(t) == pytest.approx(-4.0 * (u0 + t - stop), rel=1e-9)
    # then v = 1 - cos 2 (t - t1): it slips, and stops again a turn later
    t = first.t1 + 0.8
    assert run["v.f"].at(t) == pytest.approx(1.0 - np.cos(1.6), abs=1e-8)
    assert run.audit().holds(1e-11)


def test_a_function_of_a_resistors_flow_slides_as_well() -> None:
    """The switch reads a bond variable that no storage gives: r.f = (c.e - 1)/R."""
    m = hb.Model("measured", domain="electrical")
    m.add(
        c=hb.C("1 F", e="3 V"),
        r=hb.R("2 ohm"),
        bias=hb.Se("1 V"),
        pump=hb.Sf('if r1.state == "above" then -3 A else 1 A'),
        n=hb.Zero(),
        i=hb.One(),
    )
    m.bond("pump -> n -> c", "n -> i -> r", "i -> bias")
    m.machine(
        "r1",
        states={"above": [], "below": []},
        start="above",
        rules=["above -> below when r.f < 0.25 [A]", "below -> above when r.f > 0.25 [A]"],
    )
    run = hb.simulate(m, until=3.0)
    (sliding,) = run.sliding
    # e' = -3 - (e - 1)/2: e = -5 + 8 exp(-t/2) reaches 1.5
    assert sliding.t0 == pytest.approx(-2 * np.log(6.5 / 8.0), abs=1e-9)
    assert run["c.e"].at(2.0) == pytest.approx(1.5, abs=1e-12)
    # mean of the pump is what the resistor takes
    assert run["pump.f"].at(2.0) == pytest.approx(0.25, abs=1e-10)


def test_a_switching_signal_is_shown_as_its_average() -> None:
    m = constant_drift()
    m.signal(u=signum("r"))
    run = hb.simulate(m, until=2.0)
    assert run["u"].at(1.5) == pytest.approx(0.5, abs=1e-14)
    assert run["u"].at(0.1) == -1.0


# -- the decision


@pytest.mark.parametrize(
    ("up", "down", "slides"),
    [
        ("x1.q > 0", "x1.q < 0", True),
        ("x1.q >= 0", "0 > x1.q", True),
        ("not (x1.q <= 0)", "-x1.q > 0", True),
        ("x1.q > 2 + x2.q", "x1.q - x2.q < 2", True),
        ("x1.q > 1e-9", "x1.q < 0", False),
        ("x1.q > 1e-9", "x1.q < 1.0000001e-9", False),
        ("x1.q > 0", "x2.q < 0", False),
        ("x1.q > 0 or x2.q > 0", "x1.q < 0", False),
        ("pre(x1.q) > 0", "x1.q < 0", True),
    ],
)
def test_what_is_a_switching_surface(up: str, down: str, slides: bool) -> None:
    m = system(["0", "0"], [0.0, 0.0])
    m.machine(
        "r",
        states={"above": [], "below": []},
        start="below",
        rules=[f"below -> above when {up}", f"above -> below when {down}"],
    )
    assert bool(tables_of(m.flatten(), until=1.0).numbers["surfaces"]) is slides


def test_a_blow_ends_sticking_and_the_joined_bodies_stick_again() -> None:
    """A block held by friction is hit plastically: momentum is conserved, then F brakes both."""
    m = hb.Model("blow", domain="translational", parameters={"F": "3 N", "t_hit": "0.5 s"})
    m.add(
        block=hb.I("1 kg"),
        striker=hb.I("1 kg", f=2.0),
        pull=hb.Se("1 N"),
        rub=hb.Se('if slip.state == "forward" then -F else F'),
        v=hb.One(),
        w=hb.One(),
        contact=hb.Zero(),
    )
    m.bond("pull -> v -> block", "rub -> v", "w -> striker", "w -> contact -> v")
    m.machine(
        "slip",
        states={"forward": [], "backward": []},
        start="forward",
        rules=["forward -> backward when v.f < 0", "backward -> forward when v.f > 0"],
    )
    m.machine(
        "hit",
        states={"apart": [], "joined": ["contact"]},
        start="apart",
        rules=["apart -> joined when time >= t_hit"],
    )
    run = hb.simulate(m, until=2.0, rtol=1e-11)
    first, second = run.sliding
    assert (first.t0, first.t1) == (0.0, 0.5)
    assert run["v.f"].at(0.4) == 0.0
    assert run["rub.e"].at(0.4) == pytest.approx(-1.0, abs=1e-14)
    assert run["v.f"].at(0.5) == pytest.approx(1.0, abs=1e-14)
    # (1 - 3) N over 2 kg
    assert second.t0 == pytest.approx(1.5, abs=1e-11)
    assert second.t1 == 2.0
    assert run["v.f"].at(1.0) == pytest.approx(0.5, abs=1e-12)
    assert abs(run["w.f"].at(1.9)) < 1e-15
    assert run.weight("slip", "forward", 1.9) == pytest.approx(2.0 / 3.0, abs=1e-13)
    assert run.audit().holds(1e-11)


@pytest.mark.slow
def test_a_nonlinear_model_slides_on_a_curved_surface() -> None:
    """x' = -y, y' = x, pulled onto the circle x^2 + y^2 = 1 by a relay along the radius."""
    inward = signum("r")
    m = system(
        [f"-x2.q - 0.5*{inward}*x1.q", f"x1.q - 0.5*{inward}*x2.q"],
        [2.0, 0.0],
    )
    add_relay(m, "r", "(x1.q^2 + x2.q^2 - 1)", "above")
    run = hb.simulate(m, until=6.0, rtol=1e-11)
    (sliding,) = run.sliding
    assert sliding.t0 == pytest.approx(2.0 * np.log(2.0), abs=1e-10)
    t = np.linspace(sliding.t0, 6.0, 50)[1:]
    x, y = run["x1.q"].at(t), run["x2.q"].at(t)
    assert np.abs(x**2 + y**2 - 1.0).max() < 1e-15
    assert x == pytest.approx(np.cos(t), abs=1e-9)
    assert y == pytest.approx(np.sin(t), abs=1e-9)


@pytest.mark.parametrize("first", ["relay", "alarm"])
def test_a_machine_that_only_looks_at_the_surface_does_not_disturb(first: str) -> None:
    """x1' = -sgn x1 + x2 with x2 about cos: an alarm on the same x1 moves nothing."""
    m = system([f"-{signum('relay')} + x2.q", "2*cos(3*time/(1 s)) - 0.1*x2.q"], [-1.0, 0.4])
    names = ["relay", "alarm"] if first == "relay" else ["alarm", "relay"]
    for name in names:
        add_relay(m, name, "x1.q")
    run = hb.simulate(m, until=4.0)
    (sliding,) = run.sliding
    assert sliding.machines == ("relay",)
    assert len(run.events) <= 3
    alone = system([f"-{signum('relay')} + x2.q", "2*cos(3*time/(1 s)) - 0.1*x2.q"], [-1.0, 0.4])
    add_relay(alone, "relay", "x1.q")
    other = hb.simulate(alone, until=4.0)
    assert run.weight("relay", "above", 3.0) == other.weight("relay", "above", 3.0)
    assert run.weight("relay", "above", 3.0) == pytest.approx(
        0.5 * (1.0 + run["x2.q"].at(3.0)), abs=1e-12
    )


# -- Filippov's motion and Utkin's


def squared(control: str) -> hb.Model:
    """x1' = u + 0.5, x2' = u^2: the switch enters the second rate with its square."""
    m = system([f"{control} + 0.5", f"({control})^2"], [0.0, 0.0])
    if "relay" in control:
        add_relay(m, "relay", "x1.q")
    return m


def test_a_square_of_the_switch_is_averaged_as_in_a_band_and_not_at_the_mean_switch() -> None:
    """u jumps between -1 and 1, so u^2 is 1; u held at its mean -0.5 has the square 0.25."""
    filippov = hb.simulate(squared(f"(-{signum('relay')})"), until=1.0)
    assert filippov.final["x2.q"] == pytest.approx(1.0, abs=1e-12)
    band = hb.simulate(
        squared(f"(-{signum('relay')})"), until=1.0, sliding="hysteresis", hysteresis=1e-3
    )
    assert band.final["x2.q"] == pytest.approx(1.0, abs=1e-12)
    # equivalent control is another model: an amplifier that saturates, of high gain
    utkin = hb.simulate(squared("max(-1, min(1, -1e4*x1.q))"), until=1.0, solver="radau")
    assert utkin.final["x2.q"] == pytest.approx(0.25, abs=1e-3)


def test_a_run_goes_on_from_a_sliding_state_as_if_it_had_not_stopped() -> None:
    whole = hb.simulate(constant_drift("0.9*cos(3*time/(1 s))"), until=3.0, rtol=1e-10)
    part = hb.simulate(constant_drift("0.9*cos(3*time/(1 s))"), until=1.9, rtol=1e-10)
    assert part.sliding[-1].t1 == 1.9
    rest = hb.simulate(
        constant_drift("0.9*cos(3*(time + 1.9 [s])/(1 s))", x0=part.final["x1.q"]),
        until=1.1,
        rtol=1e-10,
    )
    assert rest.sliding[0].t0 == 0.0
    for t in (0.2, 0.7, 1.1):
        assert rest.weight("r", "above", t) == pytest.approx(
            whole.weight("r", "above", t + 1.9), abs=1e-12
        )


def relay(rules: list[str], *, start: str, q: float) -> hb.Model:
    """A charge that a relay fills at unit rate while it is low, and empties while it is high."""
    m = hb.Model("relay")
    m.add(c=hb.C(1.0, q=q), u=hb.Sf('if r.state == "low" then 1 else -1'), n=hb.Zero())
    m.bond("u -> n -> c")
    m.input(wanted=hb.Input(table=[(0, 1), (0.5, 1), (0.5, 5)]))
    m.signal(y=hb.Integral("1", start=0))
    m.machine("r", states={"low": [], "high": []}, start=start, rules=rules)
    return m


def test_a_rule_that_fires_for_what_else_it_asks_is_not_on_its_surface() -> None:
    """It turns at 3, not at 0, when the second condition comes true; it slides from t = 5."""
    rules = ["low -> high when c.q > 0 and y > 2", "high -> low when c.q < 0"]
    run = hb.simulate(relay(rules, start="low", q=1.0), until=10.0)
    assert run["c.q"].at(2.0) == pytest.approx(3.0, abs=1e-9)
    assert run["c.q"].at(3.5) == pytest.approx(1.5, abs=1e-9)
    assert [s.t0 for s in run.trace.slidings] == [pytest.approx(5.0, abs=1e-9)]
    assert run["c.q"].at(10.0) == pytest.approx(0.0, abs=1e-9)


def test_an_input_that_jumps_over_a_surface_does_not_lead_there_in_a_program_either(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The charge is 2.5 as what is wanted jumps to 5, which it reaches 2.5 s later."""
    rules = ["low -> high when c.q > wanted", "high -> low when c.q < wanted"]
    model = relay(rules, start="high", q=3.0)
    run = hb.simulate(model, until=2.0)
    program = portable(model, monkeypatch, until=2.0)
    for q in (run["c.q"].at(2.0), program.y[0]):
        assert q == pytest.approx(2.5 + 1.5, abs=1e-9)
    later = portable(model, monkeypatch, until=4.0)
    assert later.y[0] == pytest.approx(5.0, abs=1e-9)
    assert later.events[-1][0] == pytest.approx(3.0, abs=1e-9)
