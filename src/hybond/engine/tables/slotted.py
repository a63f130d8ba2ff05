"""Which parameters can be written in what is exported, and what must hold of them.

A model is flattened with its parameters as slots. One of which a plain number was wanted is a
number then, with the reason, and the model is flattened again without it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from hybond.engine.tables.columns import ModelTables
from hybond.engine.tables.make import tables_of
from hybond.model.builder import Model
from hybond.model.expressions import Binary, Compare, Expr, Neg, Number, names, to_text
from hybond.model.expressions.slots import PREFIX, Slots
from hybond.model.expressions.tree import walk
from hybond.model.flatten import flatten
from hybond.model.graph import FlatGraph


@dataclass(frozen=True, slots=True)
class SlottedTables:
    """The tables of a model in which parameters can be written.

    Parameters
    ----------
    tables : ModelTables
        With numbers that are expressions of parameters.
    graph : FlatGraph
        Of the model as it is, with plain numbers.
    slots : Slots
    fixed : mapping
        Parameters that stay numbers, and why.
    """

    tables: ModelTables
    graph: FlatGraph
    slots: Slots
    fixed: Mapping[str, str]


def slotted_tables(
    model: Model, prepared: Callable[[FlatGraph], FlatGraph], options: Mapping[str, Any]
) -> SlottedTables:
    """Return the tables of a model whose numbers say how they follow from its parameters.

    Parameters
    ----------
    prepared : callable
        What is done to the flat graph first.
    options : mapping
        Of the run.
    """
    graph = prepared(flatten(model, {}))
    wanted = set(graph.parameters)
    fixed: dict[str, str] = {}
    while True:
        slots = Slots(wanted)
        tables = tables_of(prepared(flatten(model, {}, slots)), calling=False, **options)
        for e in (*tables.values.all, *tables.pairs):
            _ask_squares(e)
        gone = {k: f"it goes into {why}" for k, why in slots.fixed.items()} or _pinned(slots)
        if not gone:
            return SlottedTables(tables, graph, slots, fixed)
        fixed.update(gone)
        wanted -= gone.keys()


def _ask_squares(e: Expr) -> None:
    """Ask whether exponents are 2: squares are printed as products."""
    for node, _ in walk(e):
        if isinstance(node, Binary) and node.op == "^" and isinstance(node.right, Number):
            bool(node.right.value == 2.0)


def _pinned(slots: Slots) -> dict[str, str]:
    """Return the parameters that can take no other value alone, and why."""
    found: dict[str, str] = {}
    for e in slots.conditions:
        if isinstance(e, Compare) and e.op == "==":
            why = f"the model is made of other parts where not {condition_text(e)}"
            found.update((n.removeprefix(PREFIX), why) for n in sorted(names(e)))
    return found


def condition_text(e: Expr) -> str:
    """Return a condition in the names of parameters.

    Examples
    --------
    >>> from hybond.model.expressions import Compare, Name
    >>> condition_text(Compare("!=", Name("p:load.R"), Number(0.0)))
    'load.R != 0'
    """
    return to_text(e).replace(PREFIX, "")


def conditions_of(slots: Slots) -> Iterator[Expr]:
    """Yield what must hold of the parameters, each in its plainest form once.

    Where no number is infinite, a product is not zero if no factor is, and a quotient if its
    numerator is not.

    Examples
    --------
    >>> slots = Slots()
    >>> r, c = (slots.follow(k, Number(v)).value for k, v in (("R", 2.0), ("C", 3.0)))
    >>> r != 0, -r != 0, 1 / (r * c) != 0, 2 * c > 1
    (True, True, True, True)
    >>> [condition_text(e) for e in conditions_of(slots)]
    ['R != 0', '2*C > 1']
    """
    plain = dict.fromkeys(c for e in slots.conditions for c in _plainer(e) if names(c))
    for c in plain:
        stronger = (Compare(op, c.left, c.right) for op in "<>") if isinstance(c, Compare) else ()
        if not (isinstance(c, Compare) and c.op == "!=" and any(s in plain for s in stronger)):
            yield c


def _plainer(e: Expr) -> list[Expr]:
    match e:
        case Compare("!=", Neg(arg), Number(0.0)):
            return _plainer(Compare("!=", arg, Number(0.0)))
        case Compare("!=", Binary("*", a, b), Number(0.0)):
            return [c for x in (a, b) for c in _plainer(Compare("!=", x, Number(0.0)))]
        case Compare("!=", Binary("/", a, _), Number(0.0)):
            return _plainer(Compare("!=", a, Number(0.0)))
        case Compare("!=", Binary("^", a, Number()), Number(0.0)):
            return _plainer(Compare("!=", a, Number(0.0)))
        case Compare("<" | ">", Binary("/", Number(1.0), a), Number(0.0)):
            return _plainer(Compare(e.op, a, Number(0.0)))
    return [e]
