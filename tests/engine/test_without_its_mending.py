"""What once made numbers wrong without a word is told if it ever comes back.

Each test takes out what keeps a run right, and sees the audit, the laws that are put back or the
warning in joules say so; and that the run is right with it.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

import pytest

import hybond as hb
from hybond.engine.laws import law_jumping
from hybond.engine.mode import solving
from hybond.engine.mode.left_free import undetermined
from hybond.engine.mode.nonlinear import newton
from hybond.engine.outcome import warned
from hybond.model import flatten as flattening


def ended(m: hb.Model, until: float) -> hb.Result:
    """Run as Python, where what is taken out is not there."""
    return hb.simulate(m, until, engine="python", on_error="return")


def dragged(law: str) -> hb.Model:
    """Let a spring be drawn over a resistor that cannot give more than 8 N."""
    m = hb.Model("dragged", domain="translational")
    m.add(pull=hb.Sf("4 mm/s"), spring=hb.C("2 mm/N"), rub=hb.R({"e": law}), n=hb.Zero())
    m.bond("pull -> n -> spring", "n -> rub")
    return m


SATURATED = {
    "tanh": "8 [N]*tanh(f/(1 [mm/s]))",
    "branches": "if f > 1 [mm/s] then 8 [N] else if f < -1 [mm/s] then -8 [N] else 8 [kN*s/m]*f",
    "limits": "max(-8 [N], min(8 [N], 8 [kN*s/m]*f))",
}


@pytest.mark.parametrize("law", SATURATED.values(), ids=SATURATED)
def test_a_saturated_law_that_is_projected_away(monkeypatch: pytest.MonkeyPatch, law: str) -> None:
    """Free directions from slopes at other values than those that hold."""
    right = ended(dragged(law), 2.0)
    assert right.status == "ok" and 3.5 < right.final["spring.e"] < 4.0
    true: Callable[..., int] = undetermined.system
    draw = random.Random(1)

    def elsewhere(e: Any, mode: Any, v: Any, _: Any) -> int:
        return true(e, mode, v, [draw.uniform(0.3, 1.7) for _ in range(2 * e.model.bonds)])

    least: Callable[..., None] = undetermined.least_of_free

    def always(e: Any, mode: Any, v: Any, w: Any) -> None:
        mode.regular = False
        least(e, mode, v, w)

    monkeypatch.setattr(undetermined, "system", elsewhere)
    monkeypatch.setattr(undetermined, "all_determined", lambda *_: False)
    monkeypatch.setattr(undetermined, "may_move", lambda *_: True)
    monkeypatch.setattr(undetermined, "holds_at", lambda *_: True)
    monkeypatch.setattr(solving, "least_of_free", always)
    monkeypatch.setattr(flattening, "with_flat_pieces", lambda graph: graph)
    run = ended(dragged(law), 2.0)
    assert run.status == "unsound", run.error
    assert run.error is not None and run.error.where == "rub" and not run.audit().holds()


NOT_TO_BE_SOLVED = {
    "parabola": ("-5 V", "1 [V/A^2]*f^2"),
    "tanh": ("2 V", "1 [V]*tanh(f/(1 [A]))"),
    "exponential": ("-0.5 V", "1 [V]*exp(f/(1 [A]))"),
}


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("source", "law"), NOT_TO_BE_SOLVED.values(), ids=NOT_TO_BE_SOLVED)
def test_no_solution_that_counts_as_open(
    monkeypatch: pytest.MonkeyPatch, source: str, law: str
) -> None:
    m = hb.Model("none", domain="electrical")
    m.add(u=hb.Se(source), d=hb.R({"e": law}), i=hb.One())
    m.bond("u -> i -> d")
    run = ended(m, 1e-3)
    assert run.error is not None and run.error.code == "HB-N301"

    def left_open(e: Any, mode: Any, _: Any) -> int:
        work = e.work
        work.guess.at[: mode.finite_frees] = [0.0] * mode.finite_frees
        newton.with_free(mode, 2 * e.model.bonds, work.base, work.guess.at, work.w)
        return newton.OK

    monkeypatch.setattr(newton, "no_solution", left_open)
    run = ended(m, 1e-3)
    assert run.status == "unsound" and run.error is not None and run.error.code == "HB-N411"
    assert run.error.where == "d"


def stuck(charge: float, limit: float) -> hb.Model:
    """Hold a charged spring by friction, beside a diode that would let it go by an impulse."""
    m = hb.Model("stuck")
    m.add(c=hb.C(1.0, q=charge), d=hb.Zero(law="diode"), r=hb.R(1.0))
    m.add(j=hb.One(law="coulomb", limit=limit))
    m.bond("j -> c", "j -> d", "d -> r")
    return m


@pytest.mark.parametrize(("charge", "limit"), [(0.5, 2.0), (0.3, 1.0), (1.5, 4.0)])
def test_a_finite_force_that_cures_a_jump(
    monkeypatch: pytest.MonkeyPatch, charge: float, limit: float
) -> None:
    """A limit of friction becomes a constraint on what is stored: energy from nothing."""
    run = ended(stuck(charge, limit), 1.0)
    assert run.status == "ok" and run.final["c.q"] == charge and not run.warnings
    shut = law_jumping.passive_role
    monkeypatch.setattr(law_jumping, "jumping_role", lambda _, r, k: shut(r.now, k))
    monkeypatch.setattr(law_jumping, "past_limit", lambda *_: 1.0)
    run = ended(stuck(charge, limit), 1.0)
    assert not run.audit().holds() and run.audit().created > 0.1
    assert any(" creates " in note and " J " in note for note in run.warnings)


def rod(theta: float, speeds: tuple[float, float, float], mu: float, eps: float) -> hb.Model:
    """Let the tip of a slender rod hit a rough floor, by Newton's law."""
    m = hb.Model("rod", domain="translational", parameters={"l": 1.0, "mu": mu, "from": theta})
    m.add(mx=hb.I(1.0, f=speeds[0]), my=hb.I(1.0, f=speeds[1]), vx=hb.One(), vy=hb.One())
    m.add(rotor=hb.I(1.0 / 3.0, domain="rotational", f=speeds[2]), w=hb.One(domain="rotational"))
    m.add(arm_n=hb.TF("-cos(theta)"), arm_t=hb.TF("sin(theta)"), tangent=hb.Zero())
    m.add(contact=hb.Zero(law="unilateral", gap="y - sin(theta)", restitution=eps))
    m.add(slip=hb.One(law="coulomb", limit="mu*contact.e", impulsive=True))
    m.bond("vx -> mx", "vy -> my", "w -> rotor", "contact -> vy", "contact -> arm_n.2")
    m.bond("arm_n.1 -> w", "vx -> tangent -> slip", "w -> arm_t -> tangent")
    m.signal(theta=hb.Integral("w.f", start=theta), y=hb.Integral("vy.f", start="sin(from)"))
    return m


