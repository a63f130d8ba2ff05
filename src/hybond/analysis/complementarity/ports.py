"""What the pairs of a complementarity system are, and how each is bounded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from hybond.causality.orientation import Given
from hybond.equations.element_rows import laws_of
from hybond.model.expressions import Bool, Expr, Number, Pre, names, simplify, substitute, transform
from hybond.model.graph import FlatGraph
from hybond.model.laws import JunctionLaw

WORDS = {
    "electrical": ("voltage", "current"),
    "translational": ("force", "velocity"),
    "rotational": ("torque", "angular velocity"),
    "hydraulic": ("pressure", "volume flow"),
    "thermal": ("temperature", "entropy flow"),
    "thermal_pseudo": ("temperature", "heat flow"),
    "magnetic": ("magnetomotive force", "flux rate"),
}
"""Effort and flow by domain."""


@dataclass(frozen=True, slots=True)
class Port:
    """A junction whose law is left open."""

    machine: int
    """Its machine."""
    law: JunctionLaw
    given: Given
    """What `l` is: the common variable, or minus the net variable."""
    path: str


@dataclass(frozen=True, slots=True)
class LawPort:
    """A pair of complementary variables."""

    given: str
    answer: str
    """`given` and `answer`: their names, ``l1`` and ``w1``."""
    path: str
    kind: str
    """`path` and `kind`: the junction and its law."""
    orientation: Given
    """What `given` is: the common variable, or minus the net variable."""
    given_signal: str
    answer_signal: str
    """`given_signal` and `answer_signal`: the signals that they are: ``d.f`` and ``-d.e``."""
    given_words: str
    answer_words: str
    """`given_words` and `answer_words`: the same for people."""
    bounded: Literal["one-sided", "given", "answer"]
    """``one-sided``: both are at least zero, one of them is. Else the one that lies between
    ``-limit`` and ``limit``."""
    limit: Expr | None = None
    breakaway: Expr | None = None
    gap: Expr | None = None
    gate: Expr | None = None
    restitution: Expr | None = None
    """`limit`, `breakaway`, `gap`, `gate` and `restitution`: in canonical names."""


def law_ports(graph: FlatGraph, ports: tuple[Port, ...], *, symbolic: bool) -> tuple[LawPort, ...]:
    """Return what the pairs of the ports are, in order."""
    taken = {*graph.by_path, *graph.parameters, *graph.signals, *(i.path for i in graph.inputs)}
    count = range(1, len(ports) + 1)
    clash = any(f"{letter}{k}" in taken for k in count for letter in "lw")
    letters = ("λ", "ω") if clash else ("l", "w")
    return tuple(
        _port(graph, p, (f"{letters[0]}{k}", f"{letters[1]}{k}"), symbolic)
        for k, p in zip(count, ports, strict=True)
    )


def _port(graph: FlatGraph, port: Port, own: tuple[str, str], symbolic: bool) -> LawPort:
    law = port.law
    node = graph.nodes[law.node]
    effort, flow = WORDS.get(node.domain.name, ("effort", "flow"))
    common, net = ("f", "e") if node.kind == "1" else ("e", "f")
    word, other = (flow, effort) if node.kind == "1" else (effort, flow)
    first = (f"{port.path}.{common}", f"{word} of {port.path}")
    if law.two_sided:
        what = f"minus the net {other} of {port.path}"
    elif node.kind == "1":
        what = f"blocked {other} of {port.path}"
    else:
        what = f"{other} at which {port.path} opens"
    second = (f"-{port.path}.{net}", what)
    if port.given == "net":
        first, second = second, first
    bounded: Literal["one-sided", "given", "answer"] = "one-sided"
    if law.two_sided:
        bounded = "given" if port.given == "net" else "answer"
    limit, restitution = law.limit, law.restitution
    if symbolic:
        limit = _written(graph, port, "forward") or limit
        restitution = _written(graph, port, "impact") or restitution
    return LawPort(
        *own,
        port.path,
        law.kind,
        port.given,
        first[0],
        second[0],
        first[1],
        second[1],
        bounded,
        limit,
        law.breakaway if law.breakaway != law.limit else None,
        law.gap,
        law.gate,
        restitution,
    )


def _written(graph: FlatGraph, port: Port, state: str) -> Expr | None:
    """Return limit or restitution in names of parameters: they stand in the law's own source."""
    machine = graph.machines[port.machine]
    if port.law.source is None or state not in machine.states:
        return None
    node = graph.nodes[port.law.source]
    e = laws_of(graph, node, symbolic=True).expressions[0]
    k = machine.states.index(state)
    own = f"in:{machine.index}:"
    states: dict[str, Expr] = {n: Bool(n == f"{own}{k}") for n in names(e) if n.startswith(own)}
    e = simplify(substitute(e, states))
    return simplify(transform(e, _before))


def _before(e: Expr) -> Expr:
    """Return 1 for ``pre(...)``: what is left of ``eps*pre(v)`` is eps."""
    return Number(1.0) if isinstance(e, Pre) else e
