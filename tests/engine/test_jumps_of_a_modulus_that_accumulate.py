"""A yo-yo that winds up on the other side loses a part of its speed each time, and comes to rest.

The modulus jumps as the string is out; ``w+ = w- (J - m r^2)/(J + m r^2)``. What comes behind the
limit of ever shorter turns was the error of steps, without end.
"""

import pytest

import hybond as hb

R, M, G, START = 0.1, 1.0, 9.81, -5.0


def yoyo(inertia):
    m = hb.Model("yo-yo", domain="rotational")
    m.add(w=hb.One(), J=hb.I(inertia), tf=hb.TF(f"if phi > 0 then {R} else -{R}"))
    m.add(v=hb.One(domain="translational"), m=hb.I(M, domain="translational"))
    m.add(W=hb.Se(-M * G, domain="translational"))
    m.bond("w -> J", "w -> tf -> v -> m", "W -> v")
    m.signal(phi=hb.Integral("w.f", start=START))
    return m


def limit(inertia):
    """When the first turn is, and the limit of all."""
    speed_up = M * G * R / (inertia + M * R * R)
    first = (2.0 * -START / speed_up) ** 0.5
    kept = (inertia - M * R * R) / (inertia + M * R * R)
    return first, first + 2.0 * first * kept / (1.0 - kept)


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("ratio", [2.0, 3.0, 6.0])
def test_a_yoyo_is_refused_where_its_turns_end(ratio, solver):
    inertia = ratio * M * R * R
    first, end = limit(inertia)
    run = hb.simulate(yoyo(inertia), until=1.5 * end, on_error="return", solver=solver)
    assert run.status == "error" and run.error.code == "HB-N410"
    assert run.t_end == pytest.approx(end, rel=1e-4)
    kept = (ratio - 1.0) / (ratio + 1.0)
    speed = (2.0 * -START * M * G * R / (inertia + M * R * R)) ** 0.5
    top = first + kept * first  # as long on the way back as it took, at a part of the speed
    assert run["w.f"].at(first * (1 - 1e-9)) == pytest.approx(speed, rel=1e-7)
    assert run["w.f"].at(first * (1 + 1e-9)) == pytest.approx(kept * speed, rel=1e-7)
    assert run["w.f"].at(top) == pytest.approx(0.0, abs=1e-6 * speed)


@pytest.mark.parametrize("ratio", [2.0, 3.0])
def test_before_that_it_runs(ratio):
    inertia = ratio * M * R * R
    _, end = limit(inertia)
    run = hb.simulate(yoyo(inertia), until=0.999 * end)
    assert run.status == "ok" and run.audit().holds()
