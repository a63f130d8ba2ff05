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
