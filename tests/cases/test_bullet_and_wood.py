"""A bullet stays in the wood: two inertias become one."""

import math

import pytest


def test_common_velocity(simulate, modes_of, solver):
    run = simulate("bullet_and_wood", solver=solver)
    assert len(run.events) == 2
    hit = run.events[1]
    assert hit.t == pytest.approx(0.2, rel=1e-9)
    assert modes_of(run, hit) == [(("inside",), "continuous")]
    for name in ("v1.f", "v2.f"):
        assert run[name].at(0.2 + 1e-9) == pytest.approx(0.5, abs=1e-12)
        assert run[name].at(0.5) == pytest.approx(0.5, abs=1e-12)
    energy = hit.steps[0].energy
    assert energy.before == pytest.approx(0.5, rel=1e-12)
    assert energy.after == pytest.approx(0.25, rel=1e-12)
    assert energy.lost == pytest.approx(0.25, rel=1e-12)
    assert energy.source == 0.0
    assert run["bullet.p + wood.p"].at(0.5) == pytest.approx(1.0, rel=1e-12)
    assert run["x1"].at(0.5) == pytest.approx(0.15, abs=1e-9)
    assert run["x2 - x1"].at(0.5) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("m1", "m2"), [(0.01, 2.0), (3.0, 0.5), (math.pi, math.e)])
def test_momentum_decides(m1, m2, simulate):
    run = simulate("bullet_and_wood", parameters={"m1": m1, "m2": m2})
    assert run["v2.f"].at(0.5) == pytest.approx(m1 / (m1 + m2), rel=1e-12)
