"""Exact propagation in the kernel is that of the reference, and of rk45 at tight tolerances."""

import re
from fractions import Fraction

import numpy as np
import pytest
from engines import assert_same_events, assert_same_states
from example_runs import example
from hypothesis import assume, given
from hypothesis import strategies as st
from switched_models import converter
from test_random import SEEDS, apart, some, told

import hybond as hb
from hybond.kernel import flow, marcher
from hybond.kernel.build import SOURCES
from hybond.solvers import dopri, exact, propagation

TEXT = (SOURCES / "exact.c").read_text()


def both(model, **options):
    return [
        hb.simulate(model, solver="exact", kernel=k, on_error="return", **options)
        for k in (False, True)
    ]


def number(name):
    found = re.search(rf"\b{name} = ([^,;}}]+)", TEXT).group(1)
    factors = [float.fromhex(f) if "0x" in f else float(f) for f in found.split("*")]
    return float(np.prod(factors))


def table(name):
    body = re.search(rf"\b{name}(?:\[[^\]]*\])+ = (.*?);", TEXT, flags=re.S).group(1)
    entries = re.findall(r"-?[0-9.]+(?: / [0-9]+)?", body)
    return [
        float(Fraction(a.split(" / ")[0]) / Fraction((a + " / 1").split(" / ")[1])) for a in entries
    ]


_TABLES = (
    ("FIT", exact.FIT),
    ("SUMS", exact.SUMS),
    ("START", exact.START),
    ("VALUE", exact.VALUE),
    ("SUM", exact.SUM),
)


def test_constants_are_the_same():
    assert number("BETWEEN") == exact.BETWEEN
    assert number("PARTS") == propagation.PARTS and number("TERMS") == propagation.TERMS
    assert number("ASKED") == exact._ASKED and table("MET") == exact._MET
    assert number("HIGHEST") == exact.ORDERS[-1]
    assert tuple(range(propagation.PARTS, exact.ORDERS[-1] + 1)) == exact.ORDERS
    assert number("FARTHEST") == exact.FARTHEST and number("LOOSE") == exact.LOOSE
    assert number("SMALLEST") == dopri._SMALLEST_ERROR
    assert number("DOUBTFUL") == exact.DOUBTFUL and number("SMALL") == propagation.SMALL
    assert f"HB_LEVELS = {propagation.LEVELS} " in (SOURCES / "hybond.h").read_text()
    for name, known in _TABLES:
        assert table(name) == pytest.approx(known.ravel(), rel=1e-11, abs=1e-13)
    listed = re.search(r"METHODS\[\] = \{(.*?)\}", (SOURCES / "method.c").read_text()).group(1)
    assert listed.replace("dopri", "rk45") == ", ".join(f"&hb_{m}" for m in marcher.METHODS)


@pytest.mark.slow
@given(seed=SEEDS)
@some(10)
def test_random_networks(kernel, seed):
    a, b = both(converter(seed), until=2.0)
    c = hb.simulate(converter(seed), 2.0, rtol=1e-11, kernel=False, on_error="return")
    assert told(a) == told(b)
    assert (a.error is None) == (b.error is None)
    assert [e.t for e in b.events] == pytest.approx([e.t for e in a.events], abs=1e-10)
    if not a.accumulations:
        assert apart(a, b) <= 1e-10
    # where an event may or may not happen, the tolerance decides
    assume(told(a) == told(c) and not a.accumulations and a.error is None)
    assert apart(c, b) <= 1e-6
    assert b.method.endswith("propagated exactly")


@given(seed=SEEDS, n=st.integers(1, 6))
@some(10)
def test_random_linear_networks_end_where_rk45_does(kernel, seed, n):
    """Coils and capacitors of any size between resistors, driven by a sum of everything."""
    random = np.random.default_rng(seed)

    def size():
        return float(np.round(10.0 ** random.uniform(-1.5, 1.5), 4))

    m = hb.Model("ladder", domain="electrical")
    drive = f"{size()}*sin({size()}*time + 1) + {size()}*exp(-{size()}*time) + {size()}*time + u"
    times = np.sort(random.uniform(0.0, 2.0, 4)).tolist()
    m.input(u=hb.Input(table=[(t, size()) for t in times], linear=True))
    m.add(V=hb.Se(drive), n0=hb.One(), r=hb.R(size()))
    m.bond("V -> n0 -> r")
    for k in range(n):
        m.add(**{f"z{k}": hb.Zero(), f"c{k}": hb.C(size()), f"g{k}": hb.R(size())})
        m.add(**{f"n{k + 1}": hb.One(), f"l{k}": hb.I(size()), f"r{k}": hb.R(size())})
        m.bond(f"n{k} -> z{k} -> c{k}", f"z{k} -> g{k}", f"z{k} -> n{k + 1} -> l{k}")
        m.bond(f"n{k + 1} -> r{k}")
    m.signal(passed=hb.Integral("n0.f", start=1.0))
    runs = [hb.simulate(m, 2.0, solver="exact", rtol=tol) for tol in (1e-5, 1e-8)]
    true = hb.simulate(m, 2.0, rtol=3e-13)
    assert all(r.stats["marched"] == r.stats["steps"] for r in runs)
    for name, value in true.final.items():
        if name.endswith((".p", ".q")):
            # the end of a step does not depend on the tolerance
            assert runs[0].final[name] == pytest.approx(runs[1].final[name], rel=1e-12, abs=1e-14)
            assert runs[0].final[name] == pytest.approx(value, rel=1e-10, abs=1e-12)
    assert runs[1].segments[-1].y[-1] == pytest.approx(true.segments[-1].y[-1], rel=1e-8, abs=1e-10)


