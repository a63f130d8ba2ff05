"""Reading laws: from what is written in an element to its `Law`, with units checked.

A plain value means the field's linear law: ``R = "10 ohm"`` is e = R f, ``G`` f = G e, ``C``
q = C e, ``I`` p = I f, ``TF`` and ``GY`` a modulus, sources their own value. A matrix means the
same for a field. ``{ e = ... }`` or ``{ f = ... }`` is a law in full, an expression or a table.
"""

from __future__ import annotations

import math
from collections import ChainMap
from collections.abc import Mapping, Sequence
from typing import Any, Literal, cast

from hybond.errors import ModelError, UnitError
from hybond.model.expressions import (
    Binary,
    Expr,
    Name,
    Number,
    Table,
    differentiate,
    names,
    simplify,
    substitute,
    turning,
)
from hybond.model.expressions.slots import settled
from hybond.model.graph import Node
from hybond.model.hierarchy import Written, constant, literal, without_units
from hybond.model.inverse import inverse_of
from hybond.model.kinds import SOURCES, STORAGES, TWO_PORTS
from hybond.model.laws import Law
from hybond.model.misfits import declared_elsewhere, units_of
from hybond.model.resolve import Resolver
from hybond.units import SHORT, Dimension, Domain, parse_unit, try_quantity

_TIME = parse_unit("s")[1]
FIELD = "the matrix of a field"
_OPTIONS = {"p", "q", "e", "f", "domain", "impulsive", "label"}
Dimensions = Mapping[str, Dimension | None]


def law_of(node: Node, written: Written, resolver: Resolver, dimensions: Dimensions) -> Law:
    """Return the law of an element.

    Raises
    ------
    ModelError
        HB-M160 a value that cannot be a law, HB-M161 a matrix of the wrong shape, HB-M162 a law
        for the wrong variable, HB-M163 a storage whose law is not allowed.
    UnitError
        HB-U103 a value with the wrong dimension.
    """
    value = written.part.value
    key = _plain_key(node, value)
    known = None if key is None else _KNOWN.get(key)
    if known is not None:
        return known
    reader = _Reader(node, written, resolver, dimensions)
    if isinstance(value, Mapping):
        law = reader.full(value)
    elif isinstance(value, Sequence) and not isinstance(value, str):
        law = reader.matrix(value)
    else:
        law = reader.plain(value)
    _check(node, law, reader.where)
    if key is not None:
        if len(_KNOWN) >= REMEMBERED:
            _KNOWN.clear()
        _KNOWN[key] = law
    return law


_Key = tuple[str, str, type, str | float]
_KNOWN: dict[_Key, Law] = {}
"""Laws of single values: a model under edit is read again with each edit, and says the same."""
REMEMBERED = 4096
"""How many, at most."""


def _plain_key(node: Node, value: object) -> _Key | None:
    """Return what the law of one quantity depends on alone, None for laws that need more."""
    if len(node.ends) != 1 or node.kind in TWO_PORTS or node.domain.effort is None:
        return None
    if isinstance(value, str):
        if len(value) > SHORT or try_quantity(value) is None:
            return None
    elif isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return (node.kind, node.domain.name, type(value), value)


