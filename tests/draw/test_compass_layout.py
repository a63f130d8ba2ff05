"""Where nodes stand: a spine, one-ports around it, rings as rectangles, pins."""

from __future__ import annotations

import itertools
import random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hybond.draw.arrange import layout
from hybond.draw.board import Board
from hybond.draw.streets import Streets
from hybond.draw.ways import _cross, _Lines


def straight(bonds: list[tuple[int, int]], at: Any) -> bool:
    return all(at[a][0] == at[b][0] or at[a][1] == at[b][1] for a, b in bonds)


def test_one_ports_stand_at_their_compass_points() -> None:
    kinds = ["Se", "1", "I", "R", "TF", "1", "C"]
    bonds = [(0, 1), (1, 2), (1, 3), (1, 4), (4, 5), (5, 6)]
    at = layout(kinds, bonds)
    source, one, inertia, resistor, transformer, other, _ = at
    assert source == (one[0] - 1, one[1])
    assert inertia == (one[0], one[1] - 1)  # y runs downwards
    assert resistor == (one[0], one[1] + 1)
    assert transformer == (one[0] + 1, one[1])
    assert other == (one[0] + 2, one[1])


def test_spine_runs_from_the_source_whatever_the_order_of_writing() -> None:
    kinds = ["R", "1", "GY", "1", "Se"]
    at = layout(kinds, [(4, 3), (3, 2), (2, 1), (1, 0)])
    assert at[3][0] < at[2][0] < at[1][0]
    assert at[3][1] == at[2][1] == at[1][1]


def test_ring_of_eight_is_a_rectangle_without_crossings() -> None:
    kinds = ["0", "1"] * 4
    bonds = [(k, (k + 1) % 8) for k in range(8)]
    at = layout(kinds, bonds)
    assert straight(bonds, at)
    assert all(abs(at[a][0] - at[b][0]) + abs(at[a][1] - at[b][1]) == 1 for a, b in bonds)


@pytest.mark.slow
def test_examples_have_straight_bonds(examples: Any) -> None:
    for name in ("ball", "diode", "motor", "rod", "masses", "bridge"):
        graph = examples[name]()
        bonds = [(b.tail, b.head) for b in graph.bonds]
        assert straight(bonds, layout([n.kind for n in graph.nodes], bonds)), name


@pytest.mark.slow
def test_bridge_is_drawn_as_a_ring(examples: Any) -> None:
    graph = examples["bridge"]()
    board = Board([n.kind for n in graph.nodes], [(b.tail, b.head) for b in graph.bonds])
    for node, (x, y) in enumerate(layout(board.kinds, board.bonds)):
        board.put(node, (int(x), int(y)))
    assert board.defects() <= 1


def test_long_chain_is_folded(examples: Any) -> None:
    graph = examples["masses"]()
    at = layout([n.kind for n in graph.nodes], [(b.tail, b.head) for b in graph.bonds])
    assert max(x for x, _ in at) < 20


def test_pins_stay_and_others_keep_off() -> None:
    kinds = ["Se", "1", "I", "R"]
    bonds = [(0, 1), (1, 2), (1, 3)]
    at = layout(kinds, bonds, pinned={1: (4.5, -2.25), 2: (7, 7)})
    assert at[1] == (4.5, -2.25)
    assert at[2] == (7.0, 7.0)
    assert len(set(at)) == 4


def test_components_stand_side_by_side() -> None:
    kinds = ["1", "I", "1", "C"]
    at = layout(kinds, [(0, 1), (2, 3)])
    assert max(at[0][0], at[1][0]) < min(at[2][0], at[3][0])


def test_pinned_component_does_not_move_for_another() -> None:
    kinds = ["1", "I", "1", "C"]
    at = layout(kinds, [(0, 1), (2, 3)], pinned={0: (3, 3), 1: (3, 2)})
    assert at[:2] == ((3.0, 3.0), (3.0, 2.0))
    assert min(at[2][0], at[3][0]) > 3


def test_empty_and_lonely() -> None:
    assert layout([], []) == ()
    assert layout(["1"], []) == ((0.0, 0.0),)


@st.composite
def graphs(draw: Any) -> tuple[list[str], list[tuple[int, int]]]:
    count = draw(st.integers(1, 14))
    kinds = [draw(st.sampled_from(["0", "1", "C", "I", "R", "Se", "TF"])) for _ in range(count)]
    pairs = list(itertools.permutations(range(count), 2))
    bonds = draw(st.lists(st.sampled_from(pairs), max_size=18)) if pairs else []
    return kinds, bonds


