"""Where the nodes of submodels stand."""

import hybond as hb
from hybond.draw import draw


def two_resistors(**layout: tuple[float, float]) -> hb.Model:
    m = hb.Model("row", domain="electrical")
    m.add(V=hb.Se("1 V"), n=hb.Zero(), zero=hb.Se(0), m=hb.Zero())
    m.add(a=hb.Submodel("electrical.resistor"), b=hb.Submodel("electrical.resistor"))
    m.bond("V -> n -> a.plus", "a.minus -> b.plus", "b.minus -> m", "zero -> m")
    m.layout = {key.replace("__", "."): at for key, at in layout.items()}
    return m


def test_a_submodel_stands_where_the_model_around_it_puts_it() -> None:
    at = draw(two_resistors(n=(0, 1), a=(1, 1), b=(4, 2)), simplify=False).positions
    assert (at["n"], at["a.plus"], at["a.minus"], at["a.r"]) == ((0, 1), (1, 1), (3, 1), (2, 2))
    assert (at["b.plus"], at["b.i"], at["b.minus"]) == ((4, 2), (5, 2), (6, 2))


def test_nodes_of_two_parts_do_not_lie_on_each_other() -> None:
    at = draw(two_resistors(), simplify=False).positions
    assert len(set(at.values())) == len(at)


def test_one_node_of_a_submodel_may_be_moved() -> None:
    at = draw(two_resistors(a=(1, 1), a__r=(2, 0)), simplify=False).positions
    assert (at["a.i"], at["a.r"]) == ((2, 1), (2, 0))


def test_places_count_through_submodels_of_submodels() -> None:
    inner = hb.library.part("electrical.resistor")
    middle = hb.Model("middle", domain="electrical")
    middle.add(r=hb.Submodel(inner), end=hb.Zero())
    middle.bond("r.minus -> end")
    middle.layout = {"r": (10, 0), "end": (13, 0)}
    m = hb.Model("outer", domain="electrical")
    m.add(s=hb.Submodel(middle), V=hb.Se("1 V"))
    m.bond("V -> s.r.plus")
    m.layout = {"s": (100, 7)}
    assert m.flatten().layout["s.r.minus"] == (112, 7)
    assert m.flatten().layout["s.end"] == (113, 7)


def test_elements_of_a_part_show_values_and_those_of_the_model_what_is_written() -> None:
    m = hb.Model("named", domain="electrical", parameters={"R0": "10 ohm"})
    m.add(V=hb.Se("1 V"), n=hb.Zero(), own=hb.R("R0"), zero=hb.Se(0), m=hb.Zero())
    m.add(part=hb.Submodel("electrical.resistor", R="2*R0"))
    m.bond("V -> n -> part.plus", "part.minus -> m", "zero -> m", "n -> own")
    shown = {node.path: node.said for node in m.flatten().nodes}
    assert (shown["own"], shown["part.r"]) == ("R0", "20 ohm")
    assert ">20 Ω<" in draw(m).svg()
