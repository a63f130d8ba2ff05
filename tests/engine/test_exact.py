"""Exact propagation of linear modes, against closed forms."""

import math

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

import hybond as hb

ENDS = 1e-13
"""What the end of a step may be off by: rounding of a few dozen terms."""


def simulated(model, until, **options):
    return hb.simulate(model, until, solver="exact", **options)


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
    between = np.linspace(0.0, run.t_end, 101)
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


def drained(matrix):
    """x' = A x, of integrals alone."""
    m = hb.Model("system")
    m.add(c=hb.C(1.0), g=hb.G(1.0))
    m.bond("c -> g")
    for i, row in enumerate(matrix):
        rate = " + ".join(f"({a!r})*x{j}" for j, a in enumerate(row.tolist()) if a) or "0"
        m.signal(**{f"x{i}": hb.Integral(rate, start=float(i == 0))})
    return m


def moved(matrix, until):
    run = simulated(drained(np.array(matrix, dtype=float)), until)
    assert run.method == "1 mode propagated exactly"
    return [float(run.final[f"x{k}"]) for k in range(len(matrix))]


def test_the_flow_is_the_exponential():
    random = np.random.default_rng(1)
    for n in (1, 2, 5, 12):
        matrix = random.normal(size=(n, n)) * 10.0 ** random.integers(-3, 4, size=(n, 1))
        for h in (1e-6, 0.3 / np.abs(matrix).sum(), 2.0 / np.abs(matrix).max(), 0.01):
            true = expm(matrix * h)[:, 0]
            assert moved(matrix, h) == pytest.approx(true, rel=1e-11, abs=1e-11 * abs(true).max())


def test_singular_and_defective_matrices():
    chain = np.diag([1.0, 1.0, 1.0], -1)
    assert moved(chain, 3.0) == pytest.approx([1.0, 3.0, 4.5, 4.5], rel=1e-14)
    found = moved([[-2.0, 0.0], [1.0, -2.0]], 7.0)
    assert found == pytest.approx([math.exp(-14.0), 7.0 * math.exp(-14.0)], rel=1e-12)
    assert moved(np.zeros((2, 2)), 1e6) == [1.0, 0.0]


# -- closed forms


def test_discharge():
    m = hb.Model("rc", domain="electrical")
    m.add(C=hb.C("1 mF", e="10 V"), R=hb.R("1 kohm"), n=hb.Zero())
    m.bond("n -> C", "n -> R")
    run = simulated(m, 5.0)
    assert_true(run, "C", lambda t: 0.01 * np.exp(-t))
    assert run.method == "1 mode propagated exactly"
    assert run.stats["propagated"] == 1
    assert abs(run.audit().energy) < 1e-8


@pytest.mark.parametrize("r", [0.0, 0.5, 4.0, 9.0])
def test_ringing_critical_and_creeping(r):
    """At r = 4 the matrix has one eigenvector only."""
    run = simulated(ringing(r), 6.0)
    a = np.array([[0.0, 1.0], [-4.0, -r]])

    def true(t):
        return np.array([(expm(a * u) @ [1.0, 0.0])[0] for u in t])

    assert_true(run, "C", true)


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
def test_driven_coils(source, particular):
    run = simulated(series(source), 4.0)
    start = particular(np.zeros(1))[0]
    assert_true(run, "L", lambda t: particular(t) - start * np.exp(-4.0 * t))
    assert run.method == "1 mode propagated exactly"
    assert abs(run.audit().energy) < 1e-8


def test_steps_do_not_miss_a_source_whose_periods_fit_the_run():
    """States that hardly move leave the steps long; powers must still see the source."""
    m = hb.Model("lamp", domain="electrical")
    m.add(V=hb.Se("sin(2*pi*time)"), n=hb.Zero(), R=hb.R(1.0), slow=hb.R(1e9), C=hb.C(1.0, q=1.0))
    m.add(b=hb.One())
    m.bond("V -> n -> R", "n -> b -> slow", "b -> C")
    run = simulated(m, 100.0)
    assert abs(run.audit().energy) < 1e-8
    supplied = sum(run.energies(s)[-1][0] for s in run.segments)
    assert supplied == pytest.approx(50.0, rel=1e-7)


