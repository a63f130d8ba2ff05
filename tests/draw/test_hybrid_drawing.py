"""One picture of all modes, and modes side by side."""

from __future__ import annotations

import itertools
import math
import re
from pathlib import Path
from typing import Any

import pytest

import hybond as hb
from hybond.causality.dynamics import dynamics
from hybond.draw import draw_hybrid, draw_mode, draw_modes
from hybond.draw.drawing import Drawing
from hybond.draw.geometry import Box
from hybond.draw.hybrid import MOST_PANELS
from hybond.draw.scene import Frame, Line, Text
from hybond.draw.style import STYLES
from hybond.draw.words import extent_of
from hybond.errors import ModelError, UsageError
from hybond.model.graph import FlatGraph

ROOT = Path(__file__).parents[2]
MODELS = [
    "bouncing_ball",
    "diode_inductor",
    "half_bridge",
    "clutch_rigid",
    "diagnosis_circuit",
    "two_body_collision",
    "capacitors_joined",
]


def graph_of(name: str) -> FlatGraph:
    return hb.load(ROOT / "examples" / f"{name}.toml").flatten()


@pytest.fixture(scope="module", params=MODELS)
def model(request: pytest.FixtureRequest) -> FlatGraph:
    return graph_of(request.param)


def marks(drawing: Drawing, word: str) -> list[Any]:
    return [m for g in drawing.scene.groups for m in g.marks if word in m.role.split()]


def panels_of(drawing: Drawing) -> list[tuple[str, Box, list[Any]]]:
    """Return for each panel its caption, its frame and the groups in it."""
    found: list[tuple[str, Box, list[Any]]] = []
    for g in drawing.scene.groups:
        if g.name == "panel":
            frame = next(m for m in g.marks if isinstance(m, Frame))
            found.append((g.key, frame.box, []))
        elif found and g.name != "words":
            found[-1][2].append(g)
    return found


def stroke_ends(bond: Any) -> dict[str, list[int]]:
    """Return the ends (0 tail, 1 head) of solid and dashed strokes, read off the picture."""
    line = next(m for m in bond.marks if m.role.split()[0] == "bond")
    found: dict[str, list[int]] = {"solid": [], "dashed": []}
    for mark in bond.marks:
        words = mark.role.split()
        if words[0] != "stroke":
            continue
        (ax, ay), (bx, by) = mark.points
        middle = ((ax + bx) / 2, (ay + by) / 2)
        ends = [k for k in (0, 1) if middle == pytest.approx(line.points[k])]
        found["dashed" if "dynamic" in words else "solid"] += ends
    return found


def bonds_of(drawing: Drawing) -> dict[str, Any]:
    return {g.key: g for g in drawing.scene.groups if g.name == "bond"}


def test_ball_on_the_floor_as_margetts_and_ngwompo_draw_it() -> None:
    """By hand: touching, the pad gives the force of `squeeze`; away, the contact gives zero.

    So the strokes of `contact -> squeeze` and of the damper move, and no other.
    """
    graph = graph_of("bouncing_ball")
    drawing = draw_hybrid(graph, graph.mode_of({"floor": "touching"}))
    found = {key: stroke_ends(bond) for key, bond in bonds_of(drawing).items()}
    assert found == {
        "weight -> v": {"solid": [1], "dashed": []},
        "v -> ball": {"solid": [1], "dashed": []},
        "contact -> v": {"solid": [1], "dashed": []},
        "contact -> squeeze": {"solid": [0], "dashed": [1]},
        "squeeze -> pad": {"solid": [0], "dashed": []},
        "squeeze -> damper": {"solid": [0], "dashed": [1]},
    }
    assert not marks(drawing, "off")
    assert len(marks(drawing, "region")) == 3  # two bonds, and the legend


def test_rigid_clutch_shows_which_inertia_becomes_dependent() -> None:
    """Closed, the two inertias have one speed: one of them is in derivative causality."""
    graph = graph_of("clutch_rigid")
    drawing = draw_hybrid(graph, graph.mode_of({"clutch": "open"}))
    late = [
        key
        for key, bond in bonds_of(drawing).items()
        if any(m.role == "stroke dynamic derivative" for m in bond.marks)
    ]
    assert len(late) == 1 and late[0] in ("w1 -> rotor", "w2 -> load")
    legend = [m.text for m in marks(drawing, "legend")]
    assert "derivative in other modes" in legend and "derivative causality" not in legend
    closed = draw_modes(graph, [graph.mode_of({"clutch": "closed"})])
    letters = [m.text for m in marks(closed, "node") if "derivative" in m.role.split()]
    assert letters == ["I"]
    assert "derivative causality" in [m.text for m in marks(closed, "legend")]


