"""Schematics of circuits as textbooks have them, counted on their marks: what stands where."""

from __future__ import annotations

import functools
import itertools
import time
from pathlib import Path
from typing import Any

import pytest

import hybond as hb
from hybond.draw import draw_schematic
from hybond.draw.beside import box_of
from hybond.draw.geometry import Box, Point
from hybond.draw.scene import Line, Text
from hybond.draw.wires import Wire, clear, led

GATE = "Vg g 0 PULSE(0 5 0 10n 10n 4u 10u)\n"
MODELS = ".model sx VSWITCH(Ron=10m Roff=1e6 Von=2.6 Voff=2.4)\n.model dm D\n.tran 1u 1m uic\n"
OUT = "Lo x out 50u\nC1 out 0 100u\nR1 out 0 5\n"
CIRCUITS = {
    "flyback": "V1 in 0 24\nL1 in sw 100u\nL2 0 a 25u\nK1 L1 L2 0.99\nS1 sw 0 g 0 sx\n"
    "D1 a out dm\nC1 out 0 100u\nR1 out 0 5\n" + GATE,
    "forward": "V1 in 0 24\nL1 in sw 400u\nL2 0 reset 400u\nL3 sec 0 100u\nK1 L1 L2 L3 0.99\n"
    "D3 reset in dm\nS1 sw 0 g 0 sx\nD1 sec x dm\nD2 0 x dm\n" + OUT + GATE,
    "push_pull": "V1 in 0 24\nL1 in d1 100u\nL2 d2 in 100u\nL3 s1 0 50u\nL4 0 s2 50u\n"
    "K1 L1 L2 L3 L4 0.99\nS1 d1 0 g 0 sx\nS2 d2 0 g 0 sx\nD1 s1 x dm\nD2 s2 x dm\n" + OUT + GATE,
    "full_bridge": "V1 in 0 48\nS1 in a g 0 sx\nS2 a 0 g 0 sx\nS3 in b g 0 sx\nS4 b 0 g 0 sx\n"
    "L1 a b 400u\nL2 s1 s2 100u\nK1 L1 L2 0.99\nD1 s1 x dm\nD2 s2 x dm\nD3 0 s1 dm\nD4 0 s2 dm\n"
    + OUT
    + GATE,
    "isolated_cuk": "V1 in 0 24\nLi in sw 500u\nS1 sw 0 g 0 sx\nCa sw p 10u\nL1 p 0 1m\nL2 s 0 1m\n"
    "K1 L1 L2 0.99\nCb s x 10u\nD1 x 0 dm\n" + OUT + GATE,
    "three_phases": "Va a 0 SIN(0 325 50)\nVb b 0 SIN(0 325 50 0 0 -120)\n"
    "Vc c 0 SIN(0 325 50 0 0 120)\nL1 a b 1\nL3 b c 1\nL5 c a 1\nL2 sa n 1\nL4 sb n 1\nL6 sc n 1\n"
    "K1 L1 L2 0.99\nK2 L3 L4 0.99\nK3 L5 L6 0.99\nD1 sa p dm\nD2 sb p dm\nD3 sc p dm\nD4 m sa dm\n"
    "D5 m sb dm\nD6 m sc dm\nC1 p m 1m\nR1 p m 50\nRn n 0 1meg\n",
}
CORES = {
    "flyback": [("L1", "L2")],
    "forward": [("L1", "L3")],
    "push_pull": [("L1", "L3"), ("L2", "L4")],
    "full_bridge": [("L1", "L2")],
    "isolated_cuk": [("L1", "L2")],
    "three_phases": [("L1", "L2"), ("L3", "L4"), ("L5", "L6")],
}
SLOW = {"forward", "three_phases"}
EACH = [pytest.param(n, marks=[pytest.mark.slow] if n in SLOW else []) for n in CIRCUITS]


