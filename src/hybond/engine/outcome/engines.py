"""What may make a run: the library, or the same engine in this interpreter; chosen here alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybond.blocks.runners import Runner
from hybond.engine.compiled.look import Look
from hybond.engine.compiled.native import NativeModel, NativeRun, Unavailable, library
from hybond.engine.compiled.native_look import NativeLook
from hybond.engine.compiled.refusal import Refusal
from hybond.engine.compiled.rows import Rows
from hybond.engine.tables import ModelTables, tables_of, written_tables
from hybond.engine.tables.options import Options, Settings
from hybond.errors import UsageError
from hybond.model.graph import FlatGraph

Asked = Literal["library", "python"]


class SlicedRun(Protocol):
    """A run in slices, as `NativeRun` is, which says what all this means."""

    status: int

    def slices(
        self,
        *,
        steps: int | Callable[[], int] = ...,
        between: Callable[[float], None] | None = None,
    ) -> Iterator[Rows]:
        """Run on to the end; yield what was written down, slice after slice."""

    def tried(self, state: ArrayLike) -> NDArray[np.intc] | None:
        """Enter a mode at the start: of each rule whether it leaves it."""

    @property
    def t(self) -> float:
        """The time that was reached, s."""

    @property
    def y(self) -> NDArray[Any]:
        """The state there."""

    @property
    def mode(self) -> tuple[int, ...]:
        """The state of each machine."""

    @property
    def fault(self) -> Refusal:
        """What stopped the run."""

    @property
    def unrest(self) -> Refusal:
        """Why a structure at rest had no solution."""

    @property
    def stuck(self) -> tuple[int, int, int, float, float]:
        """What is known of events that accumulate."""

    @property
    def energy(self) -> float:
        """The largest energy that the run has seen, J."""

    @property
    def rejected(self) -> int:
        """Steps that were tried and found too long."""

    @property
    def evaluations(self) -> int:
        """How often the rates of the state were evaluated."""

    @property
    def modes_made(self) -> int:
        """Modes whose equations were made."""

    @property
    def propagated(self) -> list[int]:
        """Modes that were propagated exactly, and those that were not."""


@dataclass(frozen=True, slots=True)
class Prepared:
    """A model, prepared for runs by an engine.

    Parameters
    ----------
    tables : ModelTables
    written : callable
        ``written(tables)`` is the same with other numbers in its slots: those of these tables.
    run : callable
        ``run(runners)`` is a run that has not begun; what runs each block is by its path.
    look : callable
        ``look()`` looks into finished runs.
    """

    tables: ModelTables
    written: Callable[[ModelTables], Prepared]
    run: Callable[[Mapping[str, Runner] | None], SlicedRun]
    look: Callable[[], Look]


@dataclass(frozen=True, slots=True)
class EngineChoice:
    """What makes a run.

    Parameters
    ----------
    prepare : callable
        Takes the tables of a model.
    said : str
        What a result says of it.
    """

    prepare: Callable[[ModelTables], Prepared]
    said: str


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
