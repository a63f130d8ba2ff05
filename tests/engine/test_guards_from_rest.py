"""Guards on what begins at zero and leaves it by a high power of time.

Near its beginning the polynomial of a step is what the step is off by, and that has any sign:
guards fired at 1e-24 s. Closed forms, and the exponential of the chain.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

import hybond as hb

Solver = Literal["auto", "rk45", "radau"]


def integrals(many: int, guard: str) -> hb.Model:
    """A charge that grows by 1 A, and integrals of it: ``x3 = t^3/6`` and so on."""
    m = hb.Model("integrals")
    m.add(s=hb.Sf(1.0), c=hb.C(1.0), n=hb.Zero())
    m.bond("s -> n -> c")
    before = "c.q"
    for k in range(2, many + 1):
        m.signal(**{f"x{k}": hb.Integral(before)})
        before = f"x{k}"
    m.machine("m", states={"q": [], "p": []}, start="q", rules=[f"q -> p when {guard}"])
    return m


@pytest.mark.parametrize("guard", ["x3 < 0", "x4 < 0", "-x3 > 0", "x3 + x4 < 0", "sin(x3) < 0"])
@pytest.mark.parametrize("solver", ["auto", "rk45"])
def test_a_power_of_time_is_not_below_zero(guard: str, solver: Solver) -> None:
    run = hb.simulate(integrals(4, guard), until=1.5, solver=solver)
    assert run.status == "ok"
    assert [e.t for e in run.events] == [0.0]
    assert run["x4"].at(1.5) == pytest.approx(1.5**4 / 24.0, rel=1e-7)


def train(cars: int, guard: str, *, turned: bool, begins: float) -> hb.Model:
    """Cars with springs between them; at `begins` the last one is pushed, or moves from then on."""
    m = hb.Model("train", domain="translational")
    for k in range(cars):
        moves = 1.0 if k == cars - 1 and begins == 0.0 else 0.0
        m.add(**{f"v{k}": hb.One(), f"a{k}": hb.I(1.0, p=-moves if turned else moves)})
        m.bond(f"a{k} -> v{k}" if turned else f"v{k} -> a{k}")
    for k in range(1, cars):
        m.add(**{f"n{k}": hb.Zero(), f"s{k}": hb.C(1.0)})
        m.bond(f"v{k - 1} -> n{k} -> v{k}", f"s{k} -> n{k}" if turned else f"n{k} -> s{k}")
    if begins:
        m.add(push=hb.Se(f"if time < {begins!r} then 0 else 1"))
        m.bond(f"push -> v{cars - 1}")
    m.machine("m", states={"q": [], "p": []}, start="q", rules=[f"q -> p when {guard}"])
    return m


def first_force(cars: int, t: float, pushed: bool) -> float:
    """The force of the first spring, by the exponential of the chain; pressed is above zero."""
    n = 2 * cars - 1
    a = np.zeros((n + 1, n + 1))
    for k in range(cars - 1):
        a[cars + k, k], a[cars + k, k + 1] = 1.0, -1.0
        a[k, cars + k], a[k + 1, cars + k] = -1.0, 1.0
    x = np.zeros(n + 1)
    if pushed:
        a[cars - 1, n], x[n] = 1.0, 1.0
    else:
        x[cars - 1] = 1.0
    return float((expm(a * t) @ x)[cars])


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("cars", "begins", "solver"),
    [
        (3, 0.0, "auto"),
        (3, 0.0, "rk45"),
        (4, 0.0, "auto"),
        (4, 0.0, "rk45"),
        (5, 0.0, "auto"),
        (3, 0.5, "auto"),
    ],
)
def test_a_coupling_opens_when_it_is_pressed(
    cars: int, begins: float, solver: Solver, turned: bool
) -> None:
    model = train(cars, "n1.e > 0", turned=turned, begins=begins)
    run = hb.simulate(model, until=begins + 6.0, solver=solver)
    grid = np.linspace(0.5, 6.0, 200)
    forces = [first_force(cars, t, begins > 0.0) for t in grid]
    at = next(i for i, f in enumerate(forces) if f > 0.0)
    crossed = brentq(lambda t: first_force(cars, t, begins > 0.0), grid[at - 1], grid[at])
    fired = [e.t for e in run.events if e.steps[-1].fired]
    assert fired == pytest.approx([begins + crossed], abs=1e-6)


@pytest.mark.parametrize("cars", [3, 4])
@pytest.mark.parametrize("begins", [0.0, 0.5])
def test_one_that_opens_when_it_is_pulled_does_so_at_once(cars: int, begins: float) -> None:
    run = hb.simulate(train(cars, "n1.e < 0", turned=False, begins=begins), until=begins + 1.0)
    fired = [e.t for e in run.events if e.steps[-1].fired]
    assert run.status == "ok"
    # by then the force is a trillionth of the others
    assert fired == pytest.approx([begins], abs=1e-2)


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
def test_a_ladder_that_is_charged_has_nothing_below_zero(solver: Solver) -> None:
    m = hb.Model("ladder", domain="electrical")
    m.add(u=hb.Se(1.0))
    before = "u"
    for k in range(1, 5):
        m.add(**{f"j{k}": hb.One(), f"r{k}": hb.R(1.0), f"n{k}": hb.Zero(), f"c{k}": hb.C(1.0)})
        m.bond(f"{before} -> j{k} -> n{k}", f"j{k} -> r{k}", f"n{k} -> c{k}")
        before = f"n{k}"
    m.machine("m", states={"q": [], "p": []}, start="q", rules=["q -> p when c4.e < 0"])
    run = hb.simulate(m, until=3.0, solver=solver)
    assert run.status == "ok"
    assert len(run.events) == 1


def masses_in_a_row(many: int, force: float, turned: bool) -> hb.Model:
    """Return masses with springs between them; the last moves as ``t^(2*many - 1)`` at first."""
    m = hb.Model("row")
    m.add(F=hb.Se(force))
    for k in range(many):
        m.add(**{f"v{k}": hb.One(), f"m{k}": hb.I(1.0)})
        m.bond(f"m{k} -> v{k}" if turned else f"v{k} -> m{k}")
        if k > 0:
            m.add(**{f"n{k}": hb.Zero(), f"k{k}": hb.C(1.0)})
            m.bond(f"v{k - 1} -> n{k} -> v{k}", f"k{k} -> n{k}" if turned else f"n{k} -> k{k}")
    m.bond("F -> v0")
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("force", [1.0, -1.0, 1e-6, 1e6])
@pytest.mark.parametrize("many", [4, 5, 7])
def test_the_last_of_a_row_of_masses_does_not_move_back_first(
    many: int, force: float, turned: bool
) -> None:
    """A polynomial of degree four that leaves zero by a high power of time dips below it."""
    m = masses_in_a_row(many, force, turned)
    back = "<" if force > 0.0 else ">"
    there = ">" if force > 0.0 else "<"
    last = f"v{many - 1}.f"
    m.machine("B", states={"a": [], "b": []}, start="a", rules=[f"a -> b when {last} {back} 0"])
    m.machine("T", states={"a": [], "b": []}, start="a", rules=[f"a -> b when {last} {there} 0"])
    run = hb.simulate(m, until=2.0, solver="rk45")
    assert [e.steps[-1].mode for e in run.events[1:]] == [(0, 1)]
    assert run.events[-1].t < 1e-5


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("lag", [1e-3, 1e-2])
@pytest.mark.parametrize("least", [1e-3, 1e-6, 1e-9, 1e-11])
def test_the_tail_of_a_coil_ends_where_its_current_is_zero(
    least: float, lag: float, turned: bool
) -> None:
    """It begins at zero as well, and is next to nothing there."""
    m = hb.Model("tail")
    m.add(E=hb.Se(f"1 if time < 0.02 else {-least}"), L=hb.I(lag), R=hb.R(1.0), D=hb.One())
    m.bond("E -> D", "L -> D" if turned else "D -> L", "R -> D" if turned else "D -> R")
    m.machine("S", states={"on": ["D"], "off": []}, start="on", rules=["on -> off when E.f < 0"])
    run = hb.simulate(m, until=1.0)
    begins = 1.0 - math.exp(-0.02 / lag)
    ends = 0.02 + lag * math.log(1.0 + begins / least)
    assert len(run.events) == 2
    assert run.events[-1].t == pytest.approx(ends, rel=1e-8)
