"""A graph with open laws near its start: rates and answers by differences.

Each law gives way to a source at its junction whose value is `l`; what answers is the other
variable of its bond. What is asked of the engine is then an ordinary graph.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.complementarity.ports import Port
from hybond.engine.outcome.apart import Apart
from hybond.equations.calculus import rate_name
from hybond.model.expressions import Expr, Name, Number
from hybond.model.graph import Bond, End, FlatGraph, Integral, Mode, Node
from hybond.model.laws import Law

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
STEP = 1e-5
"""Part of a stored quantity that it is moved by; central differences are then exact to 1e-10."""


@dataclass(frozen=True, slots=True)
class Tangent:
    """``x' = A x + E l + a``, ``w = C x + D l + c`` near a point."""

    A: Matrix
    E: Matrix
    C: Matrix
    D: Matrix
    a: Vector
    c: Vector
    """`a` and `c`: what is left at ``x = 0, l = 0``: sources, and what the tangent has there."""


def tangent(graph: FlatGraph, mode: Mode, ports: tuple[Port, ...]) -> Tangent:
    """Return the tangent of a graph at its start, in a mode with all laws in their first branch.

    Raises
    ------
    NumericsError
        If a law has no value there.
    """
    given, answers = _opened(graph, ports)
    apart = Apart(given)
    wanted = [*(rate_name(s) for s in graph.storages), *answers]
    start = apart.start

    def at(y: Vector) -> Vector:
        return np.array(apart.signals.after(0.0, y, mode, wanted))

    n, count = len(graph.storages), len(ports)
    here = at(start)
    size = max(float(np.abs(start[:n]).max(initial=0.0)), 1.0)
    steps = [STEP * max(abs(float(x)), size if n == 1 else 1e-3 * size) for x in start[:n]]
    steps += [STEP * max(float(np.abs(here).max(initial=0.0)), 1.0)] * count
    slopes = np.zeros((len(here), n + count))
    for j, (k, h) in enumerate(zip([*range(n), *range(len(start) - count, len(start))], steps)):
        ahead, back = start.copy(), start.copy()
        ahead[k] += h
        back[k] -= h
        slopes[:, j] = (at(ahead) - at(back)) / (ahead[k] - back[k])
    rest = here - slopes[:, :n] @ start[:n]
    # slopes are difference quotients: what they leave of terms that cancel is nothing
    rest[np.abs(rest) <= 1e-9 * (np.abs(here) + np.abs(slopes[:, :n]) @ np.abs(start[:n]))] = 0.0
    A, E = _clean(slopes[:n, :n]), _clean(slopes[:n, n:])
    C, D = _clean(slopes[n:, :n]), _clean(slopes[n:, n:])
    return Tangent(A, E, C, D, rest[:n], rest[n:])


def _opened(graph: FlatGraph, ports: tuple[Port, ...]) -> tuple[FlatGraph, list[Expr]]:
    """Return the graph with sources in place of laws, and what answers them.

    The value of each source is an integrated signal of rate zero, the last ones of the graph.
    """
    nodes, bonds, integrals = list(graph.nodes), list(graph.bonds), list(graph.integrals)
    machines = list(graph.machines)
    answers: list[Expr] = []
    for port in ports:
        junction = nodes[port.law.node]
        own, bond, path = len(nodes), len(bonds), f"{port.path}.law"
        flow = (junction.kind == "1") == (port.given == "common")
        value = Name(f"s:{len(integrals)}")
        nodes.append(
            Node(
                own,
                path,
                "Sf" if flow else "Se",
                (End(bond, inward=False, port=0),),
                junction.domain,
                Law("f" if flow else "e", (value,)),
            )
        )
        end = End(bond, inward=True, port=len(junction.ends))
        nodes[junction.index] = replace(
            junction, ends=(*junction.ends, end), controlled=False, machine=None
        )
        name = f"{path} -> {port.path}"
        bonds.append(Bond(bond, own, junction.index, name, junction.domain))
        integrals.append(Integral(len(integrals), path, Number(0.0), 0.0))
        m = machines[port.machine]
        machines[m.index] = replace(m, on=tuple(on - {junction.index} for on in m.on), law=None)
        answers.append(Name(f"{'e' if flow else 'f'}:{bond}"))
    made = replace(
        graph,
        nodes=tuple(nodes),
        bonds=tuple(bonds),
        integrals=tuple(integrals),
        machines=tuple(replace(m, rules=()) for m in machines),
    )
    return made, answers


def _clean(m: Matrix) -> Matrix:
    """Return a matrix without what is rounding beside its largest entry."""
    return np.where(np.abs(m) <= 1e-9 * np.abs(m).max(initial=0.0), 0.0, m)
