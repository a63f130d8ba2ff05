"""Schematics: wires end where they should, symbols are whole, nothing lies on anything."""

from __future__ import annotations

import functools
import itertools
import time
from pathlib import Path
from typing import Any

import pytest

import hybond as hb
from hybond.draw import draw_schematic
from hybond.draw.composing import composed
from hybond.draw.geometry import Box
from hybond.draw.scene import Line, Text
from hybond.draw.symbols import UNIT, boxed, placed
from hybond.draw.wires import Wire, led
from hybond.errors import FileError, UsageError
from hybond.files.save import dumps
from hybond.library import find, names
from hybond.model.symbol import Symbol, points_of

EXAMPLES = Path(__file__).parents[2] / "examples"
OF_PARTS = [
    "automatic_gearbox",
    "bead_column",
    "boost",
    "mmc_arm",
    "rectifier_dc_machine",
    "three_tanks",
]
LONG = {"rectifier_dc_machine", "controlled"}
"""What takes one to two seconds, and is drawn with --all: others have diodes and machines, too."""


def drawn(names: list[str]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize(
        "name", [pytest.param(n, marks=[pytest.mark.slow] * (n in LONG)) for n in names]
    )


of_parts = drawn(OF_PARTS)


@functools.cache
def wires_of(name: str) -> tuple[Any, dict[str, tuple[tuple[float, float], ...]]]:
    if name in OF_PARTS:
        drawing = draw_schematic(hb.load(EXAMPLES / f"{name}.toml"))
    else:
        netlist = hb.read_circuit(EXAMPLES / "netlists" / f"{name}.cir")
        drawing = draw_schematic(netlist.as_parts())
    found = {g.key: g.marks[0].points for g in drawing.scene.groups if g.name == "wire"}
    return drawing, found


@of_parts
@pytest.mark.sampled(1)
def test_wires_are_level_or_upright_and_there_is_one_for_each_bond(name: str) -> None:
    model = hb.load(EXAMPLES / f"{name}.toml")
    drawing, wires = wires_of(name)
    arrows = sum(str(b).count("->") for b in model.bonds)
    assert len([g for g in drawing.scene.groups if g.name == "wire"]) == arrows
    for way in wires.values():
        assert len(way) <= 7
        for (a, b), (c, d) in itertools.pairwise(way):
            assert abs(a - c) <= 3.0 or abs(b - d) <= 3.0
    shown = {g.key for g in drawing.scene.groups if g.name in ("part", "node")}
    assert shown == set(model.elements)


@of_parts
def test_wires_that_share_no_end_do_not_lie_on_each_other(name: str) -> None:
    """Else two nets would read as one."""
    _, wires = wires_of(name)
    found = []
    for (one, a), (other, b) in itertools.combinations(wires.items(), 2):
        if set(one.split(" -> ")) & set(other.split(" -> ")):
            continue
        for (p, q), (r, s) in itertools.product(itertools.pairwise(a), itertools.pairwise(b)):
            for k, m in ((0, 1), (1, 0)):
                if p[k] == q[k] == r[k] == s[k]:
                    low = max(min(p[m], q[m]), min(r[m], s[m]))
                    high = min(max(p[m], q[m]), max(r[m], s[m]))
                    if high > low:
                        found.append((one, other))
    assert not found


@of_parts
def test_all_is_on_the_paper(name: str) -> None:
    drawing, _ = wires_of(name)
    scene = drawing.scene
    for group in scene.groups:
        for mark in group.marks:
            places = mark.points if isinstance(mark, Line) else [(mark.x, mark.y)]
            assert all(0 <= x <= scene.width and 0 <= y <= scene.height for x, y in places)
    assert "<path" in drawing.svg() and "\\draw" in drawing.tikz()


def test_it_is_the_same_each_time() -> None:
    again = draw_schematic(hb.load(EXAMPLES / "boost.toml"))
    assert again.svg() == wires_of("boost")[0].svg()


def test_wires_of_a_net_begin_at_its_pins() -> None:
    """The boost converter: the ends of wires, net by net, are the pins bonded to it."""
    _, wires = wires_of("boost")
    model = hb.load(EXAMPLES / "boost.toml")
    dots = [n for n, p in model.elements.items() if getattr(p, "kind", "") == "0"]
    for dot in dots:
        own = [key for key in wires if dot in key.split(" -> ")]
        ends = [wires[key][0 if key.startswith(f"{dot} ->") else -1] for key in own]
        assert len(set(ends)) == 1, dot
    # two wires meet nowhere but in their own net: no dot on a crossing of two nets. A rail with n
    # ends has n - 2 places where three meet: node has 3 ends, out 4, earth 6
    drawing, _ = wires_of("boost")
    (joints,) = [g for g in drawing.scene.groups if g.name == "joints"]
    assert len(joints.marks) == 1 + 2 + 4


@pytest.mark.parametrize("turned", [False, True])
def test_a_tank_hangs_at_its_pipe_and_no_wire_leads_around_it(turned: bool) -> None:
    """Nor around what is open to the air, which stands below like a ground."""
    m = hb.Model("drain", domain="hydraulic")
    m.add(pump=hb.Submodel("hydraulic.pressure_source"), pipe=hb.Submodel("hydraulic.pipe"))
    m.add(store=hb.Submodel("hydraulic.accumulator"), valve=hb.Submodel("hydraulic.orifice"))
    m.add(tank=hb.Submodel("hydraulic.tank"), drain=hb.Submodel("hydraulic.orifice"))
    m.add(air=hb.Submodel("hydraulic.atmosphere"))
    bonds = ["pump.port -> pipe.inlet", "pipe.outlet -> store.port", "pipe.outlet -> valve.inlet"]
    bonds += ["valve.outlet -> tank.port", "tank.port -> drain.inlet", "drain.outlet -> air.port"]
    m.bond(*(" -> ".join(b.split(" -> ")[::-1]) if turned else b for b in bonds))
    drawing = draw_schematic(m)
    wires = {g.key: g.marks[0].points for g in drawing.scene.groups if g.name == "wire"}
    ends = ("tank.port", "air.port")
    for way in (way for key, way in wires.items() if any(end in key for end in ends)):
        # to and fro is a way around something: such a wire goes on in one way along either axis
        for k in (0, 1):
            steps = [q[k] - p[k] for p, q in itertools.pairwise(way) if q[k] != p[k]]
            assert all(s > 0 for s in steps) or all(s < 0 for s in steps)
    at = drawing.positions
    assert set(at) == set(m.elements)
    assert at["air"][1] == max(y for _, y in at.values())


DRAWN = [n for n in sorted(names()) if find(n).symbol is not None]


@pytest.mark.parametrize("part", DRAWN)
def test_the_symbols_of_the_library_have_all_ports_at_the_end_of_a_line(part: str) -> None:
    model = find(part)
    symbol = model.symbol
    assert symbol is not None
    assert set(symbol.pins) == set(model.ports)
    ends = [p for text in symbol.lines for p in (points_of(text)[0], points_of(text)[-1])]
    for port, pin in symbol.pins.items():
        assert any(abs(x - pin[0]) + abs(y - pin[1]) < 0.21 for x, y in ends), port
    assert len(set(symbol.pins.values())) == len(symbol.pins)
    assert hb.loads(dumps(model)).symbol == symbol


def test_most_parts_have_a_symbol() -> None:
    with_ports = [n for n in names() if find(n).ports]
    assert len(DRAWN) >= 0.8 * len(with_ports)


def test_a_symbol_is_turned_as_its_wires_want_it_but_a_tank_stands() -> None:
    two = Symbol({"a": (-2.0, 0.0), "b": (2.0, 0.0)}, ("-2,0 2,0",))
    for way in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)):
        back = (-way[0], -way[1])
        put = placed(two, (0.0, 0.0), {"a": way, "b": back})
        assert put.pins["a"] == ((2 * UNIT * way[0], 2 * UNIT * way[1]), way)
    tank = find("hydraulic.tank").symbol
    assert tank is not None
    assert placed(tank, (0.0, 0.0), {"port": (0.0, -1.0)}).pins["port"][1] == (0.0, 1.0)


