"""Reachable modes by exhaustive search; conflicts ahead by all modes, one by one."""

import itertools
import random

import pytest

import hybond as hb
from hybond.causality.ahead import conflicts_ahead
from hybond.causality.assign import assign
from hybond.causality.reachable import reachable
from hybond.causality.report import causality
from hybond.model.graph import FlatGraph, Mode


def machines_model(rules: list[list[str]], states: int = 3) -> FlatGraph:
    """Machines without a circuit: machine k has states s0, s1, ... and switches ON j{k} in s1."""
    m = hb.Model("machines")
    m.add(V=hb.Se(1), n=hb.Zero(), r=hb.R(1))
    m.bond("V -> n -> r")
    for k, own in enumerate(rules):
        m.add(**{f"j{k}": hb.One(), f"r{k}": hb.R(1)})
        m.bond(f"n -> j{k} -> r{k}")
        names = {f"s{i}": [f"j{k}"] if i == 1 else [] for i in range(states)}
        m.machine(f"m{k}", states=names, start="s0", rules=own)
    return m.flatten()


def holds(text: str, mode: Mode) -> bool | None:
    """What the guards of these tests say, read from their text: True, False or that depends."""
    if text.startswith("time"):
        return None
    if text in ("true", "false"):
        return text == "true"
    if " and " in text:
        parts = [holds(part, mode) for part in text.split(" and ")]
        return False if False in parts else None if None in parts else True
    negated = text.startswith("not ")
    name = text.removeprefix("not ")
    if name.endswith(".on"):
        value = mode[int(name[1])] == 1
    else:
        machine, state = name.split(".state == ")
        value = mode[int(machine[1])] == int(state.strip('"')[1])
    return value is not negated


def every_mode(rules: list[list[str]]) -> set[Mode]:
    """All reachable modes: each step moves every subset of the machines that may move."""
    start = (0,) * len(rules)
    found, queue = {start}, [start]
    while queue:
        mode = queue.pop()
        options = []
        for k, own in enumerate(rules):
            targets = [mode[k]]
            for rule in own:
                source, target, guard = (
                    rule.split(" -> ")[0],
                    *rule.split(" -> ")[1].split(" when "),
                )
                if int(source[1]) != mode[k]:
                    continue
                value = holds(guard, mode)
                if value is not False:
                    targets.append(int(target[1]))
                if value:
                    del targets[0]
                    break
            options.append(targets)
        for after in itertools.product(*options):
            if after not in found:
                found.add(after)
                queue.append(after)
    return found


@pytest.mark.parametrize("seed", range(60))
def test_reachable_modes_are_those_of_exhaustive_search(seed: int) -> None:
    draw = random.Random(seed)
    count = draw.randint(1, 4)
    guards = ["time >= 1", "time >= 2", "true", "false"]
    asks = [f"j{k}.on" for k in range(count)] + [
        f'm{k}.state == "s{i}"' for k in range(count) for i in range(3)
    ]
    rules = []
    for _ in range(count):
        own = []
        for _ in range(draw.randint(0, 4)):
            source, target = draw.sample(range(3), 2)
            guard = draw.choice(guards[:2] * 4 + guards[2:] + asks + [f"not {a}" for a in asks])
            if draw.random() < 0.2:
                guard = f"{draw.choice(asks)} and time >= 1"
            own.append(f"s{source} -> s{target} when {guard}")
        rules.append(own)
    found = reachable(machines_model(rules))
    assert found.complete
    assert len(set(found.modes)) == len(found.modes)
    assert set(found.modes) == every_mode(rules)
    for mode in found.modes:
        path = found.path(mode)
        assert path[0] == found.modes[0] and path[-1] == mode


def test_a_limit_is_kept_and_said() -> None:
    toggles = [["s0 -> s1 when time >= 1", "s1 -> s0 when time >= 2"]] * 40
    found = reachable(machines_model(toggles), limit=100)
    assert len(found.modes) == 100 and not found.complete
    some = reachable(machines_model(toggles), machines=[3, 5])
    assert some.complete and len(some.modes) == 4
    assert {(mode[3], mode[5]) for mode in some.modes} == set(itertools.product((0, 1), repeat=2))
    assert all(sum(mode) == mode[3] + mode[5] for mode in some.modes)


def test_machines_that_wait_for_each_other_stay() -> None:
    wait = [["s0 -> s1 when j1.on"], ["s0 -> s1 when j0.on"]]
    assert reachable(machines_model(wait)).modes == ((0, 0),)
    # Alone, what a machine asks of the others counts as possible.
    assert reachable(machines_model(wait), machines=[0]).modes == ((0, 0), (1, 0))


def two_sources(extra: int, *, interlocked: bool = False) -> FlatGraph:
    """Two voltage sources that two switches join, among `extra` lamps with switches."""
    m = hb.Model("pair")
    m.add(V=hb.Se(10), W=hb.Se(12), a=hb.One(), b=hb.One(), rail=hb.Zero(), load=hb.R(1))
    m.bond("V -> a -> rail", "W -> b -> rail", "rail -> load")
    free = ["off -> on when time >= 1", "on -> off when time >= 2"]
    for name, other in (("a", "b"), ("b", "a")):
        ask = f' and s_{other}.state == "off"' if interlocked else ""
        rules = [f"off -> on when time >= 1{ask}", "on -> off when time >= 2"]
        m.machine(f"s_{name}", states={"off": [], "on": [name]}, start="off", rules=rules)
    for k in range(extra):
        m.add(**{f"lamp{k}": hb.One(), f"r{k}": hb.R(1)})
        m.bond(f"rail -> lamp{k} -> r{k}")
        states = {"off": [], "on": [f"lamp{k}"]}
        m.machine(f"s{k}", states=states, start="off", rules=free)
    return m.flatten()


