"""Which faults which residual reacts to: fault signature matrices, detectability, isolability.

A fault of a parameter is any other value of it, one of a sensor or source something added to it,
one of a switch a machine that stays in a state. A residual reacts to a fault in a mode if it is
not zero on all motions of the faulty plant. For sensors and sources that can be read off; for
parameters and switches the residual is compared with the residuals of the faulty plant: it reacts
if it does not follow from these. So a parameter that is only a factor of a residual, or that
stands where nothing flows, is no reaction.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import prod
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.residuals.fault_reactions import Fault, Reactions, faults_of
from hybond.errors import UsageError
from hybond.model.graph import FlatGraph, Mode
from hybond.names import in_columns

if TYPE_CHECKING:
    from hybond.analysis.residuals.residuals import Residuals

MOST_MODES = 64
"""Modes up to which all are examined if none are named."""


@dataclass(frozen=True)
class Signatures:
    """Fault signatures of one mode or several; prints as a table.

    Parameters
    ----------
    graph : FlatGraph
    residuals : tuple of str
    faults : tuple of Fault
    modes : tuple of Mode
    reacts : array of bool, shape (modes, faults, residuals)
    applies : array of bool, shape (modes, faults)
        False where a fault is none: a machine that stays in the state that it is to have.
    transient : array of bool, shape (modes, faults, residuals)
        True where a sensor's or source's fault is seen only while it changes.

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.analysis.residuals.residuals import residuals
    >>> m = hb.Model("divider")
    >>> m.add(V=hb.Se("5 V"), i=hb.One(), r1=hb.R(1), n=hb.Zero(), r2=hb.R(2), c=hb.C(1))
    >>> m.bond("V -> i -> n -> r2", "i -> r1", "n -> c")
    >>> found = residuals(m, sensors=["i.f", "n.e"]).signatures()
    >>> print(found.table())
          G1  G2
    V      1   .
    r1.R   1   .
    r2.R   .   1
    c.C    .   1
    i.f    1   1
    n.e    1   1
    >>> found.groups()
    (('V', 'r1.R'), ('r2.R', 'c.C'), ('i.f', 'n.e'))
    """

    graph: FlatGraph
    residuals: tuple[str, ...]
    faults: tuple[Fault, ...]
    modes: tuple[Mode, ...]
    reacts: NDArray[np.bool_]
    applies: NDArray[np.bool_]
    transient: NDArray[np.bool_]

    def matrix(self, mode: Mode | Mapping[str, str] | None = None) -> NDArray[np.bool_]:
        """Return rows of faults, columns of residuals; without a mode what reacts in some mode."""
        if mode is None:
            return np.asarray(self.reacts.any(axis=0))
        return np.asarray(self.reacts[self._place(mode)])

    def _place(self, mode: Mode | Mapping[str, str]) -> int:
        wanted = self.graph.mode_of(mode)
        if wanted not in self.modes:
            raise UsageError(
                f"the mode {self.graph.mode_text(wanted)} was not examined",
                code="HB-A303",
                where="mode",
                hint="name it in signatures(modes=[...])",
            )
        return self.modes.index(wanted)

    def signature(
        self, fault: str, mode: Mode | Mapping[str, str] | None = None
    ) -> tuple[bool, ...]:
        """Return the row of one fault, by its name."""
        k = next(k for k, f in enumerate(self.faults) if f.name == fault)
        return tuple(bool(b) for b in self.matrix(mode)[k])

    def detectable(self, mode: Mode | Mapping[str, str] | None = None) -> tuple[str, ...]:
        """Return the faults that some residual reacts to; without a mode: in some mode."""
        rows = np.atleast_1d(self.matrix(mode).any(axis=1))
        return tuple(f.name for f, seen in zip(self.faults, rows, strict=True) if seen)

    def undetectable(self, mode: Mode | Mapping[str, str] | None = None) -> tuple[str, ...]:
        """Return the faults that no residual reacts to; without a mode: in no mode."""
        seen = set(self.detectable(mode))
        applies = self.applies if mode is None else self.applies[self._place(mode)][None]
        return tuple(
            f.name for k, f in enumerate(self.faults) if f.name not in seen and applies[:, k].any()
        )

    def groups(self, mode: Mode | Mapping[str, str] | None = None) -> tuple[tuple[str, ...], ...]:
        """Return detectable faults with equal signatures together; alone means isolable.

        Without a mode, faults are told apart that some mode tells apart.
        """
        rows = self.reacts if mode is None else self.reacts[self._place(mode)][None]
        found: dict[bytes, list[str]] = {}
        for k, fault in enumerate(self.faults):
            own = np.ascontiguousarray(rows[:, k])
            if own.any():
                found.setdefault(own.tobytes(), []).append(fault.name)
        return tuple(tuple(g) for g in found.values())

    def isolable(self, mode: Mode | Mapping[str, str] | None = None) -> tuple[str, ...]:
        """Return the faults that have a signature of their own."""
        return tuple(g[0] for g in self.groups(mode) if len(g) == 1)

    # -- writing

    def _cells(self, mode: Mode | Mapping[str, str] | None) -> list[tuple[str, ...]]:
        rows = self.matrix(mode)
        if mode is None:
            slow = np.asarray((self.transient | ~self.reacts).all(axis=0))
            never = ~np.asarray(self.applies.any(axis=0))
        else:
            slow = np.asarray(self.transient[self._place(mode)])
            never = ~np.asarray(self.applies[self._place(mode)])
        cells = [("", *self.residuals)]
        for k, fault in enumerate(self.faults):
            if never[k]:
                continue
            marks = [
                ("'" if slow[k, j] else "1") if rows[k, j] else "."
                for j in range(len(self.residuals))
            ]
            cells.append((fault.name, *marks))
        return cells

    def table(self, mode: Mode | Mapping[str, str] | None = None) -> str:
        """Return the matrix as text; ``1`` reacts, ``'`` only while the fault changes."""
        cells = self._cells(mode)
        width = max((len(n) for n in self.residuals), default=1)
        return "\n".join(in_columns((row[0], *(c.rjust(width) for c in row[1:])) for row in cells))

    def to_markdown(self, mode: Mode | Mapping[str, str] | None = None) -> str:
        """Return matrix and groups as Markdown."""
        first, *rest = self._cells(mode)
        lines = ["| " + " | ".join(first) + " |", "|" + " --- |" * len(first)]
        lines += ["| " + " | ".join(row) + " |" for row in rest]
        return "\n".join([*lines, "", *(f"- {note}" for note in self.notes(mode))]) + "\n"

    def notes(self, mode: Mode | Mapping[str, str] | None = None) -> list[str]:
        """Return what is not detectable and what is not told apart."""
        seen = mode is None and len(self.modes) > 1
        found = []
        missed = self.undetectable(mode)
        if missed:
            where = " in any mode examined" if seen else ""
            found.append(f"not detectable{where}: {', '.join(missed)}")
        shared = [g for g in self.groups(mode) if len(g) > 1]
        if shared:
            found.append("not told apart: " + "; ".join(", ".join(g) for g in shared))
        alone = self.isolable(mode)
        if alone:
            found.append(
                f"isolable{' by these modes together' if seen else ''}: {', '.join(alone)}"
            )
        return found

    def record(self) -> dict[str, Any]:
        """Return plain data, per mode."""
        return {
            "residuals": list(self.residuals),
            "faults": [{"kind": f.kind, "name": f.name} for f in self.faults],
            "modes": [
                {
                    "mode": self.graph.mode_names(mode),
                    "matrix": self.reacts[m].astype(int).tolist(),
                    "applies": self.applies[m].astype(int).tolist(),
                    "detectable": list(self.detectable(mode)),
                    "groups": [list(g) for g in self.groups(mode)],
                }
                for m, mode in enumerate(self.modes)
            ],
            "detectable": list(self.detectable()),
            "groups": [list(g) for g in self.groups()],
        }

    def __str__(self) -> str:
        one = self.modes[0] if len(self.modes) == 1 else None
        what = (
            f"Fault signatures, mode {self.graph.mode_text(one)}"
            if one is not None
            else f"Fault signatures, {len(self.modes)} modes: reacts in some mode"
        )
        return "\n".join([what, "", self.table(one), "", *self.notes(one)])

    def __repr__(self) -> str:
        return str(self)

    def _repr_markdown_(self) -> str:
        return self.to_markdown()