def test_overview_has_a_solid_stroke_per_bond_and_a_dashed_one_where_it_moves(
    model: FlatGraph,
) -> None:
    """The oracle is the panels: every mode, one by one."""
    panels = [
        {g.key: stroke_ends(g)["solid"] for g in groups if g.name == "bond"}
        for _, _, groups in panels_of(draw_modes(model))
        if not any("conflict" in m.role.split() for g in groups for m in g.marks)
    ]
    proved = {model.bonds[b].name for b in dynamics(model).dynamic}
    for key, bond in bonds_of(draw_hybrid(model)).items():
        found = stroke_ends(bond)
        assert found["solid"] == panels[0][key]
        elsewhere = {end for panel in panels for end in panel[key]} - set(found["solid"])
        assert set(found["dashed"]) == elsewhere
        assert bool(elsewhere) >= (key in proved)


def lies_on(p, points) -> bool:
    return any(
        math.dist(a, p) + math.dist(p, b) == pytest.approx(math.dist(a, b))
        for a, b in itertools.pairwise(points)
    )


def test_panels_point_out_the_strokes_that_moved_and_no_others(model: FlatGraph) -> None:
    panels = panels_of(draw_modes(model))
    first = {g.key: stroke_ends(g)["solid"] for g in panels[0][2] if g.name == "bond"}
    for _, _, groups in panels:
        bonds = [g for g in groups if g.name == "bond"]
        bands = [m for g in groups for m in g.marks if m.role == "emphasis"]
        moved = [g for g in bonds if stroke_ends(g)["solid"] != first[g.key]]
        assert len(bands) == len(moved)
        for bond in moved:
            line = next(m for m in bond.marks if m.role.split()[0] == "bond")
            assert any(
                band.points[1:-1] == line.points[1:-1]
                and all(lies_on(p, line.points) for p in band.points)
                for band in bands
            )


def test_panels_hold_every_mode_once_the_reference_first(model: FlatGraph) -> None:
    captions = [caption for caption, _, _ in panels_of(draw_modes(model))]
    assert captions[0].startswith("reference mode: ")
    assert not any(c.startswith("reference") for c in captions[1:])
    states = [[f"{m.path} = {s}" for s in m.states] for m in model.machines]
    expected = {", ".join(mode) for mode in itertools.product(*states)}
    assert {c.removeprefix("reference mode: ") for c in captions} == expected
    assert len(captions) == len(expected)


def test_panels_have_one_layout(model: FlatGraph) -> None:
    panels = panels_of(draw_modes(model))
    places = []
    for _, frame, groups in panels:
        nodes = [g for g in groups if g.name == "node"]
        places.append(
            {
                (g.key, m.text): (round(m.x - frame.x0, 6), round(m.y - frame.y0, 6))
                for g in nodes
                for m in g.marks
                if isinstance(m, Text)
            }
        )
    assert all(p == places[0] for p in places)


def test_single_pictures_of_modes_lie_on_each_other(model: FlatGraph) -> None:
    found = []
    for machine in model.machines:
        for state in machine.states:
            drawing = draw_mode(model, model.mode_of({machine.path: state}), legend=False)
            found.append([(m.text, m.x, m.y) for m in marks(drawing, "node")])
    assert all(f == found[0] for f in found)


@pytest.mark.sampled(5)
@pytest.mark.parametrize("picture", [draw_hybrid, draw_modes])
def test_nothing_overlaps_and_everything_is_on_the_page(model: FlatGraph, picture: Any) -> None:
    drawing = picture(model, numbers=True)
    everything = [m for g in drawing.scene.groups for m in g.marks]
    texts = [m for m in everything if isinstance(m, Text) and "subscript" not in m.role]
    lines = [m for m in everything if isinstance(m, Line)]
    boxes = [extent_of(t) for t in texts]
    for (a, one), (b, two) in itertools.combinations(zip(texts, boxes), 2):
        assert not one.overlaps(two), (a, b)
    for text, box in zip(texts, boxes):
        for line in lines:
            assert box.cut((line.points[0], line.points[1])) is None, (text, line)
    for mark in everything:
        box = extent_of(mark)
        assert box.x0 >= 0 and box.y0 >= 0
        assert box.x1 <= drawing.scene.width and box.y1 <= drawing.scene.height
    for _, frame, groups in panels_of(drawing):
        for g in groups:
            for mark in g.marks:
                box = extent_of(mark)
                assert box.x0 >= frame.x0 and box.x1 <= frame.x1
                assert box.y0 >= frame.y0 and box.y1 <= frame.y1


