"""A ball dropped from 3 m, restitution 1/1.1 (Margetts & Ngwompo)."""

import math

import pytest

G, H, EPS = 9.81, 3.0, 1 / 1.1
FIRST = math.sqrt(2 * H / G)
ZENO = FIRST * (1 + EPS) / (1 - EPS)


def test_impacts(simulate, modes_of, solver):
    run = simulate("bouncing_ball_newton", solver=solver)
    impacts = [e.t for e in run.events[1:]]
    published = [0.782062, 2.203993, 3.496657, 4.671806, 5.740124]
    assert impacts == pytest.approx(published, abs=6e-7)
    exact, t = [], FIRST
    for k in range(5):
        exact.append(t)
        t += 2 * FIRST * EPS ** (k + 1)
    assert impacts == pytest.approx(exact, rel=1e-8)
    for event in run.events[1:]:
        assert modes_of(run, event) == [(("impact",), "pinnacle"), (("away",), "continuous")]
    assert run["v.f"].at(impacts[0], side="left") == pytest.approx(-7.672027, abs=6e-7)
    assert run["v.f"].at(impacts[0]) == pytest.approx(7.672027 * EPS, abs=6e-7)


def test_peaks(simulate, solver):
    run = simulate("bouncing_ball_newton", solver=solver)
    impacts = [e.t for e in run.events[1:]]
    for k, peak in enumerate([2.479339, 2.049040, 1.693422, 1.399522]):
        top = 0.5 * (impacts[k] + impacts[k + 1])
        assert run["height"].at(top) == pytest.approx(peak, abs=6e-7)
        assert run["v.f"].at(top) == pytest.approx(0.0, abs=1e-6)


def test_energy_of_each_impact(simulate):
    run = simulate("bouncing_ball_newton")
    before = G * H
    for event in run.events[1:]:
        energy = event.steps[0].energy
        assert energy.before == pytest.approx(before, rel=1e-8)
        assert energy.after == pytest.approx(before * EPS**2, rel=1e-8)
        assert energy.lost == pytest.approx(before * (1 - EPS**2), rel=1e-8)
        before *= EPS**2


def test_run_beyond_the_accumulation(simulate, solver):
    run = simulate("bouncing_ball_newton", until=17.0, solver=solver)
    assert pytest.approx(16.423300, abs=6e-7) == ZENO
    assert run.status == "ok" and run.t_end == 17.0
    (record,) = run.accumulations
    assert record.t == pytest.approx(ZENO, abs=1e-9)
    assert record.ratio == pytest.approx(EPS, rel=1e-6)
    assert run.events[-1].t == record.t
    assert run["contact.e"].at(16.9) == pytest.approx(G)
    assert run["height"].at(16.9) == pytest.approx(0.0, abs=1e-12)


def test_siconos_ball(simulate, solver):
    run = simulate(
        "bouncing_ball_newton", until=3.5, solver=solver, parameters={"h0": 1, "eps": 0.9}
    )
    times = [e.t for e in run.events[1:]]
    assert times[0] == pytest.approx(0.4515236409857308, rel=1e-9)
    assert times[1:] == pytest.approx([1.264266, 1.995734, 2.654056, 3.246545], abs=6e-7)
    assert run["v.f"].at(times[0], side="left") == pytest.approx(-4.429446918070019, rel=1e-8)
    assert run["v.f"].at(times[0]) == pytest.approx(3.986502226263017, rel=1e-8)
    area = run.events[1].steps[0].impulses["contact.e"]
    assert area == pytest.approx(8.415949144333036, rel=1e-8)


def test_siconos_ball_accumulates(simulate):
    run = simulate("bouncing_ball_newton", until=9.0, parameters={"h0": 1, "eps": 0.9})
    assert run.status == "ok"
    assert [a.t for a in run.accumulations] == pytest.approx([8.578949], abs=1e-6)


@pytest.mark.parametrize(("e", "until"), [(1.0, 5.0), (0.0, 1.0)])
def test_elastic_and_dead_ball(e, until, simulate):
    run = simulate("bouncing_ball_newton", until=until, parameters={"eps": e})
    assert run.status == "ok"
    if e == 1.0:
        assert [x.t for x in run.events[1:]] == pytest.approx([FIRST, 3 * FIRST, 5 * FIRST])
        assert all(x.steps[0].energy.lost == pytest.approx(0.0, abs=1e-12) for x in run.events[1:])
    else:
        assert [a.t for a in run.accumulations] == pytest.approx([FIRST], rel=1e-12)
        assert run["height"].at(run.t_end) == pytest.approx(0.0, abs=1e-12)
        assert run["contact.e"].at(run.t_end) == pytest.approx(G)