def test_an_oscillator_keeps_its_energy_over_a_thousand_periods(kernel):
    m = hb.Model("lc", domain="electrical")
    m.add(n=hb.One(), C=hb.C(1.0, q=1.0), L=hb.I(1.0))
    m.bond("n -> C", "n -> L")
    run = hb.simulate(m, 2000.0 * np.pi, solver="exact")
    assert run.stats["marched"] == run.stats["steps"] > 20 * 1024
    y = run.segments[0].y
    assert np.abs(y[:, 0] ** 2 + y[:, 1] ** 2 - 1.0).max() < 1e-11
    assert y[-1, :2] == pytest.approx([1.0, 0.0], abs=1e-11)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "options", [{"progress": lambda t, n: None}, {"max_step": 0.01}, {"atol": 1e-9}]
)
def test_options_are_those_of_the_reference(kernel, options):
    m = example("rlcd")
    a, b = both(m, **options)
    assert a.stats["steps"] == b.stats["steps"]
    assert_same_states(a, b, 1e-11)


def chain(n):
    m = hb.Model("chain", domain="electrical")
    m.add(V=hb.Se("sin(3*time)"), i=hb.One(), r=hb.R(1.0))
    m.bond("V -> i -> r")
    for k in range(n):
        m.add(**{f"z{k}": hb.Zero(), f"c{k}": hb.C(0.01 * (k + 1)), f"i{k}": hb.One()})
        m.add(**{f"r{k}": hb.R(1.0)})
        m.bond(f"{'i' if k == 0 else f'i{k - 1}'} -> z{k} -> c{k}", f"z{k} -> i{k} -> r{k}")
    return m


@pytest.mark.slow
def test_what_is_too_large_is_left_to_the_reference(kernel):
    below, above = (hb.simulate(chain(n), 0.3, solver="exact") for n in (flow.LARGEST - 2, 70))
    assert below.stats["marched"] == below.stats["steps"]
    assert above.stats["marched"] == 0
    assert "1 mode left to the reference: more than 64 states and generators" in above.kernel
    assert above.method == "1 mode propagated exactly"
    a, b = both(chain(flow.LARGEST - 2), until=0.3)
    assert a.segments[0].y[-1] == pytest.approx(b.segments[0].y[-1], rel=1e-12, abs=1e-18)


def test_sources_that_compare_time_are_left_to_the_reference(kernel):
    m = chain(2)
    m.add(W=hb.Se("if time < 0.2 then 1 else 3"), iw=hb.One(), rw=hb.R(1.0))
    m.bond("W -> iw -> rw", "iw -> z1")
    run = hb.simulate(m, 0.5, solver="exact")
    true = hb.simulate(m, 0.5, rtol=1e-12)
    assert "comparisons of time in what is propagated exactly" in run.kernel
    assert "left to rk45" not in run.method
    assert run.final["c1.q"] == pytest.approx(true.final["c1.q"], rel=1e-11)


@pytest.mark.slow
def test_modes_of_both_kinds_in_one_passage(kernel):
    """A resistor whose law depends on the state of a machine: rk45 where it is a cubic."""
    m = hb.Model("mixed", domain="electrical")
    m.add(V=hb.Se("5*sin(6*time)"), n=hb.One(), R=hb.R(1.0), L=hb.I(0.3), z=hb.Zero())
    m.add(D=hb.R({"e": 'if M.state == "on" then 2*f + 3*f^3 else 2*f'}), C=hb.C(0.2), G=hb.R(4.0))
    m.bond("V -> n -> R", "n -> L", "n -> z -> C", "z -> G", "n -> D")
    m.machine(
        "M",
        states={"off": [], "on": []},
        start="off",
        rules=["off -> on when C.e > 0.5", "on -> off when C.e < -0.5"],
    )
    a, b = both(m, until=10.0, rtol=1e-10)
    assert b.stats["crossed"] >= 10
    assert_same_events(a, b)
    assert_same_states(a, b, 1e-10)
    assert b.method.startswith("1 mode propagated exactly; 1 mode left to rk45: laws that")


@pytest.mark.slow
def test_a_stiff_transient_after_each_event(kernel):
    """A nanosecond beside a second: what died away is not seen, whatever the kernel's levels."""
    m = hb.Model("stiff", domain="electrical")
    m.add(V=hb.Se("u"), n=hb.One(), fast=hb.R(1.0), z=hb.Zero(), c=hb.C(1e-9))
    m.add(i=hb.One(), R=hb.R(1.0), L=hb.I(1.0))
    m.bond("V -> n -> fast", "n -> z -> c", "z -> i -> R", "i -> L")
    m.input(u=hb.Input(pwm={"period": 0.5, "duty": 0.4}))
    a, b = both(m, until=5.0)
    assert b.stats["steps"] == pytest.approx(a.stats["steps"], rel=0.05) and b.stats["steps"] < 2000
    assert_same_states(a, b, 1e-8)
    matrix = np.array([[-1e9, -1.0], [1e9, -1.0]])
    fast = -(1e9 + 1.0 + np.sqrt((1e9 + 1.0) ** 2 - 8e9)) / 2.0
    slow = 2e9 / fast
    onto_slow = (matrix - fast * np.eye(2)) / (slow - fast)
    x = np.zeros(2)
    for _ in range(10):
        for h, u in ((0.2, 1.0), (0.3, 0.0)):
            rest = np.array([0.5e-9 * u, 0.5 * u])
            x = rest + np.exp(slow * h) * (onto_slow @ (x - rest))
    assert b.final["L.p"] == pytest.approx(x[1], rel=1e-12)