def examined_modes(graph: FlatGraph) -> list[Mode]:
    """Return all combinations of states if these are few, else those one machine away."""
    sizes = [len(m.states) for m in graph.machines]
    if prod(sizes) <= MOST_MODES:
        return list(product(*(range(n) for n in sizes)))
    start = graph.start_mode
    found = [start]
    for m, n in enumerate(sizes):
        found += [(*start[:m], k, *start[m + 1 :]) for k in range(n) if k != start[m]]
    return found


def fault_signatures(about: Residuals, modes: Sequence[Mode]) -> Signatures:
    """Return the signatures of all single faults in some modes."""
    faults = faults_of(about)
    shape = (len(modes), len(faults), len(about))
    reacts, transient = np.zeros(shape, dtype=bool), np.zeros(shape, dtype=bool)
    applies = np.ones(shape[:2], dtype=bool)
    tester = Reactions(about)
    for m, mode in enumerate(modes):
        for k, fault in enumerate(faults):
            if fault.kind == "switch" and mode[fault.machine] == fault.state:
                applies[m, k] = False
                continue
            if fault.kind in ("sensor", "source"):
                reacts[m, k], transient[m, k] = tester.added(fault, mode)
            else:
                reacts[m, k] = tester.changed(fault, mode)
    return Signatures(
        about.graph,
        tuple(r.name for r in about),
        tuple(faults),
        tuple(modes),
        reacts,
        applies,
        transient,
    )
