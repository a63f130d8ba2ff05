"""What may make a run: the library, or the same engine in this interpreter; chosen here alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Literal

from hybond.blocks.runners import Runner
from hybond.engine.compiled.native import NativeModel, NativeRun, Unavailable, library
from hybond.engine.compiled.sliced import SlicedRun
from hybond.engine.tables import ModelTables, tables_of, written_tables
from hybond.engine.tables.options import Options, Settings
from hybond.errors import UsageError
from hybond.model.graph import FlatGraph
from hybond.records import dataclass

if TYPE_CHECKING:
    from hybond.engine.compiled.look import Look

Asked = Literal["library", "python"]


@dataclass(frozen=True, slots=True)
class Prepared:
    """A model, prepared for runs by an engine."""

    tables: ModelTables
    written: Callable[[ModelTables], Prepared]
    """``written(tables)`` is the same with other numbers in its slots: those of these tables."""
    run: Callable[[Mapping[str, Runner] | None], SlicedRun]
    """``run(runners)`` is a run that has not begun; what runs each block is by its path."""
    look: Callable[[], Look]
    """``look()`` looks into finished runs."""


@dataclass(frozen=True, slots=True)
class EngineChoice:
    """What makes a run."""

    prepare: Callable[[ModelTables], Prepared]
    """Takes the tables of a model."""
    said: str
    """What a result says of it."""


def choose_engine(asked: Asked | None = None) -> EngineChoice:
    """Return the library if there is one, and else the engine as Python; or what is asked for.

    Raises
    ------
    UsageError
        HB-S119 if the library is asked for, and there is none, or something else is.

    Examples
    --------
    >>> choose_engine("python").said
    'the engine as Python (as asked)'
    """
    if asked not in (None, "library", "python"):
        raise UsageError(
            f"engine = {asked!r}", code="HB-S119", where="engine", hint="library or python"
        )
    why = "as asked"
    if asked != "python":
        try:
            library()
            return EngineChoice(prepared_for_library, "the library")
        except Unavailable as error:
            why = str(error)
    if asked == "library":
        raise UsageError(
            f"there is no library: {why}",
            code="HB-S119",
            where="engine",
            hint="leave engine out: the same engine runs as Python, many times slower",
        )
    return EngineChoice(prepared_for_python, f"the engine as Python ({why})")


def prepared_for_library(tables: ModelTables) -> Prepared:
    """Return a model whose tables the library reads."""
    return _native(NativeModel(tables))


def _native(model: NativeModel) -> Prepared:
    from hybond.engine.compiled.native_look import NativeLook

    return Prepared(
        model.tables,
        lambda tables: _native(model.written_with(tables)),
        lambda runners: NativeRun(model, runners=runners),
        lambda: NativeLook(model),
    )


def prepared_for_python(tables: ModelTables) -> Prepared:
    """Return a model whose tables the engine in Python reads."""
    # the whole engine is imported, which who has the library need not wait for
    from hybond.engine.interpreted.look import PythonLook
    from hybond.engine.interpreted.run import PythonModel, PythonRun

    model = PythonModel(tables)
    return Prepared(
        tables,
        prepared_for_python,
        lambda runners: PythonRun(model, runners=runners),
        lambda: PythonLook(model),
    )


def prepared(graph: FlatGraph, settings: Settings, maker: EngineChoice) -> Prepared:
    """Return a model, prepared for runs by an engine; it is kept with its graph.

    Raises
    ------
    ModelError
        As `tables_of`.
    """
    asked = settings, maker.prepare
    found: Prepared | None = graph.kept.get(asked)
    if found is None:
        found = _written(graph, settings, maker) or maker.prepare(tables_for(graph, settings))
        graph.kept.keep(asked, found)
    return found


def tables_for(graph: FlatGraph, settings: Settings) -> ModelTables:
    """Return the tables of a model for runs that are written down.

    Raises
    ------
    ModelError
        As `tables_of`.
    """
    options = Options(graph, settings.numbers, [])
    return tables_of(graph, options=options, calling=True, tells=True)


def _written(graph: FlatGraph, settings: Settings, maker: EngineChoice) -> Prepared | None:
    """Return what was prepared with slots, numbers written into them, if they fit."""
    w = graph.written
    if w is None:
        return None
    slotted = prepared(w.graph, settings, maker)
    # what tables are made of may ask more of the parameters than the graph does
    if not w.writing.fits(w.row):
        return None
    try:
        return slotted.written(written_tables(slotted.tables, graph, w))
    except ArithmeticError:
        return None
