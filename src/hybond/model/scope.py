"""One opened model with the values of its parameters, and what an expression of them is."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import field
from numbers import Real

from hybond.errors import ModelError
from hybond.model.builder import Model
from hybond.model.expressions import (
    Expr,
    Number,
    names,
    parse,
    simplify,
    substitute,
    transform,
)
from hybond.model.expressions.slots import plain
from hybond.model.parts import Value
from hybond.records import dataclass
from hybond.units import DIMENSIONLESS, try_quantity


@dataclass(slots=True)
class Scope:
    """One opened model: its dotted prefix and the values of its parameters."""

    prefix: str
    model: Model
    parameters: dict[str, Number] = field(default_factory=dict)
    index: str = ""
    """Which of the parameters is the index of the array that this is said of; none if empty."""


def literal(value: Value, where: str) -> Expr:
    """Return a number, a quantity or an expression as a tree."""
    if isinstance(value, bool) or not isinstance(value, Real | str):
        raise ModelError(
            f"{value!r} is not a number, a quantity or an expression",
            code="HB-M110",
            where=where,
            hint='write 2.5, "10 mA" or "2*k"',
        )
    if isinstance(value, str):
        quantity = try_quantity(value)
        if quantity is None:
            return parse(value, where=where)
        bare = quantity.dimension == DIMENSIONLESS
        number = Number(quantity.value, None if bare else quantity.dimension)
    else:
        number = Number(float(value))
    if abs(number.value) == float("inf") or number.value != number.value:
        raise ModelError(
            f"{value!r} is not a finite number", code="HB-M110", where=where, hint="use a number"
        )
    return number


def without_units(e: Expr) -> Expr:
    """Return the tree with plain SI numbers: units have done their work once checked."""
    return transform(e, lambda n: Number(n.value) if isinstance(n, Number) else n)


def constant(
    value: Value,
    parameters: Mapping[str, Number],
    where: str,
    *,
    known: Collection[str] | None = None,
) -> Number:
    """Return the value of an expression of parameters, in SI, with its dimension.

    What is `known` by name, but has no value yet, may be meant by a name that is wrong.

    Raises
    ------
    ModelError
        HB-M107 for an unknown name, HB-M110 if the result is not a finite number.
    """
    from hybond.model.dimensions import infer_dimension, instead_of, powered

    tree = literal(value, where)
    if isinstance(tree, Number):
        return tree
    for name in sorted(names(tree), key=lambda n: (not powered(n), n)):
        if name not in parameters:
            raise ModelError(
                f"{name!r} is not a parameter; a value here is made of parameters and numbers",
                code="HB-M107",
                where=where,
                hint=powered(name)
                or instead_of(name, [*(parameters if known is None else known)])
                or "write a number, or give the model such a parameter",
            )
    bound = substitute(tree, parameters)
    dimension = infer_dimension(bound, lambda _: None, where=where)
    folded = simplify(without_units(bound))
    if not isinstance(folded, Number) or not math.isfinite(plain(folded.value)):
        raise ModelError(
            f"{value!r} has no finite value", code="HB-M110", where=where, hint="look for 1/0"
        )
    return Number(folded.value, dimension)
