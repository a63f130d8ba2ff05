"""Impacts that keep the direction of a motion: no sign tells that their law was written.

Oracle: the rocking block of G. W. Housner, Bull. Seismol. Soc. Am. 53, 1963, in closed form. Of a
slender block that leans by phi of its angle alpha, ``phi'' = p^2 (phi - 1)``; it lands after
``acosh(1/(1 - phi))/p``, and ``1 - (1 - phi)^2`` is left to the square of what is kept of its rate.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

ALPHA, P = 0.25, 2.0
KEPT = 1.0 - 1.5 * math.sin(ALPHA) ** 2
LEANS = 0.8
ASKS = 'pre(side.state == "onto_{side}")'
HELD = {"left": "pre(w.f) < 0", "right": "pre(w.f) > 0"}


def block(written: bool) -> hb.Model:
    """Return the block; `written` says whether exits ask for what was written."""
    m = hb.Model("rocking", domain="rotational", parameters={"c": P**2, "kept": KEPT})
    m.add(J=hb.I(1.0), w=hb.One(), corner=hb.Zero(), lands=hb.Sf("kept*pre(w.f)"))
    m.add(
        weight=hb.Se(f'if side.state == "right" then -c*({ALPHA} - angle) else c*({ALPHA} + angle)')
    )
    m.bond("weight -> w -> J", "lands -> corner -> w")
    m.signal(angle=hb.Integral("w.f", start=LEANS * ALPHA))
    left, right = (ASKS.format(side=s) if written else HELD[s] for s in ("left", "right"))
    m.machine(
        "side",
        states={"right": [], "onto_left": ["corner"], "left": [], "onto_right": ["corner"]},
        start="right",
        rules=[
            "right -> onto_left when angle < 0 and w.f < 0",
            f"onto_left -> left when {left}",
            "left -> onto_right when angle > 0 and w.f > 0",
            f"onto_right -> right when {right}",
        ],
    )
    return m


@pytest.mark.parametrize("engine", [None, "python"])
def test_a_rocking_block_lands_when_housner_says(engine: str | None) -> None:
    landings = 5 if engine is None else 2
    expected, t, leans = [], 0.0, LEANS
    for n in range(landings):
        t += (1 if n == 0 else 2) * math.acosh(1.0 / (1.0 - leans)) / P
        expected.append(t)
        leans = 1.0 - math.sqrt(1.0 - KEPT**2 * (1.0 - (1.0 - leans) ** 2))
    run = hb.simulate(block(True), until=t + 0.01, engine=engine)
    assert run.warnings == ()
    assert run.events.t[1:] == pytest.approx(expected, rel=1e-8)
    for at in expected:
        before, after = (run["w.f"].at(at + d) for d in (-1e-9, 1e-9))
        assert after / before == pytest.approx(KEPT, rel=1e-7)
    lost = [s.energy.lost for e in run.events[1:] for s in e.steps if s.kind == "pinnacle"]
    kinetic = 0.5 * (P * ALPHA) ** 2 * (1.0 - (1.0 - LEANS) ** 2)
    share = [KEPT ** (2 * n) * (1.0 - KEPT**2) * kinetic for n in range(landings)]
    assert lost == pytest.approx(share, rel=1e-7)
    assert run.audit().holds()


def test_an_impact_law_that_is_on_trial_only_is_told_once_for_each_state() -> None:
    run = hb.simulate(block(False), until=6.0)
    assert len(run.events) == 4
    told = [w for w in run.warnings if "before the impact law there is written" in w]
    assert [w.split(" leaves ")[1].split()[0] for w in told] == ["onto_left", "onto_right"]
    assert all(f'pre(side.state == "{s}")' in w for s, w in zip(("onto_left", "onto_right"), told))
    # nothing is lost: it swings for ever as it did
    assert abs(run["w.f"].at(run.events.t[3])) == pytest.approx(
        P * ALPHA * math.sqrt(1.0 - (1.0 - LEANS) ** 2), rel=1e-7
    )


def test_a_ball_that_writes_its_impact_is_not_told_of() -> None:
    m = hb.Model("ball", domain="translational")
    m.add(ball=hb.I(1.0), v=hb.One(), floor=hb.Zero(), g=hb.Se(-9.81), hit=hb.Sf("-0.8*pre(v.f)"))
    m.bond("g -> v -> ball", "hit -> floor -> v")
    m.signal(h=hb.Integral("v.f", start=1.0))
    m.machine("m", states={"away": [], "impact": ["floor"]}, start="away", rules=[
        "away -> impact when h < 0 and v.f < 0", "impact -> away when pre(v.f) >= 0"
    ])  # fmt: skip
    assert hb.simulate(m, until=1.0).warnings == ()
