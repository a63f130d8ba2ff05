"""What a stop lets go of where a sine turns its sign: it begins with next to no push at all.

There the time is known to its rounding, hence so is the push; what is stored from it grows with
the square of the time since, and an integral of that with its cube.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

PUSH, INERTIA, DRAG = 2.5, 0.86, 0.79

BODY = """
hybond = 1
[elements]
push = {{ Se = "-{push}*sin({w}*time)" }}
moves = {{ junction = 1 }}
stop = {{ junction = 0, law = "unilateral" }}
body = {{ I = {inertia} }}
drag = {{ R = {drag} }}
[graph]
bonds = ["push -> moves", "moves -> stop", "stop -> body", "moves -> drag"]
[signals]
way = {{ integral = "{rate}" }}
"""

CHARGED = """
hybond = 1
[elements]
push = {{ Sf = "-{push}*sin({w}*time)" }}
moves = {{ junction = 0 }}
stop = {{ junction = 1, law = "diode" }}
body = {{ C = {inertia} }}
drag = {{ G = {drag} }}
[graph]
bonds = ["push -> moves", "moves -> stop", "stop -> body", "moves -> drag"]
[signals]
way = {{ integral = "{rate}" }}
"""


@pytest.mark.parametrize("solver", ["radau", "rk45"])
@pytest.mark.parametrize("w", [3.0, 4.4, 6.1])
@pytest.mark.parametrize(
    ("model", "rate", "factor"),
    [
        (BODY, "body.p", 1.0),
        (BODY, "2*body.f", 2.0 / INERTIA),
        (CHARGED, "body.q", 1.0),
        (CHARGED, "-3*body.q", -3.0),
    ],
)
def test_a_signal_integrates_what_begins_to_move(
    model: str, rate: str, factor: float, w: float, solver: str
) -> None:
    built = hb.loads(model.format(push=PUSH, inertia=INERTIA, drag=DRAG, w=w, rate=rate))
    since = 0.6 * math.pi / w
    run = hb.simulate(built, math.pi / w + since, solver=solver)
    slows = DRAG / INERTIA
    moved = slows * (1.0 - math.cos(w * since)) / w - math.sin(w * since)
    moved += w * -math.expm1(-slows * since) / slows
    moved *= factor * PUSH / (slows**2 + w**2)
    assert run.status == "ok"
    assert run.final["way"] == pytest.approx(moved, rel=1e-6)
