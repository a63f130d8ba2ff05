"""Diagnostic causality against exhaustive search, and against every combination of switches."""

import itertools
import random
from pathlib import Path

import pytest

import hybond as hb
from hybond.causality.diagnostic import diagnostic_causality
from hybond.errors import ModelError
from hybond.model.graph import FlatGraph

EXAMPLES = Path(__file__).parents[2] / "examples"


def receives(graph: FlatGraph, strokes: tuple[int, ...], node: int) -> list[bool]:
    """Return per end of a node whether it receives effort there."""
    return [(strokes[e.bond] == 1) == e.inward for e in graph.nodes[node].ends]


def obeys(graph: FlatGraph, strokes: tuple[int, ...], node: int, off: bool) -> bool:
    """Whether the strokes at a node obey its rule; written from the definitions."""
    n, efforts = graph.nodes[node], receives(graph, strokes, node)
    match n.kind:
        case "Se":
            return not any(efforts)
        case "Sf":
            return all(efforts)
        case "0":
            return sum(efforts) == (0 if off else 1)
        case "1":
            return sum(efforts) == len(efforts) - (0 if off else 1)
        case "TF":
            return efforts == [False, True] if off else sum(efforts) == 1
        case "GY":
            return sum(efforts) == 0 if off else sum(efforts) != 1
        case _:
            return True


def late(graph: FlatGraph, strokes: tuple[int, ...]) -> bool:
    """Whether all storage is in derivative causality."""
    return all(((strokes[s.bond] == 1) == (s.sign > 0)) == (s.kind == "C") for s in graph.storages)


def absorbing(graph: FlatGraph, strokes: tuple[int, ...], node: int) -> bool:
    """Whether the bond that tells a controlled junction its variable leads to R or a source."""
    n = graph.nodes[node]
    if n.kind in ("TF", "GY"):
        return obeys(graph, strokes, node, off=True)
    telling = [
        e for e, effort in zip(n.ends, receives(graph, strokes, node)) if effort == (n.kind == "0")
    ]
    assert len(telling) == 1
    bond = graph.bonds[telling[0].bond]
    far = graph.nodes[bond.tail if telling[0].inward else bond.head].kind
    return far in ("R", "G", "Se" if n.kind == "0" else "Sf")


def exists(graph: FlatGraph) -> bool:
    switches = [n.index for n in graph.nodes if n.controlled]
    for strokes in itertools.product((0, 1), repeat=len(graph.bonds)):
        if not all(obeys(graph, strokes, n.index, off=False) for n in graph.nodes):
            continue
        if late(graph, strokes) and all(absorbing(graph, strokes, k) for k in switches):
            return True
    return False


def random_parts(draw: random.Random) -> tuple[dict[str, str], list[str], list[str]]:
    count = draw.randint(1, 3)
    kinds = {f"n{k}": draw.choice("01") for k in range(count)}
    bonds = []
    for k in range(1, count):
        other = draw.randrange(k)
        link = draw.choice(["", "", "TF", "GY"])
        if link:
            kinds[f"t{k}"] = link
            bonds += [f"n{other} -> t{k}", f"t{k} -> n{k}"]
        else:
            bonds.append(f"n{other} -> n{k}")
    for k in range(count):
        for j in range(draw.randint(1, 3)):
            if len(bonds) < 9:
                kinds[f"x{k}_{j}"] = draw.choice(["C", "I", "R", "R", "G", "Se", "Sf"])
                bonds.append(f"n{k} -> x{k}_{j}")
    able = [name for name, kind in kinds.items() if kind in ("0", "1", "TF", "GY")]
    return kinds, bonds, draw.sample(able, draw.randint(1, min(2, len(able))))


def switched_strokes(found, off) -> tuple[int, ...]:
    """Return the strokes when the controlled nodes `off` are OFF: one bond each is turned."""
    strokes = list(found.strokes)
    for node in off:
        absorber = found.absorbers.get(node)
        if absorber is not None and absorber.bond >= 0:
            strokes[absorber.bond] = 1 - strokes[absorber.bond]
    return tuple(strokes)


