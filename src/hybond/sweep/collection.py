"""`Ensemble`: what many runs of one model give back, as arrays over its members."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.errors import HybondError, UsageError
from hybond.files.whole import write_arrays, write_rows
from hybond.model.builder import Model
from hybond.model.parts import Value
from hybond.names import did_you_mean, html_lines, html_table
from hybond.result import Result
from hybond.simulation import simulate

if TYPE_CHECKING:
    from pathlib import Path

Vector = NDArray[np.float64]
ROWS = 20
"""Members that a notebook shows."""


class Outputs(dict[str, Vector]):
    """Outputs by name; one that was not read is refused with the nearest names."""

    def __missing__(self, name: str) -> Vector:
        """Refuse a name; HB-S109."""
        raise UsageError(
            f"there is no output {name!r}",
            code="HB-S109",
            where=str(name),
            hint=did_you_mean(str(name), self) if self else "give samples= to hb.ensemble",
        )


@dataclass(frozen=True, eq=False, repr=False)
class Ensemble:
    """Runs of one model with many sets of parameters; member k has the number k, from 0.

    Parameters
    ----------
    model : Model
    until : float
        End time, s.
    options : mapping
        Of `hybond.simulate`, the same for all members.
    sets : mapping of path to tuple
        The parameters as they were given, one value for each member.
    parameters : mapping of path to array, shape (members,)
        The same in SI; an array of objects where one is no number and no quantity.
    units : mapping of output to str
        SI units, empty where there is none.
    status : array of str, shape (members,)
        ``ok``, ``accumulation``, ``error`` or ``interrupted``; see `Result`. A member that had not
        run when Ctrl-C was pressed is ``interrupted``.
    t_end : array, shape (members,)
        The time that each reached, s.
    counts : array of int, shape (members,)
        Number of events, the start included.
    events : tuple of array, one for each member
        Times of events, s, the start included; empty if they were not asked for.
    final : mapping of output to array, shape (members,)
        Values at `t_end`; nan for a member that has none.
    t : array, shape (times,)
        When outputs were sampled, s.
    samples : mapping of output to array, shape (members, times)
        At events the limit from the right; nan beyond the end of a member, and before what it was
        told to keep.
    errors : mapping of member to HybondError
        Why members stopped.
    warnings : mapping of member to tuple of str
        What was decided on the way, for the members that have something to say.
    interrupted : bool
        Whether Ctrl-C ended it early.
    seconds : float
        How long it took, s.
    how : str
        How many members ran in how many threads, and how many as ordinary runs.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical", parameters={"r": "1 kohm"})
    >>> m.add(c=hb.C("1 mF", e="10 V"), r1=hb.R("r"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r1")
    >>> many = hb.ensemble(m, "1 s", sets=[{"r": "1 kohm"}, {"r": "2 kohm"}], samples=[0.0, 1.0])
    >>> many
    <Ensemble 'rc': 2 members, until 1 s, all ok>
    >>> many.samples["c.e"].shape, many.parameters["r"].tolist()
    ((2, 2), [1000.0, 2000.0])
    >>> round(many.run(1).final["c.e"], 6)
    6.065307
    """

    model: Model
    until: float
    options: Mapping[str, Any]
    sets: Mapping[str, tuple[Value, ...]]
    parameters: Mapping[str, NDArray[Any]]
    units: Mapping[str, str]
    status: NDArray[np.str_]
    t_end: Vector
    counts: NDArray[np.intp]
    events: tuple[Vector, ...]
    final: Mapping[str, Vector]
    t: Vector
    samples: Mapping[str, Vector]
    errors: Mapping[int, HybondError]
    warnings: Mapping[int, tuple[str, ...]]
    interrupted: bool
    seconds: float
    how: str

    @property
    def title(self) -> str:
        """The model's title, or its name."""
        return self.model.title or self.model.name

    @property
    def failed(self) -> NDArray[np.intp]:
        """Numbers of the members that stopped with an error."""
        return np.flatnonzero(self.status == "error")

    def __len__(self) -> int:
        return len(self.status)

    def run(self, k: int) -> Result:
        """Run member k again, and return all of it; an error is in ``result.error``.

        Raises
        ------
        UsageError
            HB-S115 for a member that does not exist.
        HybondError
            If the model has no meaning with these parameters.
        """
        if not 0 <= k < len(self):
            raise UsageError(
                f"there is no member {k}",
                code="HB-S115",
                where="k",
                hint=f"0 to {len(self) - 1}",
            )
        parameters = {path: column[k] for path, column in self.sets.items()}
        return simulate(
            self.model, self.until, parameters=parameters, on_error="return", **self.options
        )

    # -- other forms

    def table(self) -> dict[str, NDArray[Any]]:
        """Return columns over members: parameters, ``status``, ``t_end``, ``events``, outputs.

        A name that is there already gets an underscore behind it.
        """
        found: dict[str, NDArray[Any]] = {"member": np.arange(len(self))}
        own = {"status": self.status, "t_end": self.t_end, "events": self.counts}
        for group in (self.parameters, own, self.final):
            for name, column in group.items():
                while name in found:
                    name += "_"
                found[name] = column
        return found

    def to_pandas(self) -> Any:
        """Return a DataFrame with a row for each member; see `table`."""
        import pandas as pd

        return pd.DataFrame(self.table()).set_index("member")

    def to_xarray(self) -> Any:
        """Return a Dataset: outputs over ``member`` and ``t``, or at the end if none was sampled.

        Parameters, ``status``, ``t_end`` and ``events`` are coordinates over ``member``.
        """
        import xarray as xr

        table = self.table()
        first = len(table) - len(self.final)
        over = {name: ("member", column) for name, column in list(table.items())[:first]}
        sampled = bool(self.samples)
        dimensions = ("member", "t") if sampled else ("member",)
        columns = zip(list(table)[first:], self.final, strict=True)
        return xr.Dataset(
            {
                column: (
                    dimensions,
                    (self.samples if sampled else self.final)[name],
                    {"units": self.units.get(name, "")},
                )
                for column, name in columns
            },
            coords=over | ({"t": ("t", self.t, {"units": "s"})} if sampled else {}),
            attrs={"title": self.title},
        )

    def to_csv(self, path: str | Path) -> None:
        """Write the table, a row for each member."""
        write_rows(path, self.table())

    def to_npz(self, path: str | Path) -> None:
        """Write the table as NumPy arrays; with samples also ``t`` and ``samples:<output>``."""
        columns = {
            name: column.astype(str) if column.dtype == object else column
            for name, column in self.table().items()
        }
        sampled = {f"samples:{name}": values for name, values in self.samples.items()}
        grid = {"t": self.t} if len(self.t) and "t" not in columns else {}
        write_arrays(path, columns | grid | sampled)

    def _repr_html_(self) -> str:
        table = self.table()
        rows = [
            [f"{v:.6g}" if isinstance(v := c[k], float) else str(v) for c in table.values()]
            for k in range(min(len(self), ROWS))
        ]
        said = [repr(self).split("\n")[0][1:-1]]
        more = [f"{len(self) - ROWS} more members"] if len(self) > ROWS else []
        return html_lines(said) + html_table(rows, list(table)) + html_lines(more)

    def __repr__(self) -> str:
        kinds, counts = np.unique(self.status, return_counts=True)
        each = ", ".join(f"{n} {kind}" for kind, n in zip(kinds, counts, strict=True))
        how = "all ok" if list(kinds) == ["ok"] else each
        text = f"<Ensemble {self.title!r}: {len(self)} members, until {self.until:g} s, {how}>"
        first = next(iter(self.errors.items()), None)
        return text if first is None else f"{text}\nmember {first[0]}: {first[1]}"
