"""What comes to rest close to a kink of a law, and is held there by the slope on its own side.

A difference of its rates that reaches over the kink is of the slope beyond. Where that is steeper,
stages looked as if they had converged, and what was computed was off, status ok; where they did not
converge such runs crawled, or ended with HB-N201.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb

BULK = 1.4e9
STEEP = 1e6


def cylinder(start: float, inwards: bool) -> hb.Model:
    """A cushioned cylinder that is driven into one of its ends through an orifice."""
    m = hb.Model("cylinder", domain="hydraulic")
    m.add(ps=hb.Submodel("hydraulic.pressure_source", p="60 bar"))
    m.add(o=hb.Submodel("hydraulic.orifice", area="6 mm^2"))
    m.add(t=hb.Submodel("hydraulic.atmosphere"), M=hb.I("40 kg", domain="translational"))
    m.add(c=hb.Submodel("hydraulic.cushioned_cylinder", x_0=start))
    driven, open_one = ("c.b", "c.a") if inwards else ("c.a", "c.b")
    m.bond("ps.port -> o.inlet", f"o.outlet -> {driven}", f"{open_one} -> t.port", "c.rod -> M")
    return m


@pytest.mark.parametrize(
    ("solver", "start", "inwards", "until"),
    [("auto", 0.15, False, 0.4), ("auto", 0.05, True, 0.3), ("radau", 0.03, True, 0.2)],
)
def test_a_cushioned_cylinder_at_its_end_comes_to_rest(solver, start, inwards, until) -> None:
    """Its last pressure runs out through the throttle, beside which the check valve is steeper."""
    m = cylinder(start, inwards)
    run = hb.simulate(m, until=until, solver=solver, max_steps=2000)
    rests = run["c.pressure_a" if inwards else "c.pressure_b"].at(until)
    holds = run["c.pressure_b" if inwards else "c.pressure_a"].at(until)
    # tolerances are parts of what is stored, and a part of 1e-8 of a chamber is 14 Pa
    assert abs(rests) < 30.0
    assert holds == pytest.approx(60e5, rel=1e-5)
    assert run["c.position"].at(until) == pytest.approx(0.0 if inwards else 0.3, abs=1e-9)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("rooms", "narrow", "wide", "bars", "until"),
    [
        ((1.2e-4, 2.8e-4, 1.1e-5), 1.4e-8, 5.2e-7, (19, 2, 19), 9.6),
        ((1.2e-4, 8.7e-6, 2.3e-6), 9.3e-8, 6.2e-6, (3, 15, 14), 0.28),
    ],
)
def test_vessels_level_out_through_throttles_that_are_wider_one_way(
    rooms, narrow, wide, bars, until, turned
) -> None:
    """Both throttles come to rest at their kinks; the mean of what the vessels hold stays."""
    m = hb.Model("vessels", domain="hydraulic", parameters={"k1": narrow, "k2": wide})
    law = "0.0336*(k1*max(e, 0) + k2*min(e, 0))/(e^2 + 1e6)^(1/4)"
    for k, (room, bar) in enumerate(zip(rooms, bars, strict=True)):
        m.add({f"n{k}": hb.Zero(), f"c{k}": hb.C(room / BULK, e=1e5 * bar)})
        m.bond(f"c{k} -> n{k}" if turned else f"n{k} -> c{k}")
        if k:
            m.add({f"d{k}": hb.One(), f"r{k}": hb.R({"f": law})})
            m.bond(f"n{k - 1} -> d{k} -> n{k}", f"d{k} -> r{k}")
    run = hb.simulate(m, until=until, max_steps=2000)
    mean = 1e5 * float(np.dot(rooms, bars)) / sum(rooms)
    assert [run[f"c{k}.e"].at(until) for k in range(3)] == pytest.approx([mean] * 3, rel=1e-8)


LAWS = {
    "a check valve beside": f"max(X, 0) + {STEEP}*min(X, 0)",
    "two laws": f"if X > 0 then X else {STEEP}*X",
    "a size": f"{0.5 * (STEEP + 1)}*X - {0.5 * (STEEP - 1)}*abs(X)",
}


def levelling(storage: str, law: str, turned: bool, other_side: bool) -> hb.Model:
    """Storages of 1 and 2 that level out, from 2 and 1, through what is gentle that way only."""
    m = hb.Model("two that level out")
    kind, read, gives = (hb.C, "e", "f") if storage == "C" else (hb.I, "f", "e")
    # the flow of an I that gives power is that of its bond turned round
    mirrored = other_side != (turned and storage == "I")
    given = LAWS[law].replace("X", f"(-{read})" if mirrored else read)
    first, second = (1, 2) if other_side else (2, 1)
    m.add(s0=kind(1.0, **{read: first}), s1=kind(2.0, **{read: second}))
    m.add(r=hb.R({gives: f"-({given})" if mirrored else given}))
    common, apart = (hb.Zero, hb.One) if storage == "C" else (hb.One, hb.Zero)
    m.add(n0=common(), n1=common(), d=apart())
    m.bond("n0 -> d -> n1", "d -> r")
    m.bond(*(("s0 -> n0", "s1 -> n1") if turned else ("n0 -> s0", "n1 -> s1")))
    return m


@pytest.mark.parametrize(("turned", "other_side"), [(False, False), (True, False), (False, True)])
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("storage", ["C", "I"])
def test_what_levels_out_beside_a_steeper_side_keeps_its_digits(
    storage, law, turned, other_side
) -> None:
    """The difference dies out with 1 + 1/2 a second; it was off by 1e-4, status ok."""
    m = levelling(storage, law, turned, other_side)
    run = hb.simulate(m, until=20, solver="radau", max_steps=600)
    total, sign = (5.0, -1.0) if other_side else (4.0, 1.0)
    for t in (1.0, 5.0, 12.0, 20.0):
        first = (total + 2.0 * sign * math.exp(-1.5 * t)) / 3.0
        read = float(run[f"s0.{'q' if storage == 'C' else 'p'}"].at(t))
        assert read == pytest.approx(first, rel=2e-7)


@pytest.mark.parametrize("solver", ["radau", "auto"])
@pytest.mark.parametrize("down", [False, True])
def test_a_motion_that_goes_through_a_kink_is_followed_on_both_sides(solver, down) -> None:
    """From 0 by a flow of 1.5 through the slope 1, behind 1 at once to rest by the steep one."""
    m = hb.Model("through a kink")
    law = f"e + {STEEP}*max(e - 1, 0)"
    law = f"e + {STEEP}*min(e + 1, 0)" if down else law
    m.add(c=hb.C(1.0), r=hb.R({"f": law}), s=hb.Sf(-1.5 if down else 1.5), n=hb.Zero())
    m.bond("s -> n -> c", "n -> r")
    run = hb.simulate(m, until=3, solver=solver, max_steps=600)
    sign = -1.0 if down else 1.0
    assert float(run["c.e"].at(1.0)) == pytest.approx(sign * 1.5 * (1 - math.exp(-1)), rel=1e-7)
    assert float(run["c.e"].at(1.2)) == pytest.approx(sign * (1 + 0.5 / (1 + STEEP)), rel=1e-8)
    assert float(run["c.e"].at(3.0)) == pytest.approx(sign * (1 + 0.5 / (1 + STEEP)), rel=1e-8)


def test_what_follows_a_level_that_nears_a_kink_is_not_led_beyond_by_its_stages() -> None:
    """A small vessel, of which what was foreseen is beyond the kink: steps stayed that short."""
    m = hb.Model("a small vessel at a level that nears")
    m.add(S=hb.Se("1 + exp(-time/1[s])"), T=hb.Se(1), a=hb.One(), n=hb.Zero(), b=hb.One())
    m.add(c=hb.C(1e-4, e=2.0), r=hb.R(1.0), v=hb.R({"f": "100*max(e - 0.3, 0) + min(e, 0)"}))
    m.bond("S -> a -> n -> c", "a -> r", "n -> b -> T", "b -> v")
    run = hb.simulate(m, until=25, solver="radau", max_steps=600)
    # behind the source by the time of the vessel
    assert float(run["c.e"].at(5)) == pytest.approx(1 + math.exp(-5) / (1 - 1e-4), rel=1e-7)
    assert float(run["c.e"].at(25)) == pytest.approx(1.0, rel=1e-7)
