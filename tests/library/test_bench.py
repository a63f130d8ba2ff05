"""The bench itself draws every bond both ways."""

from library.bench import every_way

import hybond as hb


def test_all_combinations_of_a_few_bonds_and_each_alone_of_many() -> None:
    m = hb.Model("row")
    assert len(every_way(m, "a - b")) == 2
    assert len({way.name for way in every_way(m, "a - b", "c - d", "e - f", "g - h")}) == 16
    many = every_way(m, *(f"a - b{k}" for k in range(7)))
    assert len({tuple(way.bonds) for way in many}) == 9


def test_the_model_itself_stays_as_it_is() -> None:
    m = hb.Model("row")
    every_way(m, "a - b")
    assert m.bonds == []
