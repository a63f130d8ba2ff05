"""Rates where nothing moves any more after a jump: what is left has the rounding of what did."""

from __future__ import annotations

import pytest

import hybond as hb

STOPPED = """
hybond = 1
[elements]
j0 = { junction = 1, law = "diode" }
j1 = { junction = 1 }
j2 = { junction = 1 }
t2 = { TF = "1.67" }
i0 = { I = 1.4083333333333334, p = -1.66 }
c1 = { C = 0.47927927927927927, q = 0.0 }
i2 = { I = { f = "1.55*sinh(p/1.12)" }, p = 0.0844 }
s0 = { Se = "0.909*sin(3.41*time)" }
s0_at = { junction = 1 }
s0_r = { R = 1.0 }
[graph]
bonds = [
  "j1 -> t2.1", "j1 -> j0", "s0 -> s0_at", "s0_at -> j1", "s0_at -> s0_r", "i0 -> j2", "c1 -> j2",
  "j1 -> j0", "j2 -> i2", "j2 -> t2.2",
]
"""
SHORTED = """
hybond = 1
[elements]
j0 = { junction = 0, law = "relay", limit = 1.51 }
j1 = { junction = 0 }
j2 = { junction = 1 }
j3 = { junction = 0, law = "coulomb", limit = 0.826 }
j4 = { junction = 0 }
j5 = { junction = 0, law = "diode" }
t3 = { GY = "0.991" }
t5 = { GY = "-0.766" }
r1 = { R = [[1.42, 0.505], [0.505, 0.506]] }
i2 = { I = 0.6290322580645161, p = -0.626 }
i4 = { I = [[0.871, 0.177], [0.177, 1.48]], p = [0.6419429029405741, 0.07709650695225911] }
c7 = { C = 1.6176470588235292, q = 0.0 }
s0 = { Sf = "0.99*sin(2.65*time)" }
s0_at = { junction = 0 }
[graph]
bonds = [
  "j0 -> j2", "j4 -> s0_at", "s0_at -> s0", "j4 -> i4.1", "j2 -> t5.1", "t3.1 -> j0",
  "i4.2 -> j2", "i2 -> j4", "r1.2 -> j1", "t5.2 -> j5", "j2 -> r1.1", "j3 -> t3.2", "j3 -> j4",
  "j5 -> c7",
]
"""
TURNED = {"s0 -> s0_at": "s0_at -> s0", "j2 -> i2": "i2 -> j2", "c1 -> j2": "j2 -> c1"}
"""Bonds that change signs and no sizes, of the first; the loads are odd."""


@pytest.mark.parametrize("turn", [False, True])
def test_the_rate_of_a_spring_that_nothing_moves_yet_is_rounding(turn: bool) -> None:
    text = STOPPED
    for one, other in TURNED.items() if turn else ():
        text = text.replace(f'"{one}"', f'"{other}"')
    if turn:
        text = text.replace("p = 0.0844", "p = -0.0844").replace("0.909*", "-0.909*")
    run = hb.simulate(hb.loads(text), until=0.604)
    assert run.status == "ok"
    # all is lost at first
    assert run["i0.p"].at(1e-6) == pytest.approx(0.0, abs=1e-11)
    assert run.audit().holds()


@pytest.mark.parametrize("restarts", [0.98, 1.0])
def test_rates_of_what_is_shorted_are_rounding_of_what_it_holds(restarts: float) -> None:
    run = hb.simulate(hb.loads(SHORTED.replace("-0.626", f"{-0.626 * restarts}")), until=0.754)
    assert run.status == "ok"
    # what is shorted holds what it had
    assert run["i2.p"].at(0.7) == pytest.approx(run["i2.p"].at(0.1), rel=1e-12)
    assert run.audit().holds()