def ladder(count: int) -> str:
    rows = [f"R{k} n{k - 1} n{k} 1k\nC{k} n{k} 0 1u\n" for k in range(1, count + 1)]
    return "V1 n0 0 1\n" + "".join(rows)


@functools.cache
def drawn(name: str, folder: str) -> tuple[Any, dict[str, Any]]:
    text = ladder(int(name[6:])) if name.startswith("ladder") else CIRCUITS[name]
    path = Path(folder) / f"{name}.cir"
    path.write_text(f"{name}\n{text}{MODELS}.end\n")
    drawing = draw_schematic(hb.read_circuit(path).as_parts())
    return drawing, {g.key: g for g in drawing.scene.groups if g.name in ("part", "node")}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> str:
    return str(tmp_path_factory.mktemp("rails"))


def body(group: Any) -> Box:
    """Return what the lines of a symbol cover."""
    points = [p for m in group.marks if isinstance(m, Line) for p in m.points]
    xs, ys = zip(*points, strict=True)
    return Box(min(xs), min(ys), max(xs), max(ys))


def middle(group: Any) -> Point:
    b = body(group)
    return (b.x0 + b.x1) / 2.0, (b.y0 + b.y1) / 2.0


def wires(drawing: Any) -> dict[str, tuple[Point, ...]]:
    return {g.key: g.marks[0].points for g in drawing.scene.groups if g.name == "wire"}


def nets(found: dict[str, tuple[Point, ...]]) -> dict[str, str]:
    """Return of each wire the node that it goes to."""
    return {key: next(e for e in key.split(" -> ") if "." not in e) for key in found}


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", EACH)
def test_coils_of_a_core_stand_side_by_side_with_bars_between_and_dots_that_agree(
    name: str, folder: str
) -> None:
    drawing, groups = drawn(name, folder)
    (cores,) = [g for g in drawing.scene.groups if g.name == "cores"]
    for primary, secondary in CORES[name]:
        one, two = body(groups[primary]), body(groups[secondary])
        assert one.x1 < two.x0 and two.x0 - one.x1 < 60.0  # left and right, close
        assert one.y0 < two.y1 and two.y0 < one.y1
        bars = [b.points for b in cores.marks if one.x1 < b.points[0][0] < two.x0]
        assert any(a[1] <= one.y0 + 30 and b[1] >= one.y1 - 30 for a, b in bars)
        # the dots are between the coils: the coils look at each other
        for coil in (primary, secondary):
            (dot,) = [m for m in groups[coil].marks if isinstance(m, Line) and "filled" in m.role]
            assert one.x0 < min(dot.points)[0] and max(dot.points)[0] < two.x1
    for bar in cores.marks:
        (x, top), (_, bottom) = bar.points
        box = Box(x - 0.5, top, x + 0.5, bottom)
        for way in wires(drawing).values():
            assert not any(box.cut(piece) for piece in itertools.pairwise(way))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", EACH)
def test_sources_stand_with_plus_up_and_the_ground_is_at_the_bottom(name: str, folder: str) -> None:
    _, groups = drawn(name, folder)
    for key, group in groups.items():
        plus = [m for m in group.marks if isinstance(m, Text) and m.text == "+"]
        if plus:
            assert plus[0].y < middle(group)[1], key
    ground = middle(groups["ground"])[1]
    assert all(middle(g)[1] < ground for k, g in groups.items() if k[0] in "VLSDCR")


@pytest.mark.parametrize("name", ["flyback", "full_bridge", "isolated_cuk"])
def test_power_goes_from_left_to_right(name: str, folder: str) -> None:
    _, groups = drawn(name, folder)
    assert middle(groups["V1"])[0] < middle(groups["L1"])[0]
    assert middle(groups["L2"])[0] < middle(groups["C1"])[0] <= middle(groups["R1"])[0]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", [*EACH, pytest.param("ladder40", marks=pytest.mark.slow)])
