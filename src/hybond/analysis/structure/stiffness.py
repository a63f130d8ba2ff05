"""Stiffness of one mode: how far its time constants lie apart, and which elements make them.

A storage takes part in a motion by the product of its components in the left and the right
eigenvector, the participation factor (I. J. Perez-Arriaga, G. C. Verghese and F. C. Schweppe,
*Selective modal analysis with applications to electric power systems*, IEEE Trans. Power
Apparatus and Systems 101(9), 1982): a number without unit.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from hybond.analysis.structure.paths import SignalGraph
from hybond.causality.record import Causality
from hybond.equations.pencil import Pencil
from hybond.model.graph import FlatGraph, Mode
from hybond.model.kinds import RESISTORS

STIFF = 1e3
"""Ratio of the largest to the smallest magnitude of poles above which a mode is called stiff: an
explicit solver then takes about that many steps per slow time constant."""
SHARE = 0.2
"""Participation from which a storage is named; the one with most is named in any case."""


@dataclass(frozen=True, slots=True)
class Stiffness:
    """How far the time constants of a mode lie apart.

    Parameters
    ----------
    ratio : float
        Largest to smallest magnitude of the poles that are not zero; 1 if there are fewer than
        two.
    fastest, slowest : complex
        Those poles, 1/s.
    fast, slow : tuple of int
        The variables with the largest part in them.
    """

    ratio: float
    fastest: complex
    slowest: complex
    fast: tuple[int, ...]
    slow: tuple[int, ...]

    @property
    def stiff(self) -> bool:
        """Whether the ratio exceeds `STIFF`."""
        return self.ratio > STIFF


def stiffness(p: Pencil) -> Stiffness | None:
    """Return the stiffness of a mode; None if nothing moves by itself.

    Examples
    --------
    >>> from hybond.equations.pencil import analyse
    >>> from hybond.equations.descriptor import Descriptor
    >>> d = Descriptor.of([[1, 0], [0, 1]], [[-1e6, 1], [0, -2]], [[1], [0]],
    ...                   states=("fast.q", "slow.q"), inputs=("V",))
    >>> found = stiffness(analyse(d))
    >>> round(found.ratio), found.fast, found.slow, found.stiff
    (500000, (0,), (1,), True)
    """
    if p.slow is None or p.poles is None or not p.poles.any():
        return None
    moving = np.abs(p.poles[p.poles != 0.0])
    from scipy.linalg import eig

    kept = p.slow.kept
    values, left, right = eig(p.slow.A, left=True)
    values = values * p.scaled.time
    factors = np.abs(left * right)
    factors /= np.maximum(factors.sum(axis=0), 1e-300)

    def at(size: float) -> tuple[complex, tuple[int, ...]]:
        k = int(np.argmin(np.abs(np.abs(values) - size)))
        least = min(SHARE, float(factors[:, k].max()))
        return complex(values[k]), tuple(kept[i] for i in np.flatnonzero(factors[:, k] >= least))

    fastest, fast = at(float(moving.max()))
    slowest, slow = at(float(moving.min()))
    return Stiffness(float(moving.max() / moving.min()), fastest, slowest, fast, slow)


def resistors_around(
    graph: FlatGraph, mode: Mode, causality: Causality, storages: Collection[int]
) -> tuple[int, ...]:
    """Return the resistors on causal paths from these storages back to them, by no other storage.

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.causality.assign import assign
    >>> m = hb.Model("rc")
    >>> m.add(V=hb.Se(1), i=hb.One(), r=hb.R(1), c=hb.C(1))
    >>> m.bond("V -> i -> r", "i -> c")
    >>> graph = m.flatten()
    >>> found = resistors_around(graph, (), assign(graph, ()), [0])
    >>> [graph.nodes[k].path for k in found]
    ['r']
    """
    signals = SignalGraph(graph, mode, causality)
    at = [(graph.nodes[graph.storages[k].node], graph.storages[k].port) for k in storages]
    after = signals.after((signals.output(n, p) for n, p in at), through_storage=False)
    before = signals.before((signals.input(n, p) for n, p in at), through_storage=False)
    on_both = after & before
    return tuple(
        n.index
        for n in graph.nodes
        if n.kind in RESISTORS and any(signals.output(n, e.port) in on_both for e in n.ends)
    )