def test_a_box_has_its_ports_where_they_are_wired() -> None:
    sides = {"a": "w", "b": "e", "c": "n", "d": "n"}
    box = boxed("thing", list(sides), sides.__getitem__)
    assert box.pins["a"][0] < 0 < box.pins["b"][0]
    assert box.pins["c"][1] < 0 and box.pins["c"][0] != box.pins["d"][0]


EAST, WEST = (1.0, 0.0), (-1.0, 0.0)


def test_a_wire_goes_around_a_symbol() -> None:
    (way,) = led([Wire(((0.0, 0.0), EAST), ((200.0, 0.0), WEST), "n")], [Box(80, -20, 120, 20)])
    assert way[0] == (0.0, 0.0) and way[-1] == (200.0, 0.0)
    assert all(abs(y) > 20 for x, y in way if 80 < x < 120) and len(way) > 2


def test_wires_of_two_nets_cross_and_do_not_lie_on_each_other() -> None:
    # both would bend at x = 50
    one = Wire(((0.0, 0.0), EAST), ((100.0, 100.0), WEST), "n")
    other = Wire(((0.0, 100.0), EAST), ((100.0, 0.0), WEST), "m")
    a, b = led([one, other], [])
    upright = [{p[0] for p, q in itertools.pairwise(way) if p[0] == q[0]} for way in (a, b)]
    assert all(upright) and not upright[0] & upright[1]


def test_wires_of_one_net_go_together() -> None:
    wires = [Wire(((0.0, y), EAST), ((200.0, 0.0), None), "n") for y in (-40.0, 40.0, 80.0)]
    ways = led(wires, [])
    pieces = {(p, q) if p < q else (q, p) for way in ways for p, q in itertools.pairwise(way)}
    steps = {(p[0] + k, p[1]) for p, q in pieces if p[1] == q[1] for k in range(int(q[0] - p[0]))}
    assert len(steps) < 350  # apart they would be 600 pixels long across


