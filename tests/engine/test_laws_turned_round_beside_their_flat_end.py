"""``F*tanh(f/v)`` where what is stored gives the effort: the flow is found from that.

Beside its end a millionth of the effort is all of the flow, far less than steps may be off by: the
run crossed the end, where the law holds, to and fro by the error of its steps, or was refused.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb


def pushed(scale=1.0, turned=False):
    """Two storages of a field, the smaller behind such a law, with a spring and a mass, shaken."""
    m = hb.Model("pushed")
    m.add(j0=hb.One(), j1=hb.Zero(), j2=hb.One(), r0=hb.R({"e": "0.00813*tanh(f/0.136)"}))
    m.add(c1=hb.C([[0.181, 2.58], [2.58, 117.0]], q=[-0.16618095183844098, 69.49004368572832]))
    m.add(c2=hb.C({"e": "1.38*((q/80.7) + (q/80.7)^3)"}), i3=hb.I(50.5 * scale))
    m.add(s0=hb.Sf("10.9*sin(2.26*time)"))
    m.bond("j1 -> r0", "j2 -> s0", "c1.2 -> j2", "c2 -> j2", "i3 -> j2", "j2 -> j0")
    m.bond("j0 -> j1" if turned else "j1 -> j0", "j1 -> c1.1")
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("scale", [1.0, 0.1])
def test_it_is_not_crossed_to_and_fro(scale, turned):
    # one way a tighter run is a far longer one: there the others are compared
    tight = hb.simulate(pushed(scale, turned), until=0.215, rtol=1e-11 if turned else 1e-8)
    for options in ({}, {"solver": "radau"}, {"rtol": 1e-6}):
        run = hb.simulate(pushed(scale, turned), until=0.215, **options)
        assert run.status == "ok" and run.audit().holds()
        assert len(run.events) <= len(tight.events) + 2
        assert run.stats["steps"] < 1000
        for name in ("c1.1.q", "c1.2.q", "c2.q"):
            assert run[name].at(0.215) == pytest.approx(tight[name].at(0.215), rel=2e-6)


STIFFNESS, WAY, TURN = 1e3, 0.2, 3.0


def slider(most, speed, turned):
    """Maxwell's element: a spring in series with such a slider, moved to and fro."""
    m = hb.Model("slider", domain="translational")
    m.add(s=hb.Sf(f"{WAY}*sin({TURN}*time)"), top=hb.One(), z=hb.Zero(), c=hb.C(1 / STIFFNESS))
    m.add(r=hb.R({"e": f"{most}*tanh(f/{speed})"}), apart=hb.I(1.0, f=2.0), alone=hb.One())
    m.bond("s -> top -> z", "z -> c", "r -> z" if turned else "z -> r", "alone -> apart")
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_a_slider_that_gives_way_is_as_by_scipy(solver, turned):
    """As fast as twice its speed: ``u' = k (v - speed u) cosh(u)^2/most`` with ``f = speed u``."""
    most, speed = 0.3, 0.1
    times = np.linspace(0.1, 4.0, 14)

    def rates(t, u):
        return STIFFNESS * (WAY * np.sin(TURN * t) - speed * u) * np.cosh(u) ** 2 / most

    u = solve_ivp(rates, (0.0, 4.0), [0.0], "Radau", times, rtol=1e-10, atol=1e-13).y[0]
    run = hb.simulate(slider(most, speed, turned), until=4.0, solver=solver)
    assert run.status == "ok" and run.audit().holds()
    assert run["c.e"].at(times) == pytest.approx(most * np.tanh(u), rel=1e-6)
    assert run["apart.f"].at(4.0) == 2.0


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_a_slider_far_beyond_its_speed_holds_its_most(solver, turned):
    """Twenty times its speed where the source is fastest: all but ``exp(-40)`` of the most."""
    most, speed = 10.0, 1e-2
    run = hb.simulate(slider(most, speed, turned), until=4.0, solver=solver)
    assert run.status == "ok" and run.audit().holds()
    fastest = np.pi / TURN * np.array([0.5, 1.5, 2.5, 3.5])
    assert run["c.e"].at(fastest) == pytest.approx(most * np.array([1, -1, 1, -1]), rel=1e-9)
    # before it gives way the spring follows the source
    assert run["c.q"].at(0.05) == pytest.approx(WAY / TURN * (1 - np.cos(TURN * 0.05)), rel=2e-2)
    assert len(run.events) < 20
