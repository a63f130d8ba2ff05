"""What is wrong with a model and what is worth knowing, with places that the page selects."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from hybond.errors import HybondError
from hybond.hints.look import hints_of
from hybond.model.builder import Model
from hybond.model.graph import FlatGraph
from hybond.names import steps
from hybond.studio.chains import links, node_of
from hybond.studio.levels import Data, bonds_of, table
from hybond.studio.strokes import Meaning

_BOND = re.compile(r"graph\.bonds\[(\d+)\]")
_SECTIONS = ("elements", "parameters", "signals", "inputs", "machines", "blocks", "ports")


def problems(data: Data, known: Meaning, conflicts: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return refusals, conflicts of causality and hints, gravest first."""
    found = []
    if known.error is not None:
        found.append({"grave": "error", **known.error.to_dict()})
    found += [{"grave": "error", **c} for c in conflicts]
    if known.whole and known.model is not None and known.graph is not None:
        found += _hints(known.model, known.graph)
    for problem in found:
        problem["select"] = place_of(data, str(problem.get("where", "")))
    return found


def problem_of(error: HybondError, data: Data) -> dict[str, Any]:
    """Return one refusal as the page shows it."""
    said = {"grave": "error", **error.to_dict()}
    said["select"] = place_of(data, str(said.get("where", "")))
    return said


def _hints(model: Model, graph: FlatGraph) -> list[dict[str, Any]]:
    said: list[dict[str, Any]] = []
    try:
        said += [{"grave": "hint", **h.to_dict()} for h in hints_of(model, graph)]
    except HybondError as error:
        said.append({"grave": "hint", **error.to_dict()})
    said += [
        {"grave": "hint", "code": "", "where": "", "why": warning, "try": ""}
        for warning in graph.warnings
    ]
    return said


def place_of(data: Data, where: str) -> dict[str, Any]:
    """Return what a place of a refusal is on the page: nodes, bonds, or an entry of a panel.

    Examples
    --------
    >>> data = {"elements": {"v": {}, "m": {}}, "graph": {"bonds": ["v -> m"]}}
    >>> place_of(data, "ball.toml:3: elements.m.I"), place_of(data, "graph.bonds[0]")
    ({'nodes': ['m']}, {'bonds': ['0.0']})
    >>> place_of(data, "v -> m"), place_of(data, "machines.sw")
    ({'bonds': ['0.0']}, {'entry': ['machines', 'sw']})
    """
    where = where.rpartition(": ")[2] if not _BOND.search(where) else where
    match = _BOND.search(where)
    written = links(bonds_of(data))
    if match:
        keys = [b.key for b in written if b.chain == int(match[1])]
        return {"bonds": keys} if keys else {}
    for b in written:
        if where in (f"{b.tail} -> {b.head}", f"{b.label}: {b.tail} -> {b.head}"):
            return {"bonds": [b.key]}
    parts = _parts(where, data)
    if parts[0] in _SECTIONS and len(parts) > 1:
        if parts[0] == "elements":
            return {"nodes": [parts[1]]} if parts[1] in table(data, "elements") else {}
        return {"entry": parts[:2]}
    if parts[0] in table(data, "elements"):
        return {"nodes": [parts[0]]}
    for section in _SECTIONS:
        if parts[0] in table(data, section):
            return {"entry": [section, parts[0]]}
    return {}


def _parts(where: str, data: Mapping[str, Any]) -> list[str]:
    """Return the steps of a path, a member of an array as the array."""
    known = {k for section in _SECTIONS for k in table(data, section)}
    return [node_of(step, known) for step in steps(where)]