@pytest.mark.slow
def test_many_wires_are_led_in_time() -> None:
    """Sixty wires over a wide paper: 14 s of CPU once, when each was looked for in all ways."""
    wires = [
        Wire(((100.0 * (k % 12), 300.0 * (k // 12)), EAST), ((1300.0, 700.0), None), "earth")
        for k in range(60)
    ]
    begin = time.process_time()
    ways = led(wires, [])
    assert time.process_time() - begin < 4.0
    assert all(
        w[0] == wire.a[0] and w[-1] == wire.b[0] for w, wire in zip(ways, wires, strict=True)
    )


@drawn(["controlled", "three_phase", "boost"])
@pytest.mark.sampled(1)
@pytest.mark.slow
def test_no_wire_ends_in_the_open(name: str) -> None:
    """Where wires of a junction meet they leave in two ways: it is no end of all of them."""
    drawing, wires = wires_of(name)
    for group in drawing.scene.groups:
        ways = [
            way if key.startswith(f"{group.key} ->") else way[::-1]
            for key, way in wires.items()
            if group.name == "node" and group.key in key.split(" -> ")
        ]
        if len(ways) > 1:
            assert (
                len({(w[1][0] > w[0][0]) - (w[1][0] < w[0][0]) for w in ways})
                + len({(w[1][1] > w[0][1]) - (w[1][1] < w[0][1]) for w in ways})
                > 2
            ), group.key


def test_a_layout_is_turned_with_sources_at_the_left_and_ground_below() -> None:
    places = {"earth": (0.0, 0.0), "load": (0.0, 3.0), "coil": (1.0, 3.0), "supply": (6.0, 3.0)}
    found = composed(places, ["supply"], ["earth"])
    assert found["supply"][0] == 0.0 and found["load"][0] > found["coil"][0]
    assert found["earth"][1] > found["load"][1]
    assert max(x for x, _ in found.values()) == 2.0  # no column is empty
    assert composed(places, [], []) == composed(found | places, [], [])


def test_power_comes_from_the_left_in_the_boost_converter() -> None:
    at = draw_schematic(hb.load(EXAMPLES / "boost.toml")).positions
    assert at["supply"][0] < at["switch"][0] < at["diode"][0]
    assert at["ground"][1] > max(at[n][1] for n in ("supply", "switch", "diode", "coil"))


@drawn([*OF_PARTS, "three_phase", "controlled"])
def test_no_wire_goes_through_a_symbol(name: str) -> None:
    drawing, wires = wires_of(name)
    for group in drawing.scene.groups:
        lines = [m for m in group.marks if isinstance(m, Line)]
        if group.name == "part" and lines:
            xs, ys = zip(*(p for m in lines for p in m.points), strict=True)
            # across a coil, too, that is thinner than wires are apart
            grown = [1.0 if max(v) - min(v) < 20.0 else -1.0 for v in (xs, ys)]
            box = Box(
                min(xs) - grown[0], min(ys) - grown[1], max(xs) + grown[0], max(ys) + grown[1]
            )
            if box.x0 < box.x1 and box.y0 < box.y1:
                for key, way in wires.items():
                    if group.key not in (end.partition(".")[0] for end in key.split(" -> ")):
                        assert not any(box.cut(p) for p in itertools.pairwise(way)), key


def test_a_model_of_single_elements_has_no_schematic() -> None:
    with pytest.raises(UsageError) as refused:
        hb.load(EXAMPLES / "buck.toml").draw(schematic=True)
    assert refused.value.code == "HB-D110"


def test_names_stand_beside_symbols() -> None:
    drawing, _ = wires_of("boost")
    words = {m.text for g in drawing.scene.groups for m in g.marks if isinstance(m, Text)}
    assert {"diode", "coil", "100 µH", "node", "earth"} <= words


HEAD = 'hybond = 1\n[elements]\nn = { junction = 0 }\n[ports]\np = "n"\n[symbol]\n'


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("pins = { q = [0, 0] }", "no port"),
        ('pins = { p = [0, 0] }\nlines = ["0,0"]', "fewer than two"),
        ('pins = { p = [0, 0] }\nlines = ["0,0 a,b"]', "no place"),
        ('pins = { p = [0, 0] }\nfills = ["0,0 1e9,0"]', "no place"),
        ("pins = { p = [0, 99] }", "farther"),
        ('pins = { p = [0, 0] }\nlines = ["0,0 13,0"]', "farther"),
        (f"pins = {{ p = [0, 0] }}\ncircles = {[[0, 0, 1]] * 201}", "more than"),
    ],
)
def test_what_is_no_symbol_is_refused(text: str, why: str) -> None:
    with pytest.raises(FileError) as refused:
        hb.loads(HEAD + text)
    assert refused.value.code == "HB-F120" and why in str(refused.value)
