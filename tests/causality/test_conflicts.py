"""Conflicts name both forcing elements, the bonds between them and the switches."""

import pytest
from mode_strokes import mode_dependent

from hybond.causality.assign import assign
from hybond.causality.explain import chain, conflict_error, describe_conflict
from hybond.causality.record import changed
from hybond.errors import CausalityError


def only(graph, mode=()):
    causality = assign(graph, mode)
    assert len(causality.conflicts) == 1
    assert -1 not in causality.strokes
    return causality.conflicts[0]


def ends(graph, conflict):
    return {graph.nodes[o.node].path for o in (conflict.origin_a, conflict.origin_b)}


def each_way(build, kinds, bonds, **options):
    every = range(len(bonds))
    for reverse in [(), *((k,) for k in every), tuple(every)]:
        yield build(kinds, bonds, reverse=reverse, **options)


def test_two_effort_sources_on_a_0_junction(build) -> None:
    kinds = {"V": "Se", "W": "Se", "s": "0", "r": "R"}
    for graph in each_way(build, kinds, ["V -> s", "W -> s", "s -> r"]):
        conflict = only(graph)
        assert (conflict.kind, conflict.node) == ("over", graph.by_path["s"])
        assert (conflict.chain_a, conflict.chain_b) == ((0,), (1,))
        assert ends(graph, conflict) == {"V", "W"}
        assert conflict.switches == ()
    graph = build(kinds, ["V -> s", "W -> s", "s -> r"])
    assert describe_conflict(graph, (), only(graph)) == (
        "Se V imposes effort on 0-junction s through 'V -> s', and so does Se W through 'W -> s'."
    )
    error = conflict_error(graph, (), only(graph))
    assert isinstance(error, CausalityError)
    assert (error.code, error.where) == ("HB-C101", "s")
    assert error.hint == "put a resistor between Se V and Se W"


def test_two_flow_sources_far_apart_on_1_junctions(build) -> None:
    kinds = {"J": "Sf", "a": "1", "t": "TF", "b": "1", "K": "Sf", "l": "I", "r": "R"}
    bonds = ["J -> a", "a -> l", "a -> t", "t -> b", "b -> r", "K -> b"]
    for graph in each_way(build, kinds, bonds):
        conflict = only(graph)
        assert conflict.kind == "over"
        assert conflict.gives == ("f", "f")
        assert ends(graph, conflict) == {"J", "K"}
        assert {conflict.chain_a[0], conflict.chain_b[0]} == {0, 5}
        assert set(conflict.chain_a + conflict.chain_b) == {0, 2, 3, 5}
        assert conflict.chain_a[-1] != conflict.chain_b[-1]


def test_switch_that_shorts_a_source_is_named(build) -> None:
    kinds = {"V": "Se", "sw": "1", "s": "0", "W": "Se", "c": "C"}
    bonds = ["V -> sw", "sw -> s", "s -> W", "s -> c"]
    graph = build(kinds, bonds, switches=["sw"])
    assert assign(graph, (0,)).conflicts == ()
    conflict = only(graph, (1,))
    assert (conflict.kind, conflict.node) == ("over", graph.by_path["s"])
    assert conflict.switches == (("sw", True),)
    error = conflict_error(graph, (1,), conflict)
    assert error.code == "HB-C101"
    assert error.where == "s in mode (m_sw = closed)"
    assert error.why == (
        "Se W imposes effort on 0-junction s through 's -> W', and so does Se V through "
        "'V -> sw', 'sw -> s'; switches: m_sw = closed."
    )
    assert error.hint == "put a resistor between Se W and Se V, or change the rules of m_sw"


def test_two_effort_sources_on_one_1_junction_leave_no_flow(build) -> None:
    graph = build({"V": "Se", "j": "1", "W": "Se"}, ["V -> j", "j -> W"], switches=["j"])
    conflict = only(graph, (1,))
    assert describe_conflict(graph, (1,), conflict) == (
        "No bond gives 1-junction j its flow: Se V imposes effort on 1-junction j through "
        "'V -> j', and so does Se W through 'j -> W'; switches: m_j = closed."
    )
    error = conflict_error(graph, (1,), conflict)
    assert error.code == "HB-C102"
    assert error.hint == "connect a resistor to 1-junction j, or change the rules of m_j"


