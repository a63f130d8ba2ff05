"""A run that begins in an impact of contacts that rebound and of others that do not.

A restitution is of the approach that the start was given, and the start was looked at in the mode
in which plastic contacts were closed already: there they share one speed, which nothing has yet.
"""

from __future__ import annotations

import pytest

import hybond as hb

SPEEDS = (1.0, 0.0, -1.0)


def row(gives: tuple[float, float], masses: tuple[float, ...], given: dict[str, bool]) -> hb.Model:
    """Return three bodies that touch and run into each other."""
    m = hb.Model("row", domain="rotational" if given.get("rotational") else "translational")
    turned = given.get("turned", False)
    for k in range(3):
        speed = -SPEEDS[k] if turned else SPEEDS[k]
        m.add(**{f"v{k}": hb.One(), f"b{k}": hb.I(masses[k], f=speed)})
        m.bond(f"b{k} -> v{k}" if turned else f"v{k} -> b{k}")
    for k in range(2):
        rebounds = {"restitution": gives[k]} if gives[k] else {}
        gap = {"gap": f"g{k}"} if given.get("gap") else {}
        m.add(**{f"c{k}": hb.Zero(law="unilateral", **rebounds, **gap)})
        m.bond(f"v{k} -> c{k} -> v{k + 1}")
        if gap:
            m.signal(**{f"g{k}": hb.Integral(f"v{k + 1}.f - v{k}.f")})
    return m


@pytest.mark.parametrize("given", [{}, {"turned": True}, {"rotational": True}, {"gap": True}])
@pytest.mark.parametrize("masses", [(1.0, 1.0, 1.0), (1.0, 2.0, 3.0), (3.0, 1.0, 2.0)])
@pytest.mark.parametrize("gives", [(1.0, 0.0), (0.0, 1.0), (0.5, 0.0), (0.0, 0.0)])
def test_what_rebounds_does_so_from_the_speeds_that_were_given(
    gives: tuple[float, float], masses: tuple[float, ...], given: dict[str, bool]
) -> None:
    """Both pairs approach at 1 m/s: each parts at its restitution, momentum is kept."""
    run = hb.simulate(row(gives, masses, given), 1e-3)
    momentum = sum(a * b for a, b in zip(masses, SPEEDS, strict=True))
    middle = (momentum + masses[0] * gives[0] - masses[2] * gives[1]) / sum(masses)
    wanted = [middle - gives[0], middle, middle + gives[1]]
    assert [run[f"v{k}.f"].at(1e-3) for k in range(3)] == pytest.approx(wanted, abs=1e-12)
    assert run.status == "ok" and not run.warnings and run.audit().holds()


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 0, 2)])
@pytest.mark.parametrize("plastic", [0.0, 0.5])
def test_a_plastic_contact_that_carries_nothing_changes_no_rebound(
    plastic: float, order: tuple[int, int, int]
) -> None:
    """Of three levers between two bodies two reverse both speeds; the third is left behind."""
    levers = [((0.0, 5.0), 1.0), ((-1.0, -5.0), plastic), ((-0.125, -2.5), 1.0)]
    m = hb.Model("levers", domain="translational")
    m.add(x=hb.One(), y=hb.One(), a=hb.I(1.0, f=0.8), b=hb.I(10.0, f=-0.01))
    m.bond("x -> a", "y -> b")
    for k in order:
        ways, gives = levers[k]
        m.add(**{f"c{k}": hb.Zero(law="unilateral", **({"restitution": gives} if gives else {}))})
        for to, way in zip("xy", ways, strict=True):
            if way:
                m.add(**{f"t{k}{to}": hb.TF(1.0 / way)})
                m.bond(f"c{k} -> t{k}{to} -> {to}")
    run = hb.simulate(m, 1e-3)
    assert run["x.f"].at(1e-3) == pytest.approx(-0.8, rel=1e-12)
    assert run["y.f"].at(1e-3) == pytest.approx(0.01, rel=1e-12)
    assert run.audit().holds()


@pytest.mark.parametrize("turned", [False, True])
def test_an_impact_that_rubs_is_asked_once_more_as_it_was(turned: bool) -> None:
    """It sticks as the run begins; learning its signs, it was asked beside friction at rest.

    A run was called unsound (HB-N411) for that: both bodies are those of the contact and the slip.
    """
    across, along = (-0.46, -0.49), (0.47, 0.32)
    m = hb.Model("rub", domain="translational")
    m.add(x=hb.One(), y=hb.One(), a=hb.I(2.0, f=-0.5 if turned else 0.5), b=hb.I(2.0, f=0.05))
    m.bond("a -> x" if turned else "x -> a", "y -> b")
    m.add(c=hb.Zero(law="unilateral", gap="g", restitution=0.5), z=hb.Zero())
    m.signal(g=hb.Integral("-0.46*x.f - 0.49*y.f"))
    m.add(r=hb.One(law="coulomb", limit="2*c.e", impulsive=True))
    m.bond("z -> r")
    for way, slip, to in zip(across, along, "xy", strict=True):
        m.add(**{f"n{to}": hb.TF(1.0 / way), f"t{to}": hb.TF(slip)})
        m.bond(f"c -> n{to} -> {to}", f"{to} -> t{to} -> z")
    run = hb.simulate(m, 1e-3)
    x, y = run["x.f"].at(1e-3), run["y.f"].at(1e-3)
    assert across[0] * x + across[1] * y == pytest.approx(0.12725, rel=1e-12)
    assert along[0] * x + along[1] * y == pytest.approx(0.0, abs=1e-12)
    assert run.status == "ok"
