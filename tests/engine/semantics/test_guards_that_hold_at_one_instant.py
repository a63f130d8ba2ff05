"""Guards that hold at one instant only, or begin to hold where they have no slope."""

from __future__ import annotations

import math

import pytest

import hybond as hb
from hybond.engine.tables.factored_guards import factored_guard
from hybond.model.expressions import parse

SOLVERS = ["rk45", "radau", "exact", "qss"]
LATE = {"rk45": 1e-7, "radau": 1e-9, "exact": 1e-11, "qss": 1e-7}
"""How far a solver may be off in time, beside a discharge."""
AT_ZERO = [
    "abs({x}) <= 0",
    "{x}^2 <= 0",
    "{x}*{x} <= 0",
    "sqrt(abs({x})) <= 0",
    "not (abs({x}) > 0)",
    "abs({x})*{y}^2 <= 0",
    "hypot({x}, 2*{x}) <= 0",
    "{x} <= 0 and {x} >= 0",
    "0 >= 3*abs({x})",
    "2*abs({x}) + abs({x}) <= 0",
    "abs({x})/2 + {x}^2 <= 0",
    "abs({x}) <= 0 and {y} > 0",
]
BELOW_ZERO = [
    "{x}*{x}*{x} < 0",
    "{x}^3 < 0",
    "{x}*abs({x}) < 0",
    "{x}^2*{x} < 0",
    "sign({x})*{x}^2 < 0",
    "{x}^5*{y} < 0",
    "-2*{x}^3 > 0",
    "min({x}*abs({x}), {y}) < 0",
]


def discharge(guard: str, *, turned: bool = False) -> hb.Model:
    """A voltage 2 exp(-t) - 1, which is zero at log(2), and one that rises from 3 V."""
    m = hb.Model("discharge")
    m.add(C=hb.C(1.0, q=1.0), w=hb.One(), r=hb.R(1.0))
    m.add(D=hb.C(1.0, q=3.0), z=hb.Zero(), s=hb.Sf(0.5))
    m.add(u=hb.Se(1.0 if turned else -1.0))
    m.bond("w -> u" if turned else "u -> w", "w -> C", "w -> r", "s -> z -> D")
    m.machine("m", states={"a": [], "b": []}, start="a", rules=[f"a -> b when {guard}"])
    return m


def first(run: hb.Result) -> float:
    assert run.status == "ok"
    found = [e.t for e in run.events if e.steps and any(s.fired for s in e.steps)]
    return found[0] if found else math.inf


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("x", ["C.e", "(C.e - 0.5)"])
@pytest.mark.parametrize("guard", AT_ZERO + BELOW_ZERO)
def test_a_guard_at_a_zero_that_is_flat_or_touched_fires_there(
    guard: str, x: str, solver: str
) -> None:
    """Magnitudes and squares never fired, products 3e-5 s late."""
    run = hb.simulate(discharge(guard.format(x=x, y="D.e")), 1.2, solver=solver)
    root = math.log(2.0) if x == "C.e" else math.log(2.0 / 1.5)
    assert first(run) == pytest.approx(root, abs=LATE[solver])


@pytest.mark.parametrize("guard", AT_ZERO[:4] + BELOW_ZERO[:4])
def test_it_does_with_the_source_turned_round(guard: str) -> None:
    run = hb.simulate(discharge(guard.format(x="C.e", y="D.e"), turned=True), 1.2, solver="exact")
    assert first(run) == pytest.approx(math.log(2.0), abs=1e-11)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("guard", AT_ZERO[:4] + BELOW_ZERO[:4])
def test_a_speed_that_swings_through_zero_does(guard: str, solver: str) -> None:
    """Of a mass on a spring, from 1 m: its displacement is a cosine, its speed a sine."""
    m = hb.Model("swing")
    m.add(I=hb.I(1.0, p=1.0), C=hb.C(1.0), v=hb.One())
    m.bond("v -> I", "v -> C")
    rules = [f"a -> b when {guard.format(x='I.f', y='I.f')}"]
    m.machine("m", states={"a": [], "b": []}, start="a", rules=rules)
    run = hb.simulate(m, 2.5, solver=solver, rtol=1e-9)
    assert first(run) == pytest.approx(math.pi / 2.0, abs=1e-5 if solver == "qss" else 1e-7)


