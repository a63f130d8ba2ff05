"""The contact phase by direct simulation of the model's own graph, until the contact ends.

The graph stays as it is; only its machines are held in the mode of contact, its storages start
from the approach (bodies at the impact speed, springs free), and one rule says when contact ends.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.restitution.branches import Branch, structure
from hybond.analysis.restitution.contact import Contact
from hybond.analysis.restitution.half_period import Ends, Phase
from hybond.analysis.structure.mode_matrices import ModeMatrices
from hybond.engine.outcome.apart import Apart
from hybond.engine.outcome.signals import Signals
from hybond.equations.calculus import rate_name
from hybond.equations.descriptor import Descriptor
from hybond.errors import EquationError, HybondError, NumericsError
from hybond.model.expressions import Binary, Compare, Expr, Name, Neg, Number, comparisons
from hybond.model.graph import FlatGraph, Integral, Machine, Mode, Rule, Storage
from hybond.model.laws import Law
from hybond.simulation import simulate

Vector = NDArray[np.float64]

RTOL, STIFF_RTOL = 1e-10, 1e-11
"""Relative tolerances of the simulated contact phase."""
STIFF = 1e3
"""Ratio of the fastest to the slowest rate above which an implicit method is used."""
AT_REST = 1e-9
"""Part of the impact speed below which a compression that has not ended has come to rest."""
REVERSALS = 20
"""Reversals of the compression after which a contact that has not ended is taken not to end."""
GROWTH, STIFF_GROWTH = 4.0, 64.0
"""How much longer each attempt lasts; that of a stiff mode costs little more than the last."""
SPENT = 1e-9
"""Part of the greatest compression that counts as none where a law ends."""
LONGEST = 60


def simulated_phase(
    graph: FlatGraph,
    contact: Contact,
    *,
    ends: Ends,
    speed: float,
    loads: bool,
    sign: int = 1,
    solver: str | None = None,
) -> Phase:
    """Return restitution and duration of the contact phase, found by simulation.

    Parameters
    ----------
    ends : {"release", "zero compression"}
    speed : float
        Speed of approach, SI.
    loads : bool
        Whether sources act; else their values are zero.
    sign : {1, -1}
        Sign of the junction's effort in contact; see `compressive_sign`.
    solver : str, optional
        Chosen by the stiffness of the mode if it is linear, else ``"rk45"``.

    Raises
    ------
    NumericsError
        HB-A208 if the phase neither ends nor comes to rest; what a law refuses.
    """
    closing = closing_rate(contact, sign)
    held = _held(graph, contact, loads=loads, ends=ends, sign=sign, closing=closing, speed=speed)
    fast, slow = rates_of(held)
    stiff = slow > 0.0 and fast / slow > STIFF
    chosen = solver or ("radau" if stiff else "rk45")
    growth = STIFF_GROWTH if stiff else GROWTH
    rtol = STIFF_RTOL if stiff else RTOL
    held_compression = len(held.storages) + len(held.integrals) - 1
    # a lightly damped half period lasts pi/rate
    until = 4.0 / fast if fast else 1e-9
    for _ in range(LONGEST):
        run = simulate(held, until, solver=chosen, rtol=rtol, on_error="return")
        signals = run.signals

        def value_at(t: float, y: Vector, mode: Mode, *, signals: Signals = signals) -> float:
            return signals.after(t, y, mode, [closing])[0]

        for event in run.events[1:]:
            if any(f.target == _ENDED for step in event.steps for f in step.fired):
                value = -value_at(event.t, event.before, contact.mode) / speed
                # below that only rounding moves
                return Phase(value, float(event.t)) if value > AT_REST else Phase(0.0, math.inf)
        last = run.segments[-1]
        compression = np.concatenate([seg.y[:, held_compression] for seg in run.segments])
        now = value_at(float(last.t[-1]), last.y[-1], last.mode)
        if run.error is not None:
            # a spring's law may end at zero compression, and the motion with it
            if now < 0.0 and compression[-1] <= SPENT * compression.max():
                return Phase(-now / speed, float(last.t[-1]))
            raise run.error
        tail = max(abs(now), abs(value_at(0.5 * until, last.at(0.5 * until), last.mode)))
        moves = np.diff(compression)
        turns = int(np.count_nonzero(moves[:-1] * moves[1:] < 0.0))
        if tail < AT_REST * speed or turns >= REVERSALS:
            return Phase(0.0, math.inf)
        until *= growth
    raise NumericsError(
        f"the contact at {contact.junction!r} neither ends nor comes to rest within {until:g} s",
        code="HB-A208",
        where=contact.junction,
        hint="look at the contact's laws: does the force return to zero?",
    )


_ENDED = "contact ended"


def closing_rate(contact: Contact, sign: int) -> Expr:
    """Return the rate of compression, in canonical names."""
    whole: Expr | None = None
    for branch, gain in contact.behind:
        term: Expr = Name(f"f:{branch.bond}")
        scale = sign * branch.sign * gain
        if abs(scale) != 1.0:
            term = Binary("*", Number(abs(scale)), term)
        if whole is None:
            whole = term if scale > 0 else Neg(term)
        else:
            whole = Binary("+" if scale > 0 else "-", whole, term)
    assert whole is not None
    return whole


def junction_effort(graph: FlatGraph, contact: Contact, sign: int) -> Expr:
    """Return the contact force, positive when it pushes, in canonical names."""
    effort = Name(f"e:{graph.nodes[contact.node].ends[0].bond}")
    return effort if sign > 0 else Neg(effort)


def compressive_sign(graph: FlatGraph, contact: Contact) -> int:
    """Return the sign that the junction's effort has in contact, 0 if the rules do not tell.

    The comparisons in the rules of the machine vote: one that enters the contact must hold on
    approach and not on separation, one that leaves it must not hold while springs are loaded.
    """
    machine = next(m for m in graph.machines if m.path == contact.machine)
    state = machine.states.index(contact.state)
    votes = 0
    for rule in machine.rules:
        enters, leaves = rule.target == state, rule.source == state
        if enters == leaves:
            continue
        for compare in comparisons(rule.guard):
            votes += _vote(graph, contact, rule, compare, enters=enters, machine=machine.index)
    return (votes > 0) - (votes < 0)


def directional(graph: FlatGraph, contact: Contact, rule: Rule) -> bool:
    """Whether a rule that makes contact asks for the direction of motion."""
    machine = next(m for m in graph.machines if m.path == contact.machine)
    return any(
        _vote(graph, contact, rule, c, enters=True, machine=machine.index)
        for c in comparisons(rule.guard)
    )


def _vote(
    graph: FlatGraph, contact: Contact, rule: Rule, compare: Compare, *, enters: bool, machine: int
) -> int:
    holds = {}
    for sign in (1, -1):
        mode = list(contact.mode)
        mode[machine] = rule.source
        started = replace(
            graph,
            storages=_approach(graph, contact, sign, loads=True),
            machines=_parked(graph, tuple(mode)),
        )
        try:
            at = Apart(started)
            y = at.start
            if not enters:
                moves = [*map(rate_name, graph.storages), *(i.rate for i in graph.integrals)]
                y = y + 1e-9 * np.array(at.signals.after(0.0, y, tuple(mode), moves))
            holds[sign] = bool(at.signals.after(0.0, y, tuple(mode), [compare])[0])
        except HybondError:
            # a law that has no value under tension: this is not the side that pushes
            return 0 if enters else -sign
    return (holds[1] - holds[-1]) * (1 if enters else -1)


def is_linear(graph: FlatGraph, mode: Mode) -> bool:
    """Whether motion in `mode` is linear in stored quantities and sources."""
    return _matrices(graph, mode) is not None


def rates_of(graph: FlatGraph) -> tuple[float, float]:
    """Return the fastest and the slowest rate of the start mode, 1/s; zeros if not linear."""
    found = _matrices(graph, graph.start_mode)
    sizes = np.abs(found.poles()) if found is not None else np.zeros(0)
    moving = sizes[sizes > 1e-9 * sizes.max(initial=0.0)]
    return (float(moving.max()), float(moving.min())) if len(moving) else (0.0, 0.0)


def _matrices(graph: FlatGraph, mode: Mode) -> Descriptor | None:
    """Return the equations of a mode as matrices, None if it is not linear."""
    try:
        return ModeMatrices(graph, ()).at(mode, ())
    except (EquationError, NumericsError):
        return None


# -- the graph held in contact


def _held(
    graph: FlatGraph,
    contact: Contact,
    *,
    loads: bool,
    ends: Ends,
    sign: int,
    closing: Expr,
    speed: float,
) -> FlatGraph:
    compression = Integral(len(graph.integrals), "compression", closing, 0.0)
    measure = (
        junction_effort(graph, contact, sign)
        if ends == "release"
        else Name(f"s:{compression.index}")
    )
    guard = Compare("<", measure, Number(0.0))
    machines = list(_parked(graph, contact.mode))
    at = next(m.index for m in machines if m.path == contact.machine)
    own = machines[at]
    machines[at] = replace(
        own,
        states=(*own.states, _ENDED),
        on=(*own.on, own.on[own.start]),
        fieldless=(*own.fieldless, False) if own.fieldless else (),
        rules=(Rule(own.start, len(own.states), guard, ends),),
    )
    nodes = graph.nodes
    if not loads:
        nothing = Number(0.0)
        nodes = tuple(
            replace(n, law=Law("e" if n.kind == "Se" else "f", (nothing,), ((0.0,),)))
            if n.kind in ("Se", "Sf")
            else n
            for n in nodes
        )
    return replace(
        graph,
        nodes=nodes,
        machines=tuple(machines),
        storages=_approach(graph, contact, sign * speed, loads=loads),
        integrals=(*graph.integrals, compression),
        dimensions={**graph.dimensions, f"s:{compression.index}": None},
        experiment={},
    )


def _wall(branch: Branch) -> float:
    """Return the flow of a wall into the contact."""
    law = branch.node.law
    if branch.kind == "Sf" and (branch.node.is_junction or (law is not None and law.matrix)):
        return branch.sign * (law.matrix[0][0] if law is not None and law.matrix else 0.0)
    raise structure(branch.node, f"the speed of {branch.node.path!r} at impact is not constant")


def _parked(graph: FlatGraph, mode: Mode) -> tuple[Machine, ...]:
    """Return the machines, started in `mode` and without rules."""
    return tuple(replace(m, start=k, rules=()) for m, k in zip(graph.machines, mode, strict=True))


def _approach(
    graph: FlatGraph, contact: Contact, closing: float, *, loads: bool
) -> tuple[Storage, ...]:
    """Return storages that start with this rate of compression, walls included if they move."""
    if loads:
        closing += sum(gain * _wall(b) for b, gain in contact.walls)
    flows = contact.approach(graph, closing)
    return tuple(
        replace(s, start=flows.get(s.node, 0.0), start_is="co-energy")
        if s.node in flows
        else replace(s, start=0.0, start_is="stored")
        for s in graph.storages
    )
