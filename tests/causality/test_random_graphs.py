"""Random graphs against rules written out again, exhaustive search and numeric rank."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from written_graphs import derivative_flags, satisfied, written

from hybond.causality.assign import assign
from hybond.model.graph import FlatGraph


def rule_nodes(graph: FlatGraph, off: frozenset[int], strokes: tuple[int, ...]) -> set[int]:
    return {n.index for n in graph.nodes if not satisfied(graph, off, strokes, n.index)}


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(written())
def test_rules_hold_wherever_no_conflict_is_reported(build, given_graph) -> None:
    kinds, bonds, switches = given_graph
    graph = build(kinds, bonds, switches=switches)
    mode = (0,) * len(switches)
    causality = assign(graph, mode)
    broken = rule_nodes(graph, graph.off_nodes(mode), causality.strokes)
    assert broken == {c.node for c in causality.conflicts}
    flags = derivative_flags(graph, causality.strokes)
    assert causality.derivative == tuple(k for k, flag in enumerate(flags) if flag)


@pytest.mark.slow
@settings(max_examples=200, deadline=None)
@given(written())
def test_chains_end_at_what_forces(build, given_graph) -> None:
    kinds, bonds, switches = given_graph
    graph = build(kinds, bonds, switches=switches)
    causality = assign(graph, (0,) * len(switches))
    for bond, reason in enumerate(causality.reasons):
        chain = causality.chain(bond)
        assert len(set(chain)) == len(chain)
        first = causality.reasons[chain[0]]
        assert (first.parent, first.via) == (-1, -1)
        assert first.origin == reason.origin
        assert reason.origin.node in causality.ends[chain[0]]
        for a, b in itertools.pairwise(chain):
            via = causality.reasons[b].via
            assert via in causality.ends[a] and via in causality.ends[b]
    for conflict in causality.conflicts:
        ends = [
            (conflict.chain_a, conflict.origin_a),
            (conflict.chain_b, conflict.origin_b),
        ]
        for chain, origin in ends:
            assert origin.node in causality.ends[chain[0]]
            assert conflict.node in causality.ends[chain[-1]]


@pytest.mark.slow
@settings(max_examples=200, deadline=None)
@given(written(), st.data())
def test_result_does_not_depend_on_arrows_or_names(build, given_graph, data) -> None:
    kinds, bonds, switches = given_graph
    mode = (0,) * len(switches)
    reverse = data.draw(st.sets(st.integers(0, len(bonds) - 1)))
    a = build(kinds, bonds, switches=switches)
    b = build(kinds, bonds, switches=switches, reverse=reverse)
    b = replace(
        b,
        nodes=tuple(replace(n, path=f"z{99 - n.index}") for n in b.nodes),
        by_path={f"z{99 - n.index}": n.index for n in b.nodes},
    )
    first, second = assign(a, mode), assign(b, mode)
    assert all(first.stroke_at(k) == second.stroke_at(k) for k in range(len(bonds)))
    assert first.reasons == second.reasons
    assert first.derivative == second.derivative
    assert first.loops == second.loops
    assert first.resistors == second.resistors
    assert [c.bonds for c in first.conflicts] == [c.bonds for c in second.conflicts]


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(written(junctions=5, leaves=2))
def test_finds_what_exhaustive_search_finds(build, given_graph) -> None:
    """A causality is found if there is one, and storage yields from the last one on."""
    kinds, bonds, switches = given_graph
    assume(len(bonds) <= 11)
    graph = build(kinds, bonds, switches=switches)
    mode = (0,) * len(switches)
    off = graph.off_nodes(mode)
    valid = [
        derivative_flags(graph, strokes)
        for strokes in itertools.product((0, 1), repeat=len(bonds))
        if all(len(n.ends) == 0 or satisfied(graph, off, strokes, n.index) for n in graph.nodes)
    ]
    causality = assign(graph, mode)
    assert (causality.conflicts == ()) == bool(valid)
    if valid:
        assert derivative_flags(graph, causality.strokes) == min(valid)


def equations(graph: FlatGraph, rng: np.random.Generator) -> np.ndarray:
    """Return the homogeneous equations of e and f of all bonds, sources set to zero."""
    m = len(graph.bonds)
    rows = []

    def row(*entries: tuple[int, float]) -> None:
        new = np.zeros(2 * m)
        for column, value in entries:
            new[column] += value
        rows.append(new)

    for n in graph.nodes:
        e, f = [end.bond for end in n.ends], [m + end.bond for end in n.ends]
        s = [end.sign for end in n.ends]
        value = rng.uniform(0.5, 2.0)
        if n.kind in ("0", "1"):
            same, summed = (e, f) if n.kind == "0" else (f, e)
            for k in same[1:]:
                row((same[0], 1.0), (k, -1.0))
            row(*zip(summed, map(float, s), strict=True))
        elif n.kind == "TF":
            row((e[0], 1.0), (e[1], -value))
            row((f[1], s[1]), (f[0], value * s[0]))
        elif n.kind == "GY":
            row((e[0], 1.0), (f[1], value * s[1]))
            row((e[1], 1.0), (f[0], -value * s[0]))
        elif n.kind == "Se":
            row((e[0], 1.0))
        elif n.kind == "Sf":
            row((f[0], 1.0))
        elif n.kind in ("R", "G"):
            row((e[0], 1.0), (f[0], -value * s[0]))
    return np.array(rows)


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(written(tree=True, junctions=8, leaves=3, switches=0), st.integers(0, 1000))
def test_derivative_storage_is_the_rank_deficiency(build, given_graph, seed) -> None:
    """On trees the stored co-energies that can be set freely are those in integral causality."""
    kinds, bonds, _ = given_graph
    graph = build(kinds, bonds)
    causality = assign(graph, ())
    assume(not causality.conflicts and graph.storages)
    matrix = equations(graph, np.random.default_rng(seed))
    _, values, vectors = np.linalg.svd(matrix)
    null = vectors[int(np.sum(values > 1e-9)) :]
    m = len(bonds)
    columns = [s.bond if s.kind == "C" else m + s.bond for s in graph.storages]
    free = np.linalg.matrix_rank(null[:, columns], tol=1e-9) if len(null) else 0
    assert len(causality.derivative) == len(graph.storages) - free