def test_open_0_junction_shorts_a_source_directly(build) -> None:
    kinds = {"V": "Se", "short": "0", "r": "R"}
    for graph in each_way(build, kinds, ["V -> short", "short -> r"], switches=["short"]):
        assert assign(graph, (1,)).conflicts == ()
        conflict = only(graph, (0,))
        assert (conflict.kind, conflict.bonds) == ("over", (0,))
        assert conflict.chain_a == conflict.chain_b == (0,)
        assert conflict.origin_b.rule == "off"
        assert conflict.switches == (("short", False),)
    graph = build(kinds, ["V -> short", "short -> r"], switches=["short"])
    assert describe_conflict(graph, (0,), only(graph, (0,))) == (
        "Se V imposes effort on the bond 'V -> short', and so does OFF 0-junction short; "
        "switches: m_short = open."
    )


def test_open_0_junction_shorts_a_source_through_a_node(build) -> None:
    kinds = {"V": "Se", "s": "0", "short": "0", "r": "R"}
    graph = build(kinds, ["V -> s", "s -> short", "short -> r"], switches=["short"])
    assert describe_conflict(graph, (0,), only(graph, (0,))) == (
        "Se V imposes effort on 0-junction s through 'V -> s', and so does OFF 0-junction short "
        "through 's -> short'; switches: m_short = open."
    )


def test_node_between_open_switches_floats(build) -> None:
    kinds = {"V": "Se", "a": "1", "s": "0", "b": "1", "r": "R"}
    bonds = ["V -> a", "a -> s", "s -> b", "b -> r"]
    for graph in each_way(build, kinds, bonds, switches=["a", "b"]):
        conflict = only(graph, (0, 0))
        assert (conflict.kind, conflict.node) == ("under", graph.by_path["s"])
        assert ends(graph, conflict) == {"a", "b"}
        assert conflict.switches == (("a", False), ("b", False))
        assert conflict_error(graph, (0, 0), conflict).code == "HB-C102"


def test_parallel_closed_switches_are_named_and_no_others(build) -> None:
    """Three bare switches between two nodes: a flow each, and two nodes to give them."""
    kinds = {"a": "0", "b": "0", "p": "C", "q": "C", "x": "1", "y": "1", "z": "1"}
    kinds |= {"far": "1", "w": "0", "c": "C", "r": "R"}
    bonds = ["a -> p", "b -> q", "b -> far", "far -> w", "w -> c", "far -> r"]
    for name in "xyz":
        bonds += [f"a -> {name}", f"{name} -> b"]
    graph = build(kinds, bonds, switches=["x", "y", "z", "far"])
    conflict = only(graph, (1, 1, 1, 1))
    assert conflict.kind == "under"
    assert conflict.switches == (("x", True), ("y", True), ("z", True))
    for k in range(3):
        assert assign(graph, tuple(int(i != k) for i in range(4))).conflicts == ()


@pytest.mark.slow
def test_conflict_in_a_long_ladder_is_told_by_its_own_chain(build) -> None:
    kinds, bonds = {"V": "Se"}, []
    for k in range(1000):
        kinds |= {f"j{k}": "1", f"r{k}": "R", f"n{k}": "0", f"c{k}": "C"}
        bonds += [f"n{k - 1} -> j{k}" if k else "V -> j0", f"j{k} -> r{k}", f"j{k} -> n{k}"]
        bonds.append(f"n{k} -> c{k}")
    kinds |= {"W": "Se", "sw": "1", "U": "Se"}
    bonds += ["W -> n500", "sw -> n500", "U -> sw"]
    graph = build(kinds, bonds, switches=["sw"])
    assert assign(graph, (0,)).conflicts == ()
    conflict = only(graph, (1,))
    assert describe_conflict(graph, (1,), conflict) == (
        "No bond gives 1-junction sw its flow: Se W imposes effort on 1-junction sw through "
        "'W -> n500', 'sw -> n500', and so does Se U through 'U -> sw'; switches: m_sw = closed."
    )


