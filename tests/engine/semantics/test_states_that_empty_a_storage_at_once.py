"""A machine passes a state whose jump empties a storage; what fills it again pushes the same way.

That looked like a contact which is struck without a rebound and then pressed, and was put to rest
there for good: nothing had asked whether it is struck again.
"""

from typing import Literal

import numpy as np
import pytest

import hybond as hb

SOLVERS = ["auto", "radau", "rk45", "exact"]
Solver = Literal["auto", "radau", "rk45", "exact"]


def filled(rules: list[str], states: dict[str, list[str]], *, turned: bool, dual: bool) -> hb.Model:
    """What is stored rises by 1 a second, but where ``sw`` is on: there it is nothing."""
    m = hb.Model("filled")
    one, zero = (hb.Zero, hb.One) if dual else (hb.One, hb.Zero)
    m.add(z=zero(), sw=one())
    if dual:
        m.add(s=hb.Se(1.0), c=hb.I(1.0), g=hb.Sf(0.0))
    else:
        m.add(s=hb.Sf(1.0), c=hb.C(1.0), g=hb.Se(0.0))
    m.bond("s -> z", "z -> c", *(("sw -> z", "g -> sw") if turned else ("z -> sw", "sw -> g")))
    text = [rule.replace("Q", "c.p" if dual else "c.q") for rule in rules]
    m.machine("A", states=states, start=next(iter(states)), rules=text)
    return m


WAYS = {
    "by_another": (
        {"rev": [], "idle": ["sw"], "fwd": []},
        [
            "rev -> idle when Q > 2",
            "idle -> fwd when pre(A.state == 'idle')",
            "fwd -> rev when Q > 1.5",
        ],
    ),
    "back": (
        {"rev": [], "idle": ["sw"]},
        ["rev -> idle when Q > 2", "idle -> rev when pre(A.state == 'idle')"],
    ),
    "by_two": (
        {"rev": [], "idle": ["sw"], "fwd": [], "up": []},
        [
            "rev -> idle when Q > 2",
            "idle -> fwd when pre(A.state == 'idle')",
            "fwd -> up when Q > 0.5",
            "up -> rev when Q > 1",
        ],
    ),
}


@pytest.mark.sampled(6)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("turned", [False, True], ids=["on", "turned"])
@pytest.mark.parametrize("dual", [False, True], ids=["charge", "momentum"])
@pytest.mark.parametrize("end", [7.0, 8.0])
def test_it_is_emptied_every_two_seconds(
    end: float, dual: bool, turned: bool, way: str, solver: Solver
) -> None:
    states, rules = WAYS[way]
    m = filled(rules, states, turned=turned, dual=dual)
    run = hb.simulate(m, end, solver=solver)
    at = np.linspace(0.013, end - 0.021, 157)
    stored = run["c.p" if dual else "c.q"].at(at)
    assert stored == pytest.approx(at % 2.0, abs=1e-9)
    emptied = [e.t for e in run.events if any(v.impulses for v in e.steps)]
    assert emptied == pytest.approx(np.arange(2.0, end + 0.5, 2.0))


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("turned", [False, True], ids=["on", "turned"])
def test_it_is_emptied_once_and_left_for_good(turned: bool, solver: Solver) -> None:
    states = {"on": [], "dump": ["sw"], "done": []}
    rules = ["on -> dump when Q > 2", "dump -> done when pre(A.state == 'dump')"]
    m = filled(rules, states, turned=turned, dual=False)
    run = hb.simulate(m, 10.0, solver=solver)
    assert run.mode["A"] == "done"
    assert run["c.q"].at([1.0, 2.5, 10.0]) == pytest.approx([1.0, 0.5, 8.0], abs=1e-9)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_second_machine_says_when(solver: Solver) -> None:
    states = {"on": [], "dump": ["sw"]}
    rules = ["on -> dump when B.state == 'go'", "dump -> on when pre(A.state == 'dump')"]
    m = filled(rules, states, turned=False, dual=False)
    m.machine(
        "B",
        states={"wait": [], "go": []},
        start="wait",
        rules=["wait -> go when c.q > 2", "go -> wait when pre(B.state == 'go')"],
    )
    run = hb.simulate(m, 7.0, solver=solver)
    assert run["c.q"].at([1.0, 3.0, 5.5, 7.0]) == pytest.approx([1.0, 1.0, 1.5, 1.0], abs=1e-9)


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_a_ball_whose_contact_has_a_state_before_it_comes_to_rest(
    restitution: float, solver: Literal["auto", "radau", "rk45"]
) -> None:
    m = hb.Model("ball", domain="translational")
    m.add(v=hb.One(), i=hb.I(1.0), g=hb.Se(-9.81), floor=hb.Zero(), e=hb.Sf("E*pre(v.f)"))
    m.parameter(E=restitution)
    m.bond("g -> v", "v -> i", "v -> floor", "e -> floor")
    m.signal(x=hb.Integral("v.f", start=1.0))
    m.machine(
        "c",
        states={"free": [], "near": [], "hit": ["floor"]},
        start="free",
        rules=[
            "free -> near when x <= 0",
            "near -> hit when v.f < 0",
            "near -> free when v.f > 0 and x > 0",
            "hit -> free when pre(c.state == 'hit')",
        ],
    )
    run = hb.simulate(m, 3.0, solver=solver)
    assert run.status == "ok"
    assert run["v.f"].at(3.0) == pytest.approx(0.0, abs=1e-12)
    assert run["x"].at(3.0) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("solver", SOLVERS)
def test_what_is_put_back_onto_its_own_threshold_is_refused_soon(solver: Solver) -> None:
    m = hb.Model("onto")
    m.add(z=hb.Zero(), s=hb.Sf(-1.0), c=hb.C(0.5), w=hb.One(), g=hb.Se(-1.2))
    m.bond("s -> z", "z -> c", "g -> w", "w -> z")
    rules = [
        "on -> up when c.q < -0.6",
        "up -> put when c.q < 1",
        "put -> on when pre(A.state == 'put')",
    ]
    m.machine("A", states={"on": [], "up": [], "put": ["w"]}, start="on", rules=rules)
    with pytest.raises(hb.NumericsError, match="HB-N404") as said:
        hb.simulate(m, 6.0, solver=solver)
    assert said.value.partial is not None
    assert len(said.value.partial.events) < 20_000
    assert said.value.partial.t_end == pytest.approx(0.6, abs=1e-6)
