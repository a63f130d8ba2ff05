"""What is constant between two timed events and selects equations there."""

from __future__ import annotations

from hybond.model.expressions import names
from hybond.model.graph import FlatGraph
from hybond.model.inputs import Constant, Pwm, Timetable
from hybond.model.kinds import RESISTORS, TWO_PORTS


def discrete_names(graph: FlatGraph) -> tuple[str, ...]:
    """Return the names of such inputs and comparisons of time that enter moduli or resistor laws.

    They select a configuration: with them constant, so are those rows.
    """
    held = {
        f"u:{i.index}"
        for i in graph.inputs
        if isinstance(i.waveform, Constant | Pwm)
        or (isinstance(i.waveform, Timetable) and not i.waveform.linear)
    }
    found: set[str] = set()
    for node in graph.nodes:
        if node.law is not None and node.kind in TWO_PORTS + RESISTORS:
            for e in node.law.expressions:
                found |= {n for n in names(e) if n in held or n.startswith("at:")}
    return tuple(sorted(found))
