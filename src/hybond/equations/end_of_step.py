"""Which variable of a junction law is the unknown of a time step: its current, its contact force.

`ports` gives the variable of a law's pair that leaves the most storage integral, whichever it is
where both would do. A time step averages what the graph does with ``l = 0`` and takes all that
`l` brings from its end, so there the choice makes a difference, of the order of the step. Here it
is the common variable wherever that costs nothing: then ``l = 0`` is the graph with its diodes
blocking and its contacts open, as in the published schemes.
"""

from __future__ import annotations

from collections.abc import Mapping

from hybond.causality.orientation import Given, base_mode
from hybond.equations.ports import PortEquations, port_equations
from hybond.equations.slots import Slots
from hybond.equations.tableau import Sheet, Tableau
from hybond.model.graph import FlatGraph, Mode


def end_of_step_ports(
    graph: FlatGraph, mode: Mode, slots: Slots, discrete: Mapping[str, float]
) -> PortEquations:
    """Return the equations of a configuration with its junction laws open, for time-stepping.

    Raises
    ------
    CausalityError
        HB-C104, see `ports.port_equations`.
    """
    mode = base_mode(graph, mode)
    sheet = Sheet(graph)
    found = port_equations(graph, mode, slots, discrete, sheet=sheet)
    given: dict[int, Given] = {p.law.node: p.given for p in found.ports}
    least = _cost(sheet.build(mode, discrete, given))
    changed = False
    for port in found.ports:
        if port.law.two_sided or port.given == "common":
            continue
        trial: dict[int, Given] = {**given, port.law.node: "common"}
        tableau = sheet.build(mode, discrete, trial)
        if not _tied(tableau, len(trial)) and _cost(tableau) <= least:
            given, changed = trial, True
    return port_equations(graph, mode, slots, discrete, given, sheet=sheet) if changed else found


def _cost(tableau: Tableau) -> tuple[int, int]:
    """Return how many constraints there are, and how many variables are left open."""
    return len(tableau.constraints) + len(tableau.agreements), len(tableau.finite.free())


def _tied(tableau: Tableau, ports: int) -> bool:
    """Whether a constraint prescribes what the laws should decide."""
    last = tableau.unknowns + tableau.storages + len(tableau.sources)
    own = set(range(last - ports, last))
    return any(own & row.keys() for row in (*tableau.constraints, *tableau.agreements))
