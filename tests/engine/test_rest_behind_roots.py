"""What a law like a root brings to rest in a finite time stays there, and steps are long again."""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb

SOLVERS = ("auto", "radau")


def braked(law: dict[str, str], inertia: float, start: float) -> hb.Model:
    """A body that a force like the root of its speed brings to rest."""
    m = hb.Model("braked")
    m.add(i=hb.I(inertia, p=start), r=hb.R(law), j=hb.One())
    m.bond("j -> i", "j -> r")
    return m


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    ("law", "force"),
    [
        # by its root; by the square that it is the inverse of; with the kink hidden in a root
        ({"e": "5.96*sign(f)*sqrt(abs(f)/2.15)"}, 5.96 / math.sqrt(2.15)),
        ({"f": "0.00107*(e/91.1)*abs(e/91.1)"}, 91.1 / math.sqrt(0.00107)),
        ({"f": "0.00107*(e/91.1)*sqrt((e/91.1)^2)"}, 91.1 / math.sqrt(0.00107)),
    ],
)
def test_a_body_comes_to_rest_and_stays(law: dict[str, str], force: float, solver: str) -> None:
    """``p' = -k sqrt(p)`` is ``sqrt(p) = sqrt(p0) - k t/2`` up to rest."""
    inertia, start = 1.3, 0.7
    k = force / math.sqrt(inertia)
    rest = 2.0 * math.sqrt(start) / k
    run = hb.simulate(braked(law, inertia, start), 10.0 * rest, solver=solver, max_steps=5000)
    for part in (0.2, 0.5, 0.9):
        meant = start * (1.0 - part) ** 2
        assert run["i.p"].at(part * rest) == pytest.approx(meant, rel=1e-6, abs=1e-7 * start)
    later = [run["i.p"].at(t) for t in np.linspace(1.01, 10.0, 20) * rest]
    assert np.abs(later).max() < 1e-6 * start
    if solver == "radau":  # of few steps it takes no time
        assert run.audit().holds(1e-6)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_body_at_rest_beside_a_small_force_creeps(solver: str) -> None:
    """A force F is held by the friction of the speed ``(F/k)**2``, far below the tolerance."""
    m = braked({"f": "0.00107*(e/91.1)*abs(e/91.1)"}, 12.53, 1.62)
    m.add(s=hb.Se("4e-5"))
    m.bond("s -> j")
    run = hb.simulate(m, 0.0315, solver=solver, max_steps=5000)
    assert abs(run["i.p"].at(0.0315)) < 1e-6 * 1.62
    rest = 2.0 * math.sqrt(1.62) / (91.1 / math.sqrt(0.00107 * 12.53))
    assert run["i.p"].at(0.5 * rest) == pytest.approx(0.25 * 1.62, rel=1e-5)


def test_what_starts_at_rest_stays() -> None:
    """Nothing pushes: rounding of what the root is taken of must not keep steps short."""
    m = braked({"f": "110.0*(e/81.1)*abs(e/81.1)"}, 1.2e-5, 0.0)
    m.add(c=hb.C(1.0, q=0.5), o=hb.R(2.0), k=hb.Zero())
    m.bond("k -> c", "k -> o")
    run = hb.simulate(m, 1.0, max_steps=5000)
    assert run["i.p"].at(1.0) == 0.0
    assert run["c.q"].at(1.0) == pytest.approx(0.5 * math.exp(-0.5), rel=1e-6)


def filled(law: dict[str, str], pressure: float, volume: float) -> hb.Model:
    """A volume that a pressure fills through a law."""
    m = hb.Model("filled")
    m.add(s=hb.Se(pressure), i=hb.One(), r=hb.R(law), c=hb.C(volume))
    m.bond("s -> i -> r", "i -> c")
    return m


@pytest.mark.parametrize("rtol", [1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("values", [(1.0, 1.0, 1.0), (1e5, 1e10, 1e-9), (2e7, 4e12, 3e-12)])
def test_a_quadratic_orifice_fills_a_volume(
    values: tuple[float, float, float], solver: str, rtol: float
) -> None:
    """``P - p = P (1 - t/T)**2`` up to ``T = 2 C sqrt(k P)``; then nothing flows, in few steps."""
    pressure, k, volume = values
    last = 2.0 * volume * math.sqrt(k * pressure)
    model = filled({"e": f"{k}*f*abs(f)"}, pressure, volume)
    run = hb.simulate(model, 3.0 * last, solver=solver, rtol=rtol, max_steps=300)
    assert run["c.e"].at(0.5 * last) == pytest.approx(0.75 * pressure, rel=20.0 * rtol)
    assert run["c.e"].at(3.0 * last) == pytest.approx(pressure, rel=1e-12)
    assert abs(run["r.f"].at(3.0 * last)) <= 1e-6 * math.sqrt(pressure / k)
    assert run.audit().energy < 20.0 * rtol


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    ("law", "power"),
    [
        ({"e": "f^3"}, 1.0 / 3.0),
        ({"e": "sign(f)*abs(f)^1.75"}, 1.0 / 1.75),
        ({"e": "sign(f)*abs(f)^10"}, 0.1),
        ({"f": "sign(e)*abs(e)^0.1"}, 0.1),
    ],
)
def test_a_charge_through_a_power_law_is_gone_in_a_finite_time(
    law: dict[str, str], power: float, solver: str
) -> None:
    """``e = (1 - (1 - p) t)**(1/(1 - p))`` up to ``T = 1/(1 - p)``."""
    m = hb.Model("emptied")
    m.add(n=hb.Zero(), c=hb.C(1.0, e=1.0), r=hb.R(law))
    m.bond("n -> c", "n -> r")
    last = 1.0 / (1.0 - power)
    run = hb.simulate(m, 2.0 * last, solver=solver, max_steps=300)
    meant = 0.5 ** (1.0 / (1.0 - power))
    assert run["c.e"].at(0.5 * last) == pytest.approx(meant, rel=1e-6)
    assert abs(run["c.e"].at(2.0 * last)) < 1e-12


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("law", [{"f": "0.3*sign(e)*sqrt(abs(e))"}, {"e": "f/0.3*abs(f/0.3)"}])
@pytest.mark.parametrize(
    ("level", "rate"),
    [
        ("time^3", "3*time^2"),
        ("max(0, time - 0.1)^4", "4*max(0, time - 0.1)^3"),
        ("(1 - cos(3*time))^2", "6*sin(3*time)*(1 - cos(3*time))"),
    ],
)
def test_an_empty_tank_with_an_outlet_is_filled_gently(
    level: str, rate: str, law: dict[str, str], solver: str
) -> None:
    """What flows in is made for a level: its rate, and what runs out there by the root."""
    m = hb.Model("tank")
    root = {"time^3": "time^1.5"}.get(level, level.removesuffix("^2"))
    root = "max(0, time - 0.1)^2" if "max" in level else root
    m.add(n=hb.Zero(), c=hb.C(1.0), r=hb.R(law), s=hb.Sf(f"{rate} + 0.3*{root}"))
    m.bond("s -> n -> c", "n -> r")
    run = hb.simulate(m, 1.0, solver=solver, max_steps=5000)

    def meant(t: float) -> float:
        if "cos" in level:
            return (1.0 - math.cos(3.0 * t)) ** 2
        return max(0.0, t - 0.1) ** 4 if "max" in level else t**3

    for t in (0.05, 0.2, 0.5, 1.0):
        assert run["c.e"].at(t) == pytest.approx(meant(t), rel=1e-6, abs=1e-9)
