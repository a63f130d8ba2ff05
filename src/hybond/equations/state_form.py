"""The mixed-Boolean state equations: ``E(κ) x' = A(κ) x + B(κ) u``, one form for all modes.

R. Margetts and R. F. Ngwompo derive them from the junction structure matrix of a hybrid bond
graph; here they come from the same switch form for a graph of any size. ``E`` differs from the
identity exactly where storage is in derivative causality in some mode; its rate is then a
pseudo-state in other rows. Switch variables that could not be eliminated follow the stored
quantities as pseudo-states without a rate.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, NoReturn, TypeVar

import numpy as np

from hybond.equations.booleans import Naming
from hybond.equations.calculus import gradient
from hybond.equations.degenerate import effective
from hybond.equations.descriptor import Descriptor
from hybond.equations.display import Display
from hybond.equations.element_rows import Column, laws_of
from hybond.equations.matrix import BooleanMatrix
from hybond.equations.mixed import MixedRow, mixed_row
from hybond.equations.patterns import Space
from hybond.equations.points import point
from hybond.equations.regions import Region
from hybond.equations.ring import Numbers, Ring, Row, Symbols
from hybond.equations.storage import stored_names
from hybond.equations.switch_form import SwitchForm
from hybond.errors import EquationError, NumericsError
from hybond.model.expressions import Expr, Number, names, simplify, substitute
from hybond.model.graph import AnyMode, FlatGraph, Mode, Node

if TYPE_CHECKING:
    from hybond.equations.transfer import TransferFunctions

T = TypeVar("T")


@dataclass
class StateEquations(Generic[T]):
    """Mixed-Boolean state equations of a graph; made by `state_equations`."""

    graph: FlatGraph
    reference: Mode
    """The mode in which all switch variables are zero."""
    form: SwitchForm[T]
    regions: list[Region[T]]
    rows: list[MixedRow[T]]
    """One per stored quantity in the graph's order, then one per kept variable. A row sums to zero;
    its columns are those of `form`, co-energy variables standing for storage."""
    outputs: list[MixedRow[T]]
    """``y = row``."""
    output_names: tuple[str, ...]
    kept: tuple[int, ...]
    """Columns of variables that were not eliminated."""
    row_names: tuple[str, ...]
    """The stored quantity whose rate row it is, the variable that a row closes, or its number."""
    lost: tuple[int, ...]
    """Columns of variables that nothing determines and nothing reads."""
    naming: Naming
    sources: tuple[int, ...]
    laws: tuple[int, ...]
    """Columns of what nonlinear laws give, and of co-energy variables of nonlinear storage."""
    place: dict[int, tuple[str, int]]
    """Where each column stands: ``("rate", k)``, ``("state", k)``, ``("input", k)``, ``("law",
    k)``."""
    in_x: Callable[[Row[T]], Row[T]]
    """Puts stored quantities in place of co-energy variables in a row."""
    again: Callable[[], StateEquations[T]] | None = None
    """Derives the long form."""

    def __repr__(self) -> str:
        return (
            f"<StateEquations {self.graph.name!r}: {len(self.states)} states, "
            f"{len(self.inputs)} inputs, {len(self.outputs)} outputs>"
        )

    @property
    def ring(self) -> Ring[T]:
        """The coefficients' kind."""
        return self.form.ring

    @property
    def symbolic(self) -> bool:
        """Whether coefficients are formulas."""
        return isinstance(self.form.ring, Symbols)

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the stored quantities, then of the kept variables."""
        return tuple(s.path for s in self.graph.storages) + tuple(
            self.variable_name(k) for k in self.kept
        )

    def variable_name(self, column: int) -> str:
        """Return what a switch variable or tear is called: the signal that it is."""
        own = self.form.column(column)
        if own is None:
            bonds = len(self.graph.bonds)
            kind = "e" if column < bonds else "f"
            return f'"{self.graph.bonds[column % bonds].name}".{kind}'
        node = self.graph.nodes[own.index]
        if not node.is_junction:
            return output_name(node, own.port)
        on = node.index in self.graph.on_nodes(self.reference)
        net = "f" if node.kind == "0" else "e"
        common = "e" if node.kind == "0" else "f"
        return f"{node.path}.{net if on else common}"

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the sources, in the order of B's columns."""
        return tuple(self.source_name(k) for k in self.sources)

    @property
    def law_names(self) -> tuple[str, ...]:
        """Names of what nonlinear laws give, in the order of N's columns."""
        return tuple(self.law_name(k) for k in self.laws)

    def source_name(self, column: int) -> str:
        """Return the name of a source: its element, with a number if it has several."""
        own = self.column(column)
        if own.index < 0:
            return f"output{own.port + 1}"
        same = [k for k in self.sources if self.column(k).index == own.index]
        path = self.graph.nodes[own.index].path
        return path if len(same) == 1 else f"{path}#{same.index(column) + 1}"

    def law_name(self, column: int) -> str:
        """Return the name of what a nonlinear law gives."""
        own = self.column(column)
        graph = self.graph
        if own.kind == "storage":
            s = graph.storages[own.index]
            return f"{s.path.rpartition('.')[0]}.{'e' if s.kind == 'C' else 'f'}"
        return output_name(graph.nodes[own.index], own.port)

    def column(self, k: int) -> Column:
        """Return what a known column is."""
        own = self.form.column(k)
        assert own is not None
        return own

    @property
    def explicit(self) -> bool:
        """Whether E is the identity in every mode and nothing was kept."""
        return not self.kept and not any(r for region in self.regions for r in region.replaced)

    # -- what laws read

    def bond_row(self, name: str) -> MixedRow[T]:
        """Return a bond variable, ``e:b`` or ``f:b``, in terms of states, inputs and laws."""
        kind, _, index = name.partition(":")
        column = int(index) + (len(self.graph.bonds) if kind == "f" else 0)
        form = self.form
        region_at = {v: r for r in self.regions if not r.why_kept for v in r.variables}
        return mixed_row(form, form.solution.value(column), region_at).mapped(self.in_x)

    def names_in(self, row: MixedRow[T]) -> set[str]:
        """Return the names that the coefficients of a row read."""
        if not self.symbolic:
            return set()
        atoms = {
            atom
            for part in ((row.base,), *(p.rows for p in row.parts))
            for r in part
            for c in r.values()
            for atom in c.atoms()  # type: ignore[attr-defined]
        }
        meaning = self.ring.meaning
        return {n for a in atoms for n in (names(meaning[a]) if a in meaning else {a})}

    def signal_row(self, e: Expr) -> MixedRow[T] | None:
        """Return a signal in terms of states and laws; None if it is not linear in bonds."""
        slopes = gradient(e)
        rest = substitute(e, {name: Number(0.0) for name in slopes})
        if any(names(d) for d in slopes.values()) or simplify(rest) != Number(0.0) or not slopes:
            return None
        ring = self.ring
        parts = []
        for name, d in slopes.items():
            row = self.bond_row(name)
            factor = ring.read(d)
            parts.append(row.mapped(lambda r, f=factor: {k: f * c for k, c in r.items()}))  # type: ignore[misc]
        if len(parts) == 1:
            return parts[0]
        total = parts[0]
        for other in parts[1:]:
            base = ring.collect([(ring.one, total.base), (ring.one, other.base)])
            total = MixedRow(base, (*total.parts, *other.parts))
        return total

    def storage_law(self, storage: int) -> Expr:
        """Return the co-energy variable of a storage port as a formula of what is stored."""
        s = self.graph.storages[storage]
        node = self.graph.nodes[s.node]
        law = laws_of(self.graph, node, symbolic=self.symbolic)
        return substitute(law.expressions[s.port], stored_names(node, self.graph))

    # -- matrices

    @cached_property
    def display(self) -> Display:
        """How columns and coefficients are written."""
        return Display(self.graph, self.naming, self.ring.meaning)

    @cached_property
    def values(self) -> Mapping[str, float]:
        """Values of the names in coefficients."""
        return self.ring.known({})

    @cached_property
    def E(self) -> BooleanMatrix:
        """The matrix of rates, shape (n, n); n stored quantities and kept variables."""
        return self._matrix(self.rows, "rate", 1.0, self.row_names, self.states)

    @cached_property
    def A(self) -> BooleanMatrix:
        """The matrix of states, shape (n, n)."""
        return self._matrix(self.rows, "state", -1.0, self.row_names, self.states)

    @cached_property
    def B(self) -> BooleanMatrix:
        """The matrix of inputs, shape (n, p)."""
        return self._matrix(self.rows, "input", -1.0, self.row_names, self.inputs)

    @cached_property
    def C(self) -> BooleanMatrix:
        """The output matrix of states, shape (q, n)."""
        return self._matrix(self.outputs, "state", 1.0, self.output_names, self.states)

    @cached_property
    def D(self) -> BooleanMatrix:
        """The output matrix of inputs, shape (q, p)."""
        return self._matrix(self.outputs, "input", 1.0, self.output_names, self.inputs)

    @cached_property
    def F(self) -> BooleanMatrix:
        """The output matrix of rates, shape (q, n): where storage is in derivative causality."""
        return self._matrix(self.outputs, "rate", 1.0, self.output_names, self.states)

    @cached_property
    def N(self) -> BooleanMatrix:
        """The matrix of nonlinear laws, shape (n, number of `law_names`)."""
        return self._matrix(self.rows, "law", -1.0, self.row_names, self.law_names)

    def _matrix(
        self,
        rows: list[MixedRow[T]],
        kind: str,
        sign: float,
        names: tuple[str, ...],
        columns: tuple[str, ...],
    ) -> BooleanMatrix:
        ring = self.ring
        factor: Any = ring.of(sign)
        entries = {}
        for i, row in enumerate(rows):
            for k in row.columns():
                at, j = self.place[k]
                if at == kind:
                    terms = row.entry(k, ring, self.naming)
                    entries[i, j] = tuple((cube, factor * c) for cube, c in terms)
        return BooleanMatrix(names, columns, entries, self.display, self.values, self.void)

    # -- modes without a solution

    @cached_property
    def void(self) -> tuple[tuple[Space, frozenset[int]], ...]:
        """Combinations of machine states that have no solution, or too many."""
        return tuple((r.space, frozenset(r.void)) for r in self.regions if r.void)

    def in_mode(self, mode: AnyMode) -> StateEquations[T]:
        """Return the equations to use in one mode: these, or where they have a gap the long form.

        The long form keeps the switch variables of regions in which sources contradict each
        other in some mode, and so has rows in every mode.
        """
        found = self.graph.mode_of(mode)
        if any(space.index(found) in gaps for space, gaps in self.void):
            return self.long_form
        return self

    @cached_property
    def long_form(self) -> StateEquations[T]:
        """The same equations with all variables of regions that have gaps."""
        assert self.again is not None
        return self.again()

    # -- numbers of one mode

    def at(self, mode: AnyMode, *, values: Mapping[str, float] | None = None) -> Descriptor:
        """Return the matrices of one mode.

        Parameters
        ----------
        mode : tuple of int, or mapping
            The state of each machine, or ``{machine: state}``.
        values : mapping, optional
            Values of names in coefficients (a parameter ``m``, or a state ``w`` that modulates),
            over those of the model.

        Returns
        -------
        Descriptor
            Columns of B are sources.

        Raises
        ------
        EquationError
            HB-Q103 if the mode has a nonlinear law or nonlinear storage.
        """
        mode = self.graph.mode_of(mode)
        if self.in_mode(mode) is not self:
            return self.long_form.at(mode, values=values)
        n, size, count = len(self.graph.storages), len(self.states), len(self.rows)
        E, A = np.zeros((count, size)), np.zeros((count, size))
        B = np.zeros((count, len(self.sources)))
        q = len(self.outputs)
        C, F, D = np.zeros((q, size)), np.zeros((q, size)), np.zeros((q, len(self.sources)))
        value = _evaluator(self.ring, point(self.graph, values), self.display)
        for rows, rate, state, source, sign in (
            (self.rows, E, A, B, -1.0),
            (self.outputs, F, C, D, 1.0),
        ):
            for i, mixed in enumerate(rows):
                for k, c in mixed.at(mode, self.ring).items():
                    kind, j = self.place[k]
                    match kind:
                        case "rate":
                            rate[i, j] += value(c)
                        case "state":
                            state[i, j] += sign * value(c)
                        case "input":
                            source[i, j] += sign * value(c)
                        case _:
                            self.refuse(k)
        found = effective(E, A, B, n) if size > n or count > n else None
        if found is None:
            # square all the same, so that what is singular shows as such
            most = max(count, size)
            pad = ((0, most - count), (0, most - size))
            E, A, B = np.pad(E, pad), np.pad(A, pad), np.pad(B, ((0, most - count), (0, 0)))
            C, F = (np.pad(m, ((0, 0), (0, most - size))) for m in (C, F))
            extra = tuple(f"undetermined {k + 1}" for k in range(most - size))
            names = (*self.states, *extra)
            return Descriptor(E, A, B, C, D, F, names, self.inputs, self.output_names, n)
        keep, columns, free = found
        moved = np.abs(C @ free).max(axis=1, initial=0.0) if free.shape[1] else np.zeros(q)
        size_of = np.abs(C).max(axis=1, initial=0.0)
        loose = moved > 1e-9 * np.maximum(size_of, 1e-300)
        return Descriptor(
            E[np.ix_(keep, columns)],
            A[np.ix_(keep, columns)],
            B[keep],
            C[:, columns],
            D,
            F[:, columns],
            tuple(self.states[k] for k in columns),
            self.inputs,
            self.output_names,
            n,
            tuple(name for name, free_ in zip(self.output_names, loose, strict=True) if free_),
        )

    def refuse(self, column: int) -> NoReturn:
        """Refuse a nonlinear law, by the column of what it gives."""
        own = self.column(column)
        node = self.graph.storages[own.index].node if own.kind == "storage" else own.index
        raise EquationError(
            "the law is not linear, so the mode has no matrices",
            code="HB-Q103",
            where=self.graph.nodes[node].path,
            hint="linearise at a point, or read the equations as text",
        )

    # -- text

    def text(self, mode: AnyMode | None = None) -> str:
        """Return the equations as text, of all modes or of one."""
        from hybond.equations.writing import write_text

        if mode is None:
            return write_text(self, None)
        return write_text(self.in_mode(mode), self.graph.mode_of(mode))

    def latex(self, mode: AnyMode | None = None) -> str:
        """Return the equations for LaTeX, of all modes or of one."""
        from hybond.equations.writing import write_latex

        if mode is None:
            return write_latex(self, None)
        return write_latex(self.in_mode(mode), self.graph.mode_of(mode))

    def markdown(self, mode: AnyMode | None = None) -> str:
        """Return the equations for Markdown, formulas between dollars."""
        from hybond.equations.writing import write_markdown

        if mode is None:
            return write_markdown(self, None)
        return write_markdown(self.in_mode(mode), self.graph.mode_of(mode))

    def transfer(self, mode: AnyMode | None = None) -> TransferFunctions:
        """Return the transfer functions of one mode, from every source to every output.

        Without `mode`: of the start mode.
        """
        from hybond.equations.transfer import transfer_functions

        found = self.graph.mode_of({} if mode is None else mode)
        return transfer_functions(self.in_mode(found), found)

    def sympy(self) -> dict[str, Any]:
        """Return E, A, B, C, D as SymPy matrices; needs the extra ``symbolic``."""
        return {name: getattr(self, name).sympy() for name in "EABCD"}

    def __str__(self) -> str:
        return self.text()

    def _repr_markdown_(self) -> str:
        return self.markdown()


