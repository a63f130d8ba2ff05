"""Two bodies collide by Newton's law; the collision is a pinnacle."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

MASS = st.floats(0.1, 10.0)


def collide(simulate, m1, m2, v1, v2, e, **options):
    values = {"m1": m1, "m2": m2, "v1": v1, "v2": v2, "eps": e}
    return simulate("two_body_collision", parameters=values, **options)


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("values", "after"),
    [
        ((1, 1, 1, 0, 0.8), (0.1, 0.9)),
        ((1, 1, 1, 0, 1), (0.0, 1.0)),
        ((2, 1, 1, -1, 0.5), (0.0, 1.0)),
    ],
)
def test_published_values(values, after, simulate, modes_of, solver):
    m1, m2, v1, v2, _ = values
    run = collide(simulate, *values, solver=solver)
    assert len(run.events) == 2
    hit = run.events[1]
    assert hit.t == pytest.approx(1.0 / (v1 - v2), rel=1e-9)
    assert modes_of(run, hit) == [(("collide",), "pinnacle"), (("apart",), "continuous")]
    end = [run[f"body{k}.f"].at(2.0) for k in (1, 2)]
    assert end == pytest.approx(after, abs=1e-12)
    assert m1 * end[0] + m2 * end[1] == pytest.approx(m1 * v1 + m2 * v2, rel=1e-12)
    lost = 0.5 * (m1 * v1**2 + m2 * v2**2 - m1 * end[0] ** 2 - m2 * end[1] ** 2)
    assert hit.steps[0].energy.lost == pytest.approx(lost, abs=1e-12)
    assert hit.steps[0].energy.source == 0.0


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(MASS, MASS, st.floats(-3.0, 3.0), st.floats(0.2, 5.0), st.floats(0.0, 1.0))
def test_newtons_law(simulate, m1, m2, v2, closing, e):
    v1 = v2 + closing
    run = collide(simulate, m1, m2, v1, v2, e, until=2.0 / closing)
    assert len(run.events) == 2
    assert [s.kind for s in run.events[1].steps] == ["pinnacle", "continuous"]
    total = m1 * v1 + m2 * v2
    after1 = (total - m2 * e * (v1 - v2)) / (m1 + m2)
    after2 = (total + m1 * e * (v1 - v2)) / (m1 + m2)
    scale = abs(v1) + abs(v2)
    assert run["body1.f"].at(run.t_end) == pytest.approx(after1, abs=1e-11 * scale)
    assert run["body2.f"].at(run.t_end) == pytest.approx(after2, abs=1e-11 * scale)
    if m1 == m2:
        assert after1 == pytest.approx(((1 - e) * v1 + (1 + e) * v2) / 2)
    energy = run.events[1].steps[0].energy
    assert energy.lost >= -1e-12 * energy.before


def test_bodies_that_separate_do_not_meet(simulate):
    run = collide(simulate, 1, 1, 0, 1, 0.5)
    assert [e.cause for e in run.events] == ["start"]
