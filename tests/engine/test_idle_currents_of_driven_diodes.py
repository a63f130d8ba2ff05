"""A diode that charges stiff storages carries next to nothing, and is asked by what drives it.

What it carries dies away in nanoseconds to the current at which the storages follow the source,
which is less than rounding. Rounding that dies away must not block it: its own rate is large.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import hybond as hb

SLOPE, LEVER = 213.0 / 1.1, 885.0
TABLE = {
    "e": {
        "table": [[-2.2, -1.1, 0.0, 1.1, 3.3], [-639.0, -213.0, 0.0, 213.0, 319.5]],
        "extrapolate": "linear",
    }
}
UNTIL = 0.0112
Build = Callable[[float, str, float], tuple[hb.Model, dict[str, float]]]


def driven(start: float, rise: str) -> hb.Model:
    """A source that charges a large storage, which is charged already, through a diode."""
    m = hb.Model("driven")
    m.add(s=hb.Se(rise), d=hb.One(law="diode"), r=hb.R(1.0), big=hb.C(TABLE, q=start))
    m.add(t=hb.TF(LEVER), j=hb.Zero())
    m.bond("s -> d", "d -> r", "d -> big")
    return m


def parted(start: float, rise: str, capacity: float) -> tuple[hb.Model, dict[str, float]]:
    """Two storages side by side; return what each holds beside 1 V of the source less of `big`."""
    m = driven(start, rise)
    m.add(one=hb.C(capacity, q=0.0), two=hb.C(2.0 * capacity, q=0.0))
    m.bond("d -> t -> j", "j -> one", "j -> two")
    stiff = LEVER**2 / (3.0 * capacity)
    passed = 1.0 / (stiff + SLOPE)
    return m, {"big.q": passed, "one.q": LEVER * passed / 3.0, "two.q": 2.0 * LEVER * passed / 3.0}


def bridged(start: float, rise: str, capacity: float) -> tuple[hb.Model, dict[str, float]]:
    """One storage in a row with two that are side by side."""
    m = driven(start, rise)
    third = 0.04
    m.add(n=hb.One(), one=hb.C(2.0 * capacity, q=0.0), two=hb.C(2.0 * capacity), rest=hb.C(third))
    m.bond("d -> t -> n", "n -> one", "n -> j", "j -> two", "j -> rest")
    both = 2.0 * capacity + third
    stiff = LEVER**2 * (1.0 / (2.0 * capacity) + 1.0 / both)
    passed = 1.0 / (stiff + SLOPE)
    moved = LEVER * passed
    held = {"big.q": passed, "one.q": moved, "two.q": 2.0 * capacity * moved / both}
    return m, held | {"rest.q": third * moved / both}


CASES = [
    (parted, -0.597, 0.0622, 0.019, 0.0124),
    (parted, -0.7, 0.209, 0.0382, 0.0259),
    (bridged, -0.874, 0.152, 0.0271, 0.0159),
    (bridged, -0.489, 0.269, 0.0327, 0.0203),
    (bridged, -0.709, 0.272, 0.0346, 0.0169),
    (bridged, -0.439, 0.0883, 0.0451, 0.0173),
]


@pytest.mark.parametrize(("kind", "start", "height", "rate", "capacity"), CASES)
def test_storages_follow_a_source_through_a_diode(
    kind: Build, start: float, height: float, rate: float, capacity: float
) -> None:
    """``s - e(big) = K Q``: what has passed by is what stands against the source."""
    m, holds = kind(start, f"{height}*sin({rate}*time)", capacity)
    run = hb.simulate(m, UNTIL, max_steps=5000)
    for t in np.array([0.3, 0.61, 1.0]) * UNTIL:
        drop = height * np.sin(rate * t) - SLOPE * start
        for name, part in holds.items():
            begun = start if name == "big.q" else 0.0
            assert run[name].at(t) == pytest.approx(begun + part * drop, rel=1e-6)


@pytest.mark.parametrize("order", [["c", "b", "a"], ["b", "a", "c"]])
def test_order_of_storages_that_follow_does_not_matter(order: list[str]) -> None:
    """The same, with what is declared in another order."""
    m = hb.Model("ordered")
    parts = {
        "a": {"big": hb.C(TABLE, q=-0.607), "t": hb.TF(LEVER), "one": hb.C(0.0392)},
        "b": {"rest": hb.C(0.04), "d": hb.One(law="diode"), "j": hb.Zero()},
        "c": {"r": hb.R(1.0), "n": hb.One(), "s": hb.Se("0.396*sin(0.0289*time)")},
    }
    for part in order:
        m.add(**parts[part])
    m.add(two=hb.C(0.0392))
    m.bond("j -> two", "j -> rest", "n -> j", "d -> t -> n", "n -> one", "d -> r", "s -> d")
    m.bond("d -> big")
    run = hb.simulate(m, UNTIL, max_steps=5000)
    _, holds = bridged(-0.607, "0", 0.0196)
    drop = 0.396 * np.sin(0.0289 * UNTIL) + SLOPE * 0.607
    for name in ("one.q", "two.q", "rest.q"):
        assert run[name].at(UNTIL) == pytest.approx(holds[name] * drop, rel=1e-6)
