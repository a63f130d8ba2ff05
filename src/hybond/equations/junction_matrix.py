"""The junction structure matrix with Boolean entries.

What the junctions, transformers and gyrators of a graph do, with all elements as ports: storage
gives its co-energy variable and receives its rate, a resistor gives what it imposes in the
reference mode and receives the conjugate, a source gives its value::

    Q(κ) [x'; D_in] = S(κ) [z; Λ(κ) D_out; u]

(R. Margetts and R. F. Ngwompo). ``Q`` is the identity unless an element is in other than its
reference causality in some mode; the row that it loses holds what the mode imposes on it instead.
``Λ`` is diagonal: 1 where a resistor's output is heard in every mode, a Boolean expression where
it acts only in some.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from hybond.calls import called
from hybond.causality.reference import reference_mode
from hybond.equations.booleans import Cube, Naming
from hybond.equations.display import Display
from hybond.equations.element_parts import parameter_values
from hybond.equations.matrix import BooleanMatrix
from hybond.equations.mixed import MixedRow, closing_row, mixed_row
from hybond.equations.patterns import Space
from hybond.equations.points import caller
from hybond.equations.regions import Region, regions_of
from hybond.equations.ring import Numbers, Ring, Symbols
from hybond.equations.switch_form import SwitchForm, switch_form
from hybond.model.builder import Model, graph_of
from hybond.model.graph import AnyMode, FlatGraph, Mode


@dataclass
class JunctionMatrix:
    """The junction structure of a graph; made by `junction_matrix`.

    Parameters
    ----------
    graph : FlatGraph
    reference : tuple of int
    form : SwitchForm
    rows : list of MixedRow
        One per storage port and per resistor port, then one per variable that was kept.
    targets, kept : tuple of int
        Columns of rates and of what resistors receive; columns of kept variables.
    imposes : mapping
        ``(node, port)`` to what that resistor port gives in the reference mode.
    naming : Naming
    """

    graph: FlatGraph
    reference: Mode
    form: SwitchForm[Any]
    rows: list[MixedRow[Any]]
    targets: tuple[int, ...]
    kept: tuple[int, ...]
    imposes: Mapping[tuple[int, int], str]
    naming: Naming

    @cached_property
    def display(self) -> Display:
        """How columns and coefficients are written."""
        return Display(self.graph, self.naming, self.form.ring.meaning)

    @cached_property
    def _given(self) -> tuple[int, ...]:
        """Columns of inputs: co-energy variables, resistor outputs, sources, the rest."""
        base = self.form.rows.unknowns
        order = ("storage", "resistor", "source", "law")
        found = [
            base + k
            for kind in order
            for k, c in enumerate(self.form.rows.columns)
            if c.kind == kind
        ]
        return (*found, *self.kept)

    @cached_property
    def outputs(self) -> tuple[str, ...]:
        """What elements receive: rates, then the intake of resistors.

        The rows that close kept variables follow; they say ``0 = ...`` and are called ``0``.
        """
        return tuple(self._name(k) for k in self.targets) + ("0",) * len(self.kept)

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """What elements give: co-energy variables, resistor outputs, source values."""
        return tuple(self._name(k) for k in self._given)

    def _name(self, column: int) -> str:
        graph = self.graph
        own = self.form.column(column)
        if own is None:
            bonds = len(graph.bonds)
            return self.display.bond_variable("e" if column < bonds else "f", column % bonds)
        if own.kind in ("rate", "storage"):
            s = graph.storages[own.index]
            if own.kind == "rate":
                return f"{s.path}'"
            return f"{s.path.rpartition('.')[0]}.{'e' if s.kind == 'C' else 'f'}"
        node = graph.nodes[own.index]
        port = f".{own.port + 1}" if len(node.ends) > 1 and not node.is_junction else ""
        if own.kind in ("resistor", "intake"):
            gives = self.imposes[own.index, own.port]
            receives = "f" if gives == "e" else "e"
            return f"{node.path}{port}.{gives if own.kind == 'resistor' else receives}"
        if own.kind == "switch" and node.is_junction:
            on = own.index in graph.on_nodes(self.reference)
            net, common = ("f", "e") if node.kind == "0" else ("e", "f")
            return f"{node.path}.{net if on else common}"
        return f"{node.path}{port}"

    @cached_property
    def S(self) -> BooleanMatrix:
        """What elements give to what they receive."""
        return self._matrix(self.inputs, {k: j for j, k in enumerate(self._given)}, -1.0)

    @cached_property
    def Q(self) -> BooleanMatrix:
        """What elements receive; the identity where causality is that of the reference mode."""
        columns = (*self.targets, *self.kept)
        skip = set(self.kept)
        places = {k: j for j, k in enumerate(columns) if k not in skip}
        return self._matrix(self.outputs, places, 1.0)

    def _matrix(
        self, names: tuple[str, ...], places: Mapping[int, int], sign: float
    ) -> BooleanMatrix:
        ring = self.form.ring
        entries = {}
        targets = (*self.targets, *self.kept)
        for i, row in enumerate(self.rows):
            own = self._way(targets[i]) if i < len(self.targets) else 1.0
            for k in row.columns():
                if k in places:
                    terms = row.entry(k, ring, self.naming)
                    factor = ring.of(sign * own * self._way(k))
                    entries[i, places[k]] = tuple((cube, factor * c) for cube, c in terms)
        return BooleanMatrix(self.outputs, names, entries, self.display, self._values)

    def _way(self, column: int) -> float:
        """Return -1 for a flow that is counted into an element, but named along an arrow away."""
        own = self.form.column(column)
        if own is None or own.kind not in ("storage", "resistor", "intake"):
            return 1.0
        graph = self.graph
        if own.kind == "storage":
            s = graph.storages[own.index]
            return float(s.sign) if s.kind == "I" else 1.0
        gives = self.imposes[own.index, own.port]
        if (gives if own.kind == "resistor" else "e" if gives == "f" else "f") == "e":
            return 1.0
        end = next(e for e in graph.nodes[own.index].ends if e.port == own.port)
        return float(end.sign)

    @cached_property
    def _values(self) -> Mapping[str, float]:
        return self.form.ring.known({})

    @cached_property
    def active(self) -> dict[str, tuple[Cube, ...]]:
        """The diagonal Boolean matrix: per resistor output, when any element hears it.

        An empty product (``((),)``) is 1: always.
        """
        found = {}
        for k in self._given:
            own = self.form.column(k)
            if own is None or own.kind != "resistor":
                continue
            found[self._name(k)] = self._heard(k)
        return found

    def _heard(self, column: int) -> tuple[Cube, ...]:
        spaces: dict[Space, set[int]] = {}
        always: tuple[Cube, ...] = ((),)
        ring = self.form.ring
        for row in self.rows:
            base = {column: row.base[column]} if column in row.base else {}
            parts = [p for p in row.parts if any(column in r for r in p.rows)]
            if base and len(parts) != 1:
                return always
            for part in parts:
                here = {
                    k
                    for k, r in enumerate(part.rows)
                    if column in ring.collect([(ring.one, base), (ring.one, r)])
                }
                if here:
                    spaces.setdefault(part.space, set()).update(here)
        if len(spaces) != 1:
            return always if spaces else ()
        ((space, on),) = spaces.items()
        return self.naming.cubes(space, frozenset(on))

    def text(self, mode: AnyMode | None = None) -> str:
        """Return S with its names, Q where it is not the identity, and the active resistors."""
        show = self.display
        s, q = self.S, self.Q
        if mode is not None:
            s, q = s.in_mode(mode), q.in_mode(mode)
        lines = ["S", s.text()]
        plain = all(terms[0][0] == () and len(terms) == 1 for terms in q.entries.values()) and all(
            i == j for i, j in q.entries
        )
        if not plain:
            lines += ["", "Q", q.text()]
        if mode is not None:
            return "\n".join(lines)
        switched = {
            name: " + ".join(show.cube(c) or "1" for c in cubes) or "0"
            for name, cubes in self.active.items()
            if cubes != ((),)
        }
        if switched:
            lines += ["", "active: " + ", ".join(f"{k}: {v}" for k, v in switched.items())]
        return "\n".join(lines)

    def __str__(self) -> str:
        return self.text()

    def _repr_latex_(self) -> str:
        return f"$S = {self.S.latex()}$"


def _silenced(form: SwitchForm[Any], region: Region[Any]) -> list[set[int]]:
    """Put "receives nothing" for "gives nothing" in the rows of linear resistors.

    Where a mode only says that a resistor's output is zero, so is its intake, by its law; the
    row can then stay in reference causality, with the output silenced. This is what the diagonal
    Boolean matrix of Margetts & Ngwompo does.
    """
    dead: list[set[int]] = []
    for replaced in region.replaced:
        gone: set[int] = set()
        for target, row in replaced.items():
            own = form.column(target)
            if own is None or own.kind != "intake":
                continue
            law = form.graph.nodes[own.index].law
            output = form.partner.get(("resistor", own.index, own.port))
            linear = law is not None and law.matrix is not None and len(law.matrix) == 1
            if linear and set(row) == {output} and output is not None:
                replaced[target] = {target: -form.ring.one}
                gone.add(output)
        dead.append(gone)
    return dead


@called("hb.junction_matrix(model)")
def junction_matrix(
    model: Model | FlatGraph, *, reference: AnyMode | None = None, symbolic: bool = True
) -> JunctionMatrix:
    """Derive the junction structure matrix of a model.

    Parameters
    ----------
    model : Model or FlatGraph
    reference : tuple of int or mapping, optional
        Default: the model's own, else the mode with most storage in integral causality.
    symbolic : bool
        Moduli in names of parameters, or numbers.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc")
    >>> m.add(V=hb.Se(1), sw=hb.One(), r=hb.R(2), c=hb.C(1))
    >>> m.bond("V -> sw -> r", "sw -> c")
    >>> m.machine("S", states={"open": [], "closed": ["sw"]}, start="open")
    >>> print(junction_matrix(m))
    S
          c.e  r.f  V
    c.q'  .    κ    .
    r.e   -κ   .    κ
    <BLANKLINE>
    active: r.f: κ
    """
    graph = graph_of(model)
    best = reference_mode(graph, mode=None if reference is None else graph.mode_of(reference))
    values = parameter_values(graph) if symbolic else {}
    ring: Ring[Any] = Symbols(values) if symbolic else Numbers(values, caller(graph))
    form = switch_form(graph, ring, best.mode, symbolic=symbolic, imposes=best.causality.resistors)
    regions = regions_of(form)
    region_at = {v: r for r in regions if not r.why_kept for v in r.variables}
    silent = [(r.space, _silenced(form, r)) for r in regions if not r.why_kept]
    rows = [mixed_row(form, row, region_at, target=t) for t, row in form.targets.items()]
    for space, dead in silent:
        if any(dead):
            rows = [row.silenced(space, dead, ring) for row in rows]
    kept: list[int] = []
    for region in regions:
        if region.why_kept:
            kept += region.variables
            rows += [closing_row(form, s) for s in region.switches]
            rows += [MixedRow(form.constraints[k]) for k in region.constraints]
    return JunctionMatrix(
        graph,
        best.mode,
        form,
        rows,
        tuple(form.targets),
        tuple(kept),
        best.causality.resistors,
        Naming(graph),
    )
