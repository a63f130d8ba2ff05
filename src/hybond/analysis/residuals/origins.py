"""Where a residual comes from, and which storage the sensors leave unknown."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from hybond.analysis.residuals.region_solver import Item
from hybond.analysis.residuals.regions import Found
from hybond.analysis.residuals.sensor_rows import SensorRows
from hybond.analysis.residuals.unit_pivots import UnitPivots
from hybond.equations.ring import substituted

if TYPE_CHECKING:
    from hybond.analysis.residuals.residuals import Residuals


@dataclass(frozen=True)
class Unobserved:
    """Storage whose state does not follow from the sensors."""

    path: str
    """The stored quantity."""
    where: str
    """In which modes: empty for all of them."""
    why: str

    def __str__(self) -> str:
        where = f" {self.where}" if self.where else ""
        return f"{self.path} does not follow from the sensors{where}: {self.why}"


def rank(given: SensorRows, pivots: UnitPivots, tag: Item) -> tuple[int, int, int]:
    """Return the place of a residual among the others: in the order of nodes."""
    if tag[0] == "closing":
        about = given.column(tag[1])
        return (0 if about is None else about.index, 1, tag[1])
    row = pivots.constraints[tag[1]][0]
    owner = given.owners[row]
    return (owner if owner >= 0 else len(given.graph.nodes), 0, row)


def origin(given: SensorRows, pivots: UnitPivots, tag: Item) -> str:
    """Return the law that a residual compares."""
    graph = given.graph
    if tag[0] == "closing":
        about = given.column(tag[1])
        return f"switch {graph.nodes[about.index].path}" if about is not None else "switch"
    row = pivots.constraints[tag[1]][0]
    owner = given.owners[row]
    if owner < 0:
        sensor = next((given.known[k].name for k in given.rows[row] if k in given.known), "")
        return f"sensor {sensor}"
    node = graph.nodes[owner]
    if node.hidden:
        return f"switch of {node.path.removesuffix('.switch')}"
    if not node.is_junction:
        return f"law of {node.kind} {node.path}"
    return f"balance of {node.kind}-junction {node.path}"


def unobserved(about: Residuals, pivots: UnitPivots, found: Found) -> list[Unobserved]:
    """Say which stored quantities contain something that no sensor determines."""
    given, graph = about.given, about.graph
    listed = []
    for s in graph.storages:
        node = graph.nodes[s.node]
        value = pivots.value(given.storages[s.index])
        if s.node in given.unused:
            listed.append(Unobserved(s.path, "", given.unused[s.node]))
            continue
        where: list[str] = []
        always = False
        for region in [*found.regions, *found.large]:
            inside = value.keys() & region.variables
            if not inside:
                continue
            if not region.values:
                always = True
                continue
            bad = frozenset(
                k
                for k, (values, free) in enumerate(zip(region.values, region.open, strict=True))
                if substituted(given.ring, value, values).keys() & free
            )
            if len(bad) == region.space.count:
                always = True
            elif bad:
                cubes = about.naming.cubes(region.space, bad)
                where += [about.display.cube(c) for c in cubes]
        if always or where:
            text = "" if always else f"while {' or '.join(where)} = 1"
            listed.append(Unobserved(s.path, text, f"no sensor near {node.path} gives it"))
    return listed
