"""A contact whose motion friction decides: it strikes nothing that friction gives way to.

A source drives a mass through dry friction and a contact that only pushes. The friction carries
the source's motion less at most its limit; the mass is pushed as soon as that is slower than it
is. So its speed is the smallest value, so far, of the source's flow plus the limit, or zero.
Nothing ever approaches by what is stored, so restitution has nothing to do.
"""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

import hybond as hb

LIMIT, PEAK, PACE = 0.558, 1.59, 4.5
UNTIL = 2.0
NAMES = (("a", "b"), ("b", "a"))


def pushed(t: float) -> float:
    """Return the speed of the mass: a running minimum."""
    times = np.linspace(0.0, t, 200_001)
    return min(0.0, float(np.min(PEAK * np.sin(PACE * times) + LIMIT)))


def check(m: hb.Model, name: str, ratio: float) -> None:
    """Run a model; `name` divided by `ratio` is the speed of the mass, or its dual."""
    run = hb.simulate(m, UNTIL)
    for t in (0.5, 0.85, 1.0, 1.5, UNTIL):
        assert run[name].at(t) / ratio == pytest.approx(pushed(t), abs=1e-9), t
    assert run.audit().holds()


@pytest.mark.parametrize(("names", "rebound"), list(product(NAMES, (0.0, 0.5, 0.9))))
def test_a_mass_is_pushed_through_friction_whatever_the_names(
    names: tuple[str, str], rebound: float
) -> None:
    """The case that was seen: an impact came of a speed that friction had only just chosen."""
    friction, contact = names
    m = hb.Model("pushed")
    m.add(**{friction: hb.Zero(law="relay", limit=LIMIT)})
    m.add(**{contact: hb.Zero(law="unilateral", restitution=rebound)})
    m.add(mass=hb.I(2.0), v=hb.One(), drive=hb.Sf(f"{PEAK}*sin({PACE}*time)"))
    m.bond(f"{contact} -> {friction}", f"{friction} -> drive", f"{contact} -> v", "mass -> v")
    check(m, "mass.p", 2.0)


@pytest.mark.parametrize(("names", "rebound"), list(product(NAMES, (0.3, 0.8))))
def test_a_store_is_filled_through_friction_whatever_the_names(
    names: tuple[str, str], rebound: float
) -> None:
    """The same with efforts and flows exchanged: a diode that rebounds, and a relay of flow."""
    friction, contact = names
    m = hb.Model("filled")
    m.add(**{friction: hb.One(law="coulomb", limit=LIMIT)})
    m.add(**{contact: hb.One(law="unilateral", restitution=rebound)})
    m.add(store=hb.C(0.5), e=hb.Zero(), drive=hb.Se(f"{PEAK}*sin({PACE}*time)"))
    m.bond(f"{contact} -> {friction}", f"{friction} -> drive", f"{contact} -> e", "store -> e")
    check(m, "store.q", -0.5)  # the arrow leaves it: its effort has the other sign


@pytest.mark.parametrize("names", NAMES)
def test_a_mass_behind_a_lever_is_pushed_through_friction(names: tuple[str, str]) -> None:
    """A lever between contact and mass."""
    friction, contact = names
    m = hb.Model("lever")
    m.add(**{friction: hb.Zero(law="coulomb", limit=LIMIT)})
    m.add(**{contact: hb.Zero(law="unilateral", restitution=0.6)})
    m.add(mass=hb.I(0.3), lever=hb.TF(4.0), drive=hb.Sf(f"{PEAK}*sin({PACE}*time)"), v=hb.One())
    m.bond(f"{contact} -> {friction}", f"{friction} -> drive", f"{contact} -> lever.1")
    m.bond("lever.2 -> v", "v -> mass")
    run = hb.simulate(m, UNTIL)
    # f1 = f2/4: the bond into the lever carries the speed
    ratio = run["mass.p"].at(UNTIL) / pushed(UNTIL)
    assert abs(ratio) in (pytest.approx(0.3 * 4.0), pytest.approx(0.3 / 4.0))
    check(m, "mass.p", ratio)


@pytest.mark.parametrize("names", [("a", "b", "c"), ("c", "b", "a"), ("b", "c", "a")])
def test_friction_in_two_places_gives_way_together(names: tuple[str, str, str]) -> None:
    """Two frictions in series of flows add up to one limit."""
    one, two, contact = names
    m = hb.Model("two")
    m.add(**{one: hb.Zero(law="relay", limit=0.2), two: hb.Zero(law="relay", limit=LIMIT - 0.2)})
    m.add(**{contact: hb.Zero(law="unilateral", restitution=0.5)})
    m.add(mass=hb.I(2.0), v=hb.One(), drive=hb.Sf(f"{PEAK}*sin({PACE}*time)"))
    m.bond(f"{contact} -> {one}", f"{one} -> {two}", f"{two} -> drive", f"{contact} -> v")
    m.bond("mass -> v")
    check(m, "mass.p", 2.0)
