"""Exact propagation of linear modes: the reference."""

import math

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

import hybond as hb
from hybond.engine.compiled import native
from hybond.engine.tables.generators import generators, of_name, terms_of
from hybond.kernel.library import library
from hybond.model.expressions import compile_expression, parse
from hybond.solvers.propagation import Propagator, balanced

ENDS = 1e-13
"""What the end of a step may be off by: rounding of a few dozen terms."""


def require_library() -> None:
    try:
        native.library()
    except native.Unavailable as why:
        pytest.skip(str(why))


@pytest.fixture(params=["reference", "kernel", "library"])
def engine(request):
    """The options of a run; with the kernel all of its steps must be taken there."""
    if request.param == "library":
        require_library()
        return {"solver": "exact", "engine": "library"}
    if request.param == "kernel" and isinstance(library(), str):
        pytest.skip(library())
    return {"solver": "exact", "kernel": request.param == "kernel"}


def simulated(model, until, engine, **options):
    """Run a model; check who took its steps."""
    run = hb.simulate(model, until, **engine, **options)
    if "kernel" in engine:
        assert run.stats["marched"] == (run.stats["steps"] if engine["kernel"] else 0)
    return run


def ends(run, path):
    """Return the ends of all steps, and a stored quantity there."""
    k = next(s.index for s in run.graph.storages if s.path.partition(".")[0] == path)
    t = np.concatenate([s.t for s in run.segments])
    return t, np.concatenate([s.y[:, k] for s in run.segments])


def assert_true(run, path, true, rel=ENDS):
    """Hold the ends of steps against a closed form, and points between them against rtol."""
    t, x = ends(run, path)
    size = np.abs(true(t)).max()
    assert np.abs(x - true(t)).max() <= rel * size
    between = np.linspace(0.0, run.t_end, 777)
    seen = np.asarray(run[f"{path}.{'q' if path == 'C' else 'p'}"].at(between.tolist()))
    assert np.abs(seen - true(between)).max() <= 10.0 * 1e-8 * size


def series(source, *, r=2.0, l=0.5, **inputs):
    """A coil behind a resistor: ``p' = u - r p/l``."""
    m = hb.Model("rl", domain="electrical")
    m.add(V=hb.Se(source), n=hb.One(), R=hb.R(r), L=hb.I(l))
    m.bond("V -> n -> R", "n -> L")
    for name, given in inputs.items():
        m.input(**{name: given})
    return m


def ringing(r, *, c=0.25, l=1.0, q=1.0):
    m = hb.Model("rlc", domain="electrical")
    m.add(n=hb.One(), C=hb.C(c, q=q), R=hb.R(r), L=hb.I(l))
    m.bond("n -> C", "n -> R", "n -> L")
    return m


# -- the matrix


def test_the_flow_is_the_exponential():
    random = np.random.default_rng(1)
    for n in (1, 2, 5, 12):
        matrix = random.normal(size=(n, n)) * 10.0 ** random.integers(-3, 4, size=(n, 1))
        z = random.normal(size=n)
        flow = Propagator(matrix)
        for h in (1e-6, 0.3 / np.abs(matrix).sum(), 2.0 / np.abs(matrix).max(), 0.01):
            true = expm(matrix * h) @ z
            assert flow.after(z, h) == pytest.approx(true, rel=1e-12, abs=1e-12 * abs(true).max())
            rows = flow.parts(z, h)
            assert rows[0] == pytest.approx(z, rel=1e-15)
            assert rows[2] == pytest.approx(expm(0.4 * matrix * h) @ z, rel=1e-11)


def test_slow_motion_beside_a_fast_one_is_not_lost():
    fast, slow = 1e9, 1.0
    flow = Propagator(np.array([[-fast, fast], [0.0, -slow]]))
    z = flow.after(np.array([0.0, 1.0]), 1.0)
    assert z[1] == pytest.approx(math.exp(-1.0), rel=1e-14)
    assert z[0] == pytest.approx(math.exp(-1.0) * fast / (fast - slow), rel=1e-14)


