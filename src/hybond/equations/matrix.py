"""A matrix with mixed-Boolean entries, sparse; as text, LaTeX, Markdown, SymPy and numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.equations.booleans import Cube
from hybond.equations.display import Display
from hybond.equations.patterns import Space
from hybond.equations.points import point
from hybond.equations.symbolic.rational import Rational
from hybond.errors import EquationError
from hybond.model.graph import AnyMode, Mode
from hybond.names import in_columns

Terms = tuple[tuple[Cube, Any], ...]
"""Disjoint Boolean products with their coefficients."""


@dataclass(frozen=True)
class BooleanMatrix:
    """A sparse matrix whose entries are sums of Boolean products times coefficients.

    Parameters
    ----------
    rows, columns : tuple of str
        Their names.
    entries : mapping of (int, int) to terms
        Entries that are not zero in every mode.
    display : Display
    values : mapping
        Of the names in coefficients.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc")
    >>> m.add(V=hb.Se(1), sw=hb.One(), r=hb.R(2), c=hb.C(1))
    >>> m.bond("V -> sw -> r", "sw -> c")
    >>> m.machine("S", states={"open": [], "closed": ["sw"]}, start="open")
    >>> eq = hb.state_equations(m)
    >>> eq.A[0, 0], eq.B["c.q", "V"]
    ('-κ/(c.C*r.R)', 'κ/r.R')
    """

    rows: tuple[str, ...]
    columns: tuple[str, ...]
    entries: Mapping[tuple[int, int], Terms]
    display: Display
    values: Mapping[str, float]
    void: tuple[tuple[Space, frozenset[int]], ...] = ()
    """Combinations of machine states in which the matrix does not hold."""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return len(self.rows), len(self.columns)

    def __getitem__(self, key: tuple[int | str, int | str]) -> str:
        i, j = self._place(key)
        return self.text_of(i, j)

    def _place(self, key: tuple[int | str, int | str]) -> tuple[int, int]:
        i, j = key
        row = self.rows.index(i) if isinstance(i, str) else range(len(self.rows))[i]
        column = self.columns.index(j) if isinstance(j, str) else range(len(self.columns))[j]
        return row, column

    def terms(self, row: int | str, column: int | str) -> Terms:
        """Return an entry as Boolean products with coefficients."""
        return self.entries.get(self._place((row, column)), ())

    def text_of(self, i: int, j: int) -> str:
        """Return one entry as text."""
        return self.display.entry(self._plain(i, j))

    def _plain(self, i: int, j: int) -> Terms:
        return self.entries.get((i, j), ())

    def in_mode(self, mode: AnyMode) -> BooleanMatrix:
        """Return the matrix of one mode, coefficients in names of parameters, without Booleans."""
        mode = self._checked(mode)
        booleans = self.display.naming.booleans
        entries: dict[tuple[int, int], Terms] = {}
        for place, terms in self.entries.items():
            here = [
                c for cube, c in terms if all(booleans[v].at(mode) == value for v, value in cube)
            ]
            total = here[0] if here else None
            for c in here[1:]:
                total = total + c
            if total is not None and total != 0:
                entries[place] = (((), total),)
        return BooleanMatrix(self.rows, self.columns, entries, self.display, self.values)

    def at(
        self, mode: AnyMode, *, values: Mapping[str, float] | None = None
    ) -> NDArray[np.float64]:
        """Return the numbers in one mode, shape `shape`."""
        mode = self._checked(mode)
        known = self._known(values)
        found = np.zeros(self.shape)
        booleans = self.display.naming.booleans
        for (i, j), terms in self.entries.items():
            for cube, c in terms:
                if all(booleans[v].at(mode) == value for v, value in cube):
                    found[i, j] += c.evaluate(known) if isinstance(c, Rational) else c
        return found

    def sparse(self, mode: AnyMode, *, values: Mapping[str, float] | None = None) -> Any:
        """Return the numbers in one mode as a `scipy.sparse.csr_array`."""
        from scipy.sparse import csr_array

        mode = self._checked(mode)
        known = self._known(values)
        booleans = self.display.naming.booleans
        at: list[tuple[int, int]] = []
        numbers: list[float] = []
        for place, terms in self.entries.items():
            for cube, c in terms:
                if all(booleans[v].at(mode) == value for v, value in cube):
                    at.append(place)
                    numbers.append(c.evaluate(known) if isinstance(c, Rational) else c)
        index = np.array(at, dtype=int).reshape(len(at), 2)
        return csr_array((numbers, (index[:, 0], index[:, 1])), shape=self.shape)

    def _checked(self, mode: AnyMode) -> Mode:
        """Return a mode in which the matrix holds."""
        graph = self.display.graph
        found = graph.mode_of(mode)
        if any(space.index(found) in gaps for space, gaps in self.void):
            raise EquationError(
                "sources contradict each other in this mode, or leave something open",
                code="HB-Q106",
                where=graph.mode_text(found),
                hint="StateEquations.at gives what equations there are in numbers",
            )
        return found

    def _known(self, values: Mapping[str, float] | None) -> Mapping[str, float]:
        return {**self.values, **point(self.display.graph, values)} if values else self.values

    # -- writing

    def text(self) -> str:
        """Return a table with row and column names."""
        rows, columns = self.shape
        cells = [["", *self.columns]]
        cells += [
            [
                self.rows[i],
                *(self.text_of(i, j) if (i, j) in self.entries else "." for j in range(columns)),
            ]
            for i in range(rows)
        ]
        return "\n".join(in_columns(cells))

    def latex(self) -> str:
        """Return a LaTeX matrix."""
        show = self.display
        rows, columns = self.shape
        lines = [
            " & ".join(show.entry_latex(self._plain(i, j)) for j in range(columns))
            for i in range(rows)
        ]
        return "\\begin{bmatrix}\n" + " \\\\\n".join(lines) + "\n\\end{bmatrix}"

    def sympy(self) -> Any:
        """Return a SymPy matrix; needs the extra ``symbolic``."""
        import sympy

        show = self.display
        matrix = sympy.zeros(*self.shape)
        for (i, j), terms in self.entries.items():
            for cube, c in terms:
                value = show.sympy(c)
                for v, positive in cube:
                    kappa = sympy.Symbol(show.kappa(v), real=True)
                    value *= kappa if positive else 1 - kappa
                matrix[i, j] += value
        return matrix

    def __str__(self) -> str:
        return self.text()

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"
