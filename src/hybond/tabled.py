"""A run as a table, here and in the forms of others: the methods of `Result` that make one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

    from hybond.result import Result


ROWS = 10_000
"""Rows that are turned into text together: as objects, numbers take four times their room."""


class Tabled:
    """A run as columns over time; `Result` is the only one that has them."""

    def table(self, names: Sequence[str] | None = None) -> dict[str, Any]:
        """Return columns of accepted points, ``t`` and ``side`` first; both limits at events."""
        run = cast("Result", self)
        names = list(names) if names is not None else run.names
        times = [segment.t for segment in run.segments]
        many = np.array([len(t) for t in times], dtype=np.intp)
        t = np.concatenate(times) if times else np.zeros(0)
        ends = np.cumsum(many)
        side = np.full(len(t), "", dtype="<U5")
        side[(ends - many)[0 if run.trace.segments.forgotten else 1 :]] = "right"
        side[ends[:-1] - 1] = "left"
        read = run._of(names, np.repeat(np.arange(len(times)), many), t)
        return {"t": t, "side": side, **dict(zip(names, read, strict=True))}

    def to_pandas(self, names: Sequence[str] | None = None) -> Any:
        """Return a DataFrame over time; at an event two rows, column ``side`` tells them apart."""
        import pandas as pd

        table = self.table(names)
        return pd.DataFrame(table).set_index("t")

    def to_xarray(self, names: Sequence[str] | None = None) -> Any:
        """Return a Dataset over ``t``, units as attributes, ``side`` as a coordinate."""
        import xarray as xr

        run, table = cast("Result", self), self.table(names)
        t, side = table.pop("t"), table.pop("side")
        return xr.Dataset(
            {n: ("t", v, {"units": run.unit(n)}) for n, v in table.items()},
            coords={"t": ("t", t, {"units": "s"}), "side": ("t", side)},
            attrs={"title": run.title, "status": run.status},
        )

    def to_csv(self, path: str | Path, names: Sequence[str] | None = None) -> None:
        """Write a table: both limits at events, column ``side`` (left, right or empty)."""
        import csv

        from hybond.files.whole import whole

        table = self.table(names)
        with whole(path) as new, open(new, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(table)
            for k in range(0, len(table["t"]), ROWS):
                # a number is written with as many digits as tell it from all others
                writer.writerows(zip(*(c[k : k + ROWS].tolist() for c in table.values())))

    def to_npz(self, path: str | Path, names: Sequence[str] | None = None) -> None:
        """Write the same table as NumPy arrays."""
        from hybond.files.whole import write_arrays

        write_arrays(path, self.table(names))