def test_singular_and_defective_matrices():
    chain = np.diag([1.0, 1.0, 1.0], -1)
    z = Propagator(chain).after(np.array([1.0, 0.0, 0.0, 0.0]), 3.0)
    assert z == pytest.approx([1.0, 3.0, 4.5, 4.5], rel=1e-15)
    z = Propagator(np.array([[-2.0, 1.0], [0.0, -2.0]])).after(np.array([0.0, 1.0]), 7.0)
    assert z == pytest.approx([7.0 * math.exp(-14.0), math.exp(-14.0)], rel=1e-13)
    assert Propagator(np.zeros((2, 2))).after(np.ones(2), 1e300).tolist() == [1.0, 1.0]


def test_balancing_keeps_powers_of_two():
    matrix = np.array([[-1.0, 1e8, 0.0], [1e-8, -1.0, 3e4], [0.0, 0.0, 0.0]])
    d = balanced(matrix)
    assert np.log2(d).tolist() == np.round(np.log2(d)).tolist()
    assert Propagator(matrix).norm < 1e5


# -- sources


@pytest.mark.parametrize(
    "text",
    [
        "3",
        "2*time - 1",
        "time^3/7",
        "5*sin(3*time + 0.4)",
        "cos(2*time)*sin(5*time)^2",
        "exp(-2*time)*(1 + time*cos(time))",
        "exp(3*(time - 1000))",
        "sinh(time) - 2*cosh(time/3)",
        "a*time*sin(time) + a^2",
        "if 2 > 1 then sin(time) else sqrt(time)",
        "sqrt(2)*min(1, 3)*time",
    ],
)
def test_generators_are_what_they_stand_for(text):
    e = parse(text)
    terms = terms_of(e, of_name)
    assert isinstance(terms, dict)
    made = generators(terms, lambda name: "da" if name == "a" else None)
    row = made.row(terms)
    index = {"time": 0, "a": 1, "da": 2}
    value = compile_expression(e, index, pre_offset=3)
    each = [compile_expression(g, index, pre_offset=3) for g in made.expressions]

    def at(t):
        v = [t, 0.5 - 2.0 * t, -2.0, 0.0, 0.0, 0.0]
        return value(v), np.array([g(v) for g in each])

    t, h = 0.7, 0.9
    before, g = at(t)
    after, then = at(t + h)
    assert row @ g == pytest.approx(before, rel=1e-12)
    assert expm(made.matrix * h) @ g == pytest.approx(then, rel=1e-11, abs=1e-300)
    assert row @ expm(made.matrix * h) @ g == pytest.approx(after, rel=1e-11)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("sqrt(time)", "sqrt of what varies"),
        ("1/time", "a division by what varies"),
        ("time^0.5", "a power that is no small whole number"),
        ("2^time", "a power of what varies"),
        ("sin(time^2)", "sin of what is no line in time"),
        ("if time > 1 then 1 else 2", "a condition that varies"),
        ("max(time, 1)", "max of what varies"),
        ("pre(a)", "an a priori value"),
        ("exp(1000)*exp(1000)*time", "a value that overflows"),
    ],
)
def test_what_has_no_generators_says_why(text, reason):
    assert terms_of(parse(text), of_name) == reason


# -- closed forms


def test_discharge(engine):
    m = hb.Model("rc", domain="electrical")
    m.add(C=hb.C("1 mF", e="10 V"), R=hb.R("1 kohm"), n=hb.Zero())
    m.bond("n -> C", "n -> R")
    run = simulated(m, 5.0, engine=engine)
    assert_true(run, "C", lambda t: 0.01 * np.exp(-t))
    assert run.method == "1 mode propagated exactly"
    assert run.stats["propagated"] == 1
    assert abs(run.audit().energy) < 1e-8


@pytest.mark.sampled(2)
@pytest.mark.parametrize("r", [0.0, 0.5, 4.0, 9.0])
def test_ringing_critical_and_creeping(r, engine):
    """At r = 4 the matrix has one eigenvector only."""
    run = simulated(ringing(r), 6.0, engine=engine)
    a = np.array([[0.0, 1.0], [-4.0, -r]])

    def true(t):
        return np.array([(expm(a * u) @ [1.0, 0.0])[0] for u in t])

    assert_true(run, "C", true)


