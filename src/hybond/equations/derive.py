"""From a graph to its mixed-Boolean state equations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, TypeVar

from hybond.calls import called
from hybond.equations.booleans import Naming
from hybond.equations.element_parts import parameter_values
from hybond.equations.element_rows import laws_of
from hybond.equations.mixed import MixedRow, cleared, closing_row, mixed_row
from hybond.equations.points import caller, point
from hybond.equations.regions import Region, regions_of
from hybond.equations.ring import Numbers, Ring, Row, Symbols, substituted
from hybond.equations.state_form import StateEquations
from hybond.equations.switch_form import SwitchForm, switch_form
from hybond.model.builder import Model, graph_of
from hybond.model.expressions import names
from hybond.model.graph import AnyMode, FlatGraph
from hybond.uncollected import uncollected

T = TypeVar("T")


@uncollected
@called("hb.state_equations(model)")
def state_equations(
    model: Model | FlatGraph,
    *,
    reference: AnyMode | None = None,
    outputs: Sequence[str] = (),
    symbolic: bool = True,
    values: Mapping[str, float] | None = None,
    compact: bool = True,
) -> StateEquations[Any]:
    """Derive the mixed-Boolean state equations of a model.

    Parameters
    ----------
    model : Model or FlatGraph
    reference : tuple of int or mapping, optional
        Default: the model's own, else the mode with most storage in integral causality.
    outputs : sequence of str
        Signals, as the model names them.
    symbolic : bool
        Coefficients in names of parameters, or numbers.
    values : mapping, optional
        For numbers where the state modulates: values of ``s:k``, ``x:k``, ``time``, ``u:k``.

    compact : bool
        Whether switches are eliminated also where some mode has no solution (two switches that
        short a source); that mode then has the long form. If not, everybody has it.

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
    graph = graph_of(model)
    graph_values = parameter_values(graph) if symbolic else {}
    known = {**graph_values, **point(graph, values)}
    ring: Ring[Any] = Symbols(known) if symbolic else Numbers(known, caller(graph))
    start = graph.mode_of({} if reference is None else reference)
    if reference is None and graph.machines:
        from hybond.causality.reference import reference_mode

        start = reference_mode(graph).mode
    wanted = [graph.signal(text) for text in outputs]
    form = switch_form(graph, ring, start, symbolic=symbolic, outputs=wanted)
    regions = regions_of(form, compact=compact)
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
    closing: list[tuple[int, MixedRow[Any]]] = []
    for region in regions:
        if region.why_kept:
            closing += [(s, closing_row(form, s)) for s in region.switches]
            closing += [(-1, MixedRow(form.constraints[k])) for k in region.constraints]
    closing = [(s, row) for s, row in closing if row.columns()]
    rows += [row for _, row in closing]
    results = [mixed_row(form, row, region_at) for row in form.outputs]
    stored = storage_rows(form, symbolic=symbolic)

    def in_x(row: Row[Any]) -> Row[Any]:
        return substituted(ring, row, stored)

    # what a nonlinear law reads counts, too: it is what its closing row is there for
    read = {k for row in (*rows, *results, *_arguments(form, region_at)) for k in row.columns()}
    variables = [v for region in regions if region.why_kept for v in region.variables]
    kept = tuple(v for v in variables if v in read)
    naming = Naming(graph)
    for space in sorted({p.space for row in (*rows, *results) for p in row.parts}, key=str):
        naming.variables(space)
    sources = _of_kind(form, "source")
    laws = tuple(k for k in _of_kind(form, "law", "storage") if k not in stored)
    eq = StateEquations(
        graph=graph,
        reference=start,
        form=form,
        regions=regions,
        rows=[cleared(row.mapped(in_x), ring) for row in rows],
        outputs=[row.mapped(in_x) for row in results],
        output_names=tuple(outputs),
        kept=kept,
        row_names=(),
        lost=tuple(v for v in variables if v not in read),
        naming=naming,
        sources=sources,
        laws=laws,
        place=_places(form, kept, sources, laws),
        in_x=in_x,
        again=lambda: state_equations(
            graph,
            reference=start,
            outputs=outputs,
            symbolic=symbolic,
            values=values,
            compact=False,
        ),
    )
    constraints = iter(range(1, len(closing) + 1))
    eq.row_names = tuple(s.path for s in graph.storages) + tuple(
        eq.variable_name(s) if s >= 0 else f"constraint {next(constraints)}" for s, _ in closing
    )
    return eq


def _arguments(form: SwitchForm[T], region_at: dict[int, Region[T]]) -> Iterator[MixedRow[T]]:
    """Yield the bond variables that laws read."""
    bonds = len(form.graph.bonds)
    formulas = [c.formula for c in form.rows.columns if c.kind == "law" and c.formula is not None]
    for name in sorted({n for e in formulas for n in names(e) if n.startswith(("e:", "f:"))}):
        column = int(name[2:]) + (bonds if name[0] == "f" else 0)
        yield mixed_row(form, form.solution.value(column), region_at)


def _of_kind(form: SwitchForm[Any], *kinds: str) -> tuple[int, ...]:
    base = form.rows.unknowns
    return tuple(base + k for k, c in enumerate(form.rows.columns) if c.kind in kinds)


def _places(
    form: SwitchForm[Any], kept: tuple[int, ...], sources: tuple[int, ...], laws: tuple[int, ...]
) -> dict[int, tuple[str, int]]:
    """Return where each column stands in the matrices."""
    n = len(form.graph.storages)
    place: dict[int, tuple[str, int]] = {}
    for s in form.graph.storages:
        place[form.partner["rate", s.index, 0]] = ("rate", s.index)
        place[form.partner["stored", s.index, 0]] = ("state", s.index)
    place.update({k: ("state", n + j) for j, k in enumerate(kept)})
    place.update({k: ("input", j) for j, k in enumerate(sources)})
    place.update({k: ("law", j) for j, k in enumerate(laws)})
    return place


def storage_rows(form: SwitchForm[T], *, symbolic: bool) -> dict[int, dict[int, T]]:
    """Return the co-energy variable of each linear storage port: ``z = K x``."""
    graph, ring = form.graph, form.ring
    at: dict[tuple[int, int], int] = {(s.node, s.port): s.index for s in graph.storages}
    found: dict[int, dict[int, T]] = {}
    for s in graph.storages:
        node = graph.nodes[s.node]
        law = laws_of(graph, node, symbolic=symbolic)
        if law.matrix is None:
            continue
        row = {
            form.partner["stored", at[s.node, j], 0]: ring.read(e)
            for j, e in enumerate(law.matrix[s.port])
        }
        found[form.partner["storage", s.index, 0]] = {k: c for k, c in row.items() if ring.there(c)}
    return found
