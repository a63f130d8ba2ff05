"""What a source lifts from zero is as large as it says, however little that is yet.

Of two capacitors beside a source that has just begun the smaller one was held at zero, the other
one was not: their junction had two efforts in one instant, and the run was told to be wrong
(HB-N411 at 1e-21 s).
"""

import math

import pytest

import hybond as hb
from hybond.testing import random_recipe

SMALL = 2.736625514403292e-06
LARGE = 0.34054054054054056


@pytest.mark.parametrize("small", [SMALL, 1e-9, 1e-14])
@pytest.mark.parametrize("dual", [False, True], ids=["capacitors", "masses"])
def test_two_storages_beside_a_source_that_begins(small: float, dual: bool) -> None:
    storage, letter = (hb.I, "p") if dual else (hb.C, "q")
    m = hb.Model("begins")
    m.add(
        j=hb.One() if dual else hb.Zero(law="relay", limit=0.809),
        a=storage(small, **{letter: 0.2 * small}),
        b=storage(LARGE, **{letter: 0.017}),
        s=(hb.Sf if dual else hb.Se)("-0.282*sin(3.54*time)*(1 - tanh(held))"),
        r=hb.R(0.035),
    )
    hard = "0.247*((p/0.131) + (p/0.131)^3)"
    m.add(i=hb.I({"f": hard}, p=-0.0378) if not dual else hb.C({"e": hard.replace("p", "q")}))
    m.bond("j -> b", "s -> j", "i -> j", "j -> a", "j -> r")
    m.signal(held=hb.Sampled(f"a.{letter}", every=0.0123))
    run = hb.simulate(m, 0.14)
    assert run.status == "ok"
    for k in range(11):
        held = run["held"].at(0.0123 * k + 0.006)
        given = -0.282 * math.sin(3.54 * (0.0123 * k + 0.006)) * (1.0 - math.tanh(held))
        assert run[f"a.{letter}"].at(0.0123 * k + 0.006) == pytest.approx(small * given, rel=1e-12)
        assert run[f"b.{letter}"].at(0.0123 * k + 0.006) == pytest.approx(LARGE * given, rel=1e-12)


@pytest.mark.parametrize("small", [SMALL, 1e-12])
def test_what_a_constraint_holds_at_zero_is_zero(small: float) -> None:
    """A source that ends at zero takes with it what it held, to the last bit."""
    m = hb.Model("ends")
    m.add(j=hb.Zero(), a=hb.C(small), b=hb.C(LARGE), r=hb.R(0.035), o=hb.Zero(), k=hb.C(1.0, q=1.0))
    m.add(s=hb.Se("0.3*max(0, 0.05 - time)"), l=hb.R(1.0))
    m.bond("s -> j -> a", "j -> b", "j -> r", "o -> k", "o -> l")
    run = hb.simulate(m, 0.14)
    assert run["a.q"].at(0.04) == pytest.approx(small * 0.003, rel=1e-10)
    assert run["a.q"].at(0.1) == 0.0 and run["b.q"].at(0.1) == 0.0


def driven(kind: str, drive: str) -> hb.Model:
    """Two masses that stick as long as their drive is zero, or two capacitors; and what adds up."""
    m = hb.Model("driven")
    if kind == "friction":
        m.add(j=hb.One(law="coulomb", limit=0.124), a=hb.I(6.69), b=hb.I(0.0691), s=hb.Sf(drive))
    else:
        m.add(j=hb.Zero(law="relay", limit=0.124), a=hb.C(6.69), b=hb.C(0.0691), s=hb.Se(drive))
    m.bond("a -> j -> s", "j -> b")
    m.signal(sum=hb.Integral("a.p" if kind == "friction" else "a.q"))
    return m


@pytest.mark.parametrize("rtol", [1e-8, 1e-10, 1e-12])
@pytest.mark.parametrize("kind", ["friction", "relay"])
def test_what_sticks_while_its_drive_is_zero_lets_go_as_soon_as_time_passes(
    kind: str, rtol: float
) -> None:
    run = hb.simulate(driven(kind, "5.04*sin(7.79*time)"), 1.62, rtol=rtol)
    # there at once, and at each half period the other way
    turns = [k * math.pi / 7.79 for k in range(1, 5)]
    assert [e.t for e in run.events if e.t > 1e-9] == pytest.approx(turns, rel=1e-9)
    stored = "a.p" if kind == "friction" else "a.q"
    for t in (0.1, 0.7, 1.3):
        size = 6.69 * 5.04
        assert abs(run[stored].at(t)) == pytest.approx(size * abs(math.sin(7.79 * t)), rel=1e-6)
        area = size * (1.0 - math.cos(7.79 * t)) / 7.79
        assert abs(run["sum"].at(t)) == pytest.approx(area, rel=1e-6)


@pytest.mark.parametrize("seed", [400306, 402910])
def test_random_models_that_let_go_at_once(seed: int) -> None:
    recipe = random_recipe(seed, controlled=True)
    assert hb.simulate(recipe.model(), recipe.until).status == "ok"
