"""The picture of a bond graph: what it shows, that nothing overlaps, that it is safe to open."""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import pytest

from hybond.draw import draw
from hybond.draw.drawing import Drawing
from hybond.draw.geometry import Box
from hybond.draw.scene import Frame, Line, Text
from hybond.draw.words import extent_of
from hybond.errors import ModelError, UsageError

SVG = "{http://www.w3.org/2000/svg}"


def marks(drawing: Drawing, word: str) -> list[Any]:
    return [m for g in drawing.scene.groups for m in g.marks if word in m.role.split()]


def texts(drawing: Drawing) -> list[Text]:
    return [m for g in drawing.scene.groups for m in g.marks if isinstance(m, Text)]


def group(drawing: Drawing, key: str) -> Any:
    return next(g for g in drawing.scene.groups if g.key == key)


def variants(graph: Any, strokes: Any) -> list[Drawing]:
    mixed = tuple(k % 2 for k in range(len(graph.bonds)))
    return [
        draw(graph),
        draw(graph, causality=strokes(graph, strokes=mixed), numbers=True),
        draw(graph, dynamic_bonds=range(len(graph.bonds)), mode=None),
        draw(graph, mode=graph.start_mode, causality=strokes(graph), numbers=True),
    ]


@pytest.mark.sampled(3)
def test_no_text_overlaps_text(example: Any, strokes: Any) -> None:
    for drawing in variants(example, strokes):
        # A subscript c belongs to its letter.
        found = [(t, extent_of(t)) for t in texts(drawing) if "subscript" not in t.role]
        for (a, box_a), (b, box_b) in itertools.combinations(found, 2):
            assert not box_a.overlaps(box_b), (a, b)


@pytest.mark.sampled(1)
def test_no_text_is_crossed_by_a_line(example: Any, strokes: Any) -> None:
    for drawing in variants(example, strokes):
        lines = [m for g in drawing.scene.groups for m in g.marks if isinstance(m, Line)]
        for text in texts(drawing):
            box = extent_of(text)
            for line in lines:
                assert box.cut((line.points[0], line.points[1])) is None, (text, line)


@pytest.mark.sampled(1)
def test_no_bond_passes_through_a_node(example: Any) -> None:
    drawing = draw(example)
    for line in marks(drawing, "bond"):
        for letters in marks(drawing, "node"):
            assert extent_of(letters).cut((line.points[0], line.points[1])) is None


@pytest.mark.sampled(1)
def test_everything_is_on_the_page(example: Any, strokes: Any) -> None:
    for drawing in variants(example, strokes):
        page = Box(0, 0, drawing.scene.width, drawing.scene.height)
        for g in drawing.scene.groups:
            for mark in g.marks:
                box = extent_of(mark)
                assert box.x0 >= 0 and box.y0 >= 0
                assert box.x1 <= page.x1 and box.y1 <= page.y1


def test_stroke_is_near_the_node_that_receives_effort(build: Any, strokes: Any) -> None:
    graph = build({"S": "Se", "j": "1", "m": "I"}, ["S -> j -> m"])
    drawing = draw(graph, causality=strokes(graph, strokes=(1, 0)))
    (letter,) = [m for m in group(drawing, "j").marks if "junction" in m.role.split()]
    for bond in ("S -> j", "j -> m"):
        (bar,) = [m for m in group(drawing, bond).marks if m.role.startswith("stroke")]
        x = sum(p[0] for p in bar.points) / 2
        y = sum(p[1] for p in bar.points) / 2
        # Both strokes are at the junction: one at a head, one at a tail.
        assert abs(x - letter.x) < 15 and abs(y - (letter.y - 7)) < 15


@pytest.mark.sampled(2)
def test_without_causality_there_are_no_strokes_and_no_legend(example: Any) -> None:
    drawing = draw(example)
    assert not marks(drawing, "stroke")
    assert not marks(drawing, "legend")


def test_legend_names_what_is_shown_only(build: Any, strokes: Any) -> None:
    graph = build({"S": "Se", "j": "1", "m": "I"}, ["S -> j -> m"])
    drawing = draw(graph, causality=strokes(graph, derivative=(0,)))
    assert [m.text for m in marks(drawing, "legend")] == ["derivative causality"]


@pytest.mark.parametrize("bond", ["j -> spring", "spring -> j"])
def test_the_legend_says_nothing_of_strokes_that_are_grey(
    build: Any, strokes: Any, bond: str
) -> None:
    graph = build(
        {"S": "Se", "j": "1", "spring": "C"},
        ["S -> j", bond],
        machines={"hook": {"off": [], "on": ["spring"]}},
    )
    given = strokes(graph, derivative=(0,))
    for mode, said in ((0, []), (1, ["derivative causality"])):
        legend = [m.text for m in marks(draw(graph, mode=(mode,), causality=given), "legend")]
        assert [text for text in legend if "causality" in text] == said


