"""What begins level stays so, and its audit does not hold rounding against it."""

from __future__ import annotations

import pytest

import hybond as hb

LADDERS = [
    ("1 V", "42.2 ohm", "0.76 F", "0.1 ohm", "0.0553 F"),
    ("1.02 V", "0.354 ohm", "0.0166 F", "0.782 ohm", "0.163 F"),
    ("1.67 V", "29 ohm", "2.62 F", "0.148 ohm", "2.59 F"),
    ("0.0272 V", "1.11 ohm", "5.37 F", "0.415 ohm", "0.014 F"),
    ("1 V", "0.114 ohm", "0.219 F", "0.554 ohm", "0.265 F"),
]


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("parts", LADDERS)
def test_ladders_that_begin_level_are_sound(parts: tuple[str, ...], turned: bool) -> None:
    v, r0, c0, r1, c1 = parts
    m = hb.Model("level", domain="electrical")
    m.add(S=hb.Se(f"-{v}" if turned else v), R0=hb.R(r0), C0=hb.C(c0, e=v), i=hb.One())
    m.add(a=hb.Zero(), R1=hb.R(r1), C1=hb.C(c1, e=v), j=hb.One(), b=hb.Zero())
    m.bond("i -> S" if turned else "S -> i", "i -> R0", "i -> a -> C0", "a -> j -> R1")
    m.bond("j -> b -> C1")
    run = hb.simulate(m, until="1 s")
    assert run.status == "ok"
    assert run["C1.e"].at([0.5, 1]) == pytest.approx(float(v.split()[0]), rel=1e-14)
