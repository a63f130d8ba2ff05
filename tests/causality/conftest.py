"""Flat graphs written by hand, record by record: no builder in between."""

import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

from hybond.model.expressions import Number
from hybond.model.graph import Bond, End, FlatGraph, Machine, Node, Storage
from hybond.model.laws import Law
from hybond.units import DOMAINS

sys.path.insert(0, str(Path(__file__).parent))  # for written_graphs

OUTPUT = {"R": "e", "G": "f", "Se": "e", "Sf": "f", "C": "e", "I": "f", "TF": "e", "GY": "e"}

Build = Callable[..., FlatGraph]


def build_graph(
    kinds: Mapping[str, str],
    bonds: Sequence[str],
    *,
    reverse: Collection[int] = (),
    switches: Collection[str] = (),
    values: Mapping[str, float | None] | None = None,
    laws: Mapping[str, Law] | None = None,
) -> FlatGraph:
    """Build a graph; ports are in the order of the bonds, whichever way these point.

    `values` are constant laws (1 if not given; None is a law that is not constant). Each of
    `switches` has a machine of its own: state 0 "open", state 1 "closed" (ON).
    """
    domain = DOMAINS["generic"]
    names = list(kinds)
    number = {name: k for k, name in enumerate(names)}
    ends: list[list[End]] = [[] for _ in names]
    records = []
    for k, text in enumerate(bonds):
        a, b = (number[part.strip()] for part in text.split("->"))
        if k in reverse:
            a, b, text = b, a, " -> ".join(reversed(text.split(" -> ")))
        first, second = sorted((a, b))
        for node in (first, second):
            ends[node].append(End(k, node == b, len(ends[node])))
        records.append(Bond(k, a, b, text, domain))
    nodes = []
    for k, (name, kind) in enumerate(kinds.items()):
        law = None
        if kind in OUTPUT:
            value = (values or {}).get(name, 1.0)
            law = Law(
                OUTPUT[kind],  # type: ignore[arg-type]
                (Number(value or 0.0),),
                None if value is None else ((value,),),
            )
        machine = list(switches).index(name) if name in switches else None
        nodes.append(
            Node(
                index=k,
                path=name,
                kind=kind,
                ends=tuple(ends[k]),
                domain=domain,
                law=(laws or {}).get(name, law),
                controlled=name in switches,
                machine=machine,
            )
        )
    storages: list[Storage] = []
    for node in nodes:
        if node.kind in ("C", "I"):
            for end in node.ends:
                index = len(storages)
                sign, path = end.sign, f"{node.path}.{node.about.energy}"
                kind: Any = node.kind
                storages.append(
                    Storage(index, node.index, end.port, end.bond, sign, kind, path, 0.0)
                )
    machines = tuple(
        Machine(k, f"m_{name}", ("open", "closed"), (frozenset(), frozenset({number[name]})), 1, ())
        for k, name in enumerate(switches)
    )
    return FlatGraph(
        name="test",
        title="",
        nodes=tuple(nodes),
        bonds=tuple(records),
        storages=tuple(storages),
        machines=machines,
        integrals=(),
        inputs=(),
        watches=(),
        signals={},
        parameters={},
        dimensions={},
        by_path=number,
    )


@pytest.fixture(scope="session")
def build() -> Build:
    return build_graph
