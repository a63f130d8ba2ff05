"""What ceases to hold within one instant makes no cycle: there is a mode in which time goes on."""

from __future__ import annotations

import pytest

import hybond as hb

SOLVERS = ["rk45", "radau", "exact", "qss"]
HYSTERESIS = ["b -> a when A.q < 1 [C]", "a -> b when B.q >= 0.5 [C]"]


def falling(
    rules: list[str],
    rates: tuple[float, float],
    *,
    at: tuple[float, float] = (1.0, 0.5),
    start: str = "a",
    turned: bool = False,
    extra: list[str] | None = None,
) -> hb.Model:
    """Two capacitors that are charged, or discharged, at even rates."""
    m = hb.Model("falling")
    for name, rate, q in zip("AB", rates, at, strict=True):
        source, node = f"s{name}", f"z{name}"
        m.add({name: hb.C(1.0, q=q), source: hb.Sf(-rate if turned else rate), node: hb.Zero()})
        m.bond(f"{node} -> {source}" if turned else f"{source} -> {node}", f"{node} -> {name}")
    m.machine("m", states={"a": [], "b": []}, start=start, rules=rules)
    if extra:
        m.machine("other", states={"p": [], "q": []}, start="p", rules=extra)
    return m


def ends(run: hb.Result) -> list[tuple[float, str]]:
    """When each event was, and the state in which time went on."""
    found = []
    for event in run.events:
        fired = [f for step in event.steps for f in step.fired if f.machine == "m"]
        if fired:
            found.append((event.t, fired[-1].target))
    return found


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("slow", [0.3, 0.1, 1e-3])
def test_two_that_fall_off_their_thresholds_at_once_are_no_cycle(
    slow: float, turned: bool, solver: str
) -> None:
    """It was HB-N401: the slower one was at its threshold still, where the other was past it."""
    run = hb.simulate(falling(HYSTERESIS, (-1.0, -slow), turned=turned), 0.4, solver=solver)
    assert run.status == "ok"
    assert ends(run) == [(0.0, "b"), (pytest.approx(0.0, abs=1e-11), "a")]


@pytest.mark.parametrize("solver", SOLVERS)
def test_two_that_come_to_their_thresholds_at_one_instant_are_no_cycle(solver: str) -> None:
    model = falling(HYSTERESIS, (-1.0, -0.1), at=(1.5, 0.55))
    run = hb.simulate(model, 1.0, solver=solver)
    assert run.status == "ok"
    assert ends(run)[-1] == (pytest.approx(0.5, abs=1e-11), "a")


@pytest.mark.parametrize("solver", SOLVERS)
def test_two_that_rise_off_their_thresholds_at_once_are_no_cycle(solver: str) -> None:
    rules = ["b -> a when A.q > 1 [C]", "a -> b when B.q <= 0.5 [C]"]
    run = hb.simulate(falling(rules, (1.0, 0.05)), 0.4, solver=solver)
    assert run.status == "ok"
    assert ends(run)[-1] == (pytest.approx(0.0, abs=1e-11), "a")


@pytest.mark.parametrize("solver", SOLVERS)
def test_speeds_that_fall_off_their_thresholds_at_once_are_no_cycle(solver: str) -> None:
    """The same of masses that are braked."""
    m = hb.Model("braked")
    for name, force, speed in (("A", -1.0, 1.0), ("B", -0.1, 0.5)):
        m.add({name: hb.I(1.0, p=speed), f"s{name}": hb.Se(force), f"w{name}": hb.One()})
        m.bond(f"s{name} -> w{name} -> {name}")
    rules = ["b -> a when A.f < 1", "a -> b when B.f >= 0.5"]
    m.machine("m", states={"a": [], "b": []}, start="a", rules=rules)
    run = hb.simulate(m, 0.4, solver=solver)
    assert run.status == "ok"
    assert ends(run)[-1] == (pytest.approx(0.0, abs=1e-11), "a")


@pytest.mark.parametrize("solver", ["rk45", "radau", "exact"])
def test_what_is_let_go_at_its_threshold_falls_off_it(solver: str) -> None:
    """Its speed is zero there: it leaves its height with the square of time."""
    m = hb.Model("let go")
    m.add(A=hb.C(1.0, q=1.0), s=hb.Sf(-1.0), z=hb.Zero())
    m.bond("s -> z -> A")
    m.add(body=hb.I(1.0), weight=hb.Se(-10.0), v=hb.One())
    m.bond("weight -> v -> body")
    m.signal(height=hb.Integral("body.f", start=0.5))
    rules = ["b -> a when A.q < 1", "a -> b when height >= 0.5"]
    m.machine("m", states={"a": [], "b": []}, start="a", rules=rules)
    run = hb.simulate(m, 0.4, solver=solver)
    assert run.status == "ok"
    assert ends(run)[-1] == (pytest.approx(0.0, abs=1e-6), "a")


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(("rate", "rules"), [
    (-1.0, ["a -> b when A.q <= 0.7", "b -> a when A.q >= 0.7"]),
    (1.0, ["a -> b when A.q >= 1.3", "b -> a when A.q <= 1.3"]),
    (-1.0, ["a -> b when not (A.q > 0.7)", "b -> a when not (A.q < 0.7)"]),
])  # fmt: skip
def test_one_threshold_that_both_rules_have_is_crossed(
    rate: float, rules: list[str], solver: str
) -> None:
    run = hb.simulate(falling(rules, (rate, 0.0)), 1.0, solver=solver)
    assert run.status == "ok"
    assert ends(run) == [(pytest.approx(0.3, abs=1e-11), "b")]


def test_a_run_that_ends_there_goes_on_as_if_it_had_not() -> None:
    model = falling(HYSTERESIS, (-1.0, -1e-3))
    model.experiment["until"] = 1.0
    first = hb.simulate(model, 1e-12)
    second = hb.simulate(model, 1.0, start=first)
    whole = hb.simulate(model, 1.0)
    assert second["B.q"].at(1.0) == pytest.approx(whole["B.q"].at(1.0), rel=1e-14)
    assert [e.t for e in second.events if e.t > 1e-9] == []


CYCLES = [
    # both hold, and go on to
    (HYSTERESIS, (-1.0, 0.1), (1.0, 0.5)),
    (["a -> b when A.q <= 0.7", "b -> a when A.q < 0.7 + 1e-3"], (-1.0, 0.0), (1.0, 0.5)),
    (["a -> b when A.q <= 0.7", "b -> a when time >= 0"], (-1.0, 0.0), (1.0, 0.5)),
    (["a -> b when A.q >= 1.3", "b -> a when not (A.q < 1.3)"], (1.0, 0.0), (1.0, 0.5)),
    # what would cease to hold does not do so within the instant
    (["a -> b when A.q <= 0.7", "b -> a when B.q > 0.5"], (-1.0, -1.0), (1.0, 0.8 + 1e-8)),
]


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(("rules", "rates", "at"), CYCLES)
def test_what_goes_on_to_hold_is_a_cycle(rules, rates, at, solver: str) -> None:
    model = falling(rules, rates, at=at)
    run = hb.simulate(model, 1.0, solver=solver, on_error="return")
    assert run.error is not None
    assert run.error.code == "HB-N401"
