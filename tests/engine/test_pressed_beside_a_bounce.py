"""What is pressed together beside a bounce that dies out carries no impulse: not even of rounding.

The impulse of each contact is put back into the law of impacts. That of one which others move at
last bounces of 1e-8 N*s is rounding of the momenta beside it, of either sign. Momentum is the
oracle: what forces of constant size have given in the time.
"""

from __future__ import annotations

import pytest

import hybond as hb

# masses, pushes from both sides, speed, weight of the ball, stiffness, height: each as drawn
DRAWN = [
    ((1.845, 1.358, 1.423, 1.436), (5.95, 4.531), 0.739, 3.32, 64.393, 0.137),
    ((0.952, 1.496, 2.735, 1.508), (4.732, 4.044), 0.628, 5.501, 29.684, 0.143),
    ((2.516, 2.964, 2.206, 2.302), (2.312, 3.236), 0.649, 5.867, 27.856, 0.205),
]


@pytest.mark.parametrize("law", [0.0, 0.5])
@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("drawn", DRAWN)
def test_contacts_pressed_together_beside_a_bounce_are_sound(drawn, way: float, law: float) -> None:
    """Two blocks, pressed together, hold by a spring a third on which a ball bounces out."""
    (a, b, c, d), (left, right), speed, weight, stiffness, height = drawn
    rebounds = {"restitution": law} if law else {}
    m = hb.Model("pressed", domain="translational")
    m.add(A=hb.I(a, f=way * speed), B=hb.I(b, f=way * speed), C=hb.I(c), D=hb.I(d), s=hb.Zero())
    m.add(a=hb.One(), b=hb.One(), c=hb.One(), d=hb.One(), k=hb.C(1 / stiffness))
    m.add(P=hb.Se(way * left), Q=hb.Se(-way * right), W=hb.Se(-way * weight))
    m.add(pressed=hb.Zero(law="unilateral", gap="g", **rebounds))
    m.add(hit=hb.Zero(law="unilateral", gap="h", restitution=0.6))
    m.bond("P -> a -> A", "Q -> b -> B", "c -> C", "W -> d -> D", "b -> s -> c", "s -> k")
    if way > 0.0:
        m.bond("a -> pressed -> b", "c -> hit -> d")
    else:
        m.bond("b -> pressed -> a", "d -> hit -> c")
    m.signal(g=hb.Integral(f"{way}*(b.f - a.f)"), h=hb.Integral(f"{way}*(d.f - c.f)", height))
    run = hb.simulate(m, until=1.2)
    assert run.status == "ok" and run.audit().holds()
    momentum = sum(float(run[f"{body}.p"].at(1.2)) for body in "ABCD")
    given = (a + b) * speed + (left - right - weight) * 1.2
    assert momentum == pytest.approx(way * given, rel=1e-12, abs=1e-12)