def test_legend_has_an_entry_for_each_sign_that_occurs(model: FlatGraph) -> None:
    for drawing in (draw_hybrid(model), draw_modes(model)):
        body = [m for g in drawing.scene.groups if g.name != "words" for m in g.marks]
        roles = {frozenset(m.role.split()) for m in body}
        words = frozenset(w for role in roles for w in role)
        legend = {m.text for m in marks(drawing, "legend")}
        dashed = {r for r in roles if {"stroke", "dynamic"} <= r}
        assert ("other modes" in legend) == any("derivative" not in r for r in dashed)
        assert ("derivative in other modes" in legend) == any("derivative" in r for r in dashed)
        solid = {r for r in roles if "stroke" in r and "dynamic" not in r}
        assert ("derivative causality" in legend) == any("derivative" in r for r in solid)
        assert ("OFF" in legend) == ("off" in words)
        assert ("dynamic causality" in legend) == ("region" in words)
        assert ("differs from the reference" in legend) == ("emphasis" in words)
        assert ("causal conflict" in legend) == ("conflict" in words)
        assert ("controlled by [machine]" in legend) == ("controlled" in words)


def test_legend_can_be_left_out(model: FlatGraph) -> None:
    assert not marks(draw_hybrid(model, legend=False), "legend")
    assert not marks(draw_modes(model, legend=False), "legend")


def test_two_batteries_on_one_rail_are_a_crossed_out_conflict() -> None:
    m = hb.Model("rail", domain="electrical")
    m.add(V=hb.Se("10 V"), W=hb.Se("12 V"), s1=hb.One(), s2=hb.One(), rail=hb.Zero(), r=hb.R(1))
    m.bond("V -> s1 -> rail", "W -> s2 -> rail", "rail -> r")
    m.machine("S1", states={"off": [], "on": ["s1"]}, start="off")
    m.machine("S2", states={"off": [], "on": ["s2"]}, start="off")
    graph = m.flatten()
    panels = {key: groups for key, _, groups in panels_of(draw_modes(graph))}
    crossed = {
        caption: {g.key for g in groups for m in g.marks if "cross" in m.role.split()}
        for caption, groups in panels.items()
    }
    both = crossed.pop("S1 = on, S2 = on")
    assert {"s1 -> rail", "s2 -> rail"} <= both
    assert not any(crossed.values())


def test_numbers_stay_clear_of_the_crosses_of_a_conflict() -> None:
    m = hb.Model("rail", domain="electrical")
    m.add(V=hb.Se("10 V"), W=hb.Se("12 V"), rail=hb.Zero(), r=hb.R(1))
    m.bond("V -> rail", "W -> rail", "rail -> r")
    graph = m.flatten()
    drawing = draw_mode(graph, (), numbers=True)
    crosses = [m for m in marks(drawing, "cross") if isinstance(m, Line)]
    assert len(crosses) >= 4
    for number in marks(drawing, "number"):
        for line in crosses:
            assert extent_of(number).cut((line.points[0], line.points[1])) is None


@pytest.mark.slow
def test_sixty_switches_are_drawn_in_one_picture_but_not_side_by_side() -> None:
    m = hb.Model("ladder", domain="electrical")
    m.add(V=hb.Se("1 V"), rail=hb.One())
    m.bond("V -> rail")
    last = "rail"
    for k in range(60):
        m.add(**{f"s{k}": hb.Zero(), f"r{k}": hb.R(1)})
        m.bond(f"{last} -> s{k} -> r{k}")
        m.machine(f"S{k}", states={"off": [], "on": [f"s{k}"]}, start="on")
    graph = m.flatten()
    drawing = draw_hybrid(graph, graph.start_mode, title=False)
    assert len(bonds_of(drawing)) == 121
    with pytest.raises(UsageError, match=r"HB-D105.*1152921504606846976 modes"):
        draw_modes(graph)


def test_panels_of_chosen_modes_and_their_bounds() -> None:
    graph = graph_of("diagnosis_circuit")
    reference = graph.mode_of({"S1": "on", "S2": "on"})
    other = graph.mode_of({"S1": "off", "S2": "on"})
    panels = panels_of(draw_modes(graph, [other, other, reference], reference=reference, columns=1))
    assert [caption for caption, _, _ in panels] == [
        "reference mode: S1 = on, S2 = on",
        "S1 = off, S2 = on",
    ]
    assert panels[0][1].x0 == panels[1][1].x0 and panels[0][1].y1 < panels[1][1].y0
    with pytest.raises(ModelError, match="HB-M144"):
        draw_modes(graph, [(0,)])
    with pytest.raises(ModelError, match="HB-M144"):
        draw_hybrid(graph, (0, 0, 0))
    with pytest.raises(UsageError, match="HB-D105"):
        draw_modes(graph, columns=0)


