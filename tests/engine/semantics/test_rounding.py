"""What is rounding for a guard is rounding for what follows it: no creeping, no missing answer.

Oracles: free fall and rest in closed form; the charge that a ladder of diodes ends at.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb


def ball_beside_a_fast_mass(gap: float, speed: float) -> hb.Model:
    """A ball just above its floor; another mass carries 110 J, which rounding is measured by."""
    m = hb.Model("rest", domain="translational", parameters={"d": 0.2})
    m.add(weight=hb.Se("-9.81 N"), ball=hb.I("1 kg", f=speed), v=hb.One())
    m.add(c=hb.Zero(law="unilateral", gap="x - d*1 [m]/2", restitution=0.9))
    m.bond("weight -> v -> ball", "c -> v")
    m.signal(x=hb.Integral("v.f", f"{0.1 + gap!r} m"))
    m.add(other=hb.I("1 kg", f=220.0**0.5), w=hb.One(), n=hb.Se("0 N"))
    m.bond("n -> w -> other")
    return m


@pytest.mark.sampled(6)
@pytest.mark.parametrize("gap", [0.0, 2e-14, 1e-13, 1e-12])
@pytest.mark.parametrize("speed", [0.0, -1e-13, -1e-12, -1.5e-11])
def test_a_ball_that_touches_but_for_rounding_comes_to_rest(gap: float, speed: float) -> None:
    run = hb.simulate(ball_beside_a_fast_mass(gap, speed), until=1e-3)
    assert run.status == "ok" and run.t_end == 1e-3
    assert run["c.e"].at(1e-3) == pytest.approx(9.81, rel=1e-12)
    assert abs(run["v.f"].at(1e-3)) < 1e-11
    assert abs(run["x"].at(1e-3) - 0.1) <= 1e-12 + gap


@pytest.mark.parametrize("above", [3e-8, 1e-6, 1e-3])
def test_a_contact_that_separates_stays_open_beside_one_that_closes(above: float) -> None:
    """However slowly it opens: one ball lies down, the other on it has already left."""
    m = hb.Model("two", domain="translational")
    m.add(w1=hb.Se("-9.81 N"), w2=hb.Se("-9.81 N"), v1=hb.One(), v2=hb.One())
    m.add(b1=hb.I("1 kg", f=0.0), b2=hb.I("1 kg", f=above))
    m.add(floor=hb.Zero(law="unilateral", gap="x1", restitution=0.5))
    m.add(between=hb.Zero(law="unilateral", gap="x2 - x1", restitution=0.5))
    m.add(far=hb.I("1 kg", f=15.0), w=hb.One(), n=hb.Se("0 N"))
    m.bond("w1 -> v1 -> b1", "w2 -> v2 -> b2", "floor -> v1", "v1 -> between", "n -> w -> far")
    m.bond("between -> v2")
    m.signal(x1=hb.Integral("v1.f", "0 m"), x2=hb.Integral("v2.f", "0 m"))
    flight = 2.0 * above / 9.81
    run = hb.simulate(m, until=0.5 * flight)
    assert run["x1"].at(run.t_end) == pytest.approx(0.0, abs=1e-20)
    risen = above * run.t_end - 0.5 * 9.81 * run.t_end**2
    assert run["x2"].at(run.t_end) == pytest.approx(risen, rel=1e-6)


def test_a_run_that_begins_empty_stays_on_constraints_that_hold_zero() -> None:
    # two coils of one current, a rotor held still, and a coupling that the current modulates
    m = hb.Model("series machine at rest", domain="electrical")
    m.add(V=hb.Se("24 V"), i=hb.One(), r=hb.R("2 ohm"), coil=hb.I("5 mH"), field=hb.I("10 mH"))
    m.add(k=hb.GY("0.02 [V*s/A]*field.f"), w=hb.One(domain="rotational"))
    m.add(rotor=hb.I("0.05 kg*m^2", domain="rotational"), held=hb.Sf(0, domain="rotational"))
    m.bond("V -> i -> r", "i -> coil", "i -> field", "i -> k -> w -> rotor", "held -> w")
    run = hb.simulate(m, until="20 ms", rtol=1e-9)
    now = 12 * (1 - math.exp(-0.02 * 2 / 0.015))
    assert run["coil.f"].at(0.02) == pytest.approx(now, rel=1e-7)


def turn_off_at_zero(rule: str) -> hb.Model:
    """A GTO that is switched off as its current ceases, beside a diode at the same node."""
    m = hb.Model("gto", domain="electrical")
    m.add(source=hb.Se("-24 V"), coil=hb.I("7 mH", f=3.0), a=hb.One(), leak=hb.R("120 ohm"))
    m.add(n=hb.Zero(), gto=hb.One(), diode=hb.One(law="diode"))
    m.add(load=hb.R("4 ohm"), other=hb.R("6 ohm"))
    m.bond("source -> a -> coil", "a -> n -> leak", "n -> gto -> load", "n -> diode -> other")
    m.machine(
        "gate",
        states={"on": ["gto"], "off": []},
        start="on",
        rules=[f"on -> off when {rule}", "off -> on when n.e > 1 [V]"],
    )
    return m


@pytest.mark.parametrize("rule", ["coil.f <= 0", "gto.f <= 0", "not (n.e > 0)"])
def test_a_guard_that_holds_at_zero_beside_a_diode_is_not_asked_for_ever(rule: str) -> None:
    """The diode counts rounding of what is stored as zero; so does the guard, when it is settled.

    Oracle: R and L in series, first with all branches in parallel, then with the leak alone.
    """
    run = hb.simulate(turn_off_at_zero(rule), until="2 ms")
    assert run.status == "ok"
    both = 1.0 / (1.0 / 4.0 + 1.0 / 6.0 + 1.0 / 120.0)
    zero = 7e-3 / both * math.log(1.0 + 3.0 * both / 24.0)
    off = next(e for e in run.events if e.cause == "guard")
    assert off.t == pytest.approx(zero, rel=1e-9)
    assert [run.graph.mode_text(e.steps[-1].mode) for e in run.events][-1] == "off, blocks"
    after = -24.0 / 120.0 * (1.0 - math.exp(-120.0 * (2e-3 - zero) / 7e-3))
    assert run["coil.f"].at(2e-3) == pytest.approx(after, rel=1e-6)


@pytest.mark.parametrize("solver", ["rk45", "radau", "exact"])
def test_the_audit_of_a_body_at_rest_is_not_one_of_rounding(solver: str) -> None:
    """0.3 - 0.1 - 0.2 N is 3e-17 N: what that moves is no energy, and no balance of it is due."""
    m = hb.Model("balanced", domain="translational")
    m.add(a=hb.Se("-0.1 N"), b=hb.Se("-0.2 N"), c=hb.Se("0.3 N"), body=hb.I("1 kg"), v=hb.One())
    m.bond("a -> v -> body", "b -> v", "c -> v")
    assert hb.simulate(m, until=5.0, solver=solver).audit().holds()


def test_the_audit_of_a_weak_push_is_measured_by_what_it_stores() -> None:
    """1 nN for 1 s: every joule of 5e-19 counts, as the tolerance of the run says."""
    m = hb.Model("push", domain="translational")
    m.add(push=hb.Se("1 nN"), body=hb.I("1 kg"), drag=hb.R("3 N*s/m"), v=hb.One())
    m.bond("push -> v -> body", "v -> drag")
    fine, coarse = (hb.simulate(m, until=1.0, rtol=r).audit().energy for r in (1e-8, 1e-3))
    assert fine < 1e-7 < coarse