@pytest.mark.sampled(12)
@pytest.mark.parametrize(
    ("source", "particular"),
    [
        ("3", lambda t: 0.75 + 0.0 * t),
        ("10*sin(7*time + 0.3)", lambda t: 10.0 * np.imag(np.exp(1j * (7 * t + 0.3)) / (4 + 7j))),
        ("2*time", lambda t: 0.5 * t - 0.125),
        ("(1*time)^2", lambda t: t**2 / 4 - t / 8 + 1 / 32),
        ("3*exp(-2*time)", lambda t: 1.5 * np.exp(-2.0 * t)),
        ("3*exp(-4*time)", lambda t: 3.0 * t * np.exp(-4.0 * t)),
        ("exp(-1*time)*cos(5*time)", lambda t: np.real(np.exp((-1 + 5j) * t) / (3 + 5j))),
    ],
)
def test_driven_coils(source, particular, engine):
    run = simulated(series(source), 4.0, engine=engine)
    start = particular(np.zeros(1))[0]
    assert_true(run, "L", lambda t: particular(t) - start * np.exp(-4.0 * t))
    assert run.method == "1 mode propagated exactly"
    assert abs(run.audit().energy) < 1e-8


@pytest.mark.sampled(1)
def test_steps_do_not_miss_a_source_whose_periods_fit_the_run(engine):
    """States that hardly move leave the steps long; powers must still see the source."""
    m = hb.Model("lamp", domain="electrical")
    m.add(V=hb.Se("sin(2*pi*time)"), n=hb.Zero(), R=hb.R(1.0), slow=hb.R(1e9), C=hb.C(1.0, q=1.0))
    m.add(b=hb.One())
    m.bond("V -> n -> R", "n -> b -> slow", "b -> C")
    run = simulated(m, 100.0, engine=engine)
    assert abs(run.audit().energy) < 1e-8
    if "kernel" in engine:
        # the library finds energies later, on the steps that it took
        supplied = run.segments[-1].y[-1][-2]
        assert supplied == pytest.approx(50.0, rel=1e-7)


