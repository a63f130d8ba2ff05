"""A step that is repeated so that it ends at an event may be as far off as it was before.

A gap that a row of contacts holds at zero has no size but the rounding of its rate, which adds up
over the length of the step.
"""

from __future__ import annotations

import pytest

import hybond as hb


def bodies(*, gap: bool) -> hb.Model:
    """Return three bodies that a contact presses together, and a friction that it feeds."""
    m = hb.Model("bodies", domain="translational")
    for k, (mass, speed, force) in enumerate(
        [(0.2, -0.15365853658536588, -9.81), (2.0, 0.20487804878048774, 0.0)]
        + [(2.0, -0.20487804878048774, -2.0)]
    ):
        m.add(**{f"v{k}": hb.One(), f"m{k}": hb.I(mass, f=speed), f"f{k}": hb.Se(force)})
        m.bond(f"f{k} -> v{k} -> m{k}")
    m.add(c=hb.Zero(law="unilateral", **({"gap": "g"} if gap else {})), z=hb.Zero())
    m.add(r=hb.One(law="coulomb", limit="1.2*c.e"), k=hb.C(0.05))
    if gap:
        m.signal(g=hb.Integral("0.8*v0.f + 0.3*v1.f - 0.3*v2.f"))
    for k, n in enumerate((0.8, 0.3, -0.3)):
        m.add(**{f"n{k}": hb.TF(1 / n)})
        m.bond(f"c -> n{k} -> v{k}")
    for k, n in ((1, 1.0), (2, 0.8)):
        m.add(**{f"t{k}": hb.TF(n)})
        m.bond(f"v{k} -> t{k} -> z")
    m.bond("z -> r", "v0 -> k")
    return m


@pytest.mark.parametrize("solver", ["auto", "rk45", "exact"])
def test_a_gap_held_at_zero_asks_for_no_steps_before_an_event(solver: str) -> None:
    run = hb.simulate(bodies(gap=True), 0.8, solver=solver)
    plain = hb.simulate(bodies(gap=False), 0.8, solver=solver)
    assert run.stats["steps"] < 150  # there were 593 to 70,000
    assert [e.t for e in run.events] == pytest.approx([e.t for e in plain.events], abs=1e-8)
    for name in ("m0.p", "m1.p", "m2.p", "k.q"):
        assert run.final[name] == pytest.approx(plain.final[name], rel=1e-7)
