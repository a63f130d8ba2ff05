"""A body that a jump of a law holds, where damping leads it there within an instant of the run."""

from __future__ import annotations

import math

import pytest

import hybond as hb

MOMENTUM = 1e-6
SOLVERS = ["auto", "radau"]


def braked(damping: float, pull: float, *, turned: bool = False) -> hb.Model:
    """Return a mass of 1 kg in motion, with friction of 1 N as a law that jumps, and damping."""
    m = hb.Model("braked", domain="translational")
    m.add(v=hb.One(), mass=hb.I(1.0, p=MOMENTUM), pull=hb.Se(pull))
    m.add(rub=hb.R({"e": "1.0*sign(f)"}), oil=hb.R(damping))
    m.bond("pull -> v -> mass", "rub -> v" if turned else "v -> rub", "v -> oil")
    return m


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(("damping", "turned"), [(2.5e10, False), (2.5e10, True), (1e11, False)])
def test_rub_that_holds_is_told_at_once(damping: float, turned: bool, solver: str) -> None:
    """It is at rest after ln(1 + b v/(F - pull)) m/b: hundreds of thousands of steps went on."""
    run = hb.simulate(braked(damping, 0.1, turned=turned), 1.0, on_error="return", solver=solver)
    rest = math.log(1.0 + damping * MOMENTUM / 0.9) / damping
    assert run.error is not None
    assert run.error.code == "HB-N410"
    assert run.error.where == "rub"
    assert abs(run.t_end - rest) < 1e-8
    assert run.stats["steps"] < 1000


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("pull", [2.0, -2.0, 1.1, -1.1, 1.01])
@pytest.mark.parametrize("damping", [1e8, 2.5e10])
def test_rub_that_does_not_hold_goes_on(damping: float, pull: float, solver: str) -> None:
    """A pull of more than the friction leads on, through rest or before it, at (pull - F)/b."""
    run = hb.simulate(braked(damping, pull), 1.0, solver=solver)
    left = pull - math.copysign(1.0, pull)
    assert run.final["mass.p"] == pytest.approx(left / damping, rel=1e-6)
