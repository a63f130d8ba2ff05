"""A model whose surroundings are held: time, inputs and what they make are states of their own.

At an instant time and inputs stand still, whatever they are. Held, they may have any value, so that
what is said of all states of the held model is said of all instants of the model itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from hybond.model.expressions import (
    And,
    Compare,
    Expr,
    Name,
    Not,
    Number,
    Or,
    Pre,
    compile_expression,
    differentiate,
    names,
    simplify,
    substitute,
    to_text,
    turning,
    uses_pre,
)
from hybond.model.expressions.tree import children, transform, with_children
from hybond.model.graph import FlatGraph, Integral, Node


def straight(e: Expr) -> bool:
    """Whether an expression is affine in its names.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> straight(parse("2*a - b/4 + 1")), straight(parse("a*b")), straight(parse("abs(a)"))
    (True, False, False)
    """
    if turning(e):
        return False
    return all(isinstance(simplify(differentiate(e, n)), Number) for n in sorted(names(e)))


@dataclass(frozen=True)
class Held:
    """A model with its surroundings held.

    Parameters
    ----------
    graph : FlatGraph
        Its last integrated signals are what is held.
    given : tuple of Expr
        What each of these is, of time and inputs of the model.
    where : tuple of Expr
        Conditions on the model, as they read in the held one.
    """

    graph: FlatGraph
    given: tuple[Expr, ...]
    where: tuple[Expr, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """What is stored, integrated and held."""
        return tuple(
            [*(s.path for s in self.graph.storages), *(i.path for i in self.graph.integrals)]
        )

    def surroundings(self, graph: FlatGraph, t: float) -> list[float]:
        """Return what is held at a time of the model `graph` itself."""
        values = {"time": t}
        for u in graph.inputs:
            values[f"u:{u.index}"] = u.waveform.value(t, u.waveform.piece(t))
        index = {name: k for k, name in enumerate(values)}
        row = list(values.values())
        return [float(compile_expression(e, index, pre_offset=0)(row)) for e in self.given]


def held(graph: FlatGraph, where: Sequence[Expr] = ()) -> Held:
    """Return a model with its surroundings held; it has no timed events and no samples.

    Examples
    --------
    >>> import hybond as hb
    >>> held(hb.load("examples/diode_inductor.toml").flatten()).names
    ('L.p', 'time')
    """
    watched = {f"at:{w.index}": w.compare for w in graph.watches}
    found: dict[Expr, int] = {}
    first = len(graph.integrals)

    def own(e: Expr) -> Expr:
        return Name(f"s:{first + found.setdefault(e, len(found))}")

    def outside(e: Expr) -> bool:
        read = names(e)
        return bool(read) and all(n == "time" or n.startswith("u:") for n in read)

    def lifted(e: Expr) -> Expr:
        condition = isinstance(e, Compare | And | Or | Not | Pre)
        if not condition and outside(e) and not uses_pre(e):
            if straight(e):
                return substitute(e, {n: own(Name(n)) for n in sorted(names(e))})
            return own(e)
        below = children(e)
        return with_children(e, tuple(lifted(b) for b in below)) if below else e

    def put(e: Expr) -> Expr:
        return lifted(substitute(e, watched))

    # a sampled signal holds its value between samples, which are timed events as others
    made = replace(
        _with_laws(graph, put),
        machines=tuple(
            replace(
                m,
                rules=tuple(
                    replace(
                        r, guard=put(r.guard), reads=tuple((text, put(e)) for text, e in r.reads)
                    )
                    for r in m.rules
                ),
            )
            for m in graph.machines
        ),
        signals={name: put(e) for name, e in graph.signals.items()},
        inputs=(),
        watches=(),
        samples=(),
        written=None,
        parametric=None,
    )
    conditions = tuple(put(e) for e in where)
    more = tuple(
        Integral(first + k, _called(e, graph), Number(0.0), 0.0) for k, e in enumerate(found)
    )
    dimensions = {
        f"s:{first + k}": graph.dimensions.get(e.path) if isinstance(e, Name) else None
        for k, e in enumerate(found)
    }
    made = replace(
        made,
        integrals=(*made.integrals, *more),
        dimensions={**graph.dimensions, **dimensions},
    )
    return Held(made, tuple(found), conditions)


def _called(e: Expr, graph: FlatGraph) -> str:
    paths = {f"u:{u.index}": Name(u.path) for u in graph.inputs}
    return to_text(transform(e, lambda n: paths.get(n.path, n) if isinstance(n, Name) else n))


def _with_laws(graph: FlatGraph, put: Callable[[Expr], Expr]) -> FlatGraph:
    """Return the graph with all laws and rates rewritten."""

    def node(n: Node) -> Node:
        if n.law is None or n.law.matrix is not None:
            return n
        return replace(n, law=replace(n.law, expressions=tuple(put(e) for e in n.law.expressions)))

    return replace(
        graph,
        nodes=tuple(node(n) for n in graph.nodes),
        integrals=tuple(replace(i, rate=put(i.rate)) for i in graph.integrals),
    )


@dataclass(frozen=True)
class Lifted:
    """A held model without rules whose laws read no a priori values: `terms` stand for these.

    Parameters
    ----------
    graph : FlatGraph
        Its last integrated signals are the terms.
    terms : tuple of Expr
        What each is a priori, in names of the held model.
    """

    graph: FlatGraph
    terms: tuple[Expr, ...]


def without_rules(graph: FlatGraph) -> Lifted:
    """Return a held model in which every mode stays as it is, to ask what entering it does."""
    found: dict[Expr, int] = {}
    first = len(graph.integrals)

    def own(e: Expr) -> Expr:
        if not isinstance(e, Pre):
            return e
        return Name(f"s:{first + found.setdefault(e.arg, len(found))}")

    made = _with_laws(graph, lambda e: transform(e, own))
    more = tuple(Integral(first + k, f"pre {k}", Number(0.0), 0.0) for k in range(len(found)))
    return Lifted(
        replace(
            made,
            machines=tuple(
                replace(m, rules=(), fieldless=(False,) * len(m.states)) for m in made.machines
            ),
            integrals=(*made.integrals, *more),
            dimensions={**made.dimensions, **{f"s:{first + k}": None for k in range(len(found))}},
        ),
        tuple(found),
    )


def guards_of(graph: FlatGraph) -> Iterator[Expr]:
    """Yield all guards."""
    for m in graph.machines:
        for r in m.rules:
            yield r.guard
