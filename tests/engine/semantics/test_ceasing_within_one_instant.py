"""What ceases to hold within one instant makes no cycle: there is a mode in which time goes on."""

from __future__ import annotations

import math

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


SLOW = [(-1e-3, 1e-3), (-1e-6, 1e-7), (-1e-9, 1e-4), (-1e-11, 1e-3), (-1e-12, 0.1), (-1e-15, 0.1)]


def charged(
    slow: float,
    at: float,
    resistance: float = 0.0,
    rules: list[str] | None = None,
    *,
    turned: bool = False,
) -> hb.Model:
    """The same, put onto 2 V by a switch at an instant; B through a resistance if there is one."""
    m = falling(rules or HYSTERESIS, (-1.0, slow), turned=turned)
    for name in "AB":
        m.add({f"u{name}": hb.Se(2.0), f"w{name}": hb.One()})
        m.bond(f"u{name} -> w{name} -> z{name}")
    if resistance:
        m.add(rB=hb.R(resistance))
        m.bond("wB -> rB")
    states = {"off": [], "on": ["wA", "wB"]}
    m.machine("sw", states=states, start="off", rules=[f"off -> on when time >= {at}"])
    return m


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("slow", "at"), SLOW)
def test_what_has_fallen_off_its_threshold_is_asked_where_it_jumps_beyond(
    slow: float, at: float, turned: bool, solver: str
) -> None:
    """It was deaf up to a moment long after that, and then found nothing that was crossed."""
    run = hb.simulate(charged(slow, at, turned=turned), 1.0, solver=solver)
    assert run.status == "ok"
    assert ends(run)[-2:] == [(pytest.approx(0.0, abs=1e-11), "a"), (at, "b")]


@pytest.mark.parametrize("solver", SOLVERS)
def test_momenta_that_have_fallen_off_are_asked_where_they_jump_beyond(solver: str) -> None:
    """The dual."""
    m = hb.Model("braked")
    for name, force, speed in (("A", -1.0, 1.0), ("B", -1e-9, 0.5)):
        m.add({name: hb.I(1.0, p=speed), f"s{name}": hb.Se(force), f"w{name}": hb.One()})
        m.add({f"u{name}": hb.Sf(2.0), f"z{name}": hb.Zero()})
        m.bond(f"s{name} -> w{name} -> {name}", f"u{name} -> z{name} -> w{name}")
    rules = ["b -> a when A.f < 1", "a -> b when B.f >= 0.5"]
    m.machine("m", states={"a": [], "b": []}, start="a", rules=rules)
    states = {"off": [], "on": ["zA", "zB"]}
    m.machine("sw", states=states, start="off", rules=["off -> on when time >= 1e-4"])
    run = hb.simulate(m, 1.0, solver=solver)
    assert run.status == "ok"
    assert ends(run)[-1] == (1e-4, "b")


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(("slow", "at"), [(-1e-3, 0.1), (-1e-9, 1e-4), (-1e-11, 1e-3)])
def test_what_has_fallen_off_its_threshold_is_asked_where_a_switch_turns_it(
    slow: float, at: float, solver: str
) -> None:
    """B.q is 0.5 + slow * at there, and goes on to 2 with a time constant of 10 ms."""
    run = hb.simulate(charged(slow, at, 1e-2), 1.0, solver=solver)
    assert run.status == "ok"
    back = 1e-2 * math.log1p(-slow * at / 1.5)
    assert ends(run)[-1] == (pytest.approx(at + back, abs=1e-11), "b")


@pytest.mark.parametrize("solver", SOLVERS)
def test_either_of_two_comparisons_wakes_what_waits(solver: str) -> None:
    """B is not told from its threshold all along; A is beyond the other one at once."""
    rules = ["b -> a when A.q < 1", "a -> b when B.q >= 0.5 or A.q > 1.5"]
    model = falling(rules, (-1.0, -1e-15))
    model.add(u=hb.Se(2.0), w=hb.One())
    model.bond("u -> w -> zA")
    states = {"off": [], "on": ["w"]}
    model.machine("sw", states=states, start="off", rules=["off -> on when time >= 0.1"])
    run = hb.simulate(model, 1.0, solver=solver)
    assert run.status == "ok"
    assert ends(run)[-1] == (0.1, "b")


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("size", [1e-3, 1e-9])
def test_what_turns_by_itself_after_it_has_fallen_off_is_asked(size: float, solver: str) -> None:
    """B.q - 0.5 is size (t^2 - t), so at its threshold again at 1 s; A is above its own then."""
    m = hb.Model("turning")
    rates = {"A": "4*time - 1", "B": f"{size}*(2*time - 1)"}
    for name, q in (("A", 1.0), ("B", 0.5)):
        m.add({name: hb.C(1.0, q=q), f"s{name}": hb.Sf(rates[name]), f"z{name}": hb.Zero()})
        m.bond(f"s{name} -> z{name} -> {name}")
    m.machine("m", states={"a": [], "b": []}, start="a", rules=HYSTERESIS)
    run = hb.simulate(m, 3.0, solver=solver)
    assert run.status == "ok"
    assert ends(run)[-1] == (pytest.approx(1.0, abs=2e-13 / size), "b")


@pytest.mark.parametrize("solver", SOLVERS)
def test_what_jumps_elsewhere_leaves_what_has_fallen_off_where_it_is(solver: str) -> None:
    """Nothing of it is reached by the jump: no cycle (HB-N401), and no other mode."""
    model = falling(HYSTERESIS, (-1.0, -1e-12))
    model.add(D=hb.C(1.0, q=0.1), u=hb.Se(2.0), w=hb.One())
    model.bond("u -> w -> D")
    states = {"off": [], "on": ["w"]}
    model.machine("sw", states=states, start="off", rules=["off -> on when time >= 0.1"])
    run = hb.simulate(model, 1.0, solver=solver)
    assert run.status == "ok"
    assert ends(run)[-1][1] == "a"
    assert run["D.q"].at(1.0) == pytest.approx(2.0, rel=1e-14)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_run_that_goes_on_is_asked_where_what_waited_jumps_beyond(solver: str) -> None:
    model = charged(-1e-12, 0.1)
    first = hb.simulate(model, 0.05, solver=solver)
    run = hb.simulate(model, 1.0, start=first, solver=solver)
    assert run.status == "ok"
    assert ends(run)[-1] == (0.1, "b")


@pytest.mark.parametrize("slow", [-1e-9, -1e-12, -1e-15])
def test_what_has_fallen_off_its_threshold_waits_from_step_to_step(slow: float) -> None:
    """Each fixed step is an instant: none of them is a cycle (HB-N401), or an event."""
    run = hb.simulate(charged(slow, 0.1), 1.0, solver="moreau-jean", step=1e-3)
    assert run.status == "ok"
    assert ends(run) == [(0.0, "b"), (pytest.approx(0.001), "a"), (pytest.approx(0.1), "b")]


@pytest.mark.parametrize("solver", ["rk45", "radau", "exact"])
@pytest.mark.parametrize("slow", [-1e-12, -1e-15])
def test_samples_leave_what_has_fallen_off_where_it_is(slow: float, solver: str) -> None:
    model = charged(slow, 0.1)
    model.signal(seen=hb.Sampled("A.q", every=1e-2))
    run = hb.simulate(model, 1.0, solver=solver)
    assert run.status == "ok"
    found = ends(run)
    assert len(found) == 3
    assert found[-1] == (0.1, "b")
