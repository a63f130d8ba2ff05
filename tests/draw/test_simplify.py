"""Drawings without what decides nothing keep the causality, and the system."""

from pathlib import Path

import pytest

import hybond as hb
from hybond.causality.dynamics import causality_of
from hybond.draw import draw_hybrid, draw_modes
from hybond.draw.simplify import simplified, zeros_of
from hybond.draw.sketch import sketch
from hybond.model.graph import FlatGraph

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.toml"))


def shown(graph: FlatGraph, mode=None):
    mode = graph.start_mode if mode is None else mode
    whole = sketch(graph, mode=mode, causality=causality_of(graph, mode))
    return whole, simplified(whole, zeros_of(graph))


def letters(drawn) -> list[str]:
    return sorted(s.letters for s in drawn.symbols)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_one_bond_decides_at_each_junction(path: Path) -> None:
    graph = hb.load(path).flatten()
    whole, drawn = shown(graph)
    if any(a.conflict for a in whole.arrows):
        pytest.skip("a mode in conflict")
    assert {s.path for s in drawn.symbols} <= {s.path for s in whole.symbols}
    for k, s in enumerate(drawn.symbols):
        near = [a for a in drawn.arrows if k in (a.tail, a.head)]
        assert near, s.path
        if s.kind not in "01" or s.off or any(a.off for a in near):
            continue
        # 0: the one bond that brings the effort; 1: the one that brings the flow
        here = [(0 if a.tail == k else 1) in a.strokes for a in near]
        assert here.count(s.kind == "0") == 1, s.path
        plain = not (s.controlled or s.law)
        if plain and len(near) == 2 and not any(a.tail == a.head for a in near):
            comes = sum(a.head == k for a in near)
            others = {a.tail if a.head == k else a.head for a in near}
            joined = any({a.tail, a.head} == others for a in drawn.arrows)
            elements = not any(drawn.symbols[o].is_junction for o in others)
            assert comes != 1 or joined or len(others) == 1 or elements, s.path


def test_a_boost_converter_of_parts_is_that_of_the_textbook() -> None:
    graph = hb.load(next(p for p in EXAMPLES if p.stem == "boost")).flatten()
    _, drawn = shown(graph)
    # coil, node, switch, diode, output and the second load's switch
    assert letters(drawn) == ["0", "0", "1", "1", "1", "1", "C", "I", "R", "R", "Se"]
    svg = draw_hybrid(graph, simplify=True).svg()
    assert 'data-node="ground.zero"' not in svg
    assert 'data-node="coil.i"' in svg


def test_two_bonds_that_both_come_stay() -> None:
    # the common flow of a and b is opposite: no single arrow says that
    m = hb.Model("facing")
    m.add(a=hb.One(), n=hb.Zero(), b=hb.One(), x=hb.I(1), y=hb.I(1), r=hb.R(1), s=hb.R(1))
    m.bond("a -> n", "b -> n", "a -> x", "b -> y", "a -> r", "b -> s")
    whole, drawn = shown(m.flatten())
    assert drawn == whole


def test_what_a_ground_holds_is_left_out_and_the_rest_stays() -> None:
    m = hb.Model("grounded", domain="electrical")
    m.add(V=hb.Se(5), i=hb.One(), r=hb.R(2), earth=hb.Zero(), pin=hb.Zero(), g=hb.Se(0))
    m.add(n=hb.Zero(), c=hb.C(1), j=hb.One(), k=hb.R(1))
    m.bond("V -> i -> r", "i -> n -> c", "n -> j -> k", "j -> earth", "earth -> pin", "g -> pin")
    _, drawn = shown(m.flatten())
    assert letters(drawn) == ["0", "1", "C", "R", "R", "Se"]


def test_every_panel_shows_the_same_symbols() -> None:
    graph = hb.load(next(p for p in EXAMPLES if p.stem == "boost")).flatten()
    modes = [graph.start_mode, graph.mode_of({"second.contact": "open"})]
    panels = draw_modes(graph, modes, simplify=True).svg()
    assert panels.count('data-node="coil.i"') == panels.count('data-node="out"') >= 2
