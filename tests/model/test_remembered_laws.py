"""Laws of single values are remembered: what was right in one place is still refused in another."""

from __future__ import annotations

import pytest

import hybond as hb


def one(kind: str, value: object, domain: str) -> hb.Model:
    m = hb.Model("one", domain=domain)
    m.add(v=hb.One(), s=hb.Se("1"), x=getattr(hb, kind)(value))
    m.bond("s -> v -> x")
    return m


def matrix(kind: str, value: object, domain: str) -> object:
    nodes = one(kind, value, domain).flatten().nodes
    return next(n.law.matrix for n in nodes if n.path == "x")


@pytest.mark.parametrize("again", [1, 2])
def test_a_value_means_what_its_kind_and_domain_make_of_it(again: int) -> None:
    assert matrix("R", "4 ohm", "electrical") == ((4.0,),)
    assert matrix("I", "4 H", "electrical") == ((0.25,),)
    assert matrix("C", 4, "electrical") == ((0.25,),)
    assert matrix("R", 4, "translational") == ((4.0,),)
    assert matrix("G", 4.0, "translational") == ((4.0,),)
    for kind, value, domain in (("R", "4 ohm", "translational"), ("I", "4 ohm", "electrical")):
        with pytest.raises(hb.HybondError, match="HB-U103"):
            one(kind, value, domain).flatten()
    with pytest.raises(hb.ModelError, match="HB-M163"):
        one("I", 0, "translational").flatten()
    with pytest.raises(hb.ModelError, match="HB-M163"):
        one("C", "-1 F", "electrical").flatten()