def test_wires_of_nets_are_apart_and_no_symbol_is_crossed(name: str, folder: str) -> None:
    drawing, groups = drawn(name, folder)
    found = wires(drawing)
    net = nets(found)
    lines: dict[tuple[int, float], list[tuple[float, float, str]]] = {}
    for key, way in found.items():
        for p, q in itertools.pairwise(way):
            assert p[0] == q[0] or p[1] == q[1]
            k = 0 if p[0] == q[0] else 1
            piece = (min(p[1 - k], q[1 - k]), max(p[1 - k], q[1 - k]), net[key])
            lines.setdefault((k, p[k]), []).append(piece)
    for pieces in lines.values():
        for (a, b, one), (c, d, other) in itertools.combinations(pieces, 2):
            assert one == other or b < c or d < a
    for key, group in groups.items():
        if group.name == "node":
            continue
        box = body(group).grown(-1.0)
        if box.x0 < box.x1 and box.y0 < box.y1:
            for other, way in found.items():
                if f"{key}." not in other:
                    assert not any(box.cut(piece) for piece in itertools.pairwise(way)), (
                        key,
                        other,
                    )


@pytest.mark.parametrize("name", [*EACH, "ladder40"])
@pytest.mark.sampled(2)
def test_no_symbol_stands_on_another(name: str, folder: str) -> None:
    _, groups = drawn(name, folder)
    boxes = [body(g) for g in groups.values() if g.name == "part"]
    assert not any(a.overlaps(b) for a, b in itertools.combinations(boxes, 2))


@pytest.mark.parametrize("name", [*EACH, "ladder40"])
def test_no_text_stands_on_a_wire_or_on_another_text(name: str, folder: str) -> None:
    drawing, _ = drawn(name, folder)
    texts = [
        (m.text, box_of(m).grown(-1.0))
        for g in drawing.scene.groups
        for m in g.marks
        if isinstance(m, Text) and m.role != "word"
    ]
    pieces = [piece for way in wires(drawing).values() for piece in itertools.pairwise(way)]
    assert len(texts) > 10
    assert not [text for text, box in texts if any(box.cut(piece) for piece in pieces)]
    assert not [
        pair for pair in itertools.combinations(texts, 2) if pair[0][1].overlaps(pair[1][1])
    ]


def test_a_long_ladder_is_folded_and_drawn_in_time(folder: str) -> None:
    """124 parts: 14 s once, and 3600 pixels wide with wires all over."""
    begin = time.process_time()
    drawing, groups = drawn("ladder40", folder)
    assert time.process_time() - begin < 5.0
    assert drawing.scene.width < 5.0 * drawing.scene.height
    bands = {round(middle(groups[f"C{k}"])[1]) for k in range(1, 41)}
    assert len(bands) == 3
    assert all(len(way) <= 8 for way in wires(drawing).values())


def test_legs_of_a_bridge_stand_between_its_rails(folder: str) -> None:
    _, groups = drawn("full_bridge", folder)
    for upper, lower in (("S1", "S2"), ("S3", "S4"), ("D1", "D3"), ("D2", "D4")):
        assert middle(groups[upper])[1] < middle(groups[lower])[1], (upper, lower)
        for part in (upper, lower):
            box = body(groups[part])
            assert box.y1 - box.y0 > box.x1 - box.x0, part


def test_ways_that_are_given_stay_and_others_go_around() -> None:
    one = Wire(((0.0, 0.0), None), ((200.0, 0.0), None), "n")
    other = Wire(((100.0, -50.0), None), ((100.0, 50.0), None), "m")
    same = Wire(((50.0, 0.0), None), ((150.0, 0.0), None), "m")
    given = clear([one, other, same], [(w.a[0], w.b[0]) for w in (one, other, same)], [])
    assert given == [((0.0, 0.0), (200.0, 0.0)), ((100.0, -50.0), (100.0, 50.0)), None]
    ways = led([one, other, same], [], given=given)
    assert ways[:2] == given[:2]
    assert not any(p[1] == q[1] == 0.0 for p, q in itertools.pairwise(ways[2]))