class _Reader:
    """The names, units and place of one element's law."""

    def __init__(
        self, node: Node, written: Written, resolver: Resolver, dimensions: Dimensions
    ) -> None:
        self.node = node
        self.scope = written.scope
        self.resolver = resolver
        self.where = f"elements.{node.path}.{written.part.kind}"
        self.count = len(node.ends)
        self.output: Literal["e", "f"] = node.about.law or "e"
        # On top of all names, not a copy of them: flattening must not cost elements squared.
        self.dimensions = ChainMap[str, Dimension | None]({}, cast(Any, dimensions))
        many = self.count > 1
        stored = node.about.energy
        self.locals: dict[str, Expr] = {}
        domains = [_domain_dimensions(dimensions, end.bond) for end in node.ends]
        for k, (effort, flow) in enumerate(domains):
            suffix = str(k + 1) if many else ""
            for name, dimension in (("e", effort), ("f", flow)):
                self._local(name + suffix, dimension)
            if stored:
                rate = flow if stored == "q" else effort
                self._local(stored + suffix, None if rate is None else rate * _TIME)
        self.effort, self.flow = domains[0]

    def _local(self, name: str, dimension: Dimension | None) -> None:
        self.locals[name] = Name(f"law:{name}")
        self.dimensions[f"law:{name}"] = dimension

    def read(
        self, value: Any, expected: Dimension | None, *, local: bool = False, known: bool = True
    ) -> Expr:
        """Return an expression in canonical names, checked against its dimension."""
        tree = self.resolver.resolve(
            literal(value, self.where), self.scope, self.where, self.locals if local else None
        )
        found = self.resolver.dimension(tree, self.dimensions, self.where, certain=True)
        if known and expected is not None and found is not None and found != expected:
            raise self._wrong_unit(value, found, expected)
        return simplify(without_units(tree))

    def _wrong_unit(self, value: Any, found: Dimension, expected: Dimension) -> UnitError:
        """Return the refusal of a value in a wrong unit, or of the domain that makes it wrong."""
        path = self.node.path
        domain = self.node.domain
        wants = {domain.effort: domain.effort_unit, domain.flow: domain.flow_unit}.get(expected)
        made = units_of([value], self.scope.parameters)
        other = declared_elsewhere(self.node, self.resolver, self.scope.model.domain)
        if other is not None:
            return UnitError(
                f"{other!r} is declared {domain.name}, and so is all that bonds and junctions join "
                f"to it; but {path!r} is of a model that is {self.scope.model.domain}, and "
                f"{value!r} is in {found}",
                code="HB-U103",
                where=f"elements.{other}.domain",
                hint=f"take the domain of {other!r} out, or put a TF or GY between the domains",
            )
        own = self.count == 1 and domain.effort is not None
        of = f", {domain.name} as it is" if own else ""
        hint = f"give a value in {wants or expected}, or declare the domain of {path!r}"
        if made:
            hint = f"give the parameter a unit that makes it {wants or expected}"
        if self.node.kind in TWO_PORTS and found == expected**-1:
            below = value if str(value).isidentifier() else f"({value})"
            hint = f"the modulus is the other way round: write 1/{below}, or swap its ports"
        elif self.node.kind in TWO_PORTS:
            hint += "; between two domains, declare that of a junction behind it: domain = ..."
        return UnitError(
            f"{value!r} is in {found}{made}; this place wants {wants or expected}{of}",
            code="HB-U103",
            where=self.where,
            hint=hint,
        )

    def plain(self, value: Any) -> Law:
        """``R = "10 ohm"`` and its like."""
        kind = self.node.kind
        if kind in SOURCES:
            tree = self.read(value, self.effort if kind == "Se" else self.flow)
            matrix = ((tree.value,),) if isinstance(tree, Number) else None
            return Law(self.output, (tree,), matrix)
        if kind in TWO_PORTS:
            tree = self.read(value, self._modulus())
            return Law("e", (tree,), ((tree.value,),) if isinstance(tree, Number) else None)
        if self.count > 1:
            raise ModelError(
                f"the element has {self.count} bonds; one value is the law of one bond",
                code="HB-M161",
                where=self.where,
                hint="give a matrix with a row per bond, or an element to each bond",
            )
        coefficient = self.read(value, self._coefficient())
        if kind in STORAGES:
            stored = self.locals[self.node.about.energy or ""]
            if not isinstance(coefficient, Number):
                raise ModelError(
                    f"{value!r} is not constant: a storage's law cannot be modulated",
                    code="HB-M163",
                    where=self.where,
                    hint='write a nonlinear law, { e = "k*q^3" }, or a two-port',
                )
            if coefficient.value == 0.0:
                raise ModelError(
                    "a storage of size zero stores nothing",
                    code="HB-M163",
                    where=self.where,
                    hint="leave it out",
                )
            inverse = 1.0 / coefficient.value
            return Law(self.output, (Binary("/", stored, coefficient),), ((inverse,),))
        other = self.locals["f" if self.output == "e" else "e"]
        tree = Binary("*", coefficient, other)
        matrix = ((coefficient.value,),) if isinstance(coefficient, Number) else None
        return Law(self.output, (tree,), matrix)

    def _coefficient(self) -> Dimension | None:
        if self.effort is None or self.flow is None:
            return None
        match self.node.kind:
            case "C":
                return self.flow * _TIME / self.effort
            case "I":
                return self.effort * _TIME / self.flow
            case "R":
                return self.effort / self.flow
            case _:
                return self.flow / self.effort

    def _modulus(self) -> Dimension | None:
        second = _domain_dimensions(self.dimensions, self.node.ends[1].bond)
        other = second[0] if self.node.kind == "TF" else second[1]
        if self.effort is None or other is None:
            return None
        return self.effort / other

    def matrix(self, rows: Sequence[Any]) -> Law:
        """Read the matrix of a linear field: the coefficients of the plain law."""
        if self.node.kind in SOURCES + TWO_PORTS:
            raise ModelError(
                f"a {self.node.kind} has no matrix",
                code="HB-M160",
                where=self.where,
                hint="give one value",
            )
        square = len(rows) == self.count and all(
            isinstance(r, Sequence) and not isinstance(r, str) and len(r) == self.count
            for r in rows
        )
        if not square:
            raise ModelError(
                f"the element has {self.count} bonds; its matrix must be square of that size",
                code="HB-M161",
                where=self.where,
                hint="one row per port",
            )
        given = [[constant(v, self.scope.parameters, self.where).value for v in r] for r in rows]
        if self.node.kind in STORAGES:
            import numpy as np

            whole = np.array([[settled(v, FIELD) for v in r] for r in given])
            if np.linalg.matrix_rank(whole) < self.count:
                raise ModelError(
                    "the matrix of a storage field must be invertible",
                    code="HB-M163",
                    where=self.where,
                    hint="ideal coupling is a transformer",
                )
            _check_symmetric(whole, self.where)
            given = inverse_of(whole.tolist())
        argument = self.node.about.energy or ("f" if self.output == "e" else "e")
        arguments = [
            self.locals[f"{argument}{k + 1}" if self.count > 1 else argument]
            for k in range(self.count)
        ]
        expressions = []
        for row in given:
            total: Expr = Number(0.0)
            for coefficient, name in zip(row, arguments, strict=True):
                total = Binary("+", total, Binary("*", Number(coefficient), name))
            expressions.append(simplify(total))
        return Law(self.output, tuple(expressions), tuple(map(tuple, given)))

    def full(self, value: Mapping[str, Any]) -> Law:
        """``{ e = "k*q^3" }``, ``{ f = { table = [...] } }`` or a list of these for a field."""
        output = next(iter(value), "")
        allowed = (self.output,) if self.node.kind not in ("R", "G") else ("e", "f")
        if len(value) != 1 or output not in allowed:
            raise ModelError(
                f"the law of {self.node.path!r} must give {' or '.join(allowed)}",
                code="HB-M162",
                where=self.where,
                hint=f'{{ {allowed[0]} = "..." }}',
            )
        if self.node.kind in TWO_PORTS + SOURCES:
            raise ModelError(
                f"a {self.node.kind} takes its value directly",
                code="HB-M162",
                where=self.where,
                hint=f'{self.node.kind} = "..."',
            )
        self.output = cast('Literal["e", "f"]', output)
        given = value[output]
        if self.count == 1 and not isinstance(given, list | tuple):
            given = [given]
        if not isinstance(given, list | tuple) or len(given) != self.count:
            raise ModelError(
                f"the element has {self.count} bonds; give a list of {self.count} expressions",
                code="HB-M161",
                where=self.where,
                hint='{ e = ["...", "..."] }',
            )
        expressions = tuple(
            self._table(g) if isinstance(g, Mapping) else self._formula(g, k)
            for k, g in enumerate(given)
        )
        return Law(self.output, expressions, self._linear(expressions))

    def _argument(self) -> str:
        return self.node.about.energy or ("f" if self.output == "e" else "e")

    def _formula(self, text: Any, port: int) -> Expr:
        domain = _domain_dimensions(self.dimensions, self.node.ends[port].bond)
        tree = self.read(text, domain[0 if self.output == "e" else 1], local=True)
        argument = self._argument()
        for name in sorted(names(tree)):
            if name.startswith("law:") and name[4] != argument:
                raise ModelError(
                    f"the law gives {self.output}, so it may use {argument}, not {name[4:]!r}",
                    code="HB-M162",
                    where=self.where,
                    hint=f"write it in {argument}",
                )
        return tree

    def _table(self, given: Mapping[str, Any]) -> Expr:
        unknown = set(given) - {"table", "extrapolate"}
        table = given.get("table")
        rows = list(table) if isinstance(table, list | tuple) else []
        if unknown or len(rows) != 2 or self.count != 1 or len(rows[0]) != len(rows[1]):
            raise ModelError(
                "a table law is two rows of equal length, arguments and values, on a one-port",
                code="HB-M161",
                where=self.where,
                hint="{ table = [[-1, 0, 1], [-2, 0, 2]] }",
            )
        argument = self.dimensions[f"law:{self._argument()}"]
        x = self._row(rows[0], argument)
        y = self._row(rows[1], self.effort if self.output == "e" else self.flow)
        return Table(self.locals[self._argument()], x, y, given.get("extrapolate", "error"))

    def _row(self, values: Sequence[Any], expected: Dimension | None) -> tuple[float, ...]:
        """Return a row of a table in SI, whose values with a unit are all of one kind."""
        found = []
        for value in values:
            number = constant(value, self.scope.parameters, self.where)
            given = number.dimension
            if given is not None and expected is not None and given != expected:
                raise self._wrong_unit(value, given, expected)
            expected = expected or given
            found.append(number.value)
        return tuple(found)

    def _linear(self, expressions: tuple[Expr, ...]) -> tuple[tuple[float, ...], ...] | None:
        """Return the matrix if the law is linear, without offset, and constant."""
        argument = self._argument()
        arguments = [
            f"law:{argument}{k + 1}" if self.count > 1 else f"law:{argument}"
            for k in range(self.count)
        ]
        rows = []
        for e in expressions:
            # the slope of a law that jumps does not show its jumps
            if names(e) - set(arguments) or turning(e):
                return None
            at_zero = simplify(substitute(e, {a: Number(0.0) for a in arguments}))
            row = [differentiate(e, a) for a in arguments]
            if at_zero != Number(0.0) or not all(isinstance(d, Number) for d in row):
                return None
            rows.append(tuple(d.value for d in row if isinstance(d, Number)))
        return tuple(rows)


