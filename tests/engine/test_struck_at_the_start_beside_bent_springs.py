"""Bodies that meet as a run begins rebound, whatever bends beside them."""

import pytest

import hybond as hb

CUBIC = {"e": "800*q + 4e4*q^3"}


def pair(way: int, bent: str, first: float, second: float, push: float) -> hb.Model:
    """Two bodies that touch, one of them pushed, and something bent that one of them may meet."""
    m = hb.Model("pair", domain="translational")
    m.add(A=hb.I("2 kg", f=way * first), B=hb.I("1.5 kg", f=way * second), a=hb.One(), b=hb.One())
    m.add(
        F=hb.Se(way * push), hit=hb.Zero(law="unilateral", gap=f"{way}*(y - x)", restitution=0.32)
    )
    m.bond("a -> A", "b -> B", "F -> a", "a -> hit -> b" if way > 0 else "b -> hit -> a")
    m.signal(x=hb.Integral("a.f"), y=hb.Integral("b.f"))
    if bent == "loose":
        m.add(k=hb.C(CUBIC), w=hb.One(), W=hb.I("1 kg"))
        m.bond("w -> W", "w -> k")
    else:
        m.add(wall=hb.Zero(law="unilateral", gap="0.01 - y + k.q"), o=hb.One(), k=hb.C(CUBIC))
        m.bond("b -> wall -> o -> k")
    return m


@pytest.mark.parametrize("bent", ["loose", "wall"])
@pytest.mark.parametrize(("first", "second"), [(0.0, -1.5), (1.0, 0.0), (2.0, 0.5)])
@pytest.mark.parametrize("push", [6.0, -6.0, 0.0])
def test_they_rebound_though_a_force_presses(
    bent: str, first: float, second: float, push: float
) -> None:
    """A look a moment ahead saw the contact approach, and held it closed: no rebound."""
    given = 1.32 * (first - second) / (1 / 2 + 1 / 1.5)
    for way in (1, -1) if bent == "loose" else (1,):
        run = hb.simulate(pair(way, bent, first, second, push), 0.1)
        assert run["a.f"].at(1e-6) == pytest.approx(way * (first - given / 2), abs=1e-5)
        assert run["b.f"].at(1e-6) == pytest.approx(way * (second + given / 1.5), abs=1e-5)
