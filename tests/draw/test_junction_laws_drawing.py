"""Junctions with a law in drawings: a badge, no source that nobody wrote."""

import hybond as hb
from hybond.draw.legend import entries
from hybond.draw.sketch import sketch


def ball() -> hb.Model:
    m = hb.Model("ball")
    m.add(i=hb.I(1), w=hb.Se(-10), v=hb.One(law="coulomb", limit=1))
    m.add(contact=hb.Zero(law="unilateral", gap="h", restitution=0.5), s=hb.One(), r=hb.R(1))
    m.bond("w -> v -> i", "contact -> v", "v -> s -> r")
    m.machine("S", states={"off": [], "on": ["s"]}, start="off")
    m.signal(h=hb.Integral("v.f", start=1))
    return m


def test_the_sources_of_laws_and_their_bonds_are_not_drawn() -> None:
    graph = ball().flatten()
    shown = sketch(graph, mode=graph.start_mode)
    implied = {n.path for n in graph.nodes if n.implied}
    assert implied == {"v.friction", "contact.rebound"}
    assert {s.path for s in shown.symbols} == {n.path for n in graph.nodes} - implied
    assert [a.name for a in shown.arrows] == [
        b.name for b in graph.bonds if not any(name in b.name for name in implied)
    ]
    # what is left is connected as it was written
    ends = {(shown.symbols[a.tail].path, shown.symbols[a.head].path) for a in shown.arrows}
    assert ends == {("w", "v"), ("v", "i"), ("contact", "v"), ("v", "s"), ("s", "r")}


def test_a_law_is_named_and_a_machine_of_its_name_is_not() -> None:
    graph = ball().flatten()
    by_path = {s.path: s for s in sketch(graph, mode=graph.start_mode).symbols}
    assert (by_path["v"].law, by_path["v"].machine) == ("coulomb", "")
    assert (by_path["contact"].law, by_path["contact"].machine) == ("unilateral", "")
    assert (by_path["s"].law, by_path["s"].machine) == ("", "S")
    assert by_path["contact"].about.endswith("; unilateral")


def test_pictures_name_laws_in_a_frame_and_the_legend_explains_them() -> None:
    for drawing in (hb.draw(ball()), hb.draw_hybrid(ball())):
        svg = drawing.svg()
        assert ">coulomb<" in svg and ">unilateral<" in svg
        assert "friction<" not in svg and "rebound<" not in svg
        assert "coulomb = dry friction, unilateral = contact" in svg
    graph = ball().flatten()
    found = [e.meaning for e in entries([sketch(graph, mode=graph.start_mode)])]
    assert sum(m.startswith("law of a junction") for m in found) == 1
    plain = hb.Model()
    plain.add(c=hb.C(1), j=hb.Zero(), r=hb.R(1))
    plain.bond("j -> c", "j -> r")
    assert not any("law" in e.meaning for e in entries([sketch(plain.flatten())]))


def test_a_mark_on_the_source_of_a_law_goes_to_its_junction() -> None:
    graph = ball().flatten()
    shown = sketch(graph, marks={"v.friction": hb.draw.Badge("stiff", "purple")})
    assert {s.path: s.badge for s in shown.symbols}["v"].text == "stiff"


def test_modes_with_laws_are_drawn_side_by_side() -> None:
    m = hb.Model("cut")
    m.add(u=hb.Se(1), d=hb.One(law="diode"), r=hb.R(1))
    m.bond("u -> d -> r")
    assert hb.draw_modes(m).svg().count(">diode<") == 2
    assert ">diode<" not in hb.draw(m).tikz() and "diode" in hb.draw(m).tikz()


def test_the_second_direction_of_a_friction_names_the_first() -> None:
    m = hb.Model("block")
    m.add(x=hb.One(law="coulomb", limit=1), y=hb.One(law="coulomb", pair="x"))
    m.add(mx=hb.I(1), my=hb.I(1))
    m.bond("x -> mx", "y -> my")
    graph = m.flatten()
    by_path = {s.path: s for s in sketch(graph, mode=graph.start_mode).symbols}
    assert (by_path["x"].law, by_path["x"].machine) == ("coulomb", "")
    assert (by_path["y"].law, by_path["y"].machine) == ("coulomb", "x")
