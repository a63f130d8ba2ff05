"""Laws with several solutions, of which no storage feels which: a run follows one, to its end."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import hybond as hb

E = "(e/(1 [V]))"
F = "(f/(1 [A]))"
TURN = math.sqrt(2.0 / 3.0)
"""Behind 1 ohm the laws below are x^3 - 2 x = u, which turns at x = -sqrt(2/3) if u rises."""
FOLD = 2.0 * TURN**3


def beside_a_storage(drive, *, away=False, rule=None, many=1):
    """A source, an RC that feels nothing of what is beside it, and resistors that turn."""
    m = hb.Model("read", domain="electrical")
    m.add(V=hb.Se(drive), z=hb.Zero(), ic=hb.One(), Rc=hb.R("1 ohm"), C=hb.C("1 F"))
    m.bond("V -> z -> ic -> Rc", "ic -> C")
    for k in range(many):
        law = hb.G({"f": f"({E}^3 - 3*{E})*1 [A]"})
        m.add(**{f"i{k}": hb.One(), f"R{k}": hb.R("1 ohm"), f"G{k}": law})
        m.bond(f"z -> i{k} -> R{k}", f"G{k} -> i{k}" if away else f"i{k} -> G{k}")
    if rule is not None:
        m.machine("w", states={"a": [], "b": []}, start="a", rules=[f"a -> b when {rule}"])
    return m


def dual(drive, *, away=False, rule=None):
    """The same with efforts and flows exchanged."""
    m = hb.Model("read", domain="electrical")
    m.add(S=hb.Sf(drive), z=hb.One(), ic=hb.Zero(), Rc=hb.R("1 ohm"), L=hb.I("1 H"))
    m.add(i0=hb.Zero(), R0=hb.R("1 ohm"), G0=hb.R({"e": f"({F}^3 - 3*{F})*1 [V]"}))
    m.bond("S -> z -> ic -> Rc", "ic -> L", "z -> i0 -> R0", "G0 -> i0" if away else "i0 -> G0")
    if rule is not None:
        m.machine("w", states={"a": [], "b": []}, start="a", rules=[f"a -> b when {rule}"])
    return m


def between_folds(u):
    """Return where x^3 - 2 x = u lies between its folds."""
    return np.array([brentq(lambda x, d=d: x**3 - 2.0 * x - d, -TURN, TURN) for d in u])


def ends_at(run, fold):
    """Assert that a run says at a fold that its solution ends, and that no guard fired before."""
    assert run.status == "unsound"
    assert "(a fold)" in str(run.error) and "small C or I" in str(run.error)
    (found,) = run.audit().laws
    assert found.t == pytest.approx(fold, abs=1e-8)
    for event in run.events[1:]:
        assert event.t >= fold - 1e-8


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45", "exact", "rk4"])
@pytest.mark.parametrize("away", [False, True])
@pytest.mark.parametrize("way", [1, -1])
def test_a_guard_fires_at_no_root_in_passing(solver, away, way):
    fixed = {"step": "10 ms"} if solver == "rk4" else {}
    sign = -1 if away else 1
    rule = f"abs({sign}*G0.e) > 0.9 V"
    m = beside_a_storage(f"({way}*time/(1 [s]))*1 [V]", away=away, rule=rule)
    run = hb.simulate(m, until="1.2 s", solver=solver, on_error="return", **fixed)
    ends_at(run, FOLD)


@pytest.mark.parametrize("away", [False, True])
@pytest.mark.parametrize("many", [2, 3])
def test_several_that_end_together_say_so(away, many):
    m = beside_a_storage("(time/(1 [s]))*1 [V]", away=away, rule="abs(G1.e) > 0.9 V", many=many)
    ends_at(hb.simulate(m, until="1.2 s", on_error="return"), FOLD)


@pytest.mark.parametrize("away", [False, True])
def test_a_law_of_the_flow_is_followed_likewise(away):
    m = dual("(time/(1 [s]))*1 [A]", away=away, rule="abs(G0.f) > 0.9 A")
    ends_at(hb.simulate(m, until="1.2 s", on_error="return"), FOLD)


def coupled(many):
    """Laws behind one common resistor: x_k^3 - c_k x_k = (u - 0.5 I - x_k)/0.8, I their sum."""
    m = hb.Model("coupled", domain="electrical")
    m.add(V=hb.Se("time/(1 [s])*1 [V]"), y=hb.Zero(), ic=hb.One(), Rc=hb.R("1 ohm"), C=hb.C("1 F"))
    m.add(a=hb.One(), Rs=hb.R("0.5 ohm"), z=hb.Zero())
    m.bond("V -> y -> ic -> Rc", "ic -> C", "y -> a -> Rs", "a -> z")
    for k in range(many):
        law = hb.G({"f": f"({E}^3 - {3.0 - 0.3 * k}*{E})*1 [A]"})
        m.add(**{f"i{k}": hb.One(), f"R{k}": hb.R("0.8 ohm"), f"G{k}": law})
        m.bond(f"z -> i{k} -> R{k}", f"i{k} -> G{k}")
    m.machine("w", states={"a": [], "b": []}, start="a", rules=["a -> b when abs(G0.e) > 0.9 V"])
    return m


def first_fold(many):
    """Follow the solution from rest by its arc, and return the largest u before it turns."""
    c = np.array([3.0 - 0.3 * k for k in range(many)])

    def by_x(x):
        own = np.diag(3.0 * x**2 - c)
        return np.eye(many) + 0.8 * own + 0.5 * np.ones((many, many)) @ own

    x, u, way, most = np.zeros(many), 0.0, None, 0.0
    for _ in range(2000):
        # along the arc: the null vector of [by_x, -1], and a few of Newton's steps across it
        _, _, v = np.linalg.svd(np.hstack([by_x(x), -np.ones((many, 1))]))
        here = v[-1] if way is None and v[-1][-1] > 0.0 else -v[-1] if way is None else v[-1]
        here = here if way is None or here @ way > 0.0 else -here
        if way is not None and here[-1] < 0.0:
            return most
        way = here
        x, u = x + 2e-3 * way[:-1], u + 2e-3 * way[-1]
        for _ in range(2):
            flow = x**3 - c * x
            off = x + 0.8 * flow + 0.5 * flow.sum() - u
            whole = np.vstack([np.hstack([by_x(x), -np.ones((many, 1))]), way])
            step = np.linalg.solve(whole, np.append(off, 0.0))
            x, u = x - step[:-1], u - step[-1]
        most = max(most, u)
    raise AssertionError("no fold")


@pytest.mark.parametrize("many", [2, 3])
def test_coupled_laws_say_so_where_their_solution_ends(many):
    run = hb.simulate(coupled(many), until="2.5 s", on_error="return")
    assert run.status == "unsound" and "(a fold)" in str(run.error)
    assert run.audit().laws[0].t == pytest.approx(first_fold(many), abs=1e-5)


@pytest.mark.parametrize("away", [False, True])
def test_what_is_read_is_the_solution_followed_in_any_order(away):
    m = beside_a_storage("1 [V]*sin(time/(1 [s]))", away=away, rule="abs(G0.e) > 0.9 V")
    run = hb.simulate(m, until="7 s")
    assert run.status == "ok" and len(run.events) == 1 and run.audit().holds()
    t = np.linspace(0.0, 7.0, 36)
    expected = between_folds(np.sin(t)) * (-1.0 if away else 1.0)
    assert run["G0.e"].at(t) == pytest.approx(expected, abs=1e-9)
    for k in (20, 8, 24, 3, 35):
        assert run["G0.e"].at(t[k]) == pytest.approx(expected[k], abs=1e-9)


@pytest.mark.parametrize("within", [False, True])
def test_a_run_that_goes_on_does_so_by_the_same_solution(within):
    m = beside_a_storage("1 [V]*sin(time/(1 [s]))", rule="abs(G0.e) > 0.9 V")
    first = hb.simulate(m, until="3 s" if within else "1.4 s")
    run = hb.simulate(m, until="3 s", start=first.state(1.4) if within else first.state())
    assert run.status == "ok" and not [e for e in run.events if e.t > 1.4 + 1e-9 and e.steps]
    t = np.linspace(1.4, 3.0, 9)
    assert run["G0.e"].at(t) == pytest.approx(between_folds(np.sin(t)), abs=1e-9)


@pytest.mark.parametrize(
    "law",
    [f"{E}^3", f"tanh(1e3*{E})", f"exp({E}) - 1", f"max({E}, 0)*100 + min({E}, 0)*0.01",
     f"max(-1, min(1, 1e4*{E}))", "tunnel 5", "tunnel 60"],
)  # fmt: skip
def test_nothing_is_said_of_laws_with_one_solution_nor_where_none_ends(law):
    series = "1 ohm"
    if law.startswith("tunnel"):
        # with 60 ohm the load line has three, and the source turns back before the fold
        series = law.split()[1] + " ohm"
        u = "(e/(60 [mV]))"
        law = f"0.01*{u}*exp(1 - {u}) + 1e-9*(exp(e/(40 [mV])) - 1)"
    m = hb.Model("one", domain="electrical")
    m.add(V=hb.Se("0.6 [V]*sin(time/(1 [s]))^2"), y=hb.Zero(), ic=hb.One(), Rc=hb.R("1 ohm"))
    m.add(C=hb.C("1 F"), i=hb.One(), R=hb.R(series), D=hb.G({"f": f"({law})*1 [A]"}))
    m.bond("V -> y -> ic -> Rc", "ic -> C", "y -> i -> R", "i -> D")
    run = hb.simulate(m, until="4 s")
    assert run.status == "ok" and not run.warnings and run.audit().holds()
