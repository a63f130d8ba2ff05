"""Guards that are not sampled because they are far, or still: none that comes to hold is missed."""

from __future__ import annotations

import math

import pytest

import hybond as hb
from hybond.engine.engine import Engine
from hybond.engine.guards import in_blocks
from hybond.engine.guards.locator import Locator, is_sampled

PEAK, FREQUENCY = 100.0, 50.0


def peak_rectifier(volt: float, idle: int = 0) -> hb.Model:
    """Return a capacitor charged through an ideal diode; behind it are others, never reached."""
    m = hb.Model("peak", domain="electrical")
    m.add(V=hb.Se(f"{PEAK}*sin({2.0 * math.pi * FREQUENCY}*time)"), d=hb.One(law="diode"))
    m.add(n=hb.Zero(), C=hb.C("1 uF", e=volt))
    m.bond("V -> d -> n -> C")
    for k in range(idle):
        m.add(**{f"d{k}": hb.One(law="diode"), f"n{k}": hb.Zero(), f"C{k}": hb.C("1 uF", e=500.0)})
        m.bond(f"n -> d{k} -> n{k} -> C{k}")
    return m


@pytest.mark.parametrize("idle", [0, 20])
@pytest.mark.parametrize("volt", [3.0, 50.0, 99.0, 99.99, 99.99999])
def test_a_source_that_just_reaches_a_level_is_seen(volt: float, idle: int) -> None:
    run = hb.simulate(peak_rectifier(volt, idle), until="30 ms")
    found = [e.t for e in run.events if e.cause != "start"]
    # on where the sine has come to the level, but for rounding of the 22.4 kV that all energy would
    # lift the capacitor to; off at its peak; a period later it only touches
    risen = PEAK * math.sin(2.0 * math.pi * FREQUENCY * found[0])
    assert found[0] < 0.25 / FREQUENCY
    assert risen == pytest.approx(volt, abs=22.5e3 * 1e-13)
    assert found[1] == pytest.approx(0.25 / FREQUENCY, abs=2e-10)
    assert run.final["C.e"] == pytest.approx(PEAK, rel=1e-9)


@pytest.mark.parametrize("volt", [100.00001, 101.0, 400.0])
def test_a_source_that_stays_below_a_level_is_none(volt: float) -> None:
    run = hb.simulate(peak_rectifier(volt, 20), until="30 ms")
    assert [e for e in run.events if e.cause != "start"] == []
    assert run.final["C.e"] == volt


def test_a_level_that_is_reached_late_is_seen_after_steps_without_a_look() -> None:
    # 1 mA into 1 mF lifts 1 V in a second; beside it a sine keeps steps short
    m = hb.Model("late", domain="electrical")
    m.add(I=hb.Sf(1e-3), n=hb.Zero(), C=hb.C("1 mF"), d=hb.One(law="diode"), V=hb.Se(-7.0))
    m.add(W=hb.Se("1e-3*sin(1000*time)"), s=hb.One(), r=hb.R("1 kohm"))
    m.bond("I -> n -> C", "n -> d", "V -> d", "W -> s -> r")
    run = hb.simulate(m, until="10 s")
    found = [e.t for e in run.events if e.cause == "guard"]
    # where rounding of all that is stored by then lets it hold
    assert found == [pytest.approx(7.0, rel=2e-12)]


def ladder(diodes: int, turned: bool = False, volt: float = 0.0) -> hb.Model:
    """Return a ladder of diodes and capacitors on a sine; the capacitor of the fifth holds `volt`.

    The bonds of half of the capacitors are turned, or those of the other half.
    """
    m = hb.Model("ladder", domain="electrical")
    m.add(V=hb.Se(f"{PEAK}*sin({2.0 * math.pi * FREQUENCY}*time)"), n0=hb.Zero())
    m.bond("V -> n0")
    for k in range(1, diodes + 1):
        m.add(**{f"n{k}": hb.Zero(), f"d{k}": hb.One(law="diode"), f"c{k}": hb.One()})
        m.bond(f"n{k - 1} -> d{k} -> n{k}" if k > 1 else "d1 -> n1")
        below = "n0" if k == 1 else f"n{k - 2}"
        away = (k % 2 == 1) == turned and k != 2
        m.add(**{f"C{k}": hb.C("1 uF", e=(-volt if away else volt) if k == 5 else 0.0)})
        chain = [below, f"c{k}", f"n{k}"] if away else [f"n{k}", f"c{k}", below]
        m.bond(" -> ".join(chain[:2] if k == 2 else chain), f"c{k} -> C{k}")
    return m


def pumped(volt: float, turned: bool) -> hb.Model:
    """Return one of six diodes; 1 mA takes 1 V/ms from the capacitor that holds something.

    While the source rises it charges the first two, together; no diode behind sees that.
    """
    m = ladder(6, turned, volt)
    m.add(p=hb.One(), I=hb.Sf("1 mA"))
    # out of the capacitor's upper end, into its lower one
    m.bond("n5 -> p -> n3", "p -> I")
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("volt", [1.0, 3.0, 4.5])
def test_a_diode_opens_whose_sides_a_rising_source_moves_alike(volt: float, turned: bool) -> None:
    # a third of what it holds is left against the next diode at once; 1 mA takes that in v/3 ms
    run = hb.simulate(pumped(volt, turned), until=f"{volt / 3.0 + 0.1} ms")
    last = run.events[-1]
    fired = [f.machine for step in last.steps for f in step.fired]
    assert fired == ["d5"]
    assert last.t == pytest.approx(1e-3 * volt / 3.0, abs=22.5e3 * 1e-13 * 1e-3)


@pytest.mark.parametrize("diodes", [6, 12])
def test_diodes_that_a_ladder_has_not_reached_are_not_sampled(
    diodes: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    # what is put back on constraints moves both sides of each of them alike
    sampled = []
    sample = in_blocks.sample

    def counted(e: Engine, g: Locator) -> None:
        sampled.append(sum(1 for k in range(g.guards) if is_sampled(g, k)))
        sample(e, g)

    monkeypatch.setattr(in_blocks, "sample", counted)
    run = hb.simulate(ladder(diodes), until="24 ms", engine="python")
    assert len(run.events) == 5
    # some four of them work by then, however many are behind
    assert 0 < max(sampled) <= 4
