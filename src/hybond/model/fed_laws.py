"""Two-sided laws whose common variable is what sources say.

A relay of a controller is fed by a source: ``y -> rel`` with ``y = { Sf = "c.q" }``. What it gives
acts on nothing through its own bonds, so no power of it can hold the common variable at zero, and
where signals lead back from it to its source, the state slides. Such a law is a machine whose two
branches have a surface between them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from hybond.model.hierarchy import Opened
from hybond.model.kinds import JUNCTIONS
from hybond.model.laws import TWO_SIDED
from hybond.model.parts import MachinePart

_Around = Mapping[str, Sequence[tuple[int, str]]]


def fed_laws(opened: Opened) -> frozenset[str]:
    """Return the junctions with a two-sided law whose common variable only sources say.

    Those with a `breakaway`, impulses, or a pair have a state at rest of their own.
    """
    asked = [
        path
        for path, written in opened.nodes.items()
        if written.part.options.get("law") in TWO_SIDED
        and not {"breakaway", "impulsive", "pair"} & written.part.options.keys()
    ]
    if not asked:
        return frozenset()
    around: dict[str, list[tuple[int, str]]] = {}
    for k, b in enumerate(opened.bonds):
        around.setdefault(b.tail.path, []).append((k, b.head.path))
        around.setdefault(b.head.path, []).append((k, b.tail.path))
    switched = {
        name for _, part in opened.machines.values() for on in part.states.values() for name in on
    }
    found = []
    for path in asked:
        flow = opened.nodes[path].part.kind == "1"
        met: set[int] = set()
        if any(
            _says(opened, around, switched, met, k, n, flow=flow) for k, n in around.get(path, ())
        ):
            found.append(path)
    return frozenset(found)


def switched_relay(name: str, common: str) -> MachinePart:
    """Return the machine of such a law, for the common variable as a guard reads it."""
    return MachinePart(
        {"sticks": (name,), "forward": (name,), "backward": (name,)},
        "sticks",
        (
            f"sticks -> forward when {common} > 0",
            f"sticks -> backward when {common} < 0",
            f"forward -> backward when {common} < 0",
            f"backward -> forward when {common} > 0",
        ),
    )


def _says(
    opened: Opened,
    around: _Around,
    switched: set[str],
    met: set[int],
    bond: int,
    node: str,
    *,
    flow: bool,
) -> bool:
    """Whether what is behind a bond gives its flow, or its effort, whatever happens there."""
    if bond in met:
        return False
    met.add(bond)
    part = opened.nodes[node].part
    others = [(k, n) for k, n in around[node] if k != bond]
    if part.kind in ("Se", "Sf"):
        return (part.kind == "Sf") == flow
    if part.kind in ("TF", "GY") and len(others) == 1:
        behind = flow if part.kind == "TF" else not flow
        return _says(opened, around, switched, met, *others[0], flow=behind)
    if part.kind not in JUNCTIONS or "law" in part.options or node in switched or not others:
        return False
    told = [_says(opened, around, switched, met, k, n, flow=flow) for k, n in others]
    return any(told) if (part.kind == "1") == flow else all(told)
