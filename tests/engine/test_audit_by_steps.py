"""The audit of runs that are right, which it must not call wrong, and of wrong ones.

Oracles: what is conserved; the same motion judged by a law that it was not made with; a state that
was moved by hand.
"""

from __future__ import annotations

import copy
from dataclasses import replace

import numpy as np
import pytest

import hybond as hb
from hybond.chronicle import Chronicle
from hybond.engine.outcome.audit import Audit, audit
from hybond.engine.outcome.signals import Signals
from hybond.testing import random_recipe


def microphone(resistance: float = 1e6) -> hb.Model:
    """A plate on a spring, charged within microseconds: many steps at the edge of stability."""
    m = hb.Model("microphone", domain="electrical")
    m.add(V=hb.Se(20), i=hb.One(), R=hb.R(resistance), v=hb.One(domain="generic"))
    m.add(M=hb.I(1e-3, domain="generic"), b=hb.R(0.05, domain="generic"))
    plate = ["q1*(1e-4 + q2)/8.854e-16", "q1^2/(2*8.854e-16) + 500*q2"]
    m.add(cf=hb.C({"e": plate}, domain="generic", q=[0, 0]))
    m.bond("V -> i -> R", "i -> cf.1", "v -> cf.2", "v -> M", "v -> b")
    return m


def sprung(law: str, start: float) -> hb.Model:
    m = hb.Model("sprung", domain="translational")
    m.add(k=hb.C({"e": law}, q=start), m=hb.I(1.0), v=hb.One())
    m.bond("v -> k", "v -> m")
    return m


HARD = "1 [N/m]*q + 1 [N/m^3]*q^3"
LOOSE = "if q > 0.1 then 100*(q - 0.1) else if q < -0.1 then 100*(q + 0.1) else 0*q"
RIGHT = {
    "microphone": (microphone(), 5e-3),
    "hard spring": (sprung(HARD, 1.0), 60.0),
    "loose spring": (sprung(LOOSE, 1.0), 10.0),
}


@pytest.mark.parametrize("name", RIGHT)
def test_errors_of_many_steps_are_what_each_of_them_may_be(name: str) -> None:
    model, until = RIGHT[name]
    run = hb.simulate(model, until)
    found = run.audit()
    assert found.energy > 1e-7  # they do add up
    assert found.holds() and found.beyond < 1e-9
    assert not found.holds(1e-10)


@pytest.mark.parametrize("rtol", [1e-6, 1e-8])
def test_heat_that_is_exchanged_is_measured_by_what_passes(rtol: float) -> None:
    """Two bodies level out at (2*400 + 280)/3 = 360 K: 80 kJ pass, and all energy stays."""
    m = hb.Model("levelled", domain="thermal")
    m.add(
        a=hb.Submodel("thermal.entropy_capacity", C="2 kJ/K", T_0="400 K"),
        b=hb.Submodel("thermal.entropy_capacity", C="1 kJ/K", T_0="280 K"),
        k=hb.Submodel("thermal.entropy_conductor", G="50 W/K"),
    )
    m.bond("a.port -> k.hot", "k.cold -> b.port")
    run = hb.simulate(m, 600.0, rtol=rtol)
    one, other = (float(run[f"{name}.temperature"].at(600.0)) for name in "ab")
    assert one == pytest.approx(360.0, rel=1e-5)
    off = abs(2e3 * (one - 400.0) + 1e3 * (other - 280.0))
    found = run.audit()
    assert found.energy == pytest.approx(off / 80e3, rel=0.1) and found.holds()


@pytest.mark.parametrize("rtol", [1e-8, 1e-10])
def test_powers_that_hang_on_small_differences_are_integrated_closer(rtol: float) -> None:
    """States right to 1e-13, propagated exactly, and powers a million times more wrong between."""
    recipe = random_recipe(901366)
    found = hb.simulate(recipe.model(), recipe.until, rtol=rtol).audit()
    assert found.energy < 10.0 * rtol and found.beyond < rtol


def judged(model: hb.Model, other: hb.Model, until: float) -> Audit:
    """Return the audit of the motion of a model by the laws of another one."""
    run, laws = (hb.simulate(m, until) for m in (model, other))
    return audit(laws.graph, run.trace, Signals(laws.signals._model, run.trace))


def test_a_law_that_is_wrong_by_a_hundred_thousandth_is_seen() -> None:
    assert judged(microphone(), microphone(), 5e-3).holds()
    assert not judged(microphone(), microphone(1e6 * (1 + 1e-5)), 5e-3).holds()
    hard = sprung(HARD, 1.0)
    wrong = sprung(HARD.replace("1 [N/m^3]", "1.00001 [N/m^3]"), 1.0)
    assert judged(hard, hard, 20.0).holds() and not judged(hard, wrong, 20.0).holds()


def test_a_state_that_is_moved_is_seen_among_thousands_of_steps() -> None:
    """All steps together may be off by more: what one of them is must not hide in the others."""
    run = hb.simulate(sprung(HARD, 1.0), 60.0)
    assert run.audit().holds()
    (segment,) = run.segments
    y = np.array(segment.y)
    q, p = y[500]
    y[500] *= 1.0 + 1e-6
    trace = copy.copy(run.trace)
    trace.segments = Chronicle(lambda s: float(s.t[0]), [replace(segment, y=y)])
    found = audit(run.graph, trace, run.signals)
    moved = 1e-6 * (q**2 + q**4 + p**2) / 0.75  # once to there, once from there
    assert not found.holds() and found.beyond == pytest.approx(2.0 * moved, rel=0.05)
