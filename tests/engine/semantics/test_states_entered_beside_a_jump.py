"""A rule that compares what jumps is true where it is entered, whatever it jumped over before.

Of what has come to its limit and stands there a guard does not hold by rounding alone. A clock that
has jumped over it stands nowhere near: it was taken for one, and its rule was not asked again up to
the next jump, or for ever.
"""

from __future__ import annotations

import math
from typing import Literal

import pytest

import hybond as hb

Solver = Literal["auto", "rk45", "radau"]

WINDOWS = [
    "floor((time - 0.02)/0.2) > -0.5",
    "mod(floor((time - 0.02)/0.2), 2) < 0.5",
    "sign(sin(31*(time - 0.02))) > 0.5",
    "ceil((time - 0.02)/0.2) > 0.5",
    "floor((time - 0.02)/0.2) > -0.5 and C.e < 3",
]


@pytest.mark.parametrize("guard", WINDOWS)
@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
def test_what_is_true_is_true_again(guard: str, solver: Solver) -> None:
    m = hb.Model("clocked", domain="electrical")
    m.add(V=hb.Se(1.0), j=hb.One(), R=hb.R(1.0), C=hb.C(0.1))
    m.bond("V -> j", "j -> R", "j -> C")
    m.machine(
        "k",
        states={"a": [], "b": [], "c": []},
        start="a",
        rules=[
            f"a -> b when {guard}",
            "b -> c when time >= 0.03 and time < 0.032",
            "c -> a when time >= 0.05 and time < 0.06",
        ],
    )
    run = hb.simulate(m, 0.09, solver=solver)
    found = [(e.t, [s.mode[0] for s in e.steps]) for e in run.events if e.cause != "start"]
    assert [t for t, _ in found] == pytest.approx([0.02, 0.03, 0.05], abs=1e-12)
    assert [modes[-1] for _, modes in found] == [1, 2, 1]


def test_what_leads_to_and_fro_is_refused_though_it_has_jumped() -> None:
    m = hb.Model("endless")
    m.add(s=hb.Se(1.0), r=hb.R(1.0))
    m.bond("s -> r")
    rules = ["a -> b when mod(floor((time - 0.02)/0.2), 2) < 0.5", "b -> a when time >= 0.0335"]
    m.machine("k", states={"a": [], "b": []}, start="a", rules=rules)
    with pytest.raises(hb.HybondError, match="HB-N401") as said:
        hb.simulate(m, 0.1)
    assert "0.0335" in str(said.value)


@pytest.mark.parametrize("level", [0.4, 1.7, 3.1])
def test_a_state_that_a_storage_leads_to_is_left_at_once(level: float) -> None:
    """``C.e`` is ``4 (1 - exp(-t))``; the clock has stood at 2 since 0.2 s where it is asked."""
    m = hb.Model("fault", domain="electrical")
    m.add(V=hb.Se(4.0), j=hb.One(), R=hb.R(1.0), C=hb.C(1.0))
    m.bond("V -> j", "j -> R", "j -> C")
    at = -math.log(1.0 - level / 4.0)
    m.machine(
        "k",
        states={"wait": [], "on": [], "fault": []},
        start="wait",
        rules=[
            "wait -> on when floor(time/0.1) > 0",
            f"on -> fault when C.e > {level} and C.e < {level} + 0.001",
            f"fault -> wait when C.e > {level} + 0.002",
        ],
    )
    run = hb.simulate(m, at + 0.05)
    again = -math.log(1.0 - (level + 0.002) / 4.0)
    expected = sorted([0.1, at, again]) if at > 0.1 else [0.1, at, again]
    assert [e.t for e in run.events if e.cause != "start"] == pytest.approx(expected, abs=1e-8)
    assert run.events[-1].steps[-1].mode == (1,)


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("start", [-0.2, 0.0, 0.05])
@pytest.mark.parametrize(("period", "duty"), [(0.05, 0.5), (0.1, 0.2), (0.013, 0.9)])
def test_carriers_go_on_beside_a_relay_that_slides(
    period: float, duty: float, start: float, solver: Solver
) -> None:
    """What a carrier had jumped over before the relay slid ended the run, by HB-N401."""
    m = hb.Model("beside")
    law = '(if clk.state == "a" then 0.4 else -0.45) - (if k.state == "p" then 1 else -1)'
    m.add(S=hb.Sf(law), n=hb.Zero(), X=hb.C(1.0, q=start))
    m.bond("S -> n", "n -> X")
    edge = duty * period
    rules = [
        f"a -> b when mod(time, {period}) >= {edge}",
        f"b -> a when mod(time, {period}) < {edge}",
    ]
    m.machine("clk", states={"a": [], "b": []}, start="a", rules=rules)
    rules = ["p -> m when X.q < 0", "m -> p when X.q > 0"]
    m.machine("k", states={"p": [], "m": []}, start="m", rules=rules)
    run = hb.simulate(m, 0.733, solver=solver)
    assert run.status == "ok"
    edges = [n * period + d for n in range(60) for d in (0.0, edge)]
    expected = sorted(t for t in edges if 0.0 < t < 0.733)
    found = [e.t for e in run.events if any(f.machine == "clk" for s in e.steps for f in s.fired)]
    assert found == pytest.approx(expected, abs=1e-11)
    assert run["X.q"].at(0.73) == pytest.approx(0.0, abs=1e-9)
