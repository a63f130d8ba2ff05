"""Laws with several solutions are followed in models whose junctions have laws as in any other."""

from __future__ import annotations

import numpy as np
import pytest

import hybond as hb

FOLD = (2.0 / 3.0) ** 1.5 * 2.0
"""Behind 1 ohm the law below is x^3 - 2 x = u."""


def cubic(drive: str, beside: str, *, away: bool = False) -> hb.Model:
    """Return ``x^3 - 2*x = drive`` for ``x = G0.e``, and a junction law beside it."""
    m = hb.Model("cubic", domain="electrical")
    m.add(V=hb.Se(drive), z=hb.Zero(), ic=hb.One(), Rc=hb.R("1 ohm"), C=hb.C("1 F"))
    m.add(i0=hb.One(), R0=hb.R("1 ohm"))
    m.add(G0=hb.G({"f": "(e/(1 [V]))^3*(1 [A]) - 3*e/(1 [ohm])"}))
    m.bond("ic -> Rc", "ic -> C", "z -> i0 -> R0", "G0 -> i0" if away else "i0 -> G0")
    if beside == "before it":
        m.add(d=hb.One(law="diode"))
        m.bond("V -> d -> z -> ic")
    elif beside == "behind it":
        m.add(d=hb.One(law="diode"), k=hb.Zero())
        m.bond("V -> z -> d -> k -> ic")
    else:
        m.bond("V -> z -> ic")
    if beside == "rectifier":
        m.add(U=hb.Se("1 [V]*sin(40*time/(1 [s]))"), d=hb.One(law="diode"), Rd=hb.R("1 ohm"))
        m.add(k=hb.Zero(), K=hb.C("0.1 F"), load=hb.R("3 ohm"))
        m.bond("U -> d -> k -> K", "d -> Rd", "k -> load")
    if beside == "ball":
        m.add(weight=hb.Se("-9.81 N", domain="translational"))
        m.add(ball=hb.I("1 kg", domain="translational"))
        m.add(v=hb.One(domain="translational"))
        m.add(floor=hb.Zero(law="unilateral", gap="h", restitution=0.6, domain="translational"))
        m.bond("weight -> v -> ball", "floor -> v")
        m.signal(h=hb.Integral("v.f", start="0.1 m"))
    return m


def root(drive: float, near: float) -> float:
    """Return the solution of the cubic that is nearest."""
    found = np.roots([1.0, 0.0, -2.0, -drive])
    real = found[np.abs(found.imag) < 1e-9].real
    return float(real[np.argmin(np.abs(real - near))])


@pytest.mark.sampled(3)
@pytest.mark.parametrize("away", [False, True])
@pytest.mark.parametrize("beside", ["rectifier", "ball", "before it", "behind it"])
def test_no_guard_fires_before_the_fold_and_the_fold_is_told(beside: str, *, away: bool) -> None:
    m = cubic("(1 [V/s])*time", beside, away=away)
    read = "-G0.e" if away else "G0.e"
    m.machine("w", states={"a": [], "b": []}, start="a", rules=[f"a -> b when {read} > 0.9 V"])
    run = hb.simulate(m, 1.3, on_error="return")
    assert run.status == "unsound" and "ends (a fold)" in str(run.error)
    assert run.audit().laws[0].t == pytest.approx(FOLD, abs=1e-8)
    assert all(e.t >= FOLD - 1e-8 for e in run.events if "G0.e" in str(e))


@pytest.mark.parametrize("away", [False, True])
@pytest.mark.parametrize("beside", ["rectifier", "ball"])
def test_events_of_laws_elsewhere_do_not_change_the_solution(beside: str, *, away: bool) -> None:
    m = cubic("2.5 [V]*cos(time/(1 [s]))", beside, away=away)
    run = hb.simulate(m, 1.75)
    assert len(run.events) > 10
    for t in (0.1, 0.9, 1.5, 1.69, 1.75):
        at = (-1 if away else 1) * float(run["G0.e"].at(t))
        assert at == pytest.approx(root(2.5 * np.cos(t), 1.3), rel=1e-9)


@pytest.mark.parametrize("away", [False, True])
def test_a_diode_that_blocks_leaves_the_law_on_the_solution_it_was_on(*, away: bool) -> None:
    """It is refused (HB-J111) if the voltage behind it is looked for near zero."""
    m = cubic("1.5 [V] - (1 [V/s])*time", "before it", away=away)
    run = hb.simulate(m, 3.0)
    assert [e.cause for e in run.events] == ["start", "guard"]
    blocks = run.events[1].t
    assert float(run["d.f"].at(blocks - 1e-9)) == pytest.approx(0.0, abs=1e-7)
    for t in np.linspace(blocks, 3.0, 7):
        x, c = abs(float(run["G0.e"].at(t))), float(run["C.e"].at(t))
        # what the law takes comes out of the capacitor, through 1 ohm each
        assert x > 1.5 and 2.0 * x**3 - 5.0 * x == pytest.approx(c, abs=1e-8)
    assert float(run["C.e"].at(3.0)) < 3.0**0.5


@pytest.mark.parametrize("turns", [1.5, 1.2, 1.01])
def test_a_source_that_jumps_behind_a_diode_ends_no_solution(turns: float) -> None:
    """The capacitor keeps its voltage over the jump, once the diode has blocked."""
    m = hb.Model("jumps", domain="electrical")
    m.add(V=hb.Se("1 [V]*sign(sin(7*time/(1 s)))"), z=hb.Zero(), d=hb.One(law="diode"))
    m.add(i=hb.One(), r=hb.R("1 ohm"), C=hb.C("0.01 F"), R=hb.R("6 ohm"))
    m.add(G=hb.G({"f": f"(e/(1 [V]))^3*(1 [A]) - {turns}*e/(1 [ohm])"}))
    m.bond("V -> d -> z -> i -> r", "i -> G", "z -> C", "z -> R")
    run = hb.simulate(m, 1.0)
    for t in (0.3, 0.6, 0.95):
        x, u = float(run["G.e"].at(t)), float(run["C.e"].at(t))
        assert x > 0.0 and x**3 - (turns - 1.0) * x == pytest.approx(u, abs=1e-9)