@pytest.mark.slow
@given(graphs())
@settings(max_examples=25, deadline=None)
def test_any_graph_gets_distinct_cells_and_twice_the_same(graph: Any) -> None:
    kinds, bonds = graph
    at = layout(kinds, bonds)
    assert len(set(at)) == len(kinds)
    assert all(x == int(x) and y == int(y) for x, y in at)
    assert layout(kinds, bonds) == at


@given(graphs(), st.integers(0, 10**6))
@settings(max_examples=60, deadline=None)
def test_cost_of_a_part_tells_the_change_of_the_whole(graph: Any, seed: int) -> None:
    kinds, bonds = graph
    board = Board(kinds, bonds)
    rng = random.Random(seed)
    cells = [(x, y) for x in range(5) for y in range(5)]
    rng.shuffle(cells)
    for node in range(len(kinds)):
        board.put(node, cells[node])
    nodes = range(len(kinds))
    for _ in range(5):
        node, cell = rng.randrange(len(kinds)), cells[-1 - rng.randrange(8)]
        if cell in board.who:
            continue
        whole, part = board.cost(nodes), board.cost([node])
        assert board.least({node: cell}) >= 0
        board.move({node: cell})
        assert board.cost(nodes) - whole == board.cost([node]) - part


@pytest.mark.parametrize("kind", [Board, Streets])
@given(graphs(), st.integers(0, 10**6))
@settings(max_examples=60, deadline=None)
def test_a_move_that_is_refused_unmade_would_have_cost_too_much(
    kind: type[Board], graph: Any, seed: int
) -> None:
    kinds, pairs = graph
    bonds = list({frozenset(b): b for b in pairs}.values())
    board, rng = kind(kinds, bonds), random.Random(seed)
    cells = [(x, y) for x in range(5) for y in range(5)]
    rng.shuffle(cells)
    for node in range(len(kinds)):
        board.put(node, cells[node])
    for _ in range(8):
        moves = {
            n: c
            for n, c in zip(
                rng.sample(range(len(kinds)), min(2, len(kinds))), cells[-2:], strict=False
            )
            if c not in board.who
        }
        rng.shuffle(cells)
        least = board.least(moves)
        board.move(moves)
        board.best_turns(sorted({b for n in moves for b in board.bonds_of[n]}))
        assert least <= board.cost(moves)
        # what is remembered between moves is what a new board counts
        fresh = kind(kinds, bonds)
        for n, cell in enumerate(board.at):
            assert cell is not None
            fresh.put(n, cell)
        for b, way in enumerate(board.turns):
            fresh.turn(b, way)
        assert board.cost(range(len(kinds))) == fresh.cost(range(len(kinds)))


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), min_size=2, max_size=12))
@settings(max_examples=20, deadline=None)
def test_steps_that_a_slanted_bond_crosses_are_those_of_all_lines(places: Any) -> None:
    at = [(float(x), float(y)) for x, y in dict.fromkeys(places)]
    lines = _Lines(at, [], [])
    xs, ys, high = lines.xs, lines.ys, len(lines.ys)
    for p, q in itertools.combinations(at, 2):
        if p[0] == q[0] or p[1] == q[1]:
            continue
        every = set()
        for i, x in enumerate(xs):
            for j, y in enumerate(ys):
                if i + 1 < len(xs) and _cross(((x, y), (xs[i + 1], y)), (p, q)):
                    every.add(2 * (i * high + j))
                if j + 1 < high and _cross(((x, y), (x, ys[j + 1])), (p, q)):
                    every.add(2 * (i * high + j) + 1)
        assert set(lines._slant(p, q)) == every


def test_large_graph_is_laid_out() -> None:
    kinds = ["0", "1"] * 75 + ["R"] * 150
    bonds = [(k, k + 1) for k in range(149)] + [(k, 150 + k) for k in range(150)]
    at = layout(kinds, bonds)
    assert len(set(at)) == 300


@pytest.mark.slow
def test_seed_is_an_argument() -> None:
    kinds = ["1"] * 4
    bonds = [(a, b) for a in range(4) for b in range(a)]
    for seed in (1, 2, 3):
        assert layout(kinds, bonds, seed=seed) == layout(kinds, bonds, seed=seed)
