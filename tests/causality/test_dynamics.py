"""What is said of all modes, against all modes."""

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from written_graphs import legal, modes, written

from hybond.causality.dynamics import causality_of, dynamics, unchanging
from hybond.causality.reference import reference_mode
from hybond.causality.strokes import Strokes


@pytest.mark.slow
@settings(max_examples=120, deadline=None)
@given(written(junctions=5, leaves=2))
def test_invariant_strokes_are_those_of_every_causality_of_every_mode(build, given_graph) -> None:
    kinds, bonds, switches = given_graph
    assume(len(bonds) <= 9)
    graph = build(kinds, bonds, switches=switches)
    forced = unchanging(graph)
    for mode in modes(graph):
        for strokes in legal(graph, graph.off_nodes(mode)):
            assert all(strokes[bond] == stroke for bond, stroke in forced)


@settings(max_examples=80, deadline=None)
@given(written(junctions=8, leaves=2))
def test_dynamic_bonds_are_those_that_switching_flips(build, given_graph) -> None:
    kinds, bonds, switches = given_graph
    graph = build(kinds, bonds, switches=switches)
    found = dynamics(graph)
    reference = found.reference
    assert set(found.invariant) | set(found.dynamic) | set(found.kept) == set(range(len(bonds)))
    assert len(found.kinds) == len(bonds)
    assert list(found.through) == list(found.dynamic)
    if reference.causality.conflicts:
        return
    flipped, late = set(), set()
    for m in range(len(graph.machines)):
        mode = tuple(1 - k if i == m else k for i, k in enumerate(reference.mode))
        causality = causality_of(graph, mode, reference=reference)
        if causality.conflicts:
            assert (m, mode[m]) in found.without
            continue
        pairs = zip(causality.strokes, reference.causality.strokes, strict=True)
        here = {b for b, (new, old) in enumerate(pairs) if new != old}
        assert all(graph.by_path[switches[m]] in found.through[b] for b in here)
        flipped |= here
        late |= set(causality.derivative) ^ set(reference.causality.derivative)
    assert flipped <= set(found.dynamic)
    assert late <= set(found.storages)
    listed = [bond for region in found.regions for bond in region.bonds]
    assert sorted(listed) == list(found.dynamic)
    for region in found.regions:
        assert set(region.switches) == {n for b in region.bonds for n in found.through[b]}


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(written(junctions=6, leaves=2), st.randoms(use_true_random=False))
def test_invariant_bonds_do_not_depend_on_the_order_of_elements(build, given_graph, random) -> None:
    kinds, bonds, switches = given_graph
    assume(len(set(bonds)) == len(bonds))
    assume(not any(kinds[n] in ("TF", "GY") for n in switches))
    names, shuffled = list(kinds), list(bonds)
    random.shuffle(names)
    random.shuffle(shuffled)
    first = build(kinds, bonds, switches=switches)
    second = build({n: kinds[n] for n in names}, shuffled, switches=switches)
    named = [
        {(frozenset(graph.bonds[b].name.split(" -> ")), stroke == 1) for b, stroke in forced}
        for graph, forced in ((first, unchanging(first)), (second, unchanging(second)))
    ]
    # Named by both ends: `build` may turn an arrow, and with it what HEAD means.
    assert {bond for bond, _ in named[0]} == {bond for bond, _ in named[1]}


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(written(junctions=10, leaves=2), st.data())
def test_causality_of_a_mode_does_not_depend_on_the_way_there(build, given_graph, data) -> None:
    kinds, bonds, switches = given_graph
    assume(switches)
    graph = build(kinds, bonds, switches=switches)
    every, reference = modes(graph), reference_mode(graph)
    mode = data.draw(st.sampled_from(every))
    shown = causality_of(graph, mode, reference=reference)
    for other in data.draw(st.lists(st.sampled_from(every), max_size=3)):
        causality_of(graph, other, reference=reference)
    assert causality_of(graph, mode, reference=reference) == shown
    fresh = Strokes(graph, mode)
    assert bool(shown.conflicts) == fresh.conflict
    if not fresh.conflict:
        assert len(shown.derivative) == fresh.dependent


def test_neighbouring_switches_are_examined_together(build) -> None:
    """Clutches in a row: each by itself, and each with the next, but not all modes of the row."""
    for clutches in (2, 12):
        kinds, bonds = {}, []
        for k in range(clutches + 1):
            kinds |= {f"v{k}": "1", f"m{k}": "I"}
            bonds.append(f"v{k} -> m{k}")
        for k in range(clutches):
            kinds[f"z{k}"] = "0"
            bonds += [f"v{k} -> z{k}", f"z{k} -> v{k + 1}"]
        graph = build(kinds, bonds, switches=[f"z{k}" for k in range(clutches)])
        found = dynamics(graph)
        assert found.reference.mode == (0,) * clutches
        # two clutches have four modes in all; of twelve the first 64 reachable ones are added
        assert found.examined >= clutches + (clutches - 1)
        assert found.examined <= (3 if clutches == 2 else clutches + (clutches - 1) + 64)
        # One mass follows per clutch that engages; where more may, one of them is seen to.
        assert len(found.storages) == clutches
        assert all(region.whole for region in found.regions)


def test_a_source_behind_a_switch(build) -> None:
    kinds = {"V": "Se", "sw": "1", "s": "0", "r": "R", "c": "C", "W": "Se", "t": "0", "d": "R"}
    bonds = ["V -> sw", "sw -> s", "sw -> r", "s -> c", "W -> t", "t -> d"]
    graph = build(kinds, bonds, switches=["sw"])
    found = dynamics(graph)
    # Nobody but the resistor can give the flow when the switch is closed; the capacitor keeps
    # its own causality, which only its own preference gives it.
    assert [found.kinds[b] for b in range(6)] == [
        "invariant",
        "kept",
        "dynamic",
        "kept",
        "invariant",
        "invariant",
    ]
    assert found.through == {2: (graph.by_path["sw"],)}
    assert found.storages == ()
