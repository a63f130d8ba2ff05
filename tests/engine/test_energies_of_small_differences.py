"""Energy over a step is integrated as far as the digits of its power go, and no further.

Behind a root, what passes by is the root of a small difference, whose last digits are a staircase:
pieces of a step get never short enough for that, and an audit would look at it for minutes.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb
from hybond.engine.looking import energies


def behind_a_root() -> hb.Model:
    """A body whose speed follows a source, but for what a root leaves over."""
    m = hb.Model("root")
    m.add(a=hb.Zero(), b=hb.Zero(), t=hb.TF(0.0355), w=hb.Sf("-0.00139*sin(0.00714*time)"))
    m.add(i=hb.I({"f": "0.875*sinh(p/0.00319)"}, p=-0.000866))
    m.add(k=hb.I({"f": "248.0*((p/0.00551) + (p/0.00551)^3)"}, p=0.0))
    m.add(r=hb.R({"e": "0.00964*sign(f)*sqrt(abs(f)/7.67)"}))
    m.add(s=hb.Sf("0.616*(1 - 0.5*tanh(i.p/0.000866))"))
    m.bond("a -> i", "b -> s", "a -> r", "k -> a", "a -> t -> b", "b -> w")
    return m


@pytest.mark.slow
def test_an_audit_behind_a_root_looks_at_few_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is left of two speeds that cancel has no digits: that takes no 200 pieces a step."""
    steps = 60
    try:
        run = hb.simulate(behind_a_root(), 1.36, max_steps=steps, engine="python")
    except hb.NumericsError as error:
        assert error.partial is not None
        run = error.partial
    many = [0]
    ask = energies.take_piece

    def counted(*given: object) -> int:
        many[0] += 1
        return ask(*given)  # type: ignore[arg-type]

    monkeypatch.setattr(energies, "take_piece", counted)
    segment = run.segments[0]
    supplied, dissipated = run.energies(segment)[-1]
    assert many[0] < 25 * len(segment.t)
    stored = run.signals.stored(np.asarray(segment.y)[[0, -1]])
    assert stored[1] - stored[0] == pytest.approx(supplied - dissipated, abs=1e-6)


@pytest.mark.parametrize("still", [0.0, 1.0, 1e6])
def test_little_energy_is_known_beside_much(still: float) -> None:
    """What a resistor takes has its digits, whatever another storage holds."""
    m = hb.Model("beside")
    m.add(c=hb.C(1.0, q=1e-3), r=hb.R(1.0), j=hb.Zero(), big=hb.C(1.0, q=math.sqrt(2.0 * still)))
    m.add(k=hb.Zero())
    m.bond("j -> c", "j -> r", "k -> big")
    run = hb.simulate(m, 5.0)
    dissipated = run.energies(run.segments[0])[-1, 1]
    assert dissipated == pytest.approx(0.5e-6 * (1.0 - math.exp(-10.0)), rel=1e-6)
