"""The tables of a model, in no language, and columns of them."""

from __future__ import annotations

from dataclasses import field, replace
from typing import Any

from hybond.engine.tables.expressions import Expressions, number_of
from hybond.equations.slots import Slots
from hybond.model.expressions import Expr
from hybond.model.graph import FlatGraph
from hybond.model.written import Written
from hybond.records import dataclass


@dataclass(slots=True)
class ModelTables:
    """What a model brings along, in no language.

    Parameters
    ----------
    graph : FlatGraph
    slots : Slots
        Where names stand in the vector of values.
    numbers : dict
        Whole numbers and floats of `hybond.engine.model.Model`, by field.
    ints, floats : dict
        Its arrays, by field.
    values : Expressions
        What `value(m, k, v)` answers.
    pairs : list of Expr
        What `evaluate_pair(m, k, s)` answers: guards, then rates of integrated signals.
    machines, states, stored, outputs, nodes, bonds, rules : list of str
        Names, by number.
    reasons : list of str
        Why modes are not propagated exactly, by number.
    """

    graph: FlatGraph
    slots: Slots
    numbers: dict[str, float] = field(default_factory=dict)
    ints: dict[str, list[int]] = field(default_factory=dict)
    floats: dict[str, list[float]] = field(default_factory=dict)
    values: Expressions = field(default_factory=Expressions)
    pairs: list[Expr] = field(default_factory=list)
    machines: list[str] = field(default_factory=list)
    states: list[str] = field(default_factory=list)
    stored: list[str] = field(default_factory=list)
    outputs: list[str] = field(default_factory=list)
    nodes: list[str] = field(default_factory=list)
    bonds: list[str] = field(default_factory=list)
    rules: list[str] = field(default_factory=list)
    reasons: list[str] = field(default_factory=list)


def written_tables(t: ModelTables, graph: FlatGraph, written: Written) -> ModelTables:
    """Return tables with numbers where there are slots; `graph` is theirs."""
    values = Expressions()
    values.all, values.text = written.put(t.values.all, stays=True), t.values.text
    floats, pairs = (written.put(part, stays=True) for part in (t.floats, t.pairs))
    return replace(t, graph=graph, floats=floats, values=values, pairs=pairs)


def first_of(rows: list[list[Any]]) -> list[int]:
    """Return where each row begins in all of them, and where the last ends."""
    found = [0]
    for row in rows:
        found.append(found[-1] + len(row))
    return found


def put_rows(t: ModelTables, first: str, rows: list[list[Any]], **columns: list[Any]) -> None:
    """Put rows into the tables: where they begin, and a column for each item of their entries."""
    t.ints[first] = first_of(rows)
    for k, name in enumerate(columns):
        flat = [entry[k] for row in rows for entry in row]
        if columns[name] is FLOATS:
            t.floats[name] = [number_of(a) for a in flat]
        else:
            t.ints[name] = [int(a) for a in flat]


INTS: list[Any] = []
FLOATS: list[Any] = [0.0]
"""What the entries of a column are."""