def test_ramps_of_a_table(engine):
    given = hb.Input(
        table=[(0.0, 0.0), (1.0, 4.0), (1.5, 4.0), (1.5, -1.0), (3.0, 2.0)], linear=True
    )
    run = simulated(series("u", u=given), 3.0, engine=engine)
    a, y, slopes = -4.0, 0.0, [(1.0, 0.0, 4.0), (0.5, 4.0, 0.0), (1.5, -1.0, 2.0)]
    for h, u, s in slopes:
        m = np.array([[a, u, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
        m[0, 2], m[2, 1] = s, 1.0
        y = (expm(m * h) @ [y, 1.0, 0.0])[0]
    assert run.final["L.p"] == pytest.approx(y, rel=1e-13)


def test_pulses(engine):
    given = hb.Input(pwm={"period": 0.1, "duty": 0.3, "high": 5.0})
    run = simulated(series("u", u=given), 2.0, engine=engine)
    y = 0.0
    for _ in range(20):
        y = 1.25 + (y - 1.25) * math.exp(-4.0 * 0.03)
        y *= math.exp(-4.0 * 0.07)
    assert run.final["L.p"] == pytest.approx(y, rel=1e-12)


def test_switched_sine(engine):
    """A coil on a sine that a machine switches at a current: events and states are exact."""
    m = hb.Model("switched", domain="electrical")
    m.add(V=hb.Se("10*sin(7*time)"), n=hb.One(), R=hb.R(2.0), s=hb.One(), z=hb.Zero())
    m.add(L=hb.I(0.5), G=hb.R(3.0))
    m.bond("V -> s -> z", "z -> n -> L", "n -> R", "z -> G")
    m.machine(
        "M",
        states={"on": ["s"], "off": []},
        start="on",
        rules=["on -> off when L.f > 0.8", "off -> on when L.f < 0.1"],
    )
    run = simulated(m, 3.0, engine=engine)
    t, p, on, times = 0.0, 0.0, True, []

    def moved(u):
        if not on:
            return p * math.exp(-10.0 * (u - t))
        f = np.imag(10.0 * np.exp(7j * np.array([u, t])) / (4 + 7j))
        return f[0] + (p - f[1]) * math.exp(-4.0 * (u - t))

    while True:
        level = 0.4 if on else 0.05
        grid = np.linspace(t, 3.0, 4001)
        off = np.array([moved(u) - level for u in grid]) * (1 if on else -1)
        k = int(np.argmax(off > 0.0))
        if not off[k] > 0.0:
            break
        u = brentq(lambda u, y=level: moved(u) - y, grid[max(k - 1, 0)], grid[k], xtol=1e-15)
        p, t, on = moved(u), u, not on
        times.append(u)
    assert len(times) > 4
    assert [e.t for e in run.events][1:] == pytest.approx(times, abs=1e-11)
    assert run.final["L.p"] == pytest.approx(moved(3.0), rel=1e-9)


def test_free_flight_needs_one_step(engine):
    m = hb.Model("ball", domain="translational")
    m.add(weight=hb.Se(-9.81), ball=hb.I(1.0), v=hb.One())
    m.bond("weight -> v -> ball")
    m.signal(height=hb.Integral("v.f", start=3.0))
    run = simulated(m, 2.0, engine=engine)
    assert run.stats["steps"] == 1
    assert run["height"].at(1.3) == pytest.approx(3.0 - 0.5 * 9.81 * 1.69, rel=1e-14)


@pytest.mark.sampled(1)
def test_an_oscillator_keeps_its_energy(engine):
    run = simulated(ringing(0.0, c=1.0), 400.0 * math.pi, rtol=1e-5, engine=engine)
    y = run.segments[0].y
    assert np.abs(y[:, 0] ** 2 + y[:, 1] ** 2 - 1.0).max() < 1e-12
    assert y[-1, :2] == pytest.approx([1.0, 0.0], abs=1e-12)


def test_stiff_decays_limit_steps_only_while_they_last(engine):
    """Two capacitors: one in a nanosecond, one in a second."""
    m = hb.Model("stiff", domain="electrical")
    m.add(a=hb.C(1e-9, q=3e-9), b=hb.C(1.0, q=1.0), r=hb.R(1.0), i=hb.One(), za=hb.Zero())
    m.add(zb=hb.Zero(), load=hb.R(1.0))
    m.bond("za -> a", "za -> i -> zb", "i -> r", "zb -> b", "zb -> load")
    run = simulated(m, 5.0, engine=engine)
    assert run.stats["steps"] < 150
    fast = -(1e9 + 2.0 + math.sqrt((1e9 + 2.0) ** 2 - 4e9)) / 2.0
    slow = 1e9 / fast
    left = np.array([[-1e9 - fast, 1.0], [1e9, -2.0 - fast]]) @ [3e-9, 1.0] / (slow - fast)
    a, b = left * math.exp(5.0 * slow)
    assert run.final["b.q"] == pytest.approx(b, rel=1e-13)
    assert run.final["a.q"] == pytest.approx(a, rel=1e-8)


def test_rounding_of_a_fast_rate_limits_no_steps(engine):
    """A rate of 1e13 per second times a tenth of a second: all digits of its rate are rounding."""
    m = hb.Model("stiffer", domain="electrical")
    m.add(a=hb.C(1e-13), b=hb.C(1.0, q=1.0), r=hb.R(1.0), i=hb.One(), za=hb.Zero())
    m.add(zb=hb.Zero(), load=hb.R(1.0))
    m.bond("za -> a", "za -> i -> zb", "i -> r", "zb -> b", "zb -> load")
    run = simulated(m, 5.0, engine=engine)
    assert run.stats["steps"] < 250
    assert run.final["b.q"] == pytest.approx(math.exp(-5.0), rel=1e-11)
    points = np.linspace(1.0, 5.0, 99)
    seen = np.asarray(run["a.e"].at(points.tolist()))
    assert seen == pytest.approx(np.exp(-points), rel=1e-6)


def test_dependent_storage_and_a_source_rate(engine):
    """A capacitor across a source takes the rate of the source."""
    m = hb.Model("dependent", domain="electrical")
    m.add(V=hb.Se("sin(3*time)"), z=hb.Zero(), C=hb.C(2.0), n=hb.One(), R=hb.R(1.0), L=hb.I(1.0))
    m.bond("V -> z -> C", "z -> n -> R", "n -> L")
    run = simulated(m, 3.0, engine=engine)
    assert run.method == "1 mode propagated exactly"
    t, q = ends(run, "C")
    assert q == pytest.approx(2.0 * np.sin(3.0 * t), abs=1e-13)
    true = np.imag(np.exp(3j * t) / (1 + 3j)) + 0.3 * np.exp(-t)
    assert ends(run, "L")[1] == pytest.approx(true, abs=1e-13)


def test_integrals_that_are_not_linear_are_taken_along(engine):
    m = ringing(0.5)
    m.signal(heat=hb.Integral("0.5*L.f^2", start=0.0), way=hb.Integral("abs(L.f)", start=0.0))
    m.signal(charge=hb.Integral("L.f", start=1.0))
    a = simulated(m, 6.0, rtol=1e-9, engine=engine)
    b = hb.simulate(m, 6.0, rtol=1e-12, kernel=False)
    assert a.method == "1 mode propagated exactly"
    for name in ("heat", "way", "charge"):
        assert a[name].at(6.0) == pytest.approx(b[name].at(6.0), rel=1e-8)
    assert a["charge"].at(6.0) == pytest.approx(a["C.q"].at(6.0), rel=1e-13)


def test_controlled_sources_are_solved_for(engine):
    """A source that follows a current, with a ramp: a row that is evaluated, but linear."""
    m = series("1*sin(3*time)")
    m.add(F=hb.Se("-3*L.f + 2*time"), S=hb.Sf("0.5*L.p"), z=hb.Zero(), C=hb.C(2.0), G=hb.R(1.0))
    m.bond("F -> n", "S -> z -> C", "z -> G")
    run = simulated(m, 3.0, engine=engine)
    assert run.method == "1 mode propagated exactly"
    # p' = sin 3t + 2t - 10 p, q' = p/2 - q/2
    a = np.zeros((6, 6))
    a[0, [0, 2, 4]] = -10.0, 1.0, 2.0
    a[1, [0, 1]] = 0.5, -0.5
    a[2, 3], a[3, 2], a[4, 5] = 3.0, -3.0, 1.0
    true = expm(3.0 * a) @ [0.0, 0.0, 0.0, 1.0, 0.0, 1.0]
    assert run.final["L.p"] == pytest.approx(true[0], rel=1e-12)
    assert run.final["C.q"] == pytest.approx(true[1], rel=1e-12)


def test_a_law_that_is_switched_off_may_be_anything(engine):
    m = ringing(0.5)
    m.add(s=hb.One(), D=hb.R({"e": "2*f + 3*f^3"}), z=hb.Zero(), G=hb.R(2.0))
    m.bond("n -> z -> G", "z -> s -> D")
    m.machine("M", states={"off": [], "on": ["s"]}, start="off", rules=["off -> on when time > 1"])
    run = simulated(m, 2.0, engine=engine)
    assert run.method == "1 mode propagated exactly; 1 mode left to rk45: laws that are not linear"
    true = hb.simulate(m, 2.0, rtol=1e-12)
    assert run.final["C.q"] == pytest.approx(true.final["C.q"], rel=1e-7)
    first = run.segments[0]
    matrix = np.array([[0.0, 1.0], [-4.0, -2.5]])
    assert first.t[-1] == 1.0
    assert first.y[-1][:2] == pytest.approx(expm(matrix) @ [1.0, 0.0], rel=1e-12)


# -- what is left to rk45


@pytest.mark.parametrize("by", [{"kernel": False}, {"engine": "library"}])
@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (lambda: series("abs(sin(1*time))"), "abs of what varies in the source V"),
        (
            lambda: series("u", u=hb.Input(function=lambda t: t**2)),
            "an input that is a function in Python",
        ),
        (lambda: nonlinear(R=hb.R({"e": "2*f^3"})), "laws that are not linear"),
        (lambda: nonlinear(C=hb.C({"e": "2*q^3"}, q=1.0)), "nonlinear storage"),
        (lambda: modulated("2*L.p*sin(1*time)"), "a product with what is stored in the source V"),
        (lambda: modulated("2*way"), "a source follows way, which does not move linearly"),
        (lambda: modulated("2", on="3*way"), "on follows way, which does not move linearly"),
    ],
)
def test_what_is_not_linear_is_left_to_rk45(make, reason, by):
    if "engine" in by:
        require_library()
    a = hb.simulate(make(), 2.0, solver="exact", **by)
    b = hb.simulate(make(), 2.0, **by)
    assert a.method.startswith("0 modes propagated exactly; 1 mode left to rk45: ")
    assert reason in a.method
    assert a.final == b.final
    assert a.stats["steps"] == b.stats["steps"]


def nonlinear(**parts):
    m = hb.Model("nonlinear", domain="electrical")
    given = {"R": hb.R(1.0), "C": hb.C(1.0, q=1.0), "L": hb.I(1.0), **parts}
    m.add(n=hb.One(), **given)
    m.bond("n -> C", "n -> R", "n -> L")
    return m


def modulated(source, on="0"):
    m = ringing(1.0)
    m.signal(way=hb.Integral("2*abs(L.f)", start=0.0), on=hb.Integral(on, start=0.0))
    m.add(V=hb.Se(source))
    m.bond("V -> n")
    return m


def test_other_solvers_say_nothing_of_methods():
    assert hb.simulate(ringing(1.0), 1.0).method == ""


def test_a_mode_is_counted_once_however_many_intervals_it_lasts():
    m = hb.Model("steps", domain="electrical")
    m.add(V=hb.Se("if time < 0.2 then 1 else 2"), i=hb.One(), r=hb.R(1), c=hb.C("0.1 F"))
    m.bond("V -> i -> r", "i -> c")
    run = hb.simulate(m, 1.0, solver="exact")
    assert run.method == "1 mode propagated exactly"
    assert run.stats["propagated"] == 1.0


@pytest.mark.parametrize("kernel", [True, False, None])
@pytest.mark.parametrize("c", [1e-15, 1e-16, 1e-18, 1e3, 1e12])
def test_a_charge_is_right_however_small_beside_its_source(c, kernel):
    m = hb.Model("rc", domain="electrical")
    m.add(V=hb.Se("5 V"), i=hb.One(), R=hb.R("1 kohm"), C=hb.C(c))
    m.bond("V -> i -> R", "i -> C")
    run = hb.simulate(m, 1e3 * c, solver="exact", kernel=kernel)
    assert run["C.e"].at(1e3 * c) == pytest.approx(5.0 * -math.expm1(-1.0), rel=1e-12)


@pytest.mark.parametrize("kernel", [True, False, None])
def test_a_large_motion_that_is_not_coupled_changes_nothing(kernel):
    m = hb.Model("two")
    m.add(far=hb.I("1 kg", p=1e9), free=hb.One())
    m.bond("free -> far")
    m.add(l=hb.I("1 mH"), c=hb.C("1 mF", q=1e-6), r=hb.R("1 ohm"), i=hb.One())
    m.bond("c -> i -> l", "i -> r")
    run = hb.simulate(m, 0.01, solver="exact", kernel=kernel)
    # overdamped only just: s^2 + 1000 s + 1e6 has complex roots
    a, w = 500.0, math.sqrt(1e6 - 500.0**2)
    want = 1e-6 * math.exp(-a * 0.01) * (math.cos(w * 0.01) + a / w * math.sin(w * 0.01))
    assert run["c.q"].at(0.01) == pytest.approx(want, rel=1e-10)


@pytest.mark.sampled(6)
@pytest.mark.parametrize("kernel", [True, False, None])
@pytest.mark.parametrize(
    ("rate", "until", "want"),
    [
        ("abs(sin(2*pi*50*(time/(1 [s]))))", 0.1, 0.2 / math.pi),
        ("sin(2*pi*50*(time/(1 [s])))^2", 0.1, 0.05),
        ("sin(2*pi*C.q/(1 [C]))^2", 5.0, 2.5),
        ("sin(2*pi*C.q/(1 [C]))^2", 10.0 / 0.3819660112501051, 5.0 / 0.3819660112501051),
    ],
)
def test_integrals_along_a_simple_motion_are_seen(rate, until, want, kernel):
    """All parts of a step may lie on whole periods."""
    m = hb.Model("al", domain="electrical")
    m.add(S=hb.Sf("1 A"), C=hb.C("1 F"), n=hb.Zero())
    m.bond("S -> n -> C")
    m.signal(y=hb.Integral(rate))
    run = hb.simulate(m, until, solver="exact", kernel=kernel)
    t = until
    if "C.q" in rate:
        want = t / 2.0 - math.sin(4.0 * math.pi * t) / (8.0 * math.pi)
    # a kink is no event
    assert run["y"].at(until) == pytest.approx(want, rel=2e-6 if "abs" in rate else 2e-8)