@pytest.mark.parametrize("extra", [0, 3, 20])
def test_two_voltage_sources_are_explained_by_their_two_switches_alone(extra: int) -> None:
    graph = two_sources(extra)
    ahead = conflicts_ahead(graph, limit=300)
    (only,) = ahead.found
    assert only.conflict.switches == (("a", True), ("b", True))
    assert only.text.endswith("switches: s_a = on, s_b = on.")
    ends = {graph.nodes[o.node].path for o in (only.conflict.origin_a, only.conflict.origin_b)}
    assert ends == {"V", "W"}
    assert ahead.looked_at.complete is (extra < 20)
    both = [m for m in ahead.looked_at.modes if m[:2] == (1, 1)]
    assert only.modes == ahead.modes == len(both) > 0


def test_a_pair_among_many_switches_is_found_by_its_region() -> None:
    # More pairs of switches than modes are looked at, and this pair is the last of them.
    m = hb.Model("pair")
    m.add(V=hb.Se(10), W=hb.Se(12), a=hb.One(), b=hb.One(), rail=hb.Zero(), load=hb.R(1))
    m.bond("V -> a -> rail", "W -> b -> rail", "rail -> load")
    for k in range(120):
        m.add(**{f"lamp{k}": hb.One(), f"r{k}": hb.R(1)})
        m.bond(f"rail -> lamp{k} -> r{k}")
    for name in [*(f"lamp{k}" for k in range(120)), "a", "b"]:
        rules = ["off -> on when time >= 1", "on -> off when time >= 2"]
        m.machine(f"s_{name}", states={"off": [], "on": [name]}, start="off", rules=rules)
    report = causality(m)
    assert not report.ahead.looked_at.complete
    (only,) = report.ahead.found
    assert only.conflict.switches == (("a", True), ("b", True))
    path = report.ahead.looked_at.path(only.mode)
    assert path[0] == (0,) * 122 and path[-1] == only.mode


def test_two_machines_can_pass_each_other_in_an_interlock() -> None:
    # Each asks whether the other is off, and both fire together: the mode is reachable.
    ahead = conflicts_ahead(two_sources(2, interlocked=True))
    assert len(ahead.found) == 1
    path = ahead.looked_at.path(ahead.found[0].mode)
    assert [mode[:2] for mode in path] == [(0, 0), (1, 1)]


def test_the_half_bridge_has_no_conflict_ahead() -> None:
    # One machine for both switches; two machines would short the supply.
    m = hb.Model("bridge")
    m.add(plus=hb.Se(24), minus=hb.Se(0), upper=hb.One(), lower=hb.One(), out=hb.Zero())
    m.add(i=hb.One(), L=hb.I(1), R=hb.R(2))
    m.bond("plus -> upper -> out", "minus -> lower -> out", "out -> i -> L", "i -> R")
    one = hb.Model("one")
    one.elements, one.bonds = m.elements, m.bonds
    rules = ["high -> low when time >= 1", "low -> high when time >= 2"]
    one.machine("leg", states={"high": ["upper"], "low": ["lower"]}, start="high", rules=rules)
    assert conflicts_ahead(one.flatten()).found == ()
    for name in ("upper", "lower"):
        states = {"on": [name], "off": []}
        rules = ["on -> off when time >= 1", "off -> on when time >= 2"]
        m.machine("s_" + name, states=states, start="off", rules=rules)
    (only,) = conflicts_ahead(m.flatten()).found
    assert dict(only.conflict.switches) == {"upper": True, "lower": True}


def random_parts(draw: random.Random) -> tuple[dict[str, str], list[str], list[str]]:
    """Return kinds, bonds and switches: a tree or ring of junctions and two-ports with leaves."""
    count = draw.randint(1, 4)
    kinds = {f"n{k}": draw.choice("01") for k in range(count)}
    pairs = [(draw.randrange(k), k) for k in range(1, count)]
    if count > 2 and draw.random() < 0.4:
        pairs.append((0, count - 1))
    bonds = []
    for k, (a, b) in enumerate(pairs):
        link = draw.choice(["", "", "", "TF", "GY"])
        if link:
            kinds[f"t{k}"] = link
            bonds += [f"n{a} -> t{k}", f"t{k} -> n{b}"]
        else:
            bonds.append(f"n{a} -> n{b}")
    for k in range(count):
        for j in range(draw.randint(0, 2) if bonds else 2):
            kinds[f"x{k}_{j}"] = draw.choice(["C", "I", "R", "G", "Se", "Sf"])
            bonds.append(f"n{k} -> x{k}_{j}")
    able = [name for name, kind in kinds.items() if kind in ("0", "1", "TF", "GY")]
    return kinds, bonds, draw.sample(able, draw.randint(0, min(3, len(able))))


@pytest.mark.slow
def test_named_switches_are_enough_whatever_the_others_do(build) -> None:
    findings = 0
    for seed in range(400):
        kinds, bonds, switches = random_parts(random.Random(seed))
        graph = build(kinds, bonds, switches=switches)
        every = list(itertools.product((0, 1), repeat=len(switches)))
        refused = {mode for mode in every if assign(graph, mode).conflicts}
        index = {name: k for k, name in enumerate(switches)}
        for start in every:
            ahead = conflicts_ahead(graph, start)  # no rules: only the start mode is looked at
            assert ahead.looked_at.modes == (start,)
            assert (start in refused) is bool(ahead.found)
            for one in ahead.found:
                findings += 1
                named = {index[path]: int(on) for path, on in one.conflict.switches}
                assert all(start[k] == state for k, state in named.items())
                agreeing = [m for m in every if all(m[k] == s for k, s in named.items())]
                assert set(agreeing) <= refused
    assert findings > 100
