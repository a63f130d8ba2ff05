"""Members that are made of the same parts: rows of numbers for the slots of one model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hybond.engine.compiled.members import Ran
from hybond.engine.compiled.native import NativeModel
from hybond.engine.outcome.engines import tables_for
from hybond.engine.tables.bands import banded
from hybond.engine.tables.options import Settings, notices
from hybond.errors import HybondError
from hybond.measures.naming import names_of, read_name
from hybond.model.builder import Model
from hybond.model.expressions import (
    ARRAYS,
    Expr,
    Name,
    compile_expression,
    names,
    transform,
    uses_pre,
)
from hybond.model.expressions.slots import Slots, slot_of
from hybond.model.flatten import flatten
from hybond.model.graph import FlatGraph
from hybond.model.junction_laws import warn_of_values
from hybond.model.parts import Value
from hybond.model.unit_words import unit_of
from hybond.model.written import Writing
from hybond.runs.times import check_instants

if TYPE_CHECKING:
    from hybond.sweep.measured import Measure, Measuring

Vector = NDArray[np.float64]


class Family:
    """A model whose parameters are slots, and what is looked at in its runs.

    Parameters
    ----------
    graph : FlatGraph
        With slots.
    slots : Slots
    settings : Settings
    wanted : sequence of str
        Outputs; if there are none, those of a result.
    impact : str or None
        The law of impacts that was asked for.
    measures : sequence of Measure
        What is measured of its runs.

    Raises
    ------
    HybondError
        For a model that cannot be run so, or an output that does not exist.
    """

    def __init__(
        self,
        graph: FlatGraph,
        slots: Slots,
        settings: Settings,
        wanted: Sequence[str],
        impact: str | None,
        measures: Sequence[Measure] = (),
    ) -> None:
        self.names = tuple(wanted) or tuple(names_of(graph))
        self.warnings = (*notices(graph, settings, impact), *graph.warnings)
        expressions = [read_name(graph, name) for name in self.names]
        self.units = {n: unit_of(e, graph) for n, e in zip(self.names, expressions, strict=True)}
        tables = tables_for(graph, settings)
        self.called = bool(tables.numbers["called"] or tables.numbers["blocks"])
        self._index, self._size = tables.slots.index, tables.slots.size
        self.kinks = bool(tables.numbers["kinks"])
        self._numbers: dict[Expr, str] = {}
        self._expressions = [transform(e, self._lifted) for e in expressions]
        signals = [read_name(graph, m.signal) for m in measures]
        self.prior = any(map(uses_pre, signals))
        lifted = [transform(e, self._lifted) for e in signals]
        numbers = set(self._numbers.values())
        read = {n for e in self._expressions for n in names(e)} - numbers
        prior = any(map(uses_pre, expressions))
        own = sorted(self._index[n] for n in read)
        reads = [sorted(self._index[n] for n in {*names(e)} - numbers) for e in lifted]
        self.measured = np.array(sorted({k for read in reads for k in read}), dtype=np.intc)
        # extremes ask for what the end of a run leaves, too
        ends = self.measured.tolist() if any(m.is_extreme for m in measures) else []
        looked = [*own, *(k + self._size for k in own if prior)]
        self.looked = np.array([*looked, *(k for k in ends if k not in looked)], dtype=np.intc)
        self.model = NativeModel(tables)
        self._own = len(self.model.written)
        trees = [tree for _, _, tree in self.model.written]
        self._writing = Writing(slots, [*trees, *self._numbers])
        index = dict(self._index)
        for j, name in enumerate(self._numbers.values()):
            index[name] = 2 * self._size + j
        self._outputs, self._measured = (
            [compile_expression(e, index, ARRAYS, pre_offset=self._size) for e in own]
            for own in (self._expressions, lifted)
        )
        self.measuring: Measuring | None = None
        if measures:
            from hybond.sweep.measured import Measuring

            self.measuring = Measuring(
                measures,
                [isinstance(e, Name) for e in signals],
                [np.searchsorted(self.measured, own) for own in reads],
                np.array([self.looked.tolist().index(k) for k in ends], dtype=np.intp),
            )

    def numbers(
        self, given: Mapping[str, Vector], many: int
    ) -> tuple[NDArray[np.bool_], Vector, Vector]:
        """Return which members are of this family, and what is written for each.

        The numbers that outputs read stand behind those of the tables.
        """
        fits, found = self._writing.of(given, many)
        return fits, found[:, : self._own], found[:, self._own :]

    def values(self, out: Vector, read: Vector) -> Vector:
        """Return outputs, shape (outputs, members, times), of what was looked at."""
        columns: list[Vector] = [np.zeros(0)] * (2 * self._size)
        for j, k in enumerate(self.looked.tolist()):
            columns[k] = np.ascontiguousarray(out[:, :, j])
        for j in range(len(self._numbers)):
            columns.append(np.broadcast_to(read[:, j : j + 1], out.shape[:2]))
        found = np.empty((len(self.names), *out.shape[:2]))
        for k, output in enumerate(self._outputs):
            found[k] = output(columns)
        return found

    def measure(self, ran: Ran, read: Vector) -> tuple[Vector, NDArray[np.bool_]]:
        """Return measurements, shape (measures, members), and of which members all are known."""
        assert self.measuring is not None

        def values(k: int, slots: Vector, member: NDArray[np.intp]) -> Vector:
            columns: list[Vector] = [np.zeros(0)] * (2 * self._size)
            for j, slot in enumerate(self.measured.tolist()):
                columns[slot] = np.ascontiguousarray(slots[:, j])
            columns += [read[member, j] for j in range(len(self._numbers))]
            found = self._measured[k](columns)
            return np.broadcast_to(np.asarray(found, dtype=float), member.shape)

        return self.measuring.of(ran, values)

    def constant(self, k: int, read: Vector) -> Vector | None:
        """Return an output that is made of parameters alone, of each member; None of another."""
        index = {name: j for j, name in enumerate(self._numbers.values())}
        e = self._expressions[k]
        if not set(names(e)) <= index.keys():
            return None
        columns = [np.ascontiguousarray(read[:, j]) for j in range(read.shape[1])]
        found = compile_expression(e, index, ARRAYS, pre_offset=0)(columns)
        return np.array(np.broadcast_to(np.asarray(found, dtype=float), (len(read),)))

    def _lifted(self, node: Expr) -> Expr:
        """Return the name of a number that parameters write, in an output."""
        slot = slot_of(node)
        if slot is None:
            return node
        return Name(self._numbers.setdefault(slot.tree, f"p:={len(self._numbers)}"))


def family_of(
    model: Model,
    given: Mapping[str, Value],
    settings: Settings,
    band: float | None,
    wanted: Sequence[str],
    impact: str | None,
    measures: Sequence[Measure] = (),
) -> Family | None:
    """Return the family of a member; None for one that only an ordinary run can tell of."""
    slots = Slots()
    try:
        graph = flatten(model, given, slots)
        if band is not None:
            graph = banded(graph, band)
        check_instants(graph, settings.until)
        differ = warn_of_values(graph)
        found = Family(graph, slots, settings, wanted, impact, measures)
    except HybondError:
        return None
    if measures and (found.kinks or found.prior or not len(found.measured)):
        return None  # of which a run reads limits from the left, and what was before
    return None if found.called or differ else found