@pytest.mark.parametrize("solver", ["rk45", "exact"])
@pytest.mark.parametrize(
    ("guard", "root"),
    [
        ("abs(sin(3*time)) <= 0 and time > 0.5", math.pi / 3.0),
        ("sin(3*time)^2 <= 0 and time > 0.5", math.pi / 3.0),
        ("max(sin(3*time), -sin(3*time)) <= 0 and time > 0.5", math.pi / 3.0),
        ("abs(cos(2*time)) <= 0", math.pi / 4.0),
        ("abs(time - 0.3) <= 0", 0.3),
        ("(time - 0.25)^2 <= 0", 0.25),
    ],
)
def test_a_guard_of_time_alone_does(guard: str, root: float, solver: str) -> None:
    run = hb.simulate(discharge(guard), 1.2, solver=solver)
    assert first(run) == pytest.approx(root, abs=1e-11)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    "guard",
    ["abs(A.e) + abs(B.e) <= 0", "A.e^2 + B.e^2 <= 0", "A.e*B.e <= 0", "max(A.e, B.e) <= 0"],
)
def test_zeros_that_two_have_at_one_instant_are_seen(guard: str, solver: str) -> None:
    m = hb.Model("two")
    for name, rate, q in (("A", -1.0, 1.0), ("B", -2.0, 2.0)):
        m.add({name: hb.C(1.0, q=q), f"s{name}": hb.Sf(rate), f"z{name}": hb.Zero()})
        m.bond(f"s{name} -> z{name} -> {name}")
    m.machine("m", states={"a": [], "b": []}, start="a", rules=[f"a -> b when {guard}"])
    assert first(hb.simulate(m, 1.5, solver=solver)) == pytest.approx(1.0, abs=1e-11)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    "guard", ["abs(C.e + 1) <= 0", "(C.e + 1)^2 <= 0", "abs(C.e)^2 < 0", "C.e*C.e*(C.e + 1) < 0"]
)
def test_what_comes_to_rest_there_or_never_does_fires_nothing(guard: str, solver: str) -> None:
    assert first(hb.simulate(discharge(guard), 40.0, solver=solver)) == math.inf


def test_where_a_magnitude_is_zero_and_where_it_is_not_are_told_apart() -> None:
    """Back and forth between them there is no cycle: it is zero at one instant."""
    m = discharge("abs(C.e) <= 0")
    m.machine("n", states={"p": [], "q": []}, start="p",
              rules=["p -> q when abs(C.e) <= 0", "q -> p when abs(C.e) > 0"])  # fmt: skip
    run = hb.simulate(m, 1.2, solver="exact")
    assert run.status == "ok"
    last = [f for e in run.events for s in e.steps for f in s.fired if f.machine == "n"]
    assert last[-1].target == "p"


@pytest.mark.parametrize(
    ("text", "split"),
    [
        ("x*x*x < 0", "x < 0"),
        ("-x^3 < 0", "x > 0"),
        ("x^2*y >= 0", "x <= 0 and x >= 0 or y >= 0"),
        ("x*y*z*w <= 0", "x*y*z*w <= 0"),
        ("x^2 < 0", "x^2 < 0"),
        ("x/0 < 0", "x/0 < 0"),
        ("x*y > 1", "x*y > 1"),
        ("min(x, y) <= 0", "min(x, y) <= 0"),
        ("min(x^3, y) <= 0", "x <= 0 or y <= 0"),
        ("x^2.5 <= 0", "x^2.5 <= 0"),
    ],
)
def test_a_comparison_with_zero_is_split_into_what_it_says(text: str, split: str) -> None:
    assert str(factored_guard(parse(text))) == split