def output_name(node: Node, port: int) -> str:
    """Return the signal that a law of an element gives."""
    if node.kind == "TF":
        return f"{node.path}.{port + 1}.{'e' if port == 0 else 'f'}"
    variable = "f" if node.kind == "Sf" else "e"
    if node.kind not in ("Se", "Sf", "GY") and node.law is not None:
        variable = node.law.output
    return f"{node.path}.{port + 1}.{variable}" if len(node.ends) > 1 else f"{node.path}.{variable}"


def _evaluator(ring: Ring[Any], values: Mapping[str, float], show: Display) -> Any:
    if isinstance(ring, Numbers):
        return float
    gone = sorted(ring.vanished & set(values))
    if gone:
        raise EquationError(
            f"{', '.join(name.removeprefix('p:') for name in gone)} is zero in the model, so the "
            "equations do not have it",
            code="HB-Q108",
            where="the equations",
            hint="derive them anew from the model with the other value",
        )
    known = ring.known(values)

    def value(c: Any) -> float:
        try:
            return float(c.evaluate(known))
        except ZeroDivisionError:
            raise EquationError(
                "a coefficient divides by what is zero at this point",
                code="HB-Q107",
                where="the equations",
                hint="take a point beside it; the rates there are finite only if the motion is",
            ) from None
        except KeyError as missing:
            raise NumericsError(
                f"a coefficient reads {show.name(missing.args[0])}, which has no value here",
                code="HB-Q101",
                where="the equations",
                hint="give values={...} at the point of interest",
            ) from None

    return value
