"""What is next to nothing just behind an instant is found from where the step goes.

A valve opens where a source passes zero: what drives is a last digit of it there, and laws beside
each other are flat and steep at rest.
"""

from __future__ import annotations

import pytest

import hybond as hb


def opened() -> hb.Model:
    m = hb.Model("opened")
    m.add(j=hb.Zero(law="unilateral", restitution=0.0), k=hb.One(), o=hb.One())
    m.add(S=hb.Sf("-0.571*sin(5.44*time)"), L=hb.I(0.468), lin=hb.R(2.03))
    m.add(a=hb.R({"e": "if f > 0 then 1.12*(f/1.3) else 0"}))
    m.add(b=hb.R({"e": "0.769*(f/1.69)*abs(f/1.69)"}))
    m.add(c=hb.R({"f": "1.5*sign(e)*sqrt(abs(e)/0.928)"}))
    m.bond("j -> o", "S -> j -> lin", "b -> k -> j -> a", "c -> o", "L -> j")
    return m


def test_the_audit_reads_it() -> None:
    """It was refused (HB-N301) although the run is there."""
    run = hb.simulate(opened(), until=1.36)
    assert run.status == "ok"
    assert run.audit().holds()
    (opens,) = (event.t for event in run.events if event.t > 0.0)
    for late in (0.0, 1e-16, 1e-12, 1e-6, 0.1):
        at = opens + late
        b, e = run["b.f"].at(at), run["b.e"].at(at)
        assert e == pytest.approx(-0.769 * (b / 1.69) * abs(b / 1.69), rel=1e-9)  # b points out