@pytest.mark.slow
def test_it_is_found_exactly_where_exhaustive_search_finds_one(build) -> None:
    counts = {True: 0, False: 0}
    for seed in range(500):
        kinds, bonds, switches = random_parts(random.Random(seed))
        graph = build(kinds, bonds, switches=switches)
        found = diagnostic_causality(graph)
        assert found.exists is exists(graph), (kinds, bonds, switches)
        counts[found.exists] += 1
        if not found.exists:
            assert found.missing or found.storages or found.conflicts
            assert set(found.missing) | set(found.absorbers) == {
                n.index for n in graph.nodes if n.controlled
            }
            continue
        assert late(graph, found.strokes)
        controlled = [n.index for n in graph.nodes if n.controlled]
        for states in itertools.product((False, True), repeat=len(controlled)):
            off = {k for k, is_off in zip(controlled, states) if is_off}
            strokes = switched_strokes(found, off)
            cut_off = {found.absorbers[k].node for k in off if found.absorbers[k].kind == "source"}
            for node in graph.nodes:
                if node.index not in cut_off:
                    assert obeys(graph, strokes, node.index, node.index in off)
    assert min(counts.values()) > 50


def test_the_diagnosis_circuit_has_the_published_absorbers() -> None:
    # Yu, Wang & Luo 2014: residuals with a1/R2 and a2/R4, derivatives of De1 and De2.
    graph = hb.load(EXAMPLES / "diagnosis_circuit.toml").flatten()
    found = diagnostic_causality(graph, sensors=["n1", "n2.e", "n3"])
    assert found.exists
    absorbers = {graph.nodes[k].path: graph.nodes[a.node].path for k, a in found.absorbers.items()}
    assert absorbers == {"a1": "R2", "a2": "R4"}
    assert late(graph, found.strokes)
    for k in found.absorbers:
        turned = switched_strokes(found, [k])
        differing = [b for b, s in enumerate(turned) if s != found.strokes[b]]
        assert [graph.bonds[b].name for b in differing] == [
            "a1 -> R2" if graph.nodes[k].path == "a1" else "a2 -> R4"
        ]


def test_the_rigid_clutch_lacks_a_resistor_and_gets_one() -> None:
    m = hb.load(EXAMPLES / "clutch_rigid.toml")
    found = diagnostic_causality(m.flatten(), storage="integral")
    assert not found.exists
    assert list(found.missing.values()) == [
        "neither a resistor nor an effort source is connected to 0-junction grip"
    ]
    m.add(lining=hb.R("100 N*m*s"))
    m.bond("grip -> lining")
    graph = m.flatten()
    found = diagnostic_causality(graph, storage="integral")
    assert found.exists
    (absorber,) = found.absorbers.values()
    assert graph.nodes[absorber.node].path == "lining"


def test_a_storage_that_cannot_have_its_preferred_causality_is_named() -> None:
    m = hb.Model("loose")
    m.add(c=hb.C(1), n=hb.Zero(), r=hb.R(1), d=hb.C(2), V=hb.Se(1), k=hb.Zero())
    m.bond("n -> c", "n -> r", "V -> k -> d")
    graph = m.flatten()
    assert diagnostic_causality(graph).exists  # the resistor gives n its effort
    integral = diagnostic_causality(graph, storage="integral")
    assert not integral.exists
    assert [graph.storages[k].path for k in integral.storages] == ["d.q"]
    assert list(integral.storages.values()) == [
        "Se V puts the stroke of 'k -> d' at C d through 'V -> k', 'k -> d', and it is wanted at "
        "0-junction k."
    ]


def test_a_sensor_keeps_its_junction_whatever_is_switched() -> None:
    m = hb.Model("cell")
    m.add(V=hb.Se(1), r=hb.R(1), j=hb.One(), n=hb.Zero(), c=hb.C(1))
    m.bond("V -> j -> n -> c", "j -> r")
    m.machine("S", states={"on": ["n"], "off": []}, start="on")
    graph = m.flatten()
    assert not diagnostic_causality(graph).exists
    found = diagnostic_causality(graph, sensors=["n.e"])
    assert found.exists
    assert {a.kind for a in found.absorbers.values()} == {"sensor"}
    with pytest.raises(ModelError, match="not at a junction"):
        diagnostic_causality(graph, sensors=["m"])


def test_a_switched_source_absorbs_if_it_is_cut_off() -> None:
    m = hb.Model("current")
    m.add(J=hb.Sf(1), j=hb.One(), n=hb.Zero(), r=hb.R(1))
    m.bond("J -> j -> n -> r")
    m.machine("S", states={"on": ["j"], "off": []}, start="on")
    graph = m.flatten()
    found = diagnostic_causality(graph)
    (absorber,) = found.absorbers.values()
    assert (found.exists, absorber.kind) == (True, "source")
    assert "zero while j is OFF" in absorber.note
