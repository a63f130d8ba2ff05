"""The mixed-Boolean state equations: ``E(κ) x' = A(κ) x + B(κ) u``, one form for all modes.

R. Margetts and R. F. Ngwompo derive them from the junction structure matrix of a hybrid bond
graph; here they come from the same switch form for a graph of any size. ``E`` differs from the
identity exactly where storage is in derivative causality in some mode; its rate is then a
pseudo-state in other rows. Switch variables that could not be eliminated follow the stored
quantities as pseudo-states without a rate.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, NoReturn, TypeVar

import numpy as np

from hybond.equations.booleans import Naming
from hybond.equations.descriptor import Descriptor
from hybond.equations.display import Display
from hybond.equations.element_rows import Column, laws_of
from hybond.equations.matrix import BooleanMatrix
from hybond.equations.mixed import MixedRow, closing_row, mixed_row
from hybond.equations.regions import Region, regions_of
from hybond.equations.ring import Numbers, Ring, Row, Symbols
from hybond.equations.switch_form import SwitchForm, switch_form
from hybond.equations.tableau import stored_names
from hybond.errors import EquationError, NumericsError
from hybond.model.builder import Model
from hybond.model.expressions import (
    Expr,
    Number,
    differentiate,
    names,
    simplify,
    substitute,
)
from hybond.model.graph import FlatGraph, Mode

if TYPE_CHECKING:
    from hybond.equations.transfer import TransferFunctions

T = TypeVar("T")


@dataclass
class StateEquations(Generic[T]):
    """Mixed-Boolean state equations of a graph; made by `state_equations`.

    Parameters
    ----------
    graph : FlatGraph
    reference : tuple of int
        The mode in which all switch variables are zero.
    form : SwitchForm
    regions : list of Region
    rows : list of MixedRow
        One per stored quantity in the graph's order, then one per kept variable. A row sums to
        zero; its columns are those of `form`, co-energy variables standing for storage.
    outputs : list of MixedRow
        ``y = row``.
    output_names : tuple of str
    kept : tuple of int
        Columns of variables that were not eliminated.
    place : dict
        Where each column stands: ``("rate", k)``, ``("state", k)``, ``("input", k)``,
        ``("law", k)``.
    in_x : callable
        Puts stored quantities in place of co-energy variables in a row.
    laws : tuple of int
        Columns of what nonlinear laws give, and of co-energy variables of nonlinear storage.
    """

    graph: FlatGraph
    reference: Mode
    form: SwitchForm[T]
    regions: list[Region[T]]
    rows: list[MixedRow[T]]
    outputs: list[MixedRow[T]]
    output_names: tuple[str, ...]
    kept: tuple[int, ...]
    naming: Naming
    sources: tuple[int, ...]
    laws: tuple[int, ...]
    place: dict[int, tuple[str, int]]
    in_x: Callable[[Row[T]], Row[T]]

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
            return f"{node.path}.{own.port + 1}"
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
        node = graph.nodes[own.index]
        output = node.law.output if node.law is not None else "e"
        same = [
            k
            for k in self.laws
            if self.column(k) is not own
            and self.column(k).kind == "law"
            and self.column(k).index == own.index
        ]
        port = f".{own.port + 1}" if same or len(node.ends) > 1 else ""
        return f"{node.path}{port}.{output}"

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
    def row_names(self) -> tuple[str, ...]:
        """Names of the rows: the stored quantity whose rate row it is, or the switch closed."""
        return self.states

    @property
    def E(self) -> BooleanMatrix:
        """The matrix of rates, shape (n, n); n stored quantities and kept variables."""
        return self._matrix(self.rows, "rate", 1.0, self.row_names, self.states)

    @property
    def A(self) -> BooleanMatrix:
        """The matrix of states, shape (n, n)."""
        return self._matrix(self.rows, "state", -1.0, self.row_names, self.states)

    @property
    def B(self) -> BooleanMatrix:
        """The matrix of inputs, shape (n, p)."""
        return self._matrix(self.rows, "input", -1.0, self.row_names, self.inputs)

    @property
    def C(self) -> BooleanMatrix:
        """The output matrix of states, shape (q, n)."""
        return self._matrix(self.outputs, "state", 1.0, self.output_names, self.states)

    @property
    def D(self) -> BooleanMatrix:
        """The output matrix of inputs, shape (q, p)."""
        return self._matrix(self.outputs, "input", 1.0, self.output_names, self.inputs)

    @property
    def F(self) -> BooleanMatrix:
        """The output matrix of rates, shape (q, n): where storage is in derivative causality."""
        return self._matrix(self.outputs, "rate", 1.0, self.output_names, self.states)

    @property
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
        return BooleanMatrix(names, columns, entries, self.display, self.values)

    # -- numbers of one mode

    def mode_of(self, mode: Mode | Mapping[str, str]) -> Mode:
        """Return a mode given as such or as ``{machine: state}``, start states for the others."""
        return self.graph.mode_of(mode) if isinstance(mode, Mapping) else mode

    def at(
        self, mode: Mode | Mapping[str, str], *, values: Mapping[str, float] | None = None
    ) -> Descriptor:
        """Return the matrices of one mode.

        Parameters
        ----------
        mode : tuple of int, or mapping
            The state of each machine, or ``{machine: state}``.
        values : mapping, optional
            Values of names in coefficients (``p:m``, or the state where it modulates), over
            those of the model.

        Returns
        -------
        Descriptor
            Columns of B are sources.

        Raises
        ------
        EquationError
            HB-Q103 if the mode has a nonlinear law or nonlinear storage.
        """
        mode = self.mode_of(mode)
        n, size = len(self.graph.storages), len(self.states)
        E, A = np.zeros((size, size)), np.zeros((size, size))
        B = np.zeros((size, len(self.sources)))
        q = len(self.outputs)
        C, F, D = np.zeros((q, size)), np.zeros((q, size)), np.zeros((q, len(self.sources)))
        value = _evaluator(self.ring, values)
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
        return Descriptor(E, A, B, C, D, F, self.states, self.inputs, self.output_names, n)

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

    def text(self, mode: Mode | Mapping[str, str] | None = None) -> str:
        """Return the equations as text, of all modes or of one."""
        from hybond.equations.writing import write_text

        return write_text(self, None if mode is None else self.mode_of(mode))

    def latex(self, mode: Mode | Mapping[str, str] | None = None) -> str:
        """Return the equations for LaTeX, of all modes or of one."""
        from hybond.equations.writing import write_latex

        return write_latex(self, None if mode is None else self.mode_of(mode))

    def markdown(self, mode: Mode | Mapping[str, str] | None = None) -> str:
        """Return the equations for Markdown, formulas between dollars."""
        from hybond.equations.writing import write_markdown

        return write_markdown(self, None if mode is None else self.mode_of(mode))

    def transfer(self, mode: Mode | Mapping[str, str] = ()) -> TransferFunctions:
        """Return the transfer functions of one mode, from every source to every output."""
        from hybond.equations.transfer import transfer_functions

        return transfer_functions(self, self.mode_of(mode))

    def sympy(self) -> dict[str, Any]:
        """Return E, A, B, C, D as SymPy matrices; needs the extra ``symbolic``."""
        return {name: getattr(self, name).sympy() for name in "EABCD"}

    def __str__(self) -> str:
        return self.text()

    def _repr_markdown_(self) -> str:
        return self.markdown()


STORED = -1
"""Column of stored quantity k in rows over x is ``STORED - k``."""


def _evaluator(ring: Ring[Any], values: Mapping[str, float] | None) -> Any:
    if isinstance(ring, Numbers):
        return float
    known = ring.known(values or {})

    def value(c: Any) -> float:
        try:
            return float(c.evaluate(known))
        except KeyError as missing:
            raise NumericsError(
                f"a coefficient reads {missing.args[0]}, which has no value here",
                code="HB-Q101",
                hint="give values={...} at the point of interest",
            ) from None

    return value


def parameter_values(graph: FlatGraph) -> dict[str, float]:
    """Return the values of all names ``p:...`` that formulas of `graph` use."""
    found = {f"p:{path}": float(v) for path, v in graph.parameters.items()}
    if graph.parametric is not None:
        for node in graph.nodes:
            if not node.is_junction and not node.hidden:
                found.update(graph.parametric(node.index).own)
    return found


def state_equations(
    model: Model | FlatGraph,
    *,
    reference: Mode | None = None,
    outputs: Sequence[str] = (),
    symbolic: bool = True,
    values: Mapping[str, float] | None = None,
) -> StateEquations[Any]:
    """Derive the mixed-Boolean state equations of a model.

    Parameters
    ----------
    model : Model or FlatGraph
    reference : tuple of int, optional
        Default: the mode with most storage in integral causality.
    outputs : sequence of str
        Signals, as the model names them.
    symbolic : bool
        Coefficients in names of parameters, or numbers.
    values : mapping, optional
        For numbers where the state modulates: values of ``s:k``, ``x:k``, ``time``, ``u:k``.

    Raises
    ------
    EquationError
        HB-Q102 for an output that is not linear in efforts and flows.

    Examples
    --------
    Two capacitors that a switch joins:

    >>> import hybond as hb
    >>> m = hb.Model("caps")
    >>> m.add(a=hb.C("1 F"), b=hb.C("2 F"), n1=hb.Zero(), sw=hb.One(), n2=hb.Zero(), r=hb.R(1))
    >>> m.bond("n1 -> a", "n1 -> sw -> n2 -> b", "n2 -> r")
    >>> m.machine("S", states={"open": [], "closed": ["sw"]}, start="open")
    >>> eq = state_equations(m)
    >>> print(eq)
    (1 - κ)*a.q' = κ*(a.q/a.C - b.q/b.C)
    b.q' + κ*a.q' = -b.q/(b.C*r.R)
    # κ = 1 when S is closed
    >>> eq.at((1,)).E
    array([[0., 0.],
           [1., 1.]])
    """
    graph = model.flatten() if isinstance(model, Model) else model
    graph_values = parameter_values(graph) if symbolic else {}
    known = {**graph_values, **(values or {})}
    ring: Ring[Any] = Symbols(known) if symbolic else Numbers(known)
    start = graph.start_mode if reference is None else reference
    if reference is None and graph.machines:
        from hybond.causality.reference import reference_mode

        start = reference_mode(graph).mode
    wanted = [_signal(graph, text) for text in outputs]
    form = switch_form(graph, ring, start, symbolic=symbolic, outputs=wanted)
    regions = regions_of(form)
    region_at = {v: r for r in regions if not r.why_kept for v in r.variables}
    rows = [
        mixed_row(
            form,
            form.targets[form.partner["rate", s.index, 0]],
            region_at,
            target=form.partner["rate", s.index, 0],
        )
        for s in graph.storages
    ]
    kept: list[int] = []
    for region in regions:
        if region.why_kept:
            kept += region.variables
            rows += [closing_row(form, region, s) for s in region.switches]
            rows += [MixedRow(form.constraints[k]) for k in region.constraints]
    results = []
    for i, (row, rest) in enumerate(zip(form.outputs, form.rests, strict=True)):
        results.append(mixed_row(form, _with_rest(form, row, rest, i), region_at))
    stored = _storage_rows(form, symbolic=symbolic)

    def in_x(row: Row[Any]) -> Row[Any]:
        parts = [(c, stored[k]) for k, c in row.items() if k in stored]
        if not parts:
            return row
        rest = {k: c for k, c in row.items() if k not in stored}
        return ring.collect([(ring.one, rest), *parts])

    sources = _of_kind(form, "source")
    laws = tuple(k for k in _of_kind(form, "law", "storage") if k not in stored)
    return StateEquations(
        graph,
        start,
        form,
        regions,
        [row.mapped(in_x) for row in rows],
        [row.mapped(in_x) for row in results],
        tuple(outputs),
        tuple(kept),
        Naming(graph),
        sources,
        laws,
        _places(form, kept, sources, laws),
        in_x,
    )


def _of_kind(form: SwitchForm[Any], *kinds: str) -> tuple[int, ...]:
    base = form.rows.unknowns
    return tuple(base + k for k, c in enumerate(form.rows.columns) if c.kind in kinds)


def _places(
    form: SwitchForm[Any], kept: list[int], sources: tuple[int, ...], laws: tuple[int, ...]
) -> dict[int, tuple[str, int]]:
    """Return where each column stands in the matrices."""
    n = len(form.graph.storages)
    place: dict[int, tuple[str, int]] = {}
    for s in form.graph.storages:
        place[form.partner["rate", s.index, 0]] = ("rate", s.index)
        place[STORED - s.index] = ("state", s.index)
    place.update({k: ("state", n + j) for j, k in enumerate(kept)})
    place.update({k: ("input", j) for j, k in enumerate(sources)})
    place.update({k: ("law", j) for j, k in enumerate(laws)})
    return place


def _signal(graph: FlatGraph, text: str) -> Expr:
    if text in graph.signals:
        return graph.signals[text]
    assert graph.read is not None
    return graph.read(text)


def _with_rest(form: SwitchForm[T], row: Row[T], rest: Expr, index: int) -> Row[T]:
    """Add what an output reads besides bonds: stored quantities, else a source column."""
    row = dict(row)
    ring = form.ring
    slopes = {n: differentiate(rest, n) for n in sorted(names(rest)) if n.startswith("x:")}
    if all(not names(d) for d in slopes.values()):
        for name, d in slopes.items():
            row[STORED - int(name[2:])] = ring.read(simplify(d))
        rest = simplify(substitute(rest, {n: Number(0.0) for n in slopes}))
    if rest != Number(0.0):
        row[form.rows.column("source", -1, port=index, formula=rest)] = ring.one
    return row


def _storage_rows(form: SwitchForm[T], *, symbolic: bool) -> dict[int, dict[int, T]]:
    """Return ``z = K x`` per linear storage port."""
    graph, ring = form.graph, form.ring
    at: dict[tuple[int, int], int] = {(s.node, s.port): s.index for s in graph.storages}
    found: dict[int, dict[int, T]] = {}
    for s in graph.storages:
        node = graph.nodes[s.node]
        law = laws_of(graph, node, symbolic=symbolic)
        if law.matrix is None:
            continue
        row = {STORED - at[s.node, j]: ring.read(e) for j, e in enumerate(law.matrix[s.port])}
        found[form.partner["storage", s.index, 0]] = {
            k: c for k, c in row.items() if ring.size(c) > 0.0
        }
    return found
