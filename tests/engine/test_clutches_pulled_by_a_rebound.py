"""What goes apart is not held together with an impact beside it: it is struck after that.

A light body rebounds at a wall, 0.9 of its speed, while a heavy one behind it comes more slowly; a
contact between them, which pushes only, has just been left. By hand, impact after impact: the wall
turns the light body round, it meets the heavy one and both go on together, and the wall turns both
round. In one problem the wall would turn both round at once, by energy that nobody has.
"""

from __future__ import annotations

import pytest

import hybond as hb

LIGHT, HEAVY = 1.0, 100.0
EPS = 0.9


def pair(kind: str, turned: bool) -> hb.Model:
    """Return both bodies, the light one at the wall, with what pushes between them."""
    m = hb.Model("pair", domain="translational")
    m.add(wall=hb.Sf(0.0), stop=hb.Zero(law="unilateral", restitution=EPS))
    m.add(va=hb.One(), a=hb.I(LIGHT, f=1.0 if turned else -1.0))
    m.add(vb=hb.One(), b=hb.I(HEAVY, f=0.7 if turned else -0.7))
    m.bond("va -> stop -> wall" if turned else "wall -> stop -> va", "va -> a", "vb -> b")
    first, then = ("vb", "va") if turned else ("va", "vb")
    if kind in ("contact", "one-way clutch", "plastic contact"):
        law = "diode" if kind == "one-way clutch" else "unilateral"
        options = {"restitution": 0.0} if kind == "plastic contact" else {}
        m.add(c=hb.Zero(law=law, **options))
        m.bond(f"{first} -> c -> {then}")
    else:
        law = "diode" if kind == "rope" else "unilateral"
        options = {} if kind == "rope" else {"restitution": 0.0}
        m.add(n=hb.Zero(), c=hb.One(law=law, **options), ground=hb.Se(0.0))
        m.bond(f"{first} -> n -> {then}", "ground -> c -> n")
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("kind", ["contact", "one-way clutch", "rope", "dual contact"])
def test_what_goes_apart_is_struck_after_the_rebound(kind: str, turned: bool) -> None:
    run = hb.simulate(pair(kind, turned), "10 ms")
    together = (EPS * LIGHT - 0.7 * HEAVY) / (LIGHT + HEAVY)
    way = 1.0 if turned else -1.0
    assert run["va.f"].at(0.01) == pytest.approx(way * EPS * together, rel=1e-12)
    assert run["vb.f"].at(0.01) == pytest.approx(way * EPS * together, rel=1e-12)
    lost = sum(s.energy.lost for e in run.events for s in e.steps if s.energy is not None)
    before = 0.5 * LIGHT + 0.5 * HEAVY * 0.49
    after = 0.5 * (LIGHT + HEAVY) * (EPS * together) ** 2
    assert lost == pytest.approx(before - after, rel=1e-9)
    assert not run.warnings and run.audit().holds()
