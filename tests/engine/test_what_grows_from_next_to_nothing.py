"""What is less than the last place of what is beside it, and grows by itself, as light does."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

SOLVERS = ["auto", "radau", "rk45"]
LOSS = 0.5


def laser(
    seed: float,
    pumped: float = 1.0,
    *,
    large: float = 1.0,
    current: float = 0.0,
    spark: float = 0.0,
    back: bool = False,
) -> hb.Model:
    """Return a store that feeds light by as much as there is of both, and light that leaves."""
    m = hb.Model("laser")
    gain = hb.R({"f": ["e1*e2", "-e1*e2"]})
    if back:
        m.add(light=hb.C(1.0, e=seed), b=hb.Zero(), leaves=hb.R(1.0 / LOSS))
        m.add(gain=gain, a=hb.Zero(), pump=hb.C(large, e=pumped))
        m.bond("b -> leaves", "b -> gain.2", "b -> light", "a -> gain.1", "a -> pump")
    else:
        m.add(a=hb.Zero(), pump=hb.C(large, e=pumped), gain=gain)
        m.add(b=hb.Zero(), light=hb.C(1.0, e=seed), leaves=hb.R(1.0 / LOSS))
        m.bond("a -> pump", "a -> gain.1", "b -> gain.2", "b -> light", "b -> leaves")
    if current > 0.0:
        m.add(feed=hb.Sf(current))
        m.bond("feed -> a")
    if spark > 0.0:
        m.add(spark=hb.Sf(spark))
        m.bond("spark -> b")
    return m


def by_logarithm(
    seed: float, pumped: float, large: float, current: float, until: float
) -> Callable[[float], np.ndarray]:
    """Return the pump and the logarithm of the light, by SciPy."""

    def rates(_: float, y: np.ndarray) -> list[float]:
        return [(current - y[0] * math.exp(y[1])) / large, y[0] - LOSS]

    found = solve_ivp(
        rates,
        (0.0, until),
        [pumped, math.log(seed)],
        method="LSODA",
        rtol=1e-11,
        atol=1e-12,
        max_step=until / 200.0,
        dense_output=True,
    )
    sol: Callable[[float], np.ndarray] = found.sol
    return sol


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize(("seed", "large"), [(1e-19, 100.0), (1e-22, 1.0), (1e-30, 1.0)])
def test_light_from_next_to_nothing(seed: float, large: float, back: bool, solver: str) -> None:
    """It is followed by its own size, however little of the energy there it is."""
    until = -math.log(seed) / 0.5 + 4.0
    want = by_logarithm(seed, 1.0, large, 0.0, until)
    run = hb.simulate(laser(seed, large=large, back=back), until=until, solver=solver)
    for part in (0.3, 0.6, 0.9, 1.0):
        pump, light = want(part * until)
        assert run["pump.e"].at(part * until) == pytest.approx(pump, rel=3e-4)
        assert run["light.e"].at(part * until) == pytest.approx(math.exp(light), rel=3e-4)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("large", [1.0, 10.0])
def test_gain_that_comes_later(large: float, solver: str) -> None:
    """Light dies out until there is more gain than loss, in the middle of a step."""
    seed, until = 1e-17, 110.0
    want = by_logarithm(seed, 1e-3, large, 0.01 * large, until)
    m = laser(seed, 1e-3, large=large, current=0.01 * large)
    run = hb.simulate(m, until=until, solver=solver)
    for t in (20.0, 50.0, 80.0, 95.0, 100.0):
        assert run["light.e"].at(t) == pytest.approx(math.exp(want(t)[1]), rel=2e-3)


@pytest.mark.parametrize("solver", SOLVERS)
def test_light_from_a_spark(solver: str) -> None:
    """Light that begins as nothing at all, of a source that gives next to nothing."""
    until = 80.0
    m = laser(0.0, large=1e3, spark=1e-24)
    run = hb.simulate(m, until=until, solver=solver)
    for t in (20.0, 50.0, 80.0):
        light = 1e-24 * math.expm1(0.5 * t) / 0.5  # the pump loses nothing to speak of
        assert run["light.e"].at(t) == pytest.approx(light, rel=2e-3)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("seed", [1e-20, 1e-25])
def test_swings_that_grow_from_next_to_nothing(seed: float, solver: str) -> None:
    """A circuit that swings, kept up by a large store: a coil and a capacitor grow together."""
    m = hb.Model("swings")
    m.add(store=hb.C(100.0, e=1.0), a=hb.Zero(), up=hb.R({"f": ["0.5*e2^2", "-0.5*e1*e2"]}))
    m.add(b=hb.Zero(), c=hb.C(1.0), coil=hb.I(1.0, f=seed), loss=hb.R(10.0))
    m.bond("a -> store", "a -> up.1", "b -> up.2", "b -> c", "b -> coil", "b -> loss")
    until = -math.log(seed) / 0.2 + 3.0

    def rates(_: float, y: np.ndarray) -> list[float]:
        return [-0.5 * y[1] ** 2 / 100.0, 0.5 * y[0] * y[1] - 0.1 * y[1] - y[2], y[1]]

    want = solve_ivp(
        rates, (0.0, until), [1.0, 0.0, seed], method="DOP853", rtol=1e-11, atol=1e-10 * seed
    )
    run = hb.simulate(m, until=until, solver=solver)
    found = [run[f"{n}"].at(until) for n in ("store.e", "c.e", "coil.f")]
    assert found == pytest.approx(want.y[:, -1], rel=5e-3, abs=1e-3)
    assert abs(want.y[1, -1]) + abs(want.y[2, -1]) > 0.3


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(("dark", "dies"), [(1e-19, 0.2), (1e-19, 1e-9), (1e-21, 0.02)])
def test_what_dies_out_hides_nothing_that_grows(dark: float, dies: float, solver: str) -> None:
    """Of two that are next to nothing the larger dies out, and the other grows."""
    seed = 1e-24
    m = laser(seed, large=1e3)
    m.add(d=hb.Zero(), dark=hb.C(1.0, e=dark), fades=hb.R({"f": f"{dies}*e + e^3"}))
    m.add(tie=hb.R({"f": ["0*e1", "1e-30*e2"]}))
    m.bond("d -> dark", "d -> fades", "a -> tie.1", "d -> tie.2")
    run = hb.simulate(m, until=90.0, solver=solver)
    assert run["light.e"].at(90.0) == pytest.approx(seed * math.exp(45.0), rel=2e-3)
