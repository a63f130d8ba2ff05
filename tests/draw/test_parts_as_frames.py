"""Parts as boxes and frames; the mode that is shown; simplified by default; words that wrap."""

import itertools
from pathlib import Path

import pytest

import hybond as hb
from hybond.causality.dynamics import causality_of, dynamics
from hybond.causality.reference import reference_mode
from hybond.draw.measure import width, wrapped
from hybond.draw.simplify import simplified, zeros_of
from hybond.draw.sketch import sketch
from hybond.errors import UsageError

EXAMPLES = Path(__file__).parents[2] / "examples"


def load(name: str) -> hb.Model:
    return hb.load(EXAMPLES / f"{name}.toml")


def drawn_nodes(drawing) -> set[str]:
    return {g.key for g in drawing.scene.groups if g.name == "node"}


def test_closed_parts_are_one_node_each() -> None:
    model = load("mmc_arm")
    assert drawn_nodes(model.draw(open=())) == {"i", "source", "R", "L", "m1", "m2", "m3", "m4"}


def test_an_open_part_shows_what_is_in_it_inside_its_frame() -> None:
    drawing = load("mmc_arm").draw(open=["m1"])
    assert {n for n in drawn_nodes(drawing) if n.startswith("m1.")} >= {"m1.C", "m1.arm", "m1.plus"}
    assert "m2" in drawn_nodes(drawing) and "m1" not in drawn_nodes(drawing)
    (part,) = [g for g in drawing.scene.groups if g.name == "part"]
    box = part.marks[0].box
    for g in drawing.scene.groups:
        if g.name == "node":
            letters = next(m for m in g.marks if m.role.startswith("node"))
            inside = box.x0 < letters.x < box.x1 and box.y0 < letters.y < box.y1
            assert inside == g.key.startswith("m1.")


def test_bonds_between_parts_stay_with_their_strokes() -> None:
    model = load("boost")
    graph = model.flatten()
    closed = model.draw(open=(), simplify=False)
    outer = {
        b.name
        for b in graph.bonds
        if len({graph.nodes[n].path.split(".")[0] for n in (b.tail, b.head)}) == 2
    }
    bonds = [g for g in closed.scene.groups if g.name == "bond"]
    assert {g.key for g in bonds} == outer
    assert all(sum(m.role.startswith("stroke") for m in g.marks) == 1 for g in bonds)


def test_a_part_that_is_not_there_is_refused() -> None:
    with pytest.raises(UsageError, match=r"HB-D111.*\n.*did you mean 'coil'"):
        load("boost").draw(open=["coils"])


@pytest.mark.slow
def test_a_model_of_parts_is_simplified_and_the_legend_says_so() -> None:
    model = load("boost")
    assert drawn_nodes(model.draw()) == drawn_nodes(model.draw(simplify=True))
    whole = drawn_nodes(model.draw(simplify=False))
    gone = len(whole) - len(drawn_nodes(model.draw()))
    assert gone > 20
    assert f"without {gone} nodes that decide nothing" in model.draw().svg()
    assert "decide nothing" not in model.draw(simplify=False).svg()


def test_a_model_of_elements_is_drawn_whole() -> None:
    model = load("capacitors_joined")
    assert drawn_nodes(model.draw()) == {n.path for n in model.flatten().nodes if not n.implied}


def test_the_mode_drawn_is_the_first_of_a_run() -> None:
    model = load("diode_bridge")
    names = hb.simulate(model, until="1 us").segments[0].mode
    states = model.flatten().mode_names(tuple(names))
    assert states != model.flatten().mode_names(model.flatten().start_mode)
    caption = ", ".join(f"{m} = {s}" for m, s in states.items())
    said = " ".join(
        m.text for g in model.draw().scene.groups for m in g.marks if m.role == "caption"
    )
    assert said == caption


@pytest.mark.parametrize("name", ["boost", "half_bridge", "diagnosis_circuit", "weirs"])
def test_dashes_are_where_strokes_are_in_some_mode_also_when_simplified(name: str) -> None:
    graph = load(name).flatten()
    zeros = zeros_of(graph)
    base = reference_mode(graph)
    found = dynamics(graph, base).dynamic
    whole = simplified(
        sketch(graph, mode=base.mode, causality=base.causality, dynamic_bonds=found), zeros
    )
    seen: dict[str, set[int]] = {}
    for mode in itertools.product(*(range(len(m.states)) for m in graph.machines)):
        here = causality_of(graph, mode, reference=base)
        for a in simplified(sketch(graph, mode=mode, causality=here), zeros).arrows:
            if not a.off:
                seen.setdefault(a.name, set()).update(a.strokes)
    for a in whole.arrows:
        assert set(a.dashed) | set(a.strokes) >= seen.get(a.name, set()), a.name
        assert not set(a.dashed) & set(a.strokes)


def test_lines_of_a_law_fit_and_lose_nothing() -> None:
    law = "f = drain·e/sqrt(abs(e)) + 0.5·leak·(level - edge)"
    for room in (60.0, 90.0, 130.0):
        lines = wrapped(law, 10.5, room, most=20)
        assert all(width(line, 10.5) <= room for line in lines)
        assert "".join(lines).replace(" ", "") == law.replace(" ", "")
    assert len(wrapped(law, 10.5, 90.0, most=2)) == 2


def test_a_long_title_goes_on_in_the_next_line() -> None:
    m = hb.Model(
        "rc", title=" ".join(["A title much longer than such a small picture is wide"] * 2)
    )
    m.add(c=hb.C("1 mF"), r=hb.R("1 kohm"), node=hb.Zero())
    m.bond("node -> c", "node -> r")
    drawing = m.draw()
    titles = [t for g in drawing.scene.groups for t in g.marks if t.role == "title"]
    assert len(titles) > 1
    assert " ".join(t.text for t in titles) == m.title
