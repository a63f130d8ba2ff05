"""Friction in a plane: as slip begins its direction hangs on rounding, by slopes beyond all bounds.

By these what pushes was taken for 1e11 J, and rounding of guards for millionths: the next time that
the block broke loose was late by a ten-millionth of the run. Along any line of the plane it does
what it does on one line, which has a closed form.
"""

import math

import pytest

import hybond as hb


def belt(angle):
    """A block on a belt, held by a spring: 2 N while it slips, 3 N to break loose."""
    m = hb.Model("belt", domain="translational")
    for axis, part in (("x", math.cos(angle)), ("y", math.sin(angle))):
        law = {"limit": 2, "breakaway": 3} if axis == "x" else {"pair": "sx"}
        m.add(**{f"b{axis}": hb.Sf(0.5 * part), f"z{axis}": hb.Zero()})
        m.add(**{f"s{axis}": hb.One(law="coulomb", **law), f"v{axis}": hb.One()})
        m.add(**{f"m{axis}": hb.I(1), f"k{axis}": hb.C(1)})
        m.bond(f"b{axis} -> z{axis} -> v{axis}", f"z{axis} -> s{axis}")
        m.bond(f"v{axis} -> m{axis}", f"v{axis} -> k{axis}")
    return m


def turns():
    """When it sticks and when it breaks loose, from the first time that it sticks."""
    # x'' = 2 - x from rest: v = 2 sin t, until that is the speed of the belt
    t = math.asin(0.25)
    stretch = 2 - 2 * math.cos(t)
    found = [t]
    for _ in range(4):
        t += (3 - stretch) / 0.5
        found.append(t)
        # about 2 N from 3 N and 0.5 m/s, back to 0.5 m/s on the other side
        t += 2 * math.pi - 2 * math.atan2(1.0, 0.5)
        stretch = 1.0
        found.append(t)
    return found


@pytest.mark.parametrize("until", [20.0, 40.0, 80.0])
@pytest.mark.parametrize("angle", [0.4, 2.0, math.pi / 2])
@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_it_breaks_loose_in_time(solver, angle, until):
    run = hb.simulate(belt(angle), until=until, solver=solver)
    assert run.status == "ok" and run.audit().holds()
    events = [e.t for e in run.events if e.cause == "guard"][:5]
    assert events == pytest.approx(turns()[: len(events)], abs=2e-7)
