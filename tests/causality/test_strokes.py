"""Strokes that follow the mode: against all strokes there are, and against a fresh start."""

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from written_graphs import derivative_flags, is_legal, legal, modes, written

from hybond.causality.arrays import compile_arrays
from hybond.causality.assign import assign
from hybond.causality.matching import Matching
from hybond.causality.record import HEAD, TAIL
from hybond.causality.strokes import Strokes


@pytest.mark.slow
@settings(max_examples=120, deadline=None)
@given(written(junctions=5, leaves=2), st.data())
def test_each_switch_ends_where_exhaustive_search_ends(build, given_graph, data) -> None:
    kinds, bonds, switches = given_graph
    assume(len(bonds) <= 10 and switches)
    graph = build(kinds, bonds, switches=switches)
    every = modes(graph)
    least: dict[tuple[int, ...], int | None] = {}
    for mode in every:
        found = [sum(derivative_flags(graph, s)) for s in legal(graph, graph.off_nodes(mode))]
        least[mode] = min(found, default=None)
    strokes = Strokes(graph, data.draw(st.sampled_from(every)))
    for mode in data.draw(st.lists(st.sampled_from(every), min_size=1, max_size=8)):
        before = list(strokes.strokes)
        changed = strokes.switch(mode)
        assert strokes.mode == mode
        assert changed == tuple(b for b in range(len(bonds)) if before[b] != strokes.strokes[b])
        assert strokes.conflict == (least[mode] is None)
        if not strokes.conflict:
            assert is_legal(graph, graph.off_nodes(mode), tuple(strokes.strokes))
            flags = derivative_flags(graph, tuple(strokes.strokes))
            assert strokes.derivative == tuple(k for k, flag in enumerate(flags) if flag)
            assert strokes.dependent == least[mode]


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(written(junctions=25, leaves=2, switches=10), st.data())
def test_switching_is_as_good_as_starting_afresh(build, given_graph, data) -> None:
    """Larger graphs, where trees of failed searches meet; some switchings are taken back."""
    kinds, bonds, switches = given_graph
    assume(switches)
    # Few sources, or hardly any mode has a causality.
    kinds = {n: "R" if k[0] == "S" and int(n[-1]) else k for n, k in kinds.items()}
    graph = build(kinds, bonds, switches=switches)
    arrays = compile_arrays(graph)
    strokes = Strokes(graph, graph.start_mode, arrays=arrays)
    machine = st.integers(0, len(switches) - 1)
    for several in data.draw(st.lists(st.lists(machine, max_size=3), min_size=1, max_size=12)):
        before, was = list(strokes.strokes), (strokes.mode, strokes.derivative, strokes.conflict)
        strokes.turn({m: 1 - strokes.states[m] for m in several})
        if len(several) == 2:
            strokes.undo()
            assert strokes.strokes == before
            assert was == (strokes.mode, strokes.derivative, strokes.conflict)
        fresh = Strokes(graph, strokes.mode, arrays=arrays)
        assert strokes.conflict == fresh.conflict
        if not strokes.conflict:
            assert is_legal(graph, graph.off_nodes(strokes.mode), tuple(strokes.strokes))
            assert strokes.dependent == fresh.dependent


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(written(junctions=8, leaves=2), st.data())
def test_record_accounts_for_the_strokes_it_has(build, given_graph, data) -> None:
    kinds, bonds, switches = given_graph
    assume(switches)
    graph = build(kinds, bonds, switches=switches)
    every = modes(graph)
    strokes = Strokes(graph, every[0])
    for mode in data.draw(st.lists(st.sampled_from(every), min_size=1, max_size=4)):
        strokes.switch(mode)
        record, fresh = strokes.record(), assign(graph, mode)
        assert bool(record.conflicts) == bool(fresh.conflicts)
        if record.conflicts:
            # Told as from scratch, whatever the past.
            assert record == fresh
            continue
        assert list(record.strokes) == strokes.strokes
        assert record.derivative == strokes.derivative
        for bond, reason in enumerate(record.reasons):
            chain = record.chain(bond)
            assert len(set(chain)) == len(chain)
            assert reason.origin.node in record.ends[chain[0]]
            assert all(record.reasons[b].parent < 0 for b in reason.ruled_out)


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(written(junctions=8, leaves=2), st.randoms(use_true_random=False))
def test_numbers_do_not_depend_on_the_order_of_elements(build, given_graph, random) -> None:
    kinds, bonds, switches = given_graph
    names, shuffled = list(kinds), list(bonds)
    random.shuffle(names)
    random.shuffle(shuffled)
    if any(kinds[n] in ("TF", "GY") for n in switches):
        shuffled = bonds  # the order of the bonds numbers the ports, which are not alike when OFF
    first = build(kinds, bonds, switches=switches)
    second = build({n: kinds[n] for n in names}, shuffled, switches=switches)
    for mode in modes(first):
        a, b = Strokes(first, mode), Strokes(second, mode)
        assert a.conflict == b.conflict
        assert a.conflict or a.dependent == b.dependent


