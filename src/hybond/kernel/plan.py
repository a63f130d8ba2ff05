"""A mode as the kernel reads it, made from the same equations as the reference."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hybond.equations.elimination import Row
from hybond.equations.mode import ModeEquations
from hybond.equations.tableau import Tableau
from hybond.kernel.bytecode import Book, Declined
from hybond.kernel.common import Common
from hybond.kernel.flow import put_flow
from hybond.kernel.settling import Shared, put_settling
from hybond.kernel.structs import Filled, Mode
from hybond.model.expressions import Expr, Number
from hybond.model.inputs import Constant, Pwm, Timetable
from hybond.modes.jump import Ways, impulse_directions, reach_of, reach_of_bonds, ways_of
from hybond.modes.locate import Watched
from hybond.programs.combined import Combined
from hybond.programs.linear import LinearForm
from hybond.programs.program import Program

Matrix = NDArray[np.float64]
LOOKS = 50.0
"""Evaluations of a step, those of its guards included, about."""
LARGEST = 400
"""States of an implicit step at the most: its matrices are dense."""
FACTORS, SOLVES = 3.3, 80.0
"""Operations of an implicit step: of its factors, and of the systems solved with them."""


def plan(
    program: Program,
    equations: ModeEquations,
    watched: Watched,
    outputs: Sequence[Expr],
    shared: Shared,
    common: Common,
    *,
    lawful: bool,
    implicit: bool,
    form: LinearForm | None = None,
) -> Filled:
    """Return a mode with the guards that may leave it.

    `outputs` are expressions whose values are wanted at the end of each step; `shared` is what
    settling asks of all modes; `lawful` says whether junctions have laws, which count rounding of
    what is stored as zero; `implicit`, whether steps solve systems of the size of the state; `form`
    is its motion as a matrix, if it is to be propagated by that.

    Raises
    ------
    Declined
        For what the kernel was not made for.
    """
    _check(program, equations, lawful=lawful)
    if implicit and program.nx + program.ns > LARGEST:
        raise Declined(f"an implicit step of more than {LARGEST} states")
    if not watched.rounded:
        raise Declined("guards that are asked without rounding")
    mode = Filled(Mode())
    book = common.book.copy()
    _layout(mode, program)
    _storage(mode, book, equations)
    _knowns(mode, book, equations)
    _dynamic(mode, book, equations)
    _guards(mode, book, common, watched)
    _put_codes(mode, book, "signal_code", [i.rate for i in program.graph.integrals])
    _put_codes(mode, book, "output_code", outputs, count="outputs")
    ways = _constraints(mode, equations)
    put_settling(mode, book, common, equations, shared, ways)
    put_flow(mode, book, form, program.nx + program.ns + 2)
    book.read |= shared.read
    _rows(mode, book, program, equations, lawful=lawful)
    code, constants = book.arrays()
    mode.put("code", code)
    mode.put("constants", constants)
    mode.structure.cost = _cost(mode, implicit=implicit)
    mode.check()
    return mode


def _check(program: Program, equations: ModeEquations, *, lawful: bool) -> None:
    tableau = equations.tableau
    if isinstance(equations, Combined):
        raise Declined("motion along a surface")
    straight = equations.linear and equations.storage.linear
    if tableau.constraints and not straight:
        raise Declined("dependent storage in a nonlinear mode")
    if tableau.agreements and equations.rows:
        raise Declined("sources that must agree in a nonlinear mode")
    if equations.rank != len(equations.structure):
        raise Declined("a modulated structure that hides constraints")
    if equations.project is not None and not equations.linear:
        raise Declined("bond variables that are not determined in a nonlinear mode")
    if equations.rows and len(equations.rows) != equations.n2.shape[1]:
        raise Declined("laws that do not determine what they should")
    if lawful and not equations.storage.linear:
        raise Declined("junction laws beside nonlinear storage")
    kinds = (Constant, Pwm, Timetable)
    if not all(isinstance(i.waveform, kinds) for i in program.graph.inputs):
        raise Declined("an input that is a function in Python")


def _layout(mode: Filled, program: Program) -> None:
    m, slots = mode.structure, program.slots
    m.slots = slots.size
    m.storages, m.signals, m.inputs = program.nx, program.ns, len(program.graph.inputs)
    m.stored_slot, m.signal_slot = slots.x.start, slots.s.start
    m.input_slot, m.input_rate_slot = slots.u.start, slots.du.start


def _storage(mode: Filled, book: Book, equations: ModeEquations) -> None:
    laws = equations.storage
    mode.put_sparse("co_energy", *laws.matrix.rows(range(laws.matrix.shape[0])))
    at = [k for k, _, _ in laws.expressions]
    mode.put("law_at", at)
    mode.put("slope_at", at)
    _put_codes(mode, book, "law_code", [law for _, law, _ in laws.expressions], count="laws")
    _put_codes(mode, book, "slope_code", [d for _, _, d in laws.expressions], count="slopes")
    mode.put("stiffness", laws.matrix.diagonal())


def _knowns(mode: Filled, book: Book, equations: ModeEquations) -> None:
    sources = equations.tableau.sources
    nx, nu = len(equations.graph.storages), len(sources)
    known = np.zeros(nx + 2 * nu)
    known[nx : nx + nu] = equations.source_constants
    mode.structure.knowns = len(known)
    mode.put("known", known)
    values = [(nx + k, sources[k].value) for k, _ in equations.source_values]
    values += [(nx + nu + k, sources[k].rate) for k, _ in equations.rate_values]
    mode.put("source_at", [k for k, _ in values])
    _put_codes(mode, book, "source_code", [e for _, e in values], count="sources")


def _dynamic(mode: Filled, book: Book, equations: ModeEquations) -> None:
    """Put in the rows that Newton solves, and their slopes by the free unknowns."""
    m, slots = mode.structure, equations.slots
    # without laws to solve the free unknowns are those that least leakage sets
    n2 = equations.n2 if equations.rows else equations.n2[:, :0]
    m.free, m.affine = n2.shape[1], int(equations.affine)
    _put_codes(mode, book, "value_code", [d.expression for d in equations.rows], count="values")
    mode.put("slope", equations.slopes.constant @ n2)
    at: list[int] = []
    slopes: list[Expr] = []
    by_free: list[Matrix] = []
    for i, row in enumerate(equations.rows):
        for name, e in row.slopes.items():
            if not isinstance(e, Number):
                at.append(i)
                slopes.append(e)
                by_free.append(n2[slots.index[name] - slots.w.start])
    mode.put("entry_at", at)
    _put_codes(mode, book, "entry_code", slopes, count="entries")
    mode.put("entry_by_free", np.array(by_free).reshape(len(by_free), n2.shape[1]))


def _guards(mode: Filled, book: Book, common: Common, watched: Watched) -> None:
    guards = [common.guard(g.rule) for g in watched.guards]
    _put_codes(mode, book, "guard_test", [g.test for g in guards], count="guards")
    _put_codes(mode, book, "atom_code", [a for g in guards for a in g.atoms])
    _put_codes(mode, book, "size_code", [a for g in guards for a in g.sizes])
    mode.put("guard_atoms", np.cumsum([0, *(len(g.atoms) for g in guards)]))


def _rows(
    mode: Filled, book: Book, program: Program, equations: ModeEquations, *, lawful: bool
) -> None:
    """Put in the rows of bond variables that something reads: expressions, rates, powers."""
    m, w = mode.structure, program.slots.w
    meter, storage, solved = program.meter, equations.storage, equations.finite
    read = sorted(k - w.start for k in book.read if w.start <= k < w.stop)
    rates = storage.bond
    bonds = np.concatenate([read, rates, *meter.supplied[:2], *meter.dissipated[:2]])
    bonds = bonds.astype(np.intp)
    shown = equations.shown
    # equal bond variables share a row; one of them stands for it
    shared, known = shown.row, shown.known
    own, some = np.unique(shared[bonds], return_index=True)
    place = np.zeros(known.shape[0], dtype=np.intp)
    place[own] = np.arange(len(own))

    def row_of(k: NDArray[np.intp]) -> NDArray[np.intp]:
        return np.asarray(place[shared[np.asarray(k, dtype=np.intp)]])

    m.rows = len(own)
    solid = equations.project is None
    mode.put_sparse("solved", *known.rows(own))
    mode.put("by_free", solved.free[bonds[some]][:, : m.free])
    # rounding is that of the terms before least leakage shares them out
    loose = equations.tableau.finite.free() if equations.project is not None else []
    m.loose = len(loose)
    mode.put_sparse("measured", *solved.known.rows(own if solid else solved.row[own]))
    mode.put_sparse("shares", *known.rows(shared[loose]))
    mode.put("by_share", solved.free[bonds[some]][:, : m.loose])
    weighed = ~equations.storage.pseudo if lawful else np.zeros(program.nx)
    mode.put("weighed", weighed)
    seen = np.zeros(w.stop - w.start)
    if lawful:
        seen = reach_of_bonds(equations, np.zeros(program.nx), 1.0)
    mode.put("seen", seen[bonds[some]])
    m.spread = len(read)
    mode.put("spread_row", row_of(np.array(read)))
    mode.put("spread_slot", [w.start + k for k in read])
    place_of = np.full(program.slots.size, -1)
    place_of[[w.start + k for k in read]] = mode.arrays["spread_row"]
    mode.put("row_of", place_of)
    mode.put("rate_row", row_of(rates))
    mode.put("rate_sign", storage.sign)
    m.supplied, m.dissipated = len(meter.supplied[2]), len(meter.dissipated[2])
    for name, (e, f, sign) in (("supplied", meter.supplied), ("dissipated", meter.dissipated)):
        mode.put(f"{name}_e", row_of(e))
        mode.put(f"{name}_f", row_of(f))
        mode.put(f"{name}_sign", sign)


def _constraints(mode: Filled, equations: ModeEquations) -> Ways | None:
    """Put in what is stored dependently, and how a state is put back (see `modes.jump`)."""
    tableau, storage = equations.tableau, equations.storage
    nx = len(equations.graph.storages)
    rows = _of_knowns(tableau, tableau.constraints)
    back = np.zeros((nx, 0))
    ways: Ways | None = None
    if len(rows):
        directions = impulse_directions(equations, [])
        ways = ways_of(storage, directions, lambda d: rows[:, :nx] @ storage.matrix.times(d))
        assert ways.inverse is not None
        back = ways.d @ ways.inverse
    mode.structure.constraints, mode.structure.agreements = len(rows), len(tableau.agreements)
    mode.put_rows("constraint", rows)
    mode.put_rows("agreement", _of_knowns(tableau, tableau.agreements))
    mode.put("put_back", back)
    reach = reach_of(storage, np.zeros(nx), 1.0) if storage.linear else np.zeros(nx)
    known = np.zeros(tableau.knowns)
    known[:nx] = reach * np.abs(storage.matrix.diagonal())
    mode.put("stored_reach", reach)
    mode.put("known_reach", known)
    return ways


def _cost(mode: Filled, *, implicit: bool) -> float:
    """Return about how many operations a step takes: its evaluations, and those for its guards.

    An implicit step may need a Jacobian, by an evaluation for each state, and factors of a real
    and a complex matrix of their number.
    """
    m, arrays = mode.structure, mode.arrays
    once = len(arrays["solved.value"]) + len(arrays["code"]) + m.free**3 + m.rows * m.free
    states = m.storages + m.signals if implicit else 0
    return float(1.0 + (LOOKS + states) * once + FACTORS * states**3 + SOLVES * states**2)


def _of_knowns(tableau: Tableau, given: Sequence[Row]) -> Matrix:
    rows = np.zeros((len(given), tableau.knowns))
    for row, terms in zip(rows, given, strict=True):
        for k, c in terms.items():
            row[k - tableau.unknowns] = c
    return rows


def _put_codes(
    mode: Filled, book: Book, name: str, expressions: Sequence[Expr], *, count: str = ""
) -> None:
    mode.put(name, [book.add(e) for e in expressions])
    if count:
        setattr(mode.structure, count, len(expressions))
