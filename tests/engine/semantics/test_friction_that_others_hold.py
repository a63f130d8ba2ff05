"""Several dry frictions hold one thing: which of them is declared first must not decide anything.

The oracle: a rigid shaft rests as long as any shares keep each within its breakaway, so that all
break loose at the sum; then each gives what it has in motion.
"""

from __future__ import annotations

import itertools

import pytest

import hybond as hb

BRAKES = [
    # ratio, limit, breakaway of each, and the load
    ([(1.0, 1.06, 1.59), (1.0, 0.768, None)], 1.9328),
    ([(1.0, 1.06, 1.59), (1.0, 0.768, None)], 2.3),
    ([(1.0, 1.06, 1.59), (1.0, 0.768, None)], 2.4),
    ([(1.0, 1.0, 1.5), (1.0, 2.0, 3.0)], 3.9),
    ([(1.0, 1.0, 1.5), (1.0, 2.0, 3.0)], 4.1),
    ([(1.0, 1.0, 1.5), (2.0, 0.8, 1.3)], 2.9),
    ([(1.0, 1.0, 1.5), (-0.5, 0.8, 1.3)], 1.7),
    ([(1.0, 1.0, 1.2), (1.0, 0.5, None), (1.0, 0.7, 1.4)], 2.5),
]


def left_over(brakes: list[tuple[float, float, float | None]], load: float) -> float:
    """What is left of the load by frictions on one rigid shaft; 0 where they can hold it.

    They can as long as there are shares of it that keep each within its breakaway.
    """
    most = sum(abs(ratio) * (limit if more is None else more) for ratio, limit, more in brakes)
    moving = sum(abs(ratio) * limit for ratio, limit, _ in brakes)
    return 0.0 if load <= most else load - moving


def body_with(brakes: list[tuple[float, float, float | None]], load: float) -> hb.Model:
    m = hb.Model("held", domain="translational")
    m.add(body=hb.I("1 kg"), load=hb.Se(load), v=hb.One())
    m.bond("load -> v -> body")
    for k, (ratio, limit, breakaway) in enumerate(brakes):
        more = {} if breakaway is None else {"breakaway": breakaway}
        m.add(**{f"g{k}": hb.One(law="coulomb", limit=limit, **more)})
        if ratio == 1.0:
            m.bond(f"v -> g{k}")
        else:
            m.add(**{f"t{k}": hb.TF(ratio)})
            m.bond(f"v -> t{k} -> g{k}")
    return m


@pytest.mark.parametrize(("brakes", "load"), BRAKES)
def test_brakes_hold_a_load_whichever_is_declared_first(
    brakes: list[tuple[float, float, float | None]], load: float
) -> None:
    left = left_over(brakes, load)
    for order in itertools.permutations(brakes):
        run = hb.simulate(body_with(list(order), load), "1 s")
        assert run["v.f"].at(1.0) == pytest.approx(left, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("load", [0.5, 1.9328, 2.3, 2.5])
@pytest.mark.parametrize("turned", [False, True])
def test_a_loop_without_mass_rests_whichever_friction_is_declared_first(
    load: float, turned: bool
) -> None:
    """A source, a resistor, two frictions in one loop: where it moves, ``f = (load - 1.828)/R``."""
    brakes = {"a": (1.06, 1.59), "b": (0.768, None)}
    m = hb.Model("loop")
    for name in sorted(brakes, reverse=turned):
        limit, breakaway = brakes[name]
        more = {} if breakaway is None else {"breakaway": breakaway}
        m.add(**{name: hb.One(law="coulomb", limit=limit, **more)})
    m.add(s=hb.Se(load), r=hb.R(2.0), c=hb.C(1e3))
    first, last = sorted(brakes, reverse=turned)
    m.bond(f"s -> {first} -> {last} -> r", f"{first} -> c")
    f = float(hb.simulate(m, "1 ms")[f"{last}.f"].at(0.0, side="right"))
    moves = load > 1.59 + 0.768
    assert f == pytest.approx((load - 1.828) / 2.0 if moves else 0.0, abs=1e-12)
