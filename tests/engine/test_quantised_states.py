"""Quantised states: error bounds, numbers of events, stiffness, sources, and whole models."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from export.programs import ask, compile_quickly, expected, needs_c, read_events
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import hybond as hb

EXAMPLES = Path(__file__).parents[2] / "examples"
NAMES = ["qss1", "qss2", "qss3", "liqss1", "liqss2", "liqss3"]
DECAY = np.array([[-1.0]])
DAMPED = np.array([[0.0, 1.0], [-4.0, -0.8]])
TRIANGLE = np.array([[-1.0, 0.5, 0.0], [0.0, -2.0, 1.0], [0.3, 0.0, -0.5]])
STIFF = np.array([[0.0, 1.0], [-1e5, -1e5 - 1.0]])
"""Eigenvalues -1 and -1e5."""


def field(rates: list[str], start: list[float]) -> hb.Model:
    """Return a model that is nothing but signals x0, x1, ... with these rates."""
    m = hb.Model("field")
    pairs = zip(rates, start, strict=True)
    m.signal(**{f"x{k}": hb.Integral(rate, start=at) for k, (rate, at) in enumerate(pairs)})
    return m


def linear(matrix: np.ndarray, start: list[float]) -> hb.Model:
    rates = [" + ".join(f"({c!r})*x{k}" for k, c in enumerate(row)) for row in matrix.tolist()]
    return field(rates, start)


def by(name: str, model: hb.Model, until: float, tol: float, **options: Any) -> hb.Result:
    """Return a run whose quanta are `tol`, whatever the size of the states."""
    options = {"rtol": 1e-13, "atol": tol, **options}
    return hb.simulate(model, until, solver=name, engine="library", **options)


def course(run: hb.Result, parts: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """Return times, ends of steps and others between, and all states there."""
    ends = np.unique(np.concatenate([s.t for s in run.segments]))
    many = max(len(ends) // 300, 1)
    ends = ends[::many]
    t = np.concatenate([ends[:-1] + k / parts * np.diff(ends) for k in range(parts)] + [ends[-1:]])
    return t, np.array([run[f"x{k}"].at(t) for k in range(len(run.segments[0].y[0]))])


def exact(matrix: np.ndarray, t: np.ndarray, start: list[float]) -> np.ndarray:
    return np.array([expm(matrix * a) @ start for a in t]).T


def kofman(matrix: np.ndarray, quantum: float) -> np.ndarray:
    """Return the bound of Kofman 2002: ``|V| |Re(L)^-1 L| |V^-1| dQ``."""
    values, vectors = np.linalg.eig(matrix)
    gain = np.abs(vectors) @ np.diag(np.abs(values / values.real)) @ np.abs(np.linalg.inv(vectors))
    bound: np.ndarray = gain @ np.full(len(matrix), quantum)
    return bound


def tolerance_of(name: str) -> float:
    return {"1": 1e-2, "2": 1e-4, "3": 1e-6}[name[-1]]


def steps(run: hb.Result) -> int:
    return int(run.stats["steps"])


@pytest.mark.parametrize("matrix", [DECAY, DAMPED, TRIANGLE], ids=["decay", "damped", "triangle"])
@pytest.mark.parametrize("name", NAMES)
def test_linear_systems_stay_within_kofmans_bound_at_all_times(
    name: str, matrix: np.ndarray
) -> None:
    tol = tolerance_of(name)
    start = [1.0, -0.7, 0.4][: len(matrix)]
    t, x = course(by(name, linear(matrix, start), 6.0, tol))
    worst = np.abs(x - exact(matrix, t, start)).max(axis=1)
    assert (worst <= kofman(matrix, tol)).all()
    # and it is quantisation that is measured, not something far more exact
    assert worst.max() > 1e-2 * tol


@pytest.mark.parametrize(("name", "copies"), [*((n, 2) for n in NAMES), ("liqss2", 3)])
def test_equal_states_whose_events_are_at_once_are_as_exact_as_one(name: str, copies: int) -> None:
    """Copies of an oscillator that all drive one more state: what one alone does, times as many."""
    one = np.array([[0.0, 1.0, 0.0], [-4.0, -0.1, 0.0], [1.0, 0.0, -0.02]])
    many = np.zeros((2 * copies + 1, 2 * copies + 1))
    for k in range(copies):
        many[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = one[:2, :2]
        many[-1, 2 * k] = 1.0 / copies
    many[-1, -1] = one[2, 2]
    tol = tolerance_of(name)
    alone = by(name, linear(one, [1.0, 0.0, 0.0]), 15.0, tol)
    run = by(name, linear(many, [1.0, 0.0] * copies + [0.0]), 15.0, tol)
    assert steps(run) == pytest.approx(steps(alone), rel=0.03)
    t, x = course(run, 1)
    worst = np.abs(x[-1] - exact(one, t, [1.0, 0.0, 0.0])[2]).max()
    assert worst <= kofman(one, tol)[2]


@pytest.mark.parametrize("name", NAMES)
def test_a_law_that_is_not_linear_stays_within_that_bound_where_it_is_straight(name: str) -> None:
    """The same decay, written so that no form is found: rates are fitted."""
    tol = tolerance_of(name)
    run = by(name, field(["-x0*x0/x0"], [1.0]), 3.0, tol)
    t, x = course(run)
    assert run.stats["evaluations"] > steps(run)
    assert np.abs(x[0] - np.exp(-t)).max() <= 1.1 * tol


@pytest.mark.parametrize("name", NAMES)
def test_the_number_of_events_grows_with_the_order(name: str) -> None:
    order = int(name[-1])
    coarse = {1: 1e-2, 2: 1e-3, 3: 1e-5}[order]
    counts = [steps(by(name, linear(DAMPED, [1.0, 0.0]), 4.0, t)) for t in (coarse, coarse / 10.0)]
    assert math.log10(counts[1] / counts[0]) == pytest.approx(1.0 / order, rel=0.12)


@pytest.mark.parametrize("name", ["liqss1", "liqss2", "liqss3"])
@pytest.mark.parametrize("straight", [True, False])
def test_linearly_implicit_methods_do_not_see_the_fast_time_constant(
    name: str, straight: bool
) -> None:
    tol = {1: 1e-3, 2: 1e-5, 3: 1e-6}[int(name[-1])]
    model = linear(STIFF, [1.0, 0.0])
    if not straight:
        model = field(["x1", "-1e5*x0*x0/x0 - 100001*x1"], [1.0, 0.0])
    run = by(name, model, 5.0, tol)
    slow = by(name, linear(DECAY, [1.0]), 5.0, tol)
    # one or two events of the fast state for each one of the slow
    assert steps(run) < 5 * steps(slow)
    t, x = course(run, 1)
    assert np.abs(x - exact(STIFF, t, [1.0, 0.0])).max() < 3.0 * tol


@pytest.mark.parametrize("name", ["qss2", "qss3"])
def test_explicit_methods_chatter_in_a_stiff_system(name: str) -> None:
    run = by(name, linear(STIFF, [1.0, 0.0]), 0.2, 1e-5)
    # more events than LIQSS needs for all of it, and hardly any time has passed
    assert steps(run) > 3000
    t, x = course(run, 1)
    assert np.abs(x - exact(STIFF, t, [1.0, 0.0])).max() < 3e-5


def pendulum(t: float, y: np.ndarray) -> np.ndarray:
    return np.array([y[1], -np.sin(y[0])])


def van_der_pol(t: float, y: np.ndarray) -> np.ndarray:
    return np.array([y[1], 100.0 * (1.0 - y[0] ** 2) * y[1] - y[0]])


@pytest.mark.parametrize("name", ["qss2", "qss3", "liqss2", "liqss3"])
def test_pendulum(name: str) -> None:
    t, x = course(by(name, field(["x1", "-sin(x0)"], [2.0, 0.0]), 5.0, 1e-5))
    true = solve_ivp(pendulum, (0, 5), [2, 0], "DOP853", rtol=1e-12, atol=1e-13, dense_output=True)
    assert np.abs(x - true.sol(t)).max() < 1e-4


def test_stiff_van_der_pol_through_two_relaxations() -> None:
    run = by("liqss3", field(["x1", "100*(1 - x0^2)*x1 - x0"], [2.0, 0.0]), 200.0, 1e-4)
    true = solve_ivp(van_der_pol, (0.0, 200.0), [2.0, 0.0], "Radau", rtol=1e-8, atol=1e-8)
    end = [run.final["x0"], run.final["x1"]]
    assert np.abs(end - true.y[:, -1]).max() < 1e-3
    assert min(s.y[:, 0].min() for s in run.segments) < -1.9
    assert steps(run) < 5000


@pytest.mark.parametrize("rate", ["sin(20*time) - x0", "sin(20*time) - x0*x0/(x0 + 1e-30)"])
@pytest.mark.parametrize("name", NAMES)
def test_a_source_that_is_a_function_of_time_is_followed(name: str, rate: str) -> None:
    """Exactly known where it is a generator of a linear mode; fitted with the rates elsewhere."""
    tol = {"1": 1e-3, "2": 1e-5, "3": 1e-6}[name[-1]]
    t, x = course(by(name, field([rate], [0.0]), 3.0, tol), 3)
    true = (np.sin(20 * t) - 20 * np.cos(20 * t) + 20 * np.exp(-t)) / 401
    assert np.abs(x[0] - true).max() < 2.0 * tol


@pytest.mark.parametrize("name", NAMES)
def test_powers_of_time_that_begin_with_nothing(name: str) -> None:
    """All derivatives up to the ninth are zero where the motion begins."""
    tol = {"1": 1e-3, "2": 1e-5, "3": 1e-6}[name[-1]]
    t, x = course(by(name, field(["10*time^9"], [0.0]), 1.0, tol))
    assert np.abs(x[0] - t**10).max() < 2.0 * tol


def test_a_source_that_moves_only_now_and_then_is_not_taken_for_a_constant() -> None:
    """Constant where the motion begins, and a narrow smooth pulse later."""

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        return np.array([np.exp(-(((t - 5.0) / 0.1) ** 2)) - 0.1 * y[0]])

    run = by("qss3", field(["exp(-((time - 5)/0.1)^2) - 0.1*x0"], [1.0]), 10.0, 1e-6)
    true = solve_ivp(rate, (0, 10), [1.0], rtol=1e-12, atol=1e-13, max_step=0.01).y[0, -1]
    assert run.final["x0"] == pytest.approx(true, abs=2e-5)


@pytest.mark.parametrize("name", NAMES)
def test_a_kink(name: str) -> None:
    # y' = -max(y, 1): e^-t times 3 down to 1 at t = log 3, then a straight line
    tol = tolerance_of(name)
    run = by(name, field(["-max(x0, 1)"], [3.0]), 1.5, tol)
    assert run.final["x0"] == pytest.approx(1.0 - (1.5 - math.log(3.0)), abs=3.0 * tol)


def test_the_equations_of_a_linear_mode_are_asked_once() -> None:
    run = by("qss2", linear(TRIANGLE, [1.0, 0.0, 0.0]), 5.0, 1e-4)
    assert run.stats["evaluations"] == 1


@pytest.mark.parametrize("n", [40, 640])
def test_an_event_costs_what_depends_on_it(n: int) -> None:
    """A pulse that wanders along a line: who is at rest has no events, however long the line is."""
    rates = ["-x0"] + [f"x{k - 1} - x{k}" for k in range(1, n)]
    run = by("qss3", field(rates, [1.0] + [0.0] * (n - 1)), 10.0, 1e-5)
    assert run.stats["evaluations"] == 1
    assert steps(run) < 2200
    t = 10.0
    for k in (0, 5, 10, 20):
        poisson = math.exp(-t + k * math.log(t) - math.lgamma(k + 1))
        assert run.final[f"x{k}"] == pytest.approx(poisson, abs=2e-5)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("rates", [["x1", "-4*x0 - 0.8*x1"], ["x1", "-sin(x0)"]])
def test_a_step_that_an_event_cuts_is_the_same_polynomial(name: str, rates: list[str]) -> None:
    """A machine that changes nothing: up to its event all is as without it."""
    model = field(rates, [1.0, 0.0])
    before = by(name, model, 2.0, 1e-3)
    watched = field(rates, [1.0, 0.0])
    watched.machine("A", states={"a": [], "b": []}, start="a", rules=["a -> b when x0 < 0.3"])
    run = by(name, watched, 2.0, 1e-3)
    at = run.events[1].t
    assert run["x0"].at(at, side="left") == pytest.approx(0.3, abs=1e-9)
    for t in (0.3 * at, 0.9 * at, at):
        for x in ("x0", "x1"):
            assert run[x].at(t, side="left") == pytest.approx(before[x].at(t), rel=1e-12, abs=1e-15)


def test_steps_end_at_the_quantum_events_of_single_states() -> None:
    """Two states that do not know each other: the events of both, as of each alone."""

    def ends(matrix: np.ndarray, start: list[float]) -> list[float]:
        run = by("qss2", linear(matrix, start), 3.0, 1e-3)
        return np.concatenate([s.t for s in run.segments])[1:-1].tolist()

    both = ends(np.diag([-1.0, -0.3]), [1.0, 2.0])
    alone = sorted(ends(np.array([[-1.0]]), [1.0]) + ends(np.array([[-0.3]]), [2.0]))
    assert len(both) == len(alone)
    assert both == pytest.approx(alone, rel=1e-9)


@pytest.mark.parametrize("name", ["qss2", "qss3", "liqss3"])
def test_energies_of_a_ladder(name: str) -> None:
    """Capacitors that exchange charge with their neighbours: what is dissipated is what is gone."""
    n = 12
    m = hb.Model("ladder", domain="electrical")
    for k in range(n):
        m.add(**{f"z{k}": hb.Zero(), f"c{k}": hb.C(1.0, e=[1.0, -0.5][k] if k < 2 else 0.0)})
        m.bond(f"z{k} -> c{k}")
        if k > 0:
            m.add(**{f"i{k}": hb.One(), f"r{k}": hb.R(1.0)})
            m.bond(f"z{k - 1} -> i{k} -> z{k}", f"i{k} -> r{k}")
    run = by(name, m, 2.0, 1e-5)
    matrix = -2.0 * np.eye(n) + np.eye(n, k=1) + np.eye(n, k=-1)
    matrix[0, 0] = matrix[-1, -1] = -1.0
    start = np.array([1.0, -0.5] + [0.0] * (n - 2))
    end = expm(2.0 * matrix) @ start
    assert [run.final[f"c{k}.q"] for k in range(n)] == pytest.approx(end, abs=1e-4)
    dissipated = sum(run.energies(s)[-1] for s in run.segments)[1]
    assert dissipated == pytest.approx(0.5 * (start @ start - end @ end), abs=1e-4)


def test_an_event_that_cuts_a_step_leaves_the_audit_right() -> None:
    m = hb.Model("pushed", domain="translational")
    m.add(S=hb.Se("0.5 [N/s]*time + 1 [N]"), j=hb.One(), L=hb.I(1, f=-1.0))
    m.bond("S -> j -> L")
    m.machine("A", states={"a": [], "b": []}, start="a", rules=["a -> b when j.f > 0"])
    done = hb.simulate(m, until=4.0, solver="qss3", rtol=1e-6, engine="library")
    assert len(done.events) == 2
    assert done.events[1].t == pytest.approx(math.sqrt(8.0) - 2.0, rel=1e-6)
    assert done.audit().energy < 1e-6


@pytest.mark.parametrize("unit", [1e-9, 1e9])
@pytest.mark.parametrize("name", ["qss3", "liqss2"])
def test_units_do_not_matter(name: str, unit: float) -> None:
    def count(time: float, size: float) -> int:
        model = linear(DAMPED / time, [size, 0.0])
        return steps(by(name, model, 3.0 * time, 1e-4 * size))

    assert abs(count(unit, 1.0) - count(1.0, 1.0)) <= 1
    assert abs(count(1.0, unit) - count(1.0, 1.0)) <= 1


@pytest.mark.parametrize("straight", [True, False])
@pytest.mark.parametrize("name", ["qss2", "qss3", "liqss2"])
def test_a_state_without_a_size_gets_going(name: str, straight: bool) -> None:
    """A capacitor without charge, and no energy anywhere."""
    m = hb.Model("rc", domain="electrical")
    law = 1.0 if straight else {"e": "1 [V/A]*f + 1e-6 [V/A^3]*f^3"}
    m.add(V=hb.Se("1 V"), n=hb.One(), r=hb.R(law), c=hb.C(1.0))
    m.bond("V -> n -> r", "n -> c")
    run = hb.simulate(m, 5.0, solver=name, rtol=1e-4, engine="library")
    assert steps(run) < 2000
    assert run.final["c.q"] == pytest.approx(1.0 - math.exp(-5.0), rel=1e-3)


@pytest.mark.parametrize("name", NAMES)
def test_states_that_depend_on_each_other_stay_on_their_constraint(name: str) -> None:
    """Two masses of one velocity: no more events than those of one that is both, twice."""
    tol = 1e-2 if name[-1] == "1" else 1e-4
    counts = []
    for masses in ([1.0, 2.0], [3.0]):
        m = hb.Model("masses", domain="translational")
        m.add(v=hb.One(), k=hb.C(0.5, e=1.0), r=hb.R(0.4))
        m.bond("v -> k", "v -> r")
        for k, mass in enumerate(masses):
            m.add(**{f"m{k}": hb.I(mass)})
            m.bond(f"v -> m{k}")
        run = hb.simulate(m, 10.0, solver=name, rtol=tol, engine="library")
        counts.append(steps(run))
    assert counts[0] <= 2 * counts[1] + 2
    alone = run.final["m0.f"]
    run = hb.simulate(m, 10.0, solver="rk45", rtol=1e-10, engine="library")
    assert alone == pytest.approx(run.final["m0.f"], abs=10.0 * tol)


def test_max_step_bounds_every_step() -> None:
    run = by("qss3", linear(DECAY, [1.0]), 2.0, 1e-1, max_step=0.05)
    assert np.diff(np.concatenate([s.t for s in run.segments])).max() <= 0.05 * (1 + 1e-9)


@pytest.mark.parametrize("rate", ["x1", "x1^2"])
def test_too_many_steps_are_refused(rate: str) -> None:
    with pytest.raises(hb.NumericsError) as caught:
        by("qss1", field(["x1", f"-{rate}"], [0.0, 1.0]), 5.0, 1e-3, max_steps=100)
    assert caught.value.code == "HB-N409"


def test_a_solution_that_ends_is_refused_with_its_state() -> None:
    # y' = y^2, y(0) = 1 is 1/(1 - t)
    model = field(["0*x1", "x1^2"], [0.5, 1.0])
    with pytest.raises(hb.NumericsError) as caught:
        by("qss2", model, 2.0, 1e-9, rtol=1e-2)
    assert caught.value.code in ("HB-N201", "HB-N202")
    assert "x1" in str(caught.value)
    assert caught.value.partial.t_end == pytest.approx(1.0, abs=0.05)


def test_aliases_and_refusals() -> None:
    model = linear(DECAY, [1.0])
    assert by("qss", model, 1.0, 1e-3).solver == "qss3"
    assert by("liqss", model, 1.0, 1e-3).solver == "liqss2"
    with pytest.raises(hb.UsageError) as caught:
        by("qss3", model, 1.0, 1e-3, step=0.1)
    assert caught.value.code == "HB-S104"
    with pytest.raises(hb.UsageError) as caught:
        hb.simulate(model, 1.0, solver="qss4")
    assert caught.value.code == "HB-S101"


def test_sliding_on_a_surface() -> None:
    """Two tendencies that push against each other: x0 stays at zero, x1 moves with the mean."""
    m = field(["u", "1 + u"], [0.5, 0.0])
    m.signal(u='if M.state == "up" then 1 else -2')
    m.machine(
        "M",
        states={"up": [], "down": []},
        start="down",
        rules=["up -> down when x0 > 0", "down -> up when x0 < 0"],
    )
    run = by("qss3", m, 2.0, 1e-6)
    assert run.final["x0"] == pytest.approx(0.0, abs=1e-9)
    assert run.final["x1"] == pytest.approx(-0.25 + 1.75, abs=1e-5)


CASES = ["bouncing_ball_newton", "diode_inductor", "clutch", "coulomb_friction", "half_bridge"]


@pytest.mark.parametrize("example", CASES)
@pytest.mark.parametrize(("name", "rtol"), [("qss3", 1e-5), ("liqss2", 1e-4)])
def test_examples_agree_with_runge_kutta(example: str, name: str, rtol: float) -> None:
    model = hb.load(EXAMPLES / f"{example}.toml")
    run = hb.simulate(model, solver=name, rtol=rtol, engine="library")
    true = hb.simulate(model, solver="rk45", rtol=1e-10, engine="library")
    assert run.status == true.status == "ok"
    assert len(run.events) == len(true.events)
    for ours, theirs in itertools.zip_longest(run.events, true.events):
        assert ours.steps[-1].mode == theirs.steps[-1].mode
        assert ours.t == pytest.approx(theirs.t, rel=20.0 * rtol, abs=0.0)
        size = np.abs([e.after for e in true.events]).max(axis=0)
        assert (np.abs(ours.after - theirs.after) <= 20.0 * rtol * size + 1e-12).all()
    energies, exactly = (sum(r.energies(s)[-1] for s in r.segments) for r in (run, true))
    assert (np.abs(energies - exactly) <= 20.0 * rtol * np.abs(exactly).max()).all()


# -- in exports


@pytest.mark.sampled(1)
@needs_c
@pytest.mark.parametrize(
    ("example", "name"),
    [("clutch", "liqss2"), ("half_bridge", "qss3"), ("diode_inductor", "qss1")],
)
@pytest.mark.slow
def test_a_program_runs_as_the_library_does(example: str, name: str, tmp_path: Path) -> None:
    options: dict[str, Any] = {"solver": name, "rtol": 1e-3}
    model = hb.load(EXAMPLES / f"{example}.toml")
    program = compile_quickly(str(hb.export(model, to="c", **options)), tmp_path, example)
    said = read_events(ask(program, "--events"))
    run = expected(hb.simulate(model, engine="library", **options))
    assert said.transitions == run.transitions
    assert said.times == pytest.approx(run.times, abs=1e-12 * run.end)
    for path, value in said.states.items():
        assert value == pytest.approx(run.states[path], rel=1e-12, abs=1e-15), path
