"""The parts of an exported program that do not depend on the language it is printed in."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache

from hybond.engine.compiled.sources import ENGINE, portable_paths
from hybond.engine.tables import ModelTables
from hybond.engine.tables.calls import refuse_calls
from hybond.engine.tables.slotted import slotted_tables
from hybond.export import kept
from hybond.export.formulas import ARRAY, PRIOR, Formulas
from hybond.export.identifiers import distinct, slot_name, spoken
from hybond.export.parameters import Names, Parameters
from hybond.model.builder import Model
from hybond.model.expressions import Name, substitute, to_text
from hybond.model.expressions import names as names_of
from hybond.model.expressions.slots import plain
from hybond.model.graph import FlatGraph
from hybond.translate.effects import Effects, effects_of
from hybond.translate.modules import Program, load, text_of
from hybond.translate.reach import Uses, uses_of
from hybond.translate.specialise import Facts, Specialist, deciding
from hybond.translate.tree import Block, Expr
from hybond.uncollected import uncollected

ROOTS = ("make_engine", "make_report", "run_program")
"""What the printed main calls."""
DRIVEN = (
    *("make_engine", "make_report", "make_run", "begin_unit", "set_input", "take_inputs"),
    *("advance", "output_now", "rates_now", "indicators_now", "indicators_of"),
    *("settle_unit", "guard_holds", "nominal_now"),
)
"""What somebody calls who drives the run: the functions of a functional mock-up unit."""
SET = (("Model", "rtol"), ("Model", "atol"))
"""What the options of a printed program set, though a method of fixed steps does not read it."""
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
GIVEN = frozenset((*NAMES, "value", "evaluate_pair"))
"""What the runtime asks of a model, and is printed here."""
LOG_OR_REPORT = ("from hybond.engine.run.log import", "from hybond.engine.run.report import")
"""Where the executive has from what writes down what happens: by itself, and in a program."""
OWN = (
    *(ARRAY, "MODEL", "USAGE", "PARAMETERS", "PARAMETER", "FIXED", "FIXED_PARAMETER"),
    *("PARAMETER_START", "PARAMETER_FOLLOWS", "TOKEN", "INPUTS", "INPUT_NUMBER", "INPUT_START"),
    *("FIRST_INPUT", "FIRST_OUTPUT", "FIRST_STATE", "FIRST_DERIVATIVE", "FIRST_INDICATOR"),
    *("BEYOND_LAST", "EXPORT", "NOTHING", "ABSENT", "FINE", "BOTH"),
)
"""What printed programs and units call what is not of the runtime."""


@lru_cache(maxsize=1)
@uncollected
def _whole() -> kept.Read:
    """Return the runtime: as it was read before, or read and checked and kept."""
    found = kept.runtime_kept()
    if found is None:
        program = _read()
        effects = effects_of(program, (*ROOTS, *DRIVEN))
        found = kept.Read(program, effects, uses_of(program), deciding(program))
        kept.keep_runtime(found)
    return found


def _read() -> Program:
    """Return the runtime, read and checked: what logs is replaced by what prints."""
    run = ENGINE / "run"
    roots = [run / "run.py", run / "unit.py", ENGINE / "expressions" / "lookup.py"]
    return load(roots, portable_paths(), lambda path: text_of(path).replace(*LOG_OR_REPORT))


def runtime() -> Program:
    """Return the runtime; where it was read before, its functions have no bodies."""
    return _whole().program


@dataclass
class Maker:
    """What makes the runtime of one model in a language, and keeps what it printed.

    Parameters
    ----------
    language : str
        ``c`` or ``java``.
    """

    language: str
    specialist: Specialist = field(init=False)
    texts: dict[int, list[str]] = field(default_factory=dict)
    """Definitions that were printed, by the identity of the function."""
    _before: kept.Printed = field(init=False)

    def __post_init__(self) -> None:
        found, self._before = _whole(), kept.printed_kept(self.language)
        self.specialist = Specialist(
            found.program,
            found.effects,
            uses=found.uses,
            bodies=found.bodies,
            known=self._before.uses,
        )

    def program_for(self, facts: Facts) -> Runtime:
        """Return the runtime where facts hold."""
        program, uses = self.specialist.program_for(facts)
        for made, f in self.specialist.made.items():
            if id(f) not in self.texts and made in self._before.texts:
                self.texts[id(f)] = self._before.texts[made].split("\n")
        return Runtime(program, self.specialist.effects, uses)

    def keep(self) -> None:
        """Keep what was printed, if some of it is new."""
        own, before = self.specialist, self._before
        uses = {made: own.made_uses[id(f)] for made, f in own.made.items()}
        texts = {
            made: "\n".join(self.texts[id(f)])
            for made, f in own.made.items()
            if id(f) in self.texts and made not in before.texts
        }
        if texts or not uses.keys() <= before.uses.keys():
            before.uses.update(uses)
            before.texts.update(texts)
            kept.keep_printed(self.language, before)


@lru_cache(maxsize=2)
@uncollected
def maker_of(language: str) -> Maker:
    """Return what makes runtimes in a language."""
    return Maker(language)


@dataclass(frozen=True, slots=True)
class Runtime:
    """The runtime of one model: a program, what its functions change, and what they use."""

    program: Program
    effects: Effects
    uses: Mapping[str, Uses]


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
    """A model, ready to be printed."""

    tables: ModelTables
    runs: Runtime
    slots: list[tuple[str, int, str]]
    """Identifier, number and meaning of the slots that expressions read."""
    points: dict[str, tuple[float, ...]]
    """Tables that they read."""
    values: list[Case]
    pairs: list[PairCase]
    """`values` and `pairs`: expressions."""
    roots: tuple[str, ...]
    """Functions that main and expressions call."""
    graph: FlatGraph
    """With plain numbers."""
    parameters: Parameters


@uncollected
def exported(
    model: Model,
    *,
    language: str = "c",
    roots: tuple[str, ...] = ROOTS,
    options: Mapping[str, object],
    prepared: Callable[[FlatGraph], FlatGraph] = lambda graph: graph,
) -> Exported:
    """Return what a model adds to the runtime, and what `roots` need of that.

    `prepared` is done to its flat graph first.
    """
    refuse_calls(model.flatten())  # before what is only not said yet, such as the end of the run
    found = slotted_tables(model, prepared, options)
    graph, tables = found.graph, found.tables
    names = Names(found)
    all_values = [names.lifted(tree) for tree in tables.values.all]
    all_pairs = [names.lifted(tree) for tree in tables.pairs]
    runs = maker_of(language).program_for(_facts(tables))
    program = runs.program
    index = tables.slots.index
    spoken_names = {name: spoken(graph, name) for name in index}
    taken = {PRIOR, *program.constants, *program.functions, *program.records, *OWN}
    shown = distinct((slot_name(spoken_names[n]) for n in index), taken)
    shown_parameters = names.shown({*taken, *shown})
    spoken_names |= names.spoken()
    formulas = Formulas(dict(zip(index, shown)), shown_parameters)
    values = [
        Case(k, _said(e, text, spoken_names), formulas.number(e))
        for k, (e, text) in enumerate(zip(all_values, tables.values.text))
    ]
    pairs = [
        PairCase(k, _said(e, _pair_text(tables, k), spoken_names), formulas.pairs(e))
        for k, e in enumerate(all_pairs)
    ]
    parameters = names.parameters(shown_parameters, formulas)
    slots = [
        (name, index[path], spoken_names[path])
        for path, name in zip(index, shown)
        if path in formulas.read
    ]
    points = {name: tuple(map(plain, values)) for values, name in formulas.tables.items()}
    wanted = tuple(sorted({*roots, *formulas.calls}))
    tables = replace(tables, floats={k: [*map(plain, row)] for k, row in tables.floats.items()})
    return Exported(tables, runs, slots, points, values, pairs, wanted, graph, parameters)


def _facts(tables: ModelTables) -> dict[tuple[str, str], int]:
    """Return what is known of a model while it is printed: what it has none of, and its method."""
    known = {"method": int(tables.numbers["method"])}
    for member in runtime().records["Model"].members:
        number = tables.numbers.get(member.name)
        if member.type.kind == "int" and number == 0 and member.name not in OPTIONS:
            known[member.name] = 0
    named = {("Model", name): number for name, number in known.items()}
    return {place: number for place, number in named.items() if place in _whole().deciding}


def _pair_text(tables: ModelTables, k: int) -> str:
    return tables.rules[k] if k < len(tables.rules) else ""


def _said(e: object, text: str, spoken_names: dict[str, str]) -> str:
    """Return what an expression is: as it was written, or in the model's names."""
    if text:
        return text
    return to_text(substitute(e, {n: Name(spoken_names[n]) for n in names_of(e)}))  # type: ignore[arg-type]
