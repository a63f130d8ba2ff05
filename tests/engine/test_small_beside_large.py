"""What is small beside what is large in one run keeps its own digits.

Found by random models with controllers: a sample moves a source by less than rounding of what the
whole run stores, a mass is lost beside another, a flow that is zero has the rounding of an effort.
"""

import itertools
import math

import pytest

import hybond as hb


@pytest.mark.parametrize("law", ["", "diode"])
def test_source_that_a_sample_moves_a_little(law):
    # the charge of `small` at 1 V is 1e-7 of what the energy of `large` would be there: the law of
    # the source was off by what the sample changes, at the sample itself (HB-N411)
    m = hb.Model("sampled")
    m.add(s=hb.Se("(1 + time)*(1 - tanh(u))"), node=hb.Zero(), small=hb.C(4e-8))
    m.add(beside=hb.Zero(), large=hb.C(1.0, q=1.0), leak=hb.R(100.0))
    m.bond("s -> node", "node -> small", "large -> beside", "beside -> leak")
    if law:  # laws of junctions go another way
        m.add(one=hb.One(law=law), r=hb.R(1.0))
        m.bond("beside -> one", "one -> r")
    m.signal(u=hb.Sampled("small.q", every=0.1))
    run = hb.simulate(m, 0.45)
    q = 0.0
    for k in range(5):
        held = q
        q = 4e-8 * (1.0 + 0.1 * k) * (1.0 - math.tanh(held))
        if k:
            assert run["small.q"].at(0.1 * k) == pytest.approx(q, rel=1e-13)
        # just before the next sample
        q = 4e-8 * (1.1 + 0.1 * k) * (1.0 - math.tanh(held))
    assert run.audit().holds()


@pytest.mark.parametrize("light", [1e-3, 2e-12, 1e-15])
@pytest.mark.parametrize("order", list(itertools.permutations(["heavy", "light", "drag"])))
def test_light_mass_that_moves_with_a_heavy_one(light, order):
    # the drag was taken from the speed of the light mass, whose force was lost in a difference of
    # sums: a tenth off, by the order of bonds
    m = hb.Model("drag")
    m.add(heavy=hb.I(3000.0, p=-8.0), light=hb.I(light), drag=hb.R(400.0), way=hb.One())
    m.bond(*(f"way -> {name}" for name in order))
    run = hb.simulate(m, 3.0)
    mass = 3000.0 + light
    p = -8.0 * math.exp(-400.0 / mass * 3.0)
    assert run["heavy.p"].at(3.0) == pytest.approx(p * 3000.0 / mass, rel=1e-7)
    assert run["light.p"].at(3.0) == pytest.approx(p * light / mass, rel=1e-7)


@pytest.mark.parametrize("order", list(itertools.permutations(["drag", "heavy", "g"])))
def test_light_spring_behind_a_gyrator(order):
    # storages of two kinds: the spring, at 1000 times the speed, loads the mass by 1e6 C
    m = hb.Model("gyrator")
    m.add(way=hb.One(), drag=hb.R(400.0), g=hb.GY(1000.0), node=hb.Zero())
    m.add(heavy=hb.I(3000.0, p=-8.0), light=hb.C(1e-18))
    m.bond("g -> node", "node -> light", *(f"way -> {name}" for name in order))
    run = hb.simulate(m, 3.0)
    p = -8.0 * math.exp(-400.0 / 3000.0 * 3.0)
    assert run["heavy.p"].at(3.0) == pytest.approx(p, rel=1e-7)
    assert run["light.q"].at(3.0) == pytest.approx(1e-18 * 1000.0 * p / 3000.0, rel=1e-7)


@pytest.mark.parametrize("solver", ["auto", "rk45"])
def test_flow_that_is_zero_beside_efforts_that_are_not(solver):
    # behind the first pulse no step was found at which all laws hold (HB-N301)
    m = hb.Model("pulses")
    m.add(s=hb.Se("-sin(4*time)"), j=hb.One(), drive=hb.Sf("(0.5 - 0.25*c.q)*pulse"))
    m.add(heavy=hb.I(2.0), c=hb.C(0.4), light=hb.I(1e-9))
    m.bond("light -> j", "c -> j", "heavy -> j", "drive -> j", "s -> j")
    pwm = {"period": 0.3, "duty": 0.4, "high": 1.0, "low": 0.0}
    m.input(pulse=hb.Input(pwm=pwm))
    run = hb.simulate(m, 0.5, solver=solver)
    # q' = -(0.5 - 0.25 q) for 0.24 s in all
    assert run["c.q"].at(0.5) == pytest.approx(2.0 - 2.0 * math.exp(0.06), rel=1e-7)
