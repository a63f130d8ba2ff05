"""The parts of an exported program that do not depend on the language it is printed in."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from hybond.errors import ModelError
from hybond.export.formulas import PRIOR, Formulas
from hybond.export.identifiers import distinct, slot_name, spoken
from hybond.export.tables import ModelTables, tables_of
from hybond.export.translate.modules import Program, load
from hybond.export.translate.reach import reached
from hybond.export.translate.specialise import specialised
from hybond.export.translate.tree import Block, Expr
from hybond.model.expressions import Name, substitute, to_text
from hybond.model.expressions import names as names_of
from hybond.model.graph import FlatGraph

ROOTS = ("make_engine", "make_report", "run_program")
"""What the printed main calls."""
OPTIONS = ("points",)
"""Whole numbers of the model that the options of the printed program change."""
NAMES = {
    "machine_name": "machines",
    "state_name": "states",
    "stored_name": "stored",
    "output_name": "outputs",
    "node_name": "nodes",
    "bond_name": "bonds",
    "rule_text": "rules",
}
"""Given functions that name something, and the list of names in `ModelTables`."""
PORTABLE = Path(__file__).parent / "portable"


@lru_cache(maxsize=1)
def runtime() -> Program:
    """Return the runtime, read and checked."""
    return load([PORTABLE / "run.py", PORTABLE / "unit.py", PORTABLE / "lookup.py"])


@dataclass(frozen=True, slots=True)
class Case:
    """One expression of the model: its number, what it is, and how it is evaluated."""

    number: int
    text: str
    value: Expr


@dataclass(frozen=True, slots=True)
class PairCase:
    """One expression on pairs."""

    number: int
    text: str
    code: Block


@dataclass(frozen=True, slots=True)
class Exported:
    """A model, ready to be printed.

    Parameters
    ----------
    tables : ModelTables
    program : Program
        The runtime.
    slots : list of (str, int, str)
        Identifier, number and meaning of the slots that expressions read.
    points : dict of str to tuple of float
        Tables that they read.
    values, pairs : list
        Expressions.
    roots : tuple of str
        Functions that main and expressions call.
    early : frozenset of str
        Functions that `values` call.
    """

    tables: ModelTables
    program: Program
    slots: list[tuple[str, int, str]]
    points: dict[str, tuple[float, ...]]
    values: list[Case]
    pairs: list[PairCase]
    roots: tuple[str, ...]
    early: frozenset[str]


def exported(graph: FlatGraph, *, roots: tuple[str, ...] = ROOTS, **options: object) -> Exported:
    """Return what a model adds to the runtime, and what `roots` need of that."""
    tables = tables_of(graph, **options)
    program = specialised(runtime(), _facts(tables))
    index = tables.slots.index
    spoken_names = {name: spoken(graph, name) for name in index}
    taken = {PRIOR, *program.constants, *program.functions, *program.records, "MODEL"}
    shown = distinct((slot_name(spoken_names[n]) for n in index), taken)
    formulas = Formulas(dict(zip(index, shown)))
    values = [
        Case(k, _said(e, text, spoken_names), formulas.number(e))
        for k, (e, text) in enumerate(zip(tables.values.all, tables.values.text))
    ]
    early = frozenset(formulas.calls)
    pairs = [
        PairCase(k, _said(e, _pair_text(tables, k), spoken_names), formulas.pairs(e))
        for k, e in enumerate(tables.pairs)
    ]
    slots = [
        (name, index[path], spoken_names[path])
        for path, name in zip(index, shown)
        if path in formulas.read
    ]
    points = {name: values for values, name in formulas.tables.items()}
    wanted = tuple(sorted({*roots, *formulas.calls}))
    found = Exported(tables, program, slots, points, values, pairs, wanted, early)
    _check(found)
    return found


def _facts(tables: ModelTables) -> dict[tuple[str, str], int]:
    """Return what is known of a model while it is printed: what it has none of, and its method."""
    known = {"method": int(tables.numbers["method"])}
    for member in runtime().records["Model"].members:
        number = tables.numbers.get(member.name)
        if member.type.kind == "int" and number == 0 and member.name not in OPTIONS:
            known[member.name] = 0
    return {("Model", name): number for name, number in known.items()}


def _pair_text(tables: ModelTables, k: int) -> str:
    return tables.rules[k] if k < len(tables.rules) else ""


def _said(e: object, text: str, spoken_names: dict[str, str]) -> str:
    """Return what an expression is: as it was written, or in the model's names."""
    if text:
        return text
    return to_text(substitute(e, {n: Name(spoken_names[n]) for n in names_of(e)}))  # type: ignore[arg-type]


def _check(found: Exported) -> None:
    """Refuse what this code and the runtime do not agree on."""
    needed = reached(found.program, found.roots)
    for name in needed.functions:
        f = found.program.functions[name]
        if f.body is None and name not in NAMES and name not in ("value", "evaluate_pair"):
            raise ModelError(
                f"the runtime asks the model for {name!r}", code="HB-E602", where=f.place
            )
