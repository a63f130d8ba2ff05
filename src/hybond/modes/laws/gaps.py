"""Whether the gap of a contact is the distance that its bonds close.

The law of a contact acts on velocities, its gap is a signal that the modeller wrote. If the gap
does not open at the speed at which the bonds separate, the contact closes at the wrong place, or
never.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.equations.calculus import partial_time
from hybond.equations.ports import PortEquations
from hybond.errors import ModelError
from hybond.model.expressions import names
from hybond.programs.program import Program

Vector = NDArray[np.float64]

PROBES = 3
"""Fixed pseudo-random velocities at which the two speeds are compared."""
APART = 1e-6
"""Part of the larger of them by which they may differ."""


def check_gaps(program: Program, ports: PortEquations, v: list[float], x: Vector) -> None:
    """Refuse a gap that does not change as fast as the bonds of its contact say.

    Raises
    ------
    ModelError
        HB-M205 with both speeds.
    """
    # a constant gap says that the sides touch at all times, or never
    contacts = [p for p in ports.ports if p.law.gap is not None and names(p.law.gap)]
    if not contacts:
        return
    graph = program.graph
    momenta = np.array([s.kind == "I" for s in graph.storages], dtype=bool)
    generator = np.random.default_rng(1)
    for _ in range(PROBES):
        probe = list(v)
        size = np.maximum(np.abs(x), 1.0)
        moved = x + momenta * size * generator.uniform(-1.0, 1.0, len(x))
        probe[program.slots.x] = moved.tolist()
        ports.solve(probe, moved, generator.uniform(-1.0, 1.0, len(ports.ports)))
        for port in contacts:
            assert port.law.gap is not None
            opening = float(program.compile(partial_time(port.law.gap, graph))(probe))
            closing = float(program.compile(port.law.net)(probe))
            if not np.isfinite([opening, closing]).all():
                continue
            if abs(opening + closing) > APART * max(abs(opening), abs(closing)):
                net = "f" if graph.nodes[port.law.node].kind == "0" else "e"
                raise ModelError(
                    f"the gap of {port.path!r} is not the distance that its bonds close: where "
                    f"-{port.path}.{net} = {-closing:.6g} the gap changes by {opening:.6g} per "
                    "second",
                    code="HB-M205",
                    where=f"elements.{port.path}.gap",
                    hint=f"the gap must grow at the rate -{port.path}.{net}: look at its sign, at "
                    "the arrows of the bonds, and at what else moves",
                )
