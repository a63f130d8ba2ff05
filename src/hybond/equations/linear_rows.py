"""All equations of one mode as linear rows: at a point, or where no coefficient asks for one.

Junctions and two-ports with a constant modulus are solved first, row by row. What elements,
storage, integrals and outputs say follows as rows among states, inputs and the bond variables that
the structure leaves open; each law is differentiated as the expression that it is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hybond.equations.calculus import rate_name
from hybond.equations.degenerate import effective
from hybond.equations.element_parts import Parts, configure, settings
from hybond.equations.peeling import Peeling
from hybond.equations.ring import Numbers, Row
from hybond.equations.slopes import ConstantSlopes, ReadingSlopes, Slopes
from hybond.equations.storage import stored_names
from hybond.errors import EquationError
from hybond.model.expressions import Expr, Number, Pre, names, substitute, uses_pre
from hybond.model.expressions.slots import tree_of
from hybond.model.expressions.tree import transform
from hybond.model.graph import FlatGraph, Mode, Node
from hybond.model.junction_structure import junction_rows
from hybond.model.kinds import SOURCES, STORAGES

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class LinearRows:
    """``E v' = A v + B u`` of a mode near a point.

    Parameters
    ----------
    E, A, B : array, shapes (n, n), (n, n), (n, p)
    variables : tuple of str
        Stored quantities, integrated signals, open bond variables, outputs.
    stored : int
        How many of them, the first ones, may be states.
    outputs : list of int
        Where the outputs stand among the variables.
    straight : bool
        Whether no coefficient depends on the point.
    kinks : tuple of str
        Laws that have a kink or a jump at the point, each with what changes its sign there.
    timed : tuple of str
        What reads the time.
    turning : callable
        How the rows turn along the motion: see `Turning`.
    """

    E: Matrix
    A: Matrix
    B: Matrix
    variables: tuple[str, ...]
    stored: int
    outputs: list[int]
    straight: bool
    kinks: tuple[str, ...]
    timed: tuple[str, ...]
    turning: Callable[[], Turning]


@dataclass(frozen=True, slots=True)
class Turning:
    """How fast the coefficients of rows change where the point moves, for each row as in `A`.

    Parameters
    ----------
    A, B : array, shapes (n, n), (n, p)
        The time derivatives of both.
    sure : array of bool, shape (n,)
        False where one depends on the rate of a bond variable that is not determined.
    """

    A: Matrix
    B: Matrix
    sure: NDArray[np.bool_]


def linear_rows(
    graph: FlatGraph,
    mode: Mode,
    values: Mapping[str, float] | None,
    *,
    inputs: Sequence[str],
    outputs: Mapping[str, Expr],
    landed: bool = False,
    reading: bool = False,
) -> LinearRows:
    """Return all equations of a mode near a point.

    Parameters
    ----------
    values : mapping or None
        Of every canonical name at the point. None: what needs a point is refused.
    inputs : sequence of str
        ``u:k``, ``p:path``, or ``source:node`` for what is added to the value of a source.
    outputs : mapping of str to Expr
        Names and canonical expressions.
    landed : bool
        Whether impacts are over: ``pre()`` in a law is then zero.
    reading : bool
        Whether a slope by a state that is read, where it is zero at the point, counts as some
        number, no two alike: so what laws read shows, even where it does not act at the point.

    Raises
    ------
    EquationError
        HB-E671 for what is sampled and for a law that holds at an instant, HB-A506 for a law
        without a finite slope, HB-Q105 if the mode leaves open what is asked for. Without a point
        HB-Q103 for a law that is not linear, HB-E671 for a source or signal that is not.
    """
    return _Assembly(
        graph, mode, values, tuple(inputs), outputs, landed=landed, reading=reading
    ).made()


@dataclass(slots=True)
class _Linear:
    """One row: coefficients of bond variables, of rates, of states, of inputs. They sum to zero."""

    bonds: Row[float] = field(default_factory=dict)
    rates: dict[int, float] = field(default_factory=dict)
    states: dict[int, float] = field(default_factory=dict)
    inputs: dict[int, float] = field(default_factory=dict)
    law: tuple[Expr, float] | None = None
    """The expression that the slopes are of, and the factor that they have."""


class _Assembly:
    def __init__(
        self,
        graph: FlatGraph,
        mode: Mode,
        values: Mapping[str, float] | None,
        inputs: tuple[str, ...],
        outputs: Mapping[str, Expr],
        *,
        landed: bool,
        reading: bool,
    ) -> None:
        for sample in graph.samples:
            raise EquationError(
                f"{sample.path} is sampled: it changes at instants, not with a rate",
                code="HB-E671",
                where=sample.path,
                hint="take the controller out and make what it sets an input of the model",
            )
        self.graph, self.mode, self.outputs = graph, mode, outputs
        self.landed = landed
        # a law that reads pre() in another mode is one behind an OFF junction: it says nothing here
        self.fieldless = any(
            m.fieldless[k] for m, k in zip(graph.machines, mode, strict=True) if m.fieldless
        )
        self.bonds = len(graph.bonds)
        self.known = [f"x:{s.index}" for s in graph.storages]
        self.known += [f"s:{i.index}" for i in graph.integrals]
        self.place = {name: k for k, name in enumerate(self.known)}
        self.inputs = {name: k for k, name in enumerate(inputs)}
        self.on = graph.on_nodes(mode)
        if values is None:
            self.discrete = settings(graph, mode, {})
            self.slopes: Slopes = ConstantSlopes(graph, self.discrete)
        else:
            watched = {f"at:{w.index}": values[f"at:{w.index}"] for w in graph.watches}
            self.discrete = settings(graph, mode, watched)
            self.slopes = (ReadingSlopes if reading else Slopes)(graph, values, self.discrete)
        self.parts = Parts(graph)
        self.timed: dict[str, None] = {}
        self.steep: list[tuple[int, Expr, EquationError]] = []

    def made(self) -> LinearRows:
        structure: list[Row[float]] = []
        rows: list[_Linear] = []
        for node in self.graph.nodes:
            if node.is_junction:
                off = node.controlled and node.index not in self.on
                structure += junction_rows(node, self.bonds, off=off)
            elif node.kind not in STORAGES:
                self._element(node, structure, rows)
        for row in self._storage_rows():
            self._sort(row, structure, rows)
        peeled = Peeling(Numbers({}), structure, 2 * self.bonds)
        for at, law, refusal in self.steep:
            held = self._held(peeled, law)
            if held < 0:
                raise refusal
            rows[at] = _Linear(bonds={held: 1.0})
        rows += [_Linear(bonds=row) for row in peeled.constraints]
        rows += self._rate_rows()
        return self._square(peeled, rows, peeled.free())

    def _held(self, peeled: Peeling[float], law: Expr) -> int:
        """Return the bond variable that a root at its end holds where nothing else moves, or -1.

        Behind a valve that is shut nothing flows, and the drop of pressure at an orifice stays.
        """
        steep, slopes = self.slopes.steep(law, "")
        if len(steep) != 1 or steep[0].partition(":")[0] not in ("e", "f"):
            return -1
        for name, slope in slopes.items():
            bond = name.partition(":")[0] in ("e", "f")
            if slope and not (bond and not peeled.reduce({self._column(name): 1.0})):
                return -1
        return self._column(steep[0])

    def _sort(self, row: _Linear, structure: list[Row[float]], rows: list[_Linear]) -> None:
        """Put a row that gives one bond variable, by what never turns, to the structure."""
        if row.law is not None or [abs(c) for c in row.bonds.values()] != [1.0]:
            rows.append(row)
            return
        known = {self._state_column(k): c for k, c in row.states.items()}
        known |= {self._input_column(j): c for j, c in row.inputs.items()}
        structure.append({**row.bonds, **known})

    def _state_column(self, k: int) -> int:
        return 2 * self.bonds + k

    def _input_column(self, j: int) -> int:
        return 2 * self.bonds + len(self.known) + j

    # -- rows

    def _element(self, node: Node, structure: list[Row[float]], rows: list[_Linear]) -> None:
        off = node.controlled and node.index not in self.on
        part = self.parts.of(node, off, self.discrete)
        source = self.inputs.get(f"source:{node.index}")
        if source is not None and off:
            source = None  # an OFF source is a null source, whatever it is told
        for constant in (*part.power, *part.laws):
            if part.source is not None:
                break
            row = _Linear({k: float(c) for k, c in constant.items()})
            self._parameters(row, constant)
            if node.kind in SOURCES and source is not None:
                row.inputs[source] = -1.0
            if row.inputs:
                rows.append(row)
            else:
                structure.append(row.bonds)
        if part.source is not None:
            way = 0 if node.kind == "Se" else self.bonds
            row = self.linear(part.source.value, node.path, -1.0, given=True)
            row.bonds[part.source.bond + way] = row.bonds.get(part.source.bond + way, 0.0) + 1.0
            if source is not None:
                row.inputs[source] = row.inputs.get(source, 0.0) - 1.0
            if not names(part.source.value):
                row.law = None
            self._sort(row, structure, rows)
        for dynamic in part.dynamic:
            try:
                row = self.linear(dynamic.expression, node.path, 1.0, given=node.kind in SOURCES)
            except EquationError as refusal:
                if refusal.code != "HB-A506":
                    raise
                self.steep.append((len(rows), dynamic.expression, refusal))
                row = _Linear()
            if node.kind in SOURCES and source is not None:
                row.inputs[source] = row.inputs.get(source, 0.0) - 1.0
            rows.append(row)

    def _storage_rows(self) -> list[_Linear]:
        """Return ``z - law(x) = 0`` of each storage port."""
        rows = []
        for s in self.graph.storages:
            node = self.graph.nodes[s.node]
            assert node.law is not None
            if node.law.matrix is None:
                own_names = stored_names(node, self.graph)
                law = substitute(node.law.expressions[s.port], own_names)
                row = self.linear(law, node.path, -1.0)
            else:
                row = _Linear()
                own = [o for o in self.graph.storages if o.node == s.node]
                for o in own:
                    c = node.law.matrix[s.port][o.port]
                    row.states[o.index] = row.states.get(o.index, 0.0) - float(c)
                    for name, j in self._asked_parameters():
                        slope = self.slopes.at(tree_of(c), name, node.path)
                        change = slope * self.slopes.values[f"x:{o.index}"]
                        row.inputs[j] = row.inputs.get(j, 0.0) - change
            at, way = (s.bond, 1.0) if s.kind == "C" else (self.bonds + s.bond, float(s.sign))
            row.bonds[at] = row.bonds.get(at, 0.0) + way
            rows.append(row)
        return rows

    def _rate_rows(self) -> list[_Linear]:
        """Return ``x' - rate = 0`` of each state."""
        rows = []
        rates: list[tuple[Expr, str]] = [(rate_name(s), s.path) for s in self.graph.storages]
        rates += [(i.rate, i.path) for i in self.graph.integrals]
        for k, (rate, path) in enumerate(rates):
            row = self.linear(rate, path, -1.0)
            row.rates[k] = 1.0
            rows.append(row)
        return rows

    def linear(self, e: Expr, where: str, factor: float, *, given: bool = False) -> _Linear:
        """Return the slopes of an expression, times a factor; whether it is given from outside."""
        if uses_pre(e):
            if self.fieldless and not self.landed:
                raise EquationError(
                    "a law that reads pre() holds at an instant and describes no motion",
                    code="HB-E671",
                    where=where,
                    hint="choose a mode with a field",
                )
            e = transform(e, lambda node: Number(0.0) if isinstance(node, Pre) else node)
        if "time" in names(e):
            self.timed[where] = None
        row = _Linear(law=(e, factor))
        self._put(row, self.slopes.of(e, where, given=given), factor)
        return row

    def _put(self, row: _Linear, slopes: Mapping[str, float], factor: float) -> None:
        for name, slope in slopes.items():
            kind = name.partition(":")[0]
            value = factor * slope
            if name in self.place:
                row.states[self.place[name]] = value
            elif kind in ("e", "f"):
                row.bonds[self._column(name)] = value
            elif name in self.inputs:
                row.inputs[self.inputs[name]] = value

    def _column(self, name: str) -> int:
        kind, _, index = name.partition(":")
        return int(index) + (self.bonds if kind == "f" else 0)

    def _asked_parameters(self) -> list[tuple[str, int]]:
        return [(name, j) for name, j in self.inputs.items() if name.startswith("p:")]

    def _parameters(self, row: _Linear, constant: Mapping[int, float]) -> None:
        """Add what parameters in the coefficients of a row change."""
        for name, j in self._asked_parameters():
            total = 0.0
            for k, c in constant.items():
                kind, b = ("e", k) if k < self.bonds else ("f", k - self.bonds)
                slope = self.slopes.at(tree_of(c), name, "")
                total += slope * self.slopes.values[f"{kind}:{b}"] if slope else 0.0
            if total:
                row.inputs[j] = row.inputs.get(j, 0.0) + total

    # -- the descriptor

    def _square(self, peeled: Peeling[float], rows: list[_Linear], free: list[int]) -> LinearRows:
        """Return the rows as a square descriptor, with what determines nothing left out."""
        many = len(self.known)
        asked = [self.linear(e, name, 1.0) for name, e in self.outputs.items()]
        column = {k: many + j for j, k in enumerate(free)}
        width = many + len(free)
        inputs = len(self.inputs)
        E, A = np.zeros((len(rows), width)), np.zeros((len(rows), width))
        B = np.zeros((len(rows), inputs))
        C, D = np.zeros((len(asked), width)), np.zeros((len(asked), inputs))
        for i, row in enumerate(rows):
            self._write(peeled, row, column, -1.0, A[i], B[i])
            for k, c in row.rates.items():
                E[i, k] += c
        for i, row in enumerate(asked):
            self._write(peeled, row, column, 1.0, C[i], D[i])
        # what matters: variables that a row sees, rows that say something
        found = effective(E, A, B, many)
        if found is None:
            raise self._open("the equations of this mode do not determine all variables")
        keep, columns, loose = found
        for i, name in enumerate(self.outputs):
            moved = np.abs(C[i] @ loose).max(initial=0.0)
            if moved > 1e-9 * np.abs(C[i]).max(initial=1e-300):
                raise self._open(f"this mode leaves {name} open")
        m, q = len(columns), len(asked)
        zero = np.zeros
        whole_e = np.block([[E[np.ix_(keep, columns)], zero((m, q))], [zero((q, m + q))]])
        whole_a = np.block([[A[np.ix_(keep, columns)], zero((m, q))], [C[:, columns], -np.eye(q)]])
        paths = [s.path for s in self.graph.storages] + [i.path for i in self.graph.integrals]
        paths += [self._bond_name(k) for k in free]
        variables = (*(paths[k] for k in columns), *self.outputs)
        return LinearRows(
            whole_e,
            whole_a,
            np.vstack([B[keep], D]),
            variables,
            many,
            list(range(m, m + q)),
            self.slopes.straight,
            tuple(self.slopes.kinks),
            tuple(self.timed),
            lambda: self._turning(peeled, [rows[i] for i in keep], whole_a[:m], column, columns, q),
        )

    def _turning(
        self,
        peeled: Peeling[float],
        rows: list[_Linear],
        a: Matrix,
        column: Mapping[int, int],
        columns: list[int],
        outputs: int,
    ) -> Turning:
        """Return how the rows turn; the rows of outputs, at the end, do not matter."""
        many, m = len(self.known), len(columns)
        found = [self.slopes.turning(*row.law) if row.law else None for row in rows]
        # rates of open bond variables: what keeps the rows without rates at zero
        moves = self._moves()
        drift = np.array(
            [
                self._drift(row, moves) if f is None else f.drift
                for row, f in zip(rows, found, strict=True)
            ]
        )
        still = np.array([not row.rates for row in rows], dtype=bool)
        open_ = a[still][:, many:m]
        rates = np.linalg.lstsq(open_, drift[still], rcond=1e-10)[0] if open_.size else np.zeros(0)
        null = np.zeros((0, m - many))
        if open_.size:
            _, sizes, vt = np.linalg.svd(open_)
            null = vt[int((sizes > 1e-10 * sizes.max(initial=0.0)).sum()) :]
        at = {columns[many + j]: j for j in range(m - many)}
        sure = np.ones(m + outputs, dtype=bool)
        A, B = np.zeros((m + outputs, m + outputs)), np.zeros((m + outputs, len(self.inputs)))
        whole, direct = np.zeros(many + len(column)), np.zeros(len(self.inputs))
        for i, own in enumerate(found):
            if own is None:
                continue
            slopes = dict(own.slopes)
            for (name, other), second in own.bends.items():
                parts = peeled.reduce({self._column(other): 1.0})
                way = np.zeros(m - many)
                for k, c in parts.items():
                    if k in column and column[k] in at:
                        way[at[column[k]]] = c
                given = self._drift(_Linear(parts), moves)
                sure[i] &= bool((np.abs(null @ way) <= 1e-9 * np.abs(way).max(initial=0.0)).all())
                slopes[name] = slopes.get(name, 0.0) + second * (float(way @ rates) + given)
            row = _Linear()
            self._put(row, slopes, own.factor)
            whole[:], direct[:] = 0.0, 0.0
            self._write(peeled, row, column, -1.0, whole, direct)
            A[i, :m], B[i] = whole[columns], direct
        return Turning(A, B, sure)

    def _drift(self, row: _Linear, moves: list[float]) -> float:
        """Return how fast a row of constant coefficients moves with the states that it reads."""
        first, end = self._state_column(0), self._input_column(0)
        read = {k - first: c for k, c in row.bonds.items() if first <= k < end}
        return sum(c * moves[k] for part in (row.states, read) for k, c in part.items())

    def _moves(self) -> list[float]:
        """Return the rate of each state at the point."""
        rates = [rate_name(s) for s in self.graph.storages]
        rates += [i.rate for i in self.graph.integrals]
        return [self.slopes.value(configure(e, self.discrete)) for e in rates]

    def _write(
        self,
        peeled: Peeling[float],
        row: _Linear,
        column: Mapping[int, int],
        factor: float,
        a: Matrix,
        b: Matrix,
    ) -> None:
        inputs = self._input_column(0)
        for k, c in peeled.reduce(row.bonds).items():
            if k >= inputs:
                b[k - inputs] += factor * c
            elif k >= 2 * self.bonds:
                a[k - 2 * self.bonds] += factor * c
            else:
                a[column[k]] += factor * c
        for k, c in row.states.items():
            a[k] += factor * c
        for k, c in row.inputs.items():
            b[k] += factor * c

    def _bond_name(self, k: int) -> str:
        bond = self.graph.bonds[k % self.bonds]
        return f'"{bond.name}".{"e" if k < self.bonds else "f"}'

    def _open(self, why: str) -> EquationError:
        return EquationError(
            why,
            code="HB-Q105",
            where=self.graph.mode_text(self.mode),
            hint="hybond analyse tells what is undetermined",
        )
