"""A whole hybrid graph with every switch as a pair of variables: one linear form for all modes.

A controlled junction is an ordinary junction with one more variable: ON, its balance (the net
effort of a 1-junction) is zero; OFF, its common variable (the flow of a 1-junction) is zero. In
the reference mode one of the two is zero: that one is its *switch variable* ``s``. Everything
else does not depend on the mode and is solved once::

    x' = A z + B u + F s,      closing rows:  s = 0  or  (G z + H u + J s) = 0

so a graph with a thousand switches has a thousand switch variables, not 2^1000 systems. What the
structure leaves free in the reference mode (storage in derivative causality there) stays as a
*tear*, with a constraint row beside it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from hybond.equations.element_rows import Assembly, Closing, Column, Rows
from hybond.equations.peeling import Peeling
from hybond.equations.ring import Ring, Row
from hybond.model.expressions import Expr
from hybond.model.graph import FlatGraph, Mode

T = TypeVar("T")


@dataclass(slots=True)
class SwitchForm(Generic[T]):
    """The mode-independent solution of a graph."""

    graph: FlatGraph
    ring: Ring[T]
    rows: Rows[T]
    """The columns, and what closes each switch variable."""
    targets: dict[int, Row[T]]
    """Column of each rate (and of what each held resistor receives) to its value, a row of knowns,
    switch variables and tears."""
    outputs: list[Row[T]]
    """The wanted signals, likewise."""
    tears: tuple[int, ...]
    """Columns that the structure leaves free."""
    constraints: list[Row[T]]
    """Rows that hold in every mode, each without a rate."""
    solution: Peeling[T]
    partner: dict[tuple[str, int, int], int]
    """Column by kind, index and port."""
    _closed: dict[tuple[int, tuple[object, ...]], Row[T]] = field(default_factory=dict)

    def column(self, k: int) -> Column | None:
        """Return what a known column is; None for a bond variable (a tear)."""
        return self.rows.columns[k - self.rows.unknowns] if k >= self.rows.unknowns else None

    @property
    def switches(self) -> tuple[int, ...]:
        """The columns of all switch variables."""
        return tuple(self.rows.closing)

    def closing(self, switch: int, states: tuple[int, ...]) -> Row[T]:
        """Return the row that closes a switch variable in these states of its machines."""
        own = self.rows.closing[switch]
        at = (switch, own.key(states))
        if at not in self._closed:
            self._closed[at] = self.solution.reduce(own.row(states))
        return self._closed[at]

    def closer(self, switch: int) -> Closing[T]:
        """Return what decides the closing row of a switch variable."""
        return self.rows.closing[switch]


def switch_form(
    graph: FlatGraph,
    ring: Ring[T],
    reference: Mode,
    *,
    symbolic: bool,
    outputs: Sequence[Expr] = (),
    imposes: Mapping[tuple[int, int], str] | None = None,
) -> SwitchForm[T]:
    """Solve the mode-independent structure of `graph`.

    Parameters
    ----------
    ring : Ring
        Numbers or symbols.
    reference : tuple of int
        The mode in which all switch variables are zero.
    symbolic : bool
        Whether laws are read in names of parameters.
    outputs : sequence of Expr
        Signals in canonical names; each must be affine in bond variables.
    imposes : mapping, optional
        Resistor ports to hold, with what they impose.

    Raises
    ------
    EquationError
        HB-Q102 for an output that is not affine in efforts and flows.
    """
    from hybond.errors import EquationError

    assembly = Assembly(
        graph,
        ring,
        graph.on_nodes(reference),
        symbolic=symbolic,
        imposes=imposes,
        feedback=imposes is None,
    )
    rows = assembly.out
    solution = Peeling(ring, rows.rows, rows.unknowns)
    bonds = len(graph.bonds)
    targets: dict[int, Row[T]] = {}
    for s in graph.storages:
        at = s.bond + (bonds if s.kind == "C" else 0)
        way = ring.of(float(s.sign) if s.kind == "C" else 1.0)
        targets[assembly.rates[s.index]] = solution.reduce({at: way})
    if imposes is not None:
        for (node, port), variable in imposes.items():
            end = graph.nodes[node].ends[port]
            flow = variable == "e"
            own = rows.column("intake", node, port=port)
            way = ring.of(float(end.sign) if flow else 1.0)
            targets[own] = solution.reduce({end.bond + (bonds if flow else 0): way})
    wanted: list[Row[T]] = []
    for e in outputs:
        found = assembly.affine(e)
        if found is None:
            raise EquationError(
                f"the output {e} is not linear in efforts and flows",
                code="HB-Q102",
                where="outputs",
                hint="ask for the efforts and flows that it is made of",
            )
        slopes, rest = found
        given = assembly.given(-1, rest, port=len(wanted))
        wanted.append(solution.reduce(ring.collect([(ring.one, slopes), (ring.one, given)])))
    return SwitchForm(
        graph=graph,
        ring=ring,
        rows=rows,
        targets={k: solution.settled(row) for k, row in targets.items()},
        outputs=[solution.settled(row) for row in wanted],
        tears=tuple(solution.free()),
        constraints=[solution.settled(row) for row in solution.constraints],
        solution=solution,
        partner={
            (c.kind, c.index, c.port): rows.unknowns + k
            for k, c in enumerate(rows.columns)
            if c.kind in ("rate", "storage", "stored", "resistor", "intake")
        },
    )
