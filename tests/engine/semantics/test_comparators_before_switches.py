"""Comparators without hysteresis that drive switches: what follows them slides with them."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import pytest

import hybond as hb

V, VS, RS, C, R = 12.0, 5.0, 10.0, 47e-6, 50.0
PART = (VS / R) / ((V - VS) / RS)
"""The part of the time in which the switch of the charger holds 5 V."""


def charger(turned: tuple[bool, ...] = (False,) * 3, gates: int = 1) -> hb.Model:
    """Return a comparator, so many gates that each say what the last does, and a switch."""
    m = hb.Model("charger", domain="electrical")
    m.add(V=hb.Se(-V if turned[0] != turned[1] else V), s=hb.One(), R=hb.R(RS), n=hb.Zero())
    m.add(c=hb.C(C), load=hb.R(R))
    ends = [("V", "s"), ("s", "n"), ("n", "c")]
    m.bond(*(f"{b} -> {a}" if t else f"{a} -> {b}" for (a, b), t in zip(ends, turned, strict=True)))
    m.bond("s -> R", "n -> load")
    rules = [f"no -> yes when n.e < {VS}", f"yes -> no when n.e > {VS}"]
    m.machine("k0", states={"no": [], "yes": []}, start="no", rules=rules)
    for k in range(1, gates):
        before = f'k{k - 1}.state == "yes"'
        rules = [f"no -> yes when {before}", f"yes -> no when not ({before})"]
        m.machine(f"k{k}", states={"no": [], "yes": []}, start="no", rules=rules)
    m.signal(g=f'if k{gates - 1}.state == "yes" then 5 else 0')
    rules = ["open -> closed when g > 2.5", "closed -> open when g < 2.5"]
    m.machine("S", states={"open": [], "closed": ["s"]}, start="open", rules=rules)
    return m


@pytest.mark.parametrize("gates", [1, 2, 4])
@pytest.mark.parametrize("turned", list(product([False, True], repeat=3)))
def test_a_switch_behind_a_comparator_slides_with_it(turned: tuple[bool, ...], gates: int) -> None:
    run = hb.simulate(charger(turned, gates), "3 ms")
    assert (run.status, len(run.events)) == ("ok", 2)
    assert float(run["n.e"].at(2e-3)) == pytest.approx(VS, abs=1e-9)
    for machine, state in (("k0", "yes"), ("S", "closed")):
        assert run.weight(machine, state, 2e-3) == pytest.approx(PART, rel=1e-9)
    assert (-1.0 if turned[1] else 1.0) * float(run["R.f"].at(2e-3)) == pytest.approx(
        VS / R, rel=1e-9
    )
    assert run.audit().holds()


def deck(tmp_path: Path, *cards: str) -> hb.Model:
    text = "\n".join(["deck", *cards, ".model SWI SW(VT=2.5 RON=0.05 ROFF=1e9)", ".end", ""])
    (tmp_path / "deck.cir").write_text(text)
    return hb.read_circuit(tmp_path / "deck.cir").model


BUCK = ("V1 in 0 12", "S1 in sw g 0 SWI", "S2 sw 0 h 0 SWI", "L1 sw o 100u", "Rs o x 0.1")
BUCK += ("R1 x 0 2", ".tran 0.1u 1m uic")


@pytest.mark.parametrize(
    "gates",
    [
        ("Bg g 0 V=if(v(o,x)<0.2,5,0)", "Bh h 0 V=5-v(g)"),
        ("Bg g 0 V=if(v(o,x)<0.2,5,0)", "Bh h 0 V=if(v(o,x)<0.2,0,5)"),
        ("Bg g 0 V=5*u(0.2-v(o,x))", "Bh h 0 V=5*u(v(o,x)-0.2)"),
    ],
)
def test_a_leg_of_two_switches_slides_as_one(tmp_path: Path, gates: tuple[str, ...]) -> None:
    run = hb.simulate(deck(tmp_path, *BUCK, *gates))
    assert (run.status, run.warnings) == ("ok", ())
    assert len(run.events) == 2
    assert float(run["L1.f"].at(8e-4)) == pytest.approx(2.0, rel=1e-9)
    # 12 V for a part of the time hold 4.2 V at the coil, and 2 A through 50 mohm all the time
    for switch, part in (("S1_state", 4.3 / 12.0), ("S2_state", 1.0 - 4.3 / 12.0)):
        assert run.weight(switch, "closed", 8e-4) == pytest.approx(part, rel=1e-8)


def test_a_switch_and_one_turned_round_at_one_threshold_slide_as_one(tmp_path: Path) -> None:
    cards = ("V1 in 0 12", "S1 in sw r s SW0", "S2 sw 0 s r SW0", "L1 sw o 100u", "R1 o y 2")
    cards += ("VRs y 0 0", "Hs s 0 VRs 1", "Vr r 0 2", ".tran 0.1u 1m uic")
    run = hb.simulate(deck(tmp_path, *cards, ".model SW0 SW(VT=0 RON=0.05 ROFF=1e9)"))
    assert (run.status, len(run.events)) == ("ok", 2)
    assert run.weight("S1_state", "closed", 8e-4) == pytest.approx(4.1 / 12.0, rel=1e-8)


@pytest.mark.parametrize("off", [2e-3, 2.5e-3])
def test_a_gate_that_is_cut_off_ends_the_sliding_of_its_comparator(
    tmp_path: Path, off: float
) -> None:
    cards = (f"V1 in 0 {V}", "S1 in a g 0 SWI", f"R0 a out {RS - 0.05}", f"C1 out 0 {C}")
    cards += (f"R1 out 0 {R}", f"Ven en 0 PWL(0 5 {off} 5 {off + 1e-9} 0)")
    cards += ("Bg g 0 V=if(v(out)<5 & v(en)>2.5,5,0)", ".tran 0.1u 4m uic")
    run = hb.simulate(deck(tmp_path, *cards))
    assert run.status == "ok"
    # nothing holds 5 V any more: it falls through the load
    fallen = VS * 2.718281828459045 ** (-(4e-3 - off - 0.5e-9) / (R * C))
    assert float(run["out.e"].at(4e-3)) == pytest.approx(fallen, rel=1e-8)


def test_a_comparator_takes_its_switch_along_where_a_load_ends_its_sliding(tmp_path: Path) -> None:
    cards = (f"V1 in 0 {V}", "S1 in a g 0 SWI", f"R0 a out {RS - 0.05}", f"C1 out 0 {C}")
    cards += (f"R1 out 0 {R}", "S2 out r2 k 0 SWI", "R2 r2 0 5", "Bg g 0 V=5*u(5-v(out))")
    cards += ("Vk k 0 PWL(0 0 1m 0 1.000001m 5)", ".tran 0.1u 6m uic")
    run = hb.simulate(deck(tmp_path, *cards))
    assert run.status == "ok"
    assert run.mode["S1_state"] == "closed"
    loads = 1.0 / R + 1.0 / 5.05
    assert float(run["out.e"].at(6e-3)) == pytest.approx(V / RS / (1.0 / RS + loads), rel=1e-6)


def test_a_surface_that_turns_into_one_that_no_switch_moves_is_left() -> None:
    m = hb.Model("turns")
    m.add(x1=hb.C(1.0, q=-1.0), s1=hb.Sf('if r.state == "up" then 1 else -1'), n1=hb.Zero())
    m.add(x2=hb.C(1.0, q=-1.0), s2=hb.Sf(0.5), n2=hb.Zero())
    m.bond("s1 -> n1 -> x1", "s2 -> n2 -> x2")
    rules = ["up -> down when max(x1.q, x2.q) > 0", "down -> up when max(x1.q, x2.q) < 0"]
    m.machine("r", states={"up": [], "down": []}, start="up", rules=rules)
    run = hb.simulate(m, "3 s")
    # x1 is held at 0 from 1 s on, until x2 arrives there at 2 s
    assert (run.status, len(run.events)) == ("ok", 3)
    assert run.events[2].t == pytest.approx(2.0, abs=1e-7)
    assert float(run["x1.q"].at(3.0)) == pytest.approx(-1.0, abs=1e-7)


def test_a_clock_cuts_a_comparator_off_again_and_again(tmp_path: Path) -> None:
    cards = (f"V1 in 0 {V}", "S1 in a g 0 SWI", f"R0 a out {RS - 0.05}", f"C1 out 0 {C}")
    cards += (f"R1 out 0 {R}", "Vc c 0 PULSE(0 5 1m 10n 10n 0.5m 1m)")
    cards += ("Bg g 0 V=if(v(out)<5,1,0)*v(c)", ".tran 0.1u 3.2m uic")
    run = hb.simulate(deck(tmp_path, *cards))
    assert run.status == "ok"
    # held at 5 V while the clock is up, from 2 to 2.5 ms, then it falls through the load
    assert run.weight("S1_state", "closed", 2.45e-3) == pytest.approx(PART, rel=1e-9)
    fallen = VS * 2.718281828459045 ** (-(0.3e-3 - 15e-9) / (R * C))
    assert float(run["out.e"].at(2.8e-3)) == pytest.approx(fallen, rel=1e-7)
    assert run.weight("S1_state", "closed", 2.8e-3) == 0.0


@pytest.mark.parametrize(
    "cards",
    [
        ("S1 in a h 0 SW1", "Bg g 0 V=if(v(out)<5,5,0)", "Ra g h 1k", "Rb h 0 1k"),
        ("S1 in a k 0 SW1", "Bg g 0 V=if(v(out)<5,5,0)", "Ra g h 1k", "Rb h 0 1k")
        + ("E1 j 0 h 0 2", "Rc j k 1k", "Rd k 0 1k"),
        ("S1 in a h 0 SWI", "V5 p 0 5", "Rp p h 1k", "S2 h 0 g 0 SWI", "Bg g 0 V=if(v(out)>5,5,0)"),
    ],
    ids=["a divider", "two dividers", "a pull-up"],
)
def test_a_switch_behind_a_resistor_behind_a_comparator_slides_with_it(
    tmp_path: Path, cards: tuple[str, ...]
) -> None:
    """What drives the switch is a voltage, 2.5 V or nothing, and never the average of them."""
    own = (f"V1 in 0 {V}", f"R0 a out {RS - 0.05}", f"C1 out 0 {C}", f"R1 out 0 {R}")
    run = hb.simulate(
        deck(
            tmp_path, *own, *cards, ".model SW1 SW(VT=1.25 RON=0.05 ROFF=1e9)", ".tran 0.1u 4m uic"
        )
    )
    assert (run.status, len(run.events), run.warnings) == ("ok", 2, ())
    assert float(run["out.e"].at(3e-3)) == pytest.approx(VS, abs=1e-9)
    assert run.weight("S1_state", "closed", 3e-3) == pytest.approx(PART, rel=1e-8)
    assert run.audit().holds()
