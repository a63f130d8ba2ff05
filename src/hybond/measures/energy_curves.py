"""Energy over time: what was supplied up to each time, and where it went."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hybond.measures.energies import check_located, energies_into, power_nodes
from hybond.measures.jumps import jumps_in, owner_of
from hybond.measures.losses import NOWHERE
from hybond.measures.window import Window
from hybond.model.graph import Node

if TYPE_CHECKING:
    from hybond.result import Result

Vector = NDArray[np.float64]

PARTS = 400
"""Points of a curve, besides the steps of the run."""


@dataclass(frozen=True, slots=True)
class EnergyCurves:
    """Energies up to each time, J.

    Parameters
    ----------
    t : array, shape (n,)
        s; at a jump twice.
    supplied : array, shape (n,)
    losses : dict
        By element, shape (n,): dissipated and lost in jumps.
    """

    t: Vector
    supplied: Vector
    losses: dict[str, Vector]

    @property
    def stored(self) -> Vector:
        """How much more is stored than at the begin."""
        return np.asarray(self.supplied - sum(self.losses.values(), np.zeros(len(self.t))))


def energy_curves(run: Result, window: Window, *, depth: int | None = None) -> EnergyCurves:
    """Return what was supplied and where it went, over a window.

    Parameters
    ----------
    depth : int, optional
        Add up submodels: paths of more than so many words.

    Raises
    ------
    UsageError
        HB-R113 for time-stepping.
    NumericsError
        HB-R103, HB-R104.
    """
    check_located(run)
    graph = run.graph
    nodes = power_nodes(graph)
    passed = energies_into(run, nodes, window, parts=PARTS)
    sums = np.hstack([np.zeros((len(nodes), 1)), np.cumsum(passed.energy, axis=1)])
    times = np.append(passed.low, passed.high[-1])
    jumps = jumps_in(run, window)
    # each jump is a pair of points at its time
    at = [j.t for j in jumps]
    t = np.concatenate([times, np.repeat(at, 2)])
    later = np.concatenate([np.zeros(len(times)), np.tile([-1.0, 1.0], len(at))])
    order = np.lexsort((later, t))
    t, later = t[order], later[order]

    def named(node: Node | None) -> str:
        if node is None:
            return NOWHERE
        path = node.path.rpartition(".")[0] if node.hidden else node.path
        return path if depth is None else ".".join(path.split(".")[:depth])

    def jumped(when: float, energy: float) -> Vector:
        return np.where((t > when) | ((t == when) & (later > 0.0)), energy, 0.0)

    supplied = np.zeros(len(t))
    losses: dict[str, Vector] = {}

    def lose(node: Node | None, energy: Vector) -> None:
        name = named(node)
        losses[name] = losses.get(name, np.zeros(len(t))) + energy

    for node, row in zip(nodes, sums, strict=True):
        smooth = np.interp(t, times, row)
        if node.kind in ("Se", "Sf") and not node.implied:
            supplied -= smooth
        elif not node.about.energy:
            lose(owner_of(graph, node), smooth)
    for jump in jumps:
        for energy in jump.supplied.values():
            supplied += jumped(jump.t, energy)
        for k, energy in jump.lost.items():
            lose(graph.nodes[k] if k >= 0 else None, jumped(jump.t, energy))
    return EnergyCurves(t, supplied, losses)
