"""Time derivatives along runs, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb
from hybond.analysis.motion import Motion


def motion(m: hb.Model, t: list[float], **options) -> Motion:
    run = hb.simulate(m, 2.0, rtol=1e-10, **options)
    (segment,) = run.segments
    return Motion(run, segment, np.array(t))


def test_a_discharge_has_derivatives_of_all_orders() -> None:
    m = hb.Model("rc", domain="electrical")
    m.add(c=hb.C(0.5, e=3.0), r=hb.R(4.0), n=hb.Zero())
    m.bond("n -> c", "n -> r")
    t = [0.0, 0.3, 1.7]
    found = motion(m, t)
    for order in range(6):
        want = [(-0.5) ** order * 1.5 * math.exp(-0.5 * a) for a in t]
        q = found.derivative(found.run.expression("c.q"), order)
        assert q == pytest.approx(want, rel=1e-8)
        flow = found.derivative(found.run.expression("r.f"), order)
        assert flow == pytest.approx(0.5 * np.array(want), rel=1e-8)


@pytest.mark.parametrize("solver", ["rk45", "radau", "exact"])
def test_storage_that_follows_a_source_has_its_derivatives(solver: str) -> None:
    """The flow into a capacitor on a source is C times the rate of that: no state is left."""
    m = hb.Model("follows", domain="electrical")
    m.add(V=hb.Se("2*sin(3*time*1 [1/s])*1 [V]"), n=hb.Zero(), c=hb.C(0.5))
    m.bond("V -> n -> c")
    t = np.array([0.1, 0.7, 1.9])
    found = motion(m, t.tolist(), solver=solver)
    for order in range(4):
        want = 3.0 ** (order + 1) * np.cos(3.0 * t + 0.5 * math.pi * order)
        flow = found.derivative(found.run.expression("c.f"), order)
        assert flow == pytest.approx(want, rel=1e-12)


def test_a_field_of_storage_couples_its_ports() -> None:
    """Two coils that share flux: ``L i' = -R i``, all derivatives by the same matrix."""
    inductance, start = np.array([[3.0, 1.0], [1.0, 2.0]]), [2.0, -1.0]
    m = hb.Model("coils", domain="electrical")
    m.add(i=hb.One(), j=hb.One(), l=hb.I(inductance.tolist(), f=start), r=hb.R(5.0), s=hb.R(7.0))
    m.bond("i -> l.1", "j -> l.2", "i -> r", "j -> s")
    found = motion(m, [0.0])
    a = -np.linalg.solve(inductance, np.diag([5.0, 7.0]))
    for order in range(5):
        want = np.linalg.matrix_power(a, order) @ start
        flows = [found.derivative(found.run.expression(f"{n}.f"), order)[0] for n in "rs"]
        assert flows == pytest.approx(want, rel=1e-12)


def test_a_nonlinear_mode_has_one_derivative() -> None:
    """Air drag: ``v' = -v^2``, so that v = 1/(1 + t) and the force v^2 falls by -2 v^3."""
    m = hb.Model("drag", domain="translational")
    m.add(v=hb.One(), m=hb.I(1.0, f=1.0), d=hb.R({"e": "f^2*1 [kg/m]"}))
    m.bond("v -> m", "v -> d")
    t = np.array([0.2, 1.0])
    found = motion(m, t.tolist())
    speed = 1.0 / (1.0 + t)
    assert found.derivative(found.run.expression("m.f"), 1) == pytest.approx(-(speed**2), rel=1e-8)
    force = found.run.expression("d.e")
    assert found.derivative(force, 1) == pytest.approx(-2.0 * speed**3, rel=1e-6)
    assert np.isnan(found.derivative(force, 2)).all()
