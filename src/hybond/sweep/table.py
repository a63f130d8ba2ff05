"""`SweepTable`: what was collected of the members of a sweep, column by column, part by part."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.errors import UsageError
from hybond.files.whole import whole
from hybond.model.builder import Model
from hybond.model.parts import Value
from hybond.names import did_you_mean
from hybond.sweep.collect import Collector
from hybond.sweep.job import Job
from hybond.sweep.part import Part
from hybond.sweep.views import Views
from hybond.units import DIMENSIONLESS, Dimension, try_quantity

if TYPE_CHECKING:
    from hybond.result import Result

OWN = ("status", "t_end", "code", "message", "warnings")
"""Columns that every table has behind the parameters."""


class SweepTable(Views):
    """A row for each member of a sweep: parameters, how it ended, what was collected.

    Columns are read from the parts of the sweep when they are asked for, so that a table of
    millions of rows takes the memory of the columns that one looks at.

    Parameters
    ----------
    job : Job
    collectors : tuple of Collector
    ranges : sequence of tuple
        First and last number of each part.
    read : callable
        ``read(first, last)`` returns a part.
    folder : Path or None
        Where it lies.

    Attributes
    ----------
    folder : Path or None
    how, notes : str, tuple of str
        How it was run; what is to be said of it: workers that died, parts that were damaged.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical", parameters={"r": "1 kohm"})
    >>> m.add(c=hb.C("1 mF", e="10 V"), r1=hb.R("r"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r1")
    >>> table = hb.sweep(m, {"r": "500, 1000, 2000"}, until="1 s", collect="final(c.e)")
    >>> table
    <SweepTable 'rc': 3 members, grid of r, all ok>
    >>> table["final(c.e)"].round(6).tolist(), table["r"].tolist()
    ([1.353353, 3.678794, 6.065307], [500.0, 1000.0, 2000.0])
    """

    def __init__(
        self,
        job: Job,
        collectors: tuple[Collector, ...],
        ranges: Sequence[tuple[int, int]],
        read: Callable[[int, int], Part],
        folder: Path | None = None,
    ) -> None:
        self.job, self.collectors, self.folder = job, collectors, folder
        self._ranges, self._read = tuple(ranges), read
        self._last: Part | None = None
        self._rows: tuple[tuple[int, int], dict[str, Any]] = ((0, 0), {})
        self.how = ""
        self.seconds = 0.0
        self.notes: tuple[str, ...] = ()
        self.interrupted = False

    @property
    def plan(self) -> Any:
        """The `Plan`."""
        return self.job.plan

    @property
    def title(self) -> str:
        """The model's title, or its name."""
        return self.job.model.title or self.job.model.name

    @property
    def columns(self) -> list[str]:
        """Names of the columns; curves are none."""
        names = ["member", *self.plan.paths, *OWN]
        return names + [c.text for c in self.collectors if c.kind != "curve"]

    def __len__(self) -> int:
        """Return how many members there are."""
        return sum(last - first for first, last in self._ranges)

    def parts(self) -> Iterator[Part]:
        """Return the parts in order, each read when it is its turn."""
        for first, last in self._ranges:
            if self._last is None or (self._last.first, self._last.last) != (first, last):
                self._last = self._read(first, last)
            yield self._last

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return a column over the members; of a curve, members and times.

        Raises
        ------
        UsageError
            HB-P109 for one that there is not.
        """
        known = [*dict.fromkeys([*self.columns, *(c.text for c in self.collectors)])]
        if name not in known:
            raise UsageError(
                f"the table has no column {name!r}",
                code="HB-P109",
                where="table",
                hint=did_you_mean(name, known),
            )
        found = [self._of_part(part, name) for part in self.parts()]
        if not found:
            return np.zeros(0)
        if isinstance(found[0], list):
            return np.array([word for part in found for word in part], dtype=object)
        return np.concatenate(found)

    def unit(self, name: str) -> str:
        """Return the SI unit of a column, empty if there is none or it is not known."""
        if name == "t_end":
            return "s"
        for factor in self.plan.factors:
            if factor.path == name:
                dimension = factor.dimension or _written(self.job.model, name)
                return "" if dimension is None else str(dimension)
        return next((c.unit for c in self.collectors if c.text == name), "")

    def _of_part(self, part: Part, name: str) -> Any:
        if name in part.columns and name not in (*self.plan.paths, *OWN):
            return part.columns[name]
        if name == "member":
            return np.arange(part.first, part.last)
        if name == "status":
            return part.status
        if name == "t_end":
            return part.t_end
        if name in OWN:
            found = [""] * len(part)
            for k in part.said:
                found[k] = _said(part, k, name)
            return found
        if (part.first, part.last) != self._rows[0]:
            self._rows = ((part.first, part.last), self.plan.rows(part.first, part.last))
        values = self._rows[1][name]
        return values if isinstance(values, np.ndarray) else list(values)

    def counts(self) -> dict[str, int]:
        """Return how many members ended in which way, failures by their code."""
        found: Counter[str] = Counter()
        for part in self.parts():
            found.update(part.status)
            for k, (code, *_) in part.said.items():
                if code:
                    found[part.status[k]] -= 1
                    found[f"{part.status[k]} ({code})"] += 1
        found = +found
        return dict(sorted(found.items(), key=lambda item: (-item[1], item[0])))

    def rows(self, first: int, last: int) -> list[list[Any]]:
        """Return the rows of members `first` to `last` - 1 that are there, cells by `columns`."""
        found: list[list[Any]] = []
        for a, b in self._ranges:
            here = slice(max(first - a, 0), max(min(last, b) - a, 0))
            if here.start < here.stop and a < last and b > first:
                part = self._read(a, b)
                columns = [self._cells(part, name)[here] for name in self.columns]
                found += map(list, zip(*columns, strict=True))
        return found

    def parameters(self, member: int) -> dict[str, Value]:
        """Return what a member is run with, as ``parameters=`` of `hybond.simulate`.

        Raises
        ------
        UsageError
            HB-P109 for a member that there is not.
        """
        if not 0 <= member < len(self.plan):
            raise UsageError(
                f"there is no member {member}",
                code="HB-P109",
                where="member",
                hint=f"0 to {len(self.plan) - 1}",
            )
        rows = self.plan.rows(member, member + 1)
        given = {p: v[0] if isinstance(v, list) else float(v[0]) for p, v in rows.items()}
        return {**self.job.fixed, **given}

    def run(self, member: int) -> Result:
        """Run a member again, and return all of it; an error is in ``result.error``.

        Raises
        ------
        UsageError
            HB-P109 for a member that there is not.
        """
        from hybond.simulation import simulate

        return simulate(
            *(self.job.model, self.job.whole_until),
            parameters=self.parameters(member),
            on_error="return",
            **self.job.options,
        )

    # -- other forms

    def to_pandas(self) -> Any:
        """Return a DataFrame with a row for each member."""
        import pandas as pd

        return pd.DataFrame({name: self[name] for name in self.columns}).set_index("member")

    def to_csv(self, path: str | Path) -> None:
        """Write the table, part after part, whole or not at all."""
        import csv

        with whole(path) as new, open(new, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(self.columns)
            for part in self.parts():
                columns = [self._cells(part, name) for name in self.columns]
                writer.writerows(zip(*columns, strict=True))

    def _cells(self, part: Part, name: str) -> list[Any]:
        column = self._of_part(part, name)
        if isinstance(column, list):
            return column
        values: list[Any] = column.tolist()
        if name in self.plan.paths:  # few numbers, each as often as the others have levels
            texts: dict[float, str] = {}
            return [texts.get(v) or texts.setdefault(v, repr(v)) for v in values]
        whole_numbers = {c.text for c in self.collectors if c.kind == "whole"}
        if name in whole_numbers:
            return [v if math.isnan(v) else int(v) for v in values]
        return values

    def to_parquet(self, path: str | Path) -> None:
        """Write the table as Parquet, with curves as lists; needs pyarrow.

        Raises
        ------
        UsageError
            HB-P108 without pyarrow.
        """
        from hybond.sweep.parquet import write_parquet

        write_parquet(self, path)

    def __repr__(self) -> str:
        counts = self.counts()
        each = ", ".join(f"{n} {kind}" for kind, n in counts.items())
        how = "all ok" if list(counts) == ["ok"] else each
        some = "" if len(self) == len(self.plan) else f"{len(self)} of "
        whole_plan = f"{some}{len(self.plan)} members, {self.plan.way} of"
        return f"<SweepTable {self.title!r}: {whole_plan} {', '.join(self.plan.paths)}, {how}>"


def _written(model: Model, path: str) -> Dimension | None:
    """Return the dimension that the model gives a parameter; numbers without a unit have it."""
    value = model.parameters.get(path)
    quantity = try_quantity(value) if isinstance(value, str) else None
    return None if quantity is None or quantity.dimension == DIMENSIONLESS else quantity.dimension


def _said(part: Part, k: int, name: str) -> str:
    code, place, why, warned = part.said[k]
    if name == "code":
        return code
    if name == "warnings":
        return warned
    return f"{place}: {why}" if place and why else why
