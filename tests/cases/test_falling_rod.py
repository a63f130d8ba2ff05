"""Falling rod (Mosterman & Biswas 2002), J/(m l^2) = 1.3, started at rest at 0.85 rad."""

import math

import pytest

import hybond as hb

IMPACT = 0.3906970
G, J, THETA = 9.81, 1.3, 0.85
ONSET = [(("stuck",), "mythical"), (("onset",), "mythical")]
SLIDES = [0.26, 0.265]
ALL = [*SLIDES, 0.27]
RATIO = math.sin(THETA) * math.cos(THETA) / (J + math.sin(THETA) ** 2)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("mu", ALL)
@pytest.mark.parametrize("name", ["falling_rod", "falling_rod_threshold"])
def test_impact_and_stuck_candidate(name, mu, simulate, solver):
    run = simulate(name, parameters={"mu": mu}, solver=solver, on_error="return")
    impact = run.events[1]
    assert impact.t == pytest.approx(IMPACT, abs=1e-7)
    assert impact.t == pytest.approx(math.sqrt(2 * (1.5 - math.sin(THETA)) / G), rel=1e-9)
    assert run["vy.f"].at(impact.t, side="left") == pytest.approx(-3.8327377, abs=1e-6)
    stuck = impact.steps[0]
    area = stuck.impulses
    assert area["mx.e"] == pytest.approx(0.8262589, abs=1e-6)
    assert area["tangent.e"] == pytest.approx(0.8262589, abs=1e-6)
    assert area["my.e"] == pytest.approx(3.1068876, abs=1e-6)
    assert area["normal.e"] == pytest.approx(3.1068876, abs=1e-6)
    assert area["rotor.e"] / J == pytest.approx(-1.0998010, abs=1e-6)
    assert -3.8327377 + area["my.e"] == pytest.approx(-0.7258501, abs=1e-6)
    assert area["tangent.e"] / area["normal.e"] == pytest.approx(RATIO, rel=1e-9)
    assert pytest.approx(0.265944, abs=5e-7) == RATIO


@pytest.mark.sampled(1)
@pytest.mark.parametrize("mu", SLIDES)
def test_slides_after_the_impact(mu, simulate, modes_of, solver):
    run = simulate("falling_rod", parameters={"mu": mu}, solver=solver)
    assert len(run.events) == 3
    impact = run.events[1]
    assert modes_of(run, impact) == [*ONSET, (("left",), "continuous")]
    t = impact.t
    assert run["w.f"].at(t) == pytest.approx(-1.4574641, abs=1e-6)
    assert run["vy.f"].at(t) == pytest.approx(-0.9619018, abs=1e-6)
    assert run["vx.f"].at(t) == pytest.approx(0.0, abs=1e-12)
    assert run["vAx"].at(t) == pytest.approx(-1.0949642, abs=1e-6)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("mu", "t", "theta", "omega", "vx"),
    [
        (0.26, 0.6955933, 0.2794357, -2.3353568, 0.4441224),
        (0.265, 0.6940071, 0.2836045, -2.3274607, 0.4512654),
    ],
)
def test_slip_falls_to_the_threshold(mu, t, theta, omega, vx, simulate, solver):
    """The same instant in both models; the published rule has no mode there."""
    run = simulate("falling_rod", parameters={"mu": mu}, solver=solver)
    assert run["vAx"].at(t) == pytest.approx(-0.2, abs=2e-6)
    with pytest.raises(hb.DivergenceOfTime) as caught:
        simulate("falling_rod_threshold", parameters={"mu": mu}, solver=solver)
    ended = caught.value.partial
    assert ended.t_end == pytest.approx(t, abs=1.5e-7)
    for mode in ("(slide)", "(stuck)", "(onset)"):
        assert mode in caught.value.why
    for r, at in ((run, t), (ended, ended.t_end)):
        assert r["theta"].at(at) == pytest.approx(theta, abs=1e-6)
        assert r["w.f"].at(at) == pytest.approx(omega, abs=1e-6)
        assert r["vx.f"].at(at) == pytest.approx(vx, abs=2e-6)
    assert ended["vAx"].at(ended.t_end) == pytest.approx(-0.2, abs=1e-8)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("mu", "t", "theta"), [(0.26, 0.728727, 0.200143), (0.265, 0.727293, 0.204207)]
)
def test_slip_reaches_zero_and_reverses(mu, t, theta, simulate, modes_of, solver):
    run = simulate("falling_rod", parameters={"mu": mu}, solver=solver)
    reversal = run.events[2]
    assert reversal.t == pytest.approx(t, abs=1e-6)
    assert run["theta"].at(reversal.t) == pytest.approx(theta, abs=1e-6)
    assert run["vAx"].at(reversal.t, side="left") == pytest.approx(0.0, abs=1e-8)
    assert modes_of(run, reversal) == [(("stuck",), "mythical"), (("right",), "continuous")]


@pytest.mark.sampled(1)
def test_sticks_and_breaks_away(simulate, modes_of, solver):
    run = simulate("falling_rod", parameters={"mu": 0.27}, solver=solver)
    assert len(run.events) == 3
    impact, breakaway = run.events[1:]
    assert modes_of(run, impact) == [(("stuck",), "continuous")]
    t = impact.t
    assert run["w.f"].at(t) == pytest.approx(-1.0998010, abs=1e-6)
    assert run["vx.f"].at(t) == pytest.approx(0.8262589, abs=1e-6)
    assert run["vy.f"].at(t) == pytest.approx(-0.7258501, abs=1e-6)
    assert run["tangent.e/normal.e"].at(t) == pytest.approx(0.186917, abs=1e-6)
    t = breakaway.t
    assert t == pytest.approx(0.6288414, abs=1e-7)
    assert run["theta"].at(t) == pytest.approx(0.4997501, abs=1e-6)
    assert run["w.f"].at(t) == pytest.approx(-1.8789554, abs=1e-6)
    ratio = run["abs(tangent.e)/normal.e"].at(t, side="left")
    assert ratio == pytest.approx(0.27, rel=1e-8)
    assert modes_of(run, breakaway) == [(("onset",), "mythical"), (("right",), "continuous")]


@pytest.mark.sampled(1)
def test_breakaway_has_no_mode_under_the_published_rule(simulate, modes_of, solver):
    with pytest.raises(hb.DivergenceOfTime) as caught:
        simulate("falling_rod_threshold", parameters={"mu": 0.27}, solver=solver)
    run = caught.value.partial
    assert run.t_end == pytest.approx(0.6288414, abs=1e-7)
    assert run["theta"].at(run.t_end) == pytest.approx(0.4997501, abs=1e-6)
    assert run["w.f"].at(run.t_end) == pytest.approx(-1.8789554, abs=1e-6)
    assert modes_of(run, run.events[1]) == [(("stuck",), "continuous")]


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("inertia", "sticks"), [(1.272, False), (1.3066, False), (4 / 3, True), (1 / 3, False)]
)
def test_inertia_decides_between_stick_and_slide(inertia, sticks, simulate, modes_of):
    """At mu = 0.265; a uniform rod (J = 1/3) does not reproduce the figure at any of the three."""
    options = {"until": 0.4, "on_error": "return"}
    run = simulate("falling_rod", parameters={"mu": 0.265, "J": inertia}, **options)
    last = modes_of(run, run.events[1])[-1]
    assert last == ((("stuck",) if sticks else ("left",)), "continuous")
    run = simulate("falling_rod", parameters={"mu": 0.27, "J": inertia}, **options)
    stuck = inertia > 0.5
    assert (modes_of(run, run.events[1])[-1][0] == ("stuck",)) == stuck
