"""Dry friction as the law of a junction: an oscillator, a block on a belt."""

import math

import pytest

import hybond as hb

TURNING = [13.317821, -11.317821, 9.317821, -7.317821, 5.317821, -3.317821, 1.317821]
REST = 0.682179


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", ["friction_oscillator", "backwards"])
def test_turning_points_and_rest(name, simulate, solver):
    """The same with the bond of the friction drawn the other way round."""
    if name == "backwards":
        m = hb.Model("backwards", domain="translational")
        m.add(mass=hb.I("1 kg", f="6 m/s"), spring=hb.C("1 m/N", q="12 m"), v=hb.One())
        m.add(rub=hb.Zero(), slip=hb.One(law="coulomb", limit="1 N"))
        m.bond("v -> mass", "v -> spring", "slip -> rub -> v")
        run = hb.simulate(m, until=25.0, solver=solver)
    else:
        run = simulate(name, solver=solver)
    stops = run.events[1:]
    found = [run["spring.q"].at(e.t) for e in stops]
    assert found == pytest.approx([*TURNING, REST], abs=2e-6)
    first = math.atan2(6.0, 13.0)
    assert [e.t for e in stops] == pytest.approx([first + k * math.pi for k in range(8)], rel=1e-6)
    assert run.mode == {"slip": "sticks"}
    assert run["spring.q"].at(25.0) == pytest.approx(REST, abs=2e-6)
    assert run["v.f"].at(25.0) == pytest.approx(0.0, abs=1e-9)


def test_the_law_and_the_machine_agree(simulate):
    one, two = simulate("friction_oscillator"), simulate("coulomb_friction")
    for t in (0.3, 4.0, 11.0, 20.0, 24.0):
        assert one["spring.q"].at(t) == pytest.approx(two["spring.q"].at(t), abs=1e-6)
        assert one["rub.e"].at(t) == pytest.approx(two["rub.e"].at(t), abs=1e-6)


def test_higher_breakaway_force_holds_earlier(simulate):
    """At 1.317821 the spring pulls with more than 1 N, but less than 1.5 N."""
    run = simulate("friction_oscillator", parameters={"Fb": "1.5 N"})
    assert run.mode == {"slip": "sticks"}
    assert run["spring.q"].at(25.0) == pytest.approx(1.317821, abs=2e-6)


def belt_cycle(m, k, v0, F, Fb):
    """Duration of the slip, duration of the stick: a circle around F/k, cut by x' = v0."""
    w = math.sqrt(k / m)
    # from (d, v0) clockwise to (-d, v0) in the phase plane, d = (Fb - F)/k
    slip = (math.pi + 2.0 * math.atan2(v0 / w, (Fb - F) / k)) / w
    stick = 2.0 * (Fb - F) / k / v0
    return slip, stick


@pytest.mark.sampled(1)
def test_stick_slip(simulate, solver):
    run = simulate("stick_slip", solver=solver)
    m, k, v0, F, Fb = 1.0, 100.0, 0.2, 6.0, 10.0
    slip, stick = belt_cycle(m, k, v0, F, Fb)
    names = [run.graph.mode_names(e.steps[-1].mode)["slip"] for e in run.events]
    leave = [e.t for e, n in zip(run.events, names, strict=True) if n == "forward"][1:]
    hold = [e.t for e, n in zip(run.events, names, strict=True) if n == "sticks"][1:]
    assert len(leave) >= 5
    for a, b in zip(leave, hold, strict=False):
        assert b - a == pytest.approx(slip, rel=1e-6)
    for a, b in zip(hold, leave[1:], strict=False):
        assert b - a == pytest.approx(stick, rel=1e-6)
    # caught by the belt as far beyond F/k as it was let go before it
    assert run["spring.q"].at(leave[2]) == pytest.approx(Fb / k, rel=1e-6)
    assert run["spring.q"].at(hold[2]) == pytest.approx((2 * F - Fb) / k, rel=1e-6)
    assert run["v.f"].at(0.5 * (hold[2] + leave[3])) == pytest.approx(v0, rel=1e-12)


def pushed(limit, breakaway=None, force="2 [N/s]*time"):
    m = hb.Model("pushed", domain="translational", parameters={"mu": 0.5})
    rest = {} if breakaway is None else {"breakaway": breakaway}
    m.add(push=hb.Se(force), mass=hb.I("1 kg"), v=hb.One(), press=hb.Se("-8 N"), w=hb.One())
    m.add(contact=hb.Zero(law="unilateral"))
    m.add(rub=hb.Zero(), slip=hb.One(law="coulomb", limit=limit, **rest))
    m.bond("push -> v -> mass", "v -> rub -> slip", "press -> w", "contact -> w")
    return m


@pytest.mark.parametrize(("breakaway", "start"), [(None, 2.0), ("1.25*mu*contact.e", 2.5)])
def test_a_growing_push_breaks_loose(breakaway, start):
    """Loose at 4 N or 5 N, then m v' = 2 t - 4."""
    run = hb.simulate(pushed("mu*contact.e", breakaway), until=4.0)
    assert run.events[-1].t == pytest.approx(start, rel=1e-9)
    assert run["contact.e"].at(3.0) == pytest.approx(8.0, rel=1e-12)
    assert run["rub.e"].at(0.5 * start) == pytest.approx(start, rel=1e-9)
    t = 4.0
    velocity = (t * t - start * start) - 4.0 * (t - start)
    assert run["v.f"].at(t) == pytest.approx(velocity, rel=1e-7)


def test_on_an_incline(simulate):
    """Up with g (sin + mu cos), down with g (sin - mu cos); at rest while tan(alpha) <= mu."""
    g, alpha, v0 = 9.81, 0.35, 3.0
    s, c = math.sin(alpha), math.cos(alpha)
    for mu in (0.3, 0.5):
        run = simulate("block_on_incline", parameters={"mu": mu})
        up = v0 / (g * (s + mu * c))
        top = 0.5 * v0 * up
        assert run.events[-1].t == pytest.approx(up, rel=1e-6)
        assert run["way"].at(up) == pytest.approx(top, rel=1e-6)
        assert run["contact.e"].at(2.0) == pytest.approx(2.0 * g * c, rel=1e-9)
        back = 0.5 * max(s - mu * c, 0.0) * g * (3.0 - up) ** 2
        assert run["way"].at(3.0) == pytest.approx(top - back, rel=1e-6)
        assert run.mode["slip"] == ("backward" if mu < math.tan(alpha) else "sticks")