RODS = {
    "gains": (2.1438, (-0.55, -0.74, -0.94), 0.05, 1.0),
    "reverses": (0.78, (0.02, -0.646, 1.318), 0.6556, 0.9),
}


@pytest.mark.parametrize("case", RODS.values(), ids=RODS)
def test_energy_that_an_impact_law_makes(monkeypatch: pytest.MonkeyPatch, case: Any) -> None:
    """Newton's law with friction; the audit sees it without the warning."""
    run = ended(rod(*case), 1e-3)
    assert any(" creates " in note for note in run.warnings)
    monkeypatch.setattr(warned, "CREATED", float("inf"))
    run = ended(rod(*case), 1e-3)
    assert not any(" creates " in note for note in run.warnings)
    assert run.audit().created > 1e-3 and not run.audit().holds()


@pytest.mark.parametrize("share", [1e-6, -0.05])
def test_a_share_that_is_determined_and_moved(
    monkeypatch: pytest.MonkeyPatch, share: float
) -> None:
    """Two corners carry a block: what is moved from one to the other turns it."""
    m = hb.Model("block", domain="translational", parameters={"a": 0.25})
    m.add(my=hb.I(1.0), weight=hb.Se(-9.81), vy=hb.One(), rot=hb.I(0.2, domain="rotational"))
    m.add(w=hb.One(domain="rotational"), left=hb.TF("-a*cos(theta)"), right=hb.TF("a*cos(theta)"))
    m.add(c1=hb.Zero(law="unilateral"), c2=hb.Zero(law="unilateral"))
    m.bond("weight -> vy -> my", "w -> rot", "c1 -> vy", "c1 -> left.2", "left.1 -> w")
    m.bond("c2 -> vy", "c2 -> right.2", "right.1 -> w")
    m.signal(theta=hb.Integral("w.f"))
    run = ended(m, 0.1)
    assert run.status == "ok"
    assert [run["c1.e"].at(0.05), run["c2.e"].at(0.05)] == pytest.approx([4.905, 4.905])
    at = [k for k, b in enumerate(run.graph.bonds) if b.name.startswith(("c1 ->", "c2 ->"))]
    assert len(at) == 4
    true: Callable[..., None] = solving.least_of_free

    def moved(e: Any, mode: Any, v: Any, w: Any) -> None:
        true(e, mode, v, w)
        for k, sign in zip(at, (-1.0, -1.0, 1.0, 1.0), strict=True):
            w[k] += sign * share

    monkeypatch.setattr(solving, "least_of_free", moved)
    run = ended(m, 0.1)
    assert run.status == "unsound" and run.error is not None
    assert run.error.where in ("left", "right")
