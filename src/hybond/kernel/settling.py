"""What entering and leaving a mode takes, as the kernel reads it (`c/settle.c`)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.causality.orientation import base_mode
from hybond.equations.leakage import null_space, undetermined
from hybond.equations.mode import ModeEquations
from hybond.equations.storage import gauss
from hybond.equations.surfaces import Surface
from hybond.kernel.bytecode import Book
from hybond.kernel.common import Common
from hybond.kernel.structs import Filled
from hybond.model.expressions import Binary, Expr, Number, names
from hybond.model.expressions.tree import prior_names
from hybond.model.graph import FlatGraph, Mode, Rule
from hybond.model.interval import Interval
from hybond.modes.jump import Ways, kicks_of
from hybond.modes.laws.complementarity import ADRIFT, Complementarity
from hybond.programs.program import Program
from hybond.solvers.lcp import positive_semidefinite

Matrix = NDArray[np.float64]


BLOCKS, CARRIES = 1, 2
"""What a diode does whose value nothing determines."""


@dataclass(frozen=True, slots=True)
class Shared:
    """What settling asks of every mode alike.

    Parameters
    ----------
    read : frozenset of int
        Slots that every mode must show: what some law or guard reads of the instant before.
    contacts : tuple of Expr
        What each impact law reads, at rest.
    surfaces : tuple of Surface
        Along which a motion may slide.
    drifting : frozenset of int
        Machines of diodes that, if they block, may share at will what an open loop holds.
    """

    read: frozenset[int] = frozenset()
    contacts: tuple[Expr, ...] = ()
    surfaces: tuple[Surface, ...] = ()
    drifting: frozenset[int] = frozenset()

    @staticmethod
    def of(program: Program, contacts: Sequence[Expr], surfaces: Sequence[Surface]) -> Shared:
        """Look through a graph; `contacts` are the approaches of its impact laws."""
        index = program.slots.index
        graph = program.graph
        found = {name for e in _laws(graph) for name in prior_names(e)}
        # a factor of an impulse must be what it was before
        found |= {name for e in _asked(graph) for name in names(e)}
        read = frozenset(index[name] for name in found)
        return Shared(read, tuple(contacts), tuple(surfaces))


def _laws(graph: FlatGraph) -> Iterable[Expr]:
    """All laws of a graph, which may read the instant before."""
    for node in graph.nodes:
        if node.law is not None:
            yield from node.law.expressions


def _asked(graph: FlatGraph) -> Iterable[Expr]:
    """All expressions that are asked at a jump."""
    for machine in graph.machines:
        yield from (rule.guard for rule in machine.rules)
    yield from (i.rate for i in graph.integrals)


def put_settling(
    mode: Filled,
    book: Book,
    common: Common,
    equations: ModeEquations,
    shared: Shared,
    ways: Ways | None,
) -> None:
    """Put in the rules that leave a mode, and the impulses of entering it."""
    program = common.program
    m, slots, graph = mode.structure, program.slots, program.graph
    rules = [
        (machine.index, rule)
        for machine in graph.machines
        if machine.law is None
        for rule in machine.rules
        if rule.source == equations.mode[machine.index]
    ]
    m.machines, m.rules = len(graph.machines), len(rules)
    mode.put("state", equations.mode)
    flags = program.flags(equations.mode)
    m.flag_count, m.flag_slot = len(flags), slots.on.start
    mode.put("flags", flags)
    mode.put("rule_machine", [k for k, _ in rules])
    mode.put("rule_target", [rule.target for _, rule in rules])
    mode.put("rule_code", [book.add(rule.guard) for _, rule in rules])
    mode.put("contact_code", [book.add(e) for e in shared.contacts])
    m.bonds, m.bond_slot = slots.w.stop - slots.w.start, slots.w.start
    kicks = np.zeros((m.bonds, 0)) if ways is None else kicks_of(equations, ways)
    mode.put_rows("kick", kicks)
    degree = equations.storage.degree
    points, weights = gauss(degree // 2 + 1) if degree is not None else ([], [])
    m.points = len(points)
    mode.put("point", points)
    mode.put("weight", weights)
    mode.put("guess", np.zeros(m.free))
    _put_ports(mode, book, common, equations, shared)
    m.fieldless = int(program.fieldless(equations.mode))
    m.enterable = int(_enterable(graph, equations, ways, [rule for _, rule in rules]))


def _put_ports(
    mode: Filled, book: Book, common: Common, equations: ModeEquations, shared: Shared
) -> None:
    """Put in what is followed with its rate.

    That is what must be positive for diodes to stay in their branches, then what is zero on
    switching surfaces.
    """
    graph, slots = common.program.graph, common.program.slots
    ports = [m for m in graph.machines if m.law is not None and equations.linear]
    laws = [m.law for m in ports if m.law is not None]
    on = [bool(m.on[equations.mode[m.index]]) for m in ports]
    wanted = [common.wanted(m, is_on) for m, is_on in zip(ports, on, strict=True)]
    freedom = np.abs(equations.freedom).max(axis=1, initial=0.0)
    adrift = [
        (CARRIES if is_on else BLOCKS)
        if any(freedom[slots.index[name] - slots.w.start] > 0.0 for name in common.follow(e).slopes)
        else 0
        for e, is_on in zip(wanted, on, strict=True)
    ]
    mode.structure.ports = len(ports)
    mode.put("port_machine", [m.index for m in ports])
    mode.put("port_turn", [1 - equations.mode[m.index] for m in ports])
    gates = [None if is_on else law.gate for law, is_on in zip(laws, on, strict=True)]
    mode.put("port_gate", [-1 if gate is None else book.add(gate) for gate in gates])
    mode.put("port_adrift", adrift)
    mode.put("port_drifts", [m.index in shared.drifting for m in ports])
    followed = [*wanted, *(surface.g for surface in shared.surfaces)]
    rows, pushes = _rates(common, equations, followed)
    mode.put("sense_code", [book.add(e) for e in followed])
    mode.put("sense_push", [-1 if push is None else book.add(push) for push in pushes])
    mode.put_rows("sense", rows)


def _rates(
    common: Common, equations: ModeEquations, followed: Sequence[Expr]
) -> tuple[Matrix, list[Expr | None]]:
    """Return the rates of expressions: rows of co-energy variables, and what is added to them.

    None where a rate is not known: it takes the rate of a source's rate, or the slope of a law.
    """
    slots, nx = common.program.slots, common.program.nx
    solved, sources = equations.shown if followed else equations.finite, equations.tableau.sources
    rows = np.zeros((len(followed), nx))
    pushes: list[Expr | None] = []
    for row, e in zip(rows, followed, strict=True):
        known = common.follow(e)
        slopes = known.slopes
        if slopes and not equations.linear:
            pushes.append(None)
            continue
        terms = np.zeros(solved.known.shape[1])
        for name, slope in slopes.items():
            c = slope.value if isinstance(slope, Number) else np.nan
            _, column, value = solved.known.rows(solved.row[[slots.index[name] - slots.w.start]])
            terms[column] += c * value
        unsure = np.isnan(terms).any() or terms[nx + len(sources) :].any()
        if unsure or terms[[k for k, _ in equations.storage.laws]].any():
            pushes.append(None)
            continue
        row[:] = terms[:nx]
        push = known.push
        for source, c in zip(sources, terms[nx : nx + len(sources)].tolist(), strict=True):
            if c != 0.0 and source.rate != Number(0.0):
                push = Binary("+", push, Binary("*", Number(c), source.rate))
        pushes.append(push)
    return rows, pushes


def _enterable(
    graph: FlatGraph, equations: ModeEquations, ways: Ways | None, rules: Sequence[Rule]
) -> bool:
    """Whether the kernel may enter a mode at an instant: nothing in it is left to be said."""
    if any(m.law is not None for m in graph.machines) and not equations.linear:
        return False
    declared = any(
        row.node >= 0 and graph.nodes[row.node].impulsive and not graph.nodes[row.node].implied
        for row in equations.rows
    )
    bonds = len(graph.bonds)
    free = {
        f"{'e' if k < bonds else 'f'}:{k % bonds}" for k in undetermined(equations.freedom).tolist()
    }
    asked = any(names(rule.guard) & free for rule in rules)
    settled = ways is None or ways.rank == len(equations.tableau.constraints)
    # what agrees at this instant only is no mode to stay in, and branches may not see that
    momentary = equations.tableau.agreements and any(m.law is not None for m in graph.machines)
    known = equations.storage.degree is not None
    return not momentary and settled and known and not declared and not asked


def simple(graph: FlatGraph) -> bool:
    """Whether junctions have no laws but those of diodes, whose branches the kernel may find."""
    return all(m.law is None or m.law.kind in ("diode", "thyristor") for m in graph.machines)


def drifting(
    laws: Complementarity, mode: Mode, interval: Interval, t: float
) -> frozenset[int] | None:
    """Return the diodes whose blocked values nothing may fix; None if branches may be ambiguous.

    They are not, where they are beyond doubt, if the problem is monotone: ``D + h C E`` is positive
    semi-definite for all steps below one for which it is, if `D` is. Two solutions of such a
    problem have ``w1 l2 + l1 w2 = 0`` (Cottle, Pang and Stone, *The Linear Complementarity
    Problem*, 1992, section 3.1): where in one of each pair exactly one is positive, the other has
    the same branches.
    """
    program = laws.program
    ports = program.ports(mode, interval, t)
    if not ports.linear:
        return None
    x, s = np.zeros(program.nx), np.zeros(program.ns)
    v = program.values(t, interval, base_mode(program.graph, mode), x, s)
    r = ports.response(v, x)
    h = laws.step(r, np.zeros(len(r.y)))
    if not (positive_semidefinite(r.D) and positive_semidefinite(r.D + h * r.CE)):
        return None
    # what a part of the ports does not see of each other, all of them do not
    loose = null_space(np.vstack([r.D + r.D.T, r.CE + r.CE.T]))
    moved = np.abs(loose).max(axis=1, initial=0.0) > ADRIFT
    return frozenset(
        p.machine for p, k in zip(ports.ports, moved, strict=True) if k and p.given == "net"
    )
