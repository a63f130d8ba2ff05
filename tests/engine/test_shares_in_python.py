"""Laws that may share what they carry: the engine as Python says what it says as C.

Directions in which an answer is free were made of length one before they were at right angles: a
root of less than zero, which C goes past as no number and Python stops at.
"""

from __future__ import annotations

import numpy as np
import pytest

import hybond as hb

TEXT = """
hybond = 1
[elements]
j0 = { junction = 1 }
j1 = { junction = 1, law = "relay", limit = LIMIT }
j2 = { junction = 0, law = "diode" }
j3 = { junction = 1, law = "diode" }
t2 = { GY = "RATIO" }
r0 = { R = 0.49204545454545456 }
r1 = { R = { e = "0.589*tanh(f/1.09)" } }
s0 = { Sf = "1.76*clock0" }
s0_at = { junction = 0 }
s0_r = { R = 1.0 }

[graph]
bonds = ["j3 -> j0", "t2.2 -> j2", "r1 -> j2", "j0 -> j2", "j1 -> t2.1",
         "r0 -> j2", "s0 -> s0_at", "s0_at -> j2", "s0_at -> s0_r", "j1 -> j0"]

[inputs]
clock0 = { pwm = { period = 0.1182999676655586, duty = 0.665, high = 1.0, low = 0.0 } }
"""


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("limit", "ratio"), [("0.917", "-1.89"), ("0.5", "-3"), ("2", "-0.7")])
def test_python_goes_where_c_goes(limit: str, ratio: str, turned: bool) -> None:
    text = TEXT.replace("LIMIT", limit).replace("RATIO", ratio)
    if turned:  # only what has no law of its own beside it: the half arrow of a resistor
        text = text.replace('"r0 -> j2"', '"j2 -> r0"').replace('"r1 -> j2"', '"j2 -> r1"')
    model = hb.loads(text)
    one, other = (hb.simulate(model, 0.746, engine=e) for e in ("library", "python"))
    assert one.events.t.tolist() == pytest.approx(other.events.t.tolist(), abs=1e-12)
    for run in (one, other):
        # the source's current divides: what is not in s0_r flows on into j2
        t = np.array([0.03, 0.1, 0.2, 0.7])
        into, own = run.sample(t, ["s0.f", "s0_r.f"]).values()
        assert np.abs(np.where((t / 0.1182999676655586) % 1.0 < 0.665, 1.76, 0.0) - into).max() == 0
        assert run.sample(t, ["s0_at.e"])["s0_at.e"] == pytest.approx(own, abs=1e-12)
        assert run.audit().holds()
