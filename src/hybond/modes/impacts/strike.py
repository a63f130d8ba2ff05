"""Impacts in a graph by a named law: what `laws` decides, put into bonds and storage.

Newton's law contact after contact needs none of this: it is a branch of the contact's own law
(`complementarity`). The other laws look at all closed contacts of an instant together.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.errors import NumericsError
from hybond.model.graph import Mode
from hybond.modes.impacts.laws import impact
from hybond.modes.jump import Jump, enter
from hybond.modes.laws.complementarity import Complementarity, Instant

Vector = NDArray[np.float64]

REACHED = 1e-6
"""Part of the velocities by which storage that is not linear may miss what the law asks for."""


def strike(
    laws: Complementarity, law: str, exponent: float, at: Instant, x: Vector, *, energy: float
) -> tuple[Jump, Mode] | None:
    """Return the jump of an impact at all closed contacts and the mode that carries it.

    None if no contact with restitution approaches.

    Raises
    ------
    HybondError
        Those of `laws.impact`; HB-J206 if storage does not follow the law.
    """
    ports, v, start = laws.consistent(at, x, energy)
    response = ports.response(v, start)
    y = laws.clean(response, ports, start, energy)
    bounces = np.array([p.law.restitution is not None for p in ports.ports])
    able = laws.able(ports, v, at)
    if not (bounces & able & (y < 0.0)).any():
        return None
    touching = np.array([p.law.gap is not None for p in ports.ports])
    closed = able & (touching | (y <= 0.0))
    closed &= np.array([not p.law.two_sided for p in ports.ports])
    closed &= (np.diag(response.D) == 0.0) & (np.diag(response.CE) > 0.0)
    who = np.flatnonzero(closed)
    chosen = [ports.ports[k] for k in who]

    def of(name: str, default: float) -> Vector:
        given = [getattr(p.law, name) for p in chosen]
        return np.array([default if e is None else float(laws.value(e, v)) for e in given])

    w = response.CE[np.ix_(who, who)]
    found = impact(
        0.5 * (w + w.T),
        y[who],
        eps=of("restitution", 0.0),
        law=law,
        stiffness=of("stiffness", 1.0),
        exponent=exponent,
        names=[p.path for p in chosen],
    )
    nu = np.zeros(len(ports.ports))
    nu[who] = found.impulses
    landed = start + response.E @ nu
    values = list(v)
    values[laws.program.slots.x] = landed.tolist()
    reached = ports.partner @ ports.solve(values, landed, np.zeros(len(nu)))
    missed = np.abs(reached[who] - found.after).max(initial=0.0)
    if missed > REACHED * np.abs(y[who]).max():
        raise NumericsError(
            f"after the impact at t = {at.t:.9g} s the contacts move {missed:.3g} off what the law "
            f"{law!r} says",
            code="HB-J206",
            where=laws.graph.mode_text(at.mode),
            hint="an impact law takes masses as constant: give them linear laws",
        )
    first = enter(ports.equations, list(v), x, where=laws.graph.mode_text(at.mode), energy=energy)
    struck = list(at.mode)
    for k, port in enumerate(ports.ports):
        states = laws.graph.machines[port.machine].states
        if nu[k] > 0.0:
            struck[port.machine] = states.index("impact") if "impact" in states else 1
        elif closed[k]:
            struck[port.machine] = 0
    jump = Jump(landed, first.impulses + response.gain @ nu, first.undetermined, happened=True)
    return jump, tuple(struck)
