"""What a law gives to the graph around it is found by differences: rounding is none of them.

Where sources follow what is stored, or resistors are bent. A law that would move what is stored by
``1e-16`` of what it gives would have an answer of ``1e21``. Oracles: a closed form; what a source
that must flow says of a diode that must block; the same outcome in all orders.
"""

from __future__ import annotations

import math

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