def test_a_title_that_fits_is_not_cut(build: Any) -> None:
    title = "Half-wave rectifier with a smoothing capacitor"
    for words in range(1, 7):
        said = " ".join(title.split()[:words])
        graph = build({"S": "Se", "j": "1", "m": "I"}, ["S -> j -> m"], title=said)
        assert " ".join(m.text for m in marks(draw(graph), "title")) == said


def test_derivative_and_conflict_and_dynamic_have_their_roles(build: Any, strokes: Any) -> None:
    graph = build({"S": "Se", "j": "1", "m": "I", "r": "R"}, ["S -> j -> m", "j -> r"])
    given = strokes(graph, derivative=(0,), conflicts=(SimpleNamespace(bonds=(0,)),))
    drawing = draw(graph, causality=given, dynamic_bonds=(2,))
    crosses = ["cross conflict"] * 2
    roles = {k: [m.role for m in group(drawing, k).marks] for k in ("S -> j", "j -> m", "j -> r")}
    assert roles["j -> m"] == ["bond", "barb", "stroke derivative"]
    assert roles["S -> j"] == ["bond conflict", "barb conflict", "stroke conflict", *crosses]
    assert roles["j -> r"] == ["bond", "barb", "stroke", "stroke dynamic"]
    assert next(m.role for m in group(drawing, "m").marks) == "node derivative"


def test_without_causality_a_dynamic_bond_has_dashed_strokes_at_both_ends(examples: Any) -> None:
    drawing = draw(examples["ball"](), dynamic_bonds=(2,))
    found = [m.role for m in group(drawing, "contact -> v").marks]
    assert found == ["bond", "barb", "stroke dynamic", "stroke dynamic"]


def test_dynamic_bond_has_a_dashed_stroke_beside_the_solid_one(examples: Any, strokes: Any) -> None:
    graph = examples["ball"]()
    drawing = draw(graph, mode=(1,), causality=strokes(graph), dynamic_bonds=(2,))
    assert len([m for m in marks(drawing, "stroke") if "dynamic" in m.role]) == 2  # and the legend


def test_off_junction_and_its_bonds_are_grey(examples: Any) -> None:
    graph = examples["ball"]()
    away, touching = draw(graph, mode=(0,)), draw(graph, mode=(1,))
    grey = {g.key for g in away.scene.groups for m in g.marks if "off" in m.role.split() and g.key}
    assert grey == {"contact", "contact -> v", "contact -> squeeze"}
    assert not marks(touching, "off")
    assert [m.role for m in marks(touching, "controlled")] == ["node junction controlled on"]
    assert [m.text for m in marks(away, "caption")] == ["floor = away"]
    assert away.positions == touching.positions


def test_controlled_junction_has_a_mark_and_its_machine_beside_it(examples: Any) -> None:
    drawing = draw(examples["ball"]())
    contact = group(drawing, "contact")
    assert any(isinstance(m, Frame) for m in contact.marks)
    assert {"c", "contact", "[floor]"} <= {m.text for m in contact.marks if isinstance(m, Text)}


def test_switched_element_is_one_symbol(build: Any, strokes: Any) -> None:
    graph = build(
        {"S": "Se", "j": "1", "valve": "R", "valve.switch": "0"},
        ["S -> j -> valve.switch -> valve"],
        machines={"tap": {"shut": [], "open": ["valve.switch"]}},
        hidden=["valve.switch"],
    )
    drawing = draw(graph, mode=(0,), causality=strokes(graph))
    assert set(drawing.positions) == {"S", "j", "valve"}
    assert len(marks(drawing, "barb")) == 2
    valve = group(drawing, "valve")
    assert "node controlled off" in [m.role for m in valve.marks]
    assert any(m.text == "[tap]" for m in valve.marks if isinstance(m, Text))


def test_derivative_storage_behind_a_switch_is_orange_outside(build: Any, strokes: Any) -> None:
    graph = build(
        {"S": "Se", "j": "1", "c": "C", "c.switch": "0"},
        ["S -> j -> c.switch -> c"],
        machines={"tap": {"on": ["c.switch"]}},
        hidden=["c.switch"],
    )
    drawing = draw(graph, causality=strokes(graph, derivative=(0,)))
    assert "stroke derivative" in [m.role for m in group(drawing, "j -> c.switch").marks]


