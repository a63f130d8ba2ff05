"""The state diagram: all modes and transitions, frames that stand apart, arrows that end there."""

import re
from xml.etree import ElementTree

import pytest

import hybond as hb
from hybond.analysis.modes.records import Edge, Fires, ModeGraph, ModeNode
from hybond.draw.mode_graph import _boxes, draw_mode_graph


def graph_of(many, kind="continuous"):
    nodes = tuple(ModeNode(f"mode {k}", (kind,)) for k in range(many))
    edges = tuple(
        Edge(a.mode, b.mode, (Fires("m", a.mode, b.mode, "c.e < 1"),), "seen")
        for a in nodes
        for b in nodes
        if a is not b
    )
    rest = {"transitions": (), "unreachable": (), "gaps": (), "time": "proved", "why": ""}
    return ModeGraph("many", nodes[0].mode, nodes, edges, exact=True, **rest)


@pytest.mark.parametrize("many", [1, 2, 5, 12, 24])
def test_frames_stand_apart(many):
    boxes = list(_boxes(graph_of(many).nodes).values())
    assert not any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[:k])


def test_the_picture_has_all_modes_and_transitions():
    found = graph_of(4)
    svg = draw_mode_graph(found).svg()
    root = ElementTree.fromstring(svg)
    texts = ["".join(e.itertext()) for e in root.iter("{http://www.w3.org/2000/svg}text")]
    assert all(n.mode in texts for n in found.nodes)
    assert sum(t.startswith("m: ") for t in texts) == 12
    assert svg.count('class="edge-group"') == 12
    assert "c.e &lt; 1" in svg


def test_arrows_begin_and_end_at_frames():
    found = graph_of(5)
    boxes = _boxes(found.nodes)
    svg = draw_mode_graph(found).svg()
    for source, target, path in re.findall(
        r'data-edge="(mode \d) -&gt; (mode \d)">\n<title>.*?</title>\n'
        r'<path class="\w+" d="M(.*?)"/>',
        svg,
    ):
        ends = [tuple(map(float, p.split())) for p in path.split("L")]
        for name, (x, y) in ((source, ends[0]), (target, ends[-1])):
            box = boxes[name]
            assert not box.grown(-0.2).overlaps(type(box)(x, y, x + 1e-9, y + 1e-9))
            assert box.grown(0.2).overlaps(type(box)(x, y, x + 1e-9, y + 1e-9))
    assert svg.count("data-edge") == 20


def test_a_pinnacle_has_two_lines_and_a_cycle_is_red():
    assert draw_mode_graph(graph_of(1, "pinnacle")).svg().count('class="badge orange"') == 2
    m = hb.Model("relay")
    m.add(c=hb.C(1), n=hb.Zero(), f=hb.Sf(0), s=hb.One(), r=hb.R(1))
    m.bond("f -> n -> c", "n -> s -> r")
    rules = ["off -> on when c.e > 1", "on -> off when c.e < 2"]
    m.machine("m", states={"off": [], "on": ["s"]}, start="off", rules=rules)
    svg = hb.reachable(m, until=0).draw().svg()
    assert svg.count('<path class="conflict"') == 4  # two arrows and their tips
    assert "no mode holds from (off) where 1 &lt; c.q &lt; 2" in svg


def test_too_many_modes_are_refused():
    with pytest.raises(hb.UsageError) as caught:
        draw_mode_graph(graph_of(25))
    assert caught.value.code == "HB-A602"