def test_ramps_of_a_table():
    given = hb.Input(
        table=[(0.0, 0.0), (1.0, 4.0), (1.5, 4.0), (1.5, -1.0), (3.0, 2.0)], linear=True
    )
    run = simulated(series("u", u=given), 3.0)
    a, y, slopes = -4.0, 0.0, [(1.0, 0.0, 4.0), (0.5, 4.0, 0.0), (1.5, -1.0, 2.0)]
    for h, u, s in slopes:
        m = np.array([[a, u, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
        m[0, 2], m[2, 1] = s, 1.0
        y = (expm(m * h) @ [y, 1.0, 0.0])[0]
    assert run.final["L.p"] == pytest.approx(y, rel=1e-13)


def test_pulses():
    given = hb.Input(pwm={"period": 0.1, "duty": 0.3, "high": 5.0})
    run = simulated(series("u", u=given), 2.0)
    y = 0.0
    for _ in range(20):
        y = 1.25 + (y - 1.25) * math.exp(-4.0 * 0.03)
        y *= math.exp(-4.0 * 0.07)
    assert run.final["L.p"] == pytest.approx(y, rel=1e-12)


def test_switched_sine():
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
    run = simulated(m, 3.0)
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


def test_free_flight_needs_one_step():
    m = hb.Model("ball", domain="translational")
    m.add(weight=hb.Se(-9.81), ball=hb.I(1.0), v=hb.One())
    m.bond("weight -> v -> ball")
    m.signal(height=hb.Integral("v.f", start=3.0))
    run = simulated(m, 2.0)
    assert run.stats["steps"] == 1
    assert run["height"].at(1.3) == pytest.approx(3.0 - 0.5 * 9.81 * 1.69, rel=1e-14)


def test_an_oscillator_keeps_its_energy():
    run = simulated(ringing(0.0, c=1.0), 400.0 * math.pi, rtol=1e-5)
    y = run.segments[0].y
    assert np.abs(y[:, 0] ** 2 + y[:, 1] ** 2 - 1.0).max() < 1e-12
    assert y[-1, :2] == pytest.approx([1.0, 0.0], abs=1e-12)


def test_stiff_decays_limit_steps_only_while_they_last():
    """Two capacitors: one in a nanosecond, one in a second."""
    m = hb.Model("stiff", domain="electrical")
    m.add(a=hb.C(1e-9, q=3e-9), b=hb.C(1.0, q=1.0), r=hb.R(1.0), i=hb.One(), za=hb.Zero())
    m.add(zb=hb.Zero(), load=hb.R(1.0))
    m.bond("za -> a", "za -> i -> zb", "i -> r", "zb -> b", "zb -> load")
    run = simulated(m, 5.0)
    assert run.stats["steps"] < 150
    fast = -(1e9 + 2.0 + math.sqrt((1e9 + 2.0) ** 2 - 4e9)) / 2.0
    slow = 1e9 / fast
    left = np.array([[-1e9 - fast, 1.0], [1e9, -2.0 - fast]]) @ [3e-9, 1.0] / (slow - fast)
    a, b = left * math.exp(5.0 * slow)
    assert run.final["b.q"] == pytest.approx(b, rel=1e-13)
    assert run.final["a.q"] == pytest.approx(a, rel=1e-8)


def test_rounding_of_a_fast_rate_limits_no_steps():
    """A rate of 1e13 per second times a tenth of a second: all digits of its rate are rounding."""
    m = hb.Model("stiffer", domain="electrical")
    m.add(a=hb.C(1e-13), b=hb.C(1.0, q=1.0), r=hb.R(1.0), i=hb.One(), za=hb.Zero())
    m.add(zb=hb.Zero(), load=hb.R(1.0))
    m.bond("za -> a", "za -> i -> zb", "i -> r", "zb -> b", "zb -> load")
    run = simulated(m, 5.0)
    assert run.stats["steps"] < 250
    assert run.final["b.q"] == pytest.approx(math.exp(-5.0), rel=1e-11)
    points = np.linspace(1.0, 5.0, 99)
    seen = np.asarray(run["a.e"].at(points.tolist()))
    assert seen == pytest.approx(np.exp(-points), rel=1e-6)


def test_dependent_storage_and_a_source_rate():
    """A capacitor across a source takes the rate of the source."""
    m = hb.Model("dependent", domain="electrical")
    m.add(V=hb.Se("sin(3*time)"), z=hb.Zero(), C=hb.C(2.0), n=hb.One(), R=hb.R(1.0), L=hb.I(1.0))
    m.bond("V -> z -> C", "z -> n -> R", "n -> L")
    run = simulated(m, 3.0)
    assert run.method == "1 mode propagated exactly"
    t, q = ends(run, "C")
    assert q == pytest.approx(2.0 * np.sin(3.0 * t), abs=1e-13)
    true = np.imag(np.exp(3j * t) / (1 + 3j)) + 0.3 * np.exp(-t)
    assert ends(run, "L")[1] == pytest.approx(true, abs=1e-13)


def test_integrals_that_are_not_linear_are_taken_along():
    m = ringing(0.5)
    m.signal(heat=hb.Integral("0.5*L.f^2", start=0.0), way=hb.Integral("abs(L.f)", start=0.0))
    m.signal(charge=hb.Integral("L.f", start=1.0))
    a = simulated(m, 6.0, rtol=1e-9)
    b = hb.simulate(m, 6.0, rtol=1e-12)
    assert a.method == "1 mode propagated exactly"
    for name in ("heat", "way", "charge"):
        assert a[name].at(6.0) == pytest.approx(b[name].at(6.0), rel=1e-8)
    assert a["charge"].at(6.0) == pytest.approx(a["C.q"].at(6.0), rel=1e-13)


def test_controlled_sources_are_solved_for():
    """A source that follows a current, with a ramp: a row that is evaluated, but linear."""
    m = series("1*sin(3*time)")
    m.add(F=hb.Se("-3*L.f + 2*time"), S=hb.Sf("0.5*L.p"), z=hb.Zero(), C=hb.C(2.0), G=hb.R(1.0))
    m.bond("F -> n", "S -> z -> C", "z -> G")
    run = simulated(m, 3.0)
    assert run.method == "1 mode propagated exactly"
    # p' = sin 3t + 2t - 10 p, q' = p/2 - q/2
    a = np.zeros((6, 6))
    a[0, [0, 2, 4]] = -10.0, 1.0, 2.0
    a[1, [0, 1]] = 0.5, -0.5
    a[2, 3], a[3, 2], a[4, 5] = 3.0, -3.0, 1.0
    true = expm(3.0 * a) @ [0.0, 0.0, 0.0, 1.0, 0.0, 1.0]
    assert run.final["L.p"] == pytest.approx(true[0], rel=1e-12)
    assert run.final["C.q"] == pytest.approx(true[1], rel=1e-12)


def test_a_law_that_is_switched_off_may_be_anything():
    m = ringing(0.5)
    m.add(s=hb.One(), D=hb.R({"e": "2*f + 3*f^3"}), z=hb.Zero(), G=hb.R(2.0))
    m.bond("n -> z -> G", "z -> s -> D")
    m.machine("M", states={"off": [], "on": ["s"]}, start="off", rules=["off -> on when time > 1"])
    run = simulated(m, 2.0)
    assert (
        run.method == "1 mode propagated exactly; 1 mode by steps of rk45: laws that are not linear"
    )
    true = hb.simulate(m, 2.0, rtol=1e-12)
    assert run.final["C.q"] == pytest.approx(true.final["C.q"], rel=1e-7)
    first = run.segments[0]
    matrix = np.array([[0.0, 1.0], [-4.0, -2.5]])
    assert first.t[-1] == 1.0
    assert first.y[-1][:2] == pytest.approx(expm(matrix) @ [1.0, 0.0], rel=1e-12)


# -- what is left to rk45


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
def test_what_is_not_linear_is_left_to_rk45(make, reason):
    a = hb.simulate(make(), 2.0, solver="exact")
    b = hb.simulate(make(), 2.0)
    assert a.method.startswith("1 mode by steps of rk45: ")
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
    assert hb.simulate(ringing(1.0), 1.0, solver="rk45").method == ""


def test_a_mode_is_counted_once_however_many_intervals_it_lasts():
    m = hb.Model("steps", domain="electrical")
    m.add(V=hb.Se("if time < 0.2 then 1 else 2"), i=hb.One(), r=hb.R(1), c=hb.C("0.1 F"))
    m.bond("V -> i -> r", "i -> c")
    run = hb.simulate(m, 1.0, solver="exact")
    assert run.method == "1 mode propagated exactly"
    assert run.stats["propagated"] == 1.0


@pytest.mark.parametrize("c", [1e-15, 1e-16, 1e-18, 1e3, 1e12])
def test_a_charge_is_right_however_small_beside_its_source(c):
    m = hb.Model("rc", domain="electrical")
    m.add(V=hb.Se("5 V"), i=hb.One(), R=hb.R("1 kohm"), C=hb.C(c))
    m.bond("V -> i -> R", "i -> C")
    run = hb.simulate(m, 1e3 * c, solver="exact")
    assert run["C.e"].at(1e3 * c) == pytest.approx(5.0 * -math.expm1(-1.0), rel=1e-12)


def test_a_large_motion_that_is_not_coupled_changes_nothing():
    m = hb.Model("two")
    m.add(far=hb.I("1 kg", p=1e9), free=hb.One())
    m.bond("free -> far")
    m.add(l=hb.I("1 mH"), c=hb.C("1 mF", q=1e-6), r=hb.R("1 ohm"), i=hb.One())
    m.bond("c -> i -> l", "i -> r")
    run = hb.simulate(m, 0.01, solver="exact")
    # overdamped only just: s^2 + 1000 s + 1e6 has complex roots
    a, w = 500.0, math.sqrt(1e6 - 500.0**2)
    want = 1e-6 * math.exp(-a * 0.01) * (math.cos(w * 0.01) + a / w * math.sin(w * 0.01))
    assert run["c.q"].at(0.01) == pytest.approx(want, rel=1e-10)


@pytest.mark.parametrize(
    ("rate", "until", "want"),
    [
        ("abs(sin(2*pi*50*(time/(1 [s]))))", 0.1, 0.2 / math.pi),
        ("sin(2*pi*50*(time/(1 [s])))^2", 0.1, 0.05),
        ("sin(2*pi*C.q/(1 [C]))^2", 5.0, 2.5),
        ("sin(2*pi*C.q/(1 [C]))^2", 10.0 / 0.3819660112501051, 5.0 / 0.3819660112501051),
    ],
)
def test_integrals_along_a_simple_motion_are_seen(rate, until, want):
    """All parts of a step may lie on whole periods."""
    m = hb.Model("al", domain="electrical")
    m.add(S=hb.Sf("1 A"), C=hb.C("1 F"), n=hb.Zero())
    m.bond("S -> n -> C")
    m.signal(y=hb.Integral(rate))
    run = hb.simulate(m, until, solver="exact")
    t = until
    if "C.q" in rate:
        want = t / 2.0 - math.sin(4.0 * math.pi * t) / (8.0 * math.pi)
    # a kink is no event
    assert run["y"].at(until) == pytest.approx(want, rel=2e-6 if "abs" in rate else 2e-8)


@pytest.mark.parametrize("cells", [150, 210])
def test_what_more_than_400_states_were_left_to_is_said(cells: int) -> None:
    m = hb.Model("line", domain="electrical")
    m.add(V=hb.Se(1.0), s=hb.One(), r=hb.R(1.0))
    m.bond("V -> s -> r")
    for k in range(cells):
        m.add(**{f"z{k}": hb.Zero(), f"c{k}": hb.C(1.0), f"i{k}": hb.One(), f"l{k}": hb.I(1.0)})
        m.bond(f"{f'i{k - 1}' if k else 's'} -> z{k} -> c{k}", f"z{k} -> i{k} -> l{k}")
    run = hb.simulate(m, 0.1)
    few = "1 mode propagated exactly"
    assert run.method == (
        few if cells == 150 else "all modes by steps of rk45: more than 400 states"
    )
    # the first capacitor hardly sees the second one yet
    assert run.final["c0.e"] == pytest.approx(-math.expm1(-0.1), rel=3e-3)