def test_conductance_is_drawn_as_resistor_and_says_so(examples: Any) -> None:
    damper = group(draw(examples["ball"]()), "damper")
    found = {m.text for m in damper.marks}
    assert "R" in found and "G = 10 m/(N·s)" in found


def test_numbers_count_from_one_in_the_order_of_bonds(examples: Any) -> None:
    drawing = draw(examples["diode"](), numbers=True)
    assert [m.text for m in marks(drawing, "number")] == ["1", "2", "3", "4", "5", "6"]


def test_pins_of_the_model_are_kept(build: Any) -> None:
    graph = build({"S": "Se", "j": "1", "m": "I"}, ["S -> j -> m"], layout={"m": (5, 2.5)})
    assert draw(graph).positions["m"] == (5.0, 2.5)


def test_title_can_be_left_out(examples: Any) -> None:
    graph = examples["diode"]()
    assert [m.text for m in marks(draw(graph), "title")] == ["Diode and inductor"]
    assert not marks(draw(graph, title=False), "title")


@pytest.mark.parametrize(
    "evil",
    ["</text><script>alert(1)</script>", "a & b", '"><image/>', "\x00\x1b\ufffe", "$\\frac$"],
)
def test_names_from_strangers_are_only_text(build: Any, tmp_path: Path, evil: str) -> None:
    graph = build({evil: ("Se", evil), "j": "1"}, [f"{evil} -> j"], title=evil)
    drawing = draw(graph, numbers=True)
    root = ElementTree.fromstring(drawing.svg())
    assert {e.tag.removeprefix(SVG) for e in root.iter()} <= {
        "svg",
        "title",
        "style",
        "rect",
        "g",
        "path",
        "text",
    }
    assert not [a for e in root.iter() for a in e.attrib if a.startswith("on")]
    drawing.save(tmp_path / "evil.png")


def test_svg_is_well_formed_and_carries_class_names(example: Any, strokes: Any) -> None:
    for drawing in variants(example, strokes):
        root = ElementTree.fromstring(drawing.svg())
        classes = {c for e in root.iter() for c in e.get("class", "").split()}
        assert {"bond", "barb", "node", "paper"} <= classes
        assert "prefers-color-scheme" in (root.findtext(f"{SVG}style") or "")


@pytest.mark.slow
def test_same_picture_in_every_process(tmp_path: Path) -> None:
    script, conftest = tmp_path / "one.py", str(Path(__file__).parent / "conftest.py")
    script.write_text(
        "import sys, runpy\n"
        f"examples = runpy.run_path({conftest!r})['EXAMPLES']\n"
        "from hybond.draw import draw\n"
        "sys.stdout.write(''.join(draw(examples[n]()).svg() for n in ('ball', 'rod')))\n",
        encoding="utf-8",
    )
    source = str(Path(__file__).parents[2] / "src")
    outputs = {
        subprocess.run(
            [sys.executable, str(script)],
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": source, "PYTHONUTF8": "1"},
            capture_output=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    }
    assert len(outputs) == 1


@pytest.mark.slow
def test_saves_by_ending_and_the_same_bytes(examples: Any, tmp_path: Path) -> None:
    drawing = draw(examples["ball"]())
    heads = {"svg": b"<svg", "png": b"\x89PNG", "pdf": b"%PDF"}
    for ending, head in heads.items():
        one = drawing.save(tmp_path / f"one.{ending}").read_bytes()
        two = drawing.save(str(tmp_path / f"two.{ending}")).read_bytes()
        assert one.startswith(head)
        assert one == two
    with pytest.raises(UsageError, match="HB-D101"):
        drawing.save(tmp_path / "picture.gif")


def test_to_mpl_draws_on_given_axes(examples: Any) -> None:
    from matplotlib.figure import Figure

    ax = Figure().add_subplot()
    drawing = draw(examples["motor"]())
    assert drawing.to_mpl(ax) is ax
    assert {"GY", "armature"} <= {t.get_text() for t in ax.texts}


def test_mode_of_wrong_length_is_refused(examples: Any) -> None:
    with pytest.raises(ModelError, match="HB-M144"):
        draw(examples["ball"](), mode=(0, 0))


def test_repr_svg_is_the_svg(examples: Any) -> None:
    drawing = draw(examples["ball"]())
    assert drawing._repr_svg_() == drawing.svg()


def test_two_bonds_between_the_same_nodes_are_both_seen(build: Any) -> None:
    graph = build({"j": "1", "field": "C", "k": "1"}, ["j -> field", "j -> field", "k -> field"])
    lines = [m.points for m in marks(draw(graph), "bond")]
    assert len(set(lines)) == 3


def test_empty_model_is_a_picture(build: Any) -> None:
    ElementTree.fromstring(draw(build({}, [])).svg())
