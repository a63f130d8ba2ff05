"""Writing down a step of time-stepping: branches that changed, impacts, percussions, energy."""

from __future__ import annotations

import numpy as np

from hybond.modes.stepping.moreau import Advance, Point
from hybond.programs.program import Program
from hybond.trace import Energy, Event, Fired, Step

GUARD = "complementarity over the step"


def event_of_step(program: Program, before: Point, advance: Advance) -> Event | None:
    """Return the event of a step, None if no law changed its branch or was struck.

    Percussions are given where what was stored violated a law: they are those of the whole step,
    impulses and the little that forces do in it. The energy lost includes what was dissipated.
    """
    end, laws = advance.end, advance.laws
    bounced = [
        m
        for m, struck, eps in zip(laws.machines, advance.struck, laws.restitution, strict=True)
        if struck and eps > 0.0
    ]
    if end.mode == before.mode and not bounced:
        return None
    nx, ns = program.nx, program.ns
    storage = advance.ports.equations.storage
    stored = storage.energy(before.y[:nx]), storage.energy(end.y[:nx])
    lost = stored[0] + advance.supplied - stored[1]
    energy = Energy(stored[0], stored[1], advance.supplied, lost)
    h = end.t - before.t
    impulses: dict[str, float] = {}
    values: dict[int, dict[str, float]] = {}
    for port, l, w in zip(
        advance.ports.ports,
        advance.answer.l.tolist(),
        (advance.ports.partner @ end.w).tolist(),
        strict=True,
    ):
        shared, other = ("e", "f") if program.graph.nodes[port.law.node].kind == "0" else ("f", "e")
        common, net = (l, -w) if port.given == "common" else (w, -l)
        values[port.machine] = {f"{port.path}.{shared}": common, f"{port.path}.{other}": net}
        if advance.struck.any() and l != 0.0:
            own = (shared, h * l) if port.given == "common" else (other, -h * l)
            impulses[f"{port.path}.{own[0]}"] = own[1]
    steps: list[Step] = []
    mode = before.mode
    if bounced:
        through = list(end.mode)
        for m in bounced:
            through[m.index] = m.states.index("impact")
        fired = _fired(program, mode, tuple(through), values)
        steps.append(Step(tuple(through), "pinnacle", fired, impulses, energy))
        mode = tuple(through)
        impulses, energy = {}, Energy(stored[1], stored[1], 0.0, 0.0)
    fired = _fired(program, mode, end.mode, values)
    steps.append(Step(end.mode, "continuous", fired, impulses, energy))
    return Event(
        float(end.t),
        "step",
        tuple(steps),
        np.array(before.y[: nx + ns]),
        np.array(end.y[: nx + ns]),
        t0=float(before.t),
    )


def _fired(
    program: Program,
    source: tuple[int, ...],
    target: tuple[int, ...],
    values: dict[int, dict[str, float]],
) -> tuple[Fired, ...]:
    return tuple(
        Fired(m.path, m.states[a], m.states[b], GUARD, values.get(m.index, {}), {})
        for m, a, b in zip(program.graph.machines, source, target, strict=True)
        if a != b
    )
