"""Global residuals: relations among sensors and sources that hold in every mode.

A residual (an analytical redundancy relation) is zero as long as the plant is as modelled. A
*global* one holds in all modes: the switch positions are in it as Booleans. C. B. Low, D. Wang,
S. Arogeti and M. Luo, *Quantitative hybrid bond graph-based fault detection and isolation*, IEEE
Trans. Automation Science and Engineering 7(3), 2010; M. Yu, D. Wang and M. Luo, *Model-based
prognosis for hybrid systems with mode-dependent degradation behaviors*, IEEE Trans. Industrial
Electronics 61(1), 2014. They walk a causal graph in which sensors are sources and storage is in
derivative causality; here the same rows are eliminated for a graph of any size.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

from hybond.analysis.residuals.jets import Jets
from hybond.analysis.residuals.origins import origin, rank, unobserved
from hybond.analysis.residuals.regions import Found, global_rows
from hybond.analysis.residuals.sensor_rows import Known, SensorRows, sensor_rows
from hybond.analysis.residuals.unit_pivots import UnitPivots
from hybond.calls import called
from hybond.equations.booleans import Naming
from hybond.equations.display import Display
from hybond.equations.mixed import MixedRow
from hybond.equations.ring import Row
from hybond.equations.symbolic.rational import Rational
from hybond.errors import EquationError
from hybond.model.builder import Model, graph_of
from hybond.model.graph import FlatGraph, Mode

if TYPE_CHECKING:
    from hybond.analysis.residuals.signatures import Signatures
    from hybond.analysis.residuals.values import ResidualValues
    from hybond.causality.diagnostic import Diagnostic
    from hybond.result import Result


@dataclass(frozen=True)
class Residual:
    """One residual of a `Residuals`."""

    name: str
    """``G1``, ``G2``, ..."""
    origin: str
    """The law that is compared: ``balance of 1-junction in``."""
    row: MixedRow[Rational]
    """Coefficients of sensors, sources and their derivatives, by mode."""
    of: Residuals = field(repr=False, compare=False)

    @property
    def sensors(self) -> tuple[str, ...]:
        """The sensors that it reads in some mode."""
        return self._names("sensor")

    @property
    def sources(self) -> tuple[str, ...]:
        """The sources that it reads in some mode."""
        return self._names("source")

    def _names(self, kind: str) -> tuple[str, ...]:
        jets = self.of.jets
        columns = {jets.jets[k].column for k in self.row.columns()}
        known = [jets.known[k] for k in sorted(columns, reverse=True)]
        return tuple(dict.fromkeys(k.name for k in known if k.kind == kind))

    @property
    def order(self) -> int:
        """The highest derivative that it reads in some mode."""
        return max((self.of.jets.jets[k].order for k in self.row.columns()), default=0)

    def at(self, mode: Mode, *, values: Mapping[str, float] | None = None) -> dict[str, float]:
        """Return its coefficients in one mode, by the names of what it reads."""
        ring = self.of.ring
        known = ring.known(values or {})
        row = self.row.at(self.of.graph.mode_of(mode), ring)
        return {self.of.jets.name(k): c.evaluate(known) for k, c in sorted(row.items())}

    def vacuous(self, mode: Mode) -> bool:
        """Whether it says ``0 = 0`` in a mode."""
        return not self.row.at(mode, self.of.ring)

    @property
    def silent(self) -> tuple[str, ...]:
        """Products of Booleans for which it says ``0 = 0``; empty if it says something always."""
        if len(self.row.parts) != 1:
            return ()
        (part,) = self.row.parts
        one, base = self.of.ring.one, self.row.base
        empty = frozenset(
            k
            for k, row in enumerate(part.rows)
            if not self.of.ring.collect([(one, base), (one, row)])
        )
        naming, show = self.of.naming, self.of.display
        return tuple(show.cube(c) or "1" for c in naming.cubes(part.space, empty))

    def text(self, mode: Mode | None = None) -> str:
        """Return the formula as text, of all modes or of one."""
        from hybond.analysis.residuals.text import write_residual

        return write_residual(self, mode)

    def latex(self, mode: Mode | None = None) -> str:
        """Return the formula for LaTeX, of all modes or of one."""
        from hybond.analysis.residuals.text import write_residual

        return write_residual(self, mode, form="latex")

    def markdown(self, mode: Mode | None = None) -> str:
        """Return the formula for Markdown, between dollars."""
        return f"${self.latex(mode)}$"

    def sympy(self, mode: Mode | None = None) -> Any:
        """Return the formula as a SymPy expression; needs the extra ``symbolic``.

        A derivative is a symbol called with primes, a Boolean a symbol that is 0 or 1.
        """
        from hybond.analysis.residuals.text import residual_sympy

        return residual_sympy(self, mode)

    def __str__(self) -> str:
        return f"{self.name} = {self.text()}"

    def _repr_markdown_(self) -> str:
        return self.markdown()


class Residuals(Sequence[Residual]):
    """The residuals of a model with sensors; made by `residuals`. A sequence of `Residual`.

    Attributes
    ----------
    graph : FlatGraph
    sensors : tuple of str
    unobserved : tuple of Unobserved
        Storage that the sensors do not determine.
    unused : dict
        Element to the reason why its law is in no residual.
    mode : tuple of int or None
        The only mode for which they were derived; None for all modes.
    complete : bool
        Whether in every mode the residuals are all that the rows used say about sensors and
        sources: nothing was lost in eliminating unknowns.
    special : bool
        Whether some residual holds only at the model's own values of parameters, because of a
        coincidence (two equal time constants).
    """

    def __init__(self, given: SensorRows, pivots: UnitPivots, found: Found) -> None:
        self.given = given
        self.graph: FlatGraph = given.graph
        self.mode: Mode | None = None
        self.ring = given.ring
        self.sensors = tuple(k.name for k in given.known.values() if k.kind == "sensor")
        self.naming = Naming(given.graph)
        self.jets = Jets(given.known)
        self.regions = found
        self.unused = {given.graph.nodes[n].path: why for n, why in sorted(given.unused.items())}
        self.unobserved = tuple(unobserved(self, pivots, found))
        self.complete = not found.large
        self.special = any(r.special for r in found.regions)
        self._list: list[Residual] = []
        order = sorted(found.rows, key=lambda item: rank(given, pivots, item[0]))
        for tag, row in order:
            mixed = row.mapped(self.jets.split)
            if not mixed.columns():
                continue
            name = f"G{len(self._list) + 1}"
            one = Residual(name, origin(given, pivots, tag), mixed, self)
            if one.text().startswith("-"):
                # nothing in it is positive: the other sign reads better
                one = Residual(name, one.origin, mixed.mapped(_turned), self)
            self._list.append(one)

    # -- a sequence

    def __len__(self) -> int:
        return len(self._list)

    def __getitem__(self, k: Any) -> Any:
        if isinstance(k, str):
            return next(r for r in self._list if r.name == k)
        return self._list[k]

    # -- what they say

    @cached_property
    def display(self) -> Display:
        """How coefficients and Booleans are written."""
        return Display(self.graph, self.naming, self.ring.meaning)

    @property
    def known(self) -> tuple[Known, ...]:
        """The sensors and sources that residuals read."""
        used = {self.jets.jets[k].column for r in self._list for k in r.row.columns()}
        known = self.given.known
        order = sorted(used, key=lambda k: (known[k].kind == "sensor", known[k].node, -k))
        return tuple(known[k] for k in order)

    @cached_property
    def diagnostic(self) -> Diagnostic:
        """The verdict of diagnostic causality on this graph, these sensors at their junctions."""
        from hybond.causality.diagnostic import diagnostic_causality

        monitored = [self.graph.nodes[n].path for n in sorted(self.given.monitored)]
        return diagnostic_causality(self.graph, sensors=monitored)

    def evaluate(
        self,
        data: Result | Mapping[str, Any],
        *,
        mode: Mode | None = None,
        t: Sequence[float] | None = None,
        values: Mapping[str, float] | None = None,
    ) -> ResidualValues:
        """Return the values of all residuals along a run, or for measured data.

        Parameters
        ----------
        data : Result or mapping
            A run of this model or of a faulty variant of it; or arrays by name, derivatives with
            primes (``"De1'"``), for one mode. Sources that are not given are taken from the
            model if they are constant.
        mode : tuple of int, optional
            For data: the mode, default the start mode. For a run: the mode that the diagnosis
            believes in, default the run's own at each point.
        t : sequence of float, optional
            Instants of the run; default its accepted points.
        values : mapping, optional
            Values of parameters (``p:R1.R``) over the model's.

        Raises
        ------
        UsageError
            HB-A303 if data lack what a residual reads, or the run is of another model.
        """
        from hybond.analysis.residuals.values import along_run, of_data

        if isinstance(data, Mapping):
            return of_data(self, data, mode=mode, values=values)
        return along_run(self, data, mode=mode, t=t, values=values)

    def signatures(
        self, mode: Mode | Mapping[str, str] | None = None, *, modes: Sequence[Mode] | None = None
    ) -> Signatures:
        """Return which faults each residual reacts to, in one mode or in several.

        Parameters
        ----------
        mode : tuple of int or mapping, optional
            One mode.
        modes : sequence of tuple of int, optional
            Several; default all combinations of states, if these are few, else those that
            differ from the start mode in one machine.
        """
        from hybond.analysis.residuals.signatures import examined_modes, fault_signatures

        mode = self.mode if mode is None and modes is None else mode
        if mode is not None:
            chosen = [self.graph.mode_of(mode)]
        else:
            chosen = list(modes) if modes is not None else examined_modes(self.graph)
        return fault_signatures(self, chosen)

    # -- writing

    def notes(self) -> list[str]:
        """Return what there is to say about them."""
        from hybond.analysis.residuals.text import notes_of

        return notes_of(self)

    def text(self, mode: Mode | None = None) -> str:
        """Return all residuals as text with what their names mean."""
        from hybond.analysis.residuals.text import write_page

        return write_page(self, mode)

    def latex(self, mode: Mode | None = None) -> str:
        """Return all residuals as a LaTeX ``align*``."""
        rows = [f"{r.name} &= {r.latex(mode)}" for r in self]
        return "\\begin{align*}\n" + " \\\\\n".join(rows) + "\n\\end{align*}"

    def table(self) -> str:
        """Return one line per residual: what it compares, sensors, order, formula."""
        from hybond.analysis.residuals.text import write_table

        return write_table(self)

    def to_markdown(self) -> str:
        """Return residuals and notes as Markdown."""
        from hybond.analysis.residuals.text import write_markdown

        return write_markdown(self)

    def record(self) -> dict[str, Any]:
        """Return plain data."""
        from hybond.analysis.residuals.text import record_of

        return record_of(self)

    def __str__(self) -> str:
        return self.text()

    def __repr__(self) -> str:
        return str(self)

    def _repr_markdown_(self) -> str:
        return self.to_markdown()


@called('hb.residuals(model, sensors=["c.e"])')
def residuals(
    model: Model | FlatGraph,
    *,
    sensors: Sequence[str],
    mode: Mode | Mapping[str, str] | None = None,
) -> Residuals:
    """Derive the global residuals of a model with sensors.

    Parameters
    ----------
    model : Model or FlatGraph
    sensors : sequence of str
        Signals that are measured: names of signals, or efforts, flows and stored quantities, or
        expressions that are linear in these.
    mode : tuple of int or mapping, optional
        Derive the residuals of this mode only. Needed where so many switches meet without a
        sensor between them that no formula of all modes is made.

    Raises
    ------
    UsageError
        HB-A301 for a sensor that is no signal of the model.
    EquationError
        HB-A302 for a sensor that is not linear; HB-A304 if nothing follows that could be
        compared.

    Examples
    --------
    A source, a switch with a resistance and a capacitor; voltage and source current measured:

    >>> import hybond as hb
    >>> m = hb.Model("charger")
    >>> m.add(V=hb.Se("5 V"), sw=hb.One(), r=hb.R("1 kohm"), n=hb.Zero(), c=hb.C("1 mF"))
    >>> m.bond("V -> sw -> n -> c", "sw -> r")
    >>> m.machine("S", states={"closed": ["sw"], "open": []}, start="closed")
    >>> found = residuals(m, sensors=["n.e", "V.f"])
    >>> print(found)
    G1 = κ*(V - n.e - r.R*V.f) + (1 - κ)*V.f
    G2 = V.f - c.C*n.e'
    where
      V = 5
      κ = 1 when S is closed
    # G1: balance of 1-junction sw; G2: balance of 0-junction n
    # diagnostic causality exists
    """
    graph = graph_of(model)
    given = sensor_rows(graph, sensors)
    pivots = UnitPivots(given)
    one = None if mode is None else graph.mode_of(mode)
    found = Residuals(given, pivots, global_rows(given, pivots, mode=one))
    found.mode = one
    if not len(found) and found.regions.large:
        raise EquationError(
            f"no residual of all modes: {found.regions.large[0].why_left_out}",
            code="HB-A304",
            where="sensors",
            hint="add a sensor between the switches, or ask for one mode: mode={...}",
        )
    if not len(found):
        raise EquationError(
            "the sensors are not redundant: nothing that the model says can be compared",
            code="HB-A304",
            where="sensors",
            hint="add a sensor; " + "; ".join(str(u) for u in found.unobserved[:3])
            if found.unobserved
            else "add a sensor where the model predicts a value",
        )
    return found


def _turned(row: Row[Rational]) -> Row[Rational]:
    return {k: -c for k, c in row.items()}
