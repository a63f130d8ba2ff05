"""A run as a table, here and in the forms of others: the methods of `Result` that make one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from pathlib import Path

    from hybond.result import Result


ROWS = 10_000
"""Rows that are turned into text together: as objects, numbers take four times their room."""


def _texts(column: NDArray[Any]) -> list[str]:
    """Return numbers with as many digits as tell each from all others, or words as they are.

    What is held, or comes again each period, is turned into text once: 0 and -0 are two numbers.
    """
    if column.dtype.kind != "f":
        return [str(word) for word in column.tolist()]
    bits, places = np.unique(column.view(np.int64), return_inverse=True)
    texts = np.array([repr(x) for x in bits.view(np.float64).tolist()], dtype=object)
    return cast("list[str]", texts[places].tolist())


class Tabled:
    """A run as columns over time; `Result` is the only one that has them."""

    def table(self, names: Sequence[str] | None = None) -> dict[str, Any]:
        """Return columns of accepted points, ``t`` and ``side`` first; both limits at events.

        One name may stand for a list of one, here and in what is written or made of a table.
        """
        run = cast("Result", self)
        if names is None:
            names = run.names
        names = [names] if isinstance(names, str) else list(names)
        times = [segment.t for segment in run.segments]
        many = np.array([len(t) for t in times], dtype=np.intp)
        t = np.concatenate(times) if times else np.zeros(0)
        ends = np.cumsum(many)
        side = np.full(len(t), "", dtype="<U5")
        side[(ends - many)[0 if run.trace.segments.forgotten else 1 :]] = "right"
        side[ends[:-1] - 1] = "left"
        read = run._of(names, np.repeat(np.arange(len(times)), many), t)
        if run._jumps_at_end:
            # what happens at the very end starts no segment
            t = np.append(t, run.t_end)
            side[-1] = "left"
            side = np.append(side, "right")
            last = run._after_last_event(names)
            read = [np.append(v, end) for v, end in zip(read, last, strict=True)]
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
            csv.writer(file).writerow(table)
            for k in range(0, len(table["t"]), ROWS):
                written: dict[bytes, list[str]] = {}  # names of one variable have one column
                columns = []
                for column in table.values():
                    part = column[k : k + ROWS]
                    key = part.tobytes()
                    columns.append(written.get(key) or written.setdefault(key, _texts(part)))
                file.writelines(f"{','.join(row)}\r\n" for row in zip(*columns, strict=True))

    def to_npz(self, path: str | Path, names: Sequence[str] | None = None) -> None:
        """Write the same table as NumPy arrays."""
        from hybond.files.whole import write_arrays

        write_arrays(path, self.table(names))
