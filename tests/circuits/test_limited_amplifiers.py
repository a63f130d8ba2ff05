"""Amplifiers with limits, fed back against themselves: Newton's steps swing between both limits."""

import pytest

import hybond as hb
from hybond.engine.mode.nonlinear import newton

TRIANGLE = """Triangle
E1 tri 0 VALUE={min(max(-1e5*V(m),-14),14)}
C1 m tri 10n IC=0
R1 sq m 10k
B1 sq0 0 V = V(p) > 0 ? 12 : -12
Rs sq0 sq 10
Cs sq 0 100p
R2 tri p 10k
R3 sq p 20k
Cp p 0 1p
.tran 1u 0.5m uic
.end
"""


@pytest.fixture
def triangle(tmp_path):
    deck = tmp_path / "triangle.cir"
    deck.write_text(TRIANGLE)
    return hb.read_circuit(deck)


def test_what_swings_between_two_limits_is_not_looked_for_by_parts_of_steps(triangle, monkeypatch):
    """Each value took 500 evaluations of the amplifier, which is steep in 1e-5 of its range."""
    called = []
    before = newton.damped
    monkeypatch.setattr(newton, "damped", lambda *a: called.append(a) or before(*a))
    assert hb.simulate(triangle.model, until=1e-9, engine="python").status == "ok"
    assert not called


def test_a_triangle_generator_has_the_period_of_its_integrator(triangle):
    """Of 4 R1 C1 R2/R3, but for 10 ohm and some ns; to and fro between -6 V and 6 V."""
    run = hb.simulate(triangle.model)
    assert run.status == "ok"
    edges = [e.t for e in run.events[1:]]
    assert edges[3] - edges[1] == pytest.approx(4 * 10e3 * 10e-9 * 0.5, rel=3e-3)
    assert run.measure("max(tri.e)") == pytest.approx(6.0, rel=3e-3)
    assert run.measure("min(tri.e)") == pytest.approx(-6.0, rel=3e-3)


def test_a_filter_that_has_only_just_begun_is_not_said_to_be_fed_back(tmp_path):
    """Its output is 3e-25 V then, with the rounding of what is solved beside it."""
    deck = tmp_path / "filter.cir"
    deck.write_text(
        "Two integrators in a loop\nVin in 0 PULSE(-1 1 0 1u 1u 499u 1m)\nR1 in a 10k\n"
        "Rq b1 a 50k\nRf lp a 10k\nC1 a b1 10n\nE1 b1 0 0 a 1e5\nR3 b1 c 10k\nC2 c d 10n\n"
        "E2 d 0 0 c 1e5\nR5 d e 10k\nR6 e lp 10k\nE3 lp 0 0 e 1e5\n"
        "Bx x 0 V = V(lp) > 0 ? 5 : 0\nRx x y 10k\nCy y 0 1u\n.tran 1u 2u uic\n.end\n"
    )
    assert not hb.simulate(hb.read_circuit(deck).model).warnings
