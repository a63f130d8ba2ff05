"""Steps at a kink beside an orifice: stages that lead nowhere are given up, and not sought twice.

A source moves what is stored behind a gyrator, ``f = e/r``, along a table with corners: the rate
jumps there, and no stages over a corner have an answer. The orifice at the same source begins at
zero, where its slope has no bound.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

TEXT = """hybond = 1
[elements]
p = { junction = 0 }
v = { junction = 1 }
gy = { GY = "-0.0127" }
orifice = { R = { f = "0.00935*sign(e)*sqrt(abs(e)/0.128)" } }
push = { Se = "-0.0107*sin(0.683*time)" }

[elements.body]
I = { f = { table = [[-826.0, -413.0, 0.0, 413.0, 1239.0],
                     [-0.00399, -0.00133, 0.0, 0.00133, 0.001995]], extrapolate = "linear" } }

[graph]
bonds = ["p -> push", "orifice -> p", "p -> gy.1", "gy.2 -> v", "body -> v"]
"""


@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_corners_beside_an_orifice_take_no_evaluations_in_vain(solver: str) -> None:
    """They took 86,000 for 15 steps: 200 corrections each time that stages were looked for."""
    run = hb.simulate(hb.loads(TEXT), 0.196, solver=solver)
    speed = 0.0107 * math.sin(0.683 * 0.196) / 0.0127
    # the last piece of the table goes on
    momentum = -413.0 - (speed - 0.00133) * (826.0 - 413.0) / (0.00399 - 0.00133)
    assert run.final["body.f"] == pytest.approx(speed, rel=1e-9)
    assert run.final["body.p"] == pytest.approx(momentum, rel=1e-6)
    assert run.stats["evaluations"] < 1000 * run.stats["steps"]
