"""Motions that begin as nothing: by a power of time, by a tail of a bell curve, by a tanh.

Oracles: integrals of the forces in closed form; masses that are tied share them.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

import hybond as hb


def tied(force: str) -> hb.Model:
    m = hb.Model("tied", domain="translational")
    m.add(F=hb.Se(force), a=hb.I("1 kg"), b=hb.I("2 kg"), v=hb.One())
    m.bond("F -> v -> a", "v -> b")
    return m


def geared(force: str) -> hb.Model:
    m = hb.Model("geared", domain="translational")
    m.add(F=hb.Se(force), a=hb.I("1 kg"), b=hb.I("2 kg"), v=hb.One(), w=hb.One(), t=hb.TF("3"))
    m.bond("F -> v -> a", "v -> t -> w -> b")
    return m


def free(force: str) -> hb.Model:
    m = hb.Model("free", domain="translational")
    m.add(F=hb.Se(force), a=hb.I("1 kg"), v=hb.One())
    m.bond("F -> v -> a")
    return m


SHARES = {tied: 1.0 / 3.0, geared: 1.0 / 19.0, free: 1.0}
"""What the first mass has of the impulse: a gear of 3 makes 2 kg into 18."""


@pytest.mark.parametrize("width", [0.01, 0.0187, 0.02])
@pytest.mark.parametrize("made", SHARES)
def test_a_bell_curve_from_numbers_next_to_zero(
    made: Callable[[str], hb.Model], width: float
) -> None:
    run = hb.simulate(made(f"1 N*exp(-((time - 0.5 s)/({width} s))^2)"), "1 s")
    assert run.status == "ok"
    impulse = width * math.sqrt(math.pi)
    assert float(run["a.p"].at(1.0)) == pytest.approx(SHARES[made] * impulse, rel=1e-6)
    assert run.stats["steps"] < 2500.0


@pytest.mark.parametrize("made", SHARES)
def test_a_tanh_from_its_tail(made: Callable[[str], hb.Model]) -> None:
    run = hb.simulate(made("1 N*(1 + tanh((time - 0.4567 s)/(1e-3 s)))"), "1 s")
    impulse = 2.0 * (1.0 - 0.4567)
    assert float(run["a.p"].at(1.0)) == pytest.approx(SHARES[made] * impulse, rel=1e-6)


def test_a_power_of_time_with_an_atol_of_nothing() -> None:
    # t**40 at the first step is far below the smallest number that has digits
    run = hb.simulate(free("1 N*(time/(1 s))^40"), "1 s")
    assert float(run["a.p"].at(1.0)) == pytest.approx(1.0 / 41.0, rel=1e-6)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("drive", "power"), [("1", 1), ("time", 2)])
@pytest.mark.parametrize("many", [4, 6])
def test_radau_integrates_what_one_storage_has_again_and_again(
    many: int, drive: str, power: int, turned: bool
) -> None:
    """Each integral leaves rest an iteration after the one before it: no step was short enough."""
    m = hb.Model("integrals")
    m.add(s=hb.Sf(drive), c=hb.C(1.0), n=hb.Zero())
    m.bond("s -> n", "c -> n" if turned else "n -> c")
    before = "n.e"
    for k in range(2, many + 1):
        m.signal(**{f"x{k}": hb.Integral(before)})
        before = f"x{k}"
    run = hb.simulate(m, until=2.0, solver="radau")
    n = many + power - 1
    assert run[before].at(2.0) == pytest.approx(2.0**n / math.factorial(n), rel=1e-6)
