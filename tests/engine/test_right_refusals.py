"""What has a solution is not refused; what is refused is so for the reason and at the time told."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from scipy.optimize import brentq

import hybond as hb

BENT = {"tanh({})": math.tanh, "max(-1, min(1, {}))": lambda x: max(-1.0, min(1.0, x))}


def node(law: str, aside: str) -> hb.Model:
    """Return 2 A into a resistor that takes 1 A at most, and a junction with a law beside it."""
    m = hb.Model("node")
    m.add(s=hb.Sf(2.0), n=hb.Zero(), flat=hb.R({"f": law.format("e")}))
    options = {"limit": 0.5} if aside in ("coulomb", "relay") else {}
    m.add(d=hb.One(law=aside, **options), load=hb.R(1.0))
    m.bond("s -> n", "n -> flat", "n -> d -> load")
    return m


def loop(law: str, aside: str) -> hb.Model:
    """Return 2 V over a resistor that holds 1 V at most, the dual of `node`."""
    m = hb.Model("loop")
    m.add(s=hb.Se(2.0), n=hb.One(), flat=hb.R({"e": law.format("f")}))
    options = {"limit": 0.5} if aside in ("coulomb", "relay") else {}
    m.add(d=hb.Zero(law=aside, **options), load=hb.R(1.0))
    m.bond("s -> n", "n -> flat", "n -> d -> load")
    return m


@pytest.mark.parametrize("make", [node, loop])
@pytest.mark.parametrize("law", BENT)
@pytest.mark.parametrize("aside", ["diode", "unilateral", "coulomb", "relay"])
def test_a_branch_without_values_is_left_for_one_that_has_some(
    make: object, law: str, aside: str
) -> None:
    # blocked or at rest, the junction leaves more to the resistor than that can take
    assert callable(make)
    run = hb.simulate(make(law, aside), until=0.1)
    limit = 0.5 if aside in ("coulomb", "relay") else 0.0
    f = brentq(lambda f: BENT[law](f + limit) + f - 2.0, 0.0, 3.0, xtol=1e-14)
    assert run["load.f"].at(0.05) == pytest.approx(f, rel=1e-9)
    assert run.audit().holds()


@pytest.mark.parametrize(("coil", "rebound"), [(0.3, None), (2.0, 0.0), (0.1, 0.5)])
def test_an_open_contact_beside_a_law_that_jumps_stays_open(
    coil: float, rebound: float | None
) -> None:
    # closed, the flow of the coil had no way but through what takes 0.04 at most
    m = hb.Model("open")
    options = {} if rebound is None else {"restitution": rebound}
    m.add(j=hb.Zero(law="unilateral", **options), g=hb.R({"f": "0.04*sign(e)"}))
    m.add(i=hb.I(coil, p=0.5))
    m.bond("j -> g", "j -> i")
    run = hb.simulate(m, until=1.0)
    assert run["i.p"].at(1.0) == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize(
    ("limited", "shut"),
    [
        ("7.24*max(-1, min(1, f/0.0578))", "if e > 0 then 0.004*e else 0"),
        ("9*tanh(f/0.05)", "max(0, e)/3"),
        ("6*max(-1, min(1, f/0.01))", "1e-3*(abs(e) + e)"),
        ("12*max(-1, min(1, 5*f))", "if e > 0 then e^2 else 0"),
    ],
)
@pytest.mark.parametrize("source", ["-5.36", "-5.36*(if time >= 0.46 then 1.1 else 1)"])
@pytest.mark.parametrize("last", ["s -> n", "n -> limited"])
def test_a_shut_valve_does_not_keep_its_neighbours_from_a_solution(
    limited: str, shut: str, source: str, last: str
) -> None:
    # what Newton begins with is beyond the limit of one law, where that is flat
    m = hb.Model("manifold")
    m.add(n=hb.Zero(), orifice=hb.R({"e": "19.6*sign(f)*sqrt(abs(f)/208)"}), line=hb.I(0.0414))
    m.add(valve=hb.R({"f": shut}), limited=hb.R({"e": limited}), s=hb.Se(source))
    bonds = ["n -> limited", "n -> orifice", "s -> n", "valve -> n", "n -> line"]
    m.bond(*[b for b in bonds if b != last], last)
    run = hb.simulate(m, until=1.0)
    assert run.status == "ok"
    e, p = (-5.36, -5.36) if source == "-5.36" else (-5.896, -5.36 * (0.46 + 1.1 * 0.54))
    assert run["line.p"].at(1.0) == pytest.approx(p, rel=1e-9)
    assert run["orifice.f"].at(1.0) == pytest.approx(-208 * (e / 19.6) ** 2, rel=1e-9)
    assert run["limited.e"].at(0.7) == pytest.approx(e, rel=1e-9)
    assert run.audit().holds()


def shorted(text: str) -> hb.Model:
    m = hb.Model("shorted")
    m.add(s=hb.Se(text), n=hb.Zero(), end=hb.One(), c=hb.C(1.0))
    m.bond("s -> n", "n -> end", "n -> c")
    return m


def cut(text: str) -> hb.Model:
    m = hb.Model("cut")
    m.add(s=hb.Sf(text), n=hb.One(), end=hb.Zero(), r=hb.R(2.0))
    m.bond("s -> n", "n -> end", "n -> r")
    return m


def turned(text: str) -> hb.Model:
    m = hb.Model("turned")
    m.add(s=hb.Sf(text), n=hb.One(), g=hb.GY(1.0), j=hb.Zero(), end=hb.One(), r=hb.R(2.0))
    m.bond("s -> n -> g -> j -> end", "n -> r")
    return m


@pytest.mark.parametrize("make", [shorted, cut, turned])
@pytest.mark.parametrize(("size", "pace"), [(3.0, 1.7), (-0.4, 20.0)])
def test_sources_that_part_are_told_with_the_time_at_which_they_differ(
    make: object, size: float, pace: float
) -> None:
    assert callable(make)
    with pytest.raises(hb.HybondError) as refusal:
        hb.simulate(make(f"{size}*sin({pace}*time)"), until=0.7)
    error = refusal.value
    assert error.code == "HB-C101"
    gives, t = map(float, re.findall(r"gives (\S+) there at t = (\S+) s", str(error))[0])
    assert abs(gives) == pytest.approx(abs(size * math.sin(pace * t)), rel=1e-4)
    assert t > 0.0
    way = "in series with s" if make is shorted else "beside s"
    assert error.hint == f"put a resistor {way}"


def test_switching_ever_faster_to_a_point_ends_there_with_a_remedy_that_helps() -> None:
    """Super-twisting: ``s' = -1.5 sqrt|s| sign s + w``, ``w' = -1.1 sign s``.

    Both are zero within a finite time (J. A. Moreno, M. Osorio, IEEE Trans. Autom. Control 57(4),
    2012). It has no size of its own but that s goes with the square of w: in a band b, s stays
    within some b, and w within some sqrt(b).
    """
    m = hb.Model("twisted")
    m.signal(
        s=hb.Integral('-1.5*sqrt(abs(s))*(if u.state == "p" then 1 else -1) + w', start=1.0),
        w=hb.Integral('if u.state == "p" then -1.1 else 1.1', start=0.0),
    )
    rules = ["p -> n when s < 0", "n -> p when s > 0"]
    m.machine("u", states={"p": [], "n": []}, start="p", rules=rules)
    ended = hb.simulate(m, until=3.0)
    assert ended.status == "accumulation" and "give them a hysteresis" in ended.warnings[0]
    assert abs(ended["s"].at(ended.t_end)) < 1e-12 and abs(ended["w"].at(ended.t_end)) < 1e-6
    run = hb.simulate(m, until=3.0, sliding="hysteresis", hysteresis=1e-6)
    late = np.linspace(ended.t_end + 0.05, 3.0, 50)
    assert run.status == "ok"
    assert np.abs(run["s"].at(late)).max() < 3e-6 and np.abs(run["w"].at(late)).max() < 3e-3
