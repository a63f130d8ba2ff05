"""The parameters of an exported program: what may be set, and all that follows from it.

They stand in an array, with the numbers behind them that follow from them and are read by
expressions. What follows is computed only where a parameter is set: the numbers that the model
has as it is written are in the program.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from hybond.engine.tables.slotted import SlottedTables, condition_text, conditions_of
from hybond.export.formulas import Formulas
from hybond.export.identifiers import distinct, slot_name
from hybond.model import expressions as e
from hybond.model.expressions.slots import PREFIX, is_slotted, slot_of, tree_of
from hybond.translate.tree import Expr
from hybond.units import DIMENSIONLESS, Dimension


@dataclass(frozen=True, slots=True)
class Parameter:
    """What may be set.

    Parameters
    ----------
    path : str
        Its name in the model.
    shown : str
        The constant that says where it stands.
    start : float
        SI.
    dimension : Dimension or None
    made_of : Expr or None
        Its value where it is not set, if that follows from other parameters.
    text : str
        The same in names of parameters.
    """

    path: str
    shown: str
    start: float
    dimension: Dimension | None
    made_of: Expr | None
    text: str

    @property
    def unit(self) -> str:
        """Its unit in words, empty if it has none."""
        return "" if self.dimension in (None, DIMENSIONLESS) else str(self.dimension)


@dataclass(frozen=True, slots=True)
class Number:
    """A number that expressions read and that follows from parameters."""

    shown: str
    start: float
    value: Expr
    text: str


@dataclass(frozen=True, slots=True)
class Entry:
    """An entry of a table, and the value that it takes."""

    table: str
    index: int
    value: Expr


@dataclass(frozen=True, slots=True)
class Condition:
    """What must hold of parameters so that the model is made of the same parts."""

    holds: Expr
    text: str


@dataclass(frozen=True, slots=True)
class Parameters:
    """All of it.

    Parameters
    ----------
    settable : list of Parameter
        Each is made of those before it.
    numbers : list of Number
    entries : list of Entry
        Of the tables of the model.
    points : list of Entry
        Of the tables that expressions read.
    conditions : list of Condition
    fixed : dict of str to str
        Parameters that cannot be set, and why.
    """

    settable: list[Parameter] = field(default_factory=list)
    numbers: list[Number] = field(default_factory=list)
    entries: list[Entry] = field(default_factory=list)
    points: list[Entry] = field(default_factory=list)
    conditions: list[Condition] = field(default_factory=list)
    fixed: Mapping[str, str] = field(default_factory=dict)

    @property
    def tables(self) -> set[str]:
        """The tables that are written to."""
        return {entry.table for entry in (*self.entries, *self.points)}


class Names:
    """The names that expressions call parameters by, and numbers that follow from them.

    Parameters
    ----------
    found : SlottedTables
    """

    def __init__(self, found: SlottedTables) -> None:
        self.found = found
        self.slots = found.slots.parameters
        self._numbers: dict[e.Expr, tuple[str, float]] = {}

    def lifted(self, tree: e.Expr) -> e.Expr:
        """Return an expression that reads parameters where it had numbers that follow from them."""
        return e.transform(tree, self._lifted)

    def _lifted(self, node: e.Expr) -> e.Expr:
        slot = slot_of(node)
        if slot is None:
            return node
        tree = slot.tree
        if isinstance(tree, e.Name) or (isinstance(tree, e.Neg) and isinstance(tree.arg, e.Name)):
            return tree
        name, _ = self._numbers.setdefault(tree, (f"{PREFIX}={len(self._numbers)}", slot.value))
        return e.Name(name)

    def spoken(self) -> dict[str, str]:
        """Return what a person calls them."""
        found = {PREFIX + path: path for path in self.slots}
        found |= {name: f"({condition_text(k)})" for k, (name, _) in self._numbers.items()}
        return found

    def shown(self, taken: set[str]) -> dict[str, str]:
        """Return the constants that say where they stand, by name."""
        wanted = [slot_name(path) for path in self.slots]
        wanted += [f"NUMBER_{k + 1}" for k in range(len(self._numbers))]
        return dict(zip(self.spoken(), distinct(wanted, taken)))

    def parameters(self, shown: Mapping[str, str], formulas: Formulas) -> Parameters:
        """Return what is printed of them, once all expressions are `formulas`."""
        f = self.found
        value: Callable[[e.Expr], Expr] = formulas.number
        settable = [
            Parameter(
                path,
                shown[PREFIX + path],
                p.start,
                p.dimension,
                None if p.made_of is None else value(p.made_of),
                "" if p.made_of is None else condition_text(p.made_of),
            )
            for path, p in self.slots.items()
        ]
        numbers = [
            Number(shown[name], start, value(tree), condition_text(tree))
            for tree, (name, start) in self._numbers.items()
        ]
        entries = [
            Entry(table, k, value(tree_of(x)))
            for table, row in f.tables.floats.items()
            for k, x in enumerate(row)
            if is_slotted(x)
        ]
        conditions = [
            Condition(formulas.truth(c), condition_text(c)) for c in conditions_of(f.slots)
        ]
        points = [
            Entry(name, k, value(tree_of(x)))
            for row, name in list(formulas.tables.items())
            for k, x in enumerate(row)
            if is_slotted(x)
        ]
        return Parameters(settable, numbers, entries, points, conditions, f.fixed)