def test_too_many_chosen_modes_are_refused() -> None:
    m = hb.Model("many", domain="electrical")
    m.add(V=hb.Se("1 V"), j=hb.One(), r=hb.R(1))
    m.bond("V -> j -> r")
    states = {f"s{k}": ["j"] if k else [] for k in range(MOST_PANELS + 1)}
    m.machine("M", states=states, start="s0")
    graph = m.flatten()
    with pytest.raises(UsageError, match="HB-D105"):
        draw_modes(graph)
    with pytest.raises(UsageError, match="HB-D105"):
        draw_modes(graph, [(k,) for k in range(MOST_PANELS + 1)])
    few = draw_modes(graph, [(k,) for k in range(1, MOST_PANELS)])
    assert len(panels_of(few)) <= MOST_PANELS


def test_model_without_machines_has_one_panel_and_no_dashes() -> None:
    m = hb.Model("oscillator", domain="translational")
    m.add(mass=hb.I("1 kg"), spring=hb.C("1 mm/N"), v=hb.One())
    m.bond("v -> mass", "v -> spring")
    graph = m.flatten()
    assert [caption for caption, _, _ in panels_of(draw_modes(graph))] == ["the only mode"]
    assert not marks(draw_hybrid(graph), "dynamic")


# Machado, Oliveira and Fernandes, IEEE Trans. Vis. Comput. Graph. 15 (2009), severity 1.0.
COLOUR_BLIND = {
    "protan": (
        (0.152286, 1.052583, -0.204868),
        (0.114503, 0.786281, 0.099216),
        (-0.003882, -0.048116, 1.051998),
    ),
    "deutan": (
        (0.367322, 0.860646, -0.227968),
        (0.280085, 0.672501, 0.047413),
        (-0.011820, 0.042940, 0.968881),
    ),
}


def linear(ink: str) -> tuple[float, ...]:
    parts = (int(ink[k : k + 2], 16) / 255 for k in (1, 3, 5))
    return tuple(c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts)


def lab(rgb: tuple[float, ...]) -> tuple[float, float, float]:
    to_xyz = (
        (0.4124564 / 0.95047, 0.3575761 / 0.95047, 0.1804375 / 0.95047),
        (0.2126729, 0.7151522, 0.0721750),
        (0.0193339 / 1.08883, 0.1191920 / 1.08883, 0.9503041 / 1.08883),
    )
    f = []
    for row in to_xyz:
        t = max(0.0, sum(a * b for a, b in zip(row, rgb)))
        f.append(t ** (1 / 3) if t > 216 / 24389 else (24389 / 27 * t + 16) / 116)
    return 116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])


@pytest.mark.parametrize("eyes", sorted(COLOUR_BLIND))
@pytest.mark.parametrize("paper", [0, 1])
def test_signs_differ_for_colour_blind_readers(eyes: str, paper: int) -> None:
    """A colour difference of 10 (CIE 1976) is seen at a glance; 2.3 is just noticeable."""
    matrix = COLOUR_BLIND[eyes]
    seen = {}
    for word in ("stroke", "off", "dynamic", "derivative", "conflict"):
        rgb = linear((STYLES[word].ink or ("", ""))[paper])
        seen[word] = lab(tuple(sum(a * b for a, b in zip(row, rgb)) for row in matrix))
    for (a, one), (b, two) in itertools.combinations(seen.items(), 2):
        distance = sum((p - q) ** 2 for p, q in zip(one, two)) ** 0.5
        assert distance > 10, (a, b, distance)


@pytest.mark.parametrize("paper", [0, 1])
def test_letters_can_be_read_on_their_grounds(paper: int) -> None:
    """WCAG 2.1, contrast of normal text: 4.5."""

    def light(ink: str) -> float:
        return sum(a * b for a, b in zip((0.2126, 0.7152, 0.0722), linear(ink)))

    def contrast(ink: str, ground: str) -> float:
        high, low = sorted((light(ink), light(ground)), reverse=True)
        return (high + 0.05) / (low + 0.05)

    for ground in ("region", "emphasis"):
        for word in ("name", "parameter", "machine", "bond"):
            pair = (STYLES[word].ink or ("", ""))[paper], (STYLES[ground].ink or ("", ""))[paper]
            assert contrast(*pair) >= 4.5, (word, ground)
    for tone in ("badge", "blue", "orange", "red", "purple", "green"):
        style = STYLES[tone]
        assert style.ink and style.fill
        assert contrast(style.ink[paper], style.fill[paper]) >= 4.5, tone


def test_svg_of_a_hybrid_drawing_has_the_same_strokes_as_its_scene(model: FlatGraph) -> None:
    for drawing in (draw_hybrid(model), draw_modes(model)):
        svg = drawing.svg()
        assert len(re.findall(r'<path class="stroke[ "]', svg)) == len(
            [m for m in marks(drawing, "stroke") if isinstance(m, Line)]
        )
