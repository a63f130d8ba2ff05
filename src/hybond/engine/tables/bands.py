"""Switching in a band instead of sliding: a relay that is not quite ideal."""

from __future__ import annotations

from dataclasses import replace

from hybond.equations.surfaces import surfaces_of, with_hysteresis
from hybond.model.expressions import Expr
from hybond.model.graph import FlatGraph, Rule


def banded(graph: FlatGraph, band: float) -> FlatGraph:
    """Return a graph in which every switching surface has a hysteresis of ``± band``."""
    guards: dict[Rule, Expr] = with_hysteresis(surfaces_of(graph), band)
    machines = tuple(
        replace(
            m,
            rules=tuple(
                _with(r, guards[r], f" (by {band:g})") if r in guards else r for r in m.rules
            ),
        )
        for m in graph.machines
    )
    return replace(graph, machines=machines)


def _with(rule: Rule, guard: Expr, said: str) -> Rule:
    told = rule.told + said if rule.told else ""
    return replace(rule, guard=guard, text=rule.text + said, told=told)
