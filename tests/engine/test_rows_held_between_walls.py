"""Bodies in a row without room between two walls: whatever pushes them, they come to rest.

How far two of them go apart adds up, with the walls, to zero. Where one of these motions turned at
the instant its rate was that of a moment later, those of the others were not: the sum was below
zero, and the laws were said to have no solution (HB-J110).
"""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

import hybond as hb


def row(
    pushes: tuple[str, ...], speeds: tuple[float, ...], *, turned: bool, domain: str
) -> hb.Model:
    """Return bodies of 1 kg that touch each other, and a wall on both sides."""
    m = hb.Model("row", domain=domain)
    m.add(left=hb.Sf(0.0), right=hb.Sf(0.0))
    way = -1.0 if turned else 1.0
    many = len(pushes)
    for k in range(many):
        m.add(**{f"v{k}": hb.One(), f"b{k}": hb.I(1.0, f=way * speeds[k])})
        m.add(**{f"push{k}": hb.Se(pushes[k])})
        m.bond(f"b{k} -> v{k}" if turned else f"v{k} -> b{k}", f"push{k} -> v{k}")
    places = ["left", *(f"v{k}" for k in range(many)), "right"]
    for k, (a, b) in enumerate(pairwise(places)):
        m.add(**{f"c{k}": hb.Zero(law="unilateral", gap=f"g{k}")})
        m.bond(f"{a} -> c{k} -> {b}")
        ends = [f"{w}.f" for w in (b, a) if w.startswith("v")]
        rate = ends[0] if b.startswith("v") else f"-{ends[0]}"
        m.signal(**{f"g{k}": hb.Integral(rate if len(ends) < 2 else f"{b}.f - {a}.f")})
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("domain", ["translational", "rotational"])
@pytest.mark.parametrize(
    ("change", "more"),
    [
        ("+ 0.05*time", 0.025),
        ("- 0.05*time", -0.025),
        ("+ 0.1*sin(2*time)", 0.1 * math.sin(1.0)),
    ],
)
@pytest.mark.parametrize("speeds", [(0.0, 0.5), (1.0, 0.5), (-1.0, 0.0)])
def test_a_row_between_walls_comes_to_rest_whatever_changes(
    speeds: tuple[float, float], change: str, more: float, domain: str, turned: bool
) -> None:
    run = hb.simulate(row((f"-0.1 {change}", "-0.1"), speeds, turned=turned, domain=domain), 0.5)
    assert [run[f"v{k}.f"].at(0.5) for k in range(2)] == pytest.approx([0.0, 0.0], abs=1e-15)
    assert run["c0.e"].at(0.5) - run["c2.e"].at(0.5) == pytest.approx(0.2 - more, rel=1e-9)
    assert run["c1.e"].at(0.5) - run["c2.e"].at(0.5) == pytest.approx(0.1, rel=1e-9)
    assert run.audit().holds()


def test_three_of_them_do_as_well() -> None:
    m = row(
        ("-0.1 + 0.05*time", "-0.1", "-0.1 - 0.02*time"),
        (0.0, 0.5, 1.0),
        turned=False,
        domain="translational",
    )
    run = hb.simulate(m, 0.5)
    assert [run[f"v{k}.f"].at(0.5) for k in range(3)] == pytest.approx([0.0] * 3, abs=1e-15)
    assert run.audit().holds()
