"""What settles within far less than the run takes is right to the tolerance, whatever rounding is.

The current through 1 microhm is a difference of voltages, and off by the rounding of these. That
was taken to add up over a millionth of the run, which 1 pF never lets it: its voltage was 2 % off,
and on the way there explicit steps that were unstable passed for steps over a kink (1e18 V).
"""

from __future__ import annotations

import numpy as np
import pytest

import hybond as hb

VOLTAGE = """
hybond = 1
name = "fast beside a long run"
[elements]
s = {{ Se = "1 + 0.5*sin({w}*time)" }}
j = {{ junction = 1 }}
r = {{ R = {r} }}
n = {{ junction = 0 }}
c = {{ C = {c} }}
d = {{ R = {{ f = "{law}" }} }}
[graph]
bonds = ["s -> j", "{turned}", "j -> n", "n -> c", "n -> d"]
"""


def dual(text: str) -> str:
    """Return the model with efforts and flows exchanged; `e` in its law stays what it reads."""
    swapped = text.replace("Se =", "Sf =").replace("C =", "I =").replace("R = {{ f", "R = {{ e")
    swapped = swapped.replace("r = {{ R", "r = {{ G")
    for old, new in (
        ("junction = 1", "_"),
        ("junction = 0", "junction = 1"),
        ("_ }", "junction = 0 }"),
    ):
        swapped = swapped.replace(old, new)
    return swapped


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize(
    ("span", "r", "c", "law", "turned"),
    [
        (1.0, 1e-6, 1e-12, "max(e, 0)", "j -> r"),
        (1.0, 1e-8, 1e-9, "max(e, 0)", "r -> j"),
        (100.0, 1e-9, 1e-6, "max(e, 0)", "j -> r"),
        (100.0, 1e-9, 1e-12, "0.001*e + e^3", "r -> j"),
    ],
)
@pytest.mark.parametrize("of", ["voltages", "currents"])
def test_what_settles_at_once_follows_to_the_tolerance(of, span, r, c, law, turned, solver):
    text = VOLTAGE if of == "voltages" else dual(VOLTAGE)
    read = "e" if of == "voltages" else "f"
    law = law.replace("e", read)
    text = text.format(w=10.0 / span, r=r, c=c, law=law, turned=turned)
    run = hb.simulate(hb.loads(text), span, solver=solver)
    assert run.status == "ok"
    times = np.array([k * span / 50 for k in range(1, 50)])
    found = run.sample(times.tolist(), [f"c.{read}"])[f"c.{read}"]
    asked = 1.0 + 0.5 * np.sin(10.0 * times / span)
    drop = r * (asked if "max" in law else 1e-3 * asked + asked**3)
    assert np.abs(found - asked + drop).max() < 1e-5
    # nothing is charged beyond what charges it, nor discharged below nothing
    begin = [r * c * 10.0**k for k in range(-2, 8)]
    early = run.sample(begin, [f"c.{read}"])[f"c.{read}"]
    assert early.min() >= -1e-5 and early.max() <= 1.0 + 1e-5


@pytest.mark.parametrize("at", [0.0, 1.0, 50.0])
def test_what_two_have_together_is_no_matter_of_how_soon_they_agree(at: float) -> None:
    """Two capacitors of 1 pF behind 1 kohm, joined by 1 microhm, follow a step within 2 ns."""
    m = hb.Model("pair", domain="electrical")
    m.add(a=hb.C(1e-12), b=hb.C(1e-12), n=hb.Zero(), k=hb.Zero(), j=hb.One(), r=hb.R(1e-6))
    m.add(s=hb.Se(f"if time < {at} then 0 else 1"), q=hb.One(), R=hb.R(1e3))
    m.bond("s -> q -> n", "q -> R", "n -> a", "n -> j -> k", "j -> r", "k -> b")
    run = hb.simulate(m, 2.0 * max(at, 1.0), solver="radau", max_steps=2000)
    assert run.final["b.e"] == pytest.approx(1.0, abs=1e-6)