def test_conflict_is_left_again(build) -> None:
    kinds = {"V": "Se", "sw": "1", "s": "0", "W": "Se", "c": "C"}
    graph = build(kinds, ["V -> sw", "sw -> s", "s -> W", "s -> c"], switches=["sw"])
    strokes = Strokes(graph, (0,))
    start = list(strokes.strokes)
    strokes.switch((1,))
    assert strokes.conflict
    assert strokes.record() == assign(graph, (1,))
    strokes.switch((0,))
    assert not strokes.conflict
    assert strokes.strokes == start


def test_pins_hold_in_every_mode(build) -> None:
    kinds = {"a": "0", "sw": "1", "b": "0", "c": "C", "d": "C"}
    bonds = ["c -> a", "a -> sw", "sw -> b", "b -> d"]
    graph = build(kinds, bonds, switches=["sw"])
    for stroke, late in ((HEAD, (1,)), (TAIL, (0,))):
        # Closed, the switch ties two capacitors together; the pin says which one follows.
        strokes = Strokes(graph, (0,), pins={1: stroke})
        assert strokes.conflict == (stroke == TAIL)
        strokes.switch((1,))
        assert strokes.derivative == late
        assert strokes.strokes[1] == stroke


def test_odd_ring_of_gyrators_needs_a_blossom(build) -> None:
    """Three 0-junctions joined by gyrators: an odd cycle, so one inertia cannot be integral.

    A gyrator gives the effort of both its neighbours or of neither, so the ring serves two of
    the three nodes; the third takes its effort from its inertia.
    """
    kinds = {f"n{k}": "0" for k in range(3)} | {f"g{k}": "GY" for k in range(3)}
    kinds |= {f"x{k}": "I" for k in range(3)}
    bonds = [f"n{k} -> x{k}" for k in range(3)]
    for k in range(3):
        bonds += [f"n{k} -> g{k}", f"g{k} -> n{(k + 1) % 3}"]
    graph = build(kinds, bonds)
    causality = assign(graph, ())
    best = min(sum(derivative_flags(graph, s)) for s in legal(graph, frozenset()))
    assert causality.conflicts == ()
    assert len(causality.derivative) == best == 1


@pytest.fixture
def seen(monkeypatch) -> list[int]:
    """Return a list with the vertices that the searches branched at, one entry per search."""
    search = Matching._search
    counts: list[int] = []

    def counted(self, *args, **options):
        end = search(self, *args, **options)
        counts.append(len(self.seen))
        return end

    monkeypatch.setattr(Matching, "_search", counted)
    return counts


def test_cost_of_a_switch_does_not_grow_with_the_graph(build, seen) -> None:
    """In a ladder a switch is a matter of its own rung."""
    costs = []
    for rungs in (50, 500):
        kinds, bonds = {"V": "Se"}, []
        for k in range(rungs):
            kinds |= {f"j{k}": "1", f"r{k}": "R", f"n{k}": "0", f"s{k}": "1", f"c{k}": "C"}
            bonds += [f"n{k - 1} -> j{k}" if k else "V -> j0", f"j{k} -> r{k}", f"j{k} -> n{k}"]
            bonds += [f"n{k} -> s{k}", f"s{k} -> c{k}"]
        graph = build(kinds, bonds, switches=[f"s{k}" for k in range(rungs)])
        strokes = Strokes(graph, (1,) * rungs)
        seen.clear()
        for k in range(10, 30):
            strokes.turn({k: 0})
        costs.append(sum(seen))
    assert 0 < costs[0] == costs[1] < 20 * 50


def test_searches_that_must_fail_are_not_all_repeated(build, seen) -> None:
    """A mesh of ideal capacitors: of each loop one cannot be integral, whatever is switched."""
    costs = []
    for side in (8, 24):
        kinds, bonds, switches = {}, [], []
        for k in range(side * side):
            kinds[f"n{k}"] = "0"
            right = [k + 1] if (k + 1) % side else []
            down = [k + side] if k + side < side * side else []
            for other in right + down:
                name = f"{k}_{other}"
                kinds |= {f"j{name}": "1", f"c{name}": "C"}
                bonds += [f"n{k} -> j{name}", f"j{name} -> n{other}", f"j{name} -> c{name}"]
                if other == k + 1 and k % 3 == 0:
                    switches.append(f"j{name}")
        kinds = {n: kinds[n] for n in sorted(kinds)}
        bonds = [b for b in bonds if all(n in kinds for n in b.split(" -> "))]
        graph = build(kinds, bonds, switches=switches)
        strokes = Strokes(graph, (1,) * len(switches))
        loops = (side - 1) ** 2
        assert strokes.dependent == loops - 1  # it floats: every node can give an effort
        seen.clear()
        for k in range(len(switches)):
            strokes.turn({k: 0})
            strokes.undo()
        costs.append(sum(seen) / len(switches))
    # Nine times as many capacitors; a search that starts over would cost nine times as much.
    assert 0 < costs[1] < 4 * costs[0]
