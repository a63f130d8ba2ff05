"""What a source has while its junction is OFF is read by signals: its bends end steps there too."""

from __future__ import annotations

import math

import pytest

import hybond as hb

SOLVERS = ("auto", "rk45", "radau")
BEND, SPEED, SLACK = 0.6345252914520598, 0.45886739030971485, 0.2
"""When a winch has its speed (s), that speed (m/s), and the slack of its rope (m)."""
T = "(time/(1 [s]))"
FORMS = {
    "min": f"{SPEED}*min({T}/{BEND}, 1)",
    "max": f"-max(-{SPEED}*{T}/{BEND}, -{SPEED})",
    "abs": f"({SPEED}*{T}/{BEND} + {SPEED} - abs({SPEED}*{T}/{BEND} - {SPEED}))/2",
}


def wound(t: float) -> float:
    """Return how much rope is wound up at a time, in closed form."""
    return SPEED * (t * t / (2 * BEND) if t < BEND else t - BEND / 2)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_rope_is_taut_when_a_winch_that_starts_has_wound_up_its_slack(
    solver: str, form: str, turned: bool
) -> None:
    """The bend of the winch was passed over while the rope was slack: 2e-7 s late."""
    for until in (1.0, 4.0):
        m = hb.Model("hoist", domain="translational")
        m.add(winch=hb.Sf(FORMS[form]), rope=hb.Zero(), v=hb.One(), load=hb.I("500 kg"))
        m.add(spring=hb.C("1e-4 m/N"), weight=hb.Se("-10 N"))
        m.add(floor=hb.Zero(law="unilateral", gap="height"))
        m.bond("winch -> rope -> v", "weight -> v", "floor -> v")
        m.bond(*(("spring -> rope", "load -> v") if turned else ("rope -> spring", "v -> load")))
        m.signal(height=hb.Integral("v.f"), pull=hb.Integral("winch.f - v.f", start=-SLACK))
        m.machine(
            "hook",
            states={"slack": [], "taut": ["rope"]},
            start="slack",
            rules=["slack -> taut when pull > 0", "taut -> slack when pull < 0"],
        )
        run = hb.simulate(m, until=until, solver=solver)
        taut = BEND / 2 + SLACK / SPEED
        (found,) = (e.t for e in run.events if e.steps[0].fired and e.t < taut + 1e-3 and e.t > 0)
        assert found == pytest.approx(taut, abs=1e-12 * until)
        assert run["pull"].at(BEND) == pytest.approx(wound(BEND) - SLACK, abs=1e-13)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("kind", ["effort", "flow"])
def test_a_source_behind_an_open_switch_is_metered_through_its_bends(
    solver: str, kind: str
) -> None:
    """A rectified sine that nothing carries has a mean, which a signal makes of it."""
    sine = f"max(sin(7*{T}), 0.2)"
    m = hb.Model("meter", domain="electrical")
    m.add(load=hb.R(50), extra=hb.C("1 mF", e="1 V"), leak=hb.R(100), n=hb.Zero())
    m.bond("n -> extra", "n -> leak")
    if kind == "effort":
        m.add(supply=hb.Se(sine), s=hb.One())
        m.bond("supply -> s -> load")
    else:
        m.add(supply=hb.Sf(sine), s=hb.Zero())
        m.bond("supply -> s -> load")
    m.signal(area=hb.Integral("2*supply.e" if kind == "effort" else "2*supply.f"))
    m.machine(
        "switch",
        states={"open": [], "shut": ["s"]},
        start="open",
        rules=["open -> shut when time >= 100", "shut -> open when time >= 200"],
    )
    run = hb.simulate(m, until=2 * math.pi / 7, solver=solver)
    low = math.asin(0.2)
    # above the bend 2 cos(low), below it a fifth for the rest of the turn
    want = 2 * (2 * math.cos(low) + 0.2 * (2 * math.pi - (math.pi - 2 * low))) / 7
    assert run["area"].at(2 * math.pi / 7) == pytest.approx(want, rel=1e-9)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_pulse_of_a_source_that_is_cut_off_is_metered(solver: str) -> None:
    """Nothing else moves: no step may pass over it."""
    m = hb.Model("pulse", domain="electrical")
    m.add(supply=hb.Se(f"exp(-(({T} - 0.37)/1e-4)^2)"), s=hb.One(), load=hb.R(50))
    m.bond("supply -> s -> load")
    m.signal(area=hb.Integral("supply.e"))
    m.machine(
        "switch",
        states={"open": [], "shut": ["s"]},
        start="open",
        rules=["open -> shut when time >= 100", "shut -> open when time >= 200"],
    )
    run = hb.simulate(m, until=1, solver=solver)
    assert run["area"].at(1) == pytest.approx(1e-4 * math.sqrt(math.pi), rel=1e-7)