def test_gyrator_between_an_effort_and_a_flow_source(build) -> None:
    kinds = {"V": "Se", "g": "GY", "J": "Sf"}
    for graph in each_way(build, kinds, ["V -> g", "g -> J"]):
        conflict = only(graph)
        assert conflict.kind == "over"
        assert set(conflict.gives) == {"e", "f"}
        assert "which the gyrator makes the same" in describe_conflict(graph, (), conflict)


def test_transformer_between_two_effort_sources(build) -> None:
    for graph in each_way(build, {"V": "Se", "t": "TF", "W": "Se"}, ["V -> t", "t -> W"]):
        conflict = only(graph)
        assert (conflict.kind, conflict.gives) == ("over", ("e", "e"))
        assert ends(graph, conflict) == {"V", "W"}


def test_three_sources_on_a_node_are_two_conflicts(build) -> None:
    kinds = {"U": "Se", "V": "Se", "W": "Se", "s": "0"}
    causality = assign(build(kinds, ["U -> s", "V -> s", "W -> s"]), ())
    assert [c.bonds for c in causality.conflicts] == [(0, 1), (0, 2)]


def test_conflict_elsewhere_does_not_disturb_a_part(build) -> None:
    kinds = {"V": "Se", "W": "Se", "s": "0", "u": "Se", "j": "1", "l": "I", "r": "R"}
    graph = build(kinds, ["V -> s", "W -> s", "u -> j", "j -> l", "j -> r"])
    causality = assign(graph, ())
    assert len(causality.conflicts) == 1
    assert causality.derivative == causality.loops == ()


def test_many_machines_are_not_all_listed(build) -> None:
    kinds = {"V": "Se", "W": "Se", "s": "0"}
    bonds = ["V -> s", "W -> s"]
    for k in range(12):
        kinds |= {f"U{k}": "Se", f"q{k}": "1", f"z{k}": "R"}
        bonds += [f"U{k} -> q{k}", f"q{k} -> z{k}"]
    graph = build(kinds, bonds, switches=[f"q{k}" for k in range(12)])
    assert conflict_error(graph, (1,) * 12, only(graph, (1,) * 12)).where == "s in mode (...)"


@pytest.mark.parametrize(
    ("kinds", "bonds", "bond", "lines"),
    [
        (
            {"V": "Se", "s": "0", "c": "C"},
            ["V -> s", "s -> c"],
            1,
            ["'V -> s': fixed by Se:V", "'s -> c': propagated from 0:s"],
        ),
        (
            {"a": "R", "b": "R"},
            ["a -> b"],
            0,
            ["'a -> b': chosen in the direction of the law of R:a"],
        ),
        (
            {"c": "C", "end": "0"},
            ["c -> end"],
            0,
            ["'c -> end': fixed by 0:end, which has one bond"],
        ),
        ({"c": "C", "r": "R"}, ["c -> r"], 0, ["'c -> r': preferred by C:c"]),
    ],
)
def test_chain_in_words(build, kinds, bonds, bond, lines) -> None:
    graph = build(kinds, bonds)
    assert chain(graph, assign(graph, ()), bond) == lines


def test_chain_says_what_ruled_integral_causality_out(build) -> None:
    kinds = {"a": "0", "b": "0"}
    bonds = []
    for k in range(3):
        kinds |= {f"j{k}": "1", f"c{k}": "C"}
        bonds += [f"a -> j{k}", f"j{k} -> b", f"j{k} -> c{k}"]
    graph = build(kinds, bonds)
    assert chain(graph, assign(graph, ()), 8) == [
        "'j2 -> c2': derivative for C:c2, since integral causality conflicts with "
        "'j0 -> c0', 'j1 -> c1'"
    ]


def test_mode_dependent_strokes(build) -> None:
    kinds = {"V": "Se", "sw": "1", "s": "0", "r": "R", "c": "C"}
    graph = build(kinds, ["V -> sw", "sw -> s", "sw -> r", "s -> c"], switches=["sw"])
    off, on = assign(graph, (0,)), assign(graph, (1,))
    assert changed(graph, off, on) == (2,)
    assert mode_dependent(graph, [(0,), (1,)]) == {2: (off.strokes[2], on.strokes[2])}
    assert mode_dependent(graph, [(1,)]) == {}
    assert mode_dependent(graph, []) == {}
