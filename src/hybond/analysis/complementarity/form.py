"""The linear complementarity system of a graph whose junctions have laws, in symbols or numbers.

With the laws of ideal diodes, contacts and dry friction left open a graph is::

    x' = A x + B u + E l + a,     w = C x + F u + D l + c,     0 <= l, w >= 0, l w = 0 (or a box)

`l` and `w` are the common variable and minus the net variable of each junction with a law, or the
other way round (`orientation`); machines written by hand stay in one mode. The matrices come
from the rows of the mixed-Boolean state equations: a junction's switch variable is its `l`, and
the row that would close it is its `w`.

A. J. van der Schaft and J. M. Schumacher, *Complementarity modeling of hybrid systems*, IEEE
Trans. Autom. Control 43 (1998); W. P. M. H. Heemels, J. M. Schumacher and S. Weiland, *Linear
complementarity systems*, SIAM J. Appl. Math. 60 (2000).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from hybond.analysis.complementarity.orientation import law_machines, open_ports
from hybond.analysis.complementarity.ports import LawPort, Port, law_ports
from hybond.analysis.complementarity.rows import Derived, derive_rows
from hybond.analysis.complementarity.start import nonlinear_nodes, start_values
from hybond.analysis.complementarity.tangent import Tangent, tangent
from hybond.calls import called
from hybond.causality.orientation import base_mode
from hybond.equations.booleans import Naming
from hybond.equations.display import Display
from hybond.equations.element_parts import parameter_values
from hybond.equations.matrix import BooleanMatrix
from hybond.equations.ring import Numbers, Ring, Symbols
from hybond.equations.storage import stiffness_at
from hybond.errors import EquationError
from hybond.model.builder import Model, graph_of
from hybond.model.expressions import Expr
from hybond.model.graph import AnyMode, FlatGraph, Mode
from hybond.uncollected import uncollected

if TYPE_CHECKING:
    from hybond.analysis.complementarity.properties import Properties


@dataclass
class ComplementarityForm:
    """A linear complementarity system; made by `complementarity`.

    Parameters
    ----------
    graph : FlatGraph
    mode : tuple of int
        The mode of the machines written by hand; laws of junctions are in their first branch.
    laws : tuple of LawPort
        The pairs ``l`` and ``w``, in the order of the columns of `E`.
    states : tuple of str
        The stored quantities.
    inputs : tuple of str
        Sources in the order of the columns of `B`; ``V'`` is the rate of the source V, which
        enters where storage follows a source.
    A, B, E, C, D, F : BooleanMatrix
    a, c : BooleanMatrix
        One column; not zero for a linearisation only.
    formulas : dict
        What the inputs are, in canonical names.
    symbolic : bool
        Whether coefficients are formulas.
    nonlinear : tuple of str
        What is not linear; then the matrices are a linearisation.
    constraints : tuple of str
        What stored quantities satisfy in all branches of the laws.
    point : mapping or None
        Stored quantities at which it was linearised.
    """

    graph: FlatGraph
    mode: Mode
    laws: tuple[LawPort, ...]
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    A: BooleanMatrix
    B: BooleanMatrix
    E: BooleanMatrix
    C: BooleanMatrix
    D: BooleanMatrix
    F: BooleanMatrix
    a: BooleanMatrix
    c: BooleanMatrix
    formulas: Mapping[str, Expr]
    display: Display
    symbolic: bool = True
    nonlinear: tuple[str, ...] = ()
    constraints: tuple[str, ...] = ()
    point: Mapping[str, float] | None = None
    constraint_rows: Any = ()
    """The constraints as rows of an array, one column per stored quantity."""
    vanished: frozenset[str] = frozenset()
    """Names of coefficients that are zero in the model, and were left out."""

    @property
    def given(self) -> tuple[str, ...]:
        """Names ``l1``, ``l2``, ..."""
        return tuple(law.given for law in self.laws)

    @property
    def answers(self) -> tuple[str, ...]:
        """Names ``w1``, ``w2``, ..."""
        return tuple(law.answer for law in self.laws)

    @cached_property
    def properties(self) -> Properties:
        """Whether D is positive semi-definite, passivity, relative degrees."""
        from hybond.analysis.complementarity.properties import properties_of

        return properties_of(self)

    def numbers(self, values: Mapping[str, float] | None = None) -> dict[str, Any]:
        """Return the matrices as arrays.

        Parameters
        ----------
        values : mapping, optional
            Values of names in coefficients (``p:R``) over those of the model.
        """
        return {name: getattr(self, name).at(self.mode, values=values) for name in "ABECDFac"}

    def text(self) -> str:
        """Return the system as text."""
        from hybond.analysis.complementarity.text import write_text

        return write_text(self)

    def latex(self) -> str:
        """Return the system as a LaTeX ``align*``."""
        from hybond.analysis.complementarity.text import write_latex

        return write_latex(self)

    def markdown(self) -> str:
        """Return the system for Markdown, formulas between dollars."""
        from hybond.analysis.complementarity.text import write_markdown

        return write_markdown(self)

    def to_data(self) -> dict[str, Any]:
        """Return plain data, ready for JSON."""
        from hybond.analysis.complementarity.text import to_data

        return to_data(self)

    def sympy(self) -> dict[str, Any]:
        """Return the matrices as SymPy matrices; needs the extra ``symbolic``."""
        return {name: getattr(self, name).sympy() for name in "ABECDFac"}

    def __str__(self) -> str:
        return self.text()

    def _repr_markdown_(self) -> str:
        return self.markdown()


@uncollected
@called("hb.complementarity(model)")
def complementarity(
    model: Model | FlatGraph, mode: AnyMode | None = None, *, symbolic: bool = True
) -> ComplementarityForm:
    """Derive the linear complementarity system of a model whose junctions have laws.

    Parameters
    ----------
    model : Model or FlatGraph
    mode : tuple of int or mapping, optional
        The mode of the machines written by hand; default the start mode.
    symbolic : bool
        Coefficients in names of parameters, or numbers.

    Returns
    -------
    ComplementarityForm

    Raises
    ------
    EquationError
        HB-Q109 if no junction has a law, HB-Q110 if friction acts in two directions.
    CausalityError
        HB-C104 if a law is tied to a constraint whichever of its variables is given.

    Notes
    -----
    A graph that is not linear is linearised at its start state, in numbers.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rectifier", domain="electrical")
    >>> m.add(V=hb.Se("10"), d=hb.One(law="diode"), n=hb.Zero(), c=hb.C(1), r=hb.R(2))
    >>> m.bond("V -> d -> n", "n -> c", "n -> r")
    >>> form = complementarity(m)
    >>> print(form)
    c.q' = -c.q/(c.C*r.R) + l1
    w1 = c.q/c.C - V
    0 <= l1 ⟂ w1 >= 0
    where
      l1 = d.f, current of d
      w1 = -d.e, blocked voltage of d
      V = 10
    # D is positive semidefinite; passive: what is stored is a storage function
    # l1 acts on w1 through storage (relative degree 1)
    >>> form.numbers()["A"]
    array([[-0.5]])
    """
    graph = graph_of(model)
    if not law_machines(graph):
        raise EquationError(
            "no junction of this model has a law, so it is no complementarity system",
            code="HB-Q109",
            where=graph.name,
            hint='a diode is { junction = 1, law = "diode" }; for machines see state_equations',
        )
    for machine in graph.machines:
        if machine.law is not None and machine.law.planar:
            raise EquationError(
                f"the friction of {machine.path} acts in two directions: its disk is no linear "
                "complementarity",
                code="HB-Q110",
                where=machine.path,
                hint="state_equations writes the modes in which it sticks and slips",
            )
    chosen = base_mode(graph, graph.mode_of({} if mode is None else mode))
    known = start_values(graph, chosen)
    bent, stored = nonlinear_nodes(graph, chosen, known)
    ports, constraints = open_ports(graph, chosen, frozenset(bent), known)
    nonlinear = _said(graph, bent, stored)
    if not nonlinear:
        values = parameter_values(graph)
        ring: Ring[Any] = Symbols(values) if symbolic else Numbers({**values, **known})
        found = derive_rows(graph, chosen, ports, ring, symbolic=symbolic)
        if found is not None:
            show = Display(graph, Naming(graph), ring.meaning)
            # between two timed events inputs are constants: numbers are those of the start
            at_start = ring.known({k: x for k, x in known.items() if k.startswith(("u:", "at:"))})
            return _from_rows(graph, chosen, ports, found, ring, show, at_start, symbolic=symbolic)
        nonlinear = ("what the graph leaves undetermined takes the value of least leakage",)
    x = np.array([known[f"x:{s.index}"] for s in graph.storages])
    rows = np.zeros((len(constraints), len(x)))
    for i, row in enumerate(constraints):
        for k, c in row.items():
            rows[i, k] = c
    held = rows @ stiffness_at(graph, x)
    return _from_numbers(graph, chosen, ports, tangent(graph, chosen, ports), x, nonlinear, held)


def _said(graph: FlatGraph, bent: tuple[int, ...], stored: tuple[int, ...]) -> tuple[str, ...]:
    """Return what is not linear, by element."""
    found = [f"the law of {graph.nodes[k].about.symbol} {graph.nodes[k].path}" for k in bent]
    found += [f"the law of {graph.nodes[k].kind} {graph.nodes[k].path}" for k in stored]
    return tuple(found)


def _from_rows(
    graph: FlatGraph,
    mode: Mode,
    ports: tuple[Port, ...],
    found: Derived[Any],
    ring: Ring[Any],
    show: Display,
    values: Mapping[str, float],
    *,
    symbolic: bool,
) -> ComplementarityForm:
    laws = law_ports(graph, ports, symbolic=symbolic)
    states = tuple(s.path for s in graph.storages)
    inputs = tuple(found.names[k] for k in found.inputs)
    place = {
        "state": {k: j for j, k in enumerate(found.states)},
        "input": {k: j for j, k in enumerate(found.inputs)},
        "law": {k: j for j, k in enumerate(found.laws)},
    }

    def matrix(rows: list[dict[int, Any]], kind: str, names: tuple[str, ...]) -> BooleanMatrix:
        where = place.get(kind, {})
        columns = {"state": states, "input": inputs, "law": tuple(p.given for p in laws)}
        entries = {
            (i, where[k]): (((), c),)
            for i, row in enumerate(rows)
            for k, c in row.items()
            if k in where
        }
        return BooleanMatrix(names, columns.get(kind, ("1",)), entries, show, values)

    answers = tuple(p.answer for p in laws)
    return ComplementarityForm(
        graph=graph,
        mode=mode,
        laws=laws,
        states=states,
        inputs=inputs,
        A=matrix(found.rates, "state", states),
        B=matrix(found.rates, "input", states),
        E=matrix(found.rates, "law", states),
        C=matrix(found.answers, "state", answers),
        D=matrix(found.answers, "law", answers),
        F=matrix(found.answers, "input", answers),
        a=matrix([], "", states),
        c=matrix([], "", answers),
        formulas={found.names[k]: found.formulas[k] for k in found.inputs},
        display=show,
        symbolic=symbolic,
        constraints=tuple(_constraint(row, found, show) for row in found.constraints),
        constraint_rows=matrix(
            found.constraints, "state", tuple(str(k) for k in range(len(found.constraints)))
        ).at(mode),
        vanished=frozenset(ring.vanished),
    )


def _constraint(row: dict[int, Any], found: Derived[Any], show: Display) -> str:
    from hybond.equations.display import joined, split

    names = {k: show.name(f"x:{j}") for j, k in enumerate(found.states)}
    names.update(found.names)
    return "0 = " + joined(
        [show.term(piece, "", names[k]) for k, c in row.items() for piece in split(c)]
    )


def _from_numbers(
    graph: FlatGraph,
    mode: Mode,
    ports: tuple[Port, ...],
    found: Tangent,
    x: Any,
    nonlinear: tuple[str, ...],
    held: Any,
) -> ComplementarityForm:
    show = Display(graph, Naming(graph), {})
    laws = law_ports(graph, ports, symbolic=False)
    states = tuple(s.path for s in graph.storages)
    given, answers = tuple(p.given for p in laws), tuple(p.answer for p in laws)

    def matrix(array: Any, rows: tuple[str, ...], columns: tuple[str, ...]) -> BooleanMatrix:
        entries = {
            (i, j): (((), float(array[i, j])),)
            for i in range(len(rows))
            for j in range(len(columns))
            if array[i, j] != 0.0
        }
        return BooleanMatrix(rows, columns, entries, show, {})

    nothing: dict[tuple[int, int], Any] = {}
    return ComplementarityForm(
        graph=graph,
        mode=mode,
        laws=laws,
        states=states,
        inputs=(),
        A=matrix(found.A, states, states),
        B=BooleanMatrix(states, (), nothing, show, {}),
        E=matrix(found.E, states, given),
        C=matrix(found.C, answers, states),
        D=matrix(found.D, answers, given),
        F=BooleanMatrix(answers, (), nothing, show, {}),
        a=matrix(found.a[:, None], states, ("1",)),
        c=matrix(found.c[:, None], answers, ("1",)),
        formulas={},
        display=show,
        symbolic=False,
        nonlinear=nonlinear,
        constraint_rows=held,
        point={s: float(value) for s, value in zip(states, x, strict=True)},
    )
