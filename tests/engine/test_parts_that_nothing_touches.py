"""What begins at its equilibrium, and that nothing touches, stands: rounding moves nothing.

The force of a spring is a product of decimals, the weight another one, and their difference 1e-15 N
that is nobody's. What is truly beside its equilibrium, or is touched, moves as closed forms say.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
from scipy.optimize import brentq

import hybond as hb

SOLVERS = ["auto", "exact", "rk45", "radau"]
M, K, G = 8.49, 668.5, 8.31
Family = Callable[[float, float, float], hb.Model]
VALUES = [(5.64, 670.2, 7.18), (M, K, G), (0.36, 424.4, 8.5), (4.27, 229.4, 4.94)]
"""Mass, stiffness, acceleration, ...: the products of most of these are rounded."""


def hanging(m: float, k: float, g: float) -> hb.Model:
    model = hb.Model("hanging", domain="translational")
    model.add(i=hb.I(m), c=hb.C(1 / k, q=m * g / k), v=hb.One(), weight=hb.Se(m * g))
    model.bond("weight -> v -> i", "v -> c")
    return model


def pushed_later(m: float, k: float, g: float) -> hb.Model:
    """What pushes does so behind the end of the run."""
    model = hanging(m, k, g)
    model.add(push=hb.Se("if time >= 5 [s] then 2 [N] else 0 [N]"))
    model.bond("push -> v")
    return model


def hanging_on_two(m: float, k: float, g: float) -> hb.Model:
    """The bonds of the source and of one spring point the other way."""
    model = hb.Model("two springs", domain="translational")
    stretch = m * g / (k + 0.37 * k)
    model.add(i=hb.I(m), c=hb.C(1 / k, q=stretch), d=hb.C(1 / (0.37 * k), q=-stretch))
    model.add(v=hb.One(), weight=hb.Se(-m * g))
    model.bond("v -> weight", "v -> i", "v -> c", "d -> v")
    return model


def charged(m: float, k: float, g: float) -> hb.Model:
    model = hb.Model("charged", domain="electrical")
    model.add(c=hb.C(m, q=m * g), r=hb.R(k), l=hb.I(0.3), v=hb.One(), s=hb.Se(g))
    model.bond("s -> v -> c", "v -> r", "v -> l")
    return model


def divided(m: float, k: float, g: float) -> hb.Model:
    model = hb.Model("divided", domain="electrical")
    model.add(c=hb.C("1 mF", q=1e-3 * (g * k / (k + m))), n=hb.Zero(), v=hb.One(), s=hb.Se(g))
    model.add(x=hb.R(m), y=hb.R(k), l=hb.I(0.2, p=0.2 * (g / (k + m))))
    model.bond("s -> v -> n -> c", "v -> x", "v -> l", "n -> y")
    return model


def at_ambient(m: float, k: float, g: float) -> hb.Model:
    model = hb.Model("warm", domain="electrical")
    model.add(c=hb.C(m, q=m * g), r=hb.R(k), v=hb.One(), ambient=hb.Se(g))
    model.bond("ambient -> v -> c", "v -> r")
    return model


def level(m: float, k: float, g: float) -> hb.Model:
    """Two tanks with a pipe between them, the water in which has a mass."""
    model = hb.Model("tanks", domain="hydraulic")
    model.add(a=hb.C(m, q=m * g), b=hb.C(k, q=k * g), water=hb.I(0.1), v=hb.One(), r=hb.R(0.5))
    model.bond("a -> v -> b", "v -> water", "v -> r")
    return model


def geared(m: float, k: float, g: float) -> hb.Model:
    model = hb.Model("geared", domain="rotational")
    model.add(i=hb.I(m), c=hb.C(1 / k, q=g / k * 7 / 3), n=hb.TF(3 / 7), v=hb.One(), u=hb.One())
    model.add(s=hb.Se(g))
    model.bond("s -> v -> i", "v -> n -> u -> c")
    return model


def on_a_cubic(m: float, k: float, g: float) -> hb.Model:
    model = hb.Model("cubic spring", domain="translational")
    model.add(i=hb.I(m), v=hb.One(), weight=hb.Se(m * g), r=hb.R(k))
    model.add(c=hb.C({"e": f"{k}*q^3"}, q=(m * g / k) ** (1 / 3)))
    model.bond("weight -> v -> i", "v -> c", "v -> r")
    return model


def on_hard_and_soft(m: float, k: float, g: float) -> hb.Model:
    """A spring that hardens beside a straight one, whose bond points the other way."""
    model = hb.Model("hard and soft", domain="translational")
    q = brentq(lambda q: 1.37 * k * q + 4 * k * q**3 - m * g, 0, 1, xtol=1e-17, rtol=1e-15)
    model.add(i=hb.I(m), c=hb.C({"e": f"{k}*q + {4 * k}*q^3"}, q=q), d=hb.C(1 / (0.37 * k), q=-q))
    model.add(v=hb.One(), weight=hb.Se(-m * g))
    model.bond("v -> weight", "v -> i", "v -> c", "d -> v")
    return model


def bent_wheel(m: float, k: float, g: float) -> hb.Model:
    """What is bent is an inertia, which turns as fast as its spring is driven."""
    model = hb.Model("bent wheel", domain="rotational")
    p = m * g
    model.add(
        s=hb.Sf(p / m + 0.1 * p**3), n=hb.Zero(), c=hb.C(1 / k), i=hb.I("1 kg*m^2"), v=hb.One()
    )
    model.elements["i"] = hb.I({"f": f"p/{m} + 0.1*p^3"}, p=p)
    model.bond("s -> n -> v -> i", "n -> c")
    return model


def watched(model: hb.Model, guard: str) -> hb.Model:
    rules = [f"rests -> moved when {guard}"]
    model.machine("watch", states={"rests": [], "moved": []}, start="rests", rules=rules)
    model.machine("clock", states={"a": [], "b": []}, start="a", rules=["a -> b when time >= 0.3"])
    return model


def moved_at(run: hb.Result) -> list[float]:
    return [float(event.t) for event in run.events if event.steps[-1].mode[0] == 1][:1]


FAMILIES = [hanging, pushed_later, hanging_on_two, charged, divided, at_ambient, level, geared]
BENT = [on_a_cubic, on_hard_and_soft, bent_wheel]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("family", [*FAMILIES, *BENT], ids=lambda family: family.__name__)
def test_rounding_fires_no_guard(family: Family, solver: str) -> None:
    flow = {divided: "c.f", bent_wheel: "c.e"}.get(family, "v.f")
    for values in VALUES:
        for sign in "><":
            run = hb.simulate(watched(family(*values), f"{flow} {sign} 0"), 3, solver=solver)
            assert moved_at(run) == []
            stored = "a.q" if family is level else "c.q"
            assert run[stored].at(3) == run[stored].at(0)


@pytest.mark.parametrize("solver", ["auto", "exact"])
@pytest.mark.parametrize("aside", [1e-3, 1e-9, 1e-12, -1e-12, 1e-13])
def test_what_is_beside_its_equilibrium_swings(aside: float, solver: str) -> None:
    model = hanging(M, K, G)
    model.elements["c"] = hb.C(1 / K, q=M * G / K * (1 + aside))
    run = hb.simulate(watched(model, "v.f > 0"), 3, solver=solver)
    half = math.pi * math.sqrt(M / K)
    # what is left of the digits of the stretch is all that is known of the swing
    assert moved_at(run) == pytest.approx([half if aside > 0 else 0.0], abs=1e-15 / abs(aside))


@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize("aside", [1e-4, -1e-4])
def test_what_is_beside_its_equilibrium_on_a_bent_spring_swings(aside: float, solver: str) -> None:
    """A hardening spring alone; its stiffness there is three times its force by its stretch."""
    model = hb.Model("cubic spring", domain="translational")
    stretch = (M * G / K) ** (1 / 3)
    model.add(i=hb.I(M), v=hb.One(), weight=hb.Se(M * G))
    model.add(c=hb.C({"e": f"{K}*q^3"}, q=stretch * (1 + aside)))
    model.bond("weight -> v -> i", "v -> c")
    run = hb.simulate(watched(model, "v.f > 0"), 3, solver=solver)
    half = math.pi * math.sqrt(M / (3 * K)) / stretch
    assert moved_at(run) == pytest.approx([half if aside > 0 else 0.0], rel=1e-4, abs=1e-12)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("touch", ["switch", "clock", "ramp", "neighbour"])
def test_what_is_touched_moves(touch: str, solver: str) -> None:
    """A force that begins at 0.5 s, or grows from there on; a neighbour that moves all the time."""
    model = hanging(M, K, G)
    force, rate = 3.0, math.sqrt(K / M)
    after = 0.5
    if touch == "switch":
        model.add(push=hb.Se(f'if hand.state == "on" then {force} [N] else 0 [N]'))
        model.bond("push -> v")
        rules = ["off -> on when time >= 0.5"]
        model.machine("hand", states={"off": [], "on": []}, start="off", rules=rules)
        way = force / M / rate * math.sin(rate * (2 - after))
    elif touch == "clock":
        model.add(push=hb.Se(f"if time >= 0.5 [s] then {force} [N] else 0 [N]"))
        model.bond("push -> v")
        way = force / M / rate * math.sin(rate * (2 - after))
    elif touch == "ramp":
        model.add(push=hb.Se(f"{force} [N/s]*max(time - 0.5 [s], 0 [s])"))
        model.bond("push -> v")
        way = force / K * (1 - math.cos(rate * (2 - after)))
    else:
        # another mass on a like spring, three times as stiff a one between: two normal modes
        model.add(
            j=hb.I(M), d=hb.C(1 / (3 * K), q=0.02), w=hb.Zero(), u=hb.One(), e=hb.C(1 / K, q=0.02)
        )
        model.bond("u -> j", "u -> e", "u -> w -> v", "w -> d")
        slow, fast = rate, rate * math.sqrt(7.0)
        way = 0.5 * (-0.02) * (slow * math.sin(slow * 2) - fast * math.sin(fast * 2))
    run = hb.simulate(model, 2, solver=solver)
    assert run["v.f"].at(2) == pytest.approx(way, rel=1e-5, abs=1e-7)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("force", [3.0, -1e-3, 1e-6])
@pytest.mark.parametrize("cut", [0.4, 0.5, 0.6])
def test_a_run_that_ends_where_something_is_touched_goes_on(
    cut: float, force: float, solver: str
) -> None:
    model = hanging(M, K, G)
    model.add(push=hb.Se(f'if hand.state == "on" then {force} [N] else 0 [N]'))
    model.bond("push -> v")
    rules = ["off -> on when time >= 0.5"]
    model.machine("hand", states={"off": [], "on": []}, start="off", rules=rules)
    run = hb.simulate(model, 2.0, start=hb.simulate(model, cut, solver=solver), solver=solver)
    rate = math.sqrt(K / M)
    moved = force / K * (1.0 - math.cos(1.5 * rate))
    # steps with an error of their own are right to 1e-8 of the stretch
    assert run.final["c.q"] - M * G / K == pytest.approx(moved, rel=1e-5, abs=3e-10)


@pytest.mark.parametrize("solver", ["auto", "exact"])
@pytest.mark.parametrize("cut", [0.0352, 0.036, 0.038, 0.04])
def test_what_has_come_to_rest_goes_on_as_if_it_had_not_been_cut(cut: float, solver: str) -> None:
    """What stands is sought where a motion begins, not where a run goes on: the same to the bit."""
    model = hb.Model("charged", domain="electrical")
    model.add(s=hb.Se(7.3), r=hb.R(1.0), c=hb.C("1 mF"), v=hb.One())
    model.bond("s -> v -> r", "v -> c")
    whole = hb.simulate(model, 0.05, solver=solver)
    first = hb.simulate(model, cut, solver=solver)
    assert hb.simulate(model, 0.05, start=first, solver=solver).final == whole.final
