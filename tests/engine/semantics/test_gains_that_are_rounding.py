"""What a law gives to the graph around it is found by differences: rounding is none of them.

Where sources follow what is stored, or resistors are bent. A law that would move what is stored by
``1e-16`` of what it gives would have an answer of ``1e21``. Oracles: a closed form; what a source
that must flow says of a diode that must block; the same outcome in all orders.
"""

from __future__ import annotations

import math
from math import pi

import pytest
from in_orders import in_orders

import hybond as hb

Parts = dict[str, object]


def driven(law: str, flow: float, ratio: float, *, dual: bool = False) -> tuple[Parts, list[str]]:
    """A source that a coil follows drives another coil, beside a diode, through a gyrator.

    Both its flow and an effort beside it are modulated by the other coil's flux. Dual: capacitors.
    """
    one, two = (hb.One, hb.Zero) if dual else (hb.Zero, hb.One)
    store = hb.C if dual else hb.I
    effort, through = (hb.Sf, hb.Se) if dual else (hb.Se, hb.Sf)
    if dual:
        law = law.replace("i.p", "i.q")
    parts: Parts = {
        "n": one(),
        "k": two(),
        "j": two(),
        "d": one(law="diode"),
        "g": hb.GY(ratio),
        "i": store(1.0),
        "h": store(1.0),
        "s": effort(f"-1.18*({law})"),
        "u": through(f"{flow}*({law})"),
    }
    bonds = ["g.1 -> n", "i -> k", "j -> g.2", "n -> k", "j -> h", "j -> s", "j -> u", "n -> d"]
    return parts, bonds


@pytest.mark.parametrize(
    ("law", "ratio", "dual"),
    [
        ("1 - 0.5*tanh(i.p/0.0279)", 0.628, False),
        ("1 - 0.5*tanh(i.p/0.03)", 0.07, True),
        ("1 - i.p", 0.628, False),
    ],
)
def test_a_diode_has_to_block_what_a_source_drives_in_every_order(
    law: str, ratio: float, dual: bool
) -> None:
    """The gyrator makes of the flow an effort that the diode would have to bear, and cannot."""
    for m in in_orders(*driven(law, 0.468, ratio, dual=dual)):
        with pytest.raises(hb.HybondError) as refused:
            hb.simulate(m, 0.173)
        assert refused.value.code == "HB-J110"


@pytest.mark.parametrize("ratio", [0.628, 1.3])
def test_a_diode_lets_a_source_drive_the_other_way(ratio: float) -> None:
    """The diode bears an effort ``-0.468 r (1 - p)``, so that ``p = 1 - exp(0.468 r t)``."""
    for m in in_orders(*driven("1 - i.p", -0.468, ratio)):
        run = hb.simulate(m, 0.5)
        p = 1.0 - math.exp(0.468 * ratio * 0.4)
        assert run["i.p"].at(0.4) == pytest.approx(p, rel=1e-7)
        assert run["h.p"].at(0.4) == pytest.approx(-0.468 * (1.0 - p), rel=1e-7)


def brushless(size: float, *, turned: bool = False) -> hb.Model:
    """A motor with trapezoidal voltages, fed by three legs in six steps that its angle takes.

    Each leg has two switches and a diode beside each. `size` is that of voltages, those of currents
    and times follow.
    """
    volt, amp, s = size, size**0.7, size**-0.5
    l, r, k = 0.1 * volt * s / amp, 0.3 * volt / amp, 0.7 * volt * s
    m = hb.Model("brushless", domain="electrical")
    m.add(
        V=hb.Se(volt),
        rail=hb.Zero(),
        star=hb.Zero(),
        w=hb.One(domain="rotational"),
        J=hb.I(0.5 * volt * amp * s**3, domain="rotational"),
        drag=hb.R(0.15 * volt * amp * s**2, domain="rotational"),
    )
    m.bond("V -> rail", "w -> J", "drag -> w" if turned else "w -> drag")
    m.signal(th=hb.Integral("w.f", start=pi / 6 + 0.1))
    m.signal(step="floor(mod(th - pi/6, 2*pi)/(pi/3))")
    for i, q in enumerate("abc"):
        m.signal(**{f"s{q}": f"mod(th + {2 * (3 - i) % 6}*pi/3, 2*pi)"})
        falls = f"if s{q} < 7*pi/6 then (pi - s{q})*6/pi else "
        falls += f"(if s{q} < 11*pi/6 then -1 else (s{q} - 2*pi)*6/pi)"
        rises = f"if s{q} < pi/6 then s{q}*6/pi else (if s{q} < 5*pi/6 then 1 else ({falls}))"
        m.signal(**{f"t{q}": rises})
        names = {f"{part}{q}": hb.One() for part in "iul"}
        m.add(**names, **{f"n{q}": hb.Zero(), f"L{q}": hb.I(l), f"R{q}": hb.R(r)})
        m.add(**{f"g{q}": hb.GY(f"{k}*t{q}"), f"up{q}": hb.One(law="diode")})
        m.add(**{f"low{q}": hb.One(law="diode")})
        bonds = [f"rail -> u{q} -> n{q} -> l{q}", f"low{q} -> n{q} -> up{q} -> rail"]
        bonds += [f"n{q} -> i{q} -> star", f"i{q} -> g{q} -> w", f"i{q} -> L{q}"]
        bonds += [f"R{q} -> i{q}" if turned else f"i{q} -> R{q}"]
        m.bond(*(reversed(bonds) if turned else bonds))
    ways = ["ab", "ac", "bc", "ba", "ca", "cb"]
    m.machine(
        "six",
        states={f"s{i}": [f"u{way[0]}", f"l{way[1]}"] for i, way in enumerate(ways)},
        start="s0",
        rules=[
            f"s{i} -> s{(i + 1) % 6} when step > {(i + 1) % 6} - 0.5 and step < {(i + 1) % 6} + 0.5"
            for i in range(6)
        ],
    )
    return m


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("size", [0.0033, 1.0, 4e3, 1e-5])
@pytest.mark.parametrize("turns", [8.0, 9.5])
def test_what_one_law_was_given_leaves_no_gain_of_the_next(
    turns: float, size: float, turned: bool, solver: str
) -> None:
    """A leg that is let go has a diode that takes its current: nothing is lost, nothing jumps.

    A diode beside a closed switch moves no coil. Asked after another, with what Newton had found
    for that one to begin from, it seemed to, by rounding, and which diodes conduct was decided by
    how much it would have to carry.
    """
    m = brushless(size, turned=turned)
    coils = ["La.p", "Lb.p", "Lc.p"]
    run = hb.simulate(m, turns * size**-0.5, solver=solver)
    assert not [text for text in run.warnings if "answers" in text]
    assert len(run.events) > 10
    times = list(run.events.t)
    for coil in coils:
        before, after = run[coil].at(times, side="left"), run[coil].at(times)
        assert after == pytest.approx(before, abs=1e-9 * abs(after).max())
    # what the supply gave is stored, or gone in resistors
    assert run.audit().holds()
