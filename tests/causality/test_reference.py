"""The reference mode against all modes, one by one."""

from dataclasses import replace

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from written_graphs import modes, written

from hybond.causality.reference import reference_mode
from hybond.causality.strokes import Strokes
from hybond.model.graph import FlatGraph, Machine, Mode


def score(graph: FlatGraph, mode: Mode) -> tuple[int, int, int] | None:
    """Integral storages, junctions and two-ports ON, machines in their start state."""
    strokes = Strokes(graph, mode)
    if strokes.conflict:
        return None
    started = sum(m.start == k for m, k in zip(graph.machines, mode, strict=True))
    return len(graph.storages) - strokes.dependent, len(graph.on_nodes(mode)), started


def best(graph: FlatGraph) -> tuple[int, int, int] | None:
    return max((s for s in (score(graph, m) for m in modes(graph)) if s), default=None)


def few_sources(kinds: dict[str, str]) -> dict[str, str]:
    """Turn most sources into resistors: hardly any mode has a causality otherwise."""
    return {n: "R" if k[0] == "S" and int(n[-1]) else k for n, k in kinds.items()}


def started(graph: FlatGraph, starts: list[int]) -> FlatGraph:
    machines = (replace(m, start=k) for m, k in zip(graph.machines, starts, strict=False))
    return replace(graph, machines=tuple(machines))


def grouped(graph: FlatGraph, draw) -> FlatGraph:
    """Let machines switch several nodes together, in states drawn at random."""
    left = [n.index for n in graph.nodes if n.controlled]
    machines, nodes = [], list(graph.nodes)
    while left:
        count = draw(st.integers(1, min(3, len(left))))
        group, left = left[:count], left[count:]
        sets = draw(st.lists(st.frozensets(st.sampled_from(group)), min_size=1, max_size=3))
        missing = frozenset(group).difference(*sets)
        sets += [missing] if missing else []
        states, index = tuple(f"s{k}" for k in range(len(sets))), len(machines)
        start = draw(st.integers(0, len(sets) - 1))
        machines.append(Machine(index, f"m{index}", states, tuple(sets), start, ()))
        for n in group:
            nodes[n] = replace(nodes[n], machine=index)
    return replace(graph, machines=tuple(machines), nodes=tuple(nodes))


@pytest.mark.slow
@settings(max_examples=80, deadline=None)
@given(written(junctions=10, leaves=2, switches=7), st.lists(st.integers(0, 1), min_size=7))
def test_no_mode_is_better_switch_by_switch(build, given_graph, starts) -> None:
    kinds, bonds, switches = given_graph
    assume(switches)
    graph = started(build(few_sources(kinds), bonds, switches=switches), starts)
    found, most = reference_mode(graph), best(graph)
    if most is None:
        assert found.how == "no mode has a causality"
    else:
        assert score(graph, found.mode) == most
        assert found.how == "proved best"
        assert found.integral == most[0]
        assert not found.causality.conflicts


@pytest.mark.slow
@settings(max_examples=10, deadline=None)
@given(written(junctions=14, leaves=2, switches=0), st.randoms(use_true_random=False))
def test_no_mode_of_ten_switches_is_better(build, given_graph, random) -> None:
    kinds, bonds, _ = given_graph
    able = sorted(n for n, kind in kinds.items() if kind in ("0", "1", "TF", "GY"))
    switches = random.sample(able, min(10, len(able)))
    graph = build(few_sources(kinds), bonds, switches=switches)
    most, mode = best(graph), reference_mode(graph).mode
    assert most is None or score(graph, mode) == most


@pytest.mark.slow
@settings(max_examples=80, deadline=None)
@given(written(junctions=10, leaves=2, switches=6), st.data())
def test_no_mode_is_better_where_machines_switch_several(build, given_graph, data) -> None:
    kinds, bonds, switches = given_graph
    assume(switches)
    graph = grouped(build(few_sources(kinds), bonds, switches=switches), data.draw)
    found, most = reference_mode(graph), best(graph)
    if most is None:
        assert found.causality.conflicts
    else:
        assert found.how == "proved best"
        assert found.integral == most[0]


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(written(junctions=8, leaves=2, switches=5), st.randoms(use_true_random=False))
def test_mode_does_not_depend_on_the_order_of_elements(build, given_graph, random) -> None:
    kinds, bonds, switches = given_graph
    assume(switches and not any(kinds[n] in ("TF", "GY") for n in switches))
    first = build(kinds, bonds, switches=switches)
    names, shuffled, machines = list(kinds), list(bonds), list(switches)
    for each in (names, shuffled, machines):
        random.shuffle(each)
    second = build({n: kinds[n] for n in names}, shuffled, switches=machines)
    a, b = reference_mode(first), reference_mode(second)
    assert (a.integral, a.how) == (b.integral, b.how)
    assert score(first, a.mode) == score(second, b.mode)


def test_ties_go_to_junctions_on_then_to_the_start(build) -> None:
    kinds = {"V": "Se", "a": "1", "n": "0", "b": "1", "W": "Se"}
    graph = build(kinds, ["V -> a", "a -> n", "n -> b", "b -> W"], switches=["a", "b"])
    # Either switch may be closed, not both: two sources; nor neither: the node would float.
    for start in ((0, 1), (1, 0)):
        assert reference_mode(started(graph, list(start))).mode == start
    # The builder starts both closed; then names decide.
    assert reference_mode(graph).mode == (1, 0)


def test_the_user_decides(build) -> None:
    kinds = {"a": "I", "v": "1", "z": "0", "w": "1", "b": "I"}
    graph = build(kinds, ["v -> a", "v -> z", "z -> w", "w -> b"], switches=["z"])
    best = reference_mode(graph)
    assert (best.mode, best.integral, best.how) == ((0,), 2, "proved best")
    for given_mode in (
        reference_mode(graph, mode=(1,)),
        reference_mode(replace(graph, reference=(1,))),
    ):
        assert (given_mode.mode, given_mode.integral) == ((1,), 1)
        assert given_mode.how == "given by the user"


@pytest.mark.parametrize("switches", [60, 300])
def test_many_switches_are_not_enumerated(build, switches: int) -> None:
    """A chain of masses with a clutch at every joint."""
    kinds, bonds = {}, []
    for k in range(switches + 1):
        kinds |= {f"v{k}": "1", f"m{k}": "I"}
        bonds.append(f"v{k} -> m{k}")
    for k in range(switches):
        kinds[f"z{k}"] = "0"
        bonds += [f"v{k} -> z{k}", f"z{k} -> v{k + 1}"]
    graph = build(kinds, bonds, switches=[f"z{k}" for k in range(switches)])
    found = reference_mode(graph)
    assert found.mode == (0,) * switches
    assert found.integral == switches + 1
    assert found.steps == 1
