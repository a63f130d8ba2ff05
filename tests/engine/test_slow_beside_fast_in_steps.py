"""Slow motions beside fast ones keep their digits in implicit steps, and those stay few.

Rates were rounded by more than the leak is, and so was the Jacobian: a motion of three seconds took
40 000 steps and was up to 28 % off, status ok. Where what is fast is more than 1e16 steps of them
long, factors of a step were rounded by more than what both lose by a leak: 8 000 steps, up to 21 %
off, status ok.
"""

from __future__ import annotations

import pytest
from engine.slow_models import LINEAR, NETWORKS, System, held, of_pair, pair, switched

import hybond as hb


@pytest.mark.parametrize("name", LINEAR)
def test_radau(name: str) -> None:
    stepped(LINEAR[name](), "radau", 1e-7)


@pytest.mark.parametrize("name", ["of three scales", "fed", "for 1e25 times the fastest"])
def test_a_network(name: str) -> None:
    stepped(NETWORKS[name](), "radau", 1e-7, rtol=1e-9)


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("bent", [False, True])
@pytest.mark.parametrize("r", [1e-14, 1e-15, 1e-16, 1e-18])
def test_steps_that_are_many_times_what_is_fast(r: float, bent: bool, back: bool) -> None:
    m = pair(back=back, r=r)
    if bent:
        beside_bent(m)
    stepped(of_pair(m, back=back, until=2.0, r=r), "auto" if bent else "radau", 1e-7)


@pytest.mark.parametrize(
    "name",
    [
        "that leaks beside",
        "of next to no and next to all resistance",
        "that is level",
        "that begins with nothing",
        "fed for years",
    ],
)
def test_a_network_beside_a_law_that_is_bent(name: str) -> None:
    """What joins it nowhere takes the mode from those that are propagated, and changes nothing."""
    m, until, ends = NETWORKS[name]()
    beside_bent(m)
    stepped((m, until, ends), "auto", 1e-5)


def test_a_switched_pair() -> None:
    stepped(switched(), "radau", 1e-8)


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("bent", ["storage", "law"])
def test_beside_what_bends(bent: str, back: bool) -> None:
    """Where something else in the model is not linear, `auto` makes such steps, too."""
    m = pair(back=back)
    m.add(y=hb.C({"e": "q + sinh(q)"}, q=0.1) if bent == "storage" else hb.C(1.0, q=0.1))
    m.add(o=hb.One(), x=hb.R({"e": "f + sinh(f)"}) if bent == "law" else hb.R(1.0))
    m.bond("y -> o -> x")
    m.signal(went=hb.Integral("r.f"))
    m, until, ends = of_pair(m, back=back)
    ends["went"] = -ends["b.q"] if back else 5e-6 - ends["a.q"]
    run = stepped((m, until, ends), "auto", 1e-8)
    assert run.turns


def beside_bent(m: hb.Model) -> None:
    """Put something beside a model that is not linear, and joins it nowhere."""
    m.add(x=hb.C(1.0, e=1.0), y=hb.R("1 + y.f^2"), o=hb.Zero())
    m.bond("o -> x", "o -> y")


def stepped(system: System, solver: str, rel: float, *, rtol: float = 1e-8) -> hb.Result:
    m, until, ends = system
    run = hb.simulate(m, until, solver=solver, rtol=rtol)
    held(run, until, ends, rel)
    assert run.stats["steps"] < 1000
    return run
