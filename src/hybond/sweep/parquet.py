"""Writes the table of a sweep as Parquet: groups of rows of one size, wherever its parts end."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hybond.errors import UsageError
from hybond.files.whole import whole

if TYPE_CHECKING:
    from hybond.sweep.table import SweepTable

GROUP = 65_536
"""Rows that are written at once."""


def has_parquet() -> bool:
    """Whether Parquet can be written here."""
    return importlib.util.find_spec("pyarrow") is not None


def write_parquet(table: SweepTable, path: str | Path) -> None:
    """Write a table with units as metadata of its columns; whole numbers without value are null.

    Raises
    ------
    UsageError
        HB-P108 without pyarrow.
    """
    if not has_parquet():
        raise UsageError(
            "Parquet needs the package pyarrow, which is not installed",
            code="HB-P108",
            where="to_parquet",
            hint="pip install pyarrow, or take to_csv",
        )
    import pyarrow as pa
    import pyarrow.parquet as pq

    names = [*table.columns, *(c.text for c in table.collectors if c.kind == "curve")]
    kinds = {c.text: c.kind for c in table.collectors}
    factors = {f.path: f.is_number for f in table.plan.factors}

    def type_of(name: str) -> Any:
        if name == "member" or kinds.get(name) == "whole":
            return pa.int64()
        if kinds.get(name) == "curve":
            return pa.list_(pa.float64())
        texts = ("status", "code", "message", "warnings")
        if name in texts or kinds.get(name) == "text" or factors.get(name) is False:
            return pa.string()
        return pa.float64()

    schema = pa.schema([pa.field(n, type_of(n), metadata={"unit": table.unit(n)}) for n in names])

    def column(part: Any, name: str) -> Any:
        values = table._of_part(part, name)
        if kinds.get(name) == "whole":
            return pa.array(values, mask=np.isnan(values)).cast(pa.int64())
        if kinds.get(name) == "curve":
            return pa.array(list(values), type=pa.list_(pa.float64()))
        texts = type_of(name) == pa.string()
        return pa.array(list(map(str, values)) if texts else values, type=type_of(name))

    with whole(path) as new, pq.ParquetWriter(str(new), schema) as writer:
        waiting: list[Any] = []
        for part in table.parts():
            waiting.append(pa.table([column(part, n) for n in names], schema=schema))
            if sum(map(len, waiting)) >= GROUP:
                held = pa.concat_tables(waiting)
                many = len(held) // GROUP * GROUP
                writer.write_table(held.slice(0, many).combine_chunks(), row_group_size=GROUP)
                waiting = [held.slice(many)]
        if waiting:
            writer.write_table(pa.concat_tables(waiting).combine_chunks(), row_group_size=GROUP)
