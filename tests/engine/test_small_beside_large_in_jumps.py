"""A storage that holds next to nothing jumps to its own value, whatever large ones do beside it.

Ways to jump used to move a little of everything: what a large storage stores, less what it stores,
was left over for the small one, and its law was off by a tenth (HB-N411).
"""

import numpy as np
import pytest
from scipy.optimize import brentq

import hybond as hb

SMALL = [1e-3, 1e-6, 1e-9, 1e-12, 1e-15]


def of_cubic(e):
    """Return x of x + x^3 = e, by its own formula."""
    root = np.sqrt(e * e / 4.0 + 1.0 / 27.0)
    return np.cbrt(e / 2.0 + root) + np.cbrt(e / 2.0 - root)


def cubic(letter, width):
    return f"({letter}/{width!r}) + ({letter}/{width!r})^3"


@pytest.mark.parametrize("width", SMALL)
@pytest.mark.parametrize("turned", [False, True], ids=["", "turned"])
def test_beside_a_large_one_on_a_source(width, turned):
    m = hb.Model("two")
    m.add(s=hb.Se("-0.1258"), a=hb.Zero(), b=hb.Zero(), large=hb.C(0.7256, q=0.478))
    m.add(small=hb.C({"e": cubic("q", width)}, q=0.4 * width))
    m.bond("s -> a", "a -> b", "large -> b", "small -> a" if turned else "a -> small")
    run = hb.simulate(m, 1.0)
    # the arrow points out of it: its port has the same effort
    assert run["small.q"].at(0.0) == pytest.approx(width * of_cubic(-0.1258), rel=1e-13)
    assert run["large.q"].at(0.0) == pytest.approx(-0.1258 * 0.7256, rel=1e-13)


@pytest.mark.parametrize("width", SMALL)
def test_joined_to_a_large_one_by_a_switch(width):
    m = hb.Model("joined")
    m.add(a=hb.Zero(), b=hb.Zero(), i=hb.One(), large=hb.C(2.0, e=0.3))
    m.add(small=hb.C({"e": cubic("q", width)}, q=-width))
    m.bond("large -> a -> i -> b -> small")
    m.machine(
        "S",
        states={"open": [], "closed": ["i"]},
        start="open",
        rules=["open -> closed when time >= 0.5"],
    )
    run = hb.simulate(m, 1.0)
    # charge is kept: 2 e + w x(e) = 0.6 - w
    e = 0.3
    for _ in range(60):
        e = (0.6 - width - width * of_cubic(e)) / 2.0
    assert run["small.q"].at(1.0) == pytest.approx(width * of_cubic(e), rel=1e-12)
    assert run["small.q"].at(1.0) + run["large.q"].at(1.0) == pytest.approx(0.6 - width, rel=1e-15)


@pytest.mark.parametrize("width", SMALL)
def test_a_light_wheel_geared_to_a_heavy_one_that_is_caught(width):
    m = hb.Model("caught")
    m.add(
        w=hb.One(),
        heavy=hb.I(5.0, f=3.0),
        gear=hb.TF(0.25),
        u=hb.One(),
        drive=hb.Sf("2"),
        c=hb.One(),
    )
    m.add(light=hb.I({"f": cubic("p", width)}, p=0.1 * width))
    m.bond("w -> heavy", "w -> gear -> u -> light", "drive -> c -> w")
    run = hb.simulate(m, 1.0)
    assert run["heavy.p"].at(0.0) == pytest.approx(10.0, rel=1e-14)
    # f2 = m f1
    assert run["light.p"].at(0.0) == pytest.approx(width * of_cubic(0.5), rel=1e-13)


@pytest.mark.parametrize("width", SMALL)
def test_between_two_large_ones(width):
    """The small one takes what one of the large ones gives and the other does not."""
    m = hb.Model("between")
    m.add(left=hb.Se("1"), right=hb.Se("0.25"), i=hb.One(), k=hb.One(), n=hb.Zero())
    m.add(one=hb.C(3.0, q=1.0), two=hb.C(4.0, q=-2.0), small=hb.C({"e": cubic("q", width)}, q=0.0))
    m.bond("left -> i -> one", "i -> n -> k -> two", "k -> right", "n -> small")
    run = hb.simulate(m, 1.0)
    q = {name: run[f"{name}.q"].at(0.0) for name in ("one", "two", "small")}
    # what they were, less what goes through: dq1 = dq2 + dq, 1 = e1 + e, e = e2 + 0.25
    e = 0.5
    for _ in range(200):
        x = width * of_cubic(e)
        # 3 (1 - e) - 1 = 4 (e - 0.25) + 2 + x
        e = (3.0 - 1.0 + 1.0 - 2.0 - x) / 7.0
    assert q["small"] == pytest.approx(width * of_cubic(e), rel=1e-12)
    assert q["one"] == pytest.approx(3.0 * (1.0 - e), rel=1e-13)
    assert q["two"] == pytest.approx(4.0 * (e - 0.25), rel=1e-12)


@pytest.mark.parametrize("width", [1e-3, 1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("f_0", [3.13, 8.0])
def test_a_light_one_with_corners_follows_a_source_that_follows_a_heavy_one(width, f_0):
    """Slopes beside a corner are those of its other side: it comes nearer by halves."""
    m = hb.Model("corners")
    rows = [[-2 * width, -width, 0.0, width, 3 * width], [-30.3, -10.1, 0.0, 10.1, 15.15]]
    m.add(light=hb.I({"f": {"table": rows, "extrapolate": "linear"}}), heavy=hb.I(16.0, p=471.0))
    m.add(s=hb.Sf(f"{f_0}*(1 - 0.5*tanh(heavy.p/471.0))"), v=hb.One())
    m.bond("s -> v -> light", "v -> heavy")
    run = hb.simulate(m, 1e-3)
    f = brentq(lambda f: f - f_0 * (1.0 - 0.5 * np.tanh(16.0 * f / 471.0)), 0.0, f_0, xtol=1e-14)
    assert run["heavy.p"].at(0.0) == pytest.approx(16.0 * f, rel=1e-12)
    assert run["light.p"].at(0.0) == pytest.approx(np.interp(f, rows[1], rows[0]), rel=1e-11)
