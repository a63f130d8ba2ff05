"""Friction that an impulse tears loose: it slides on from there, whichever law is named first.

A slipping coupling and a relay stand between a drive and a mass. The coupling holds more at rest
than it slides with, so the speed of the drive falls at once, and takes that of the mass along.
Oracles: closed forms.
"""

from __future__ import annotations

import itertools
import math

import pytest

import hybond as hb

HOLDS, SLIDES = 1.1895, 0.793
Parts = dict[str, object]


def coupled(parts: Parts, bonds: list[str], laws: tuple[str, ...]) -> list[hb.Model]:
    """The model with its laws named in each order."""
    made = []
    for order in itertools.permutations(laws):
        names = dict(zip(laws, order, strict=True))
        m = hb.Model("coupled")
        m.add(**{names.get(name, name): part for name, part in parts.items()})
        for chain in bonds:
            m.bond(" -> ".join(names.get(n, n) for n in chain.split(" -> ")))
        made.append(m)
    return made


def drive(slack: float, resistance: float, *, dual: bool) -> list[hb.Model]:
    """A unit effort drives a mass of 0.5 through a relay; a coupling limits the flow."""
    node, line = (hb.One, hb.Zero) if dual else (hb.Zero, hb.One)
    store, source = (hb.C, hb.Sf) if dual else (hb.I, hb.Se)
    way = "e" if dual else "f"
    y = "f" if dual else "e"
    parts: Parts = {
        "j": line(),
        "xa": node(law="coulomb", limit=SLIDES, breakaway=HOLDS),
        "xb": node(law="relay", limit=slack),
        "i": store(0.5),
        "s": source(1.0),
    }
    bonds = ["s -> j", "j -> xa", "j -> xb", "xb -> i"]
    if resistance > 0.0:
        parts["r"] = hb.R({y: f"{resistance}*{way}"})
        bonds.append("j -> r")
    return coupled(parts, bonds, ("xa", "xb"))


@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize(("slack", "resistance"), [(0.00296, 0.0), (0.1, 0.0), (0.00296, 0.3)])
def test_a_coupling_that_breaks_loose_slides_in_every_order(
    slack: float, resistance: float, dual: bool
) -> None:
    """The flow of the mass lags by the slack while it grows, and leads by it after the impulse.

    ``p' = 1 - r (p/m + slack)`` until ``p/m + slack`` is what the coupling holds; from then on the
    flow is what it slides with, and nothing drives the mass.
    """
    for m in drive(slack, resistance, dual=dual):
        run = hb.simulate(m, 1.5)
        p = run["i.q" if dual else "i.p"]
        rate = resistance / 0.5
        push = 1.0 - resistance * slack

        top = 0.5 * (HOLDS - slack)
        t = top / push if rate == 0.0 else -math.log(1.0 - rate * top / push) / rate
        grown = 0.9 * top if rate == 0.0 else push * (1.0 - math.exp(-rate * 0.9 * t)) / rate
        assert p.at(0.9 * t) == pytest.approx(grown, rel=1e-7)
        for after in (1.001 * t, 1.45):
            assert p.at(after) == pytest.approx(0.5 * (SLIDES + slack), rel=1e-9)


@pytest.mark.parametrize("law", ["diode", "unilateral"])
def test_behind_a_one_way_clutch_the_mass_runs_on_when_the_coupling_breaks_loose(law: str) -> None:
    """It has what the coupling held, and keeps that while the drive falls back."""
    parts: Parts = {
        "j": hb.One(),
        "xa": hb.Zero(law="coulomb", limit=SLIDES, breakaway=HOLDS),
        "xb": hb.Zero(law=law),
        "i": hb.I(0.5),
        "s": hb.Se(1.0),
    }
    for m in coupled(parts, ["s -> j", "j -> xa", "j -> xb", "xb -> i"], ("xa", "xb")):
        run = hb.simulate(m, 1.5)
        for t in (0.4, 0.7, 1.4):
            assert run["i.p"].at(t) == pytest.approx(min(t, 0.5 * HOLDS), rel=1e-9)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("slides", "holds", "relay"), [(0.5, 0.75, 1.46), (0.9, 0.95, 0.2)])
def test_a_coupling_in_line_with_a_relay_breaks_loose_in_every_order(
    slides: float, holds: float, relay: float, turned: bool
) -> None:
    """A charged capacitor drives a mass until its flow is what both of them bear together.

    ``p = sin(w t) q/w`` until then; it falls to what they bear in motion, and stays there. The
    relay is at a node, or at a line behind a gyrator.
    """
    parts: Parts = {
        "n": hb.One(),
        "xa": hb.Zero(law="coulomb", limit=slides, breakaway=holds),
        "i": hb.I(1.0),
        "c": hb.C(0.25, q=2.5),
    }
    bonds = ["c -> n", "n -> i", "xa -> n"]
    if turned:
        parts |= {"k": hb.Zero(), "g": hb.GY(1.0), "xb": hb.One(law="relay", limit=relay)}
        bonds += ["g.2 -> k", "g.1 -> xb", "k -> xa"]
    else:
        parts["xb"] = hb.Zero(law="relay", limit=relay)
        bonds.append("xb -> xa")
    t = math.asin((holds + relay) / 5.0) / 2.0
    left = 2.5 * math.cos(2.0 * t)
    for m in coupled(parts, bonds, ("xa", "xb")):
        run = hb.simulate(m, 1.0)
        assert run["i.p"].at(0.5 * t) == pytest.approx(5.0 * math.sin(t), rel=1e-7)
        for after in (1.001 * t, 0.9):
            flow = slides + relay
            assert run["i.p"].at(after) == pytest.approx(flow, rel=1e-9)
            assert run["c.q"].at(after) == pytest.approx(left - flow * (after - t), rel=1e-7)
