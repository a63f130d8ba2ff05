"""Random graphs, and the rules of causality written from their definitions."""

import itertools
from collections.abc import Iterator

from hypothesis import assume
from hypothesis import strategies as st

from hybond.model.graph import FlatGraph

LEAVES = ["C", "I", "R", "G", "Se", "Sf"]


@st.composite
def written(draw, *, tree: bool = False, junctions: int = 6, leaves: int = 3, switches: int = 3):
    """Draw the arguments of `build`: junctions joined by bonds, TF and GY, with leaves."""
    count = draw(st.integers(1, junctions))
    kinds = {f"n{k}": draw(st.sampled_from("01")) for k in range(count)}
    pairs = [(draw(st.integers(0, k - 1)), k) for k in range(1, count)]
    if not tree and count > 1:
        extra = st.tuples(st.integers(0, count - 1), st.integers(0, count - 1))
        pairs += [p for p in draw(st.lists(extra, max_size=count)) if p[0] != p[1]]
    bonds = []
    for k, (a, b) in enumerate(pairs):
        link = draw(st.sampled_from(["", "", "", "TF", "GY"]))
        if link:
            kinds[f"t{k}"] = link
            bonds += [f"n{a} -> t{k}", f"t{k} -> n{b}"]
        else:
            bonds.append(f"n{a} -> n{b}")
    for k in range(count):
        for j in range(draw(st.integers(0, leaves))):
            kinds[f"x{k}_{j}"] = draw(st.sampled_from(LEAVES))
            bonds.append(f"n{k} -> x{k}_{j}")
    assume(bonds)
    bonds = draw(st.permutations(bonds))
    names = list(kinds)
    order = draw(st.permutations(names))
    joined = {word for bond in bonds for word in bond.split(" -> ")}
    kinds = {name: kinds[name] for name in order if name in joined}
    able = [n for n in kinds if kinds[n] in ("0", "1", "TF", "GY")]
    return kinds, bonds, draw(st.lists(st.sampled_from(able), unique=True, max_size=switches))


def satisfied(graph: FlatGraph, off: frozenset[int], strokes: tuple[int, ...], node: int) -> bool:
    """Whether the strokes at a node obey its rule; written from the definitions."""
    n = graph.nodes[node]
    receives = [(strokes[e.bond] == 1) == e.inward for e in n.ends]
    effort_in = sum(receives)
    if n.kind == "Se":
        return effort_in == 0
    if n.kind == "Sf":
        return effort_in == len(receives)
    if n.kind == "0":
        return effort_in == (0 if node in off else 1)
    if n.kind == "1":
        return effort_in == len(receives) - (0 if node in off else 1)
    if n.kind == "TF":
        return receives == [False, True] if node in off else effort_in == 1
    if n.kind == "GY":
        return effort_in == 0 if node in off else effort_in != 1
    return True


def derivative_flags(graph: FlatGraph, strokes: tuple[int, ...]) -> tuple[bool, ...]:
    flags = []
    for s in graph.storages:
        receives_effort = (strokes[s.bond] == 1) == (s.sign > 0)
        flags.append(receives_effort if s.kind == "C" else not receives_effort)
    return tuple(flags)


def legal(graph: FlatGraph, off: frozenset[int]) -> Iterator[tuple[int, ...]]:
    """Yield every choice of strokes that obeys all rules, out of all 2^bonds."""
    for strokes in itertools.product((0, 1), repeat=len(graph.bonds)):
        if is_legal(graph, off, strokes):
            yield strokes


def is_legal(graph: FlatGraph, off: frozenset[int], strokes: tuple[int, ...]) -> bool:
    return all(not n.ends or satisfied(graph, off, strokes, n.index) for n in graph.nodes)


def modes(graph: FlatGraph) -> list[tuple[int, ...]]:
    return list(itertools.product(*(range(len(m.states)) for m in graph.machines)))