def _check(node: Node, law: Law, where: str) -> None:
    """Refuse storage laws that have no energy; warn about nothing silently."""
    if node.kind not in STORAGES or law.matrix is None:
        return
    if len(law.matrix) == 1 and 0.0 < law.matrix[0][0] < math.inf:
        return
    import numpy as np

    m = np.array([[settled(v, FIELD) for v in row] for row in law.matrix])
    _check_symmetric(m, where)
    if np.linalg.eigvalsh(m).min() <= 0.0:
        raise ModelError(
            "the storage would have negative energy",
            code="HB-M163",
            where=where,
            hint="use positive values",
        )


def _check_symmetric(matrix: Any, where: str) -> None:
    import numpy as np

    if not np.allclose(matrix, matrix.T, rtol=1e-12, atol=0.0):
        raise ModelError(
            "the matrix of a storage field must be symmetric, else it has no energy",
            code="HB-M163",
            where=where,
            hint="split the rest off as an R field",
        )


def start_of(node: Node, written: Written, domains: Sequence[Domain]) -> tuple[list[float], str]:
    """Return the start values of a storage's ports, and whether they are stored or co-energy.

    `domains` are those of its ports.
    """
    options = written.part.options
    unknown = set(options) - _OPTIONS
    if unknown:
        from hybond.names import did_you_mean

        raise ModelError(
            f"{node.kind} {node.path!r} has no option {min(unknown)!r}",
            code="HB-M164",
            where=f"elements.{node.path}",
            hint=did_you_mean(min(unknown), _OPTIONS),
        )
    stored = node.about.energy or ""
    co_energy = node.about.imposes or ""
    given = [k for k in ("p", "q", "e", "f") if k in options]
    if any(k not in (stored, co_energy) for k in given) or len(given) > 1:
        raise ModelError(
            f"the start of a {node.kind} is {stored} or {co_energy}; given: {', '.join(given)}",
            code="HB-M165",
            where=f"elements.{node.path}",
            hint=f'{stored} = "..."',
        )
    if not given:
        return [0.0] * len(node.ends), "stored"
    key = given[0]
    where = f"elements.{node.path}.{key}"
    value = options[key]
    values = list(value) if isinstance(value, list | tuple) else [value]
    if len(values) != len(node.ends):
        raise ModelError(
            f"{len(node.ends)} start values are needed, {len(values)} given",
            code="HB-M165",
            where=where,
            hint="a list, one per port",
        )
    numbers = [constant(v, written.scope.parameters, where) for v in values]
    for n, domain in zip(numbers, domains, strict=True):
        wanted = domain.effort if key in "ep" else domain.flow
        if key in "pq":
            wanted = None if wanted is None else wanted * _TIME
        if n.dimension is not None and wanted is not None and n.dimension != wanted:
            made = units_of(values, written.scope.parameters)
            raise UnitError(
                f"the start {key} is given in {n.dimension}; it is in {wanted}{made}",
                code="HB-U103",
                where=where,
                hint=f"give it in {wanted}"
                + (", or mend the unit of the parameter" if made else ""),
            )
    return [n.value for n in numbers], "stored" if key == stored else "co-energy"


def _domain_dimensions(
    dimensions: Dimensions, bond: int
) -> tuple[Dimension | None, Dimension | None]:
    return dimensions[f"e:{bond}"], dimensions[f"f:{bond}"]
