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


RATE, AT_ONCE = 3.0, 1e-9
FOLLOWS = {
    "capacitor": (hb.Se, hb.One, hb.C, 1.0),
    "mass": (hb.Sf, hb.Zero, hb.I, 1.0),
    "mass, hardly held": (hb.Sf, hb.Zero, hb.I, 0.1),
    "capacitor behind little": (hb.Se, hb.One, hb.C, 0.2),
}


@pytest.mark.parametrize("name", FOLLOWS)
def test_what_follows_its_drive_within_a_nanosecond_is_not_told_to_lose_energy(name: str) -> None:
    """Its force is the small difference of two large ones, of which rounding leaves few digits."""
    source, junction, storage, resistance = FOLLOWS[name]
    m = hb.Model("follows")
    m.add(s=source(f"sin({RATE}*time)"), j=junction(), R=hb.R(resistance), x=storage(AT_ONCE))
    m.bond("s -> j -> R", "j -> x")
    run = hb.simulate(m, 1.0)
    tau = AT_ONCE * resistance if storage is hb.C else AT_ONCE / resistance
    t = np.linspace(0.1, 1.0, 10)
    closed_form = (np.sin(RATE * t) - RATE * tau * np.cos(RATE * t)) / (1.0 + (RATE * tau) ** 2)
    stored = "x.q" if storage is hb.C else "x.p"
    assert np.asarray(run.sample(t, [stored])[stored]) / AT_ONCE == pytest.approx(
        closed_form, abs=1e-8
    )
    found = run.audit()
    assert found.holds() and found.beyond < found.rtol


def test_what_follows_a_drive_that_it_was_not_made_with_is_seen() -> None:
    """The same motion by a resistance of twice that: half of what passes is lost on the way."""
    models = []
    for resistance in (1.0, 2.0):
        m = hb.Model("follows")
        m.add(s=hb.Se(f"sin({RATE}*time)"), j=hb.One(), R=hb.R(resistance), x=hb.C(1e-3))
        m.bond("s -> j -> R", "j -> x")
        models.append(m)
    assert judged(*models, 1.0).beyond > 1e-4


LEVER, LIGHT, SPEED = 943.0, 8e-11, -13.4


def levered(speed: str, load: float) -> hb.Model:
    """A light mass that a source drives, held by a lever: what it lags is gone in 1e-16 s."""
    m = hb.Model("levered")
    m.add(s=hb.Sf(speed), j=hb.Zero(), i=hb.I(LIGHT), t=hb.TF(LEVER), n=hb.Zero(), r=hb.R(1.0))
    m.add(heavy=hb.I(1.0, p=load), e=hb.One(), k=hb.Zero())
    m.bond("s -> j -> i", "j -> t -> e -> k", "k -> r", "k -> heavy")
    return m


@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_power_that_hangs_on_the_last_digit_of_a_state_is_not_told_to_be_lost(solver: str) -> None:
    run = hb.simulate(levered(f"{SPEED}", 4.65e-5), 1e-2, solver=solver)
    # at rest the lever gives the heavy one what flows there, and the resistance nothing
    moved = 4.65e-5 / LEVER
    assert run["i.p"].at(1e-2) == pytest.approx(LIGHT * SPEED, rel=1e-6 + abs(moved / SPEED))
    assert run.audit().holds()


@pytest.mark.parametrize("later", [1.0, 1e3])
def test_short_steps_long_after_the_start_are_integrated_where_they_are(later: float) -> None:
    """A step of a few last places of the time, in which all passes that ever does."""
    tau = 1e-12 * later
    m = hb.Model("late")
    step = f"if time >= {later + 0.5} then 1 else 0"
    m.add(s=hb.Se(step), j=hb.One(), r=hb.R(1.0), c=hb.C(tau))
    m.bond("s -> j -> r", "j -> c")
    run = hb.simulate(m, later + 1.0)
    assert run["c.q"].at(later + 1.0) == pytest.approx(tau, rel=1e-8)
    assert run.audit().holds()


def test_rounding_of_a_state_excuses_no_law_that_is_wrong() -> None:
    """The same motion by a lever that is a thousandth longer: the transient is another one."""
    longer = levered(f"{SPEED}", 4.65e-5)
    longer.elements["r"] = hb.R(1.1)
    assert not judged(levered(f"{SPEED}", 4.65e-5), longer, 1e-2).holds()


class Bent(Signals):
    """Signals of a run, with a flow added to one bond at all points."""

    bond, flow = 0, 0.0

    def bonds(self, segment, end=None):
        w = np.array(super().bonds(segment, end))
        w[len(self.graph.bonds) + self.bond] += self.flow
        return w


@pytest.mark.parametrize("span", [1.0, 10.0, 1e4])
@pytest.mark.parametrize("part", [1e-16, 1e-13, 1e-11, 1e-9])
def test_power_without_counterpart_is_a_part_of_what_the_run_has_to_give(span, part) -> None:
    """Where nothing moves there is no power to be a part of, but the energy over all the time."""
    m = hb.Model("still")
    m.add(c=hb.C(2.0, e=3.0), j=hb.Zero(), s=hb.Sf(0.0))
    m.bond("s -> j -> c")
    run = hb.simulate(m, span)
    energy = 0.5 * 2.0 * 3.0**2
    bent = Bent(run.signals._model, run.trace)
    bent.flow = part * energy / span / 3.0
    found = audit(run.graph, run.trace, bent)
    assert found.power == pytest.approx(part, rel=1e-6)
    assert found.holds() == (part <= 1e-12)


def test_a_step_is_integrated_once_more_whichever_way_bonds_point() -> None:
    """The polynomial of the last step is off by more than the tolerance lets the step be wrong by.

    Told of the step itself are 2e-7 of the energy; by a force turned round it was a third.
    """
    found = []
    for away in (False, True):
        m = hb.Model("pushed")
        m.add(j=hb.One(), a=hb.I(0.58, p=-0.165), b=hb.I(0.42991452991452994, p=0.0))
        m.add(s=hb.Se("1.98*(1 + 0.5*tanh(b.p))"))
        m.bond(*(("j -> s", "a -> j", "b -> j") if away else ("s -> j", "j -> a", "j -> b")))
        run = hb.simulate(m, 1.27)
        assert run.final["a.p"] == pytest.approx(1.67068056857, rel=2e-7)  # SciPy's DOP853
        found.append(run.audit())
    assert [a.energy for a in found] == pytest.approx([found[0].energy] * 2, rel=1e-6)
    assert found[0].energy < 1e-6
