"""Causal paths against ranks at random values, on random linear graphs.

The theorem (Sueur and Dauphin-Tanguy 1991) is about values that are independent of each other. A
ring of bare junctions is a ring of ones, whose products can cancel; there the strokes are only a
bound. With a modulus in each ring, and on trees, they must tell the rank exactly.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

sys.path.insert(0, str(Path(__file__).parent))

from whole_pencil import Net, random_net, whole, with_moduli_in_rings

from hybond.analysis.structure.controllability import controllability, observability
from hybond.analysis.structure.detectors import detected, paths_to
from hybond.analysis.structure.paths import paths
from hybond.equations.pencil import analyse

MANY = settings(max_examples=75, deadline=None, derandomize=True)
seeds = st.integers(0, 100_000)
sizes = st.integers(1, 7)


def compare(net: Net) -> tuple | None:
    """Return (paths, pencil, controllability); None if the mode has causal conflicts."""
    graph = net.model().flatten()
    strokes = paths(graph, graph.start_mode)
    pencil = analyse(whole(net))
    if strokes.conflicts or not pencil.regular:
        return strokes, pencil, None
    return strokes, pencil, controllability(pencil)


def at_rest(net: Net) -> int:
    """Return how many combinations no source moves at s = 0: the deficit of [A B]."""
    d = whole(net)
    values = np.linalg.svd(np.hstack([d.A, d.B]), compute_uv=False)
    return len(d.A) - int((values > 1e-9 * values[0]).sum())


def assert_told(net: Net) -> None:
    """Hold what paths tell against ranks."""
    strokes, pencil, reach = compare(net)
    assert pencil.regular == (not strokes.conflicts)
    if reach is not None:
        assert pencil.order == strokes.order
        assert reach.finite == strokes.controllable
        assert at_rest(net) == len(strokes.stuck)


@pytest.mark.slow
@MANY
@given(seeds, sizes, st.sampled_from([0.0, 0.3]))
def test_on_trees_paths_tell_the_rank(seed: int, size: int, controlled: float) -> None:
    net = random_net(seed, size, rings=0, controlled=controlled, sources=1.0, resistors=0.7)
    assert_told(net)


@pytest.mark.slow
@MANY
@given(seeds, sizes, st.integers(1, 4))
def test_with_a_modulus_in_each_ring_too(seed: int, size: int, rings: int) -> None:
    net = random_net(seed, size, rings=rings, controlled=0.0, sources=1.0, resistors=0.7)
    net = with_moduli_in_rings(net, seed)
    assert_told(net)


@pytest.mark.slow
@MANY
@given(seeds, sizes, st.integers(1, 4))
def test_in_bare_rings_paths_are_a_bound(seed: int, size: int, rings: int) -> None:
    net = random_net(seed, size, rings=rings, controlled=0.0, sources=1.0, resistors=0.7)
    strokes, pencil, reach = compare(net)
    if reach is not None:
        assert pencil.order <= strokes.order
        if reach.finite and pencil.order == strokes.order:
            assert strokes.controllable


@pytest.mark.slow
@MANY
@given(seeds, sizes, st.integers(0, 3), st.integers(1, 2), st.integers(0, 1000))
def test_paths_to_detectors_tell_the_observable_rank(
    seed: int, size: int, rings: int, count: int, pick: int
) -> None:
    net = random_net(seed, size, rings=rings, controlled=0.0, sources=1.0, resistors=0.7)
    net = with_moduli_in_rings(net, seed)
    elements = net.of("C", "I", "R", "G", "Se", "Sf")
    if not elements:
        return
    rng = np.random.default_rng(pick)
    chosen = [elements[k] for k in rng.integers(len(elements), size=count)]
    outputs = tuple(f"{n}.{v}" for n, v in zip(chosen, rng.choice(["e", "f"], count), strict=True))
    graph = net.model().flatten()
    wanted = [detected(graph, graph.read(name)) for name in outputs]
    strokes = paths_to(graph, graph.start_mode, wanted)
    pencil = analyse(whole(net, *outputs))
    if pencil.regular:
        assert observability(pencil).finite == strokes.controllable


def test_a_ring_of_ones_that_cancels() -> None:
    """The source's flow enters node k and leaves it again: strokes show a path, c gets nothing."""
    nodes: dict[str, tuple[str, object]] = {
        "J": ("Sf", (1.0, 0.0, 1.0)), "u": ("1", None), "v": ("1", None), "k": ("0", None),
        "c": ("C", 2.0), "r": ("R", 3.0),
    }  # fmt: skip
    bonds = [("J", "u"), ("u", "k"), ("k", "v"), ("v", "u"), ("k", "c"), ("k", "r")]
    strokes, pencil, reach = compare(Net(nodes, bonds))
    assert reach is not None
    assert (strokes.order, strokes.controllable) == (1, True)
    assert (pencil.order, reach.finite, reach.rank) == (1, False, 0)
    assert np.allclose(reach.modes, [-1 / 6])
