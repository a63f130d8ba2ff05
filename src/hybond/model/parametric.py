"""An element's law with its parameters left as names: what formulas are printed in.

`lawbook` puts numbers in and checks units; here the same writing is read again with parameters as
``p:<dotted path>``. A value written as a number gets a name too, the element's own:
``pad = { C = "1 mm/N" }`` has the coefficient ``p:pad.C``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Any

from hybond.model.expressions import Binary, Expr, Name, Number, differentiate, simplify
from hybond.model.graph import Node
from hybond.model.hierarchy import Written, literal, without_units
from hybond.model.kinds import SOURCES, STORAGES, TWO_PORTS
from hybond.model.resolve import Resolver
from hybond.names import join
from hybond.records import dataclass

INVERSE = {"C": "K", "I": "W"}
"""What the inverse of a storage's matrix is called, by its kind: rates are formulas of that."""


@dataclass(frozen=True, slots=True)
class Parametric:
    """The law of an element in names of parameters."""

    matrix: tuple[tuple[Expr, ...], ...] | None
    """As `Law.matrix`: ``output = matrix @ argument``; None if the law is not linear with constant
    coefficients."""
    expressions: tuple[Expr, ...]
    """As `Law.expressions`."""
    own: Mapping[str, float] = field(default_factory=dict)
    """The values of the element's own names, SI."""


def parametric(node: Node, written: Written, resolver: Resolver) -> Parametric:
    """Return the law of `node` in names of parameters.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", parameters={"R": "2 ohm"})
    >>> m.add(r=hb.R("3*R"), c=hb.C("1 mF"))
    >>> m.bond("c -> r")
    >>> graph = m.flatten()
    >>> r = graph.parametric(graph.by_path["r"])
    >>> str(r.matrix[0][0])
    '3*p:R'
    >>> c = graph.parametric(graph.by_path["c"])
    >>> str(c.matrix[0][0]), dict(c.own)
    ('1/p:c.C', {'p:c.C': 0.001})
    """
    return _Reading(node, written, resolver).read()


class _Reading:
    def __init__(self, node: Node, written: Written, resolver: Resolver) -> None:
        self.node = node
        self.scope = written.scope
        self.resolver = resolver
        self.value = written.part.value
        self.where = f"elements.{node.path}"
        many = len(node.ends) > 1
        variables = ("e", "f", node.about.energy) if node.about.energy else ("e", "f")
        self.names: dict[str, Expr] = {
            name: Name(f"p:{join(self.scope.prefix, name)}") for name in self.scope.parameters
        }
        if self.scope.index:
            self.names[self.scope.index] = self.scope.parameters[self.scope.index]
        # As in `lawbook`, in a formula alone: a plain value may read a parameter `f`.
        self.locals: dict[str, Expr] = {}
        for k in range(len(node.ends)):
            for variable in variables:
                name = f"{variable}{k + 1 if many else ''}"
                self.locals[name] = Name(f"law:{name}")
        self.own: dict[str, float] = {}

    def read(self) -> Parametric:
        assert self.node.law is not None
        if isinstance(self.value, Mapping):
            return self._full(self.value)
        if isinstance(self.value, Sequence) and not isinstance(self.value, str):
            return self._matrix()
        return self._plain()

    def _tree(self, value: Any, *, local: bool = False) -> Expr:
        names = {**self.names, **self.locals} if local else self.names
        tree = self.resolver.resolve(literal(value, self.where), self.scope, self.where, names)
        return simplify(without_units(tree))

    def _named(self, name: str, value: float) -> Expr:
        """Return the element's own name for a number, but for those that say most as they are."""
        if value in (0.0, 1.0, -1.0) and self.node.kind not in STORAGES + ("R", "G"):
            return Number(value)
        if value == 0.0:
            return Number(0.0)
        own = f"p:{self.node.path}.{name}"
        self.own[own] = value
        return Name(own)

    def _plain(self) -> Parametric:
        law = self.node.law
        assert law is not None
        tree = self._tree(self.value)
        if self.node.kind in SOURCES + TWO_PORTS:
            if isinstance(tree, Number) and self.node.kind in TWO_PORTS:
                tree = self._named(self.node.kind, tree.value)
            return Parametric(((tree,),) if law.matrix is not None else None, (tree,), self.own)
        if isinstance(tree, Number):
            tree = self._named(self.node.kind, tree.value)
        argument = Name(f"law:{self.node.about.energy or ('f' if law.output == 'e' else 'e')}")
        if self.node.kind in STORAGES:
            tree = simplify(Binary("/", Number(1.0), tree))
        matrix = ((tree,),) if law.matrix is not None else None
        return Parametric(matrix, (Binary("*", tree, argument),), self.own)

    def _matrix(self) -> Parametric:
        """A field keeps names for what is written, but a storage for the inverse of it."""
        law = self.node.law
        assert law is not None and law.matrix is not None
        storage = self.node.kind in STORAGES
        letter = INVERSE.get(self.node.kind, self.node.kind)
        rows = []
        for i, numbers in enumerate(law.matrix):
            row = []
            for j, number in enumerate(numbers):
                tree = Number(number) if storage else self._tree(self.value[i][j])
                if isinstance(tree, Number):
                    a, b = (min(i, j), max(i, j)) if storage else (i, j)
                    tree = self._named(f"{letter}{a + 1}{b + 1}", law.matrix[a][b])
                row.append(tree)
            rows.append(tuple(row))
        argument = self.node.about.energy or ("f" if law.output == "e" else "e")
        expressions = []
        for entries in rows:
            total: Expr = Number(0.0)
            for k, entry in enumerate(entries):
                total = Binary("+", total, Binary("*", entry, self.locals[f"{argument}{k + 1}"]))
            expressions.append(simplify(total))
        return Parametric(tuple(rows), tuple(expressions), self.own)

    def _full(self, value: Mapping[str, Any]) -> Parametric:
        law = self.node.law
        assert law is not None
        (given,) = value.values()
        many = len(self.node.ends) > 1
        texts = list(given) if isinstance(given, list | tuple) and many else [given]
        if len(texts) == 1 and isinstance(texts[0], list | tuple):
            texts = list(texts[0])
        if any(isinstance(t, Mapping) for t in texts):
            return Parametric(None, law.expressions, {})
        expressions = tuple(self._tree(t, local=True) for t in texts)
        if law.matrix is None:
            return Parametric(None, expressions, {})
        argument = self.node.about.energy or ("f" if law.output == "e" else "e")
        locals_ = [f"law:{argument}{k + 1 if many else ''}" for k in range(len(texts))]
        matrix = tuple(
            tuple(simplify(differentiate(e, name)) for name in locals_) for e in expressions
        )
        return Parametric(matrix, expressions, {})
