"""Which variable of each law's pair is given, so that no constraint holds it fast.

`causality.orientation` counts variables. Around a loop without a reference potential they depend
on one another by value: there a law may be tied to a constraint on what is stored or on sources,
and giving the other variable of its pair unties it.
"""

from __future__ import annotations

from collections.abc import Mapping

from hybond.analysis.complementarity.ports import Port
from hybond.analysis.complementarity.rows import Renumbered, reference_of
from hybond.causality.orientation import Given, orientation
from hybond.equations.element_rows import Assembly
from hybond.equations.ring import Numbers, Row
from hybond.errors import CausalityError
from hybond.model.graph import FlatGraph, Mode


def law_machines(graph: FlatGraph) -> tuple[int, ...]:
    """Return the machines that stand for laws of junctions."""
    return tuple(m.index for m in graph.machines if m.law is not None)


def open_ports(
    graph: FlatGraph, mode: Mode, bent: frozenset[int], known: Mapping[str, float]
) -> tuple[tuple[Port, ...], list[Row[float]]]:
    """Return the junctions whose laws are left open in a mode of the other machines.

    Beside them: constraints on co-energy variables that hold in all branches, by storage.

    Parameters
    ----------
    mode : tuple of int
        With all laws in their first branch.
    bent : frozenset of int
        The elements that are not linear: what they say is no constraint.
    known : mapping
        The value of each canonical name that a coefficient may read.

    Raises
    ------
    CausalityError
        HB-C104 if a law stays tied to a constraint, whichever of its variables is given.
    """
    owners = {law.node: (m, law) for m in graph.machines if m.law for law in m.law.junctions}
    given = orientation(graph, mode)
    seen: set[tuple[Given, ...]] = set()
    while True:
        ports = tuple(
            Port(owners[n][0].index, owners[n][1], g, graph.nodes[n].path) for n, g in given.items()
        )
        tied, constraints = _tied(graph, mode, ports, bent, known)
        if not tied:
            return ports, constraints
        seen.add(tuple(given.values()))
        given = {n: _other(g) if n in tied else g for n, g in given.items()}
        if tuple(given.values()) in seen:
            raise CausalityError(
                f"the law of {graph.nodes[tied[0]].path} is tied to a constraint that holds in "
                "every mode",
                code="HB-C104",
                where=graph.mode_text(mode),
                hint="two sources or switches leave nothing for the law to decide: look at what "
                "stands in parallel or in series with it",
            )


def _other(given: Given) -> Given:
    return "net" if given == "common" else "common"


def _tied(
    graph: FlatGraph,
    mode: Mode,
    ports: tuple[Port, ...],
    bent: frozenset[int],
    known: Mapping[str, float],
) -> tuple[list[int], list[Row[float]]]:
    """Return the junction of one law of each constraint that contains laws, and the others."""
    reference = reference_of(mode, ports)
    ring = Numbers(known)
    made = Assembly(graph, ring, graph.on_nodes(reference), symbolic=False).out
    rows: list[Row[float]] = [
        row for row, owner in zip(made.rows, made.owners, strict=True) if owner not in bent
    ]
    nodes = {p.law.node for p in ports}
    own: dict[int, int] = {}
    others = []
    for switch, closing in made.closing.items():
        node = made.columns[switch - made.unknowns].index
        if node in nodes:
            own[switch] = node
        elif node not in bent:
            others.append(switch)
            rows.append(closing.row(tuple(mode[m] for m in closing.machines)))
    found = Renumbered(ring, rows, [*range(made.unknowns), *others]).constraints
    tied = [own[min(own.keys() & row.keys())] for row in found if own.keys() & row.keys()]
    held = {made.unknowns + k: c.index for k, c in enumerate(made.columns) if c.kind == "storage"}
    return tied, [{held[k]: c for k, c in row.items() if k in held} for row in found]
